// Times of the page beside the command on one thread: node web-times.js, after tools/web and a build of profile release.
import { execFileSync, spawnSync } from "node:child_process";
import { closeSync, mkdirSync, openSync, writeSync } from "node:fs";
import path from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { launch } from "./browser.js";

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
const target = process.env.CARGO_TARGET_DIR || path.join(root, "target");
const native = path.join(target, "release/undrift"), folder = path.join(target, "web/times");
mkdirSync(folder, { recursive: true });

// An hour of six axes at 100 Hz: white noise and a random walk, mulberry32 with seed 1 and Box-Muller.
let state = 1;
function uniform() {
  state = (state + 0x6d2b79f5) | 0;
  let t = Math.imul(state ^ (state >>> 15), 1 | state);
  t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
  return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
}
const normal = () => Math.sqrt(-2 * Math.log(1 - uniform())) * Math.cos(2 * Math.PI * uniform());
const out = openSync(path.join(folder, "static.csv"), "w"), bias = [0, 0, 0, 0, 0, 0];
writeSync(out, "t_s,gx_dps,gy_dps,gz_dps,ax_mps2,ay_mps2,az_mps2\n");
for (let k = 0; k < 360000; k++) {
  const row = bias.map((_, i) => {
    bias[i] += (i < 3 ? 3e-4 : 1e-5) * normal();
    return (bias[i] + (i < 3 ? 0.05 : 0.01) * normal() - (i === 5 ? 9.81 : 0)).toFixed(6);
  });
  writeSync(out, `${(k / 100).toFixed(2)},${row.join(",")}\n`);
}
closeSync(out);
// Half an hour at 200 Hz.
execFileSync("cargo", ["run", "--quiet", "--release", "-p", "undrift-lab", "--bin", "simulate_log", "--", path.join(folder, "drive"), "1800", "200"], { cwd: root });

const browser = await launch(), page = await browser.newPage();
await page.goto(pathToFileURL(path.join(target, "web/undrift.html")).href);
async function put(names) {
  await page.evaluate(() => document.body.append(Object.assign(document.createElement("input"), { type: "file", multiple: true, id: "put" })));
  await page.locator("#put").setInputFiles(names.map(name => path.join(folder, name)));
  await page.evaluate(() => { for (const file of document.getElementById("put").files) undrift.put(file.name, file); document.getElementById("put").remove(); });
}

console.log("| task | page [s] | command, one thread [s] | ratio |\n|---|---|---|---|");
async function time(task, args, cwd) {
  const own = await page.evaluate(async args => { const done = await undrift.run(args); return { code: done.code, seconds: done.seconds, said: done.warnings }; }, args);
  if (own.code !== 0) throw new Error(own.said.join("\n"));
  const begun = performance.now();
  const theirs = spawnSync(native, args, { cwd, env: { ...process.env, RAYON_NUM_THREADS: "1" }, encoding: "utf8" });
  const seconds = (performance.now() - begun) / 1e3;
  if (theirs.status !== 0) throw new Error(theirs.stderr);
  console.log(`| ${task} | ${own.seconds.toFixed(1)} | ${seconds.toFixed(1)} | ${(own.seconds / seconds).toFixed(2)} |`);
}
await put(["static.csv"]);
await time("Allan deviations, an hour of six axes at 100 Hz", ["identify", "static.csv", "--allan"], folder);
await time("the same, identified", ["identify", "static.csv", "-o", "imu.toml"], folder);
await put(["drive/imu.csv", "drive/gnss.csv", "drive/truth.csv", "drive/drive.toml"]);
await time("a drive of 30 min at 200 Hz", ["navigate", "drive.toml", "-o", "nav.csv"], path.join(folder, "drive"));
await browser.close();
