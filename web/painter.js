// Draws materials with their shaders, in a worker if the browser permits, so that the page never waits for a picture.
// The text of this function is self-contained, since the page passes it to the worker. It receives messages { kind,
// .. }:
//   common       `data`, what all pictures share; forgets everything else
//   material     `index`, `material` (null: none) with the fragment shader `text`; or its JSON as `bytes`; if `is_edited`,
//                it shows edits
//   edit         `index`, `edit` of a material that shows edits: shares, roughness (factor, own), colours (two matrices)
//   environment  `image` (width, height, texels)
//   draw         `number` of the request; `pictures`, each with `subject` (a material's index, or "difference" of the first two),
//                width, height, scene; `is_new`: forgets the samples so far; `reset_exposure`: sets a new exposure under an
//                environment; `is_quick`: starts with the coarsest picture, because another one may follow at once
//   resting      `is_resting`: take few samples of a picture, because a fit is running
//   lose         for tests: loses the context, or restores it
// and posts { kind, .. }: picture (subject, image, number), drawn (number, samples, exposure), refused (subject, why), busy
// (compiling shaders), environment (preparing one), lost, restored.
"use strict";
function painting(canvas, post) {
"use strict";
const light = lighting();
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const gl = canvas.getContext("webgl2", { alpha: false, antialias: true });
if (!gl) post({ kind: "none" });
if (!gl) return null;
const has_floats = gl.getExtension("EXT_color_buffer_float") !== null;
const k_max_samples = 1024, k_max_samples_resting = 8; // of a picture whose scene does not change
const k_difference_gain = 10;
const k_quick_ms = 10, k_coarsest = 8; // milliseconds for a quick picture; its pixels are up to this many times wider
const k_detail_delay_ms = 150; // from a quick picture to the detailed one

let data = null, descriptions = {}, image = null;
// Objects of the context, which are lost with it. `visible`: a buffer with the visible surface. `means`: buffers with means of samples.
let materials = {}, meshes = {}, programs = new Map(), last_pictures = {}, environment = null, visible = null, means = {};
let develop_program = null, difference_program = null, smoothing_program = null;
// Pictures under an environment have a number of samples that were averaged, and an exposure.
let samples = 0, exposure = 1, has_exposure = false, is_resting = false;
// The last measured time of a sample of a pixel, in milliseconds. Until it is known, pictures start at the coarsest level.
let sample_ms = Infinity;

// The matrix from world to clip coordinates, column-major. `shift` moves the picture, in units of its width and height.
function to_clip({ eye, target, half, frame }, shift = [0, 0]) {
  const distance = Math.hypot(...eye.map((x, i) => x - target[i]));
  const near = Math.max(distance - 4, distance * 0.02), far = distance + 4;
  const rows = [frame[0].map((x, i) => x / half[0] + 2 * shift[0] * frame[2][i]),
    frame[1].map((x, i) => x / half[1] + 2 * shift[1] * frame[2][i]),
    frame[2].map((x) => x * (near + far) / (near - far)), frame[2].map((x) => -x)];
  const shifts = rows.map((row, r) => (r === 2 ? 2 * near * far / (near - far) : 0) - dot(row, eye));
  return [0, 1, 2].flatMap((c) => rows.map((row) => row[c])).concat(shifts);
}

// ---- WebGL -------------------------------------------------------------------------------------------------------

const bytes_of = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));

// The layout and type of a texture's numbers, and their array.
const k_formats = { RGBA16F: ["RGBA", "HALF_FLOAT", Uint16Array], RGBA32F: ["RGBA", "FLOAT", Float32Array],
  RGBA32UI: ["RGBA_INTEGER", "UNSIGNED_INT", Uint32Array] };
