// Makes the real reports that the tests open: of a simulated drive whose files, columns and model have hostile
// names, of one hour at 200 Hz, of the demo, and of a static recording. `node make.js DIR PROGRAM SIMULATE`: where
// to, and the programs undrift and simulate_log.
import { execFile } from "node:child_process";
import { mkdir, readFile, rename, rm, writeFile } from "node:fs/promises";
import { cpus } from "node:os";
import path from "node:path";
import { promisify } from "node:util";
import { COLUMN, DRIVE, GNSS, MODEL } from "./hostile.js";

const [dir, undrift, simulate] = process.argv.slice(2).map(argument => path.resolve(argument));
const run = (program, ...arguments_) => promisify(execFile)(program, arguments_, { maxBuffer: 1 << 26 });
const at = name => path.join(dir, name);

// Five minutes at 50 Hz, its names hostile, 40 s without fixes and some fixes far off.
async function hostile() {
  const folder = at("hostile-drive");
  await rm(folder, { recursive: true, force: true });
  await run(simulate, folder, "300", "50");
  const file = name => path.join(folder, name);
  const edit = async (name, change) => writeFile(file(name), change(await readFile(file(name), "utf8")));
  const quoted = JSON.stringify;
  await edit("imu.csv", text => text.replace("gx_radps", `"${COLUMN}"`));
  await edit("gnss.csv", text => {
    const [head, ...lines] = text.trimEnd().split("\n");
    const kept = lines.filter(line => !(parseFloat(line) >= 150 && parseFloat(line) < 190));
    const jump = line => line.split(",").map((cell, i) => i === 1 ? String(Number(cell) + 0.001) : cell).join(",");
    return [head, ...kept.map((line, i) => i % 50 === 37 ? jump(line) : line)].join("\n") + "\n";
  });
  await edit("drive.toml", text => text
    .replace('"gx_radps"', quoted(COLUMN))
    .replace('"gnss.csv"', quoted(GNSS))
    .replace('model = "adis16405"', `[model]\npreset = "adis16405"\nname = ${quoted(MODEL)}`));
  await rename(file("gnss.csv"), file(GNSS));
  await rename(file("drive.toml"), file(DRIVE));
  const model = name => ["--bias-model", name, "--json", at(`${name}${DRIVE}.json`)];
  await run(undrift, "navigate", file(DRIVE), ...model("gauss-markov"), "--report", at("navigate.html"));
  await run(undrift, "navigate", file(DRIVE), ...model("random-walk"));
  await run(undrift, "report", at(`gauss-markov${DRIVE}.json`), at(`random-walk${DRIVE}.json`), "-o", at("compare.html"));
  await run(undrift, "outages", file(DRIVE), "--length", "10", "--every", "25", "--start", "60", "--bias-models", "all", "--report", at("outages.html"));
}

async function hour() {
  const folder = at("hour-drive");
  await run(simulate, folder, "3600", "200");
  await run(undrift, "navigate", path.join(folder, "drive.toml"), "--bias-model", "gauss-markov", "--report", at("hour.html"));
  await rm(folder, { recursive: true });
}

// Twenty minutes of a static recording.
async function identify() {
  const folder = at("sample");
  await rm(folder, { recursive: true, force: true });
  await run(undrift, "sample", folder);
  await run(undrift, "identify", path.join(folder, "static.csv"), "--report", at("identify.html"));
  await rm(folder, { recursive: true });
}

const demo = () => run(undrift, "demo", "--report", at("demo.html"));

await mkdir(dir, { recursive: true });
const works = [hour, demo, hostile, identify];
// The demo uses every core itself: with few, one after the other is as quick.
if (cpus().length > 4) await Promise.all(works.map(work => work()));
else for (const work of works) await work();
