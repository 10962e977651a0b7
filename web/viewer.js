// The pictures of a page: what they show, how they follow the hand, and who draws them (painter.js).
"use strict";
const viewer = (() => {
const section = document.getElementById("viewer");
const controls = section.querySelector("form");
const figures = [...section.querySelectorAll("figure[data-material]")];
const wipe = section.querySelector(".wipe");
const k_degree = Math.PI / 180;
let data = null; // what painter.js calls common, and the exposure under lights

// ---- What is seen ------------------------------------------------------------------------------------------------

const angles_of = (w) => [Math.atan2(w[0], w[2]), Math.asin(w[1])];
const direction_of = ([azimuth, elevation]) =>
  [Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation), Math.cos(elevation) * Math.cos(azimuth)];
const clamp = (x, least, most) => Math.min(Math.max(x, least), most);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

// Azimuths and elevations of the camera and of the first light.
const beginning = () =>
  ({ camera: [0, data.elevation], light: angles_of(data.lights[0].towards), turned: facing, zoom: 1, shown: first_shown() });
let view = null, facing = 0;
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
  const half = Math.tan(data.fov / 2), stops = 2 ** controls.stops.value;
  return {
    mesh: controls.mesh.value, fov: data.fov, target: mesh.target,
    // Where the picture is narrow, it is its width that holds the object.
    eye: mesh.target.map((x, i) => x + distance * Math.max(1, data.aspect / aspect) * frame[2][i]),
    half: [half * aspect, half], frame, stops, around: has_environment(),
    exposure: (has_environment() ? drawn.exposure : data.exposure) * stops,
    directions: towards.flat(),
    irradiances: data.lights.flatMap((light, k) => !has_lights() || k && !controls.others.checked ? [0, 0, 0] : light.irradiance),
    turned: view.turned, samples: has_environment() ? drawn.samples : 0,
  };
}

// ---- Who draws ---------------------------------------------------------------------------------------------------

// A worker, where it may use WebGL, or the page itself. `receive` is null where neither can.
function new_painter(take) {
  const on_page = () => {
    const send = painting(document.createElement("canvas"), take);
    return { send, end() {} };
  };
  if (!window.OffscreenCanvas || !window.Worker) return on_page();
  try {
    const text = `${lighting}\n${painting}\nconst receive = painting(new OffscreenCanvas(1, 1), (message, gifts) => postMessage(message, gifts || []));
      onmessage = ({ data }) => receive && receive(data);`;
    const worker = new Worker(URL.createObjectURL(new Blob([text], { type: "text/javascript" })));
    // A worker without WebGL: the page itself tries.
    worker.onmessage = ({ data }) => data.kind === "none" ? (worker.terminate(), painter = on_page()) : take(data);
    return { send: (message, gifts = []) => worker.postMessage(message, gifts), end: () => worker.terminate() };
  } catch {
    return on_page();
  }
}

const figure_of = (of) => figures.find((figure) => figure.dataset.material === String(of));
let painter = null, number = 0, drawn = { number: 0, samples: 0, exposure: 1 }, waiting = [], has_floats = true, known = new Set(), began = () => {};

function take(message) {
  const { kind } = message;
  if (kind === "ready" || kind === "none") {
    has_floats = message.has_floats;
    setTimeout(() => began(kind === "ready")); // once there is a painter
  } else if (kind === "busy") {
    busy("Preparing the pictures: the browser compiles their shaders. Without a graphics card this takes a while.");
  } else if (kind === "environment") {
    busy("Preparing the environment ..");
  } else if (kind === "picture") {
    const canvas = figure_of(message.of)?.querySelector("canvas"), { image } = message;
    if (!canvas) return;
    if (!is_reading) busy("");
    if (canvas.width !== image.width || canvas.height !== image.height) canvas.width = image.width, canvas.height = image.height;
    if (image instanceof ImageBitmap) canvas.getContext("bitmaprenderer").transferFromImageBitmap(image);
    else canvas.getContext("2d").drawImage(image, 0, 0);
  } else if (kind === "drawn") {
    drawn = message;
    waiting = waiting.filter((of) => of.number > message.number || (of.done(), false));
  } else if (kind === "refused") {
    refuse(figure_of(message.of), message.why);
  } else if (kind === "lost") {
    say("The browser took the graphics away. The pictures go on when it gives them back; if they do not, load the page again.");
  } else if (kind === "restored") {
    say("");
    redraw();
  }
}

