// The page that fits lobes to a measurement. Workers do the long computations: working.js fits, painter.js draws.
"use strict";
const app = (() => {
const $ = (id) => document.getElementById(id);
const set_shown = (id, shown) => { $(id).hidden = !shown; }, hide = (...ids) => ids.forEach((id) => set_shown(id, false));

// ---- The files of the folder -------------------------------------------------------------------------------------

// A page from a disk may not fetch data, so each file of `data` is a script that calls srbf_given. The page in one file has texts.
const k_max_bytes = 2 ** 28, requested = {}, page_parsed = new Promise((resolve) => document.addEventListener("DOMContentLoaded", resolve));
window.srbf_given = (name, text) => requested[name].resolve(text);
function load_data(name) {
  if (requested[name]) return requested[name].promise;
  const request = requested[name] = {};
  request.promise = page_parsed.then(() => new Promise((resolve, reject) => {
    request.resolve = resolve;
    const embedded = $(`data/${name}`);
    if (embedded) return resolve(embedded.textContent);
    const script = document.createElement("script");
    script.src = `data/${name}.js`;
    script.onerror = () => reject(new Error(`data/${name}.js is missing beside this page`));
    document.head.append(script);
  }));
  return request.promise;
}

// ---- The worker that fits ----------------------------------------------------------------------------------------

// `worker` holds the file that the page shows, `idle_worker` has none, and `cache` has the unpacked files that every worker needs.
let worker = null, idle_worker = null, question_count = 0, cache = null;
const worker_url = URL.createObjectURL(new Blob([`${binding}\n${working}\nworking();`], { type: "text/javascript" }));

// A worker with the module. Questions that are unanswered when it ends are rejected with null.
function new_worker() {
  const thread = new Worker(worker_url), unanswered = new Map(), host = {
    is_busy: () => unanswered.size > 0,
    ask: (question) => new Promise((resolve, reject) => {
      const id = ++question_count;
      unanswered.set(id, { resolve, reject });
      thread.postMessage({ ...question, id });
    }),
    end() {
      thread.terminate();
      for (const { reject } of unanswered.values()) reject(null);
      unanswered.clear();
    },
  };
  thread.onmessage = ({ data }) => {
    const question = unanswered.get(data.id);
    if (question) {
      unanswered.delete(data.id);
      host.is_trapped ||= data.is_trap;
      if ("error" in data) question.reject(new Error(data.error));
      else question.resolve(data.result);
    } else if (host === worker) {
      if ("draft" in data) show_draft(data.draft);
      else if (saving) saving.progress = data.progress;
      else if (is_editing) show_edit_progress(data);
      else show_progress(data);
    }
  };
  host.begun = (async () => {
    cache ??= { module: await load_data("module"), studio: await load_data("studio"), prepared: await load_data("prepared") };
    const answer = await host.ask({ kind: "begin", ...cache });
    cache = answer.cache;
    return answer.viewer;
  })();
  return host;
}

// ---- The display -------------------------------------------------------------------------------------------------

const k_level = ["good", "good", "fair", "poor"], k_good_energy_error = 0.02; // of the incident light
// The file that the page shows, its fitted model (or the model in the file), and the edited model. `run_id` counts files and fits:
// an action whose number is no longer this one has been replaced by a later one.
let file = null, fitted = null, edited = null, run_id = 0, fit_start = 0, can_draw = false;
let saving = null; // the file being written: its name, the start time and the progress (0: unknown)

const with_commas = (n) => n.toLocaleString("en");
const two_digits = (x) => Number(x.toPrecision(2)).toString();
const stem = (name) => name.replace(/(.)\.[^.]*$/, "$1");

const show_text = (id, text) => Object.assign($(id), { textContent: text, hidden: text === "" });
const show_reading_status = (text) => show_text("reading", text);
function show_failure(text) {
  show_text("failure", text);
  if (text) $("failure").scrollIntoView({ block: "nearest" });
}
function show_progress({ progress, stage }) {
  document.querySelector("#working progress").value = progress;
  $("stage").textContent = `${stage}, ${progress_text(progress, fit_start)}`;
}
// The completed percentage and, once it can be estimated, the remaining time.
function progress_text(progress, start) {
  const seconds = (performance.now() - start) / 1000, remaining = progress > 0.05 ? seconds * (1 - progress) / progress : NaN;
  return `${Math.round(100 * progress)} %` + (remaining >= 1 ? `, about ${Math.ceil(remaining)} s left` : "");
}
const show_edit_progress = ({ progress }) => { $("edit_status").textContent = `Computing the edited model, ${Math.round(100 * progress)} % …`; };
function show_saving() {
  const { name, start, progress } = saving, bar = document.querySelector("#writing progress");
  set_shown("writing", true);
  if (progress) bar.value = progress;
  else bar.removeAttribute("value");
  const duration = progress ? `, ${progress_text(progress, start)}` : ` for ${Math.ceil((performance.now() - start) / 1000)} s`;
  $("saved").textContent = `Writing ${name}${duration} …`;
}
function show_working(stage) {
  set_shown("working", stage !== "");
  document.querySelector("#working progress").value = 0;
  $("stage").textContent = stage;
  viewer.set_resting(stage !== "");
}
function show_slices(drawings) {
  set_shown("plots", true);
  document.querySelector("#plots .slices").innerHTML = drawings;
}
function show_measurement(measurement) {
  const samples = measurement.samples ? `, ${with_commas(measurement.samples)} samples` : "";
  const sides = measurement.twoSided ? ", reflection and transmission" : "";
  $("about").textContent = `${measurement.format}, ${with_commas(measurement.bytes)} bytes${samples}${sides}`
    + (measurement.isotropic ? "" : "; it depends on rotation about the normal, so only the fit has a picture")
    + measurement.notes.map((note) => `; ${note}`).join("");
  if (!can_draw) return;
  viewer.set_material(1, null);
  viewer.set_material(0, measurement.material);
  show_drawing();
}
// Shows a waiting message until the first picture arrives. `drawing_id` counts the calls.
let drawing_id = 0;
async function show_drawing() {
  const own_drawing = ++drawing_id, { classList } = $("viewer");
  classList.add("drawing");
  await viewer.settled();
  if (own_drawing === drawing_id) classList.remove("drawing");
}
// Describes the source of a ready material, says whether it is edited, and shows its licence terms.
function show_ready() {
  const { kind, error, about, terms } = file.link.dataset;
  $("name").textContent = edited ? `Edited: made from ${kind}` : kind;
  $("about").textContent = edited ? `ΔE ${error} before the edit. An edited material has no measurement to compare with. `
    : `${stem(file.name)}, ${with_commas(fitted.bytes)} bytes. ${about} `;
  $("about").insertAdjacentHTML("beforeend", terms); // with a link
}
function show_model(model) {
  if (file.link) show_ready();
  else $("about").textContent = `A model of ${with_commas(model.bytes)} bytes. Drop its measurement to fit it anew.`;
  set_shown("saving", true);
  if (!can_draw) return;
  viewer.set_material(0, null);
  viewer.set_material(1, model.material);
  show_drawing();
}
function describe_errors({ seen, smoothed, headline, twoSided, energyError }) {
  if (twoSided) return `The reflected and transmitted light have an error of at most ${two_digits(energyError)} of the incident light.`;
  if (!smoothed) return `The difference is ${headline} (1 is just noticeable).`;
  return `The difference is ${smoothed.verdict} once the measurement's noise is smoothed: ΔE_ITP ${two_digits(smoothed.deltaE)}, and ` +
    `${two_digits(seen.deltaE)} with the noise (1 is just noticeable).`;
}
function show_draft(draft) {
  $("verdict").className = "";
  $("verdict").textContent = draft.last ? `The fit of ${with_commas(draft.bytes)} bytes is shown. Its errors are being measured.`
    : `A first draft of ${with_commas(draft.bytes)} bytes is shown. The fit goes on.`;
  show_slices(draft.slices);
  if (!can_draw) return;
  viewer.set_material(1, draft.material);
  show_drawing();
}
function show_fit(report) {
  const { seen, smoothed } = report, level_of_energy = report.energyError <= k_good_energy_error ? "good" : "fair";
  $("verdict").className = seen ? k_level[(smoothed ?? seen).level] : level_of_energy;
  $("verdict").textContent = describe_errors(report);
  const ratio = with_commas(Math.round(report.sourceBytes / report.bytes));
  $("sizes").textContent =
    `${with_commas(report.bytes)} bytes instead of ${with_commas(report.sourceBytes)}: 1/${ratio}. Fitted in ${report.seconds.toFixed(1)} s.`;
  set_shown("saving", true);
  show_slices(report.slices);
  if (can_draw) viewer.set_material(1, report.material);
}

// ---- Edits -------------------------------------------------------------------------------------------------------

// The content of the edited picture: "edit" (the fitted model, edited by the shader), "model" (the edited model) or null (no picture).
let edit_view = null, pending_edit = null, is_editing = false;
// Promises that resolve when the last edit is computed, and when a new worker has restored what the last one had.
let edit_done = Promise.resolve(), restart_done = Promise.resolve();
const editing = new_editing({
  preview(edit) {
    if (!can_draw || !viewer.can_preview()) return;
    if (edit_view !== "edit") viewer.set_material(2, { ...fitted.material, bytes: fitted.bytes_to_edit.slice() }, true);
    edit_view = "edit";
    viewer.set_edit(2, edit);
  },
  // Runs one edit at a time; of the edits requested meanwhile only the last one is computed.
  apply(edits, description) {
    pending_edit = { edits, description };
    if (!is_editing) edit_done = apply_pending_edits(run_id);
  },
});
async function apply_pending_edits(own_run) {
  is_editing = true;
  await restart_done;
  while (pending_edit && own_run === run_id) {
    const { edits, description } = pending_edit;
    pending_edit = edited = null;
    $("edit_status").textContent = "Computing the edited model …";
    const result = await ask_step(own_run, { kind: "edit", name: file.name, edits });
    if (own_run !== run_id || pending_edit) continue;
    edited = result?.edits ? result : null;
    $("edit_status").textContent = edited ? `Edited: ${description}. ${with_commas(edited.bytes)} bytes.` : "";
    if (file.link) show_ready();
    if (!result || !can_draw) continue;
    viewer.set_material(2, edited && edited.material);
    edit_view = edited && "model";
  }
  is_editing = false;
}
function begin_editing(highlight) {
  pending_edit = edited = null;
  if (can_draw && edit_view) viewer.set_material(2, null);
  edit_view = null;
  $("edit_status").textContent = "";
  editing.begin(highlight);
}

// ---- Actions -----------------------------------------------------------------------------------------------------

// The result of a promise, or null after an error, which `on_error` shows if `is_current` (no later action has replaced this one).
async function result_of(promise, is_current, on_error = show_failure) {
  try {
    return await promise;
  } catch (error) {
    if (error && is_current()) on_error(error.message);
    return null;
  }
}
// Asks the worker for a step of a fit, an edit or a save. `question` may be a promise.
function ask_step(own_run, question) {
  const answer = Promise.resolve(question).then((ready) => worker.ask(ready));
  return result_of(answer, () => own_run === run_id, (message) => {
    show_failure(message);
    show_working("");
    if (worker?.is_trapped) restart_done = restart_worker();
  });
}

// Starts the pictures, and places the sliders, buttons and light controls beside them. `common`: the data of `begin`.
let pictures_started = null; // a promise
const ensure_pictures = (common) => pictures_started ??= start_pictures(common);
async function start_pictures(common) {
  can_draw = await viewer.start(common, "2");
  set_shown("without", !can_draw);
  set_shown("viewer", can_draw && file !== null);
  if (can_draw) $("viewer").prepend(document.querySelector("#viewer .pictures"), $("side"), document.querySelector("#viewer > .controls"));
}
async function open_in(host, { name, bytes, link }) {
  await ensure_pictures(await host.begun);
  return host.ask({ kind: "open", name, bytes, is_ready: Boolean(link) });
}
// Ends the worker. Its successor reads the page's file again, and the models made so far. Resolves to true if it could.
async function restart_worker() {
  const own_run = run_id, models = fitted && { kind: "restore", name: stem(file.name), fitted: fitted.file, edited: edited?.file };
  worker.end();
  const host = worker = new_worker();
  const restored = open_in(host, file).then(() => models ? host.ask(models) : true);
  return await result_of(restored, () => own_run === run_id) !== null;
}
function set_fitted(result) {
  fitted = result;
  fitted.bytes_to_edit = result.material && result.material.bytes.slice(); // the original bytes are transferred to the painter
}
async function fit(own_run) {
  fit_start = performance.now();
  show_working("beginning");
  const options = $("lobes").dataset.touched ? { lobes: Number($("lobes").value) } : {};
  const result = await ask_step(own_run, { kind: "fit", name: file.name, options });
  if (!result || own_run !== run_id) return;
  set_fitted(result);
  show_working("");
  show_fit(result);
  begin_editing(result.highlight);
}
// Sets the name of a picture in its button, its caption and its description.
function name_picture(subject, name) {
  for (const element of document.querySelectorAll(`[data-show="${subject}"], figure[data-material="${subject}"] figcaption`))
    element.textContent = name;
  document.querySelector(`figure[data-material="${subject}"] canvas`)?.setAttribute("aria-label", name);
}
// Shows the name of a file. For a ready material it also shows the stored picture, until the first one is drawn.
function show_name(name, link) {
  $("name").textContent = link?.dataset.kind ?? stem(name);
  set_shown("stored", Boolean(link));
  set_shown("lobes_row", !link);
  $("viewer").classList.toggle("stored", Boolean(link));
  if (link) document.body.style.setProperty("--stored", link.querySelector("i").style.backgroundPosition);
  set_shown("state", true);
}
// Reads a measurement and fits it, or reads a model and shows it; `link` is the link of a ready material. The page keeps its
// content until the file is read. If several files are chosen, only the last one is shown: `opening_id` counts them.
let opening_id = 0;
function begin_opening() {
  show_reading_status("");
  show_failure("");
  return ++opening_id;
}
async function show_file(own_opening, name, bytes, link) {
  const next = { name, bytes, link }, host = idle_worker ?? new_worker();
  idle_worker = null;
  show_reading_status(`Reading ${name} …`);
  const show_error = (message) => show_failure(refusal(name, bytes, message));
  const opened = await result_of(open_in(host, next), () => own_opening === opening_id, show_error);
  if (own_opening !== opening_id) return host.end();
  show_reading_status("");
  if (opened) show_opened(opened, next, host);
  else host.end();
  show_address();
}
function show_opened(opened, next, host) {
  const own_run = ++run_id;
  worker?.end();
  worker = host, file = next, fitted = null;
  begin_editing(null);
  show_failure("");
  hide("saving", "plots");
  show_name(file.name, file.link);
  for (const id of ["about", "verdict", "sizes", "saved"]) $(id).textContent = "";
  $("verdict").className = "";
  show_working("");
  if (can_draw) set_shown("viewer", true);
  set_shown("lobes_row", !opened.model);
  for (const element of document.querySelectorAll(".compared")) element.hidden = opened.model;
  show_slices(opened.slices);
  name_picture("1", opened.model ? "unedited" : "fitted");
  $("state").scrollIntoView();
  if (!opened.model) {
    show_measurement(opened);
    return fit(own_run);
  }
  document.querySelector("figure[data-material='1'] figcaption").textContent = $("name").textContent;
  set_fitted(opened);
  show_model(opened);
  begin_editing(opened.highlight);
}
// The message for a file that cannot be read: its kind if the library does not know the format, else the library's error.
function refusal(name, bytes, message) {
  const kind = bytes instanceof Uint8Array ? light.kind_of(bytes) : null, is_unknown = message.includes(": unknown format: ");
  if (!is_unknown && !/(picture|page)$/.test(kind)) return message;
  return `${name}: this is ${kind ?? "a file of another kind"}; drop a measurement, a model or an .hdr`;
}
async function take_file(chosen) {
  const own_opening = begin_opening(), { name, size } = chosen;
  if (size > k_max_bytes) return show_failure(`${name}: size: expected at most ${with_commas(k_max_bytes)} bytes, found ${with_commas(size)}`);
  const is_current = () => own_opening === opening_id, show_error = (message) => show_failure(`${name}: cannot be read: ${message}`);
  const content = await result_of(chosen.arrayBuffer(), is_current, show_error);
  if (!content || !is_current()) return;
  const bytes = new Uint8Array(content);
  if (!light.is_environment(name, bytes)) return show_file(own_opening, name, bytes);
  await pictures_started;
  if (can_draw && viewer.can_preview()) await viewer.open_environment(chosen, show_failure);
  else show_failure(`${name}: this browser draws no pictures under an environment`);
}
// Ends the worker at once. Its successor reads the file again.
async function cancel() {
  ++run_id;
  show_working("");
  $("verdict").textContent = "Cancelled. Move the slider to fit again.";
  $("verdict").className = "";
  hide("saving");
  begin_editing(null);
  await restart_worker();
}
async function change_lobes() {
  $("lobes").dataset.touched = "yes";
  if (!file) return;
  const own_run = ++run_id;
  show_failure("");
  begin_editing(null);
  if (worker.is_busy() && !await restart_worker()) return;
  if (own_run === run_id) await fit(own_run);
}
function new_element(tag, ...content) {
  const element = document.createElement(tag);
  element.append(...content);
  return element;
}
// Shows how to use the saved file, one line for each of `steps`. The pattern `name` finds a name in the file for these lines.
async function show_saved({ note = "", steps = "", name: pattern }, file_name, { content, error }) {
  const parts = { file: file_name, name: pattern && (await content.text()).match(pattern)?.[1] };
  const reference = error && (error.isOfModel ? "material on this page, which has an error of its own" : "measurement");
  const error_text = error ? `Blender’s nodes differ by ΔE ${two_digits(error.deltaE)} from the ${reference}. ` : "";
  const fill_in = (step) => step.replace(/{(file|name)}/g, (_, part) => parts[part]);
  $("saved").replaceChildren(new_element("p", `Saved ${file_name}. ${error_text}`, new_element("strong", note)));
  if (steps) $("saved").append(new_element("ol", ...steps.split("\n").map((step) => new_element("li", fill_in(step)))));
}
// The question whose answer is a file to save. If the page has the measurement, the material for Blender is made from it.
async function save_question(what, name) {
  const measured = `${stem(file.name)}_rgb.bsdf`, has_measured = file.link && document.querySelector(`[data-sample="${measured}"]`);
  const measurement = what === "blender" && has_measured && !edited ? { name: measured, bytes: await load_data(measured) } : null;
  return { kind: "save", what, name, measurement };
}
// Saves one file at a time, because all saves share one status line.
async function save(button) {
  const buttons = [...document.querySelectorAll("[data-save]")];
  for (const each of buttons) each.disabled = true;
  await make_and_download(button.dataset);
  for (const each of buttons) each.disabled = false;
  if (document.activeElement === document.body) button.focus({ preventScroll: true }); // a disabled button loses the focus
}
async function make_and_download(button_data) {
  const { save: what, ending } = button_data, own_run = run_id;
  await edit_done;
  if (own_run !== run_id) return;
  const name = stem(file.name) + (edited ? "_edited" : "") + ending;
  $("saved").textContent = "";
  saving = { name, start: performance.now(), progress: 0 };
  const timer = setInterval(show_saving, 400); // quick saves show no status
  const made = await ask_step(own_run, save_question(what, name));
  clearInterval(timer);
  saving = null;
  hide("writing");
  $("saved").textContent = !made && own_run === run_id ? "Nothing was saved." : "";
  if (!made) return restart_done;
  await show_saved(button_data, name, made);
  const link = document.createElement("a");
  link.href = URL.createObjectURL(made.content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}
// Shows one of the page's own files.
async function show_bundled(name, link) {
  const own_opening = begin_opening(), bytes = await result_of(load_data(name), () => own_opening === opening_id);
  if (own_opening !== opening_id) return;
  if (!bytes) return show_address();
  if (file) $("state").scrollIntoView();
  await show_file(own_opening, name, bytes, link);
}
for (const button of document.querySelectorAll("[data-sample]")) button.addEventListener("click", () => show_bundled(button.dataset.sample));
// The address "#NAME" shows a material of the gallery, so that its link can be shared.
const ready_links = [...document.querySelectorAll("#gallery li a")];
const find_ready_link = (href = location.href) => ready_links.find((link) => link.href === href);
function show_material_of_address() {
  const link = find_ready_link(), name = location.hash.slice(1);
  if (link) return show_bundled(`${name}.srbf`, link);
  if (name && name !== "lights" && !document.getElementById(name)) show_failure(`This page has no ready material of the name ${name}.`);
  show_address();
}
// Sets the address to that of the ready material that is shown, or removes the name of one.
function show_address() {
  const href = file?.link?.href ?? location.href.replace(find_ready_link() ? location.hash : "", "");
  if (href !== location.href) history.replaceState(null, "", href);
}
window.addEventListener("hashchange", () => { if (!file?.link || find_ready_link() !== file.link) show_material_of_address(); });
// A click on the current ball does not change the address.
for (const link of ready_links) link.addEventListener("click", () => { if (link === find_ready_link()) show_material_of_address(); });
for (const button of document.querySelectorAll("[data-save]")) button.addEventListener("click", () => save(button));
$("file").addEventListener("change", () => {
  if ($("file").files[0]) take_file($("file").files[0]);
  $("file").value = "";
});
$("cancel").addEventListener("click", cancel);
$("stop").addEventListener("click", () => { restart_done = restart_worker(); });
$("lobes").addEventListener("input", () => { $("lobes_value").value = $("lobes").value; });
$("lobes").addEventListener("change", change_lobes);
document.addEventListener("dragover", (event) => {
  event.preventDefault();
  document.body.classList.add("over");
});
document.addEventListener("dragleave", () => document.body.classList.remove("over"));
document.addEventListener("drop", (event) => {
  event.preventDefault();
  document.body.classList.remove("over");
  const [chosen] = event.dataTransfer.files, address = event.dataTransfer.getData("text/uri-list"), link = find_ready_link(address);
  if (link) link.click();
  else if (chosen) take_file(chosen);
  else show_failure(`This is ${address ? "a link" : "no file"}; drop a measurement, a model or an .hdr`);
});
if (find_ready_link()) show_name("", find_ready_link());
window.addEventListener("load", () => setTimeout(() => {
  idle_worker = new_worker();
  result_of(idle_worker.begun.then(ensure_pictures), () => true);
  show_material_of_address();
}, 50)); // after the page is shown

// For tests and for scripts that draw figures.
const state = () => ({ file, fitted, edited, busy: Number(worker?.is_busy() ?? false) });
return { take_file, state, save_as: async (what, name) => (await worker.ask(await save_question(what, name))).content };
})();
