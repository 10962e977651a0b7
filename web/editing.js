// The sliders that edit the fitted model. While one moves, the shader shows the edit of the fitted model; then the worker
// computes the edited model.
"use strict";
// `apply(edits, words)` computes and shows the edited model; without edits it discards the model. `preview(edit)` shows an
// edit by the shader.
function new_editing({ apply, preview }) {
const form = document.querySelector("#editing form"), inputs = [...form.querySelectorAll("input")];
const value = (name) => Number(form.elements[name].value);
let highlight = null; // data of the fitted model for previews

// A factor, 1/3 to 3 (that of α, of which the roughness of Blender and three.js is the root), and a colour of luminance 1 from cool to warm.
const factor = (name) => 3 ** value(name);
function tint(name) {
  const warmth = value(`${name}_warmth`), colour = [2 ** warmth, 1, 2 ** -warmth];
  return colour.map((x) => x * factor(name) / luminance(colour));
}
const k_luminance = [0.2126, 0.7152, 0.0722], luminance = (colour) => colour.reduce((sum, x, i) => sum + k_luminance[i] * x, 0);
const saturation = () => { const x = value("saturate"); return x < 0 ? 1 + x : 1 + 2 * x; };
const texts = {
  roughen: () => `× ${Math.sqrt(factor("roughen")).toFixed(2)}`, highlight: () => `× ${factor("highlight").toFixed(2)}`, body: () => `× ${factor("body").toFixed(2)}`,
  saturate: () => `× ${saturation().toFixed(2)}`, hue: () => `${value("hue")}°`,
};
const warmth_text = (x) => x === 0 ? "as it is" : x < 0 ? `${Math.round(-100 * x)} % cooler` : `${Math.round(100 * x)} % warmer`;

// The edits for the library: only those that change the model.
function edits() {
  const changes = {}, is_changed = (...names) => names.some((name) => value(name) !== 0);
  if (is_changed("roughen")) changes.roughen = factor("roughen");
  if (is_changed("highlight", "highlight_warmth")) changes.highlight = tint("highlight");
  if (is_changed("body", "body_warmth")) changes.body = tint("body");
  if (is_changed("saturate")) changes.saturate = saturation();
  if (is_changed("hue")) changes.hue = value("hue");
  return changes;
}
// The same edits, described with the labels of the sliders.
const words = () => inputs.filter((input) => value(input.name) !== 0)
  .map((input) => `${input.labels[0].textContent.toLowerCase()} ${input.nextElementSibling.value}`).join(", ");
// Scales the distance of a colour from grey; rotates its hue about grey, as `TurnHue`. Both keep the luminance.
function saturated(colour) {
  const grey = luminance(colour);
  return colour.map((x) => grey + saturation() * (x - grey));
}
function turned(colour) {
  const angle = value("hue") * Math.PI / 180, mean = (colour[0] + colour[1] + colour[2]) / 3;
  const around = colour.map((x, i) => Math.cos(angle) * (x - mean) + Math.sin(angle) / Math.sqrt(3) * (colour[(i + 2) % 3] - colour[(i + 1) % 3]));
  return around.map((x) => x + luminance(colour) - luminance(around));
}
// The edits for the painter. Each column of a matrix is an edited primary colour.
function edit() {
  const matrix = (tint) => [0, 1, 2].flatMap((column) => turned(saturated(tint.map((x, row) => row === column ? x : 0))));
  return { shares: highlight.shares, roughness: [factor("roughen"), highlight.roughness], colours: [...matrix(tint("highlight")), ...matrix(tint("body"))] };
}
function show_values() {
  for (const input of inputs) {
    const name = input.name;
    input.nextElementSibling.value = texts[name] ? texts[name]() : warmth_text(value(name));
  }
}
function change() {
  show_values();
  preview(edit());
}
for (const input of inputs) {
  input.addEventListener("input", change);
  input.addEventListener("change", () => apply(edits(), words()));
}
for (const button of form.querySelectorAll("[data-reset]"))
  button.addEventListener("click", () => {
    form.elements[button.dataset.reset].value = 0;
    change();
    apply(edits(), words());
  });
form.addEventListener("reset", () => setTimeout(() => { // after the sliders are reset
  change();
  apply(edits(), words());
}));
form.addEventListener("submit", (event) => event.preventDefault());

return {
  // Begins with a fitted model, or null if there is none to edit.
  begin(model_data) {
    highlight = model_data;
    document.getElementById("editing").hidden = !model_data;
    for (const input of inputs) input.value = 0; // no event
    show_values();
  },
};
}
