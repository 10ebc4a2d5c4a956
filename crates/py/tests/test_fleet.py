"""Many logs on workers of Dask: whoever dies, the results are those of the command, to the byte."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undrift
from undrift import fleet

LOGS = 12
BROKEN = 5

DRIVE = """model = "adis16405"
[imu]
file = "imu.csv"
time = "t_s"
gyro = ["gx", "gy", "gz"]
gyro_unit = "rad/s"
accel = ["fx", "fy", "fz"]
accel_unit = "m/s^2"
[gnss]
file = "gnss.csv"
time = "t_s"
position = ["lat_deg", "lon_deg", "height_m"]
position_std = "0.05 m"
velocity = ["vn", "ve", "vd"]
velocity_std = "0.05 m/s"
"""

MANIFEST = """unit = "{parent}"
bias_models = ["white", "arma"]
outages = { length = "5 s", every = "15 s", start = "50 s" }
[[log]]
drive = "SN*/*/drive.toml"
"""


def write_drive(folder: Path, seed: int) -> None:
    """At rest for 30 s, then northward at 1 m/s² up to 10 m/s, on a plane that does not turn."""
    rng = np.random.default_rng(seed)
    rate, duration = 50, 120.0
    t = np.arange(1, int(rate * duration) + 1) / rate
    push = np.where((t > 30) & (t <= 40), 1.0, 0.0)
    speed = np.clip(t - 30, 0, 10)
    way = np.where(t < 40, speed**2 / 2, 50 + 10 * (t - 40))
    zero = np.zeros_like(t)
    imu = np.column_stack([zero, zero, zero, push, zero, zero - 9.8])
    imu += rng.normal(0, [0.001] * 3 + [0.02] * 3, imu.shape)
    temperature = zero + 20 + seed
    folder.mkdir(parents=True)
    np.savetxt(
        folder / "imu.csv",
        np.column_stack([t, imu, temperature]),
        "%.9g",
        ",",
        header="t_s,gx,gy,gz,fx,fy,fz,temp_C",
        comments="",
    )
    k = np.arange(rate - 1, t.size, rate)
    fix = np.column_stack(
        [t, 45 + np.degrees(way / 6.367e6), zero + 8, zero + 100, speed, zero, zero]
    )[k]
    fix[:, 4:] += rng.normal(0, 0.03, (k.size, 3))
    header = "t_s,lat_deg,lon_deg,height_m,vn,ve,vd"
    np.savetxt(folder / "gnss.csv", fix, "%.12g", ",", header=header, comments="")
    (folder / "drive.toml").write_text(DRIVE)


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Twelve drives of four units, one without its fixes."""
    folder = tmp_path_factory.mktemp("fleet")
    for k in range(LOGS):
        write_drive(folder / f"SN{k // 3}" / f"{k:02}", k)
    (folder / f"SN{BROKEN // 3}" / f"{BROKEN:02}" / "gnss.csv").unlink()
    (folder / "fleet.toml").write_text(MANIFEST)
    return folder


@pytest.fixture(scope="module")
def expected(
    logs: Path,
    tmp_path_factory: pytest.TempPathFactory,
    terminal: Callable[..., subprocess.CompletedProcess[str]],
) -> dict[str, bytes]:
    """The files that the command makes on one machine."""
    out = tmp_path_factory.mktemp("alone")
    done = terminal("fleet", logs / "fleet.toml", "-o", out)
    assert done.returncode == 0, done.stderr
    assert f"{LOGS} logs processed, 0 up to date" in done.stdout
    return files(out)


def files(folder: Path) -> dict[str, bytes]:
    found = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in found}


@pytest.fixture
def cluster() -> Iterator[tuple[Any, list[subprocess.Popen[bytes]]]]:
    """A scheduler and two workers, processes of their own without a nanny, on loopback."""
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(
            n_workers=0, host="127.0.0.1", dashboard_address=None
        ) as scheduler,
        distributed.Client(scheduler) as client,
    ):
        address = scheduler.scheduler_address
        worker = [sys.executable, "-m", "distributed.cli.dask_worker", address]
        options = ["--no-nanny", "--nthreads", "1", "--no-dashboard", "--host", "127.0.0.1"]
        workers = [subprocess.Popen([*worker, *options]) for _ in range(2)]
        try:
            client.wait_for_workers(2, timeout=120)
            yield client, workers
        finally:
            for process in workers:
                process.kill()
                process.wait()


