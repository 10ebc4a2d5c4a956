// The page of the browser: what it computes, what it is not allowed to do, and what hostile files do to it.
import test, { before, after } from "node:test";
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync } from "node:fs";
import path from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { gzipSync } from "node:zlib";
import { launch } from "./browser.js";
import { download } from "./page.js";
import { publicData, skipped } from "./data.js";

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
const target = process.env.CARGO_TARGET_DIR || path.join(root, "target");
const file = path.join(target, "web/undrift.html"), native = path.join(target, "release/undrift"), simulate = path.join(target, "release/simulate_log");
const missing = existsSync(file) ? false : `${file} is missing: tools/web makes it`;
const scratch = path.join(target, "web/scratch");

let browser;
before(async () => {
  browser = await launch();
  rmSync(scratch, { recursive: true, force: true });
  mkdirSync(scratch, { recursive: true });
});
after(() => browser.close());

// A button as the page's code calls it, and those that the tests have pressed.
const called = button => button.id || button.value || button.textContent;
const pressed = new Set();

async function open(options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
  await context.exposeFunction("pressed", name => pressed.add(name));
  await context.addInitScript(`addEventListener("click", ({ target }) => { const button = target.closest?.("button"); if (button) pressed((${called})(button)); }, true)`);
  const page = await context.newPage(), troubles = [];
  page.on("console", message => { if (["error", "warning"].includes(message.type()) && !/willReadFrequently/.test(message.text())) troubles.push(message.text()); });
  page.on("pageerror", error => troubles.push(String(error)));
  page.on("request", request => { if (!/^(file|data|blob|about):/.test(request.url())) troubles.push("request: " + request.url()); });
  await page.goto(pathToFileURL(file).href);
  return { page, troubles, close: () => context.close() };
}

// Runs the command in the page; its files are put there first.
const run = (page, args, results = []) => page.evaluate(async ({ args, results }) => {
  const done = await undrift.run(args, results);
  const files = {};
  for (const [name, blob] of Object.entries(done.files)) files[name] = await blob.text();
  return { code: done.code, output: done.output, warnings: done.warnings, files };
}, { args, results });

// Puts files there by the page's own input, without its analysis.
async function put(page, paths) {
  await page.evaluate(() => {
    const input = Object.assign(document.createElement("input"), { type: "file", multiple: true, id: "put" });
    document.body.append(input);
  });
  await page.locator("#put").setInputFiles(paths);
  await page.evaluate(() => {
    for (const file of document.getElementById("put").files) undrift.put(file.name, file);
    document.getElementById("put").remove();
  });
}

const idle = page => page.waitForFunction(() => !undrift.busy() && document.getElementById("busy").hidden, null, { timeout: 600000 });

// Numbers agree to a relative `tolerance`: the processor's fused multiplications, which WebAssembly has not, round otherwise.
function same(own, other, tolerance, at = "") {
  if (typeof own === "number" && typeof other === "number") {
    assert.ok(own === other || Math.abs(own - other) <= tolerance * Math.max(Math.abs(own), Math.abs(other)) + 1e-12, `${at}: ${own} and ${other}`);
  } else if (own !== null && typeof own === "object") {
    assert.deepEqual(Object.keys(own), Object.keys(other ?? {}), at);
    for (const key of Object.keys(own)) same(own[key], other[key], tolerance, `${at}/${key}`);
  } else assert.equal(own, other, at);
}

test("the page and the command in it are below 4 MB with gzip", { skip: missing }, () => {
  assert.ok(gzipSync(readFileSync(file)).length < 4e6);
});

test("the column of times is a field of the form, and messages call it so", { skip: missing }, async () => {
  const { page, troubles, close } = await open();
  const noise = k => (((k * 7919) % 1013) / 1013 - 0.5) * 0.02;
  const row = k => [k * 655, ...[1, 2, 3].map(axis => noise(k * 3 + axis)), noise(k * 5), noise(k * 11), 9.80665 + noise(k * 17)].join(",");
  const table = path.join(scratch, "ticks.csv");
  writeFileSync(table, "ticks,gx,gy,gz,ax,ay,az\n" + Array.from({ length: 3000 }, (_, k) => row(k)).join("\n") + "\n");
  await page.setInputFiles("#choose", table);
  await page.waitForFunction(() => /Column of times/.test(document.getElementById("messages").textContent), null, { timeout: 60000 });
  await idle(page);
  assert.doesNotMatch(await page.textContent("#messages"), /--time|--rate/);
  await page.fill("#rate", "");
  await page.fill("#time", "ticks,LSB/32768 s");
  await page.click("#static .do");
  await idle(page);
  assert.match(await page.textContent("#text"), /at 50\.0 Hz/);
  assert.deepEqual(troubles, []);
  await close();
});

