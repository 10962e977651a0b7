// The pictures of a page: what they show, how they respond to the pointer, and what draws them (painter.js).
"use strict";
const viewer = (() => {
const section = document.getElementById("viewer");
const controls = section.querySelector("form");
const figures = [...section.querySelectorAll("figure[data-material]")];
const wipe = section.querySelector(".wipe");
const k_degree = Math.PI / 180, k_smooth_samples = 64; // samples of a pixel at which noise becomes hardly visible
let data = null; // the message `common` of painter.js, and the exposure under lights of an exported page

// ---- The view ----------------------------------------------------------------------------------------------------

const angles_of = (w) => [Math.atan2(w[0], w[2]), Math.asin(w[1])];
const direction_of = ([azimuth, elevation]) =>
  [Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation), Math.cos(elevation) * Math.cos(azimuth)];
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

// The initial view: azimuth and elevation of the camera and of the first light, the environment's rotation, zoom and shown pictures.
const initial_view = () => ({ camera: [0, data.elevation], light: angles_of(data.lights[0].towards), turned: environment_azimuth, zoom: 1,
  shown: initial_pictures() });
// `environment_azimuth`: the initial rotation of the environment. `edit_figure`: the figure that shows edits, or null.
let view = null, environment_azimuth = 0, edit_figure = null;
const has_environment = () => controls.environment.value !== "none";
const has_lights = () => !has_environment() || controls.lamps.checked;

// The camera's axes in the world: x to the right, y up, z to the viewer.
function axes() {
  const [azimuth, elevation] = view.camera, s = Math.sin(azimuth), c = Math.cos(azimuth);
  return [[c, 0, -s], [-s * Math.sin(elevation), Math.cos(elevation), -c * Math.sin(elevation)], direction_of(view.camera)];
}
// The exposure under lights: that of the first material, so that pictures can be compared.
const exposures = new Map(), light_exposure = () => exposures.get(Math.min(...exposures.keys())) ?? data.exposure ?? 1;

// The scene of a picture with this aspect ratio, for the shaders.
function scene(aspect) {
  const mesh = data.meshes[controls.mesh.value], frame = axes(), distance = mesh.distance / view.zoom;
  const towards = data.lights.map((light, k) => k ? light.towards : direction_of(view.light));
  const half = Math.tan(data.fov / 2), stops = 2 ** controls.stops.value;
  return {
    mesh: controls.mesh.value, fov: data.fov, target: mesh.target,
    // A picture narrower than `data.aspect` fits the object to its width.
    eye: mesh.target.map((x, i) => x + distance * Math.max(1, data.aspect / aspect) * frame[2][i]),
    half: [half * aspect, half], frame, stops, around: has_environment(),
    exposure: (has_environment() ? last_drawn.exposure : light_exposure()) * stops,
    directions: towards.flat(),
    irradiances: data.lights.flatMap((light, k) => !has_lights() || k && !controls.others.checked ? [0, 0, 0] : light.irradiance),
    turned: view.turned, samples: has_environment() ? last_drawn.samples : 0,
  };
}

// ---- The painter -------------------------------------------------------------------------------------------------

// Draws in a worker if it may use WebGL, otherwise on the page. `send` is null if neither can draw.
function new_painter(receive) {
  const draw_on_page = () => ({ send: painting(document.createElement("canvas"), receive), end() {} });
  if (!window.OffscreenCanvas || !window.Worker) return draw_on_page();
  try {
    const text = `${lighting}\n${painting}
      const receive = painting(new OffscreenCanvas(1, 1), (message, transfers) => postMessage(message, transfers || []));
      onmessage = ({ data }) => receive && receive(data);`;
    const worker = new Worker(URL.createObjectURL(new Blob([text], { type: "text/javascript" })));
    worker.onmessage = ({ data }) => {
      if (data.kind !== "none") return receive(data);
      worker.terminate();
      painter = draw_on_page(); // may have WebGL if the worker has not
    };
    return { send: (message, transfers = []) => worker.postMessage(message, transfers), end: () => worker.terminate() };
  } catch {
    return draw_on_page();
  }
}
const figure_of = (subject) => figures.find((figure) => figure.dataset.material === String(subject));
let painter = null, has_floats = true, on_started = () => {};
// The number of the last request (a message `draw`), the last answer (`drawn`), and the promises of `settled` that wait for one.
let request_number = 0, last_drawn = { number: 0, samples: 0, exposure: 1 }, unsettled = [];
const materials_shown = new Set();

// Receives a message of the painter.
function receive(message) {
  const { kind } = message;
  if (kind === "ready" || kind === "none") {
    has_floats = message.has_floats;
    setTimeout(() => on_started(kind === "ready")); // after `painter` is assigned
  } else if (kind === "busy") {
    show_busy("Preparing the pictures: the browser compiles their shaders. Without a graphics card this takes a while.");
  } else if (kind === "environment") {
    show_busy("Preparing the environment …");
  } else if (kind === "picture") {
    const { subject, image } = message, canvas = figure_of(subject)?.querySelector("canvas");
    if (!canvas) return;
    if (!is_reading) show_busy("");
    show_image(image, canvas);
    if (subject !== "difference") latest_canvas = canvas;
    if (message.number < first_current_number) return;
    outdated.delete(String(subject));
    section.classList.remove("stored");
  } else if (kind === "drawn") {
    last_drawn = message;
    section.classList.toggle("refining", has_environment() && last_drawn.samples < k_smooth_samples);
    for (const { number, resolve } of unsettled) if (number <= message.number) resolve();
    unsettled = unsettled.filter(({ number }) => number > message.number);
  } else if (kind === "refused") {
    show_refusal(figure_of(message.subject), message.why);
  } else if (kind === "lost") {
    show_notice("The browser has lost its graphics context. The pictures return when it is restored; if they do not, reload the page.");
  } else if (kind === "restored") {
    show_notice("");
    restart();
  }
}
function show_image(image, canvas) {
  if (canvas.width !== image.width || canvas.height !== image.height) Object.assign(canvas, { width: image.width, height: image.height });
  if (image instanceof ImageBitmap) canvas.getContext("bitmaprenderer").transferFromImageBitmap(image);
  else canvas.getContext("2d").drawImage(image, 0, 0);
}
// Copies the picture of a canvas to another one.
function copy_picture(from, canvas) {
  if (from === canvas) return;
  if (!from.getContext("bitmaprenderer")) return show_image(from, canvas);
  const copy = new OffscreenCanvas(from.width, from.height);
  copy.getContext("2d").drawImage(from, 0, 0);
  show_image(copy.transferToImageBitmap(), canvas);
}
// A promise that resolves when the pictures show what was requested last.
const settled = () => new Promise((resolve) => {
  draw_now();
  unsettled.push({ number: request_number, resolve });
});

// ---- The page ----------------------------------------------------------------------------------------------------

// The next request begins from the first sample, sets a new exposure, and draws only one figure (null: all).
let frame_requested = false, is_new = true, reset_exposure = false, only_figure = null;
// The figures whose picture is outdated, the number of the first request without outdated pictures, and the canvas with the
// latest picture, which an outdated figure shows until its own arrives.
const outdated = new Set();
let first_current_number = 0, latest_canvas = null;
function mark_outdated(materials) {
  for (const material of materials) outdated.add(material);
  first_current_number = request_number + 1;
}
// Draws another scene.
function redraw() {
  mark_outdated(figures.map((figure) => figure.dataset.material));
  restart();
}
// Draws all pictures from their first sample.
function restart() {
  is_new = true, only_figure = null;
  draw_soon();
}
function draw_soon() {
  if (frame_requested || !painter || !data) return;
  frame_requested = true;
  requestAnimationFrame(draw_now);
}
function draw_now() {
  frame_requested = false;
  if (!painter || !data) return;
  show_state();
  const pictures = [];
  for (const figure of figures) {
    const canvas = figure.querySelector("canvas"), { material } = figure.dataset;
    if (figure.hidden || !canvas || only_figure !== null && material !== only_figure) continue;
    const aspect = document.fullscreenElement === section ? canvas.clientWidth / canvas.clientHeight : data.aspect;
    const width = Math.round(canvas.clientWidth * Math.min(window.devicePixelRatio, 2)), height = Math.round(width / aspect);
    if (width) pictures.push({ subject: material === "difference" ? material : Number(material), width, height, scene: scene(width / height) });
  }
  painter.send({ kind: "draw", number: ++request_number, pictures, is_new, reset_exposure, is_quick: only_figure !== null });
  is_new = reset_exposure = false;
}
// True if there are a measurement and a model, and if there is a picture of the subject. A picture that is missing takes no space.
const has_comparison = () => materials_shown.has("0") && materials_shown.has("1");
const is_available = (subject) => subject === "difference" ? has_comparison() : materials_shown.has(subject);
// True if there is only a model, without a measurement: then one figure shows it, or its edits.
const is_lone = () => edit_figure !== null && materials_shown.has("1") && !materials_shown.has("0");
// True if this choice of pictures remains possible when materials change.
const can_stay = (shown) => is_available(shown) || shown === "wipe" && has_comparison() ||
  shown === "all" && is_lone() && materials_shown.has(edit_figure);
// A narrow page shows one picture at a time, or two with the wipe.
function initial_pictures() {
  if (is_lone()) return view && can_stay(view.shown) ? view.shown : "1";
  return window.innerWidth <= 640 && has_comparison() ? "wipe" : "all";
}
function show_state() {
  const stops = Number(controls.stops.value), { shown } = view, wiped = shown === "wipe" && has_comparison();
  controls.exposure.value = (stops > 0 ? "+" : "") + stops + (Math.abs(stops) === 1 ? " stop" : " stops");
  section.querySelector(".pictures").classList.toggle("one", shown !== "all");
  section.querySelector(".pictures").classList.toggle("wiped", wiped);
  wipe.hidden = !wiped;
  section.classList.toggle("lone", is_lone());
  controls.lamps.disabled = !has_environment();
  section.querySelector("[value=environment]").disabled = !has_environment();
  if (!has_environment() && controls.drag.value === "environment") controls.drag.value = "view";
  const is_offered = { wipe: has_comparison(), all: materials_shown.size >= 2 };
  for (const button of section.querySelectorAll("[data-show]")) {
    const { show } = button.dataset;
    button.setAttribute("aria-pressed", show === shown);
    button.hidden = !(is_offered[show] ?? is_available(show));
  }
  // Lays out all figures before the first is drawn, since the size of each depends on the others.
  for (const figure of figures) {
    const { material } = figure.dataset, canvas = figure.querySelector("canvas");
    const is_all = shown === "all" && !(material === "difference" && materials_shown.has(edit_figure)); // edits take its place
    const is_shown = is_available(material) && (wiped ? "01".includes(material) : is_all || shown === material);
    const is_late = figure.hidden && is_shown && outdated.has(material) && material !== "difference";
    if (is_late && latest_canvas && canvas) copy_picture(latest_canvas, canvas);
    figure.hidden = !is_shown;
  }
}
// Replaces a picture by the reason why it cannot be drawn.
function show_refusal(figure, why) {
  const paragraph = document.createElement("p");
  paragraph.className = "refused";
  paragraph.textContent = "This browser does not take the shader: " + why;
  figure?.querySelector("canvas")?.replaceWith(paragraph);
}
const show_notice = (text) => Object.assign(document.getElementById("said"), { textContent: text, hidden: !text });
function show_busy(text) {
  const status = document.getElementById("busy");
  if (status.textContent !== text) status.textContent = text;
}
function turn_environments_off() {
  controls.environment.value = "none";
  controls.environment.disabled = controls.file.disabled = true;
  show_notice("Environments need WebGL's EXT_color_buffer_float, which this browser does not offer. The pictures are under three lights.");
  redraw();
}
let images = {}, is_reading = false; // environments by their names in the list
// Shows the pictures under the chosen environment.
function change_environment() {
  const image = images[controls.environment.value];
  if (image) {
    environment_azimuth = view.turned = light.facing_azimuth(image);
    painter.send({ kind: "environment", image });
  }
  redraw();
}
async function open_environment(file, show_error = show_notice) {
  try {
    show_error("");
    is_reading = true;
    show_busy(`Reading ${file.name} …`);
    await new Promise((resolve) => setTimeout(resolve, 50)); // so that the page shows this before the long reading
    images.file = await light.read_file(file);
    controls.environment.querySelector("[value=file]")?.remove();
    controls.environment.add(new Option(file.name, "file", false, true));
    show_error("");
    is_reading = false;
    change_environment();
  } catch (error) {
    is_reading = false;
    show_busy("");
    show_error(error.message);
  }
}
// Rotates the view, moves the light or rotates the environment, for a drag of x, y pixels.
function drag(target, x, y) {
  const is_light = target === "light", angles = is_light ? view.light : view.camera, sign = is_light ? 1 : -1, step = 0.5 * k_degree;
  if (target === "environment") {
    view.turned += step * x;
    return redraw();
  }
  angles[0] += sign * step * x;
  angles[1] = clamp(angles[1] - sign * step * y, -85 * k_degree, 85 * k_degree);
  redraw();
}
function zoom(factor) {
  view.zoom = clamp(view.zoom * factor, 0.3, 4);
  redraw();
}
// The object of a drag. With Shift or the right button a drag moves the light or the environment.
function drag_target(event) {
  if (event.shiftKey || event.buttons === 2) return has_lights() ? "light" : "environment";
  return controls.drag.value;
}
function follow_pointer(canvas) {
  const fingers = new Map();
  const finger_distance = () => {
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
    const distance_before = fingers.size > 1 ? finger_distance() : 0;
    fingers.set(event.pointerId, event);
    if (fingers.size > 1) zoom(finger_distance() / Math.max(distance_before, 1));
    else drag(drag_target(event), event.clientX - before.clientX, event.clientY - before.clientY);
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(-0.001 * event.deltaY));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const arrow = { ArrowLeft: [-10, 0], ArrowRight: [10, 0], ArrowUp: [0, -10], ArrowDown: [0, 10] }[event.key];
    if (arrow) drag(drag_target(event), ...arrow);
    else if (event.key === "+" || event.key === "-") zoom(event.key === "+" ? 1.1 : 1 / 1.1);
    else return;
    event.preventDefault();
  });
}
function show_pictures(shown) {
  view.shown = shown;
  restart();
}
// One picture on the whole screen, or the wipe if there are two to compare.
function show_full_screen() {
  if (has_comparison()) view.shown = "wipe";
  else if (view.shown === "all") [view.shown] = materials_shown;
  section.requestFullscreen().catch(() => {}); // the browser may refuse
}
function add_listeners() {
  for (const figure of figures) follow_pointer(figure.querySelector("canvas"));
  for (const button of section.querySelectorAll("[data-show]")) button.addEventListener("click", () => show_pictures(button.dataset.show));
  document.addEventListener("keydown", (event) => {
    if (event.target.closest?.("input, select, textarea") || event.ctrlKey || event.metaKey || event.altKey || !view) return;
    if (/^[0-9]$/.test(event.key)) {
      const figure = figures[event.key - 1];
      if (event.key === "0" || figure && is_available(figure.dataset.material)) show_pictures(figure ? figure.dataset.material : "all");
    } else if (event.key === "w" && has_comparison()) {
      show_pictures("wipe");
    } else if (event.key === "f" && has_comparison()) {
      show_pictures(view.shown === "0" ? "1" : "0");
    } else if (event.key === "p" && document.fullscreenEnabled) {
      show_full_screen();
    }
  });
  controls.addEventListener("input", ({ target }) => {
    if (target.type === "file") return;
    if (["environment", "mesh", "lamps", "others"].includes(target.name)) reset_exposure = true;
    if (target.name === "stops") return draw_soon();
    if (target.name !== "environment") return redraw();
    show_notice("");
    change_environment();
  });
  wipe.addEventListener("input", () => section.querySelector(".pictures").style.setProperty("--wiped", wipe.value + "%"));
  controls.file.addEventListener("change", () => { if (controls.file.files[0]) open_environment(controls.file.files[0]); });
  if (edit_figure === null) { // otherwise the page itself handles dropped files
    document.addEventListener("dragover", (event) => event.preventDefault());
    document.addEventListener("drop", (event) => {
      event.preventDefault();
      if (event.dataTransfer.files[0] && has_floats) open_environment(event.dataTransfer.files[0]);
    });
  }
  controls.full.hidden = !document.fullscreenEnabled;
  controls.full.addEventListener("click", show_full_screen);
  section.addEventListener("fullscreenchange", restart);
  // Puts the first light behind the object and turns the others off.
  controls.behind?.addEventListener("click", () => {
    const frame = axes(), [x, y, z] = data.light_behind;
    view.light = angles_of([0, 1, 2].map((i) => x * frame[0][i] + y * frame[1][i] + z * frame[2][i]));
    controls.others.checked = false;
    reset_exposure = true;
    redraw();
  });
  controls.addEventListener("submit", (event) => event.preventDefault());
  controls.addEventListener("reset", () => setTimeout(() => { // after the controls are reset
    choose_initial_light();
    view = initial_view();
    change_environment();
  }));
  new ResizeObserver(() => restart()).observe(section.querySelector(".pictures"));
}
// The address "#lights" selects three lights at first.
const choose_initial_light = () => { if (location.hash === "#lights" || !has_floats) controls.environment.value = "none"; };