function new_texture(gl, { target, format, size, texels }) {
  const bind_point = gl["TEXTURE_" + target], [pixel, type, Numbers] = k_formats[format];
  const numbers = new Numbers(bytes_of(texels).buffer);
  const texture = light.new_empty_texture(gl, bind_point, target === "3D" ? gl.LINEAR : gl.NEAREST);
  if (target === "3D") {
    gl.texParameteri(bind_point, gl.TEXTURE_WRAP_S, gl.REPEAT); // the difference angle's azimuth
    gl.texImage3D(bind_point, 0, gl[format], ...size, 0, gl[pixel], gl[type], numbers);
  } else if (target === "CUBE_MAP") {
    const face = 4 * size[0] * size[1];
    for (let i = 0; i < 6; ++i)
      gl.texImage2D(gl.TEXTURE_CUBE_MAP_POSITIVE_X + i, 0, gl[format], ...size, 0, gl[pixel], gl[type],
        numbers.subarray(i * face, (i + 1) * face));
  } else {
    gl.texImage2D(bind_point, 0, gl[format], ...size, 0, gl[pixel], gl[type], numbers);
  }
  return { bind_point, texture };
}
function compile(gl, type, text) {
  const shader = gl.createShader(type);
  gl.shaderSource(shader, text);
  gl.compileShader(shader);
  return shader;
}
// A program with the locations of its uniforms. Throws the browser's log if it refuses the text.
function new_program(vertex, fragment) {
  const program = gl.createProgram(), locations = {};
  const stages = [compile(gl, gl.VERTEX_SHADER, vertex), compile(gl, gl.FRAGMENT_SHADER, fragment)];
  for (const stage of stages) gl.attachShader(program, stage);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS))
    throw new Error(stages.map((stage) => gl.getShaderInfoLog(stage)).join(" ") + gl.getProgramInfoLog(program));
  return { program, location: (name) => locations[name] ??= gl.getUniformLocation(program, name) };
}
// The program for these texts. Materials with the same text share it.
function program_of(vertex, fragment) {
  const key = vertex + fragment;
  if (!programs.has(key)) {
    post({ kind: "busy" });
    programs.set(key, new_program(vertex, fragment));
  }
  return programs.get(key);
}
function new_material(description) {
  const { block, textures = [], text } = description, floats = (numbers) => numbers && new Float32Array(bytes_of(numbers).buffer);
  const material = { description, ...program_of(data.vertex, text), block: null, vectors_name: description.vectors_name };
  if (block) {
    material.block = gl.createBuffer();
    gl.bindBuffer(gl.UNIFORM_BUFFER, material.block);
    gl.bufferData(gl.UNIFORM_BUFFER, bytes_of(block), gl.STATIC_DRAW);
  }
  material.textures = textures.map((texture) => ({ ...new_texture(gl, texture), sampler: texture.sampler }));
  for (const name of ["vectors", "nodes", "grains"]) material[name] = floats(description[name]);
  return material;
}
function forget_material(index) {
  const { block = null, textures = [] } = materials[index] ?? {};
  gl.deleteBuffer(block); // null is ignored
  for (const { texture } of textures) gl.deleteTexture(texture);
  delete materials[index];
}
const material_of = (index) => materials[index] ??= new_material(descriptions[index]);

