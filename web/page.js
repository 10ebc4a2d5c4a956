// The page: what was dropped goes to the worker that runs the command, what it says comes back.
const $ = id => document.getElementById(id);

// ---- The worker ------------------------------------------------------------------------------------------------

let worker, module, running, runs = 0;
const files = new Map();

async function compiled() {
  const packed = Uint8Array.from(atob($("wasm").textContent), c => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(stream).arrayBuffer());
}

// A worker with all files.
async function start() {
  module ??= compiled();
  const url = URL.createObjectURL(new Blob([WORKER], { type: "text/javascript" }));
  worker = new Worker(url);
  worker.onmessage = ({ data }) => running?.run === data.run && running.heard(data);
  worker.onerror = event => running?.heard({ code: -1, problem: event.message, files: {}, output: "" });
  worker.postMessage({ module: await module, put: Object.fromEntries(files) });
  URL.revokeObjectURL(url);
}
let ready = start();

// Runs the command; `results` are files that it writes. Resolves to its exit code, output, warnings and files.
async function undrift(args, results = []) {
  await ready;
  const run = ++runs, warnings = [];
  return new Promise(done => {
    running = {
      run,
      cancelled: () => done({ code: null, warnings, output: "", files: {} }),
      heard(said) {
        if (said.progress !== undefined) $("progress").textContent = said.progress;
        else if (said.warning !== undefined) warnings.push(said.warning);
        else {
          running = undefined;
          // The program's other output on a panic is no use here.
          if (said.problem) warnings.push(`error: the program stopped (${said.problem}). Please report it, with the log if you can share it.`);
          done({ ...said, warnings });
        }
      },
    };
    worker.postMessage({ run, args: ["--color", "never", ...args], results });
  });
}

function put(path, blob) {
  files.set(path, blob);
  worker.postMessage({ put: { [path]: blob } });
}

$("cancel").onclick = () => {
  if (!running) return;
  const { cancelled } = running;
  running = undefined;
  worker.terminate();
  ready = start();
  cancelled();
};

// ---- Messages and results --------------------------------------------------------------------------------------

// Options of the command, as the fields of the form are called.
const FIELDS = { rate: "Rate", time: "Column of times", columns: "Columns", units: "Unit of the gyros” and “Unit of the accelerometers", span: "Part used", base: "Data sheet" };
const inFields = text => text.replace(/, or identify\.\w+ in a manifest/g, "").replace(/--([a-z]+)\b/g, (option, name) => FIELDS[name] ? `“${FIELDS[name]}”` : option);

// Warnings and errors, and apart from them what is only said.
function list(said) {
  const lines = said.map(inFields);
  const serious = text => /^(warning|error):|^Cancelled/.test(text);
  const items = lines.filter(serious).map(text => Object.assign(document.createElement("li"), { textContent: text }));
  $("messages").replaceChildren(...items);
  $("messages").hidden = !items.length;
  $("notes").textContent = lines.filter(text => !serious(text)).join("\n");
}

function show(text) {
  $("text").textContent = text;
  $("text").hidden = !text;
}

async function showReport(blob) {
  $("report").hidden = !blob;
  if (blob) $("report").srcdoc = await blob.text();
}

function save(name, blob) {
  const url = URL.createObjectURL(blob), link = Object.assign(document.createElement("a"), { href: url, download: name.split("/").pop() });
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 60000);
}

// A button for a file that is there, or is made when it is asked for.
function offer(label, get) {
  const button = Object.assign(document.createElement("button"), { className: "link", textContent: label, type: "button" });
  button.onclick = () => working(async () => {
    const [name, blob] = await get();
    if (blob) save(name, blob);
  });
  $("downloads").append(button);
  $("downloads").hidden = false;
}

const buttons = () => document.querySelectorAll(".do, #sample-static, #sample-drive, #sample-room, #demo, #downloads button");

// Runs something while nothing else can be begun.
async function working(task) {
  if (running) return;
  $("run").hidden = false;
  $("busy").hidden = $("cancel").hidden = false;
  $("progress").textContent = "";
  buttons().forEach(button => { button.disabled = true; });
  try {
    await task();
  } finally {
    $("busy").hidden = $("cancel").hidden = true;
    $("progress").textContent = "";
    buttons().forEach(button => { button.disabled = false; });
  }
}

function clear() {
  list([]);
  show("");
  $("downloads").replaceChildren();
  $("downloads").hidden = true;
  $("took").textContent = "";
  $("report").hidden = true;
}

// A run whose result is shown; whether there is one.
async function shown(args, results, report) {
  const done = await undrift(args, results);
  list(done.code === null ? ["Cancelled."] : done.warnings);
  if (done.code === null) return null;
  show(done.output);
  await showReport(done.files[report]);
  $("took").textContent = done.code === 0 ? `${done.seconds.toFixed(1)} s, version ${VERSION}` : "";
  if (done.code !== 0 && !done.warnings.length) list(["error: the program ended without a result"]);
  return done.code === 0 ? done : null;
}

