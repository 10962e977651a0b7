"""Serves a folder, and opens one of its pages in Chromium."""
import base64
import contextlib
import functools
import http.server
import threading

from support.chromium import Chromium

WEBGPU = ["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader"]


class Handler(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


def serve(folder):
    """A server of the folder at 127.0.0.1, and its address."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return server, f"http://127.0.0.1:{server.server_port}/"


@contextlib.contextmanager
def opened(folder, page, flags):
    """A browser that shows this page of the folder."""
    server, address = serve(folder)
    browser = Chromium(flags)
    try:
        browser.ask("Page.navigate", url=address + page)
        browser.wait_for("Page.loadEventFired")
        yield browser
    finally:
        browser.close()
        server.shutdown()


def picture(browser, promise, size):
    """The linear picture [size, size, 3] of a promise of float32 RGBA, whose first row is the lowest. Waits for 100 seconds."""
    import numpy as np  # the pages of a site are served without it
    patience = 'new Promise((_, no) => setTimeout(() => no("no picture"), 100000))'
    text = browser.run(f"""Promise.race([{promise}, {patience}]).then(({{ buffer }}) => {{
        let text = "";
        for (const byte of new Uint8Array(buffer)) text += String.fromCharCode(byte);
        return btoa(text);
    }})""")
    return np.frombuffer(base64.b64decode(text), np.float32).reshape(size, size, 4)[::-1, :, :3].astype(float)