// A promise that is kept when the pictures show what was asked for last.
const settled = () => new Promise((done) => {
  draw_now();
  waiting.push({ number, done });
});

// ---- The page ----------------------------------------------------------------------------------------------------

let is_due = false, is_new = true, exposes = false;
// Draws everything anew.
function redraw() {
  is_new = true;
  draw_soon();
}
function draw_soon() {
  if (is_due || !painter || !data) return;
  is_due = true;
  requestAnimationFrame(draw_now);
}
function draw_now() {
  is_due = false;
  if (!painter || !data) return;
  show_state();
  const pictures = [];
  for (const figure of figures) {
    const canvas = figure.querySelector("canvas"), { material } = figure.dataset;
    if (figure.hidden || !canvas) continue;
    const width = Math.round(canvas.clientWidth * Math.min(window.devicePixelRatio, 2)), height = Math.round(width / data.aspect);
    if (width) pictures.push({ of: material === "difference" ? material : Number(material), width, height, scene: scene(width / height) });
  }
  painter.send({ kind: "draw", number: ++number, pictures: pictures.length ? pictures : [], is_new, exposes });
  is_new = exposes = false;
}
// Pictures of nothing have no place.
const is_there = (of) => of === "difference" ? known.has("0") && known.has("1") : known.has(of);
// On a narrow page one picture at a time, of which the wipe shows two.
const first_shown = () => window.innerWidth <= 640 && is_there("difference") ? "wipe" : "all";
function show_state() {
  const stops = Number(controls.stops.value), { shown } = view, wiped = shown === "wipe" && is_there("difference");
  controls.exposure.value = (stops > 0 ? "+" : "") + stops + (Math.abs(stops) === 1 ? " stop" : " stops");
  section.querySelector(".pictures").classList.toggle("one", shown !== "all");
  section.querySelector(".pictures").classList.toggle("wiped", wiped);
  wipe.hidden = !wiped;
  controls.lamps.disabled = !has_environment();
  section.querySelector("[value=environment]").disabled = !has_environment();
  if (!has_environment() && controls.drag.value === "environment") controls.drag.value = "view";
  for (const button of section.querySelectorAll("[data-show]")) {
    const { show } = button.dataset;
    button.setAttribute("aria-pressed", show === shown);
    button.hidden = show === "wipe" ? !is_there("difference") : show === "all" ? known.size < 2 : !is_there(show);
  }
  // All of them take their places before the first is drawn, whose size depends on the others.
  for (const figure of figures) {
    const { material } = figure.dataset;
    figure.hidden = !is_there(material) || (wiped ? !["0", "1"].includes(material) : shown !== "all" && shown !== material);
  }
}
// Says in the place of a picture why there is none.
function refuse(figure, why) {
  const refused = document.createElement("p");
  refused.className = "refused";
  refused.textContent = "This browser does not take the shader: " + why;
  figure?.querySelector("canvas")?.replaceWith(refused);
}
function say(text) {
  const said = document.getElementById("said");
  said.textContent = text;
  said.hidden = !text;
}
function busy(text) {
  const at = document.getElementById("busy");
  if (at.textContent !== text) at.textContent = text;
}
function without_floats() {
  controls.environment.value = "none";
  controls.environment.disabled = controls.file.disabled = true;
  say("Environments need WebGL's EXT_color_buffer_float, which this browser does not offer. The pictures are under three lights.");
  redraw();
}

