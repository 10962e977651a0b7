// The sliders that edit the fitted model. While one moves, the shader shows the edit of the fitted model; then the worker
// computes the edited model.
"use strict";
// `apply(edits, words)` computes and shows the edited model, or without edits forgets it; `preview(edit)` shows an edit of
// the painter before.
function new_editing({ apply, preview }) {
const form = document.querySelector("#editing form"), inputs = [...form.querySelectorAll("input")];
const value = (name) => Number(form.elements[name].value);
let highlight = null; // what the pictures need of the fitted model

// A factor, 1/3 to 3, and a colour of luminance 1 from cool to warm.
const factor = (name) => 3 ** value(name);
function tint(name) {
  const warmth = value(`${name}_warmth`), colour = [2 ** warmth, 1, 2 ** -warmth];
  const luminance = 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2];
  return colour.map((x) => x * factor(name) / luminance);
}
const saturation = () => { const x = value("saturate"); return x < 0 ? 1 + x : 1 + 2 * x; };
const texts = {
  roughen: () => `× ${factor("roughen").toFixed(2)}`, highlight: () => `× ${factor("highlight").toFixed(2)}`, body: () => `× ${factor("body").toFixed(2)}`,
  saturate: () => `× ${saturation().toFixed(2)}`,
};
const warmth_text = (x) => x === 0 ? "as it is" : x < 0 ? `${Math.round(-100 * x)} % cooler` : `${Math.round(100 * x)} % warmer`;

// The edits for the library, those alone that change something.
function edits() {
  const of = {}, is_changed = (...names) => names.some((name) => value(name) !== 0);
  if (is_changed("roughen")) of.roughen = factor("roughen");
  if (is_changed("highlight", "highlight_warmth")) of.highlight = tint("highlight");
  if (is_changed("body", "body_warmth")) of.body = tint("body");
  if (is_changed("saturate")) of.saturate = saturation();
  return of;
}
// The same in the words of the sliders.
const words = () => inputs.filter((input) => value(input.name) !== 0)
  .map((input) => `${input.labels[0].textContent.toLowerCase()} ${input.nextElementSibling.value}`).join(", ");
// The same for the painter: a matrix, column by column, tints and then saturates.
function edit() {
  const s = saturation(), matrix = (tint) => [0, 1, 2].flatMap((column) =>
    [0, 1, 2].map((row) => tint[column] * ((1 - s) * [0.2126, 0.7152, 0.0722][column] + (row === column ? s : 0))));
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
form.addEventListener("submit", (event) => event.preventDefault());

return {
  // Begins with a fitted model, or null if there is none to edit.
  begin(of) {
    highlight = of;
    document.getElementById("editing").hidden = !of;
    for (const input of inputs) input.value = 0;
    show_values();
  },
};
}
