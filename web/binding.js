// The library's WebAssembly module (web/module.cpp) as JavaScript functions, for pages, workers and scripts. The
// text of this function is self-contained, since a page passes it to its worker too.
"use strict";
function binding() {
"use strict";
const encoder = new TextEncoder(), decoder = new TextDecoder();

// The functions that the C library needs from a system: a clock, and an output for the reason why it stops.
function new_system(memory) {
  const view = () => new DataView(memory().buffer);
  let output = "";
  return { output: () => output, imports: {
    clock_time_get(id, precision, address) { view().setBigUint64(address, BigInt(Math.round(performance.now() * 1e6)), true); return 0; },
    clock_res_get(id, address) { view().setBigUint64(address, 1000n, true); return 0; },
    fd_write(file, parts, count, written) {
      let sum = 0;
      for (let i = 0; i < count; ++i) {
        const start = view().getUint32(parts + 8 * i, true), size = view().getUint32(parts + 8 * i + 4, true);
        output += decoder.decode(new Uint8Array(memory().buffer, start, size).slice());
        sum += size;
      }
      view().setUint32(written, sum, true);
      return 0;
    },
    proc_exit(status) { throw new Error(output.trim() || `the module ended with status ${status}`); },
  } };
}
// Instantiates the compiled module with what it imports, and returns its exports.
async function instantiate(module, progress) {
  let c = null;
  const memory = () => c.memory, text_at = (address, size) => decoder.decode(new Uint8Array(c.memory.buffer, address, size).slice());
  const system = new_system(memory), k_no_system = 52; // ENOSYS
  const wasi = new Proxy(system.imports, { get: (functions, name) => functions[name] ?? (() => k_no_system) });
  const imports = { srbf: { progress: (address, size, fraction) => progress(text_at(address, size), fraction) === false ? 0 : 1 } };
  for (const { module: from, name } of WebAssembly.Module.imports(module))
    if (from === "wasi_snapshot_preview1") (imports[from] ??= {})[name] = wasi[name];
  c = (await WebAssembly.instantiate(module, imports)).exports;
  c._initialize?.();
  return c;
}
// The functions of the compiled module. `progress(stage, fraction)` may return false to cancel a fit.
async function new_srbf(module, progress = () => true) {
  const c = await instantiate(module, progress);
  const bytes_at = (address, size) => new Uint8Array(c.memory.buffer, address, size);

  // Calls f with the addresses and sizes of copies of these texts and byte arrays.
  function with_bytes(values, f) {
    const copies = values.map((value) => {
      const bytes = typeof value === "string" ? encoder.encode(value) : value, address = c.srbf_allocate(Math.max(bytes.length, 1));
      if (!address) throw new Error("out of memory");
      bytes_at(address, bytes.length).set(bytes);
      return [address, bytes.length];
    });
    try {
      return f(...copies.flat());
    } finally {
      for (const [address] of copies) c.srbf_free(address);
    }
  }
  const content = () => bytes_at(c.srbf_content(), c.srbf_content_size()).slice();
  const text = () => decoder.decode(content());
  // Removes the parts of a message that name command-line options: after a comma or semicolon, or in parentheses.
  const plain = (message) => message.replace(/ \([^()]*--[a-z][^()]*\)|[,;] (?:(?![,;] | \().)*?--[a-z](?:(?![,;] |\)).)*/g, "");
  // Returns a function's result; if it failed, throws its content, which is the error in one line.
  function check(status) {
    if (!status) throw new Error(plain(text()));
    return status;
  }
  const describe = (number) => ({ number, ...JSON.parse(text()) });
  const floats = (directions) => new Uint8Array(Float32Array.from(directions).buffer);
  return {
    // Opens a measurement or a model from the bytes of a file with this name.
    open(name, bytes) {
      const opened = describe(check(with_bytes([name, bytes], c.srbf_open)));
      return { ...opened, ...opened.notes && { notes: opened.notes.map(plain) } };
    },
    close: (number) => c.srbf_close(number),
    // A quick first model of a one-sided measurement.
    draft: (number, options = {}) => describe(check(with_bytes([JSON.stringify(options)], (address, size) => c.srbf_draft(number, address, size)))),
    // A model of the measurement, and a report.
    fit: (number, options = {}) => describe(check(with_bytes([JSON.stringify(options)], (address, size) => c.srbf_fit(number, address, size)))),
    // Data for a preview of edits, or null if the model cannot be edited; and the edited model.
    highlight: (number) => (check(c.srbf_highlight(number)), JSON.parse(text())),
    edit: (number, edits) => describe(check(with_bytes([JSON.stringify(edits)], (address, size) => c.srbf_edit(number, address, size)))),
    model_file: (number) => (check(c.srbf_model_file(number)), content()),
    code_languages: () => (check(c.srbf_code_languages()), JSON.parse(text())),
    code: (number, language, { sampling = false, environment = false } = {}) =>
      (check(with_bytes([language], (address, size) => c.srbf_code(number, address, size, sampling ? 1 : 0, environment ? 1 : 0))), text()),
    blender: (number) => (check(c.srbf_blender(number)), text()), // of a measurement or a model
    blender_error: (number) => (check(c.srbf_blender_error(number)), JSON.parse(text())), // ΔE_ITP of that script against it
    table: (number, name) => (check(with_bytes([name], (address, size) => c.srbf_table(number, address, size))), content()),
    // f [1/sr] at pairs of directions: x, y, z of each in `wl` and `wv`, and R, G, B of each in the result.
    evaluate: (number, wl, wv) => {
      const count = wl.length / 3;
      if (!Number.isInteger(count) || wv.length !== wl.length)
        throw new Error("directions: expected as many to the viewer as to the light, of three numbers each");
      return with_bytes([floats(wl), floats(wv), new Uint8Array(12 * count)], (a, size, b, same, f) => {
        check(c.srbf_evaluate(number, a, b, f, count));
        return new Float32Array(c.memory.buffer.slice(f, f + 12 * count));
      });
    },
    set_studio: (bytes) => check(with_bytes([bytes], c.srbf_set_studio)),
    viewer_data: () => (check(c.srbf_viewer_data()), JSON.parse(text())),
    viewer_material: (number) => (check(c.srbf_viewer_material(number)), content()), // JSON
    slices: (measured, model) => (check(c.srbf_slices(measured, model)), text()),
    page: (model, measured) => (check(c.srbf_page(model, measured)), text()),
    memory_bytes: () => c.memory.buffer.byteLength,
  };
}
return { new_srbf };
}