// The program that draws a material under an environment; compiled when it is first needed.
function environment_program_of(index) {
  const material = material_of(index), { text, two_sided } = material.description;
  const pixel = two_sided ? data.environment_pixel_of_both_sides : data.environment_pixel;
  return material.environment_program ??= program_of(data.whole, text.slice(0, text.length - data.pixel.length) + pixel);
}
function new_mesh(gl, { vertices, triangles, index_bytes }) {
  const array = gl.createVertexArray(), indices = bytes_of(triangles);
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, bytes_of(vertices), gl.STATIC_DRAW);
  for (const attribute of [0, 1]) {
    gl.enableVertexAttribArray(attribute);
    gl.vertexAttribPointer(attribute, 3, gl.FLOAT, false, 24, 12 * attribute);
  }
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
  gl.bindVertexArray(null);
  const type = index_bytes === 2 ? gl.UNSIGNED_SHORT : gl.UNSIGNED_INT;
  return { array, corners: indices.length / index_bytes, type };
}
// Uses a program with the numbers of a material and the lights of a scene.
function use_material(index, { program, location }, scene) {
  const { block, vectors, vectors_name, nodes, grains, textures, description: { edit } } = materials[index];
  gl.useProgram(program);
  gl.bindBufferBase(gl.UNIFORM_BUFFER, 0, block);
  if (block) gl.uniformBlockBinding(program, gl.getUniformBlockIndex(program, "PmNumbers"), 0);
  if (vectors) gl.uniform4fv(location(vectors_name), vectors);
  textures.forEach(({ sampler, bind_point, texture }, unit) => {
    gl.uniform1i(location(sampler), unit);
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(bind_point, texture);
  });
  if (edit) {
    gl.uniform1fv(location("edited_shares"), edit.shares);
    gl.uniform2fv(location("edited_roughness"), edit.roughness);
    gl.uniform1i(location("edited_part"), edit.part);
  }
  if (location("mixture_numbers")) gl.uniform4fv(location("mixture_numbers"), nodes);
  if (location("mixture_grain")) gl.uniform2fv(location("mixture_grain"), grains);
  gl.uniform3fv(location("eye"), scene.eye);
  gl.uniform3fv(location("light_direction"), scene.directions);
  gl.uniform3fv(location("light_irradiance"), scene.irradiances);
}
function draw_mesh({ program, location }, scene, shift) {
  gl.useProgram(program);
  gl.uniformMatrix4fv(location("to_clip"), false, to_clip(scene, shift));
  const { array, corners, type } = meshes[scene.mesh];
  gl.enable(gl.DEPTH_TEST);
  gl.bindVertexArray(array);
  gl.drawElements(gl.TRIANGLES, corners, type, 0);
}
function draw_under_lights(index, scene) {
  gl.clearColor(...data.background, 1);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  const material = material_of(index);
  use_material(index, material, scene);
  gl.uniform1f(material.location("exposure"), scene.exposure);
  draw_mesh(material, scene);
}
// Draws a triangle that covers the picture. The textures use the units from `unit` on.
function draw_full_screen({ location }, textures, unit) {
  for (const [sampler, texture] of Object.entries(textures)) {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.uniform1i(location(sampler), unit++);
  }
  gl.disable(gl.DEPTH_TEST);
  gl.bindVertexArray(null);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}
