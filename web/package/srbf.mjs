// Fits of measured BRDFs, and uses of their models; srbf.d.ts documents them.
{{binding}}
const { new_srbf } = binding();
let instance = null, progress = () => true;

// The instance of the module in the file beside this one, made once.
async function ready() {
  if (!instance) {
    const url = new URL("srbf.wasm", import.meta.url);
    const bytes = url.protocol === "file:" ? await (await import("node:fs/promises")).readFile(url) : await (await fetch(url)).arrayBuffer();
    instance = await new_srbf(await WebAssembly.compile(bytes), (stage, fraction) => progress(stage, fraction));
  }
  return instance;
}

function brdf(srbf, { number, model, ...rest }) {
  const common = {
    evaluate: (wl, wv) => srbf.evaluate(number, wl, wv),
    table: (name) => srbf.table(number, name),
    blender: () => srbf.blender(number),
    close: () => srbf.close(number),
  };
  if (model === false) return common;
  const code = (language, options = {}) => srbf.code(number, language, options);
  return { ...common, file: () => srbf.model_file(number), code, ...rest };
}

export async function open(bytes, name = "measurement") {
  const srbf = await ready(), { number, model } = srbf.open(name, bytes);
  return brdf(srbf, { number, model });
}

export async function fit(bytes, { name = "measurement", progress: on_progress = () => true, ...options } = {}) {
  const srbf = await ready(), { number } = srbf.open(name, bytes);
  progress = on_progress;
  try {
    const { number: fitted, ...report } = srbf.fit(number, options);
    return brdf(srbf, { number: fitted, report });
  } finally {
    progress = () => true;
    srbf.close(number);
  }
}
