"""How a fleet of many small logs goes on worker processes of Dask: time, requests a second, memory of this process, which
holds client and scheduler. The installed package is measured; with --command also the command, and whether the
bytes are the same.

    python tools/fleet-many.py FOLDER [--logs 500 2000] [--workers 1 2] [--trivial 20000] [--command target/release/undrift]

The logs are twenty simulated drives of 2 min at 50 Hz under as many names as are asked for, with two bias models and
four outages each; trivial ones are logs that are not there.
"""

import argparse
import filecmp
import json
import shutil
import subprocess
import sys
import time
from pathlib import Path

DRIVES = 20
MANIFEST = """bias_models = ["white", "arma"]
outages = { length = "10 s", every = "15 s", start = "60 s" }
[[log]]
table = "TABLE"
drive = "drive.toml"
"""


def memory(what: str) -> float:
    """VmRSS or VmHWM of this process [MB]."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith(what)) / 1024


def manifest(folder: Path, logs: int, *, trivial: bool) -> Path:
    """The manifest of so many logs."""
    import undrift

    for k in range(DRIVES):
        if not (folder / f"{k:02}/drive.toml").exists():
            undrift.simulate("car", duration=120, rate=50, seed=k).save(folder / f"{k:02}")
    shutil.copy(folder / "00/drive.toml", folder)
    shutil.copy(folder / "00/imu.toml", folder)
    name = f"{'trivial' if trivial else 'logs'}-{logs}"
    rows = (
        f"{'none' if trivial else f'{k % DRIVES:02}'},log {k:06},SN{k % 37:04}" for k in range(logs)
    )
    (folder / f"{name}.csv").write_text("data,name,unit\n" + "\n".join(rows) + "\n")
    path = folder / f"{name}.toml"
    path.write_text(MANIFEST.replace("TABLE", f"{name}.csv"))
    return path


def measure(path: str, output: str, workers: int) -> dict[str, float]:
    """One run, in this process."""
    from distributed import Client, LocalCluster

    from undrift import fleet

    with (
        LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address=None,
        ) as cluster,
        Client(cluster) as client,
    ):
        client.wait_for_workers(workers)
        start, before = time.perf_counter(), memory("VmRSS")
        found: dict[str, float] = {}

        def progress(done: int, all_: int) -> None:
            found.setdefault("first", time.perf_counter() - start)
            if done == all_:
                found["processed"] = time.perf_counter() - start
                found["grown"] = memory("VmHWM") - before

        result = fleet.run(client, path, output, progress=progress)
        found["wall"] = time.perf_counter() - start
        assert not result.lost and result.processed, result
    return found


def in_child(path: Path, output: Path, workers: int) -> dict[str, float]:
    shutil.rmtree(output, ignore_errors=True)
    command = [sys.executable, __file__, "--one", str(path), str(output), str(workers)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    found: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return found


def same(a: Path, b: Path) -> bool:
    names = [path.relative_to(a) for path in a.rglob("*") if path.is_file()]
    return filecmp.cmpfiles(a, b, names, shallow=False)[1:] == ([], [])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--logs", type=int, nargs="*", default=[500, 2000])
    parser.add_argument("--workers", type=int, nargs="*", default=[1, 2])
    parser.add_argument("--trivial", type=int, default=0)
    parser.add_argument("--command")
    given = parser.parse_args()
    folder = given.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    print("| logs | workers | to the first task [s] | all processed [s] | with table and report [s] | memory grown by [MB] |")
    print("|---|---|---|---|---|---|", flush=True)

    def row(name: str, workers: int, found: dict[str, float]) -> None:
        numbers = (found["first"], found["processed"], found["wall"], found["grown"])
        print(f"| {name} | {workers} |", " | ".join(f"{n:.1f}" for n in numbers), "|", flush=True)

    for logs in given.logs:
        path = manifest(folder, logs, trivial=False)
        alone = folder / "out-command"
        if given.command:
            shutil.rmtree(alone, ignore_errors=True)
            start = time.perf_counter()
            run = [given.command, "fleet", path, "-o", alone, "--threads", "1", "--quiet"]
            subprocess.run(run, check=True)
            print(f"| {logs} | command, 1 thread | | | {time.perf_counter() - start:.1f} | |")
        for workers in given.workers:
            out = folder / "out-dask"
            row(str(logs), workers, in_child(path, out, workers))
            if given.command and not same(alone, out):
                sys.exit("the bytes are not those of the command")
    if given.trivial:
        path = manifest(folder, given.trivial, trivial=True)
        workers = max(given.workers)
        row(f"{given.trivial} trivial", workers, in_child(path, folder / "out-dask", workers))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        print(json.dumps(measure(sys.argv[2], sys.argv[3], int(sys.argv[4]))))
    else:
        main()