// The buffer, or null if it has another size, in which case it is deleted.
function reusable(buffer, width, height) {
  if (!buffer || buffer.width === width && buffer.height === height) return buffer;
  light.delete_buffer(gl, buffer);
  return null;
}
// Draws the surface at 2 x 2 points of each pixel. One of them lies `shift` pixels from the pixel's centre.
function draw_surface(scene, width, height, shift) {
  const fine = [2 * width, 2 * height];
  visible = reusable(visible, ...fine) ?? { ...light.new_buffer(gl, ...fine, 2, true), ...program_of(data.vertex, data.surface) };
  visible.key = null;
  gl.bindFramebuffer(gl.FRAMEBUFFER, visible.framebuffer);
  gl.viewport(0, 0, ...fine);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  // The shift of all points. The point of the sample lies in the lower or the upper half of its pixel.
  draw_mesh(visible, scene, shift.map((x, axis) => (x + (x < 0 ? 0.25 : -0.25)) / [width, height][axis]));
  gl.viewport(0, 0, width, height);
}
// Two buffers of a material, which alternately hold the mean of its samples.
function means_of(index, width, height) {
  const buffers = means[index] ?? [null, null];
  return means[index] = buffers.map((buffer) => reusable(buffer, width, height) ?? light.new_buffer(gl, width, height, 1, false));
}
// Adds sample `count` to a mean: reads it from `source` and writes it to `target`, at the points that `draw_surface` found.
function draw_sample(index, scene, count, source, target, shift) {
  const program = environment_program_of(index), { width, height } = target, { location } = program, { scale, textures } = environment;
  gl.bindFramebuffer(gl.FRAMEBUFFER, target.framebuffer);
  use_material(index, program, scene);
  // The rows are the environment's x, y and z axes in the world.
  const s = Math.sin(scene.turned), c = Math.cos(scene.turned);
  gl.uniformMatrix3fv(location("into_environment"), false, [c, 0, s, 0, 1, 0, -s, 0, c]);
  gl.uniformMatrix3fv(location("picture_axes"), false,
    [...scene.frame[0].map((x) => x * scene.half[0]), ...scene.frame[1].map((x) => x * scene.half[1]), ...scene.frame[2]]);
  gl.uniform1f(location("environment_scale"), scale);
  gl.uniform1f(location("share"), 1 / (count + 1));
  gl.uniform1i(location("sample_index"), count);
  gl.uniform2f(location("picture_size"), width, height);
  gl.uniform2f(location("shift"), ...shift);
  draw_full_screen(program, { surface_positions: visible.textures[0], surface_normals: visible.textures[1], before: source.textures[0],
    ...textures }, materials[index].textures.length);
}
function prepare_environment() {
  if (environment) return;
  post({ kind: "environment" });
  environment = light.new_environment(gl, image);
}
// The number of samples that the next picture adds: several at first, because a single sample is noisy.
const samples_added = () => samples === 0 && !job.is_quick ? data.first_samples : 1;
// Averages each pixel with its neighbours, weighted by the similarity of their normals.
const k_smoothing_text = `#version 300 es
precision highp float;
uniform sampler2D radiance, normals;
uniform int reach;
out vec4 pixel;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(radiance, 0) - 1;
    vec4 normal = texelFetch(normals, 2 * at, 0), sum = texelFetch(radiance, at, 0);
    for (int y = -reach; y <= reach && normal.w != 0.0; ++y)
        for (int x = -reach; x <= reach; ++x) {
            ivec2 beside = clamp(at + ivec2(x, y), ivec2(0), last);
            vec4 difference = texelFetch(normals, 2 * beside, 0) - normal;
            sum += exp(-50.0 * dot(difference, difference)) * texelFetch(radiance, beside, 0);
        }
    pixel = sum / sum.a; // the radiance of every pixel has the alpha 1
}`;
// Shows a mean of this number of samples. The noise of the first ones is smoothed.
function develop_mean(mean, count, scene) {
  const { width, height } = mean, reach = Math.max(2 - Math.floor(count / 4), 0); // pixels on each side
  const [picture] = reach ? means_of("smooth", width, height) : [mean];
  if (reach) {
    if (visible.width !== 2 * width || visible.height !== 2 * height) draw_surface(scene, width, height, light.shift_of(0));
    smoothing_program ??= new_program(data.whole, k_smoothing_text);
    gl.bindFramebuffer(gl.FRAMEBUFFER, picture.framebuffer);
    gl.viewport(0, 0, width, height);
    gl.useProgram(smoothing_program.program);
    gl.uniform1i(smoothing_program.location("reach"), reach);
    draw_full_screen(smoothing_program, { radiance: mean.textures[0], normals: visible.textures[1] }, 0);
  }
  if (!has_exposure && !job.is_quick) {
    exposure = light.exposure_of(gl, picture, visible, data.knee);
    has_exposure = job.size === 1; // a coarse picture has a preliminary one
  }
  develop_program ??= new_program(data.whole, data.develop);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.viewport(0, 0, width, height);
  gl.useProgram(develop_program.program);
  gl.uniform3f(develop_program.location("background"), ...data.background);
  gl.uniform1f(develop_program.location("exposure"), exposure * scene.stops);
  draw_full_screen(develop_program, { radiance: picture.textures[0] }, 0);
}
// Adds these samples and draws the mean so far.
function draw_under_environment(index, scene, width, height) {
  prepare_environment();
  const mean = means_of(index, width, height), end = samples + samples_added();
  for (let count = samples; count < end; ++count) {
    const shift = light.shift_of(count);
    draw_surface(scene, width, height, shift);
    draw_sample(index, scene, count, mean[count % 2], mean[(count + 1) % 2], shift);
  }
  develop_mean(mean[end % 2], end, scene);
}

// ---- Edits -------------------------------------------------------------------------------------------------------

// A material that shows edits has three pictures: of its highlight, its body and the surroundings. Tints and saturation are
// linear maps of the first two, and roughness changes only the first. Under lights a picture is drawn once; under an
// environment it is a mean of samples.
//   key       the scene and size, common to all three
//   parts     the number of samples, pixels per pixel of the whole picture, and the buffer of each
//   duration  milliseconds that a sample of the highlight took at full size
let edited = null;
const k_highlight = 0, k_body = 1, k_around = 2;

