"""docs/web.jpg: python3 docs/figures/web.py. Chromium opens the page that fits, data/ready/srbf.html, and fits the bundled film."""
import os
import sys
import time

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "..", "..", "test"))
from chromium import WEBGL, Chromium  # noqa: E402

PATIENCE = 600  # seconds until a fit counts as failed
FITTED = "document.getElementById('working').hidden && !!app.state().fitted && !!document.getElementById('verdict').textContent"
page = Chromium(WEBGL)
try:
    page.size(1100, 735)
    page.open(os.path.join(here, "..", "..", "data", "ready", "srbf.html"))
    page.click("[data-sample='cc_ibiza_sunset_rgb.bsdf']")
    begun = time.time()
    while not page.run(FITTED):
        if time.time() - begun > PATIENCE:
            sys.exit("nothing was fitted")
        time.sleep(1)
    time.sleep(60)  # pictures become less noisy
    page.run("document.getElementById('state').scrollIntoView()")
    page.settle()
    page.screenshot(os.path.join(here, "..", "web.jpg"))
finally:
    page.close()
