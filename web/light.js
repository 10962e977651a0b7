// Environments: reading their files, their textures, and the accumulation of pictures under them.
// The text of this function is self-contained, since the page passes it to its worker too.
"use strict";
function lighting() {
"use strict";
const k_max_bytes = 2 ** 27, k_max_width = 4096;

// ---- Files -------------------------------------------------------------------------------------------------------

const fail = (what, expected, found) => { throw new Error(`${what}: expected ${expected}, found ${found}`); };

// The kinds of files that have neither light nor a material, as "a PNG picture", by their first bytes.
const k_kinds = [[/^$/, "an empty file"], [/^\x89PNG/, "a PNG picture"], [/^\xff\xd8\xff/, "a JPEG picture"], [/^GIF8/, "a GIF picture"],
  [/^RIFF....WEBP/s, "a WebP picture"], [/^(II\*\0|MM\0\*)/, "a TIFF picture"], [/^BM....\0\0\0\0/s, "a BMP picture"],
  [/^8BPS/, "a Photoshop picture"], [/^....ftyp(avif|hei[cfx]|mif1)/s, "a HEIF or AVIF picture"], [/^....ftyp|^\x1aE\xdf\xa3/s, "a video"],
  [/^\s*(<\?xml[^>]*>\s*)?<svg\b/, "an SVG picture"], [/^%PDF/, "a PDF document"], [/^PK\x03\x04/, "a ZIP archive"],
  [/^(7z\xbc\xaf|Rar!|\x1f\x8b|\x28\xb5\x2f\xfd)/, "a compressed file"], [/^BLENDER/, "a Blender file"], [/^glTF/, "a glTF scene"],
  [/^Kaydara FBX/, "an FBX scene"], [/^(PXR-USDC|#usda)/, "a USD scene"], [/^(ID3|OggS|fLaC|RIFF....WAVE)/s, "a sound"],
  [/^\s*(<!--.*?-->\s*)*<(!doctype html|html)\b/is, "a web page"], [/^\s*[[{]/, "a JSON file"]];
const first_text = (bytes) => String.fromCharCode(...bytes.subarray(0, 4096));
const kind_of = (bytes) => k_kinds.find(([pattern]) => pattern.test(first_text(bytes)))?.[1] ?? null;
// True if a file is meant as an environment.
const is_environment = (name, bytes) => /\.(hdr|exr)$/i.test(name) || /^(#\?(RADIANCE|RGBE)|\x76\x2f\x31\x01)/.test(first_text(bytes));

// Decodes RGBE, mantissas and an exponent in four bytes per texel, to linear colours.
function decode_rgbe(rgbe) {
  const texels = new Float32Array(rgbe.length / 4 * 3), scales = Float64Array.from({ length: 256 }, (_, e) => e ? 2 ** (e - 136) : 0);
  for (let i = 0, k = 0; i < rgbe.length; i += 4) {
    const scale = scales[rgbe[i + 3]];
    texels[k++] = rgbe[i] * scale, texels[k++] = rgbe[i + 1] * scale, texels[k++] = rgbe[i + 2] * scale;
  }
  return texels;
}
// Reads a Radiance file: RGBE, flat or run-length encoded, with rows from the top and columns from the left.
function read_hdr(bytes) {
  const text = new TextDecoder("latin1").decode(bytes.subarray(0, 65536)), end = text.indexOf("\n\n");
  if (!text.startsWith("#?")) fail("first bytes", "'#?' of a Radiance file", JSON.stringify(text.slice(0, 8)));
  if (end < 0) fail("header", "an empty line that ends it", "none");
  const format = /\nFORMAT=(.*)/.exec(text.slice(0, end));
  if (format && format[1].trim() !== "32-bit_rle_rgbe") fail("FORMAT", "32-bit_rle_rgbe", format[1]);
  const line = text.slice(end + 2, text.indexOf("\n", end + 2)), size = /^-Y (\d+) \+X (\d+)$/.exec(line.trim());
  if (!size) fail("resolution", "'-Y HEIGHT +X WIDTH'", JSON.stringify(line.slice(0, 40)));
  const height = Number(size[1]), width = Number(size[2]);
  let offset = end + 3 + line.length;
  // The densest encoding is a run of 127 texels in two bytes of each of the four channels.
  if (!width || !height || width * height > (bytes.length - offset) * 16)
    fail("resolution", `texels that ${bytes.length - offset} bytes can hold`, `${width} x ${height}`);
  const rgbe = new Uint8Array(4 * width * height);
  for (let y = 0; y < height; ++y) {
    const fail_row = () => fail(`row ${y}, byte ${offset}`, `${width} texels`, "fewer, or a longer run");
    const row = rgbe.subarray(4 * width * y, 4 * width * (y + 1));
    const in_runs = width >= 8 && width < 32768 && bytes[offset] === 2 && bytes[offset + 1] === 2 &&
      bytes[offset + 2] === width >> 8 && bytes[offset + 3] === (width & 255);
    if (!in_runs) {
      if (offset + row.length > bytes.length) fail_row();
      row.set(bytes.subarray(offset, offset += row.length));
      continue;
    }
    offset += 4;
    for (let c = 0; c < 4; ++c)
      for (let x = 0; x < width;) {
        const count = bytes[offset++], length = count > 128 ? count - 128 : count;
        if (!length || length > width - x || offset + (count > 128 ? 1 : length) > bytes.length) fail_row();
        for (let i = 0; i < length; ++i) row[4 * x++ + c] = bytes[count > 128 ? offset : offset + i];
        offset += count > 128 ? 1 : length;
      }
  }
  return { width, height, texels: decode_rgbe(rgbe) };
}
function half_to_number(bits) {
  const exponent = bits >> 10 & 31, mantissa = bits & 1023, sign = bits & 32768 ? -1 : 1;
  if (exponent === 31) return mantissa ? NaN : sign * Infinity;
  return sign * (exponent ? 2 ** (exponent - 15) * (1 + mantissa / 1024) : mantissa * 2 ** -24);
}
// Decompresses a zlib stream.
const inflate = async (bytes) => new Uint8Array(await new Response(
  new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer());

// Reads an OpenEXR file of scanlines, uncompressed or ZIP or ZIPS compressed, with channels R, G and B of halves or floats.
async function read_exr(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let offset = 8;
  const read_text = () => {
    let word = "";
    for (; bytes[offset]; ++offset) word += String.fromCharCode(bytes[offset]);
    ++offset;
    return word;
  };
  if (view.getUint32(4, true) !== 2) fail("kind of OpenEXR file", "one part of scanlines", "tiles or several parts");
  const header = {};
  for (let name; (name = read_text());) {
    read_text(); // the attribute's type
    const size = view.getUint32(offset, true);
    header[name] = offset += 4;
    offset += size;
  }
  const table = offset, channels = [], [left, top, right, bottom] = [0, 4, 8, 12].map((i) => view.getInt32(header.dataWindow + i, true));
  const width = right - left + 1, height = bottom - top + 1, compression = bytes[header.compression];
  if (![0, 2, 3].includes(compression)) fail("compression", "none, ZIPS or ZIP", `number ${compression}`);
  for (offset = header.channels; bytes[offset]; offset += 16) {
    const name = read_text(), type = view.getUint32(offset, true);
    channels.push({ name, size: type === 1 ? 2 : 4, type });
    if (name.length === 1 && "RGB".includes(name) && type === 0) fail(`channel ${name}`, "halves or floats", "integers");
  }
  const names = channels.map(({ name }) => name);
  for (const name of "RGB") if (!names.includes(name)) fail("channels", "R, G and B", names.join(" "));
  const row_bytes = width * channels.reduce((sum, { size }) => sum + size, 0), rows = compression === 3 ? 16 : 1;
  if (width < 1 || height < 1 || width * height > 2 ** 26) fail("size", "at most 67108864 texels", `${width} x ${height}`);
  const texels = new Float32Array(3 * width * height);
  for (let block = 0; block * rows < height; ++block) {
    offset = Number(view.getBigUint64(table + 8 * block, true));
    const first = view.getInt32(offset, true) - top, size = view.getUint32(offset + 4, true), count = Math.min(rows, height - first);
    let raw = bytes.subarray(offset + 8, offset + 8 + size);
    if (compression && size < count * row_bytes) {
      const packed = await inflate(raw), half = (packed.length + 1) >> 1;
      for (let i = 1; i < packed.length; ++i) packed[i] = packed[i] + packed[i - 1] - 128;
      raw = packed.map((_, i) => packed[i & 1 ? half + (i >> 1) : i >> 1]);
    }
    if (raw.length < count * row_bytes) fail(`rows from ${first}, byte ${offset}`, `${count * row_bytes} bytes`, raw.length);
    const numbers = new DataView(raw.buffer, raw.byteOffset, raw.byteLength);
    for (let y = first, position = 0; y < first + count; ++y)
      for (const { name, size: bytes_each, type } of channels) {
        const c = name.length === 1 ? "RGB".indexOf(name) : -1;
        for (let x = 0; x < width; ++x, position += bytes_each)
          if (c >= 0)
            texels[3 * (y * width + x) + c] = type === 1 ? half_to_number(numbers.getUint16(position, true)) : numbers.getFloat32(position, true);
      }
  }
  return { width, height, texels };
}
// Reads the image in a user's file. Throws an error that begins with the file's name.
async function read_file(file) {
  try {
    if (file.size > k_max_bytes) fail("size", `at most ${k_max_bytes / 2 ** 20} MB`, `${Math.ceil(file.size / 2 ** 20)} MB`);
    const bytes = new Uint8Array(await file.arrayBuffer()), kind = kind_of(bytes);
    if (kind) throw new Error(`this is ${kind}; open an .hdr or .exr file`);
    const is_exr = bytes[0] === 0x76 && bytes[1] === 0x2f && bytes[2] === 0x31 && bytes[3] === 1;
    return is_exr ? await read_exr(bytes) : read_hdr(bytes);
  } catch (error) {
    const what = error instanceof RangeError || error instanceof TypeError ? "the file ends early, or is damaged" : error.message;
    throw new Error(`${file.name}: ${what}`);
  }
}

// ---- A photographer's light --------------------------------------------------------------------------------------

// A soft box, a strip light behind the object on the opposite side, and walls that are brighter above. Soft edges need few texels.
function soft_box() {
  const width = 256, height = 128, texels = new Float32Array(3 * width * height), degree = Math.PI / 180;
  // Azimuth from the viewer to the right, elevation, half the width and height, and radiance.
  const lamps = [[-40, 42, 17, 13, 12], [140, 25, 5, 28, 7]].map((lamp) => lamp.map((x, i) => i < 4 ? x * degree : x));
  const soft_step = (x) => { const t = Math.min(Math.max(0.5 + x / (8 * degree), 0), 1); return t * t * (3 - 2 * t); };
  for (let y = 0, i = 0; y < height; ++y)
    for (let x = 0; x < width; ++x, i += 3) {
      const phi = ((x + 0.5) / width - 0.5) * 2 * Math.PI, theta = (y + 0.5) / height * Math.PI;
      const azimuth = Math.PI - phi; // of the direction (sin θ sin φ, cos θ, −sin θ cos φ)
      let radiance = 0.32 + 0.26 * Math.cos(theta);
      for (const [towards, elevation, half_width, half_height, bright] of lamps) {
        const turn = Math.atan2(Math.sin(azimuth - towards), Math.cos(azimuth - towards)) * Math.sin(theta);
        radiance += bright * soft_step(half_width - Math.abs(turn)) * soft_step(half_height - Math.abs(Math.PI / 2 - theta - elevation));
      }
      texels.fill(radiance, i, i + 3);
    }
  return { width, height, texels };
}

// ---- Textures ----------------------------------------------------------------------------------------------------

// The relative solid angle of a texel in each row.
const solid_angles = (height) =>
  Float64Array.from({ length: height }, (_, y) => Math.cos(Math.PI * y / height) - Math.cos(Math.PI * (y + 1) / height));

// The image at half the width and height. Each texel is the mean over its solid angle.
function halve({ width, height, texels }) {
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
        const row_weight = weights[row];
        for (let i = 3 * (row * width + left); i < 3 * (row * width + right); i += 3) {
          r += row_weight * texels[i], g += row_weight * texels[i + 1], b += row_weight * texels[i + 2];
          weight += row_weight;
        }
      }
      half.texels[k++] = r / weight, half.texels[k++] = g / weight, half.texels[k++] = b / weight;
    }
  }
  return half;
}
// The cumulative distributions from which the shader samples directions, the same as in the program's class Environment.
function running_sums({ width, height, texels }) {
  const columns = new Float32Array((width + 1) * height), rows = new Float64Array(height + 1), weights = solid_angles(height);
  // The luminance of a row, blurred along it.
  const blurred_row = (y) => {
    const luminance = new Float64Array(width), blurred = new Float64Array(width);
    for (let x = 0, i = 3 * Math.min(Math.max(y, 0), height - 1) * width; x < width; ++x, i += 3)
      luminance[x] = 0.2126 * texels[i] + 0.7152 * texels[i + 1] + 0.0722 * texels[i + 2];
    for (let x = 0; x < width; ++x)
      blurred[x] = 0.75 * luminance[x] + 0.125 * (luminance[x ? x - 1 : width - 1] + luminance[x + 1 < width ? x + 1 : 0]);
    return blurred;
  };
  for (let y = 0, above = blurred_row(-1), here = blurred_row(0), below; y < height; ++y, above = here, here = below) {
    const running = new Float64Array(width + 1);
    below = blurred_row(y + 1);
    for (let x = 0; x < width; ++x) running[x + 1] = running[x] + 0.75 * here[x] + 0.125 * (above[x] + below[x]);
    rows[y + 1] = rows[y] + running[width] * weights[y];
    for (let x = 0; x <= width; ++x) columns[y * (width + 1) + x] = running[width] ? running[x] / running[width] : 0;
  }
  return { columns, rows: Float32Array.from(rows, (sum) => rows[height] ? sum / rows[height] : 0) };
}
// A texture without content, which stays bound.
function new_empty_texture(gl, bind_point, filter) {
  const texture = gl.createTexture();
  gl.bindTexture(bind_point, texture);
  for (const size of ["MIN", "MAG"]) gl.texParameteri(bind_point, gl[`TEXTURE_${size}_FILTER`], filter);
  for (const axis of ["S", "T", "R"]) gl.texParameteri(bind_point, gl[`TEXTURE_WRAP_${axis}`], gl.CLAMP_TO_EDGE);
  return texture;
}
function new_texture(gl, width, height, format, filter, numbers) {
  const texture = new_empty_texture(gl, gl.TEXTURE_2D, filter);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl[format], width, height, 0, format === "R32F" ? gl.RED : gl.RGBA, gl.FLOAT, numbers);
  return texture;
}
function new_environment(gl, image) {
  for (let i = 0; i < image.texels.length; ++i) if (!(image.texels[i] >= 0 && image.texels[i] < Infinity)) image.texels[i] = 0;
  while (Math.max(image.width, image.height) > Math.min(k_max_width, gl.getParameter(gl.MAX_TEXTURE_SIZE) - 1)) image = halve(image);
  const { width, height } = image, sums = running_sums(image);
  let largest = 65504; // the largest half float
  for (let i = 0; i < image.texels.length; ++i) largest = Math.max(largest, image.texels[i]);
  const scale = largest / 65504;
  const radiance = new_texture(gl, width, height, "RGBA16F", gl.LINEAR, null);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.REPEAT);
  for (let level = 0, level_image = image; ; ++level, level_image = halve(level_image)) {
    const texels = new Float32Array(4 * level_image.width * level_image.height);
    for (let i = 0; i < level_image.width * level_image.height; ++i)
      for (let c = 0; c < 3; ++c) texels[4 * i + c] = level_image.texels[3 * i + c] / scale;
    gl.texImage2D(gl.TEXTURE_2D, level, gl.RGBA16F, level_image.width, level_image.height, 0, gl.RGBA, gl.FLOAT, texels);
    if (level_image.width === 1 && level_image.height === 1) break;
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
// The offset of sample i from the centres of its pixels.
const k_plastic = 1.3247179572447460;
const shift_of = (i) => [1 / k_plastic, 1 / k_plastic ** 2].map((step) => (i + 1) * step % 1 - 0.5);

// The exposure at which 90 % of the object's pixels are at most `knee`. `visible` has the surface at 2 x 2 points of each pixel.
function exposure_of(gl, { width, height, framebuffer }, visible, knee) {
  const pixels = new Float32Array(4 * width * height), surface = new Float32Array(16 * width * height), brightness = [];
  gl.bindFramebuffer(gl.FRAMEBUFFER, visible.framebuffer);
  gl.readPixels(0, 0, 2 * width, 2 * height, gl.RGBA, gl.FLOAT, surface);
  gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, pixels);
  for (let y = 0, i = 0; y < height; ++y)
    for (let x = 0; x < width; ++x, i += 4)
      if (surface[4 * (2 * y * 2 * width + 2 * x) + 3] > 0) brightness.push(Math.max(pixels[i], pixels[i + 1], pixels[i + 2]));
  const percentile = Float32Array.from(brightness).sort()[Math.floor(0.9 * (brightness.length - 1))];
  return percentile > 0 ? knee / percentile : 1;
}
// The rotation [rad] of an environment about the vertical that puts most of its light 40 degrees to the left of the viewer. The
// direction of the light is a vector mean, weighted with the cube of the luminance, so that lamps count for more than walls.
function facing_azimuth({ width, height, texels }) {
  let x = 0, z = 0;
  const weights = solid_angles(height), phi = (column) => ((column + 0.5) / width - 0.5) * 2 * Math.PI;
  const sines = Float64Array.from({ length: width }, (_, column) => Math.sin(phi(column)));
  const cosines = Float64Array.from({ length: width }, (_, column) => Math.cos(phi(column)));
  for (let row = 0, i = 0; row < height; ++row)
    for (let column = 0; column < width; ++column, i += 3) {
      const luminance = Math.min(0.2126 * texels[i] + 0.7152 * texels[i + 1] + 0.0722 * texels[i + 2], 100);
      const weight = luminance * luminance * luminance * weights[row];
      x += weight * sines[column], z -= weight * cosines[column];
    }
  const current = Math.atan2(x, z), target = -40 * Math.PI / 180; // azimuths from +z, towards the viewer, to +x, the right
  return Number.isFinite(current) ? target - current : 0;
}

return { kind_of, is_environment, read_file, decode_rgbe, soft_box, new_empty_texture, new_environment, new_buffer, delete_buffer, shift_of,
  exposure_of, facing_azimuth };
}
const light = lighting();