test("nothing can be sent", { skip: missing }, async () => {
  const { page, close } = await open();
  const sent = await page.evaluate(async () => {
    const tries = {
      fetch: () => fetch("https://example.org/"),
      image: () => new Promise((done, failed) => { const image = new Image(); image.onload = done; image.onerror = () => failed(new Error("blocked")); image.src = "https://example.org/x.png"; }),
      beacon: async () => { const refused = new Promise(done => addEventListener("securitypolicyviolation", done, { once: true })); navigator.sendBeacon("https://example.org/", "x"); await Promise.race([refused.then(() => { throw new Error("blocked"); }), new Promise(done => setTimeout(done, 2000))]); },
      socket: () => new Promise((done, failed) => { const socket = new WebSocket("wss://example.org/"); socket.onopen = done; socket.onerror = () => failed(new Error("blocked")); }),
    };
    const through = [];
    for (const [name, attempt] of Object.entries(tries)) await attempt().then(() => through.push(name), () => {});
    return through;
  });
  assert.deepEqual(sent, []);
  await close();
});

test("a simulated recording is identified at a click, and saved for Kalibr", { skip: missing }, async () => {
  const { page, troubles, close } = await open();
  await page.click("#sample-static");
  await page.waitForFunction(() => document.getElementById("downloads").children.length > 3, null, { timeout: 180000 });
  await idle(page);
  assert.match(await page.textContent("#text"), /^Usable: 6 axes/);
  assert.match(await page.textContent("#preview table"), /force/);
  await page.frameLocator("#report").locator("figure").first().waitFor({ timeout: 20000 });
  const { name, text } = await download(page, () => page.locator("#downloads button", { hasText: "Kalibr" }).click());
  assert.equal(name, "imu.yaml");
  assert.match(text, /gyroscope_noise_density/);
  assert.deepEqual(troubles, []);
  await close();
});

// Presses a button that begins a run: a verdict, no error, a report with a figure, and files that are not empty.
async function result(page, button) {
  const name = await button.evaluate(called);
  await button.click();
  await idle(page);
  const errors = await page.$$eval("#messages li", items => items.map(item => item.textContent).filter(text => /^error:|^Cancelled/.test(text)));
  assert.deepEqual(errors, [], name);
  assert.match(await page.textContent("#text"), /usable/i, name);
  assert.match(await page.textContent("#took"), /^[\d.]+ s, version/, name);
  await page.frameLocator("#report").locator("figure").first().waitFor({ timeout: 20000 });
  const files = new Map();
  const offers = page.locator("#downloads button");
  for (let k = 0; k < await offers.count(); k++) {
    const file = await download(page, () => offers.nth(k).click());
    await idle(page);
    assert.ok(file.text.length > 20, `${name}: ${file.name} is empty`);
    files.set(file.name, file.text);
  }
  assert.ok(files.size > 1, name);
  return files;
}

// The page with a drive, each of its buttons pressed.
async function driven(page) {
  await page.waitForFunction(() => document.getElementById("toml").value.includes("[gnss]"), null, { timeout: 60000 });
  await idle(page);
  const files = new Map(), buttons = page.locator("#drive button");
  for (let k = 0; k < await buttons.count(); k++) files.set(await buttons.nth(k).evaluate(called), await result(page, buttons.nth(k)));
  assert.match(files.get("navigate").get("nav.kml"), /<kml/);
  // Smoothed, the same samples with smaller errors.
  const [forward, smoothed] = ["navigate", "smooth"].map(name => files.get(name).get("nav.csv").trimEnd().split("\n"));
  assert.ok(smoothed.length > 1000 && Math.abs(smoothed.length / forward.length - 1) < 0.01, `${forward.length}, ${smoothed.length}`);
  const std = lines => Number(lines[lines.length >> 1].split(",")[lines[0].split(",").indexOf("north_std_m")]);
  assert.ok(std(smoothed) < std(forward), `${std(smoothed)}, ${std(forward)}`);
  for (const length of ["10", "30", "60"]) assert.equal(JSON.parse(files.get(length).get("outages.json")).outages[0].length_s, Number(length));
  // What was tuned is in the form, for the next run.
  assert.equal(await page.inputValue("#toml"), files.get("tune").get("tuned.toml"));
  // Nothing is sent: no map offers a background.
  assert.equal(await page.frameLocator("#report").locator("input").count(), 0);
  // The rest before the drive is a static recording.
  await page.click("#tab-static");
  await page.fill("#span", "0,55");
  await result(page, page.locator("#static button"));
  await page.click("#tab-drive");
  assert.ok(await page.isVisible("#toml"));
  while (await page.locator("#files button").count()) {
    await page.locator("#files button").first().click();
    await idle(page);
  }
  assert.ok(await page.isHidden("#work"));
}

