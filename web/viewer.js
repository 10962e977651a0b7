// Draws the page's materials with the shaders that the page shows, and moves camera and light.
"use strict";
const viewer = (() => {
const data = JSON.parse(document.getElementById("data").textContent);
const section = document.getElementById("viewer");
const controls = section.querySelector("form");
const figures = [...section.querySelectorAll("figure")];
const k_degree = Math.PI / 180;

// ---- What is seen ------------------------------------------------------------------------------------------------

const angles_of = (w) => [Math.atan2(w[0], w[2]), Math.asin(w[1])];
const direction_of = ([azimuth, elevation]) =>
  [Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation), Math.cos(elevation) * Math.cos(azimuth)];
const clamp = (x, least, most) => Math.min(Math.max(x, least), most);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

// Azimuths and elevations of the camera and of the first light.
const beginning = () =>
  ({ camera: [0, data.elevation], light: angles_of(data.lights[0].towards), turned: 0, zoom: 1, shown: "all" });
let view = beginning();
const has_environment = () => controls.environment.value !== "none";
const has_lights = () => !has_environment() || controls.lamps.checked;

// The camera's axes: x right, y up, z to the viewer.
function axes() {
  const [azimuth, elevation] = view.camera, s = Math.sin(azimuth), c = Math.cos(azimuth);
  return [[c, 0, -s], [-s * Math.sin(elevation), Math.cos(elevation), -c * Math.sin(elevation)], direction_of(view.camera)];
}

// What the shaders are told, for a picture of that aspect.
function scene(aspect) {
  const mesh = data.meshes[controls.mesh.value], frame = axes(), distance = mesh.distance / view.zoom;
  const towards = data.lights.map((light, k) => k ? light.towards : direction_of(view.light));
  const half = Math.tan(data.fov / 2);
  return {
    mesh: controls.mesh.value, fov: data.fov, target: mesh.target,
    // Where the picture is narrow, it is its width that holds the object.
    eye: mesh.target.map((x, i) => x + distance * Math.max(1, data.aspect / aspect) * frame[2][i]),
    half: [half * aspect, half], frame,
    exposure: (has_environment() ? exposure : data.exposure) * 2 ** controls.stops.value,
    directions: towards.flat(),
    irradiances: data.lights.flatMap((light, k) => !has_lights() || k && !controls.others.checked ? [0, 0, 0] : light.irradiance),
    turned: view.turned, samples: has_environment() ? samples : 0,
  };
}

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

// A material's program with its numbers.
function new_material_program(index, vertex, fragment) {
  const of = new_program(vertex, fragment), { block, vectors, textures = [] } = data.materials[index];
  gl.useProgram(of.program);
  if (block) gl.uniformBlockBinding(of.program, gl.getUniformBlockIndex(of.program, "PmNumbers"), 0);
  if (vectors) gl.uniform4fv(of.place("ggx_numbers"), new Float32Array(bytes_of(vectors).buffer));
  textures.forEach(({ sampler }, unit) => gl.uniform1i(of.place(sampler), unit));
  return of;
}

const text_of = (index) => document.getElementById("glsl-" + index).textContent;

function new_material(gl, index) {
  const { block, textures = [] } = data.materials[index];
  const material = { ...new_material_program(index, data.vertex, text_of(index)), block: null, textures: [] };
  if (block) {
    material.block = gl.createBuffer();
    gl.bindBuffer(gl.UNIFORM_BUFFER, material.block);
    gl.bufferData(gl.UNIFORM_BUFFER, bytes_of(block), gl.STATIC_DRAW);
  }
  material.textures = textures.map((of) => new_texture(gl, of));
  return material;
}

// The same material under an environment; compiled once there is one.
function under_environment(index) {
  const material = materials[index];
  if (!material.lit) {
    const text = text_of(index);
    const { two_sided, nodes, grains } = data.materials[index], floats = (text) => new Float32Array(bytes_of(text).buffer);
    const pixel = two_sided ? data.environment_pixel_of_both_sides : data.environment_pixel;
    material.lit = new_material_program(index, data.whole, text.slice(0, text.length - data.pixel.length) + pixel);
    gl.uniform4fv(material.lit.place("mixture_numbers"), floats(nodes));
    gl.uniform2fv(material.lit.place("mixture_grain"), floats(grains));
  }
  return material.lit;
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

// One context, for a browser gives a page but a few, draws every picture in turn; each is then copied to its place.
const surface = document.createElement("canvas");
const gl = surface.getContext("webgl2", { alpha: false, antialias: true });
const has_floats = gl && gl.getExtension("EXT_color_buffer_float") !== null;
let materials = {}, meshes = {};
// Of pictures under an environment: its textures, how many samples they are the mean of, the exposure, the surface that
// is visible at each pixel, and for each material the means.
let environment = null, samples = 0, exposure = 1, is_exposed = false, visible = null, develop = null, means = {};
const images = { studio: () => ({ ...data.environment, texels: light.decoded(bytes_of(data.environment.rgbe)) }) };

function load() {
  materials = {}, meshes = {}, environment = visible = develop = null, means = {};
  for (const name in data.meshes) meshes[name] = new_mesh(gl, data.meshes[name]);
  for (const figure of figures) {
    const index = figure.dataset.material;
    try {
      materials[index] = new_material(gl, index);
    } catch (error) {
      refuse(figure, error);
    }
  }
}

function use_material(index, { program, place }, now) {
  const { block, textures } = materials[index];
  gl.useProgram(program);
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
  use_material(index, materials[index], now);
  gl.uniform1f(materials[index].place("exposure"), now.exposure);
  draw_mesh(materials[index], now);
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

// Buffers of a material: first the filtered picture, then two that take turns as the mean of samples.
function means_of(index, width, height) {
  const of = means[index];
  if (of && of[0].width === width && of[0].height === height) return of;
  if (of) for (const buffer of of) light.delete_buffer(gl, buffer);
  return means[index] = [0, 1, 2].map(() => light.new_buffer(gl, width, height, 1, false));
}

// Draws one more sample (`draws` 0), or the filtered picture (3), from what `draw_surface` saw.
function draw_sample(index, now, draws, from, to, shift) {
  const lit = under_environment(index), { width, height } = to, { place } = lit, { scale, textures } = environment;
  gl.bindFramebuffer(gl.FRAMEBUFFER, to.framebuffer);
  use_material(index, lit, now);
  // Rows: the environment's x, y and z in the world.
  const s = Math.sin(now.turned), c = Math.cos(now.turned);
  gl.uniformMatrix3fv(place("into_environment"), false, [c, 0, s, 0, 1, 0, -s, 0, c]);
  gl.uniformMatrix3fv(place("picture_axes"), false,
    [...now.frame[0].map((x) => x * now.half[0]), ...now.frame[1].map((x) => x * now.half[1]), ...now.frame[2]]);
  gl.uniform1f(place("environment_scale"), scale);
  gl.uniform1f(place("share"), draws === 3 ? 1 : 1 / (samples + 1));
  gl.uniform1i(place("sample_index"), draws === 3 ? 0 : samples);
  gl.uniform1i(place("draws"), draws);
  gl.uniform2f(place("picture_size"), width, height);
  gl.uniform2f(place("shift"), ...shift);
  draw_whole(lit, { surface_positions: visible.textures[0], surface_normals: visible.textures[1], before: from.textures[0],
    ...textures }, materials[index].textures.length);
}

// One more sample, and the picture so far: filtered at first, then the mean alone.
function draw_under_environment(index, now, width, height) {
  environment ??= light.new_environment(gl, (images[controls.environment.value] ?? images.studio)());
  develop ??= new_program(data.whole, data.develop);
  const [filtered, ...mean] = means_of(index, width, height);
  if (samples === 0) {
    draw_surface(now, width, height, [0, 0]);
    draw_sample(index, now, 3, mean[0], filtered, [0, 0]);
    if (!is_exposed) exposure = light.exposure_of(gl, filtered, data.knee), is_exposed = true;
    now = scene(width / height);
  }
  const shift = light.shift_of(samples);
  draw_surface(now, width, height, shift);
  draw_sample(index, now, 0, mean[samples % 2], mean[(samples + 1) % 2], shift);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.useProgram(develop.program);
  gl.uniform3f(develop.place("background"), ...data.background);
  gl.uniform1f(develop.place("exposure"), now.exposure);
  gl.uniform1f(develop.place("full_scale"), 0);
  gl.uniform1f(develop.place("share"), Math.min(samples / data.filtered_samples, 1));
  draw_whole(develop, { radiance: filtered.textures[0], other: mean[(samples + 1) % 2].textures[0] }, 0);
}

function draw(index, canvas) {
  const width = Math.round(canvas.clientWidth * Math.min(window.devicePixelRatio, 2));
  const height = Math.round(width / data.aspect);
  if (width === 0) return;
  if (canvas.width !== width || canvas.height !== height) canvas.width = width, canvas.height = height;
  if (surface.width !== width || surface.height !== height) surface.width = width, surface.height = height;
  gl.viewport(0, 0, width, height);
  (has_environment() ? draw_under_environment : draw_under_lights)(index, scene(width / height), width, height);
  canvas.getContext("2d").drawImage(surface, 0, 0);
}

// ---- The page ----------------------------------------------------------------------------------------------------

const k_samples = 1024; // of a picture at rest
let is_due = false;
// Draws everything anew; with an environment then goes on until the pictures have converged.
function redraw() {
  samples = 0;
  draw_soon();
}
function draw_soon() {
  if (is_due || !gl || gl.isContextLost()) return;
  is_due = true;
  requestAnimationFrame(() => {
    is_due = false;
    if (samples === 0) show_state();
    let drawn = 0;
    for (const figure of figures) {
      const index = figure.dataset.material;
      if (figure.hidden || !materials[index]) continue;
      try {
        draw(index, figure.querySelector("canvas"));
        ++drawn;
      } catch (error) {
        refuse(figure, error);
      }
    }
    if (!has_environment() || !drawn) return;
    ++samples;
    if (samples < k_samples) draw_soon();
  });
}
function show_state() {
  const stops = Number(controls.stops.value);
  controls.exposure.value = (stops > 0 ? "+" : "") + stops + (Math.abs(stops) === 1 ? " stop" : " stops");
  section.querySelector(".pictures").classList.toggle("one", view.shown !== "all");
  section.querySelector("[name=lamps]").disabled = !has_environment();
  section.querySelector("[value=environment]").disabled = !has_environment();
  if (!has_environment() && controls.drag.value === "environment") controls.drag.value = "view";
  for (const button of section.querySelectorAll("[data-show]"))
    button.setAttribute("aria-pressed", button.dataset.show === view.shown);
  // All of them take their places before the first is drawn, whose size depends on the others.
  for (const figure of figures) figure.hidden = view.shown !== "all" && view.shown !== figure.dataset.material;
}
// Says in the place of a picture why there is none.
function refuse(figure, error) {
  const refused = document.createElement("p");
  refused.className = "refused";
  refused.textContent = "This browser does not take the shader: " + error.message;
  figure.querySelector("canvas").replaceWith(refused);
  delete materials[figure.dataset.material];
}
function say(text) {
  const said = document.getElementById("said");
  said.textContent = text;
  said.hidden = !text;
}

// Shows the pictures under another environment, or the same anew.
function change_environment() {
  if (environment) for (const texture of Object.values(environment.textures)) gl.deleteTexture(texture);
  environment = null, is_exposed = false;
  redraw();
}
async function open_environment(file) {
  try {
    const image = await light.read_file(file);
    images.file = () => image;
    controls.environment.querySelector("[value=file]")?.remove();
    controls.environment.add(new Option(file.name, "file", false, true));
    say("");
    change_environment();
  } catch (error) {
    say(error.message);
  }
}

// Turns the view, moves the light or turns the environment by so many pixels on the screen.
function move(what, x, y) {
  const of_light = what === "light", turned = of_light ? view.light : view.camera, sign = of_light ? 1 : -1, step = 0.5 * k_degree;
  if (what === "environment") {
    view.turned += step * x;
    return redraw();
  }
  turned[0] += sign * step * x;
  turned[1] = clamp(turned[1] - sign * step * y, -85 * k_degree, 85 * k_degree);
  redraw();
}
function zoom(factor) {
  view.zoom = clamp(view.zoom * factor, 0.3, 4);
  redraw();
}
// Dragging with Shift or the right button moves what lights the object.
function moved_by(event) {
  if (event.shiftKey || event.buttons === 2) return has_lights() ? "light" : "environment";
  return controls.drag.value;
}

function follow(canvas) {
  const fingers = new Map();
  const apart = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, event);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const was_apart = fingers.size > 1 ? apart() : 0;
    fingers.set(event.pointerId, event);
    if (fingers.size > 1) zoom(apart() / Math.max(was_apart, 1));
    else move(moved_by(event), event.clientX - before.clientX, event.clientY - before.clientY);
  });
  for (const end of ["pointerup", "pointercancel"])
    canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(-0.001 * event.deltaY));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const arrow = { ArrowLeft: [-10, 0], ArrowRight: [10, 0], ArrowUp: [0, -10], ArrowDown: [0, 10] }[event.key];
    if (arrow) move(moved_by(event), ...arrow);
    else if (event.key === "+" || event.key === "-") zoom(event.key === "+" ? 1.1 : 1 / 1.1);
    else return;
    event.preventDefault();
  });
}

