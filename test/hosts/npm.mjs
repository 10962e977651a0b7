// node npm.mjs [PROGRAM]: checks that the package of build/npm fits what the program fits, and that broken files do not stop it.
// needs: site
import assert from "node:assert";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";

const root = path.join(path.dirname(fileURLToPath(import.meta.url)), "../.."), folder = mkdtempSync(path.join(tmpdir(), "srbf-npm-"));
const { fit, open } = await import(path.join(root, "build/npm/srbf.mjs"));
const program = (...all) => execFileSync(process.argv[2] ?? path.join(root, "build/release/srbf"), all, { stdio: "pipe" });
const paper = path.join(root, "data/paper_white_rgb.bsdf"), bytes = readFileSync(paper), name = "paper_white_rgb.bsdf";

// A three.js module has lobes for environments, which are found by what renderers evaluate: their numbers depend on the processor.
const comparable = (code, language) => language === "three" ? code.replace(/-?\d+\.?\d*(e[-+]?\d+)?/g, "#") : code;

const fractions = [];
const model = await fit(bytes, { name, lobes: 2, progress: (stage, fraction) => { fractions.push(fraction); } });
program("fit", paper, "--lobes", "2", "-o", path.join(folder, "paper_white_rgb.srbf"));
const file = readFileSync(path.join(folder, "paper_white_rgb.srbf"));
assert.deepEqual(Buffer.from(model.file()), file, "the model's file");
for (const language of ["glsl", "hlsl", "wgsl", "msl", "c", "three"]) {
  const exported = path.join(folder, language);
  program("export", path.join(folder, "paper_white_rgb.srbf"), "--to", language, "-o", exported);
  assert.equal(comparable(model.code(language), language), comparable(readFileSync(exported, "utf8"), language), language);
}
assert(fractions.length > 10 && fractions.every((x, i) => i === 0 || x >= fractions[i - 1]) && fractions.at(-1) <= 1, "progress");
assert.equal(model.report.bytes, file.length - 8 - Number(file.readBigUint64LE()), "the report's bytes");
const again = await open(file, "paper_white_rgb.srbf"), wl = [0, 0, 1, 0.6, 0, 0.8], wv = [0.6, 0, 0.8, 0, 0, 1];
assert.deepEqual(again.evaluate(wl, wv), model.evaluate(wl, wv));
assert(model.evaluate(wl, wv).every((f) => f > 0.1 && f < 1), "paper is white");
await assert.rejects(fit(bytes, { name, lobe: 3 }), /options: expected model/);
await assert.rejects(fit(bytes, { name, lobes: 0 }), /options: lobes: expected 1 to 64 or auto, found 0/);
await assert.rejects(fit(bytes, { name, progress: () => false }), /cancelled/);
await assert.rejects(open(bytes.subarray(0, 1000), name), /^Error: paper_white_rgb.bsdf: /);

// Each file of the corpus of the fuzzers, whole or cut, gives an error of one line or a BRDF with values, and never a trap.
let read = 0, refused = 0;
for (const kind of readdirSync(path.join(root, "fuzz/corpus"))) {
  if (kind === "command_line") continue;
  for (const name of readdirSync(path.join(root, "fuzz/corpus", kind))) {
    const whole = readFileSync(path.join(root, "fuzz/corpus", kind, name));
    for (const fraction of [1, 0.9, 0.5, 0.1])
      try {
        const opened = await open(whole.subarray(0, Math.floor(fraction * whole.length)), name);
        opened.evaluate(wl, wv);
        opened.close();
        ++read;
      } catch (error) {
        assert(!(error instanceof WebAssembly.RuntimeError) && !error.message.includes("\n"), `${kind}/${name}: ${error.message}`);
        ++refused;
      }
  }
}
assert(read > 10 && refused > 10, `${read} read, ${refused} refused`);
rmSync(folder, { recursive: true });
console.log(`  the package fits what the program fits; ${read} files of the corpus read, ${refused} refused`);
