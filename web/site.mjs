// node site.mjs MODULE.wasm FOLDER VERSION: writes the page as a folder, and beside it the page in one file and the module as a package.
import { readFile, readdir, writeFile, mkdir, copyFile } from "node:fs/promises";
import { gzipSync } from "node:zlib";
import path from "node:path";
import { fileURLToPath } from "node:url";

const [module_file, folder, version] = process.argv.slice(2);
const web = path.dirname(fileURLToPath(import.meta.url)), root = path.dirname(web);
const text = (name) => readFile(path.join(web, name), "utf8");
const fill_in = (template, parts) => template.replace(/{{(\w+)}}/g, (_, name) => parts[name]);

// The page, with the same pictures as exported ones.
const button = (show, name) => `<button type="button" data-show="${show}" aria-pressed="false">${name}</button>\n`;
const figure = (subject, name) =>
  `<figure data-material="${subject}"><canvas tabindex="0" aria-label="${name}"></canvas><figcaption>${name}</figcaption></figure>\n`;
// A slider of an edit with its reset button, from -range to range; `ends` are the labels of both ends. Screen readers read the part.
const slider_template = await text("slider.html");
function slider(name, label, part = "", { range = 1, step = 0.02, ends = [] } = {}) {
  const of_part = part && ` of the ${part}`, labels = ends.map((end) => `<span>${end}</span>`).join(" ");
  return fill_in(slider_template, { name, label, range, step, spoken_label: label.toLowerCase() + of_part,
    suffix: of_part && `<span class="unseen">${of_part}</span>`, ends: labels && `<span class="ends">${labels}</span>` });
}
const k_warmth = { ends: ["cooler", "warmer"] };
const sliders = {
  highlight_sliders: slider("roughen", "Roughness", "highlight") + slider("highlight", "Brightness", "highlight") +
    slider("highlight_warmth", "Tint", "highlight", k_warmth),
  body_sliders: slider("body", "Brightness", "body") + slider("body_warmth", "Tint", "body", k_warmth),
  both_sliders: slider("hue", "Hue", "", { range: 180, step: 1 }) + slider("saturate", "Saturation"),
};
const pictures = [["0", "measured"], ["1", "fitted"], ["2", "edited"], ["difference", "difference × 10"]];
const viewer = fill_in(await text("pictures.html"), {
  pictures_lead: "Drag a picture to turn the object. Choose a light, or drop your own .hdr file.",
  choices: `<div class="choices" role="group" aria-label="Which pictures are shown">\n${button("all", "Side by side")}${button("wipe", "Wipe")}${
    pictures.map(([subject, name]) => button(subject, name)).join("")}</div>\n`,
  pictures: pictures.map(([subject, name]) => figure(subject, name)).join(""), own_shape: "",
  behind: '<button type="button" name="behind">Light from behind</button>\n',
  picture_note: '<p class="note compared">The picture “measured” is drawn from a coarser table, in which light and viewer can be exchanged. ' +
    "The errors are against the file, where the exchange may change values.</p>\n",
});
await mkdir(path.join(folder, "data"), { recursive: true });
// The ready models, in the order of their picture: measured ones first. A ball is a part of the picture.
const k_columns = 5, k_rows = 4, k_row = 203, k_ball = 150; // rows have k_row pixels, of which k_ball show the ball
const is_measured = (name) => !name.includes("_stand_in");
const models = (await readdir(path.join(root, "data/gallery"))).filter((name) => name.endsWith(".srbf")).sort()
  .sort((a, b) => is_measured(b) - is_measured(a));
const balls = await readFile(path.join(root, "data/gallery/gallery.jpg"));
// The table of data/README.md: kind, what the model was fitted to, its error, that in Blender, and its licence.
const table = await readFile(path.join(root, "data/README.md"), "utf8"), descriptions = new Map();
for (const [, name, kind, ...rest] of table.matchAll(/^\| (\w+) \| (.+) \| (.+) \| ([\d.]+) \| (.+) \| (\w+) \|$/gm)) {
  const [source, error, blender, licence] = rest;
  descriptions.set(name, { kind: kind[0].toUpperCase() + kind.slice(1), source, error, blender, licence });
}
const k_unknown_terms = "We do not know whether you may publish it: ask the authors of the network, or fit the measurement itself, which " +
  '<a href="https://rgl.epfl.ch/materials">rgl.epfl.ch/materials</a> has.';
const terms = (licence) => licence === "ask" ? k_unknown_terms : `It is under ${licence}, free for any use.`;
const in_blender = (text, error) =>
  text.endsWith(" in all") ? text.replace(" in all", "") : `up to ${(Number(error) + Number(text.replace("adds ", ""))).toFixed(1)}`;
