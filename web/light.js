// Environments: their files, their textures, and pictures that converge under them.
// A function of its own text, which the page gives to its worker too.
"use strict";
function lighting() {
"use strict";
const k_most_bytes = 2 ** 27, k_most_width = 4096;

// ---- Files -------------------------------------------------------------------------------------------------------

const fail = (what, expected, found) => { throw new Error(`${what}: expected ${expected}, found ${found}`); };

// Colours from mantissas and an exponent, four bytes a texel.
function decoded(rgbe) {
  const texels = new Float32Array(rgbe.length / 4 * 3), scales = Float64Array.from({ length: 256 }, (_, e) => e ? 2 ** (e - 136) : 0);
  for (let i = 0, k = 0; i < rgbe.length; i += 4) {
    const scale = scales[rgbe[i + 3]];
    texels[k++] = rgbe[i] * scale, texels[k++] = rgbe[i + 1] * scale, texels[k++] = rgbe[i + 2] * scale;
  }
  return texels;
}

// An image of a Radiance file: RGBE, flat or in runs, rows from the top and columns from the left.
function read_hdr(bytes) {
  const text = new TextDecoder("latin1").decode(bytes.subarray(0, 65536)), end = text.indexOf("\n\n");
  if (!text.startsWith("#?")) fail("first bytes", "'#?' of a Radiance file", JSON.stringify(text.slice(0, 8)));
  if (end < 0) fail("header", "an empty line that ends it", "none");
  const format = /\nFORMAT=(.*)/.exec(text.slice(0, end));
  if (format && format[1].trim() !== "32-bit_rle_rgbe") fail("FORMAT", "32-bit_rle_rgbe", format[1]);
  const line = text.slice(end + 2, text.indexOf("\n", end + 2)), size = /^-Y (\d+) \+X (\d+)$/.exec(line.trim());
  if (!size) fail("resolution", "'-Y HEIGHT +X WIDTH'", JSON.stringify(line.slice(0, 40)));
  const height = Number(size[1]), width = Number(size[2]);
  let at = end + 3 + line.length;
  // A run of 127 texels takes two bytes in each of the four channels.
  if (!width || !height || width * height > (bytes.length - at) * 16)
    fail("resolution", `texels that ${bytes.length - at} bytes can hold`, `${width} x ${height}`);
  const rgbe = new Uint8Array(4 * width * height);
  for (let y = 0; y < height; ++y) {
    const ended = () => fail(`row ${y}, byte ${at}`, `${width} texels`, "fewer, or a longer run");
    const row = rgbe.subarray(4 * width * y, 4 * width * (y + 1));
    const in_runs = width >= 8 && width < 32768 && bytes[at] === 2 && bytes[at + 1] === 2 &&
      bytes[at + 2] === width >> 8 && bytes[at + 3] === (width & 255);
    if (!in_runs) {
      if (at + row.length > bytes.length) ended();
      row.set(bytes.subarray(at, at += row.length));
      continue;
    }
    at += 4;
    for (let c = 0; c < 4; ++c)
      for (let x = 0; x < width;) {
        const count = bytes[at++], length = count > 128 ? count - 128 : count;
        if (!length || length > width - x || at + (count > 128 ? 1 : length) > bytes.length) ended();
        for (let i = 0; i < length; ++i) row[4 * x++ + c] = bytes[count > 128 ? at : at + i];
        at += count > 128 ? 1 : length;
      }
  }
  return { width, height, texels: decoded(rgbe) };
}

function half_to_number(bits) {
  const exponent = bits >> 10 & 31, mantissa = bits & 1023, sign = bits & 32768 ? -1 : 1;
  if (exponent === 31) return mantissa ? NaN : sign * Infinity;
  return sign * (exponent ? 2 ** (exponent - 15) * (1 + mantissa / 1024) : mantissa * 2 ** -24);
}

// What a zlib stream holds.
const inflated = async (bytes) => new Uint8Array(await new Response(
  new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer());

// An image of an OpenEXR file of scanlines, uncompressed or by ZIP or ZIPS, with channels R, G and B of halves or floats.
async function read_exr(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let at = 8;
  const text = () => {
    let word = "";
    for (; bytes[at]; ++at) word += String.fromCharCode(bytes[at]);
    ++at;
    return word;
  };
  if (view.getUint32(4, true) !== 2) fail("kind of OpenEXR file", "one part of scanlines", "tiles or several parts");
  const header = {};
  for (let name; (name = text());) {
    text(); // its type
    const size = view.getUint32(at, true);
    header[name] = at += 4;
    at += size;
  }
  const table = at, channels = [], [left, top, right, bottom] = [0, 4, 8, 12].map((i) => view.getInt32(header.dataWindow + i, true));
  const width = right - left + 1, height = bottom - top + 1, compression = bytes[header.compression];
  if (![0, 2, 3].includes(compression)) fail("compression", "none, ZIPS or ZIP", `number ${compression}`);
  for (at = header.channels; bytes[at]; at += 16) {
    const name = text(), type = view.getUint32(at, true);
    channels.push({ name, size: type === 1 ? 2 : 4, type });
    if (name.length === 1 && "RGB".includes(name) && type === 0) fail(`channel ${name}`, "halves or floats", "integers");
  }
  for (const name of "RGB") if (!channels.some((of) => of.name === name)) fail("channels", "R, G and B", channels.map((of) => of.name).join(" "));
  const of_row = width * channels.reduce((sum, { size }) => sum + size, 0), rows = compression === 3 ? 16 : 1;
  if (width < 1 || height < 1 || width * height > 2 ** 26) fail("size", "at most 67108864 texels", `${width} x ${height}`);
  const texels = new Float32Array(3 * width * height);
  for (let block = 0; block * rows < height; ++block) {
    at = Number(view.getBigUint64(table + 8 * block, true));
    const first = view.getInt32(at, true) - top, size = view.getUint32(at + 4, true), count = Math.min(rows, height - first);
    let raw = bytes.subarray(at + 8, at + 8 + size);
    if (compression && size < count * of_row) {
      const packed = await inflated(raw), half = (packed.length + 1) >> 1;
      for (let i = 1; i < packed.length; ++i) packed[i] = packed[i] + packed[i - 1] - 128;
      raw = packed.map((_, i) => packed[i & 1 ? half + (i >> 1) : i >> 1]);
    }
    if (raw.length < count * of_row) fail(`rows from ${first}, byte ${at}`, `${count * of_row} bytes`, raw.length);
    const numbers = new DataView(raw.buffer, raw.byteOffset, raw.byteLength);
    for (let y = first, from = 0; y < first + count; ++y)
      for (const { name, size: bytes_each, type } of channels) {
        const c = name.length === 1 ? "RGB".indexOf(name) : -1;
        for (let x = 0; x < width; ++x, from += bytes_each)
          if (c >= 0)
            texels[3 * (y * width + x) + c] = type === 1 ? half_to_number(numbers.getUint16(from, true)) : numbers.getFloat32(from, true);
      }
  }
  return { width, height, texels };
}

// The image of a file that a user gives. Throws what is wrong with it, after its name.
async function read_file(file) {
  try {
    if (file.size > k_most_bytes) fail("size", `at most ${k_most_bytes / 2 ** 20} MB`, `${Math.ceil(file.size / 2 ** 20)} MB`);
    const bytes = new Uint8Array(await file.arrayBuffer());
    const is_exr = bytes[0] === 0x76 && bytes[1] === 0x2f && bytes[2] === 0x31 && bytes[3] === 1;
    return is_exr ? await read_exr(bytes) : read_hdr(bytes);
  } catch (error) {
    const what = error instanceof RangeError || error instanceof TypeError ? "the file ends early, or is damaged" : error.message;
    throw new Error(`${file.name}: ${what}`);
  }
}

// ---- Textures ----------------------------------------------------------------------------------------------------

// Of a texel of each row, but for a factor that all have.
const solid_angles = (height) =>
  Float64Array.from({ length: height }, (_, y) => Math.cos(Math.PI * y / height) - Math.cos(Math.PI * (y + 1) / height));

// With half the width and height: means over the solid angle that a texel covers.
function halved({ width, height, texels }) {
  const half = { width: Math.max(width >> 1, 1), height: Math.max(height >> 1, 1) };
  half.texels = new Float32Array(3 * half.width * half.height);
  const first = (i, from, to) => Math.floor(i * from / to), end = (i, from, to) => Math.ceil((i + 1) * from / to);
  const weights = solid_angles(height);
  for (let y = 0, k = 0; y < half.height; ++y) {
    const top = first(y, height, half.height), bottom = end(y, height, half.height);
    for (let x = 0; x < half.width; ++x) {
      const left = first(x, width, half.width), right = end(x, width, half.width);
      let weight = 0, r = 0, g = 0, b = 0;
      for (let row = top; row < bottom; ++row) {
        const of_row = weights[row];
        for (let i = 3 * (row * width + left); i < 3 * (row * width + right); i += 3) {
          r += of_row * texels[i], g += of_row * texels[i + 1], b += of_row * texels[i + 2];
          weight += of_row;
        }
      }
      half.texels[k++] = r / weight, half.texels[k++] = g / weight, half.texels[k++] = b / weight;
    }
  }
  return half;
}

// The running sums that the shader draws directions by, as class Environment of the program has them.
function running_sums({ width, height, texels }) {
  const columns = new Float32Array((width + 1) * height), rows = new Float64Array(height + 1), weights = solid_angles(height);
  // How bright the texels of a row are, blurred along it.
  const along = (y) => {
    const bright = new Float64Array(width), blurred = new Float64Array(width);
    for (let x = 0, i = 3 * Math.min(Math.max(y, 0), height - 1) * width; x < width; ++x, i += 3)
      bright[x] = 0.2126 * texels[i] + 0.7152 * texels[i + 1] + 0.0722 * texels[i + 2];
    for (let x = 0; x < width; ++x)
      blurred[x] = 0.75 * bright[x] + 0.125 * (bright[x ? x - 1 : width - 1] + bright[x + 1 < width ? x + 1 : 0]);
    return blurred;
  };
  for (let y = 0, above = along(-1), here = along(0), below; y < height; ++y, above = here, here = below) {
    const running = new Float64Array(width + 1);
    below = along(y + 1);
    for (let x = 0; x < width; ++x) running[x + 1] = running[x] + 0.75 * here[x] + 0.125 * (above[x] + below[x]);
    rows[y + 1] = rows[y] + running[width] * weights[y];
    for (let x = 0; x <= width; ++x) columns[y * (width + 1) + x] = running[width] ? running[x] / running[width] : 0;
  }
  return { columns, rows: Float32Array.from(rows, (sum) => rows[height] ? sum / rows[height] : 0) };
}

function new_texture(gl, width, height, format, filter, numbers) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, filter);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, filter);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl[format], width, height, 0, format === "R32F" ? gl.RED : gl.RGBA, gl.FLOAT, numbers);
  return texture;
}

