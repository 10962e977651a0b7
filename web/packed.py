"""A smaller page: python3 web/packed.py PAGE.html SMALL.html.

SMALL.html shows what a page of `srbf export --to html` shows, in about a quarter of its bytes. The page is compressed as a whole, and a script
of the browser unpacks it. Two things are rounded: positions and normals of shapes to 16 bits, and values of a measurement to 8 binary
digits, by at most 0.2 %. SMALL.html shows nothing without JavaScript.
"""
import array
import base64
import json
import os
import re
import sys
import zlib

HALF_BITS = 2  # binary digits by which values of the measurement, 16-bit floats, are shortened
DATA = re.compile(r'(?<=<script id="data" type="application/json">).*?(?=</script>)', re.S)
SHADER = re.compile(r"(?<=<pre id='glsl-)(\d+'>)(.*?)(?=</pre>)", re.S)
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
// The page is compressed; the numbers of shapes and of the measurement are stored as differences.
(async () => {
  const bytes = Uint8Array.from(atob(document.getElementById("packed").textContent), (c) => c.charCodeAt(0));
  const all = new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer());
  let at = all.indexOf(0);
  const { html, tail, parts } = JSON.parse(new TextDecoder().decode(all.subarray(0, at++)));
  const read = ({ kind, stride, count, scale }) => {
    const numbers = new Uint16Array(count);
    for (let i = 0; i < count; ++i) {
      const folded = all[at + i] | all[at + count + i] << 8;
      numbers[i] = (folded >> 1 ^ -(folded & 1)) + (i < stride ? 0 : numbers[i - stride]);
    }
    at += 2 * count;
    if (kind === "triangles") return numbers;
    if (kind === "vertices") return Float32Array.from(new Int16Array(numbers.buffer), (x, i) => x / 32767 * (i % 6 < 3 ? scale : 1));
    // The fourth number of a texel is 1 where it was measured; others are black.
    const texels = new Uint16Array(count / 3 * 4);
    for (let i = 0, k = 0; k < count; i += 4, k += 3) {
      for (let c = 0; c < 3; ++c) texels[i + c] = numbers[k + c] << scale;
      if (numbers[k] || numbers[k + 1] || numbers[k + 2]) texels[i + 3] = 0x3c00;
    }
    return texels;
  };
  const text = (numbers) => {
    let binary = "";
    for (const byte of new Uint8Array(numbers.buffer)) binary += String.fromCharCode(byte);
    return btoa(binary);
  };
  const texts = parts.map((part) => text(read(part)));
  document.open();
  document.write(html.replaceAll("@tail@", () => tail).replace(/@part(\\d+)@/g, (_, k) => texts[k]));
  document.close();
})();
</script>
</body>
</html>
"""


def differences(numbers, stride):
    """Numbers of 16 bits as differences to those `stride` before, with the sign as the lowest bit; all low bytes precede the high ones."""
    low, high = bytearray(len(numbers)), bytearray(len(numbers))
    for i, number in enumerate(numbers):
        apart = (number - (numbers[i - stride] if i >= stride else 0)) & 0xFFFF
        folded = 2 * apart if apart < 0x8000 else 2 * (0xFFFF - apart) + 1
        low[i], high[i] = folded & 255, folded >> 8
    return bytes(low + high)


def parts_of(data):
    """Takes what is large out of the data: where it was, what it is, and its numbers."""
    for mesh in data["meshes"].values():
        if mesh["index_bytes"] == 2:
            yield mesh, "triangles", {"kind": "triangles", "stride": 3}, array.array("H", base64.b64decode(mesh["triangles"]))
        vertices = array.array("f", base64.b64decode(mesh["vertices"]))
        scale = max(abs(x) for i, x in enumerate(vertices) if i % 6 < 3)
        rounded = [round(32767 * (x / scale if i % 6 < 3 else x)) & 0xFFFF for i, x in enumerate(vertices)]
        yield mesh, "vertices", {"kind": "vertices", "stride": 6, "scale": scale}, rounded
    for material in data["materials"]:
        for texture in (material or {}).get("textures", []):
            if texture["sampler"] == "merl_table":
                texels, rounded = array.array("H", base64.b64decode(texture["texels"])), []
                for i in range(0, len(texels), 4):
                    colour = [x + (1 << HALF_BITS >> 1) >> HALF_BITS for x in texels[i:i + 3]]
                    rounded += [1, 0, 0] if texels[i + 3] and not any(colour) else colour  # black; unmeasured texels have three zeros
                width, height, _ = texture["size"]
                yield texture, "texels", {"kind": "texels", "stride": 3 * width * height, "scale": HALF_BITS}, rounded


def packed(page):
    """The text of a smaller page."""
    data = json.loads(DATA.search(page)[0])
    parts, binary = [], b""
    for k, (where, name, part, numbers) in enumerate(parts_of(data)):
        where[name] = f"@part{k}@"
        parts.append({**part, "count": len(numbers)})
        binary += differences(numbers, part["stride"])
    page = DATA.sub(lambda _: json.dumps(data, separators=(",", ":")).replace("<", "\\u003c"), page)
    shaders = [found[2] for found in SHADER.finditer(page)]
    tail = os.path.commonprefix([shader[::-1] for shader in shaders])[::-1] if len(shaders) > 1 else ""
    page = SHADER.sub(lambda found: found[1] + found[2].removesuffix(tail) + ("@tail@" if tail else ""), page)
    head = json.dumps({"html": page, "tail": tail, "parts": parts}, ensure_ascii=False, separators=(",", ":")).encode()
    text = base64.b64encode(zlib.compress(head + b"\0" + binary, 9)).decode()
    return PAGE.replace("TITLE", re.search(r"<title>(.*?)</title>", page)[1]).replace("PACKED", text)


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        small = packed(file.read())
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write(small)