const attribute = (text) => text.replaceAll("&", "&amp;").replaceAll('"', "&quot;");
const ball_template = await text("ball.html"), groups = { true: "", false: "" }; // by is_measured
for (const [index, name] of models.entries()) {
  const stem = path.parse(name).name, x = index % k_columns, shift = 100 * Math.floor(index / k_columns) * k_row / (k_rows * k_row - k_ball);
  const { kind, source, error, blender, licence } = descriptions.get(stem);
  const error_in_blender = in_blender(blender, error), about = `ΔE ${error} against ${source}; in Blender ${error_in_blender}.`;
  groups[is_measured(name)] += fill_in(ball_template, { stem, kind, error, in_blender: error_in_blender, kind_value: attribute(kind),
    about_value: attribute(about), terms_value: attribute(terms(licence)), position: `${100 * x / (k_columns - 1)}% ${shift.toFixed(2)}%` });
}
const gallery = `<h3>Measured, free for any use (CC0)</h3>\n<ul>\n${groups.true}</ul>\n` +
  `<h3>Computed by a neural network: <a href="#gallery_notes">ask before you publish</a></h3>\n<ul>\n${groups.false}</ul>`;
await writeFile(path.join(folder, "data", "gallery.jpg"), balls);
const page = fill_in(await text("app.html"), { viewer, version, gallery, ...sliders });
const k_ball_elements = "#gallery i, #stored, #viewer.stored figure::before";
const with_balls = (address) => page.replace("</head>", `<style>${k_ball_elements} { background-image: url(${address}) }</style>\n</head>`);
await writeFile(path.join(folder, "index.html"), with_balls("data/gallery.jpg"));
const page_files = {};
for (const name of ["style.css", "app.css", "light.js", "painter.js", "viewer.js", "binding.js", "working.js", "editing.js", "app.js"]) {
  page_files[name] = await text(name);
  await writeFile(path.join(folder, name), page_files[name]);
}

// Precomputed data of the ready models. Their shaders have nearly all lines in common.
const binding = new Function(`${await text("binding.js")}\nreturn binding;`)();
const srbf = await binding().new_srbf(await WebAssembly.compile(await readFile(module_file)));
const lines = new Map(), prepared_models = {}; // the number of each line, and each model with numbers in place of lines
const number_of = (line) => lines.get(line) ?? lines.set(line, lines.size).size - 1;
for (const name of models) {
  const { number } = srbf.open(name, await readFile(path.join(root, "data/gallery", name)));
  const material = JSON.parse(new TextDecoder().decode(srbf.viewer_material(number)));
  prepared_models[name] = { material: { ...material, text: material.text.split("\n").map(number_of) }, highlight: srbf.highlight(number) };
  srbf.close(number);
}

// Data as scripts, because a page opened from a disk may not fetch files.
const k_samples = ["cc_ibiza_sunset_rgb.bsdf", "paper_white_rgb.bsdf"];
const data_files = { module: await readFile(module_file), studio: await readFile(path.join(root, "data/studio.hdr")),
  prepared: JSON.stringify({ lines: [...lines.keys()], models: prepared_models }) };
for (const sample of k_samples) data_files[sample] = await readFile(path.join(root, "data", sample));
for (const model of models) data_files[model] = await readFile(path.join(root, "data/gallery", model));
let embedded = "";
for (const [name, content] of Object.entries(data_files)) {
  const packed = gzipSync(content, { level: 9 });
  if (!models.includes(name)) console.log(`${name}: ${packed.length} bytes compressed`);
  const data = packed.toString("base64");
  await writeFile(path.join(folder, "data", name + ".js"), `srbf_given("${name}", "${data}");\n`);
  embedded += `<script type="text/plain" id="data/${name}">${data}</script>\n`;
}

// The page in one file, without the report. Its data comes last, so that the page is shown before they are read.
const one_file = with_balls(`data:image/jpeg;base64,${balls.toString("base64")}`)
  .replace(/ <a href="gallery.*?<\/a>/, "").replace("One folder", "One file")
  .replace(/<link rel="stylesheet" href="(.*?)">/g, (_, name) => `<style>\n${page_files[name]}</style>`)
  .replace("</body>", () => embedded + "</body>")
  .replace(/<script src="(.*?)"><\/script>/g, (_, name) => `<script>\n${page_files[name].replaceAll("</script", "<\\/script")}</script>`);
await writeFile(path.join(path.dirname(folder), "srbf.html"), one_file);

// The package for scripts, ready to publish.
const package_folder = path.join(path.dirname(folder), "npm");
await mkdir(package_folder, { recursive: true });
const parts = { version, binding: page_files["binding.js"], languages: srbf.code_languages().map((name) => `"${name}"`).join(" | ") };
for (const name of ["package.json", "srbf.d.ts", "srbf.mjs", "README.md"])
  await writeFile(path.join(package_folder, name), fill_in(await text(path.join("package", name)), parts));
await copyFile(module_file, path.join(package_folder, "srbf.wasm"));