test("every button gives a result with the simulated drive", { skip: missing }, async () => {
  const { page, troubles, close } = await open();
  await page.click("#sample-drive");
  await driven(page);
  assert.deepEqual(troubles, []);
  await close();
});

test("an IMU and poses are navigated, cut and tuned, and the tuned noise is saved for Kalibr", { skip: missing }, async () => {
  const { page, troubles, close } = await open();
  await page.click("#sample-room");
  await page.waitForFunction(() => document.getElementById("toml").value.includes("[poses]"), null, { timeout: 60000 });
  await idle(page);
  assert.equal(await page.getAttribute("#tab-drive", "aria-selected"), "true");
  assert.match(await page.inputValue("#toml"), /^marker = /m);
  const files = new Map();
  for (const name of ["navigate", "smooth", "10", "tune"]) files.set(name, await result(page, page.locator(`#drive button[value="${name}"]`)));
  assert.ok(files.get("navigate").get("nav.csv").split("\n").length > 10000);
  assert.ok(Math.abs(JSON.parse(files.get("10").get("outages.json")).outages[0].length_s - 10) < 1e-9);
  assert.match(files.get("tune").get("tuned.toml"), /^\[poses\]/m);
  assert.match(files.get("tune").get("imu.yaml"), /gyroscope_noise_density/);
  assert.deepEqual(troubles, []);
  await close();
});

test("every button gives a result with another sensor and a drive file of one's own", { skip: missing || (existsSync(simulate) ? false : `${simulate} is missing`) }, async () => {
  const { page, troubles, close } = await open();
  const drive = path.join(scratch, "drive");
  execFileSync(simulate, [drive, "480", "100", "3"]);
  await page.setInputFiles("#choose", readdirSync(drive).map(name => path.join(drive, name)));
  await driven(page);
  assert.deepEqual(troubles, []);
  await close();
});

test("the demo runs at a click", { skip: missing }, async () => {
  const { page, troubles, close } = await open();
  await page.click("#demo");
  await page.waitForFunction(() => document.getElementById("downloads").children.length, null, { timeout: 600000 });
  assert.match(await page.textContent("#text"), /times less/);
  await page.frameLocator("#report").locator("figure").first().waitFor({ timeout: 20000 });
  assert.deepEqual(troubles, []);
  await close();
});

test("a run can be cancelled, and the next one works", { skip: missing }, async () => {
  const { page, close } = await open();
  await page.click("#sample-static");
  await page.waitForFunction(() => /Allan deviations alone/.test(document.getElementById("text").textContent), null, { timeout: 60000 });
  await page.click("#cancel");
  await idle(page);
  assert.match(await page.textContent("#messages"), /Cancelled/);
  assert.equal((await run(page, ["--version"])).code, 0);
  await close();
});

test("on a phone nothing is wider than the page, and the tabs answer to the keyboard", { skip: missing }, async () => {
  const { page, close } = await open({ viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true });
  await page.click("#sample-drive");
  await page.waitForFunction(() => document.getElementById("toml").value.includes("[gnss]"), null, { timeout: 60000 });
  await idle(page);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  await page.focus("#tab-drive");
  await page.keyboard.press("ArrowLeft");
  assert.equal(await page.getAttribute("#tab-static", "aria-selected"), "true");
  await close();
});

// Every log of the golden files, and public drives.
const golden = path.join(root, "testdata/golden");
const isLog = name => !/\.(py|json|toml|m|mat|yaml|params|kml|geojson|db3-wal|txt|md)$/.test(name);
const logs = readdirSync(golden, { recursive: true }).map(String).filter(name => isLog(name) && statSync(path.join(golden, name)).isFile());