// Adds the parts, each scaled linearly to the picture's size. Under an environment the result is radiance, under lights a
// displayed colour. Must follow develop.glsl without its main.
const k_sum_text = `
uniform sampler2D highlight, body, around;
uniform mat3 colours[2];
uniform bool is_around; // true if there is a picture of the surroundings
uniform vec2 size;
vec4 texel(sampler2D part, ivec2 at) { return texelFetch(part, clamp(at, ivec2(0), textureSize(part, 0) - 1), 0); }
vec4 enlarged(sampler2D part) {
    if (textureSize(part, 0) == ivec2(size)) return texelFetch(part, ivec2(gl_FragCoord.xy), 0);
    vec2 at = gl_FragCoord.xy / size * vec2(textureSize(part, 0)) - 0.5, within = fract(at);
    ivec2 first = ivec2(floor(at));
    return mix(mix(texel(part, first), texel(part, first + ivec2(1, 0)), within.x),
               mix(texel(part, first + ivec2(0, 1)), texel(part, first + ivec2(1, 1)), within.x), within.y);
}
void main() {
    vec4 body_texel = enlarged(body); // w is the fraction of the pixel that the object covers
    vec3 sum = colours[0] * enlarged(highlight).rgb + colours[1] * body_texel.rgb;
    vec3 shown = displayed(sum / max(body_texel.w, 1.0e-3));
    shown = vec3(srgb_transfer(shown.x), srgb_transfer(shown.y), srgb_transfer(shown.z));
    pixel = vec4(is_around ? sum + enlarged(around).rgb : mix(background, shown, body_texel.w), 1.0);
}`;

