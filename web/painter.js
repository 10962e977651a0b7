// Draws materials with their shaders, in a worker where the browser lets it, so that the page never waits for a picture.
// A function of its own text, which the page gives to that worker. It takes messages { kind, .. }:
//   common       `data`, what all pictures have in common; forgets everything else
//   material     `index`, `material` (null: none), whose `text` is its fragment shader; or its JSON as `bytes`
//   environment  `image` (width, height, texels)
//   draw         `pictures`, each with `of`, a material's index or "difference" of the first two, width, height and scene
//   rest         `is_resting`: few samples of a picture, for somebody else computes
//   lose         for tests: takes the context away, or gives it back
// and gives back { kind, .. }: picture (of, image), drawn (number, samples, exposure), refused (of, why), busy (with shaders),
//   environment (busy with one), lost, restored.
"use strict";
function painting(surface, post) {
"use strict";
const light = lighting();
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const gl = surface.getContext("webgl2", { alpha: false, antialias: true });
if (!gl) return post({ kind: "none" }), null;
const has_floats = gl.getExtension("EXT_color_buffer_float") !== null;
const k_samples = 1024, k_samples_resting = 8; // of a picture that does not move
const k_difference_gain = 10;

let data = null, given = {}, image = null;
// Of the context: all that it would lose.
let materials = {}, meshes = {}, programs = new Map(), shown = {}, environment = null, visible = null, develop = null, apart = null, means = {};
// Of pictures under an environment: how many samples they are the mean of, and the exposure.
let samples = 0, exposure = 1, is_exposed = false, is_resting = false;

// World to clip coordinates, columns one after the other; with the picture shifted by parts of its width and height.
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

const k_formats = {
  RGBA16F: ["RGBA", "HALF_FLOAT", Uint16Array],
  RGBA32F: ["RGBA", "FLOAT", Float32Array],
  RGBA32UI: ["RGBA_INTEGER", "UNSIGNED_INT", Uint32Array],
};

function new_texture(gl, { target, format, size, texels }) {
  const place = gl["TEXTURE_" + target], [pixel, type, Numbers] = k_formats[format];
  const numbers = new Numbers(bytes_of(texels).buffer);
  const texture = gl.createTexture();
  gl.bindTexture(place, texture);
  const filter = target === "3D" ? gl.LINEAR : gl.NEAREST;
  gl.texParameteri(place, gl.TEXTURE_MIN_FILTER, filter);
  gl.texParameteri(place, gl.TEXTURE_MAG_FILTER, filter);
  for (const axis of ["S", "T", "R"]) gl.texParameteri(place, gl["TEXTURE_WRAP_" + axis], gl.CLAMP_TO_EDGE);
  if (target === "3D") {
    gl.texParameteri(place, gl.TEXTURE_WRAP_S, gl.REPEAT); // the difference angle's azimuth
    gl.texImage3D(place, 0, gl[format], ...size, 0, gl[pixel], gl[type], numbers);
  } else if (target === "CUBE_MAP") {
    const face = 4 * size[0] * size[1];
    for (let i = 0; i < 6; ++i)
      gl.texImage2D(gl.TEXTURE_CUBE_MAP_POSITIVE_X + i, 0, gl[format], ...size, 0, gl[pixel], gl[type],
        numbers.subarray(i * face, (i + 1) * face));
  } else {
    gl.texImage2D(place, 0, gl[format], ...size, 0, gl[pixel], gl[type], numbers);
  }
  return { place, texture };
}

function compiled(gl, type, text) {
  const shader = gl.createShader(type);
  gl.shaderSource(shader, text);
  gl.compileShader(shader);
  return shader;
}

// A program and the places of its uniforms. Throws what the browser has against its text.
function new_program(vertex, fragment) {
  const program = gl.createProgram(), places = {};
  const stages = [compiled(gl, gl.VERTEX_SHADER, vertex), compiled(gl, gl.FRAGMENT_SHADER, fragment)];
  for (const stage of stages) gl.attachShader(program, stage);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS))
    throw new Error(stages.map((stage) => gl.getShaderInfoLog(stage)).join(" ") + gl.getProgramInfoLog(program));
  return { program, place: (name) => places[name] ??= gl.getUniformLocation(program, name) };
}