function new_environment(gl, image) {
  for (let i = 0; i < image.texels.length; ++i) if (!(image.texels[i] >= 0 && image.texels[i] < Infinity)) image.texels[i] = 0;
  while (Math.max(image.width, image.height) > Math.min(k_most_width, gl.getParameter(gl.MAX_TEXTURE_SIZE) - 1)) image = halved(image);
  const { width, height } = image, sums = running_sums(image);
  let most = 65504; // the largest half float
  for (let i = 0; i < image.texels.length; ++i) most = Math.max(most, image.texels[i]);
  const scale = most / 65504;
  const radiance = new_texture(gl, width, height, "RGBA16F", gl.LINEAR, null);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.REPEAT);
  for (let level = 0, of = image; ; ++level, of = halved(of)) {
    const texels = new Float32Array(4 * of.width * of.height);
    for (let i = 0; i < of.width * of.height; ++i)
      for (let c = 0; c < 3; ++c) texels[4 * i + c] = of.texels[3 * i + c] / scale;
    gl.texImage2D(gl.TEXTURE_2D, level, gl.RGBA16F, of.width, of.height, 0, gl.RGBA, gl.FLOAT, texels);
    if (of.width === 1 && of.height === 1) break;
  }
  return { scale, textures: {
    environment: radiance,
    environment_columns: new_texture(gl, width + 1, height, "R32F", gl.NEAREST, sums.columns),
    environment_rows: new_texture(gl, height + 1, 1, "R32F", gl.NEAREST, sums.rows),
  } };
}