// ---- Files -----------------------------------------------------------------------------------------------------

// Names as the command takes them.
const plain = name => name.normalize("NFKD").replace(/[^ -~]/g, "_").replace(/[/\\"]/g, "_");
const size = bytes => bytes >= 1e6 ? `${(bytes / 1e6).toFixed(1)} MB` : `${Math.ceil(bytes / 1e3)} kB`;
const logs = () => Array.from(files.keys()).filter(name => !name.endsWith(".toml"));

function listFiles() {
  $("files").replaceChildren(...Array.from(files, ([name, blob]) => {
    const item = document.createElement("li"), remove = document.createElement("button");
    Object.assign(remove, { className: "link", textContent: "remove", type: "button" });
    remove.setAttribute("aria-label", `remove ${name}`);
    remove.onclick = () => {
      if (running) return;
      files.delete(name);
      worker.postMessage({ remove: name });
      opened();
    };
    item.append(name, Object.assign(document.createElement("small"), { textContent: size(blob.size) }), remove);
    return item;
  }));
}

async function add(dropped) {
  if (running || !dropped.length) return;
  await ready;
  for (const file of dropped) put(plain(file.name), file);
  await opened();
}

let inspected = [];
const value = text => { try { return JSON.parse(text); } catch { return text; } };

// What the files are, and the forms filled from it.
async function opened() {
  listFiles();
  clear();
  $("work").hidden = $("found").hidden = !files.size;
  if (!files.size) return;
  const given = Array.from(files.keys()).filter(name => name.endsWith(".toml"));
  await working(async () => {
    const names = logs();
    if (names.length) {
      const vehicle = $("vehicle").value ? ["--vehicle", $("vehicle").value] : [];
      const done = await undrift(["inspect", ...names, ...vehicle, "--json", "inspect.json", "-o", "starter.toml"], ["inspect.json", "starter.toml"]);
      list(done.warnings);
      inspected = done.files["inspect.json"] ? JSON.parse(await done.files["inspect.json"].text()) : [];
      const text = await undrift(["inspect", ...names]);
      $("inspected").textContent = text.output;
      $("found").hidden = !text.output;
      const starter = given.length ? files.get(given[0]) : done.files["starter.toml"];
      $("toml").value = starter ? await starter.text() : "";
    }
  });
  const tables = inspected.flatMap(file => file.parts.map(part => part.table));
  fillStatic();
  const moving = given.length || tables.includes("gnss") || tables.includes("poses");
  tab(moving ? "drive" : "static");
  if (!moving && tables.includes("imu")) await identify();
}

$("choose").onchange = ({ target }) => { add(target.files).finally(() => { target.value = ""; }); };
const drop = $("drop");
for (const name of ["dragover", "dragenter"]) addEventListener(name, event => { event.preventDefault(); drop.classList.add("over"); });
for (const name of ["dragleave", "drop"]) addEventListener(name, event => { event.preventDefault(); drop.classList.remove("over"); });
addEventListener("drop", event => add(event.dataTransfer?.files ?? []));

async function sample(names) {
  await working(async () => {
    const written = names.map(name => `sample/${name}`);
    const { files: made, warnings } = await undrift(["sample", "sample"], written);
    list(warnings);
    for (const name of files.keys()) worker.postMessage({ remove: name });
    files.clear();
    for (const path of written) if (made[path]) put(path.split("/").pop(), made[path]);
  });
  await opened();
}
$("sample-static").onclick = () => sample(["static.csv"]);
$("sample-drive").onclick = () => sample(["drive/imu.csv", "drive/gnss.csv"]);
$("sample-room").onclick = () => sample(["room/imu.csv", "room/poses.txt"]);

// Fewer drives than the command's, for patience.
$("demo").onclick = () => working(async () => {
  clear();
  const done = await shown(["demo", "--drives", "2", "--report", "demo.html"], ["demo.html"], "demo.html");
  if (done) offer("Report (HTML)", () => ["demo.html", done.files["demo.html"]]);
});

// ---- Tabs ------------------------------------------------------------------------------------------------------

const KINDS = ["static", "drive"];
function tab(kind, focus = false) {
  for (const name of KINDS) {
    const chosen = name === kind;
    $(name).hidden = !chosen;
    $(`tab-${name}`).setAttribute("aria-selected", String(chosen));
    $(`tab-${name}`).tabIndex = chosen ? 0 : -1;
  }
  if (focus) $(`tab-${kind}`).focus();
}
for (const kind of KINDS) {
  $(`tab-${kind}`).onclick = () => tab(kind);
  $(`tab-${kind}`).onkeydown = event => {
    if (["ArrowLeft", "ArrowRight"].includes(event.key)) tab(KINDS.find(other => other !== kind), true);
  };
}

// ---- A static recording ----------------------------------------------------------------------------------------

const option = (text, chosen) => new Option(text, text, false, chosen);

function fillStatic() {
  const records = inspected.filter(file => file.parts.some(part => part.table === "imu")).map(file => file.file);
  $("record").replaceChildren(...(records.length ? records : logs()).map((name, at) => option(name, at === 0)));
  fillColumns();
}

function fillColumns() {
  const part = inspected.find(file => file.file === $("record").value)?.parts.find(one => one.table === "imu");
  const line = key => value(part?.lines.find(one => one.key === key)?.value ?? '""');
  const names = [line("gyro"), line("accel")].flat().filter(name => name !== "");
  $("columns").value = names.length === 6 && names.every(name => !String(name).includes(",")) ? names.join(",") : "";
  $("gyro-unit").value = line("gyro_unit");
  $("accel-unit").value = line("accel_unit");
  const unit = line("time_unit");
  $("time").value = line("time") && !String(line("time")).includes(",") ? [line("time"), ...(unit ? [unit] : [])].join(",") : "";
  // A guess would pass for what is known.
  const guessed = part?.lines.find(one => one.key === "rate")?.known === "no_times";
  $("rate").value = line("time") || guessed ? "" : String(line("rate")).replace(/ ?Hz$/, "");
  preview();
}
$("record").onchange = fillColumns;

function asked() {
  const is = id => $(id).value.trim();
  const units = is("gyro-unit") && is("accel-unit") ? ["--units", `${is("gyro-unit")},${is("accel-unit")}`] : [];
  return [
    $("record").value,
    ...(is("rate") ? ["--rate", is("rate")] : []),
    ...(is("time") && !is("rate") ? ["--time", is("time")] : []),
    ...(is("columns") ? ["--columns", is("columns")] : []),
    ...units,
    ...(is("span") ? ["--span", is("span")] : []),
  ];
}

const FACTORS = { "deg/s": Math.PI / 180, "rad/s": 1, "mdeg/s": Math.PI / 180e3, "deg/h": Math.PI / 648e3, "m/s^2": 1, "m/s2": 1, g: 9.80665, mg: 9.80665e-3 };

function factor(unit) {
  const [, per, of] = /^LSB\/([\d.]+) (.+)$/.exec(unit) ?? [];
  return per ? FACTORS[of] / Number(per) : FACTORS[unit];
}

// The first rows of a text table, and their magnitudes under the units of the form.
async function preview() {
  const blob = files.get($("record").value), wanted = $("columns").value.split(",").map(name => name.trim());
  $("preview").hidden = true;
  if (!blob || wanted.length !== 6) return;
  let head = blob.slice(0, 65536);
  const magic = new Uint8Array(await head.slice(0, 2).arrayBuffer());
  if (magic[0] === 0x1f && magic[1] === 0x8b) {
    // Only as much as the first slice holds.
    const reader = head.stream().pipeThrough(new DecompressionStream("gzip")).getReader();
    const parts = [];
    try { for (let part; parts.length < 4 && !(part = await reader.read()).done;) parts.push(part.value); } catch { /* cut */ }
    head = new Blob(parts);
  }
  const lines = (await head.text()).split(/\r?\n/).slice(0, -1).filter(line => line && !line.startsWith("#"));
  const separator = [",", ";", "\t", " "].find(one => lines[0]?.includes(one));
  const cells = line => line.trim().split(separator === " " ? / +/ : separator).map(cell => cell.trim());
  const names = cells(lines[0] ?? ""), at = wanted.map(name => /^\d+$/.test(name) ? Number(name) - 1 : names.indexOf(name));
  const rows = lines.filter(line => at.every(i => i >= 0 && Number.isFinite(parseFloat(cells(line)[i])))).slice(0, 4);
  const [gyro, accel] = [factor($("gyro-unit").value), factor($("accel-unit").value)];
  if (!rows.length || !gyro || !accel) return;
  const cell = (tag, text) => Object.assign(document.createElement(tag), { textContent: text, className: "number" });
  const row = (tag, texts) => { const made = document.createElement("tr"); made.append(...texts.map(text => cell(tag, text))); return made; };
  const magnitude = (numbers, by) => Math.hypot(...numbers.map(x => x * by));
  const table = rows.map(line => {
    const own = at.map(i => cells(line)[i]), numbers = own.map(Number);
    return row("td", [...own, (magnitude(numbers.slice(0, 3), gyro) * 180 / Math.PI).toPrecision(4), magnitude(numbers.slice(3), accel).toPrecision(4)]);
  });
  $("preview").querySelector("table").replaceChildren(row("th", [...wanted, "rate [°/s]", "force [m/s²]"]), ...table);
  $("preview").hidden = false;
}
for (const id of ["columns", "gyro-unit", "accel-unit"]) $(id).oninput = preview;

const FORMATS = [["Kalibr", "kalibr", "imu.yaml"], ["PX4", "px4", "imu.params"], ["ROS", "ros", "imu-ros.yaml"], ["KF-GINS", "kf-gins", "kf-gins.yaml"], ["MATLAB", "matlab", "imu.m"],
  ["VINS", "vins", "vins.yaml"], ["OpenVINS", "openvins", "kalibr_imu_chain.yaml"], ["Basalt", "basalt", "basalt.json"],
  ["GTSAM", "gtsam", "imu_gtsam.py"], ["ArduPilot", "ardupilot", "imu.param"], ["Gazebo", "gazebo", "imu.sdf"]];

// The model of a file for other programs.
function offerFormats(model) {
  for (const [label, name, file] of FORMATS) {
    offer(label, async () => {
      const done = await undrift(["model", model, "--to", name, "-o", file], [file]);
      list(done.warnings);
      return [file, done.files[file]];
    });
  }
}

async function identify() {
  const form = asked();
  await working(async () => {
    clear();
    const quick = await shown(["identify", ...form, "--allan", "--report", "allan.html"], ["allan.html"], "allan.html");
    if (!quick) return;
    show(`${quick.output}\n\nTests and models follow.`);
    const base = $("base").value ? ["--base", $("base").value] : [];
    const found = await shown(["identify", ...form, ...base, "-o", "imu.toml", "--report", "identify.html", "--json", "identify.json"], ["imu.toml", "identify.html", "identify.json"], "identify.html");
    if (!found) return;
    const model = found.files["imu.toml"];
    offer("Report (HTML)", () => ["identify.html", found.files["identify.html"]]);
    offer("imu.toml", () => ["imu.toml", model]);
    offer("JSON", () => ["identify.json", found.files["identify.json"]]);
    offerFormats("imu.toml");
  });
}
$("static").onsubmit = event => { event.preventDefault(); identify(); };

// ---- A drive ---------------------------------------------------------------------------------------------------

$("vehicle").onchange = () => opened();

const SOLUTIONS = ["nav.csv", "nav.kml", "nav.gpx", "nav.geojson"];

async function navigate(smooth) {
  const more = smooth ? ["--smooth"] : [];
  const results = ["navigate.html", "navigate.json", ...SOLUTIONS];
  const out = SOLUTIONS.flatMap(name => ["-o", name]);
  const done = await shown(["navigate", "drive.toml", ...more, ...out, "--report", "navigate.html", "--json", "navigate.json"], results, "navigate.html");
  if (!done) return;
  offer("Report (HTML)", () => ["navigate.html", done.files["navigate.html"]]);
  for (const name of SOLUTIONS) offer(name, () => [name, done.files[name]]);
  offer("JSON", () => ["navigate.json", done.files["navigate.json"]]);
}

async function cut(length) {
  const done = await shown(["outages", "drive.toml", "--length", length, "--report", "outages.html", "--json", "outages.json"], ["outages.html", "outages.json"], "outages.html");
  if (!done) return;
  offer("Report (HTML)", () => ["outages.html", done.files["outages.html"]]);
  offer("JSON", () => ["outages.json", done.files["outages.json"]]);
}

async function tune() {
  const done = await shown(["tune", "drive.toml", "-o", "tuned.toml", "--report", "tune.html"], ["tuned.toml", "tune.html"], "tune.html");
  if (!done) return;
  const tuned = done.files["tuned.toml"];
  offer("Report (HTML)", () => ["tune.html", done.files["tune.html"]]);
  offer("tuned.toml", () => ["tuned.toml", tuned]);
  offerFormats("tuned.toml");
  if (tuned) $("toml").value = await tuned.text();
}

$("drive").onsubmit = event => {
  event.preventDefault();
  const what = event.submitter?.value ?? "navigate";
  working(async () => {
    clear();
    const toml = new Blob([$("toml").value]);
    worker.postMessage({ put: { "drive.toml": toml } });
    if (what === "tune") await tune();
    else if (/^\d+$/.test(what)) await cut(what);
    else await navigate(what === "smooth");
    offer("drive.toml", () => ["drive.toml", toml]);
  });
};

// ---- What the command knows ------------------------------------------------------------------------------------

for (const name of VEHICLES) $("vehicle").append(option(name));
for (const name of PRESETS) $("base").append(option(name));
window.undrift = { run: undrift, put, busy: () => Boolean(running) };
