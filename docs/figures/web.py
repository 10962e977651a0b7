"""Draws docs/web.jpg: python3 docs/figures/web.py. Chromium opens the page that fits, data/ready/srbf.html, clicks the ball of the film,
and makes its highlight rougher."""
import os
import sys
import time

from clone import ROOT
from support.chromium import WEBGL, Chromium

PATIENCE = 600  # seconds until a picture counts as missing
page = Chromium(WEBGL)


def wait(shown):
    begun = time.time()
    while not page.run(shown):
        if time.time() - begun > PATIENCE:
            sys.exit("nothing was shown")
        time.sleep(1)


try:
    page.size(1280, 900)
    page.open(os.path.join(ROOT, "data", "ready", "srbf.html"))
    page.click("#gallery a[href='#cc_ibiza_sunset']")
    wait("document.getElementById('working').hidden && !document.getElementById('editing').hidden")
    page.run("""(() => { const slider = document.getElementById("edit_roughen"); slider.value = 0.5;
        for (const kind of ["input", "change"]) slider.dispatchEvent(new Event(kind, { bubbles: true })); })()""")
    wait("document.getElementById('edit_status').textContent.length > 0")
    time.sleep(10)  # the edited picture is begun
    wait("!document.getElementById('viewer').classList.contains('refining')")
    page.run("document.getElementById('state').scrollIntoView()")
    page.settle()
    page.screenshot(os.path.join(ROOT, "docs", "web.jpg"))
finally:
    page.close()