function show(which) {
  view.shown = which;
  redraw();
}

function start() {
  section.hidden = false;
  document.getElementById("without").hidden = true;
  load();
  for (const figure of figures) if (figure.querySelector("canvas")) follow(figure.querySelector("canvas"));
  for (const button of section.querySelectorAll("[data-show]"))
    button.addEventListener("click", () => show(button.dataset.show));
  document.addEventListener("keydown", (event) => {
    if (/^[0-9]$/.test(event.key) && !event.ctrlKey && !event.metaKey && !event.altKey) {
      const figure = figures[event.key - 1];
      if (event.key === "0" || figure) show(figure ? figure.dataset.material : "all");
    }
  });
  controls.addEventListener("input", ({ target }) => {
    if (target.type === "file") return;
    if (["environment", "mesh", "lamps", "others"].includes(target.name)) is_exposed = false;
    if (target.name === "environment") say(""), change_environment();
    else if (target.name === "stops") draw_soon(), show_state();
    else redraw();
  });
  controls.file.addEventListener("change", () => { if (controls.file.files[0]) open_environment(controls.file.files[0]); });
  section.addEventListener("dragover", (event) => event.preventDefault());
  section.addEventListener("drop", (event) => {
    event.preventDefault();
    if (has_floats && event.dataTransfer.files[0]) open_environment(event.dataTransfer.files[0]);
  });
  if (!has_floats) {
    controls.environment.disabled = controls.file.disabled = true;
    say("Environments need WebGL's EXT_color_buffer_float, which this browser does not offer. The pictures are under three lights.");
  }
  // The first light behind the object, the others off.
  controls.behind?.addEventListener("click", () => {
    const frame = axes(), [x, y, z] = data.light_behind;
    view.light = angles_of([0, 1, 2].map((i) => x * frame[0][i] + y * frame[1][i] + z * frame[2][i]));
    controls.others.checked = false;
    is_exposed = false;
    redraw();
  });
  controls.addEventListener("submit", (event) => event.preventDefault());
  controls.addEventListener("reset", () => {
    view = beginning();
    setTimeout(change_environment); // after the controls are back
  });
  window.addEventListener("resize", redraw);
  surface.addEventListener("webglcontextlost", (event) => {
    event.preventDefault();
    say("The browser took the graphics away. The pictures go on when it gives them back; if they do not, load the page again.");
  });
  surface.addEventListener("webglcontextrestored", () => {
    gl.getExtension("EXT_color_buffer_float");
    say("");
    load();
    redraw();
  });
  redraw();
}

for (const button of document.querySelectorAll(".copy"))
  button.addEventListener("click", () => {
    getSelection().selectAllChildren(button.nextElementSibling);
    button.textContent = document.execCommand("copy") ? "Copied" : "Selected: copy it from the menu";
  });
if (gl && figures.length) start();

return { scene, gl };
})();
