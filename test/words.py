"""Pages, help texts and messages have none of the terms of words.csv: python3 test/words.py FOLDER.

A line of words.csv is a regular expression, of words, and what to write instead. It searches the prose of the documentation, what
programs print or show (strings of C++, and the text of web pages, scripts and the Python package) and comments of C++ and GLSL, which also
begin with a subject, not with "Of", "What", "Whether" or "The same". `code` and blocks of code are not prose.
"""
import csv
import os
import re
import sys

from support.documents import documents

folder = sys.argv[1]
STRINGS = re.compile(r'(?<!\w)"((?:[^"\\\n]|\\.)*)"')  # strings in one line of C++; adjacent ones are one string
COMMENT = re.compile(r"(^|\s)//+<?(.*)$")
BARE = re.compile(r"(Of|What|Whether|The same|Those|As many|So many)\b")
SHOWN = re.compile(r'"([^"\n]*)"|`([^`]*)`|>([^<>]*)<|"""(.*?)"""', flags=re.S)  # strings of scripts and pages


def text(path):
    with open(os.path.join(folder, path), encoding="utf-8") as file:
        return file.read()


def files(where, *endings):
    found = (os.path.join(at, name)[len(folder.rstrip("/")) + 1:] for at, _, names in os.walk(os.path.join(folder, where)) for name in names)
    return sorted(path for path in found if path.endswith(endings))


def prose(page):
    return re.sub(r"`[^`]*`", "", re.sub(r"^\s*```(?!text).*?^\s*```", "", text(page), flags=re.M | re.S))


def strings(path):
    """The strings of a C++ file, without comments; adjacent ones are joined."""
    code = re.sub(r"^\s*//.*$", "", text(path), flags=re.M).replace('\\n"', ' "')
    return "\n".join(STRINGS.findall(re.sub(r'"\s*\n\s*"', "", code)))


def shown(path):
    return "\n".join(" ".join(filter(None, groups)) for groups in SHOWN.findall(text(path)))


def comments(path):
    """The comments of a C++ or GLSL file; lines of one comment are joined."""
    lines = [re.sub(r'"(?:[^"\\\n]|\\.)*"', '""', line) for line in text(path).split("\n")]
    found = [COMMENT.search(line) for line in lines]
    blocks = "\n".join(match.group(2) if match else "\f" for match in found)
    return [" ".join(re.sub(r"`[^`]*`", "", block).split()) for block in blocks.split("\f") if block.strip()]


with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "words.csv"), encoding="utf-8") as file:
    terms = [(re.compile(rf"\b(?:{row['term']})", flags=re.I), row["instead"]) for row in csv.DictReader(file)]
searched = [(page, prose(page)) for page in documents(folder)]
searched += [(path, strings(path)) for where in ("app", "extras", "src") for path in files(where, ".cpp", ".h")]
searched += [(path, shown(path)) for path in files("web", ".html", ".js", ".mjs") + files("extras", ".html") + files("python/srbf", ".py")]
problems = []
for path in (path for where in ("src", "include", "extras", "app", "python", "web") for path in files(where, ".cpp", ".h", ".inl", ".glsl")):
    for comment in comments(path) if "/test/" not in path else []:
        searched.append((path, comment))
        if BARE.match(comment):
            problems.append(f"{path}: '{comment[:60]}'; write: a sentence with a subject and a verb")
for path, text in searched:
    for term, instead in terms:
        problems += [f"{path}: '{' '.join(found.group().split())}'; write: {instead}" for found in term.finditer(text)]
print("\n".join(problems) or f"{len(searched)} texts: none of {len(terms)} terms")
sys.exit(bool(problems))