def test_a_killed_worker_does_not_show(
    logs: Path, tmp_path: Path, expected: dict[str, bytes], cluster: Any
) -> None:
    client, workers = cluster
    told: list[tuple[int, int]] = []

    def progress(done: int, all_: int) -> None:
        told.append((done, all_))
        if done == LOGS // 2:
            # In the midst of a log, most likely: there is one for each thread always.
            os.kill(workers[0].pid, signal.SIGKILL)

    result = fleet.run(client, logs / "fleet.toml", tmp_path, progress=progress)
    assert workers[0].wait(timeout=60) == -signal.SIGKILL
    assert len(client.scheduler_info()["workers"]) == 1
    # Every log done once, the same as on one machine.
    # One that was done, but not reported yet when its worker died, is found done.
    assert result.processed + result.skipped == LOGS and result.skipped <= 1
    assert (result.failed, result.lost, result.damaged) == (1, {}, ())
    assert told == [(n, LOGS) for n in range(LOGS + 1)]
    assert files(tmp_path) == expected
    table = pytest.importorskip("pyarrow.parquet").read_table(tmp_path / "results.parquet")
    assert len(set(table["log"].to_pylist())) == LOGS
    assert result.to_arrow().equals(table)

    # What is there is not done again; what changed is.
    again = fleet.run(client, logs / "fleet.toml", tmp_path, progress=False)
    assert (again.processed, again.skipped) == (0, LOGS)
    failed = fleet.run(client, logs / "fleet.toml", tmp_path, progress=False, retry_failed=True)
    assert (failed.processed, failed.skipped) == (1, LOGS - 1)
    assert files(tmp_path) == expected


def test_inputs_and_outputs_by_url(logs: Path, expected: dict[str, bytes]) -> None:
    distributed = pytest.importorskip("distributed")
    memory = pytest.importorskip("fsspec").filesystem("memory")
    for name, content in files(logs).items():
        memory.pipe_file(f"/fleet/{name}", content)
    with distributed.Client(
        processes=False, n_workers=1, threads_per_worker=2, dashboard_address=None
    ) as client:
        url = "memory://fleet/fleet.toml"
        result = fleet.run(client, url, "memory://fleet-out", progress=False)
    assert (result.processed, result.failed, result.lost) == (LOGS, 1, {})
    found = {
        path.removeprefix("/fleet-out/"): memory.cat_file(path)
        for path in memory.find("/fleet-out")
    }
    # What a URL has beside: which inputs were read, and the results put together.
    beside = {name for name in found if name.startswith(("seen/", "packs/"))}
    assert len(beside) > LOGS
    found = {name: content for name, content in found.items() if name not in beside}
    assert found == expected
    assert result.to_arrow().num_rows > LOGS


def test_the_pure_function_by_itself(
    logs: Path, tmp_path: Path, expected: dict[str, bytes]
) -> None:
    """What Ray or anything else does with it."""
    work = fleet.jobs(logs / "fleet.toml")
    assert len(work) == LOGS
    keys = [fleet.fingerprint(job) for job in work]
    for key, job in reversed(list(zip(keys, work, strict=True))):
        outcome = fleet.process(job, threads=2)
        assert outcome == fleet.process(job)
        fleet.keep(key, outcome, tmp_path)
    assert fleet.kept(tmp_path) == set(keys)
    summary = fleet.gather(keys, tmp_path)
    assert files(tmp_path) == expected
    assert summary == json.loads(expected["fleet.json"])
    [trouble] = summary["failed"]
    assert trouble == {
        "log": "SN1/05/drive.toml",
        "unit": "SN1",
        "why": "gnss.csv: no such file",
    }


def test_mistakes_are_told(tmp_path: Path) -> None:
    manifest = tmp_path / "fleet.toml"
    with pytest.raises(undrift.UndriftError, match="No such file"):
        fleet.jobs(manifest)
    manifest.write_text('[[log]]\ndrive = "a"\nunits = 3\n')
    with pytest.raises(undrift.UndriftError, match="line 3, log.units: unknown key"):
        fleet.jobs(manifest)
    with pytest.raises(undrift.UndriftError, match="not a job"):
        fleet.process("{}")
