"""A smaller page: python3 web/packed.py PAGE.html SMALL.html.

SMALL.html shows what a page of `srbf export --to html` shows, in about a fifth of its bytes. The page is compressed as a whole, and a script
of the browser unpacks it. Two things are rounded: positions and normals of shapes to 16 bits, and values of a measurement to 8 binary
digits, by at most 0.2 %. SMALL.html shows nothing without JavaScript.
"""
import array
import base64
import difflib
import html
import json
import re
import sys
import zlib

HALF_BITS = 2  # binary digits by which values of the measurement, 16-bit floats, are shortened
ROWS = (32, 96, 97)  # vertices in a row of the built-in shapes, which are grids
DATA = re.compile(r'(?<=<script id="data" type="application/json">).*?(?=</script>)', re.S)
SHADER = re.compile(r"<pre id='glsl-\d+'>(.*?)</pre>", re.S)
PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>TITLE</title>
</head>
<body>
<p id="without">This page needs JavaScript and a browser of 2023 or later.</p>
<script id="packed" type="text/plain">PACKED</script>
<script>
"use strict";
// The page is compressed; the numbers of shapes, of the measurement and of the environment are stored as differences.
(async () => {
  const bytes = Uint8Array.from(atob(document.getElementById("packed").textContent), (c) => c.charCodeAt(0));
  const all = new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer());
  let at = all.indexOf(0);
  const { page, shared, parts } = JSON.parse(new TextDecoder().decode(all.subarray(0, at++)));
  const read = ({ strides, count }) => {
    const numbers = new Uint16Array(count);
    for (let i = 0; i < count; ++i) {
      const folded = all[at + i] | all[at + count + i] << 8;
      numbers[i] = folded >> 1 ^ -(folded & 1);
    }
    at += 2 * count;
    for (const stride of strides) for (let i = stride; i < count; ++i) numbers[i] += numbers[i - stride];
    return numbers;
  };
  const kinds = {
    triangles: (numbers) => numbers,
    vertices: (numbers, scale) => Float32Array.from(new Int16Array(numbers.buffer), (x, i) => x / 32767 * (i % 6 < 3 ? scale : 1)),
    rgbe: (numbers) => Uint8Array.from(numbers, (_, i) => numbers[i % 4 * numbers.length / 4 + (i >> 2)]),
    texels(numbers, shift) { // the fourth number of a texel is 1 where it was measured; others are black
      const texels = new Uint16Array(numbers.length / 3 * 4);
      for (let i = 0, k = 0; k < numbers.length; i += 4, k += 3) {
        for (let c = 0; c < 3; ++c) texels[i + c] = numbers[k + c] << shift;
        if (numbers[k] || numbers[k + 1] || numbers[k + 2]) texels[i + 3] = 0x3c00;
      }
      return texels;
    },
  };
  const text = (numbers) => {
    let binary = "";
    for (const byte of new Uint8Array(numbers.buffer)) binary += String.fromCharCode(byte);
    return btoa(binary);
  };
  const texts = parts.map((part) => text(kinds[part.kind](read(part), part.scale)));
  const quoted = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&#39;" };
  const in_html = shared.replace(/[&<>"']/g, (c) => quoted[c]), in_json = JSON.stringify(shared).slice(1, -1).replaceAll("<", "\\u003c");
  document.open();
  document.write(page.replaceAll("@shared@", () => in_html).replace("@shared in JSON@", () => in_json).replace(/@part(\\d+)@/g, (_, k) => texts[k]));
  document.close();
})();
</script>
</body>
</html>
"""


def differences(numbers, strides):
    """Numbers of 16 bits as differences to those a stride before, by one stride after the other, with the sign as the lowest bit; all low bytes
    precede the high ones."""
    for stride in reversed(strides):
        numbers = [number - (numbers[i - stride] if i >= stride else 0) & 0xFFFF for i, number in enumerate(numbers)]
    folded = [2 * apart if apart < 0x8000 else 2 * (0xFFFF - apart) + 1 for apart in numbers]
    return bytes(x & 255 for x in folded) + bytes(x >> 8 for x in folded)


def vertices_of(mesh):
    """The numbers of the vertices, rounded to 16 bits, and what they are divided by."""
    vertices = array.array("f", base64.b64decode(mesh["vertices"]))
    scale = max(abs(x) for i, x in enumerate(vertices) if i % 6 < 3)
    return [round(32767 * (x / scale if i % 6 < 3 else x)) & 0xFFFF for i, x in enumerate(vertices)], scale


def colours_of(texture):
    texels, rounded = array.array("H", base64.b64decode(texture["texels"])), []
    for i in range(0, len(texels), 4):
        colour = [x + (1 << HALF_BITS >> 1) >> HALF_BITS for x in texels[i:i + 3]]
        rounded += [1, 0, 0] if texels[i + 3] and not any(colour) else colour  # black; unmeasured texels have three zeros
    return rounded


def parts_of(data):
    """Yields the large arrays of the data: place, kind, numbers, strides of differences to choose from, and scale."""
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
                yield texture, "texels", colours_of(texture), [[3 * width * height]], HALF_BITS


def escaped(text):
    return html.escape(text).replace("&#x27;", "&#39;")


def with_shared_text(page, data):
    """The page and the data without the lines that the shaders of all materials and one of the environment's share, and these lines."""
    shaders, develop = [html.unescape(shader).split("\n") for shader in SHADER.findall(page)], data["develop"].split("\n")
    if not shaders:
        return page, ""
    found = difflib.SequenceMatcher(None, shaders[0], develop, autojunk=False).find_longest_match()
    shared = "\n".join(develop[found.b:found.b + found.size])
    data["develop"] = data["develop"].replace(shared, "@shared in JSON@")
    return page.replace(escaped(shared), "@shared@"), shared


def packed(page):
    """The text of a smaller page."""
    data = json.loads(DATA.search(page)[0])
    page, shared = with_shared_text(page, data)
    parts, binary = [], b""
    for k, (where, name, numbers, choices, scale) in enumerate(parts_of(data)):
        where[name] = f"@part{k}@"
        tries = [(differences(numbers, strides), strides) for strides in choices]
        best, strides = min(tries, key=lambda packing: len(zlib.compress(packing[0], 9)))
        parts.append({"kind": name, "strides": strides, "count": len(numbers), "scale": scale})
        binary += best
    page = DATA.sub(lambda _: json.dumps(data, separators=(",", ":")).replace("<", "\\u003c"), page)
    head = json.dumps({"page": page, "shared": shared, "parts": parts}, ensure_ascii=False, separators=(",", ":")).encode()
    text = base64.b64encode(zlib.compress(head + b"\0" + binary, 9)).decode()
    return PAGE.replace("TITLE", re.search(r"<title>(.*?)</title>", page)[1]).replace("PACKED", text)


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        small = packed(file.read())
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write(small)