// ---- Pictures that converge --------------------------------------------------------------------------------------

// A framebuffer of `count` pictures of floats; with depths for surfaces.
function new_buffer(gl, width, height, count, with_depth) {
  const buffer = { width, height, framebuffer: gl.createFramebuffer(), textures: [] };
  gl.bindFramebuffer(gl.FRAMEBUFFER, buffer.framebuffer);
  for (let i = 0; i < count; ++i) {
    buffer.textures.push(new_texture(gl, width, height, "RGBA32F", gl.NEAREST, null));
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, buffer.textures[i], 0);
  }
  gl.drawBuffers(buffer.textures.map((_, i) => gl.COLOR_ATTACHMENT0 + i));
  if (with_depth) {
    buffer.depth = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, buffer.depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, buffer.depth);
  }
  return buffer;
}
function delete_buffer(gl, { framebuffer, textures, depth }) {
  gl.deleteFramebuffer(framebuffer);
  for (const texture of textures) gl.deleteTexture(texture);
  if (depth) gl.deleteRenderbuffer(depth);
}

// Where in its pixels sample i is taken, from their centres.
const k_plastic = 1.3247179572447460;
const shift_of = (i) => [1 / k_plastic, 1 / k_plastic ** 2].map((step) => (i + 1) * step % 1 - 0.5);

