// Makes the page: one HTML file with the command, its style and its scripts in it.
//
//     node build.mjs undrift.wasm OUT.html
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { mkdtempSync, openSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { WASI } from "node:wasi";
import { gzipSync } from "node:zlib";

const [wasmFile, out] = process.argv.slice(2);
const wasm = readFileSync(wasmFile);
const here = import.meta.dirname;
const folder = mkdtempSync(path.join(tmpdir(), "undrift-web-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));

// Runs the command as the page will, in a folder of its own.
const nowhere = openSync("/dev/null", "w");
const module = await WebAssembly.compile(wasm);
function undrift(...args) {
  const wasi = new WASI({ version: "preview1", args: ["undrift", "--quiet", ...args], preopens: { ".": folder }, stdout: nowhere, returnOnExit: true });
  const code = wasi.start(new WebAssembly.Instance(module, wasi.getImportObject()));
  if (code !== 0) throw new Error(`undrift ${args.join(" ")} ended with ${code}`);
}
const written = name => readFileSync(path.join(folder, name), "utf8");

// Style and policy of the reports, which the page shows in a frame under its own policy: it has to allow theirs too.
undrift("sample", "sample");
undrift("identify", "sample/static.csv", "--allan", "--report", "report.html");
undrift("model", "--list", "--json", "presets.json");
const report = written("report.html");
const hashes = kind => report.match(new RegExp(`${kind}-src ((?:'sha256-[^']+' ?)+)`))[1].trim();
const reportStyle = report.match(/<style>([^]*?)<\/style>/)[1];
const version = /^version = "(.+)"$/m.exec(readFileSync(path.join(here, "../Cargo.toml"), "utf8"))[1];

const bundle = async (entry, define = {}) => {
  const { outputFiles } = await build({ entryPoints: [path.join(here, entry)], bundle: true, minify: true, write: false, format: "iife", target: "es2022", define, legalComments: "none" });
  return outputFiles[0].text.replaceAll("</script", "<\\/script");
};
const script = await bundle("page.js", {
  WORKER: JSON.stringify(await bundle("worker.js")),
  PRESETS: JSON.stringify(Object.keys(JSON.parse(written("presets.json")))),
  VEHICLES: JSON.stringify(["car", "aircraft", "copter", "pedestrian"]),
  VERSION: JSON.stringify(version),
});
const style = reportStyle + readFileSync(path.join(here, "page.css"), "utf8");
const hash = text => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
const policy = [
  "default-src 'none'",
  `script-src ${hash(script)} ${hashes("script")} 'wasm-unsafe-eval'`,
  "worker-src blob:",
  `style-src ${hash(style)} ${hashes("style")}`,
  "img-src data: blob:",
  "base-uri 'none'",
  "form-action 'none'",
].join("; ");
const shim = JSON.parse(readFileSync(path.join(here, "node_modules/@bjorn3/browser_wasi_shim/package.json"), "utf8")).version;
const parts = { POLICY: policy, SHIM: shim, STYLE: style, SCRIPT: script, WASM: gzipSync(wasm, { level: 9 }).toString("base64") };
const page = readFileSync(path.join(here, "page.html"), "utf8").replace(/@([A-Z]+)@/g, (_, name) => parts[name]);
writeFileSync(out, page);
console.log(`${out}: ${(page.length / 1e6).toFixed(1)} MB, ${(gzipSync(page, { level: 9 }).length / 1e6).toFixed(2)} MB with gzip`);