test(`inspect says the same as the command of ${logs.length} logs`, { skip: missing }, async () => {
  const { page, close } = await open();
  for (const log of logs) {
    const name = path.basename(log);
    await put(page, [path.join(golden, log)]);
    const own = await run(page, ["inspect", name, "--json", "-"]);
    const theirs = spawnSync(native, ["inspect", name, "--json", "-"], { cwd: path.dirname(path.join(golden, log)), encoding: "utf8" });
    assert.equal(own.code, theirs.status, `${log}: ${own.warnings}${theirs.stderr}`);
    if (own.code === 0) same(JSON.parse(theirs.stdout), JSON.parse(own.output), 1e-9, log);
  }
  await close();
});

const DRIVES = [["rtk-drive", ["imu.csv.gz", "gnss.pos"]], ["uav-flight", null], ["navego-adis16405", null]];
for (const [drive] of DRIVES) {
  const example = path.join(root, `examples/${drive}.toml`);
  const name = `${drive}: navigated as by the command`, folder = path.join(publicData, drive);
  const skip = missing || (existsSync(folder) ? false : skipped(name, `DATA/${drive}`));
  test(name, { skip }, async () => {
    const { page, close } = await open();
    const text = readFileSync(example, "utf8"), names = Array.from(text.matchAll(/^file *= *"(.+)"/gm), found => found[1]);
    const toml = path.join(scratch, "drive.toml"), out = path.join(scratch, "native.json");
    writeFileSync(toml, text.replaceAll(/^file *= *"(.+\/)?(.+)"/gm, 'file = "$2"'));
    execFileSync(native, ["navigate", example, "--data", folder, "--model", "adis16405", "--json", out, "-q"]);
    await put(page, [toml, ...names.map(name => path.join(folder, name))]);
    const own = await run(page, ["navigate", "drive.toml", "--model", "adis16405", "--json", "own.json"], ["own.json"]);
    assert.equal(own.code, 0, own.warnings.join("\n"));
    const [a, b] = [JSON.parse(readFileSync(out, "utf8")), JSON.parse(own.files["own.json"])];
    for (const key of ["used", "rejected"]) assert.deepEqual(b.summary?.[key], a.summary?.[key]);
    same(a.summary, b.summary, 1e-4, drive);
    await close();
  });
}

// Runs `inspect` over pieces of a log; each has to be a result or a message.
async function survives(page, name, pieces, label) {
  const codes = await page.evaluate(async ({ pieces, name }) => {
    const codes = [];
    for (const text of pieces) {
      undrift.put(name, new File([Uint8Array.from(atob(text), c => c.charCodeAt(0))], name));
      const done = await undrift.run(["inspect", name]);
      codes.push([done.code, done.warnings.join(" ")]);
    }
    return codes;
  }, { pieces: pieces.map(piece => piece.toString("base64")), name });
  for (const [code, said] of codes) assert.ok(code === 0 || (code === 1 && said.includes("error:")), `${label}: ${code} ${said}`);
}

test("logs cut at every twentieth are a result or a message, never a dead page", { skip: missing }, async () => {
  const { page, troubles, close } = await open();
  for (const log of logs) {
    const whole = readFileSync(path.join(golden, log));
    const pieces = Array.from({ length: 19 }, (_, k) => whole.subarray(0, Math.floor(((k + 1) * whole.length) / 20)));
    await survives(page, path.basename(log), pieces, log);
  }
  assert.deepEqual(troubles, []);
  await close();
});

// What the fuzz targets start from, and what tools/fuzz has found since, where it has run.
const corpora = ["fuzz/corpus-seeds", "fuzz/corpus", "fuzz/artifacts"].map(name => path.join(root, name)).filter(existsSync);
const hostile = corpora.flatMap(folder => readdirSync(folder, { recursive: true }).map(name => path.join(folder, String(name)))).filter(name => statSync(name).isFile());

test("the corpora of the fuzz targets are a result or a message", { skip: missing || (hostile.length ? false : "no corpora") }, async () => {
  const { page, troubles, close } = await open();
  for (const name of hostile) await survives(page, path.basename(name), [readFileSync(name)], name);
  assert.deepEqual(troubles, []);
  await close();
});

test("every button of the page is pressed by a test", { skip: missing }, async () => {
  const { page, close } = await open();
  const buttons = await page.locator("button").all();
  const names = await Promise.all(buttons.map(button => button.evaluate(called)));
  assert.deepEqual(names.filter(name => !pressed.has(name)), []);
  await close();
});