// The same program serves all materials of the same text.
function program_of(vertex, fragment) {
  const key = vertex + fragment;
  if (!programs.has(key)) {
    post({ kind: "busy" });
    programs.set(key, new_program(vertex, fragment));
  }
  return programs.get(key);
}

// Gives a program the numbers of a material.
function use_numbers({ program, place }, { block, vectors, vectors_name, nodes, grains, textures }) {
  gl.useProgram(program);
  if (block) gl.uniformBlockBinding(program, gl.getUniformBlockIndex(program, "PmNumbers"), 0);
  if (vectors) gl.uniform4fv(place(vectors_name), vectors);
  textures.forEach(({ sampler }, unit) => gl.uniform1i(place(sampler), unit));
  if (place("mixture_numbers")) gl.uniform4fv(place("mixture_numbers"), nodes);
  if (place("mixture_grain")) gl.uniform2fv(place("mixture_grain"), grains);
}

function new_material(of) {
  const { block, textures = [], text } = of, floats = (numbers) => numbers && new Float32Array(bytes_of(numbers).buffer);
  const material = { of, ...program_of(data.vertex, text), block: null, vectors_name: of.vectors_name };
  if (block) {
    material.block = gl.createBuffer();
    gl.bindBuffer(gl.UNIFORM_BUFFER, material.block);
    gl.bufferData(gl.UNIFORM_BUFFER, bytes_of(block), gl.STATIC_DRAW);
  }
  material.textures = textures.map((texture) => ({ ...new_texture(gl, texture), sampler: texture.sampler }));
  for (const name of ["vectors", "nodes", "grains"]) material[name] = floats(of[name]);
  return material;
}
function forget_material(index) {
  const material = materials[index];
  if (material && material.block) gl.deleteBuffer(material.block);
  if (material) for (const { texture } of material.textures) gl.deleteTexture(texture);
  delete materials[index];
}
const material_of = (index) => materials[index] ??= new_material(given[index]);

// The same material under an environment; compiled once there is one.
function under_environment(index) {
  const material = material_of(index), { text, two_sided } = material.of;
  const pixel = two_sided ? data.environment_pixel_of_both_sides : data.environment_pixel;
  return material.lit ??= program_of(data.whole, text.slice(0, text.length - data.pixel.length) + pixel);
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

function use_material(index, of, now) {
  const { block, textures } = materials[index], { place } = of;
  use_numbers(of, materials[index]);
  gl.uniform3fv(place("eye"), now.eye);
  gl.uniform3fv(place("light_direction"), now.directions);
  gl.uniform3fv(place("light_irradiance"), now.irradiances);
  gl.bindBufferBase(gl.UNIFORM_BUFFER, 0, block);
  textures.forEach((of, unit) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(of.place, of.texture);
  });
}

function draw_mesh({ program, place }, now, shift) {
  gl.useProgram(program);
  gl.uniformMatrix4fv(place("to_clip"), false, to_clip(now, shift));
  const { array, corners, type } = meshes[now.mesh];
  gl.enable(gl.DEPTH_TEST);
  gl.bindVertexArray(array);
  gl.drawElements(gl.TRIANGLES, corners, type, 0);
}

function draw_under_lights(index, now) {
  gl.clearColor(...data.background, 1);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  const material = material_of(index);
  use_material(index, material, now);
  gl.uniform1f(material.place("exposure"), now.exposure);
  draw_mesh(material, now);
}

// A triangle that covers the picture, with textures in the units from `unit` on.
function draw_whole({ place }, textures, unit) {
  for (const [sampler, texture] of Object.entries(textures)) {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.uniform1i(place(sampler), unit++);
  }
  gl.disable(gl.DEPTH_TEST);
  gl.bindVertexArray(null);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}

