// The page that fits lobes to a measurement. Workers do the long computations: working.js fits, painter.js draws.
"use strict";
const app = (() => {
const $ = (id) => document.getElementById(id);
const set_shown = (id, shown) => { $(id).hidden = !shown; };

// ---- The files of the folder -------------------------------------------------------------------------------------

// A page opened from a disk may load scripts but not fetch data, so each file of `data` is a script that calls
// srbf_given. The page in one file has them as texts.
const k_max_bytes = 2 ** 28, waiting = {}, parsed = new Promise((done) => document.addEventListener("DOMContentLoaded", done));
window.srbf_given = (name, text) => waiting[name].done(text);
function load_data(name) {
  if (waiting[name]) return waiting[name].promise;
  const entry = waiting[name] = {};
  entry.promise = parsed.then(() => new Promise((done, failed) => {
    entry.done = done;
    const inside = $(`data/${name}`);
    if (inside) return done(inside.textContent);
    const script = document.createElement("script");
    script.src = `data/${name}.js`;
    script.onerror = () => failed(new Error(`data/${name}.js is missing beside this page`));
    document.head.append(script);
  }));
  return entry.promise;
}

// ---- The worker that fits ----------------------------------------------------------------------------------------

// `worker` holds the file that the page shows; `spare` is started and idle.
let worker = null, spare = null, question_count = 0, cache = null;
const url = URL.createObjectURL(new Blob([`${binding}\n${working}\nworking();`], { type: "text/javascript" }));

// A worker with the module. Requests that are unanswered when it ends are rejected with null.
function new_worker() {
  const thread = new Worker(url), open = new Map(), host = {
    is_busy: () => open.size > 0,
    ask: (question) => new Promise((done, failed) => {
      const id = ++question_count;
      open.set(id, { done, failed });
      thread.postMessage({ ...question, id });
    }),
    end() {
      thread.terminate();
      for (const { failed } of open.values()) failed(null);
      open.clear();
    },
  };
  thread.onmessage = ({ data }) => {
    const question = open.get(data.id);
    if (question) {
      open.delete(data.id);
      host.is_trapped ||= data.is_trap;
      if ("error" in data) question.failed(new Error(data.error));
      else question.done(data.result);
    } else if (host === worker) {
      if ("draft" in data) show_draft(data.draft);
      else if (saving) saving.progress = data.progress;
      else if (is_editing) show_edit_progress(data);
      else show_progress(data);
    }
  };
  host.begun = (async () => {
    cache ??= { module: await load_data("module"), studio: await load_data("studio"), prepared: await load_data("prepared") };
    const begun = await host.ask({ kind: "begin", ...cache });
    cache = begun.cache;
    return begun.viewer;
  })();
  return host;
}
const ask = (question) => worker.ask(question);

// ---- The display -------------------------------------------------------------------------------------------------

const k_level = ["good", "good", "fair", "poor"];
let file = null, fitted = null, edited = null, started = 0, draws = false, run = 0;
let saving = null; // the file being written: its name, the start time and the progress (0: unknown)

const grouped = (n) => n.toLocaleString("en");
const two_digits = (x) => Number(x.toPrecision(2)).toString();
const stem = (name) => name.replace(/(.)\.[^.]*$/, "$1");

function fail(text) {
  $("failure").textContent = text;
  set_shown("failure", text !== "");
  if (text) $("failure").scrollIntoView({ block: "nearest" });
}
function say(text) {
  $("reading").textContent = text;
  set_shown("reading", text !== "");
}
function show_progress({ progress, stage }) {
  document.querySelector("#working progress").value = progress;
  $("stage").textContent = `${stage}, ${share_done(progress, started)}`;
}
function share_done(progress, started) {
  const seconds = (performance.now() - started) / 1000, remaining = progress > 0.05 ? seconds * (1 - progress) / progress : NaN;
  return `${Math.round(100 * progress)} %` + (remaining >= 1 ? `, about ${Math.ceil(remaining)} s left` : "");
}
function show_edit_progress({ progress }) {
  $("edit_status").textContent = `Computing the edited model, ${Math.round(100 * progress)} % …`;
}
function show_saving() {
  const { name, begun, progress } = saving, bar = document.querySelector("#writing progress");
  set_shown("writing", true);
  progress ? bar.value = progress : bar.removeAttribute("value");
  const done = progress ? `, ${share_done(progress, begun)}` : ` for ${Math.ceil((performance.now() - begun) / 1000)} s`;
  $("saved").textContent = `Writing ${name}${done} …`;
}
function show_working(stage) {
  set_shown("working", stage !== "");
  document.querySelector("#working progress").value = 0;
  $("stage").textContent = stage;
  viewer.rest(stage !== "");
}
function show_slices(drawings) {
  set_shown("plots", true);
  document.querySelector("#plots .slices").innerHTML = drawings;
}
function show_measurement(measurement) {
  const samples = measurement.samples ? `, ${grouped(measurement.samples)} samples` : "";
  $("about").textContent = `${measurement.format}, ${grouped(measurement.bytes)} bytes${samples}${measurement.twoSided ? ", reflection and transmission" : ""}`
    + (measurement.isotropic ? "" : "; it depends on rotation about the normal, so only the fit has a picture")
    + measurement.notes.map((note) => `; ${note}`).join("");
  if (!draws) return;
  viewer.set_material(1, null);
  viewer.set_material(0, measurement.material);
  show_drawing();
}
// Shows a waiting message until the first picture arrives.
let drawing = 0;
async function show_drawing() {
  const mine = ++drawing, { classList } = $("viewer");
  classList.add("drawing");
  await viewer.settled();
  if (mine === drawing) classList.remove("drawing");
}
// Describes the source of a ready material, says whether it is edited, and shows its licence terms.
function show_ready() {
  const { kind, error, about, terms } = file.link.dataset;
  $("name").textContent = edited ? `Edited: made from ${kind}` : kind;
  $("about").textContent = edited ? `ΔE ${error} before the edit. An edited material has no measurement to compare with. `
    : `${stem(file.name)}, ${grouped(fitted.bytes)} bytes. ${about} `;
  $("about").insertAdjacentHTML("beforeend", terms); // with a link
}
function show_model(model) {
  if (file.link) show_ready();
  else $("about").textContent = `A model of ${grouped(model.bytes)} bytes. Drop its measurement to fit it anew.`;
  set_shown("saving", true);
  if (!draws) return;
  viewer.set_material(0, null);
  viewer.set_material(1, model.material);
  show_drawing();
}
function words_of({ seen, smoothed, headline, twoSided, energyError }) {
  if (twoSided) return `The reflected and transmitted light have an error of at most ${two_digits(energyError)} of the incident light.`;
  if (!smoothed)
    return `The difference is ${headline} (1 is just noticeable).`;
  return `The difference is ${smoothed.verdict} once the measurement's noise is smoothed: ΔE_ITP ${two_digits(smoothed.deltaE)}, and ` +
    `${two_digits(seen.deltaE)} with the noise (1 is just noticeable).`;
}
function show_draft(draft) {
  $("verdict").className = "";
  $("verdict").textContent = draft.last ? `The fit of ${grouped(draft.bytes)} bytes is shown. Its errors are being measured.`
    : `A first draft of ${grouped(draft.bytes)} bytes is shown. The fit goes on.`;
  show_slices(draft.slices);
  if (!draws) return;
  viewer.set_material(1, draft.material);
  show_drawing();
}
function show_fit(report) {
  const { seen, smoothed } = report, level = seen ? k_level[(smoothed ?? seen).level] : report.energyError <= 0.02 ? "good" : "fair";
  $("verdict").className = level;
  $("verdict").textContent = words_of(report);
  const ratio = grouped(Math.round(report.sourceBytes / report.bytes));
  $("sizes").textContent =
    `${grouped(report.bytes)} bytes instead of ${grouped(report.sourceBytes)}: 1/${ratio}. Fitted in ${report.seconds.toFixed(1)} s.`;
  set_shown("saving", true);
  show_slices(report.slices);
  if (draws) viewer.set_material(1, report.material);
}

// ---- Edits -------------------------------------------------------------------------------------------------------

// `shown`: the content of the edited picture, "edit" (of the fitted model) or "model"; null without a picture.
let shown = null, wanted = null, is_editing = false, applied = Promise.resolve(), restored = Promise.resolve();
const editing = new_editing({
  preview(edit) {
    if (!draws || !viewer.previews()) return;
    if (shown !== "edit") viewer.set_material(2, { ...fitted.material, bytes: fitted.bytes_to_edit.slice() }, true), shown = "edit";
    viewer.set_edit(2, edit);
  },
  // Runs one edit at a time; of the edits requested meanwhile only the last one is computed.
  apply(edits, words) {
    wanted = { edits, words };
    if (!is_editing) applied = apply_wanted(run);
  },
});
async function apply_wanted(mine) {
  is_editing = true;
  await restored;
  while (wanted && mine === run) {
    const { edits, words } = wanted;
    wanted = edited = null;
    $("edit_status").textContent = "Computing the edited model …";
    const result = await step(mine, () => ask({ kind: "edit", name: file.name, edits }));
    if (mine !== run || wanted) continue;
    edited = result?.edits ? result : null;
    $("edit_status").textContent = edited ? `Edited: ${words}. ${grouped(edited.bytes)} bytes.` : "";
    if (file.link) show_ready();
    if (result && draws) viewer.set_material(2, edited && edited.material), shown = edited && "model";
  }
  is_editing = false;
}
function begin_editing(highlight) {
  wanted = edited = null;
  if (draws && shown) viewer.set_material(2, null);
  shown = null;
  $("edit_status").textContent = "";
  editing.begin(highlight);
}

// ---- Actions -----------------------------------------------------------------------------------------------------

// Runs a step of a fit, and shows its error unless a later run has replaced this one.
async function step(mine, action) {
  try {
    return await action();
  } catch (error) {
    if (error && mine === run) {
      fail(error.message), show_working("");
      if (worker?.is_trapped) restored = renew();
    }
    return null;
  }
}

// Starts the pictures, and places the sliders, buttons and light controls beside them. `common`: the data of `begin`.
let pictures = null; // a promise that resolves when they have started
const ensure_pictures = (common) => pictures ??= start_pictures(common);
async function start_pictures(common) {
  draws = await viewer.start(common, "2");
  set_shown("without", !draws), set_shown("viewer", draws && file !== null);
  if (draws) $("viewer").prepend(document.querySelector("#viewer .pictures"), $("side"), document.querySelector("#viewer > .controls"));
}
async function open_in(host, { name, bytes, link }) {
  await ensure_pictures(await host.begun);
  return host.ask({ kind: "open", name, bytes, is_ready: Boolean(link) });
}
// Ends the worker. Its successor reads the page's file again, and the models made so far.
function renew() {
  const mine = run, made = fitted && { kind: "restore", name: stem(file.name), fitted: fitted.file, edited: edited?.file };
  worker.end();
  const host = worker = new_worker();
  return open_in(host, file).then(() => made && host.ask(made)).then(() => true, (error) => void (error && mine === run && fail(error.message)));
}
function take_fit(result) {
  fitted = result;
  fitted.bytes_to_edit = result.material && result.material.bytes.slice(); // the original bytes are transferred to the painter
}
async function fit(mine) {
  started = performance.now();
  show_working("beginning");
  const lobes = Number($("lobes").value), was_touched = $("lobes").dataset.touched;
  const result = await step(mine, () => ask({ kind: "fit", name: file.name, options: was_touched ? { lobes } : {} }));
  if (!result || mine !== run) return;
  take_fit(result);
  show_working("");
  show_fit(result);
  begin_editing(result.highlight);
}
// Describes a picture in words.
function name_picture(subject, name) {
  for (const element of document.querySelectorAll(`[data-show="${subject}"], figure[data-material="${subject}"] figcaption`)) element.textContent = name;
  document.querySelector(`figure[data-material="${subject}"] canvas`)?.setAttribute("aria-label", name);
}
// Shows the name of a file. For a ready material it also shows the stored picture, until the first one is drawn.
function show_name(name, link) {
  $("name").textContent = link?.dataset.kind ?? stem(name);
  set_shown("stored", Boolean(link)), set_shown("lobes_row", !link);
  $("viewer").classList.toggle("stored", Boolean(link));
  if (link) document.body.style.setProperty("--stored", link.querySelector("i").style.backgroundPosition);
  set_shown("state", true);
}
// Reads a measurement and fits it, or reads a model and shows it; `link` is the address of a ready material. The page keeps its
// content until the file is read. If several files are chosen, only the last one is shown.
let opening = 0;
function begin_opening() {
  say(""), fail("");
  return ++opening;
}
async function show_file(mine, name, bytes, link) {
  const next = { name, bytes, link }, host = spare ?? new_worker();
  spare = null;
  say(`Reading ${name} …`);
  const opened = await open_in(host, next).catch((error) => void (error && mine === opening && fail(refusal(name, bytes, error.message))));
  if (mine !== opening) return host.end();
  say("");
  if (opened) show_opened(opened, next, host);
  else host.end();
  show_address();
}
function show_opened(opened, next, host) {
  const mine = ++run;
  worker?.end();
  worker = host, file = next, fitted = null;
  begin_editing(null);
  fail("");
  set_shown("saving", false), set_shown("plots", false);
  show_name(file.name, file.link);
  for (const id of ["about", "verdict", "sizes", "saved"]) $(id).textContent = "";
  $("verdict").className = "";
  show_working("");
  if (draws) set_shown("viewer", true);
  set_shown("lobes_row", !opened.model);
  for (const element of document.querySelectorAll(".compared")) element.hidden = opened.model;
  show_slices(opened.slices);
  name_picture("1", opened.model ? "unedited" : "fitted");
  $("state").scrollIntoView();
  if (!opened.model) {
    show_measurement(opened);
    return void fit(mine);
  }
  document.querySelector("figure[data-material='1'] figcaption").textContent = $("name").textContent;
  take_fit(opened);
  show_model(opened);
  begin_editing(opened.highlight);
}
// The message for a file that cannot be read: its kind if the library does not know the format, else the library's error.
function refusal(name, bytes, why) {
  const kind = bytes instanceof Uint8Array ? light.kind_of(bytes) : null, is_unknown = why.includes(": unknown format: ");
  return is_unknown || /(picture|page)$/.test(kind) ? `${name}: this is ${kind ?? "a file of another kind"}; drop a measurement, a model or an .hdr` : why;
}
async function take_file(chosen) {
  const mine = begin_opening(), { name, size } = chosen;
  if (size > k_max_bytes) return fail(`${name}: size: expected at most ${grouped(k_max_bytes)} bytes, found ${grouped(size)}`);
  const bytes = await chosen.arrayBuffer().then((buffer) => new Uint8Array(buffer), (error) => void fail(`${name}: cannot be read: ${error.message}`));
  if (!bytes || mine !== opening) return;
  if (!light.is_environment(name, bytes)) return show_file(mine, name, bytes);
  await pictures;
  if (draws && viewer.previews()) await viewer.open_environment(chosen, fail);
  else fail(`${name}: this browser draws no pictures under an environment`);
}
// Ends the worker at once. Its successor reads the file again.
async function cancel() {
  ++run;
  show_working("");
  $("verdict").textContent = "Cancelled. Move the slider to fit again.";
  $("verdict").className = "";
  set_shown("saving", false);
  begin_editing(null);
  await renew();
}
async function change_lobes() {
  $("lobes").dataset.touched = "yes";
  if (!file) return;
  const mine = ++run;
  fail("");
  begin_editing(null);
  if (worker.is_busy() && !await renew() || mine !== run) return;
  await fit(mine);
}
function element(kind, ...content) {
  const made = document.createElement(kind);
  made.append(...content);
  return made;
}
// Shows how to use the saved file, one line for each of `steps`. The pattern `name` finds a name in the file for these lines.
async function show_saved({ note = "", steps = "", name: pattern }, file_name, { content, error }) {
  const parts = { file: file_name, name: pattern && (await content.text()).match(pattern)?.[1] };
  const reference = error && (error.isOfModel ? "material on this page, which has an error of its own" : "measurement");
  const said = `Saved ${file_name}. ` + (error ? `Blender’s nodes differ by ΔE ${two_digits(error.deltaE)} from the ${reference}. ` : "");
  const filled = (step) => step.replace(/{(file|name)}/g, (_, part) => parts[part]);
  $("saved").replaceChildren(element("p", said, element("strong", note)));
  if (steps) $("saved").append(element("ol", ...steps.split("\n").map((step) => element("li", filled(step)))));
}
// If the page has the measurement, the material for Blender is made from it.
async function write(what, name) {
  const measured = `${stem(file.name)}_rgb.bsdf`, has_measured = file.link && document.querySelector(`[data-sample="${measured}"]`);
  const measurement = what === "blender" && has_measured && !edited ? { name: measured, bytes: await load_data(measured) } : null;
  return ask({ kind: "save", what, name, measurement });
}
// Saves one file at a time, because all saves share one status line.
async function save(button) {
  const buttons = [...document.querySelectorAll("[data-save]")];
  for (const each of buttons) each.disabled = true;
  await write_file(button.dataset);
  for (const each of buttons) each.disabled = false;
  if (document.activeElement === document.body) button.focus({ preventScroll: true }); // a disabled button loses the focus
}
async function write_file(button) {
  const { save: what, ending } = button;
  const mine = run;
  await applied;
  if (mine !== run) return;
  const name = stem(file.name) + (edited ? "_edited" : "") + ending;
  $("saved").textContent = "";
  saving = { name, begun: performance.now(), progress: 0 };
  const timer = setInterval(show_saving, 400); // quick saves show no status
  const written = await step(mine, () => write(what, name));
  saving = clearInterval(timer), set_shown("writing", false);
  $("saved").textContent = !written && mine === run ? "Nothing was saved." : "";
  if (!written) return restored;
  await show_saved(button, name, written);
  const link = document.createElement("a");
  link.href = URL.createObjectURL(written.content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

// Shows one of the page's own files.
async function show_own(name, link) {
  const mine = begin_opening(), bytes = await load_data(name).catch((error) => void fail(error.message));
  if (mine !== opening) return;
  if (!bytes) return show_address();
  if (file) $("state").scrollIntoView();
  await show_file(mine, name, bytes, link);
}
for (const button of document.querySelectorAll("[data-sample]")) button.addEventListener("click", () => show_own(button.dataset.sample));
// The address "#NAME" shows a material of the gallery, so that its link can be shared.
const links = [...document.querySelectorAll("#gallery li a")], linked = (address = location) => links.find((link) => link.href === address.href);
function show_linked() {
  const link = linked(), name = location.hash.slice(1);
  if (link) return show_own(`${name}.srbf`, link);
  if (name && name !== "lights" && !document.getElementById(name)) fail(`This page has no ready material of the name ${name}.`);
  show_address();
}
// The address of the ready material that is shown, or none.
function show_address() {
  const { href } = file?.link ?? { href: location.href.replace(linked() ? location.hash : "", "") };
  if (href !== location.href) history.replaceState(null, "", href);
}
window.addEventListener("hashchange", () => { if (!file?.link || linked() !== file.link) show_linked(); });
// A click on the current ball does not change the address.
for (const link of links) link.addEventListener("click", () => { if (link === linked()) show_linked(); });
for (const button of document.querySelectorAll("[data-save]")) button.addEventListener("click", () => save(button));
$("file").addEventListener("change", () => {
  if ($("file").files[0]) take_file($("file").files[0]);
  $("file").value = "";
});
$("cancel").addEventListener("click", cancel);
$("stop").addEventListener("click", () => { restored = renew(); });
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
  const [chosen] = event.dataTransfer.files, address = event.dataTransfer.getData("text/uri-list"), link = linked({ href: address });
  if (link) link.click();
  else if (chosen) take_file(chosen);
  else fail(`This is ${address ? "a link" : "no file"}; drop a measurement, a model or an .hdr`);
});
if (linked()) show_name("", linked());
window.addEventListener("load", () => setTimeout(() => {
  spare = new_worker();
  spare.begun.then(ensure_pictures).catch((error) => error && fail(error.message));
  show_linked();
}, 50)); // after the page is shown

return { take_file, save_as: (what, name) => write(what, name).then(({ content }) => content), state: () => ({ file, fitted, edited, busy: Number(worker?.is_busy() ?? false) }) };
})();
