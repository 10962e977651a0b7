"""Serves a folder with three.js as a site, and opens a page in Chromium that can import modules from it.

Exit status 77: there is no Chromium, or none with WebGL 2. Standard output says which.
"""
import os
import sys

from support.browser_server import serve
from support.chromium import WEBGL, Chromium, program


class Site:
    def __init__(self, folder):
        if not program():
            print("no Chromium")
            sys.exit(77)
        _, self.address = serve(folder)
        with open(os.path.join(folder, "empty.html"), "w") as file:
            file.write("""<!doctype html><link rel="icon" href="data:,">
<script type="importmap">{ "imports": { "three": "./three.module.js" } }</script>""")
        self.chromium = Chromium(WEBGL)
        self.visit("empty.html")
        if not self.chromium.run("document.createElement('canvas').getContext('webgl2') !== null"):
            print("a Chromium without WebGL 2")
            sys.exit(77)

    def visit(self, page):
        self.chromium.ask("Page.navigate", url=self.address + page)
        self.chromium.wait_for("Page.loadEventFired")
        self.chromium.settle()