// Adds a sample to a picture of radiances under an environment, or draws it under lights.
function draw_part(index, which, scene, width, height) {
  const part = edited.parts[which];
  descriptions[index].edit.part = which;
  if (scene.around) {
    const mean = means_of(`${index} ${which}`, width, height), shift = light.shift_of(part.samples);
    part.buffer = mean[(part.samples + 1) % 2];
    const key = JSON.stringify([edited.key, width, height, shift]); // the same for all parts
    if (visible?.key !== key) draw_surface(scene, width, height, shift);
    visible.key = key;
    gl.viewport(0, 0, width, height);
    draw_sample(index, scene, part.samples, mean[part.samples % 2], part.buffer, shift);
  } else {
    const material = material_of(index), { text } = material.description;
    part.buffer = reusable(part.buffer, width, height) ?? light.new_buffer(gl, width, height, 1, true);
    gl.bindFramebuffer(gl.FRAMEBUFFER, part.buffer.framebuffer);
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const radiances = material.radiances ??= program_of(data.vertex, text.replace("#define SHOWN 1", "#define SHOWN 0"));
    use_material(index, radiances, scene);
    draw_mesh(radiances, scene);
  }
  ++part.samples;
}
// Draws the missing parts (coarsely for a quick picture that would take long), or else one more sample of each part.
function draw_parts(index, scene, width, height) {
  const { is_quick } = job, { edit } = descriptions[index], { mesh, eye, frame, directions, irradiances, turned, around } = scene;
  const key = JSON.stringify([index, width, height, mesh, eye, frame, directions, irradiances, turned, around]);
  if (edited?.key !== key) {
    forget_edited();
    edited = { key, parts: [0, 1, 2].map(() => ({ samples: 0, size: 0, buffer: null })), duration: 0 };
  }
  const { parts } = edited, has_new_roughness = edited.roughness !== edit.roughness[0], drawn = around ? parts : parts.slice(0, k_around);
  // When nothing moves, a picture under lights has four points per pixel.
  const whole = around || is_quick ? 1 : 2;
  const coarse = 1 / Math.min(Math.max(Math.ceil(Math.sqrt(edited.duration / k_quick_ms)), 1), k_coarsest);
  for (const part of drawn) {
    const is_new = part.samples === 0 || part === parts[k_highlight] && has_new_roughness;
    let size = whole;
    if (is_quick && !is_new) size = part.size;
    else if (is_quick && part.samples > 0) size = coarse;
    if (is_new || size !== part.size) Object.assign(part, { samples: 0, size });
  }
  edited.roughness = edit.roughness[0];
  if (around) prepare_environment();
  const fewest = Math.min(...drawn.map(({ samples }) => samples));
  for (const part of drawn) {
    if (part.samples > fewest || fewest > 0 && (is_quick || !around)) continue;
    const which = parts.indexOf(part), start = performance.now();
    draw_part(index, which, scene, scaled(width, part.size), scaled(height, part.size));
    if (which !== k_highlight) continue;
    wait_for_card(part.buffer);
    edited.duration = (performance.now() - start) / part.size ** 2;
  }
}
function draw_edited(index, scene, width, height) {
  draw_parts(index, scene, width, height);
  const { around } = scene, { edit } = descriptions[index], { parts } = edited;
  const sum = edited.sum ??= program_of(data.whole, data.develop.slice(0, data.develop.indexOf("void main()")) + k_sum_text);
  const [highlight, body, beside] = parts.map(({ buffer }) => (buffer ?? parts[k_body].buffer).textures[0]);
  const [radiances] = around ? means_of(index, width, height) : [null];
  gl.bindFramebuffer(gl.FRAMEBUFFER, radiances && radiances.framebuffer);
  gl.viewport(0, 0, width, height);
  gl.useProgram(sum.program);
  gl.uniformMatrix3fv(sum.location("colours"), false, edit.colours);
  gl.uniform1i(sum.location("is_around"), around);
  gl.uniform2f(sum.location("size"), width, height);
  gl.uniform3f(sum.location("background"), ...data.background);
  gl.uniform1f(sum.location("exposure"), scene.exposure);
  draw_full_screen(sum, { highlight, body, around: beside }, 0);
  if (around) develop_mean(radiances, Math.min(...parts.map(({ samples }) => samples)), scene);
}
function forget_edited() {
  // Buffers of means are kept for reuse.
  if (edited) for (const { buffer } of edited.parts) if (buffer?.depth) light.delete_buffer(gl, buffer);
  edited = null;
}
// Keeps the last picture of a material as a texture.
function keep_picture(index, width, height) {
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(gl.TEXTURE_2D, last_pictures[index] ??= light.new_empty_texture(gl, gl.TEXTURE_2D, gl.NEAREST));
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.copyTexImage2D(gl.TEXTURE_2D, 0, gl.RGB, 0, 0, width, height, 0);
}
// The difference of the two pictures in display values, amplified.
const k_difference_text = `#version 300 es
precision highp float;
uniform sampler2D first, second;
uniform float gain;
out vec4 pixel;
void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    pixel = vec4(gain * abs(texelFetch(first, texel, 0).rgb - texelFetch(second, texel, 0).rgb), 1.0);
}`;
function draw_difference() {
  difference_program ??= new_program(data.whole, k_difference_text);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.useProgram(difference_program.program);
  gl.uniform1f(difference_program.location("gain"), k_difference_gain);
  draw_full_screen(difference_program, { first: last_pictures[0], second: last_pictures[1] }, 0);
}
function draw_picture({ subject, width, height, scene }) {
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  gl.viewport(0, 0, width, height);
  if (subject === "difference") return draw_difference();
  if (descriptions[subject].edit) draw_edited(subject, scene, width, height);
  else if (scene.around) draw_under_environment(subject, scene, width, height);
  else draw_under_lights(subject, scene);
  if (subject < 2) keep_picture(subject, width, height);
}
// Waits until the graphics card has finished the canvas, or a buffer of floats.
function wait_for_card(buffer = null) {
  gl.bindFramebuffer(gl.FRAMEBUFFER, buffer && buffer.framebuffer);
  gl.readPixels(0, 0, 1, 1, gl.RGBA, buffer ? gl.FLOAT : gl.UNSIGNED_BYTE, new (buffer ? Float32Array : Uint8Array)(4));
}
const pixels_of = (pictures) => pictures.reduce((sum, { width, height }) => sum + width * height, 0);
// The initial resolution of a new picture without edits, relative to the page's pixels: lower under an environment if samples are slow.
function initial_size({ is_quick, pictures }) {
  if (is_quick || samples > 0 || !pictures.length || !pictures[0].scene.around) return 1;
  if (pictures.some(({ subject }) => descriptions[subject]?.edit)) return 1;
  return Math.min(Math.max(Math.sqrt(k_quick_ms / (sample_ms * pixels_of(pictures))), 1 / k_coarsest), 1);
}
const scaled = (length, size) => Math.max(Math.round(size * length), 1); // [pixels]

