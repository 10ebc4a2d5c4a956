"""Runs every filter over every pass of every drive and judges the answers: the tables of docs/lab/drives.md. Use `benches/drives/run`."""

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "peers")]
from catalogue import DRIVES
from judge import judge, lines
from navigation import crate

PEERS = HERE.parent / "peers"
# Name, adapter, model, options.
FILTERS = [
    ("undrift, data sheet", "undrift_drive.py", "sheet", []),
    ("undrift, tuned", "undrift_drive.py", "tuned", []),
    ("undrift, by hand", "undrift_drive.py", "hand", []),
    ("undrift, tuned, smoothed", "undrift_drive.py", "tuned", ["smooth"]),
    ("fusion-nav, data sheet", "fusion_nav", "sheet", []),
    ("fusion-nav, allantools", "fusion_nav", "rest", []),
    ("fusion-nav, by hand", "fusion_nav", "hand", []),
    ("strapdown-core, data sheet", "strapdown_core", "sheet", []),
    ("strapdown-core, by hand", "strapdown_core", "hand", []),
    ("ekf2, its defaults", "ekf2", "default", []),
    ("ekf2, data sheet", "ekf2", "sheet", []),
    ("ekf2, allantools", "ekf2", "rest", []),
    ("ekf2, by hand", "ekf2", "hand", []),
    ("sidereon, data sheet", "sidereon_drive.py", "sheet", []),
    ("sidereon, biases held, by hand", "sidereon_drive.py", "hand", ["held"]),
    ("sidereon, biases held, car, by hand", "sidereon_drive.py", "hand", ["held", "car"]),
    ("sidereon, unscented, data sheet", "sidereon_drive.py", "sheet", ["ukf"]),
    ("python-ins, data sheet", "pyins_drive.py", "sheet", []),
    ("python-ins, by hand", "pyins_drive.py", "hand", []),
]
# CPU time of a sample [s], as measured, where it is above 100 us: one of the three passes, no row with allantools' noise, none of a drive
# whose pass would take longer than --limit, short drives first until a row has had its --budget.
SLOW = {"pyins_drive.py": 1.0e-3, "sidereon_drive.py": 2.1e-4}
SOURCES = {"fusion_nav": PEERS / "fusion_nav.rs", "strapdown_core": PEERS / "strapdown_core.rs", "ekf2": HERE / "ekf2.rs"}


def programs():
    """Programs of the crates, or why there is none."""
    beside = (str(HERE / "raw_logs.rs"),)
    yield "fusion_nav", crate("fusion-nav", "0.1.0", "fusion_nav.rs", beside=beside, under="drives-crates")
    yield "ekf2", crate("ekf2", "0.1.0", str(HERE / "ekf2.rs"), system="a C++ compiler and libclang", beside=(), under="drives-crates")
    yield "strapdown_core", crate(
        "strapdown-core", "0.5.0", "strapdown_core.rs", system="libhdf5 and libnetcdf", beside=beside, under="drives-crates",
        nalgebra=">=0.33.3, <0.35.0",
    )


def tune(undrift, folder):
    """Tunes on the logs of the first half from the data sheet; nothing where it refuses."""
    first = folder / "half"
    if (folder / "tuned.toml").exists() or (first / "tune.txt").exists():
        return
    done = subprocess.run(
        [undrift, "tune", first / "sheet.toml", "-o", first / "tuned.toml", "-q"], capture_output=True, text=True
    )
    (first / "tune.txt").write_text(done.stderr)
    if (first / "tuned.toml").exists():
        (folder / "tuned.toml").write_text((first / "tuned.toml").read_text())