// The surface at 2 x 2 points of each pixel, of which one is shifted so many pixels from its centre.
function draw_surface(now, width, height, shift) {
  const fine = [2 * width, 2 * height];
  if (visible && (visible.width !== fine[0] || visible.height !== fine[1]))
    light.delete_buffer(gl, visible), visible = null;
  visible ??= { ...light.new_buffer(gl, ...fine, 2, true), ...new_program(data.vertex, data.surface) };
  gl.bindFramebuffer(gl.FRAMEBUFFER, visible.framebuffer);
  gl.viewport(0, 0, ...fine);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  // The shift of all points: that point lies in the lower or the upper half of its pixel.
  draw_mesh(visible, now, shift.map((x, axis) => (x + (x < 0 ? 0.25 : -0.25)) / [width, height][axis]));
  gl.viewport(0, 0, width, height);
}

// Buffers of a material, which take turns as the mean of samples.
function means_of(index, width, height) {
  const of = means[index];
  if (of && of[0].width === width && of[0].height === height) return of;
  if (of) for (const buffer of of) light.delete_buffer(gl, buffer);
  return means[index] = [0, 1].map(() => light.new_buffer(gl, width, height, 1, false));
}

// Draws sample `count` of a mean from what `draw_surface` saw.
function draw_sample(index, now, count, from, to, shift) {
  const lit = under_environment(index), { width, height } = to, { place } = lit, { scale, textures } = environment;
  gl.bindFramebuffer(gl.FRAMEBUFFER, to.framebuffer);
  use_material(index, lit, now);
  // Rows: the environment's x, y and z in the world.
  const s = Math.sin(now.turned), c = Math.cos(now.turned);
  gl.uniformMatrix3fv(place("into_environment"), false, [c, 0, s, 0, 1, 0, -s, 0, c]);
  gl.uniformMatrix3fv(place("picture_axes"), false,
    [...now.frame[0].map((x) => x * now.half[0]), ...now.frame[1].map((x) => x * now.half[1]), ...now.frame[2]]);
  gl.uniform1f(place("environment_scale"), scale);
  gl.uniform1f(place("share"), 1 / (count + 1));
  gl.uniform1i(place("sample_index"), count);
  gl.uniform2f(place("picture_size"), width, height);
  gl.uniform2f(place("shift"), ...shift);
  draw_whole(lit, { surface_positions: visible.textures[0], surface_normals: visible.textures[1], before: from.textures[0],
    ...textures }, materials[index].textures.length);
}

// How many samples the next picture adds: one that begins is noisy, and has some at once.
const samples_added = () => samples === 0 ? data.first_samples : 1;
// These samples, and the picture so far.
function draw_under_environment(index, now, width, height) {
  if (!environment) {
    post({ kind: "environment" });
    environment = light.new_environment(gl, image);
  }
  develop ??= new_program(data.whole, data.develop);
  const mean = means_of(index, width, height), end = samples + samples_added();
  for (let count = samples; count < end; ++count) {
    const shift = light.shift_of(count);
    draw_surface(now, width, height, shift);
    draw_sample(index, now, count, mean[count % 2], mean[(count + 1) % 2], shift);
  }
  const picture = mean[end % 2];
  if (!is_exposed) exposure = light.exposure_of(gl, picture, visible, data.knee), is_exposed = true;
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.useProgram(develop.program);
  gl.uniform3f(develop.place("background"), ...data.background);
  gl.uniform1f(develop.place("exposure"), exposure * now.stops);
  gl.uniform1f(develop.place("full_scale"), 0);
  draw_whole(develop, { radiance: picture.textures[0], other: picture.textures[0] }, 0);
}


// What the last picture of a material was, as a texture.
function keep_shown(index, width, height) {
  const texture = shown[index] ??= gl.createTexture();
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.copyTexImage2D(gl.TEXTURE_2D, 0, gl.RGB, 0, 0, width, height, 0);
}

// How far the two pictures are apart, in the numbers that a display is given, several times enlarged.
const k_apart_text = `#version 300 es
precision highp float;
uniform sampler2D first, second;
uniform float gain;
out vec4 pixel;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    pixel = vec4(gain * abs(texelFetch(first, at, 0).rgb - texelFetch(second, at, 0).rgb), 1.0);
}`;
function draw_difference() {
  apart ??= new_program(data.whole, k_apart_text);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.useProgram(apart.program);
  gl.uniform1f(apart.place("gain"), k_difference_gain);
  draw_whole(apart, { first: shown[0], second: shown[1] }, 0);
}