// Starts with the message `common` of painter.js. Resolves to false if the browser cannot draw. The painter finds
// out, because requesting a context here would block the page. `figure`: the figure that shows edits of the second one.
async function start(common, figure = null) {
  edit_figure = figure;
  const can_draw = await new Promise((resolve) => {
    on_started = resolve;
    painter = new_painter(receive);
  });
  if (!can_draw) painter = null;
  if (!painter) return false;
  section.hidden = false;
  data = common;
  images.soft = light.soft_box();
  images.studio = { ...data.environment, texels: light.decode_rgbe(Uint8Array.from(atob(data.environment.rgbe), (c) => c.charCodeAt(0))) };
  painter.send({ kind: "common", data });
  choose_initial_light();
  view = initial_view();
  add_listeners();
  change_environment();
  if (!has_floats) turn_environments_off();
  return true;
}
// Sets the material of a figure; null removes it. With `is_edited` the figure shows the edit of `set_edit`.
function set_material(index, material, is_edited = false) {
  materials_shown[material ? "add" : "delete"](String(index));
  if (material?.exposure) exposures.set(index, material.exposure);
  else exposures.delete(index);
  mark_outdated([String(index), "difference"]);
  painter.send({ kind: "material", index, material, is_edited }, material && material.bytes ? [material.bytes.buffer] : []);
  if (!can_stay(view.shown)) view.shown = initial_pictures();
  else if (material && view.shown === "1" && String(index) === edit_figure) view.shown = edit_figure;
  restart();
}
// Draws only this picture, with this edit.
function set_edit(index, edit) {
  painter.send({ kind: "edit", index, edit });
  if (view.shown !== "all") view.shown = String(index);
  is_new = true, only_figure = String(index);
  draw_soon();
}

for (const button of document.querySelectorAll(".copy"))
  button.addEventListener("click", () => {
    getSelection().selectAllChildren(button.nextElementSibling);
    button.textContent = document.execCommand("copy") ? "Copied" : "Selected: copy it from the menu";
  });

// While a fit is running, pictures take only a few samples.
const set_resting = (is_resting) => painter?.send({ kind: "resting", is_resting });

const lose = (is_lost) => painter.send({ kind: "lose", is_lost }); // for tests
return { start, set_material, set_edit, open_environment, set_resting, settled, scene, lose, can_preview: () => has_floats };
})();