def run(options):
    folder, answers = Path(options.exchange), Path(options.exchange) / "answers"
    answers.mkdir(exist_ok=True)
    built = dict(programs())
    for name, (program, fault) in built.items():
        print(f"{name}: {fault or 'built'}", flush=True)
    drives = options.drives or [name for name in DRIVES if (folder / name / "drive.json").exists()]
    undrift = str(Path(options.undrift).resolve())
    known = {name: json.loads((folder / name / "drive.json").read_text()) for name in drives}
    tasks = []
    for title, adapter, model, extra in FILTERS:
        if options.only and not any(word in title for word in options.only):
            continue
        for name in drives:
            for number in range(1 if adapter in SLOW else known[name]["passes"]):
                out = answers / f"{title.replace(', ', '_').replace(' ', '-')}.{name}.{number}"
                if options.again or not out.with_suffix(out.suffix + ".json").exists():
                    tasks.append((title, adapter, model, extra, name, number, out))

    spent = dict.fromkeys((title for title, _, _, _ in FILTERS), 0.0)

    def why_not(title, adapter, model, name):
        """Why a filter does not take a drive, if so."""
        about = known[name]
        if adapter in built and built[adapter][1]:
            return built[adapter][1]
        if adapter == "ekf2" and not about["velocity"]:
            return "takes no fix without a velocity"
        if adapter not in ("undrift_drive.py", "ekf2") and about["no_start"]:
            return f"no start: {about['no_start']}"
        takes = SLOW.get(adapter, 0.0) * about["samples"]
        if takes > options.limit:
            return f"not started: about {takes:.0f} s of CPU a pass, the limit is {options.limit} s"
        if adapter in SLOW and spent[title] > options.budget:
            return f"not started: the row has had its {options.budget} s of CPU"
        if model == "tuned":
            if name in tuning:
                tuning[name].result()
            said = folder / name / "half/tune.txt"
            if not (folder / name / "tuned.toml").exists():
                return "not tuned: " + (said.read_text()[:120] if said.exists() else "not run")
        return None

    def one(task):
        title, adapter, model, extra, name, number, out = task
        before = time.monotonic()
        out.unlink(missing_ok=True)
        fault = why_not(title, adapter, model, name)
        if fault:
            found = {"fault": fault}
        else:
            command = [built[adapter][0]] if adapter in built else [sys.executable, str(HERE / adapter)]
            command += [str(folder / name), str(number), model, str(out)]
            command += [undrift] if adapter == "undrift_drive.py" else []
            timed = ["/usr/bin/env", "bash", "-c", 'TIMEFORMAT="%U %S"; time "$@" 2>"$0"', str(out) + ".err", *command, *extra]
            child = subprocess.run(timed, capture_output=True, text=True, preexec_fn=lambda: resource.setrlimit(
                resource.RLIMIT_CPU, (options.limit, options.limit + 1)), env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})
            errors = Path(str(out) + ".err")
            said = [line for line in (errors.read_text() if errors.exists() else "").splitlines() if line.strip()]
            errors.unlink(missing_ok=True)
            if child.returncode in (137, 152):
                found, spent[title] = {"fault": f"stopped after {options.limit} s of CPU"}, spent[title] + options.limit
            elif child.returncode or not out.exists():
                found = {"fault": (said[-1] if said else f"exit {child.returncode}")[:160]}
            else:
                found = {"cpu_s": sum(map(float, child.stderr.strip().splitlines()[-1].split()))}
                spent[title] += found["cpu_s"]
        out.with_suffix(out.suffix + ".json").write_text(json.dumps({"filter": title, "drive": name, "pass": number, **found}))
        print(f"{title}; {name} {number}: {found.get('fault') or '%.1f s' % found['cpu_s']} ({time.monotonic() - before:.0f} s)", flush=True)

    # Tuning before all, for rows depend on it; what is slow next, so that no core waits for the other at the end.
    tasks.sort(key=lambda task: (task[1] not in SLOW, known[task[4]]["samples"]))
    with ThreadPoolExecutor(options.jobs) as pool:
        longest = sorted(drives if any(task[2] == "tuned" for task in tasks) else [], key=lambda name: known[name]["samples"], reverse=True)
        tuning = {name: pool.submit(tune, undrift, folder / name) for name in longest}
        list(pool.map(one, tasks))
    counts = {adapter: lines(SOURCES.get(adapter, HERE / adapter)) for _, adapter, _, _ in FILTERS}
    version = subprocess.run([undrift, "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
    titles = [(title, counts[adapter], adapter) for title, adapter, _, _ in FILTERS]
    judge(folder, answers, drives, titles, version, Path(options.results), options.figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("exchange", help="folder that exchange.py wrote")
    parser.add_argument("--undrift", required=True, help="the built command")
    parser.add_argument("--drives", nargs="+", help="only these drives")
    parser.add_argument("--only", nargs="+", help="only filters whose name contains one of these words")
    parser.add_argument("--again", action="store_true", help="run what has answers, too")
    parser.add_argument("--limit", type=int, default=240, help="CPU time of one pass [s]")
    parser.add_argument("--budget", type=int, default=900, help="CPU time of a row of a slow filter [s]")
    parser.add_argument("--jobs", type=int, default=2, help="processes side by side")
    parser.add_argument("--results", default="target/drives", help="folder for a result of each drive, as `undrift report` reads it")
    parser.add_argument("--figure", help="SVG of the pooled drift")
    run(parser.parse_args())


if __name__ == "__main__":
    main()