// Draws one round of pictures. A difference needs the pictures of both materials.
function draw_all({ number, size, pictures: requested }) {
  const pictures = requested.map((picture) => ({ ...picture, width: scaled(picture.width, size), height: scaled(picture.height, size) }));
  const difference = pictures.find(({ subject }) => subject === "difference"), round = pictures.filter((picture) => picture !== difference);
  if (difference) {
    const missing = [0, 1].filter((subject) => !requested.some((picture) => picture.subject === subject));
    round.push(...missing.map((subject) => ({ ...difference, subject, hidden: true })), difference);
  }
  let drawn = 0;
  for (const picture of round) {
    const { subject } = picture;
    if (subject === "difference" ? !descriptions[0] || !descriptions[1] : !descriptions[subject]) continue;
    try {
      draw_picture(picture);
    } catch (error) {
      descriptions[subject] = null;
      post({ kind: "refused", subject, why: error.message });
      continue;
    }
    ++drawn;
    if (picture.hidden) continue;
    wait_for_card(); // an unfinished picture would block the page
    const image = canvas.transferToImageBitmap ? canvas.transferToImageBitmap() : canvas;
    post({ kind: "picture", subject, image, number }, image === canvas ? [] : [image]);
  }
  wait_for_card(); // finishes these pictures before the next are begun
  if (size < 1) return drawn;
  if (drawn && pictures[0].scene.around) samples += samples_added();
  post({ kind: "drawn", number, samples, exposure });
  return drawn;
}
let job = null; // the last `draw` message with the size of its next round
let timer = 0, context_loss = null;
function draw_soon(milliseconds) {
  clearTimeout(timer);
  timer = setTimeout(() => {
    if (!job || !data || gl.isContextLost()) return;
    const start = performance.now(), { is_quick, size, pictures } = job, added = samples_added();
    if (!draw_all(job)) return;
    job.is_quick = false;
    const { around } = pictures[0].scene, duration = performance.now() - start;
    if (around && !is_quick) sample_ms = duration / (size ** 2 * pixels_of(pictures) * added);
    if (size < 1) {
      job.size = Math.min(Math.max(2 * size, initial_size(job)), 1);
      draw_soon(0);
    } else if (is_quick) draw_soon(k_detail_delay_ms);
    else if (around && samples < (is_resting ? k_max_samples_resting : k_max_samples)) draw_soon(Math.max(0, 16 - duration)); // a frame
  }, milliseconds);
}
// Forgets the objects of the context, and makes the meshes.
function reset_context() {
  materials = {}, programs = new Map(), last_pictures = {}, means = {}, meshes = {};
  environment = visible = develop_program = difference_program = smoothing_program = edited = null;
  for (const name in data.meshes) meshes[name] = new_mesh(gl, data.meshes[name]);
  samples = 0;
}

const actions = {
  common(message) {
    data = message.data, descriptions = {};
    reset_context();
  },
  material({ index, material, is_edited }) {
    forget_material(index);
    forget_edited();
    descriptions[index] = material && material.bytes ? JSON.parse(new TextDecoder().decode(material.bytes)) : material;
    if (is_edited) descriptions[index].text = descriptions[index].text.replace("#define SIDES", "#define PM_EDITED\n#define SIDES");
    samples = 0;
    if (index === 0) has_exposure = false;
  },
  edit({ index, edit }) { if (descriptions[index]) descriptions[index].edit = edit; },
  environment(message) {
    forget_edited();
    if (environment) for (const texture of Object.values(environment.textures)) gl.deleteTexture(texture);
    environment = null, image = message.image, has_exposure = false, samples = 0;
  },
  draw(message) {
    if (message.is_new) samples = 0;
    if (message.reset_exposure) has_exposure = false;
    job = { ...message, size: initial_size(message) };
    draw_soon(0);
  },
  resting(message) {
    is_resting = message.is_resting;
    if (!is_resting) draw_soon(0);
  },
  lose({ is_lost }) {
    context_loss ??= gl.getExtension("WEBGL_lose_context");
    if (is_lost) context_loss.loseContext();
    else context_loss.restoreContext();
  },
};
canvas.addEventListener("webglcontextlost", (event) => {
  event.preventDefault();
  post({ kind: "lost" });
});
canvas.addEventListener("webglcontextrestored", () => {
  gl.getExtension("EXT_color_buffer_float");
  if (data) reset_context();
  post({ kind: "restored" });
  if (job) draw_soon(0);
});
post({ kind: "ready", has_floats });
return (message) => actions[message.kind](message);
}
