"""python3 page.py PAGE.html FOLDER: does what a user does with the page, and writes its pictures and its texts about them into FOLDER.

Exit status 77: there is no Chromium, or none with WebGL 2. Standard output says which.
"""
import base64
import json
import os
import sys
import time

from support.chromium import LIMIT, WEBGL, Chromium, program

page, folder = sys.argv[1:3]


# Three lights first, and all controls to be seen.
LIGHTS = "#lights"
CONTROLS = "document.querySelector('#viewer details').open = true"


# The texts that are seen, how many they are, and what is wrong with their boxes: they lie over each other, or their page or drawing cuts
# them. What scrolls within the page is cut there.
LABELS = """(() => {
    const seen = [], wrong = [];
    const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (texts.nextNode()) {
        const text = texts.currentNode.data.trim(), element = texts.currentNode.parentElement;
        if (!text || element.closest("script, pre, option") || !element.checkVisibility()) continue;
        const range = document.createRange();
        range.selectNodeContents(texts.currentNode);
        const drawing = element.closest("svg"), scrolled = element.closest(".wide"), within = (drawing ?? document.documentElement).getBoundingClientRect();
        for (const box of range.getClientRects()) {
            const left = box.left, top = box.top, bottom = box.bottom, right = Math.min(box.right, scrolled?.getBoundingClientRect().right ?? Infinity);
            if (right - left < 1 || bottom - top < 1) continue;
            if (left < Math.max(within.left, 0) - 1 || right > Math.min(within.right, innerWidth) + 1 || top < within.top - 1 || bottom > within.bottom + 1)
                wrong.push(`${text} is cut`);
            for (const other of seen)
                if (Math.min(right, other.right) - Math.max(left, other.left) > 1 && Math.min(bottom, other.bottom) - Math.max(top, other.top) > 2)
                    wrong.push(`${text} lies over ${other.text}`);
            seen.push({ text, left, top, right, bottom });
        }
    }
    return { seen: seen.length, wrong };
})()"""


class Visit:
    def __init__(self, flags):
        self.chromium, self.pictures = Chromium(flags), []

    def take(self, step):
        """Keeps the pixels of every picture that is shown, as RGBA, and the scene that the page says it drew."""
        self.chromium.run("viewer.settled()")
        for picture in self.chromium.run("""[...document.querySelectorAll("figure:not([hidden]):not([data-material=difference])")].map((figure) => {
                const canvas = figure.querySelector("canvas"), { width, height } = canvas;
                const copy = Object.assign(document.createElement("canvas"), { width, height })
                    .getContext("2d", { willReadFrequently: true });
                copy.drawImage(canvas, 0, 0);
                const pixels = copy.getImageData(0, 0, width, height).data;
                let text = "";
                for (let i = 0; i < pixels.length; i += 8192) text += String.fromCharCode(...pixels.subarray(i, i + 8192));
                return { material: Number(figure.dataset.material), width, height, scene: viewer.scene(width / height), pixels: btoa(text) };
            })"""):
            name = f"{len(self.pictures)}.rgba"
            with open(os.path.join(folder, name), "wb") as file:
                file.write(base64.b64decode(picture.pop("pixels")))
            self.pictures.append({"step": step, "file": name, **picture})


def with_webgl():
    visit = Visit(WEBGL)
    chromium = visit.chromium
    chromium.size(1000, 600)
    chromium.open(page, LIGHTS)
    chromium.run(CONTROLS)
    if not chromium.run("!!document.createElement('canvas').getContext('webgl2')"):
        print("this Chromium has no WebGL 2")
        sys.exit(77)
    visit.take("opened")
    chromium.run("document.forms[0].mesh.value = 'ball'")
    chromium.click("[data-show='1']")
    visit.take("one")
    chromium.drag("figure:not([hidden]) canvas", 80, 30)
    visit.take("turned")
    chromium.click("[name='drag'][value='light']")
    chromium.drag("figure:not([hidden]) canvas", 60, 0)
    visit.take("lit")
    chromium.click("[data-show='0']")
    visit.take("other")
    chromium.click("[name='others']")
    chromium.run("const f = document.forms[0]; f.mesh.value = 'knot'; f.stops.value = -1; f.mesh.dispatchEvent(new Event('input', {bubbles: true}))")
    chromium.settle()
    visit.take("knot")
    chromium.click("[type='reset']")
    chromium.settle()
    visit.take("again")
    chromium.click("[data-show='7']")
    chromium.click("[name='behind']")
    visit.take("behind")
    chromium.size(390, 844, mobile=True)
    chromium.open(page, LIGHTS)
    chromium.run(CONTROLS)
    visit.take("phone")
    labels = {"wipe": chromium.run(LABELS)}
    for show in ("all", "difference", "1"):
        chromium.click(f"[data-show='{show}']")
        labels[show] = chromium.run(LABELS)
    visit.take("phone one")
    chromium.swipe("figure:not([hidden]) canvas", 60, 0)
    visit.take("swiped")
    phone = chromium.run("[document.documentElement.scrollWidth, innerWidth]")
    under_environments(visit)
    read = read_environment(chromium)
    answers = {"pictures": visit.pictures, "problems": chromium.problems, "requests": chromium.requests, "phone": phone, "labels": labels,
               "read": read,
               "refused": refused_environments(chromium)}
    chromium.close()
    return answers