function draw_picture({ of, width, height, scene }) {
  if (surface.width !== width || surface.height !== height) surface.width = width, surface.height = height;
  gl.viewport(0, 0, width, height);
  if (of === "difference") return draw_difference();
  const now = { ...scene, samples };
  (scene.around ? draw_under_environment : draw_under_lights)(of, now, width, height);
  if (of < 2) keep_shown(of, width, height);
}

// Waits until all that was asked of the graphics is done.
function finish() {
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
}

// One round of pictures; a difference needs those of both.
function draw_all({ number, pictures }) {
  const difference = pictures.find(({ of }) => of === "difference"), round = pictures.filter(({ of }) => of !== "difference");
  const wanted = new Set(round.map(({ of }) => of));
  if (difference) for (const of of [0, 1]) if (!wanted.has(of)) round.push({ ...difference, of, hidden: true });
  let drawn = 0;
  for (const picture of difference ? [...round, difference] : round) {
    const { of } = picture;
    if (of === "difference" ? !given[0] || !given[1] : !given[of]) continue;
    try {
      draw_picture(picture);
    } catch (error) {
      given[of] = null;
      post({ kind: "refused", of, why: error.message });
      continue;
    }
    ++drawn;
    if (picture.hidden) continue;
    finish(); // a page that is given an unfinished picture waits for it
    const image = surface.transferToImageBitmap ? surface.transferToImageBitmap() : surface;
    post({ kind: "picture", of, image }, image === surface ? [] : [image]);
  }
  if (drawn && pictures[0].scene.around) samples += samples_added();
  finish(); // the pictures are there before the next are begun
  post({ kind: "drawn", number, samples, exposure });
  return drawn;
}

let job = null, is_due = false, loss = null;
function draw_soon(milliseconds) {
  if (is_due) return;
  is_due = true;
  setTimeout(() => {
    is_due = false;
    if (!job || !data || gl.isContextLost()) return;
    const now = job, begun = performance.now();
    const drawn = draw_all(now);
    if (drawn && now.pictures[0].scene.around && samples < (is_resting ? k_samples_resting : k_samples) && job === now) draw_soon(Math.max(0, 16 - (performance.now() - begun)));
  }, milliseconds);
}

function load() {
  materials = {}, programs = new Map(), shown = {}, environment = visible = develop = apart = null, means = {}, meshes = {};
  for (const name in data.meshes) meshes[name] = new_mesh(gl, data.meshes[name]);
  samples = 0;
}

const actions = {
  common(message) { data = message.data, given = {}, load(); },
  material({ index, material }) {
    forget_material(index);
    given[index] = material && material.bytes ? JSON.parse(new TextDecoder().decode(material.bytes)) : material;
    samples = 0;
    if (index === 0) is_exposed = false;
  },
  environment(message) {
    if (environment) for (const texture of Object.values(environment.textures)) gl.deleteTexture(texture);
    environment = null, image = message.image, is_exposed = false, samples = 0;
  },
  draw(message) {
    if (message.is_new) samples = 0;
    if (message.exposes) is_exposed = false;
    job = message;
    draw_soon(0);
  },
  rest(message) {
    is_resting = message.is_resting;
    if (!is_resting) draw_soon(0);
  },
  lose({ is_lost }) {
    loss ??= gl.getExtension("WEBGL_lose_context");
    is_lost ? loss.loseContext() : loss.restoreContext();
  },
};
surface.addEventListener("webglcontextlost", (event) => {
  event.preventDefault();
  post({ kind: "lost" });
});
surface.addEventListener("webglcontextrestored", () => {
  gl.getExtension("EXT_color_buffer_float");
  if (data) load();
  post({ kind: "restored" });
  if (job) draw_soon(0);
});
post({ kind: "ready", has_floats });
return (message) => actions[message.kind](message);
}
