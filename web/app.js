// The page where a measurement becomes a formula. What takes long is done by workers: working.js fits, painter.js draws.
"use strict";
const app = (() => {
const $ = (id) => document.getElementById(id);
const is_shown = (id, shown) => { $(id).hidden = !shown; };

// ---- What the folder holds ---------------------------------------------------------------------------------------

// A page from a disk may fetch nothing, but scripts: each file of `data` calls srbf_given.
const k_most_bytes = 2 ** 28, waiting = {};
window.srbf_given = (name, text) => waiting[name].done(text);
function loaded(name) {
  if (waiting[name]) return waiting[name].promise;
  const of = waiting[name] = {};
  of.promise = new Promise((done, failed) => {
    of.done = done;
    const script = document.createElement("script");
    script.src = `data/${name}.js`;
    script.onerror = () => failed(new Error(`data/${name}.js is missing beside this page`));
    document.head.append(script);
  });
  return of.promise;
}

// ---- The worker that fits ----------------------------------------------------------------------------------------

let worker = null, asked = 0, open_questions = new Map(), kept = null;
const url = URL.createObjectURL(new Blob([`${binding}\n${working}\nworking();`], { type: "text/javascript" }));

// A new worker with the module in it; the one before is gone, whatever it was doing.
function begin() {
  worker?.terminate();
  for (const { failed } of open_questions.values()) failed(null);
  open_questions = new Map();
  const mine = worker = new Worker(url);
  worker.onmessage = ({ data }) => {
    if (mine !== worker) return;
    if ("progress" in data) return show_progress(data);
    if ("draft" in data) return show_draft(data.draft);
    const question = open_questions.get(data.id);
    open_questions.delete(data.id);
    if (data.is_trap) ready = null;
    "error" in data ? question.failed(new Error(data.error)) : question.done(data.result);
  };
  return (async () => {
    kept ??= { module: await loaded("module"), studio: await loaded("studio") };
    const { module, studio, viewer: common } = await ask({ kind: "begin", ...kept });
    kept = { module, studio };
    return common;
  })();
}
function ask(question, gifts = []) {
  return new Promise((done, failed) => {
    const id = ++asked;
    open_questions.set(id, { done, failed });
    worker.postMessage({ ...question, id }, gifts);
  });
}
let ready = null; // what `begin` promised last
const begun = () => ready ??= begin();

// ---- What the page shows -----------------------------------------------------------------------------------------

const k_level = ["good", "good", "fair", "poor"];
let file = null, fitted = null, common = null, started = 0, draws = false, run = 0;

const grouped = (n) => n.toLocaleString("en");
const figures = (x) => Number(x.toPrecision(2)).toString();
const stem = (name) => name.replace(/(.)\.[^.]*$/, "$1");

function fail(text) {
  $("failure").textContent = text;
  is_shown("failure", text !== "");
}
function show_progress({ progress, stage }) {
  const seconds = (performance.now() - started) / 1000, left = progress > 0.05 ? seconds * (1 - progress) / progress : NaN;
  document.querySelector("progress").value = progress;
  $("stage").textContent = `${stage}, ${Math.round(100 * progress)} %` + (left >= 1 ? `, about ${Math.ceil(left)} s left` : "");
}
function show_working(stage) {
  is_shown("working", stage !== "");
  document.querySelector("progress").value = 0;
  $("stage").textContent = stage;
  viewer.rest(stage !== "");
}
function show_slices(drawings) {
  is_shown("plots", true);
  document.querySelector("#plots .slices").innerHTML = drawings;
}
function show_measurement(of) {
  const samples = of.samples ? `, ${grouped(of.samples)} samples` : "";
  $("about").textContent = `${of.format}, ${grouped(of.bytes)} bytes${samples}${of.twoSided ? ", reflection and transmission" : ""}`
    + (of.isotropic ? "" : "; it depends on rotation about the normal, so only the fit has a picture")
    + of.notes.map((note) => `; ${note}`).join("");
  if (!draws) return;
  viewer.set_material(1, null);
  viewer.set_material(0, of.material);
}
function words_of({ seen, smoothed, samples, twoSided, energyError }) {
  if (twoSided) return `Light sent back and through is right to ${figures(energyError)} of what arrives.`;
  if (!smoothed)
    return `The difference is ${seen.verdict}: ΔE_ITP ${figures(seen.deltaE)} on average, ${figures(seen.worst)} in the worst of eight ` +
      `lightings${samples ? ", in cross-validation" : ""} (1 is just noticeable).`;
  return `The difference is ${smoothed.verdict} once the measurement's noise is smoothed: ΔE_ITP ${figures(smoothed.deltaE)}, and ` +
    `${figures(seen.deltaE)} with the noise (1 is just noticeable).`;
}
function show_draft(of) {
  $("verdict").className = "";
  $("verdict").textContent = of.last ? `The fit of ${grouped(of.bytes)} bytes is shown. Its errors are being measured.`
    : `A first draft of ${grouped(of.bytes)} bytes is shown. The fit goes on.`;
  show_slices(of.slices);
  if (draws) viewer.set_material(1, of.material);
}
function show_fit(of) {
  const { seen, smoothed } = of, level = seen ? k_level[(smoothed ?? seen).level] : of.energyError <= 0.02 ? "good" : "fair";
  $("verdict").className = level;
  $("verdict").textContent = words_of(of);
  const share = grouped(Math.round(of.sourceBytes / of.bytes));
  $("sizes").textContent =
    `${grouped(of.bytes)} bytes instead of ${grouped(of.sourceBytes)}: 1/${share}. Fitted in ${of.seconds.toFixed(1)} s.`;
  is_shown("downloads", true);
  show_slices(of.slices);
  if (draws) viewer.set_material(1, of.material);
}

// ---- What it does ------------------------------------------------------------------------------------------------

// Says what went wrong with a step of this run, unless another took its place.
async function step(mine, of) {
  try {
    return await of();
  } catch (error) {
    if (error && mine === run) fail(error.message), show_working("");
    return null;
  }
}

// Reads the file again if the worker is a new one.
async function open() {
  common = await begun();
  if (!draws && !$("viewer").dataset.tried) {
    $("viewer").dataset.tried = "yes";
    draws = await viewer.start(common);
    is_shown("without", !draws);
  }
  return ask({ kind: "open", name: file.name, bytes: file.bytes });
}
async function fit(mine) {
  started = performance.now();
  show_working("beginning");
  const lobes = Number($("lobes").value), was_touched = $("lobes").dataset.touched;
  const result = await step(mine, () => ask({ kind: "fit", name: file.name, options: was_touched ? { lobes } : {} }));
  if (!result || mine !== run) return;
  fitted = result;
  show_working("");
  show_fit(result);
}
async function take(name, bytes) {
  const mine = ++run;
  if (open_questions.size) ready = begin(); // what it is doing nobody waits for
  file = { name, bytes }, fitted = null;
  fail("");
  for (const id of ["downloads", "plots"]) is_shown(id, false);
  is_shown("state", true);
  $("name").textContent = stem(name);
  for (const id of ["about", "verdict", "sizes", "saved"]) $(id).textContent = "";
  $("verdict").className = "";
  show_working("reading");
  const of = await step(mine, open);
  if (mine !== run) return;
  if (!of) return is_shown("state", false), is_shown("viewer", false);
  if (draws) is_shown("viewer", true);
  show_measurement(of);
  show_slices(of.slices);
  await fit(mine);
}
async function take_file(of) {
  const mine = ++run;
  fail("");
  if (of.size > k_most_bytes) return fail(`${of.name}: size: expected at most ${grouped(k_most_bytes)} bytes, found ${grouped(of.size)}`);
  const bytes = await of.arrayBuffer().catch((error) => (fail(`${of.name}: cannot be read: ${error.message}`), null));
  if (bytes && mine === run) await take(of.name, new Uint8Array(bytes));
}
// The worker ends at once. The next one reads the file again, for another number of lobes or what is saved.
async function cancel() {
  const mine = ++run;
  ready = begin();
  show_working("");
  $("verdict").textContent = "Cancelled. Move the slider to fit again.";
  $("verdict").className = "";
  is_shown("downloads", false);
  await step(mine, open);
}
async function change_lobes() {
  $("lobes").dataset.touched = "yes";
  if (!file) return;
  const mine = ++run;
  if (open_questions.size) {
    ready = begin();
    if (!await step(mine, open) || mine !== run) return;
  }
  fail("");
  await fit(mine);
}
async function save({ save: what, ending }) {
  const name = stem(file.name) + ending, mine = run;
  $("saved").textContent = `Writing ${name} …`;
  const content = await step(mine, () => ask({ kind: "save", what, name }));
  $("saved").textContent = content === null ? "" : `Saved ${name}.`;
  if (content === null) return;
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

for (const button of document.querySelectorAll("[data-sample]"))
  button.addEventListener("click", async () => {
    const mine = ++run, bytes = await step(mine, () => loaded(button.dataset.sample));
    if (bytes && mine === run) take(button.dataset.sample, bytes);
  });
for (const button of document.querySelectorAll("[data-save]")) button.addEventListener("click", () => save(button.dataset));
$("file").addEventListener("change", () => {
  if ($("file").files[0]) take_file($("file").files[0]);
  $("file").value = "";
});
$("cancel").addEventListener("click", cancel);
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
  if (event.dataTransfer.files[0]) take_file(event.dataTransfer.files[0]);
});
window.addEventListener("load", () => setTimeout(() => begun().catch((error) => error && fail(error.message)), 50)); // once the page is seen

return { take_file, save_as: (what, name) => ask({ kind: "save", what, name }), state: () => ({ file, fitted, busy: open_questions.size }) };
})();
