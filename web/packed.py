"""A smaller page: python3 web/packed.py PAGE.html SMALL.html.

SMALL.html shows what a page of `srbf export --to html` shows, in about a fifth of its bytes. The page is compressed as a whole, and the
script of packed_page.html unpacks it in the browser. Two things are rounded: positions and normals of shapes to 16 bits, and values of a
measurement to 8 binary digits, by at most 0.2 %. SMALL.html shows nothing without JavaScript.
"""
import array
import base64
import difflib
import html
import json
import re
import sys
import zlib
from pathlib import Path

DROPPED_BITS = 2  # binary digits by which values of the measurement, 16-bit floats, are shortened
ROWS = (32, 96, 97)  # vertices in a row of the built-in shapes, which are grids
DATA = re.compile(r'(?<=<script id="data" type="application/json">).*?(?=</script>)', re.S)
SHADER = re.compile(r"<pre id='glsl-\d+'>(.*?)</pre>", re.S)


def encode_differences(numbers, strides):
    """Returns differences of 16-bit numbers, over each stride in turn, as bytes: the sign is the lowest bit, low bytes first."""
    for stride in reversed(strides):
        numbers = [number - (numbers[i - stride] if i >= stride else 0) & 0xFFFF for i, number in enumerate(numbers)]
    folded = [2 * delta if delta < 0x8000 else 2 * (0xFFFF - delta) + 1 for delta in numbers]
    return bytes(x & 255 for x in folded) + bytes(x >> 8 for x in folded)


def vertices_of(mesh):
    """Returns the numbers of the vertices, rounded to 16 bits, and the scale of the positions."""
    vertices = array.array("f", base64.b64decode(mesh["vertices"]))
    scale = max(abs(x) for i, x in enumerate(vertices) if i % 6 < 3)
    return [round(32767 * (x / scale if i % 6 < 3 else x)) & 0xFFFF for i, x in enumerate(vertices)], scale


def colours_of(texture):
    """Returns the rounded colours of a texture, three numbers a texel."""
    texels, rounded = array.array("H", base64.b64decode(texture["texels"])), []
    for i in range(0, len(texels), 4):
        colour = [x + (1 << DROPPED_BITS >> 1) >> DROPPED_BITS for x in texels[i:i + 3]]
        rounded += [1, 0, 0] if texels[i + 3] and not any(colour) else colour  # black; unmeasured texels have three zeros
    return rounded


def parts_of(data):
    """Yields for each large array of the data: its object, its key there, the numbers, lists of possible strides, and the scale."""
    for mesh in data["meshes"].values():
        if mesh["index_bytes"] == 2:
            yield mesh, "triangles", array.array("H", base64.b64decode(mesh["triangles"])), [[3]], None
        numbers, scale = vertices_of(mesh)
        yield mesh, "vertices", numbers, [[6], *([6, 6 * row] for row in ROWS)], scale
    rgbe = base64.b64decode(data["environment"]["rgbe"])
    yield data["environment"], "rgbe", [x for c in range(4) for x in rgbe[c::4]], [[1]], None
    for material in data["materials"]:
        for texture in (material or {}).get("textures", []):
            if texture["sampler"] == "merl_table":
                width, height, _ = texture["size"]
                yield texture, "texels", colours_of(texture), [[3 * width * height]], DROPPED_BITS


def escape(text):
    return html.escape(text).replace("&#x27;", "&#39;")


def extract_shared_text(page, data):
    """Takes the lines that all shaders share with an environment's out of the data. Returns the page and these lines."""
    shaders, develop = [html.unescape(shader).split("\n") for shader in SHADER.findall(page)], data["develop"].split("\n")
    if not shaders:
        return page, ""
    found = difflib.SequenceMatcher(None, shaders[0], develop, autojunk=False).find_longest_match()
    shared = "\n".join(develop[found.b:found.b + found.size])
    data["develop"] = data["develop"].replace(shared, "@shared in JSON@")
    return page.replace(escape(shared), "@shared@"), shared


def pack(page):
    """Returns the text of a smaller page."""
    data = json.loads(DATA.search(page)[0])
    page, shared = extract_shared_text(page, data)
    parts, binary = [], b""
    for k, (holder, key, numbers, stride_options, scale) in enumerate(parts_of(data)):
        holder[key] = f"@part{k}@"
        encodings = [(encode_differences(numbers, strides), strides) for strides in stride_options]
        shortest, strides = min(encodings, key=lambda encoding: len(zlib.compress(encoding[0], 9)))
        parts.append({"kind": key, "strides": strides, "count": len(numbers), "scale": scale})
        binary += shortest
    page = DATA.sub(lambda _: json.dumps(data, separators=(",", ":")).replace("<", "\\u003c"), page)
    head = json.dumps({"page": page, "shared": shared, "parts": parts}, ensure_ascii=False, separators=(",", ":")).encode()
    text = base64.b64encode(zlib.compress(head + b"\0" + binary, 9)).decode()
    template = Path(__file__).with_name("packed_page.html").read_text(encoding="utf-8")
    return template.replace("{{title}}", re.search(r"<title>(.*?)</title>", page)[1]).replace("{{packed}}", text)


if __name__ == "__main__":
    Path(sys.argv[2]).write_text(pack(Path(sys.argv[1]).read_text(encoding="utf-8")), encoding="utf-8")
