"""python3 report_page.py PAGE.html: what a browser has to say of a report, as JSON: problems, requests, pictures that show nothing, and how far
the page is wider than a desktop's window and a phone's.

Exit status 77: there is no Chromium."""
import json
import sys

from chromium import Chromium, program

if not program():
    print("no Chromium (Debian: chromium)")
    sys.exit(77)
chromium = Chromium(["--disable-3d-apis"])
too_wide = []
for width, mobile in ((1280, False), (390, True)):
    chromium.size(width, 800, mobile=mobile)
    chromium.open(sys.argv[1])
    too_wide.append(chromium.run("document.documentElement.scrollWidth - innerWidth"))
answers = {"problems": chromium.problems, "requests": chromium.requests, "too_wide": too_wide,
           "images": chromium.run("document.images.length"),
           "blank": chromium.run("[...document.images].filter((i) => !i.complete || i.naturalWidth === 0).length"),
           "plots": chromium.run("[...document.querySelectorAll('svg.slice')].filter((s) => s.getBoundingClientRect().height > 100).length")}
chromium.close()
print(json.dumps(answers))