CHOOSE = "document.forms[0].environment.dispatchEvent(new Event('input', {bubbles: true}))"


def under_environments(visit):
    """Returns the pictures once they are means of samples alone."""
    chromium = visit.chromium

    def converged(step):
        chromium.run("viewer.settled()")  # what it says of samples is of these pictures
        end = time.time() + LIMIT
        while chromium.run("viewer.scene(1).samples") < 12 and time.time() < end:
            chromium.settle()
        visit.take(step)

    chromium.size(140, 600, mobile=True)
    for material in (0, 7, 3):  # the measurement, and models of two kinds
        chromium.click(f"[data-show='{material}']")
        if material == 0:
            chromium.run("document.forms[0].mesh.value = 'ball'; document.forms[0].environment.value = 'studio'; " + CHOOSE)
            chromium.settle()
        converged("studio")
    chromium.drag("figure:not([hidden]) canvas", 60, 0, modifiers=8)  # Shift
    converged("studio turned")
    chromium.click("[name='lamps']")
    converged("studio and lights")


GIVE = """((name, content, size) => {
    const file = new File([Uint8Array.from(content, (c) => c.charCodeAt(0))], name), given = new DataTransfer();
    if (size) Object.defineProperty(File.prototype, "size", { value: size });
    given.items.add(file);
    const input = document.forms[0].file;
    input.files = given.files;
    document.getElementById("said").textContent = "";
    input.dispatchEvent(new Event("change"));
})"""


def give(chromium, name, content, size=0):
    """Chooses a file as the environment."""
    chromium.run(f"{GIVE}({json.dumps(name)}, {json.dumps(content)}, {size})")


def read_environment(chromium):
    """Returns what the page says while it reads an environment, and once it has pictures under it."""
    chromium.run("""(() => {
        const { arrayBuffer } = Blob.prototype;
        Blob.prototype.arrayBuffer = async function () {
            Blob.prototype.arrayBuffer = arrayBuffer;
            await viewer.settled(); // pictures arrive meanwhile
            window.reading = [document.getElementById("busy").innerText, document.forms[0].environment.value];
            return arrayBuffer.call(this);
        };
    })()""")
    give(chromium, "flat.hdr", "#?RADIANCE\n\n-Y 4 +X 8\n" + "\x80" * 128)
    end = time.time() + LIMIT
    while chromium.run("document.forms[0].environment.value") != "file" and time.time() < end:
        chromium.settle()
    chromium.run("viewer.settled()")
    return [*chromium.run("reading"), chromium.run("document.forms[0].environment.value"),
            chromium.run("document.getElementById('busy').innerText")]


def refused_environments(chromium):
    """Returns what the page says to files that are no environments, and to a lost context."""
    said = {}

    def says(new):
        """Returns what the page says, once that is new."""
        end = time.time() + LIMIT
        while not new(text := chromium.run("document.getElementById('said').innerText")) and time.time() < end:
            chromium.settle()
        return text

    for name, size, content in (("text.hdr", 0, "no environment"),
                                ("cut.hdr", 0, "#?RADIANCE\n\n-Y 4 +X 8\nxxx 40 bytes or more, but not 128 of them"),
                                ("cut.exr", 0, "\x76\x2f\x31\x01\x02"), ("huge.hdr", 4 << 30, "#?")):
        give(chromium, name, content, size)
        said[name] = says(lambda text: text)
    chromium.run("viewer.lose(true)")
    said["lost"] = says(lambda text: text not in said.values())
    chromium.run("viewer.lose(false)")
    said["restored"] = says(lambda text: text != said["lost"])
    chromium.run("viewer.settled()")  # it draws again
    return said


def without_webgl():
    chromium = Chromium(["--disable-3d-apis", "--disable-software-rasterizer"])
    chromium.size(1000, 600)
    chromium.open(page)
    shown = lambda selector: chromium.run(
        f"[...document.querySelectorAll({selector!r})].filter((e) => e.getBoundingClientRect().height > 0).length")
    end = time.time() + LIMIT
    while not shown("#without") and time.time() < end:  # its worker tells it
        time.sleep(0.1)
    answers = {"said": shown("#without"), "viewer": shown("#viewer"), "rows": shown("tbody tr"), "slices": shown("svg.slice"),
               "problems": [p for p in chromium.problems if "WebGL" not in json.dumps(p)]}
    chromium.close()
    return answers


if not program():
    print("no Chromium (Debian: chromium)")
    sys.exit(77)
result = {"with": with_webgl(), "without": without_webgl()}
with open(os.path.join(folder, "result.json"), "w") as file:
    json.dump(result, file, indent=1)
