// Runs the command, compiled to WebAssembly, in the folder of the files that were dropped: one run after the other, each in
// an instance of its own, so that one that failed leaves nothing behind.
import { ConsoleStdout, WASI } from "@bjorn3/browser_wasi_shim";
import { Dropped, Written, found, put, workingFolder } from "./files.js";

const folder = workingFolder();
let module;

const progress = (run, name) => (at, size) => postMessage({ run, progress: `${name}: ${Math.round((100 * at) / size)} % of ${(size / 1e6).toFixed(1)} MB` });

// Lines that begin with a carriage return are progress.
const stderr = run => line => postMessage(line.startsWith("\r") ? { run, progress: line.slice(1) } : { run, warning: line });

class NoInput extends ConsoleStdout {
  fd_read() { return { ret: 0, data: new Uint8Array(0) }; }
}

function execute({ run, args, results }) {
  const output = [];
  // What an earlier run has written under these names is not this one's.
  for (const name of results) folder.dir.contents.delete(name);
  const fds = [
    new NoInput(() => {}),
    ConsoleStdout.lineBuffered(line => output.push(line)),
    ConsoleStdout.lineBuffered(stderr(run)),
    folder,
  ];
  for (const entry of folder.dir.contents.values()) if (entry instanceof Dropped) entry.progress = progress(run, entry.blob.name ?? "reading");
  const wasi = new WASI(["undrift", ...args], ["NO_COLOR=1"], fds, { debug: false });
  wasi.wasiImport.sched_yield = () => 0;
  const begun = performance.now();
  let code, problem;
  try {
    code = wasi.start(new WebAssembly.Instance(module, { wasi_snapshot_preview1: wasi.wasiImport }));
  } catch (error) {
    code = -1;
    problem = String(error);
  }
  const files = {};
  for (const name of results) {
    const file = found(folder, name);
    if (file instanceof Written) files[name] = new Blob([file.bytes]);
  }
  postMessage({ run, code, problem, output: output.join("\n"), files, seconds: (performance.now() - begun) / 1e3 });
}

onmessage = ({ data }) => {
  if (data.module) module = data.module;
  if (data.put) for (const [path, blob] of Object.entries(data.put)) put(folder, path, new Dropped(blob));
  if (data.remove) folder.dir.contents.delete(data.remove);
  if (data.args) execute(data);
};
