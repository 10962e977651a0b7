"""Links of the documentation resolve, and the files that it names exist: python3 test/pages_of_docs.py FOLDER. Its words: words.py."""
import os
import re
import sys

from support.documents import documents

folder = sys.argv[1]
PAGES = documents(folder)


def text(page):
    with open(os.path.join(folder, page), encoding="utf-8") as file:
        return file.read()


def is_left_out(path):
    """True for a path in a folder of extras that was deleted."""
    extra = re.match(r"extras/[a-z_]+", path)
    return bool(extra) and not os.path.exists(os.path.join(folder, extra[0]))


def anchors(page):
    """The anchors that GitHub makes from headings: words with hyphens, without punctuation. A repeated one gets a number."""
    found = {}
    for heading in re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", text(page), flags=re.M | re.S), flags=re.M):
        heading = re.sub(r"\]\([^)]*\)", "", heading).lower().strip()
        name = re.sub(r"[^\w\- ]", "", heading).replace(" ", "-")
        found[name] = found.get(name, -1) + 1
    return {name if i == 0 else f"{name}-{i}" for name, count in found.items() for i in range(count + 1)}


problems = []
for page in PAGES:
    prose = re.sub(r"^\s*```.*?^\s*```", "", text(page), flags=re.M | re.S)
    for link in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "", prose)):
        path, _, anchor = link.partition("#")
        if re.match(r"[a-z]+:", link):
            continue
        target = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
        if is_left_out(target):
            continue
        if not os.path.exists(os.path.join(folder, target)):
            problems.append(f"{page}: no {link}")
        elif anchor and target.endswith(".md") and anchor not in anchors(target):
            problems.append(f"{page}: no heading {link}")
# A file is named by its path from the root, or from one of these folders. NAME stands for any name.
NAMED = re.compile(r"`((?:[a-z_.]+/)+[a-z_0-9]+\.(?:cpp|h|glsl))`")
for page in (page for page in PAGES if page != "CHANGELOG.md" and not page.startswith("docs/notes/")):
    for name in NAMED.findall(text(page)):
        if not is_left_out(name) and not any(os.path.exists(os.path.join(folder, root, name)) for root in ("", "src", "include", "data")):
            problems.append(f"{page}: no file {name}")
print("\n".join(problems) or f"{len(PAGES)} pages: links resolve")
sys.exit(bool(problems))