// The exposure that takes nine tenths of the object's pixels to at most `knee`; `visible` has the surface at 2 x 2 points of each.
function exposure_of(gl, { width, height, framebuffer }, visible, knee) {
  const pixels = new Float32Array(4 * width * height), surface = new Float32Array(16 * width * height), bright = [];
  gl.bindFramebuffer(gl.FRAMEBUFFER, visible.framebuffer);
  gl.readPixels(0, 0, 2 * width, 2 * height, gl.RGBA, gl.FLOAT, surface);
  gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, pixels);
  for (let y = 0, i = 0; y < height; ++y)
    for (let x = 0; x < width; ++x, i += 4)
      if (surface[4 * (2 * y * 2 * width + 2 * x) + 3] > 0) bright.push(Math.max(pixels[i], pixels[i + 1], pixels[i + 2]));
  const most = Float32Array.from(bright).sort()[Math.floor(0.9 * (bright.length - 1))];
  return most > 0 ? knee / most : 1;
}

// The azimuth [rad] by which an environment is turned so that most of its light comes from the left of the viewer, 40 degrees
// off: a vector mean over the upper half, of cubes, so that lamps count for more than walls.
function facing({ width, height, texels }) {
  let x = 0, z = 0;
  const weights = solid_angles(height), phi = (column) => ((column + 0.5) / width - 0.5) * 2 * Math.PI;
  const sines = Float64Array.from({ length: width }, (_, column) => Math.sin(phi(column)));
  const cosines = Float64Array.from({ length: width }, (_, column) => Math.cos(phi(column)));
  for (let row = 0, i = 0; row < height; ++row)
    for (let column = 0; column < width; ++column, i += 3) {
      const bright = Math.min(0.2126 * texels[i] + 0.7152 * texels[i + 1] + 0.0722 * texels[i + 2], 100);
      const weight = bright * bright * bright * weights[row];
      x += weight * sines[column], z -= weight * cosines[column];
    }
  const now = Math.atan2(x, z), wanted = -40 * Math.PI / 180; // azimuths from +z, towards the viewer, to +x, the right
  return Number.isFinite(now) ? wanted - now : 0;
}

return { read_file, decoded, new_environment, new_buffer, delete_buffer, shift_of, exposure_of, facing };
}
const light = lighting();
