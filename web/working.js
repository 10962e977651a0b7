// The page's worker. It reads, fits and writes, so that the page itself never waits. The text of this function is
// self-contained. It receives { kind: "begin", id, module, studio, prepared }, compressed or as an earlier worker returned
// them, and then { kind, id, .. } where kind names one of `actions`. It posts { id, result } or { id, error }, and
// during a fit { progress, stage } and once { draft }, a first model.
"use strict";
function working() {
"use strict";
const { new_srbf } = binding();
let srbf = null, measured = null, model = null, edited = null, prepared = null;

// Decodes a script of the folder `data`: base64 of a gzip-compressed file.
async function unpack(text) {
  const packed = atob(text), bytes = new Uint8Array(packed.length);
  for (let i = 0; i < packed.length; ++i) bytes[i] = packed.charCodeAt(i);
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer());
}
// The material of a picture, as bytes because the page only passes it on; null without a picture.
function material_of({ number }) {
  const bytes = srbf.viewer_material(number), material = JSON.parse(new TextDecoder().decode(bytes));
  return material && { bytes, exposure: material.exposure };
}
// The material of a ready model's picture, and the data for previews of its edits, from `prepared`, which site.mjs computed.
function prepared_picture(name) {
  const { material, highlight } = prepared.models[name], text = material.text.map((line) => prepared.lines[line]).join("\n");
  return { highlight, material: { bytes: new TextEncoder().encode(JSON.stringify({ ...material, text })), exposure: material.exposure } };
}
let span = [0, 1]; // the part of an action to which the module's progress refers
const k_draft_fraction = 0.15; // of the time of a fit, approximately

const actions = {
  open({ name, bytes, is_ready }) {
    for (const subject of [measured, model, edited]) if (subject) srbf.close(subject.number);
    measured = model = edited = null;
    const opened = srbf.open(name, bytes);
    if (opened.model) {
      model = opened;
      const shown = is_ready ? prepared_picture(name) : { highlight: srbf.highlight(model.number), material: material_of(model) };
      return { ...model, ...shown, slices: srbf.slices(0, model.number) };
    }
    measured = opened;
    return { ...measured, material: material_of(measured), slices: srbf.slices(measured.number, 0) };
  },
  fit({ options }) {
    if (!measured.twoSided) {
      span = [0, k_draft_fraction];
      const { number, ...report } = srbf.draft(measured.number, options), material = material_of({ number });
      postMessage({ draft: { ...report, material, slices: srbf.slices(measured.number, number) } }, [material.bytes.buffer]);
      srbf.close(number);
      span = [k_draft_fraction, 1];
    }
    const fitted = srbf.fit(measured.number, options);
    for (const subject of [model, edited]) if (subject) srbf.close(subject.number);
    model = fitted, edited = null;
    return { ...model, highlight: srbf.highlight(model.number), material: material_of(model), slices: srbf.slices(measured.number, model.number),
      file: srbf.model_file(model.number), memory: srbf.memory_bytes() };
  },
  // Edits the fitted model; without edits the model itself is saved again.
  edit({ edits }) {
    if (edited) srbf.close(edited.number);
    edited = null; // also if the edit fails
    if (Object.keys(edits).length) edited = srbf.edit(model.number, edits);
    return edited ? { ...edited, material: material_of(edited), file: srbf.model_file(edited.number) } : {};
  },
  // Opens the models that an earlier worker made from this file. `files`: their name and bytes.
  restore(files) {
    if (files.fitted) model = srbf.open(`${files.name}.srbf`, files.fitted);
    if (files.edited) edited = srbf.open(`${files.name}_edited.srbf`, files.edited);
    return {};
  },
  // The content is a Blob, which the page receives without a copy. A material for Blender reports its own error.
  // `measurement`: the name and packed bytes of the model's measurement, or null if the page does not have it.
  async save({ what, name, measurement }) {
    const opened = measurement && srbf.open(measurement.name, await unpack(measurement.bytes));
    const { number } = edited ?? model, source = opened ?? measured, is_table = source && !source.twoSided && source.samples === null;
    const for_blender = !edited && is_table ? source.number : number; // nearer to a measurement than to its fit
    const writers = { srbf: () => srbf.model_file(number), table: () => srbf.table(number, name), blender: () => srbf.blender(for_blender),
      page: () => srbf.page(number, measured?.number ?? 0) };
    const content = writers[what] ? writers[what]() : srbf.code(number, what);
    const error = what === "blender" ? { deltaE: srbf.blender_error(for_blender), isOfModel: for_blender === number } : null;
    if (opened) srbf.close(opened.number);
    return { content: new Blob([content], { type: "application/octet-stream" }), error };
  },
};
let last_report = 0; // the time of the last progress that was posted
onmessage = async ({ data }) => {
  const { kind, id } = data;
  try {
    if (kind === "begin") {
      const module = typeof data.module === "string" ? await WebAssembly.compile(await unpack(data.module)) : data.module;
      const studio = typeof data.studio === "string" ? await unpack(data.studio) : data.studio;
      prepared = typeof data.prepared === "string" ? JSON.parse(new TextDecoder().decode(await unpack(data.prepared))) : data.prepared;
      srbf = await new_srbf(module, (stage, fraction) => {
        const now = performance.now();
        if (now - last_report <= 80) return true;
        postMessage({ progress: span[0] + (span[1] - span[0]) * fraction, stage });
        last_report = now;
        return true;
      });
      srbf.set_studio(studio);
      return postMessage({ id, result: { cache: { module, studio, prepared }, viewer: srbf.viewer_data() } });
    }
    if (typeof data.bytes === "string") data.bytes = await unpack(data.bytes);
    span = [0, 1];
    const result = await actions[kind](data);
    postMessage({ id, result }, result.material ? [result.material.bytes.buffer] : []);
  } catch (error) {
    // After a trap the module's memory is inconsistent, so the page starts a new worker.
    const is_trap = error instanceof WebAssembly.RuntimeError || error instanceof RangeError;
    const why = is_trap ? `${data.name ?? "this"}: it takes more memory than the browser gives (${error.message})` : error.message;
    postMessage({ id, error: why, is_trap });
  }
};
}
