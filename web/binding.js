// The library's WebAssembly module (web/module.cpp) as functions of JavaScript, for pages, workers and scripts alike. A function
// of its own text, which a page gives to its worker too.
"use strict";
function binding() {
"use strict";
const encoder = new TextEncoder(), decoder = new TextDecoder();

// What the C library asks of a system: a clock, and somewhere to say why it stops.
function system_of(memory) {
  const view = () => new DataView(memory().buffer);
  let said = "";
  return { said: () => said, imports: {
    clock_time_get(id, precision, at) { view().setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true); return 0; },
    clock_res_get(id, at) { view().setBigUint64(at, 1000n, true); return 0; },
    fd_write(file, parts, count, written) {
      let sum = 0;
      for (let i = 0; i < count; ++i) {
        const from = view().getUint32(parts + 8 * i, true), size = view().getUint32(parts + 8 * i + 4, true);
        said += decoder.decode(new Uint8Array(memory().buffer, from, size).slice());
        sum += size;
      }
      view().setUint32(written, sum, true);
      return 0;
    },
    proc_exit(status) { throw new Error(said.trim() || `the module ended with status ${status}`); },
  } };
}

// An instance of the compiled module. `progress(stage, fraction)` may return false to cancel a fit.
async function new_srbf(module, progress = () => true) {
  let c = null;
  const memory = () => c.memory, bytes_at = (at, size) => new Uint8Array(c.memory.buffer, at, size);
  const system = system_of(memory), k_no_system = 52; // ENOSYS
  const wasi = new Proxy(system.imports, { get: (all, name) => all[name] ?? (() => k_no_system) });
  const imports = { srbf: { progress: (at, size, fraction) => progress(decoder.decode(bytes_at(at, size).slice()), fraction) === false ? 0 : 1 } };
  for (const { module: from, name } of WebAssembly.Module.imports(module))
    if (from === "wasi_snapshot_preview1") (imports[from] ??= {})[name] = wasi[name];
  c = (await WebAssembly.instantiate(module, imports)).exports;
  c._initialize?.();

  // Calls f with the places and sizes of these texts and arrays of bytes.
  function with_bytes(all, f) {
    const places = all.map((of) => {
      const bytes = typeof of === "string" ? encoder.encode(of) : of, at = c.srbf_allocate(Math.max(bytes.length, 1));
      if (!at) throw new Error("out of memory");
      bytes_at(at, bytes.length).set(bytes);
      return [at, bytes.length];
    });
    try {
      return f(...places.flat());
    } finally {
      for (const [at] of places) c.srbf_free(at);
    }
  }
  const content = () => bytes_at(c.srbf_content(), c.srbf_content_size()).slice();
  const text = () => decoder.decode(content());
  // What a function returned, unless it failed: then the content is why, in one line.
  function checked(status) {
    if (!status) throw new Error(text());
    return status;
  }
  const described = (number) => ({ number, ...JSON.parse(text()) });
  const floats = (directions) => {
    const all = Float32Array.from(directions);
    return new Uint8Array(all.buffer);
  };
  return {
    // A measurement or a model from the bytes of a file of that name.
    open: (name, bytes) => described(checked(with_bytes([name, bytes], c.srbf_open))),
    close: (number) => c.srbf_close(number),
    // A first model of a measurement of one side, soon.
    draft: (number, options = {}) => described(checked(with_bytes([JSON.stringify(options)], (at, size) => c.srbf_draft(number, at, size)))),
    // A model of the measurement, with a report.
    fit: (number, options = {}) => described(checked(with_bytes([JSON.stringify(options)], (at, size) => c.srbf_fit(number, at, size)))),
    model_file: (number) => (checked(c.srbf_model_file(number)), content()),
    code: (number, language, sampling = false) =>
      (checked(with_bytes([language], (at, size) => c.srbf_code(number, at, size, sampling ? 1 : 0))), text()),
    table: (number, name) => (checked(with_bytes([name], (at, size) => c.srbf_table(number, at, size))), content()),
    // f [1/sr] at pairs of directions, x, y, z one after the other: red, green and blue of each.
    evaluate: (number, wl, wv) => {
      const count = wl.length / 3;
      if (!Number.isInteger(count) || wv.length !== wl.length) throw new Error("directions: expected as many to the viewer as to the light, of three numbers each");
      return with_bytes([floats(wl), floats(wv), new Uint8Array(12 * count)], (a, size, b, same, f) => {
        checked(c.srbf_evaluate(number, a, b, f, count));
        return new Float32Array(c.memory.buffer.slice(f, f + 12 * count));
      });
    },
    set_studio: (bytes) => checked(with_bytes([bytes], c.srbf_set_studio)),
    viewer_data: () => (checked(c.srbf_viewer_data()), JSON.parse(text())),
    viewer_material: (number) => (checked(c.srbf_viewer_material(number)), content()), // JSON
    slices: (measured, model) => (checked(c.srbf_slices(measured, model)), text()),
    page: (model, measured) => (checked(c.srbf_page(model, measured)), text()),
    memory_bytes: () => c.memory.buffer.byteLength,
  };
}
return { new_srbf };
}
