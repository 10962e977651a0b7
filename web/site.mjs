// node site.mjs MODULE.wasm FOLDER VERSION PICTURES: writes the page for any browser as one folder, and beside it the page in one
// file and the module as a package. PICTURES is a folder with NAME.png for each data/gallery/NAME.srbf.
import { readFile, readdir, writeFile, mkdir, copyFile } from "node:fs/promises";
import { gzipSync } from "node:zlib";
import path from "node:path";
import { fileURLToPath } from "node:url";

const [module_file, folder, version, drawn] = process.argv.slice(2);
const web = path.dirname(fileURLToPath(import.meta.url)), root = path.dirname(web);
const text = (name) => readFile(path.join(web, name), "utf8");
const filled = (template, parts) => template.replace(/{{(\w+)}}/g, (_, name) => parts[name]);

// The page, with the same pictures as exported ones.
const button = (show, name) => `<button type="button" data-show="${show}" aria-pressed="false">${name}</button>\n`;
const figure = (subject, name) => `<figure data-material="${subject}"><canvas tabindex="0" aria-label="${name}"></canvas><figcaption>${name}</figcaption></figure>\n`;
const pictures = [["0", "measured"], ["1", "fitted"], ["2", "edited"], ["difference", "difference × 10"]];
const viewer = filled(await text("pictures.html"), {
  pictures_lead: "Drag a picture to turn the object; all of them follow.",
  choices: `<div class="choices" role="group" aria-label="Which pictures are shown">\n${button("all", "Side by side")}${button("wipe", "Wipe")}${
    pictures.map(([subject, name]) => button(subject, name)).join("")}</div>\n`,
  pictures: pictures.map(([subject, name]) => figure(subject, name)).join(""), own_shape: "", behind: '<button type="button" name="behind">Light from behind</button>\n', 
  picture_note: '<p class="note">The picture “measured” is drawn from a coarser table, in which light and viewer can be exchanged. The errors are ' +
    "against the file, which need not be so.</p>\n",
});
await mkdir(path.join(folder, "data"), { recursive: true });
const models = (await readdir(path.join(root, "data/gallery"))).filter((name) => name.endsWith(".srbf")).sort();
let gallery = "";
for (const name of models.map((name) => path.parse(name).name)) {
  const title = name.replace(/_stand_in$/, " (stand-in)").replaceAll("_", " ");
  gallery += `<li><a href="#${name}"><img src="data/${name}.png" width="120" height="120" alt="" loading="lazy">${title}</a></li>\n`;
  await copyFile(path.join(drawn, name + ".png"), path.join(folder, "data", name + ".png"));
}
const page = filled(await text("app.html"), { viewer, version, gallery });
await writeFile(path.join(folder, "index.html"), page);
const parts = {};
for (const name of ["style.css", "app.css", "light.js", "painter.js", "viewer.js", "binding.js", "working.js", "editing.js", "app.js"]) {
  parts[name] = await text(name);
  await writeFile(path.join(folder, name), parts[name]);
}

// Data as scripts, because a page opened from a disk may not fetch files.
let inside = "";
for (const [name, file] of [["module", module_file], ["studio", path.join(root, "data/studio.hdr")],
  ...["cc_ibiza_sunset_rgb.bsdf", "paper_white_rgb.bsdf"].map((sample) => [sample, path.join(root, "data", sample)]),
  ...models.map((name) => [name, path.join(root, "data/gallery", name)])]) {
  const packed = gzipSync(await readFile(file), { level: 9 });
  if (!models.includes(name)) console.log(`${name}: ${packed.length} bytes compressed`);
  const data = packed.toString("base64");
  await writeFile(path.join(folder, "data", name + ".js"), `srbf_given("${name}", "${data}");\n`);
  inside += `<script type="text/plain" id="data/${name}">${data}</script>\n`;
}

// The page in one file, with one picture of the gallery and without the report.
const spheres = (await readFile(path.join(root, "data/gallery/gallery.jpg"))).toString("base64");
const one_file = page.replaceAll(/<img[^>]*>/g, "").replace(/(<section id="gallery">[^]*?)<ul>/, (_, head) =>
    `${head}<img src="data:image/jpeg;base64,${spheres}" style="width: min(100%, 40rem); aspect-ratio: auto" alt="Spheres of the materials, with their names">\n<ul>`)
  .replace(/ <a href="gallery.*?<\/a>/, "").replace("One folder", "One file")
  .replace(/<link rel="stylesheet" href="(.*?)">/g, (_, name) => `<style>\n${parts[name]}</style>`)
  .replace('<script src="light.js">', () => inside + '<script src="light.js">')
  .replace(/<script src="(.*?)"><\/script>/g, (_, name) => `<script>\n${parts[name].replaceAll("</script", "<\\/script")}</script>`);
await writeFile(path.join(path.dirname(folder), "srbf.html"), one_file);

// The package for scripts, ready to publish.
const package_folder = path.join(path.dirname(folder), "npm");
await mkdir(package_folder, { recursive: true });
for (const name of ["package.json", "srbf.d.ts", "srbf.mjs", "README.md"])
  await writeFile(path.join(package_folder, name), filled(await text(path.join("package", name)), { version, binding: await text("binding.js") }));
await copyFile(module_file, path.join(package_folder, "srbf.wasm"));
