"""A page in a headless Chromium, driven over the pipe of its DevTools protocol with Python's standard library."""
import base64
import json
import os
import select
import shutil
import subprocess
import tempfile


def program():
    """The name of the installed Chromium, or None."""
    return next((name for name in ("chromium", "chromium-browser", "google-chrome") if shutil.which(name)), None)


LIMIT = 3600  # seconds of silence after which a browser is taken to hang


class Chromium:
    """A browser with one page. `problems` lists messages of its console and network."""

    def __init__(self, flags):
        self.profile = tempfile.TemporaryDirectory(prefix="srbf-chromium-", ignore_cleanup_errors=True)
        their_in, self.out = os.pipe()
        self.in_, their_out = os.pipe()

        def as_files_3_and_4():
            # Temporary numbers that differ from both ends.
            a, b = os.dup2(their_in, 100), os.dup2(their_out, 101)
            os.dup2(a, 3), os.dup2(b, 4)

        # Containers have little or no shared memory.
        command = [program(), "--headless=new", "--remote-debugging-pipe", "--no-sandbox", "--disable-dev-shm-usage", "--no-first-run", "--hide-scrollbars",
                   "--disable-background-networking", "--disable-component-update", "--disable-extensions",
                   "--user-data-dir=" + self.profile.name, *flags, "about:blank"]
        self.process = subprocess.Popen(command, close_fds=False, preexec_fn=as_files_3_and_4, stdin=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(their_in), os.close(their_out)
        self.unread, self.number, self.session, self.problems, self.requests = b"", 0, None, [], []
        target = next(t for t in self.ask("Target.getTargets")["targetInfos"] if t["type"] == "page")
        self.session = self.ask("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.ask(domain + ".enable")

    def close(self):
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.profile.cleanup()

    def receive(self):
        """The next message."""
        while b"\0" not in self.unread:
            if not select.select([self.in_], [], [], LIMIT)[0]:
                raise TimeoutError(f"no message from Chromium for {LIMIT} s")
            more = os.read(self.in_, 1 << 20)
            if not more:
                raise EOFError("Chromium ended")
            self.unread += more
        text, self.unread = self.unread.split(b"\0", 1)
        message = json.loads(text)
        method, params = message.get("method"), message.get("params", {})
        if method == "Runtime.exceptionThrown" or method == "Log.entryAdded" and params["entry"]["level"] in ("warning", "error"):
            self.problems.append(params)
        if method == "Runtime.consoleAPICalled" and params["type"] in ("warning", "error", "assert"):
            self.problems.append(params)
        if method == "Network.requestWillBeSent":
            self.requests.append(params["request"]["url"][:100])
        return message

    def ask(self, method, **params):
        self.number += 1
        message = {"id": self.number, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(method + ": " + answer["error"]["message"])
                return answer["result"]

    def wait_for(self, method):
        while self.receive().get("method") != method:
            pass

    def run(self, script):
        """The value of an expression, awaited if it is a promise."""
        answer = self.ask("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(script + ": " + json.dumps(answer["exceptionDetails"]))
        return answer["result"].get("value")

    def size(self, width, height, mobile=False):
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=mobile)
        self.ask("Emulation.setTouchEmulationEnabled", enabled=mobile)

    def open(self, path, fragment=""):
        if fragment:
            self.ask("Page.navigate", url="about:blank")  # the same page with another fragment is not loaded anew
            self.wait_for("Page.loadEventFired")
        self.ask("Page.navigate", url="file://" + os.path.abspath(path) + fragment)
        self.wait_for("Page.loadEventFired")
        self.settle()

    def settle(self):
        """Waits until pending frames are drawn."""
        self.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done))))")

    def middle(self, selector):
        """The position of an element on the screen, after scrolling to it."""
        return self.run(f"""(() => {{ const e = document.querySelector({selector!r}); e.scrollIntoView({{block: "center"}});
            const r = e.getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; }})()""")

    def click(self, selector):
        x, y = self.middle(selector)
        for kind in ("mousePressed", "mouseReleased"):
            self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)
        self.settle()

    def drag(self, selector, right, down, modifiers=0):
        x, y = self.middle(selector)
        mouse = lambda kind, at: self.ask("Input.dispatchMouseEvent", type=kind, x=x + at * right, y=y + at * down, button="left",
                                          buttons=1, clickCount=1, modifiers=modifiers)
        mouse("mousePressed", 0)
        for i in range(1, 6):
            mouse("mouseMoved", i / 5)
        mouse("mouseReleased", 1)
        self.settle()

    def swipe(self, selector, right, down):
        x, y = self.middle(selector)
        touch = lambda kind, *points: self.ask("Input.dispatchTouchEvent", type=kind,
                                               touchPoints=[{"x": a, "y": b} for a, b in points])
        touch("touchStart", (x, y))
        for i in range(1, 6):
            touch("touchMove", (x + i / 5 * right, y + i / 5 * down))
        touch("touchEnd")
        self.settle()

    def screenshot(self, path, whole=False):
        """Saves the screen as PNG or JPEG, by the ending of the path."""
        jpeg = {"format": "jpeg", "quality": 90} if str(path).endswith(".jpg") else {"format": "png"}
        answer = self.ask("Page.captureScreenshot", captureBeyondViewport=whole, **jpeg)
        with open(path, "wb") as file:
            file.write(base64.b64decode(answer["data"]))


def picture(html, width, path, folder=None):
    """Writes a picture of a whole page without scripts, `width` pixels wide; relative paths of its files begin in `folder`."""
    with tempfile.TemporaryDirectory() as work:
        page = os.path.join(folder or work, "page.html")
        with open(page, "w", encoding="utf-8") as file:
            file.write(f'<!doctype html><meta charset="utf-8">{html}')
        browser = Chromium(["--allow-file-access-from-files"])
        try:
            browser.size(width, 100)
            browser.open(page)
            browser.screenshot(path, whole=True)
        finally:
            browser.close()


WEBGL = ["--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist"]
