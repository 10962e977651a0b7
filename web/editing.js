// The sliders that edit the fitted model. While one moves, the shader shows the edit; then the worker computes the edited model.
"use strict";
// `apply(edits, description)` computes and shows the edited model, or discards it without edits. `preview(edit)` uses the shader.
function new_editing({ apply, preview }) {
const form = document.querySelector("#editing form"), inputs = [...form.querySelectorAll("input")];
const value = (name) => Number(form.elements[name].value);
let highlight = null; // data of the fitted model for previews

// The factor of a slider, 1/3 to 3. The roughness slider scales α, whose root is the roughness of Blender and three.js.
const factor = (name) => 3 ** value(name);
// The tint of a part: its brightness times a colour of luminance 1 from cool to warm.
function tint(name) {
  const warmth = value(`${name}_warmth`), colour = [2 ** warmth, 1, 2 ** -warmth];
  return colour.map((x) => x * factor(name) / luminance(colour));
}
const k_luminance = [0.2126, 0.7152, 0.0722], luminance = (colour) => colour.reduce((sum, x, i) => sum + k_luminance[i] * x, 0);
const saturation = () => { const x = value("saturate"); return x < 0 ? 1 + x : 1 + 2 * x; };
// The texts beside the sliders.
const times = (x) => `× ${x.toFixed(2)}`;
const texts = {
  roughen: () => times(Math.sqrt(factor("roughen"))), highlight: () => times(factor("highlight")), body: () => times(factor("body")),
  saturate: () => times(saturation()), hue: () => `${value("hue")}°`,
};
const warmth_text = (x) => x === 0 ? "as it is" : `${Math.round(Math.abs(100 * x))} % ${x < 0 ? "cooler" : "warmer"}`;

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
// A description of the edits, with the labels of the sliders.
const description = () => inputs.filter((input) => value(input.name) !== 0)
  .map((input) => `${input.labels[0].textContent.toLowerCase()} ${input.nextElementSibling.value}`).join(", ");
// Scales the distance of a colour from grey, as `Saturate` of srbf/edit.h. The luminance stays.
function saturate(colour) {
  const grey = luminance(colour);
  return colour.map((x) => grey + saturation() * (x - grey));
}
// Rotates the hue of a colour about grey, as `TurnHue`. The luminance stays.
function turn_hue(colour) {
  const angle = value("hue") * Math.PI / 180, mean = (colour[0] + colour[1] + colour[2]) / 3;
  const rotated = colour.map((x, i) => Math.cos(angle) * (x - mean) + Math.sin(angle) / Math.sqrt(3) * (colour[(i + 2) % 3] - colour[(i + 1) % 3]));
  return rotated.map((x) => x + luminance(colour) - luminance(rotated));
}
// The edits for the painter. Each column of a matrix is an edited primary colour.
function painter_edit() {
  const matrix = (tint) => [0, 1, 2].flatMap((column) => turn_hue(saturate(tint.map((x, row) => row === column ? x : 0))));
  const colours = [...matrix(tint("highlight")), ...matrix(tint("body"))];
  return { shares: highlight.shares, roughness: [factor("roughen"), highlight.roughness], colours };
}
function show_values() {
  for (const input of inputs) {
    const name = input.name;
    input.nextElementSibling.value = texts[name] ? texts[name]() : warmth_text(value(name));
  }
}
function change() {
  show_values();
  preview(painter_edit());
}
const apply_values = () => apply(edits(), description());
function change_and_apply() {
  change();
  apply_values();
}
for (const input of inputs) {
  input.addEventListener("input", change);
  input.addEventListener("change", apply_values);
}
for (const button of form.querySelectorAll("[data-reset]"))
  button.addEventListener("click", () => {
    form.elements[button.dataset.reset].value = 0;
    change_and_apply();
  });
form.addEventListener("reset", () => setTimeout(change_and_apply)); // after the sliders are reset
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