// Shows the pictures under another environment, or the same anew.
let images = {}, is_reading = false;
function change_environment() {
  const image = images[controls.environment.value];
  if (image) {
    facing = light.facing(image), view.turned = facing;
    painter.send({ kind: "environment", image });
  }
  redraw();
}
async function open_environment(file) {
  try {
    say("");
    is_reading = true;
    busy(`Reading ${file.name} ..`);
    await new Promise((painted) => setTimeout(painted, 50)); // so that the page says so, for reading takes its time
    images.file = await light.read_file(file);
    controls.environment.querySelector("[value=file]")?.remove();
    controls.environment.add(new Option(file.name, "file", false, true));
    say("");
    is_reading = false;
    change_environment();
  } catch (error) {
    is_reading = false;
    busy("");
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

function listen() {
  for (const figure of figures) follow(figure.querySelector("canvas"));
  for (const button of section.querySelectorAll("[data-show]"))
    button.addEventListener("click", () => show(button.dataset.show));
  document.addEventListener("keydown", (event) => {
    if (event.target.closest?.("input, select, textarea") || event.ctrlKey || event.metaKey || event.altKey || !view) return;
    if (/^[0-9]$/.test(event.key)) {
      const figure = figures[event.key - 1];
      if (event.key === "0" || figure && is_there(figure.dataset.material)) show(figure ? figure.dataset.material : "all");
    } else if (event.key === "w" && is_there("difference")) {
      show("wipe");
    } else if (event.key === "f" && is_there("difference")) {
      show(view.shown === "0" ? "1" : "0");
    }
  });
  controls.addEventListener("input", ({ target }) => {
    if (target.type === "file") return;
    if (["environment", "mesh", "lamps", "others"].includes(target.name)) exposes = true;
    if (target.name === "environment") say(""), change_environment();
    else if (target.name === "stops") draw_soon();
    else redraw();
  });
  wipe.addEventListener("input", () => section.querySelector(".pictures").style.setProperty("--wiped", wipe.value + "%"));
  controls.file.addEventListener("change", () => { if (controls.file.files[0]) open_environment(controls.file.files[0]); });
  section.addEventListener("dragover", (event) => event.preventDefault());
  section.addEventListener("drop", (event) => {
    const file = event.dataTransfer.files[0];
    if (!file || !/\.(hdr|exr)$/i.test(file.name) && !section.dataset.alone) return;
    event.preventDefault(), event.stopPropagation();
    if (has_floats) open_environment(file);
  });
  // The first light behind the object, the others off.
  controls.behind?.addEventListener("click", () => {
    const frame = axes(), [x, y, z] = data.light_behind;
    view.light = angles_of([0, 1, 2].map((i) => x * frame[0][i] + y * frame[1][i] + z * frame[2][i]));
    controls.others.checked = false;
    exposes = true;
    redraw();
  });
  controls.addEventListener("submit", (event) => event.preventDefault());
  controls.addEventListener("reset", () => setTimeout(() => { // after the controls are back
    start_light();
    view = beginning();
    change_environment();
  }));
  new ResizeObserver(() => redraw()).observe(section.querySelector(".pictures"));
}
// "#lights" after the address: three lights first.
const start_light = () => { if (location.hash === "#lights" || !has_floats) controls.environment.value = "none"; };

// Begins with `common`, of painter.js; resolves to false where the browser cannot draw. To ask for a context would keep the page
// waiting: the painter tells.
async function start(common) {
  const draws = await new Promise((done) => {
    began = done;
    painter = new_painter(take);
  });
  if (!draws) return painter = null, false;
  section.hidden = false;
  data = common;
  images.studio = { ...data.environment, texels: light.decoded(Uint8Array.from(atob(data.environment.rgbe), (c) => c.charCodeAt(0))) };
  painter.send({ kind: "common", data });
  start_light();
  view = beginning();
  listen();
  facing = light.facing(images.studio), view.turned = facing;
  painter.send({ kind: "environment", image: images.studio });
  if (!has_floats) without_floats();
  return true;
}
// Gives the picture of that figure a material; null: none.
function set_material(index, material) {
  known[material ? "add" : "delete"](String(index));
  if (material && index === 0 && material.exposure) data.exposure = material.exposure;
  painter.send({ kind: "material", index, material }, material && material.bytes ? [material.bytes.buffer] : []);
  view.shown = is_there(view.shown) || view.shown === "wipe" && is_there("difference") ? view.shown : first_shown();
  redraw();
}

for (const button of document.querySelectorAll(".copy"))
  button.addEventListener("click", () => {
    getSelection().selectAllChildren(button.nextElementSibling);
    button.textContent = document.execCommand("copy") ? "Copied" : "Selected: copy it from the menu";
  });

// While somebody else computes, pictures converge no further than they have to.
const rest = (is_resting) => painter?.send({ kind: "rest", is_resting });

return { scene, start, rest, set_material, show, settled, lose: (is_lost) => painter.send({ kind: "lose", is_lost }) };
})();
