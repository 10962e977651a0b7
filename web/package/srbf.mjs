// Fits of measured BRDFs, and what models are good for: see srbf.d.ts.
{{binding}}
const { new_srbf } = binding();
let instance = null, progress = () => true;

// The module beside this file, once.
async function ready() {
  if (!instance) {
    const url = new URL("srbf.wasm", import.meta.url);
    const bytes = url.protocol === "file:" ? await (await import("node:fs/promises")).readFile(url) : await (await fetch(url)).arrayBuffer();
    instance = await new_srbf(await WebAssembly.compile(bytes), (stage, fraction) => progress(stage, fraction));
  }
  return instance;
}

function brdf(srbf, { number, model, ...rest }) {
  const of = {
    evaluate: (wl, wv) => srbf.evaluate(number, wl, wv),
    table: (name) => srbf.table(number, name),
    close: () => srbf.close(number),
  };
  return model === false ? of : { ...of, file: () => srbf.model_file(number), code: (language, { sampling = false } = {}) => srbf.code(number, language, sampling), ...rest };
}

export async function open(bytes, name = "measurement") {
  const srbf = await ready(), { number, model } = srbf.open(name, bytes);
  return brdf(srbf, { number, model });
}

export async function fit(bytes, { name = "measurement", progress: told = () => true, ...options } = {}) {
  const srbf = await ready(), { number } = srbf.open(name, bytes);
  progress = told;
  try {
    const { number: fitted, ...report } = srbf.fit(number, options);
    return brdf(srbf, { number: fitted, report });
  } finally {
    progress = () => true;
    srbf.close(number);
  }
}
