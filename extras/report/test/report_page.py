"""python3 report_page.py GALLERY.html PAGE.html...: prints as JSON how a browser renders a report's pages.

The output contains:
  - problems and requests
  - the numbers of pictures and of plots on each page
  - the number of blank pictures
  - by how many pixels the pages are wider than the window of a desktop and that of a phone
  - the order of the gallery's materials after a click

Exit status 77: Chromium is not installed."""
import json
import sys

from support.chromium import Chromium, program

if not program():
    print("no Chromium (Debian: chromium)")
    sys.exit(77)
chromium = Chromium(["--disable-3d-apis"])
answers = {"too_wide": [], "images": [], "plots": [], "blank": 0}
for page in sys.argv[1:]:
    for width, mobile in ((1280, False), (390, True)):
        chromium.size(width, 800, mobile=mobile)
        chromium.open(page)
        answers["too_wide"].append(chromium.run("document.documentElement.scrollWidth - innerWidth"))
    chromium.run("for (const image of document.images) image.loading = 'eager'")
    chromium.run("Promise.all([...document.images].map((image) => image.decode().catch(() => {})))")
    answers["images"].append(chromium.run("document.images.length"))
    answers["blank"] += chromium.run("[...document.images].filter((i) => !i.complete || i.naturalWidth === 0).length")
    answers["plots"].append(chromium.run("[...document.querySelectorAll('svg.slice')].filter((s) => s.getBoundingClientRect().height > 100).length"))
chromium.open(sys.argv[1])
for by in ("name", "error"):
    answers["by_" + by] = chromium.run(f"(document.querySelector('[data-by={by}]').click(), [...document.querySelectorAll('.card')].map((c) => c.dataset.{by}))")
answers["by_error"] = [float(error) for error in answers["by_error"]]
answers.update(problems=chromium.problems, requests=chromium.requests)
chromium.close()
print(json.dumps(answers))
