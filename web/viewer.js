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
const beginning = () => ({ camera: [0, data.elevation], light: angles_of(data.lights[0].towards), zoom: 1, shown: "all" });
let view = beginning();

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
    exposure: data.exposure * 2 ** controls.stops.value,
    directions: towards.flat(),
    irradiances: data.lights.flatMap((light, k) => k && !controls.others.checked ? [0, 0, 0] : light.irradiance),
  };
}

// World to clip coordinates, columns one after the other.
function to_clip({ eye, target, half, frame }) {
  const distance = Math.hypot(...eye.map((x, i) => x - target[i]));
  const near = Math.max(distance - 4, distance * 0.02), far = distance + 4;
  const rows = [frame[0].map((x) => x / half[0]), frame[1].map((x) => x / half[1]),
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

// A program with a material's numbers. Throws what the browser has against its text.
function new_material(gl, index) {
  const program = gl.createProgram();
  const stages = [compiled(gl, gl.VERTEX_SHADER, data.vertex),
    compiled(gl, gl.FRAGMENT_SHADER, document.getElementById("glsl-" + index).textContent)];
  for (const stage of stages) gl.attachShader(program, stage);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS))
    throw new Error(stages.map((stage) => gl.getShaderInfoLog(stage)).join(" ") + gl.getProgramInfoLog(program));
  gl.useProgram(program);
  const place = (name) => gl.getUniformLocation(program, name), { block, vectors, textures = [] } = data.materials[index];
  const material = { program, place, block: null, textures: [] };
  if (block) {
    material.block = gl.createBuffer();
    gl.bindBuffer(gl.UNIFORM_BUFFER, material.block);
    gl.bufferData(gl.UNIFORM_BUFFER, bytes_of(block), gl.STATIC_DRAW);
    gl.uniformBlockBinding(program, gl.getUniformBlockIndex(program, "PmNumbers"), 0);
  }
  if (vectors) gl.uniform4fv(place("ggx_numbers"), new Float32Array(bytes_of(vectors).buffer));
  textures.forEach((of, unit) => {
    material.textures.push(new_texture(gl, of));
    gl.uniform1i(place(of.sampler), unit);
  });
  return material;
}

function new_mesh(gl, { vertices, triangles }) {
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
  return { array, corners: indices.length / 2 };
}

// One context, for a browser gives a page but a few, draws every picture in turn; each is then copied to its place.
const surface = document.createElement("canvas");
const gl = surface.getContext("webgl2", { alpha: false, antialias: true });
let materials = {}, meshes = {};

function load() {
  materials = {}, meshes = {};
  for (const name in data.meshes) meshes[name] = new_mesh(gl, data.meshes[name]);
  for (const figure of figures) {
    const index = figure.dataset.material;
    try {
      materials[index] = new_material(gl, index);
    } catch (error) {
      const refused = document.createElement("p");
      refused.className = "refused";
      refused.textContent = "This browser does not take the shader: " + error.message;
      figure.querySelector("canvas").replaceWith(refused);
    }
  }
}

function draw(index, canvas) {
  const width = Math.round(canvas.clientWidth * Math.min(window.devicePixelRatio, 2));
  const height = Math.round(width / data.aspect);
  if (width === 0) return;
  if (canvas.width !== width || canvas.height !== height) canvas.width = width, canvas.height = height;
  if (surface.width !== width || surface.height !== height) surface.width = width, surface.height = height;
  const { program, place, block, textures } = materials[index], now = scene(width / height);
  gl.viewport(0, 0, width, height);
  gl.clearColor(...data.background, 1);
  gl.enable(gl.DEPTH_TEST);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.useProgram(program);
  gl.uniformMatrix4fv(place("to_clip"), false, to_clip(now));
  gl.uniform3fv(place("eye"), now.eye);
  gl.uniform1f(place("exposure"), now.exposure);
  gl.uniform3fv(place("light_direction"), now.directions);
  gl.uniform3fv(place("light_irradiance"), now.irradiances);
  gl.bindBufferBase(gl.UNIFORM_BUFFER, 0, block);
  textures.forEach((of, unit) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(of.place, of.texture);
  });
  const { array, corners } = meshes[now.mesh];
  gl.bindVertexArray(array);
  gl.drawElements(gl.TRIANGLES, corners, gl.UNSIGNED_SHORT, 0);
  canvas.getContext("2d").drawImage(surface, 0, 0);
}

// ---- The page ----------------------------------------------------------------------------------------------------

let is_due = false;
function redraw() {
  if (is_due || !gl || gl.isContextLost()) return;
  is_due = true;
  requestAnimationFrame(() => {
    is_due = false;
    const stops = Number(controls.stops.value);
    controls.exposure.value = (stops > 0 ? "+" : "") + stops + (Math.abs(stops) === 1 ? " stop" : " stops");
    section.querySelector(".pictures").classList.toggle("one", view.shown !== "all");
    for (const button of section.querySelectorAll("[data-show]"))
      button.setAttribute("aria-pressed", button.dataset.show === view.shown);
    // All of them take their places before the first is drawn, whose size depends on the others.
    for (const figure of figures) figure.hidden = view.shown !== "all" && view.shown !== figure.dataset.material;
    for (const figure of figures) {
      const index = figure.dataset.material;
      if (!figure.hidden && materials[index]) draw(index, figure.querySelector("canvas"));
    }
  });
}

// Turns the view or moves the light by so many pixels on the screen.
function move(of_light, x, y) {
  const turned = of_light ? view.light : view.camera, sign = of_light ? 1 : -1, step = 0.5 * k_degree;
  turned[0] += sign * step * x;
  turned[1] = clamp(turned[1] - sign * step * y, -85 * k_degree, 85 * k_degree);
  redraw();
}
function zoom(factor) {
  view.zoom = clamp(view.zoom * factor, 0.3, 4);
  redraw();
}
const moves_light = (event) => event.shiftKey || event.buttons === 2 || controls.drag.value === "light";

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
    else move(moves_light(event), event.clientX - before.clientX, event.clientY - before.clientY);
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
    if (arrow) move(event.shiftKey || controls.drag.value === "light", ...arrow);
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
  controls.addEventListener("input", redraw);
  controls.addEventListener("submit", (event) => event.preventDefault());
  controls.addEventListener("reset", () => {
    view = beginning();
    setTimeout(redraw); // after the controls are back
  });
  window.addEventListener("resize", redraw);
  surface.addEventListener("webglcontextlost", (event) => event.preventDefault());
  surface.addEventListener("webglcontextrestored", () => { load(); redraw(); });
  redraw();
}

for (const button of document.querySelectorAll(".copy"))
  button.addEventListener("click", () => {
    getSelection().selectAllChildren(button.nextElementSibling);
    button.textContent = document.execCommand("copy") ? "Copied" : "Selected: copy it from the menu";
  });
if (gl && figures.length) start();

return { scene };
})();
