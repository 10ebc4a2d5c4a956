"""Many logs on object storage: what is asked of the store, counted on a server on loopback."""

from __future__ import annotations

import io
import json
import os
import signal
import socket
import subprocess
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import undrift
from test_fleet import BROKEN, LOGS, MANIFEST, cluster, expected, files, logs
from object_store import read, served
from undrift import _store, fleet

__all__ = ["cluster", "expected", "logs"]

FOLDER = "s3://bucket/logs"


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch, logs: Path) -> Iterator[Counter[tuple[str, str]]]:
    """The logs in a bucket, and what is asked of the server from then on."""
    with served(monkeypatch) as counts:
        s3fs = pytest.importorskip("s3fs")
        s3fs.S3FileSystem.clear_instance_cache()
        bucket = s3fs.S3FileSystem()
        bucket.mkdir("bucket")
        for name, content in files(logs).items():
            bucket.pipe_file(f"bucket/logs/{name}", content)
        counts.clear()
        yield counts


def results(bucket: Any, output: str) -> dict[str, bytes]:
    """The files of a fleet, without what a store has beside."""
    found = {name.partition(f"{output}/")[2]: name for name in bucket.find(output)}
    return {
        name: bucket.cat_file(path)
        for name, path in found.items()
        if not name.startswith(("seen/", "packs/"))
    }


def test_an_object_is_read_once(
    asked: Counter[tuple[str, str]], expected: dict[str, bytes], cluster: Any
) -> None:
    client, _ = cluster
    bucket = _store.system(FOLDER)[0]
    manifest = f"{FOLDER}/fleet.toml"
    first = fleet.run(client, manifest, "s3://bucket/out", progress=False)
    assert (first.processed, first.skipped, first.failed) == (LOGS, 0, 1)
    assert results(bucket, "bucket/out") == expected
    inputs = read(asked, "/bucket/logs/SN")
    # A drive file and two logs of each; one has no fixes.
    assert len(inputs) == 3 * LOGS - 1
    assert set(inputs.values()) == {1}

    asked.clear()
    again = fleet.run(client, manifest, "s3://bucket/out", progress=False)
    assert (again.processed, again.skipped) == (0, LOGS)
    assert read(asked, "/bucket/logs/SN") == {}
    assert results(bucket, "bucket/out") == expected

    # What has changed is read, and nothing else.
    path = "bucket/logs/SN0/01/imu.csv"
    content = bucket.cat_file(path)
    bucket.pipe_file(path, content.rpartition(b"\n")[0].rpartition(b"\n")[0] + b"\n")
    asked.clear()
    third = fleet.run(client, manifest, "s3://bucket/out", progress=False)
    assert (third.processed, third.skipped) == (1, LOGS - 1)
    of_it = {f"/bucket/logs/SN0/01/{name}": 1 for name in ("drive.toml", "imu.csv", "gnss.csv")}
    assert read(asked, "/bucket/logs/SN") == of_it


def test_a_killed_worker_repeats_its_own_log(
    asked: Counter[tuple[str, str]], expected: dict[str, bytes], cluster: Any
) -> None:
    client, workers = cluster

    def progress(done: int, _all: int) -> None:
        if done == LOGS // 2:
            os.kill(workers[0].pid, signal.SIGKILL)

    result = fleet.run(client, f"{FOLDER}/fleet.toml", "s3://bucket/out", progress=progress)
    assert result.lost == {}
    assert results(_store.system(FOLDER)[0], "bucket/out") == expected
    inputs = read(asked, "/bucket/logs/SN")
    twice = {os.path.dirname(path) for path, number in inputs.items() if number > 1}
    assert max(inputs.values()) <= 2 and len(twice) <= 1


def test_a_damaged_result_is_replaced_and_reported(
    asked: Counter[tuple[str, str]], expected: dict[str, bytes]
) -> None:
    bucket = _store.system(FOLDER)[0]
    work = fleet.jobs(f"{FOLDER}/fleet.toml")[:3]
    first = [fleet.process_to(job, "s3://bucket/out") for job in work]
    assert all(done.processed and not done.damaged for done in first)
    for done, damage in zip(first, (b"", b"{", None), strict=True):
        path = f"bucket/out/jobs/{done.fingerprint}.json"
        # It is still JSON.
        other = bucket.cat_file(path).replace(b'"outage": 1', b'"outage": 2', 1)
        bucket.pipe_file(path, other if damage is None else damage)
    again = [fleet.process_to(job, "s3://bucket/out") for job in work]
    assert all(done.processed and done.damaged for done in again)
    for done in again:
        name = f"jobs/{done.fingerprint}.json"
        assert bucket.cat_file(f"bucket/out/{name}") == expected[name]
    assert [fleet.process_to(job, "s3://bucket/out").processed for job in work] == [False] * 3
    # Gathering twice reads the results once.
    asked.clear()
    keys = [done.fingerprint for done in again]
    summary = fleet.gather(keys, "s3://bucket/out")
    assert sum(read(asked, "/bucket/out/jobs").values()) == 3
    assert fleet.gather(keys, "s3://bucket/out") == summary
    assert sum(read(asked, "/bucket/out/jobs").values()) == 3


def test_tasks_and_memory_of_the_scheduler_are_bounded(
    logs: Path, tmp_path: Path, expected: dict[str, bytes]
) -> None:
    distributed = pytest.importorskip("distributed")
    most = 0
    with distributed.Client(
        processes=False, n_workers=1, threads_per_worker=1, dashboard_address=None
    ) as client:

        def progress(_done: int, _all: int) -> None:
            nonlocal most
            most = max(most, len(client.futures))

        fleet.run(client, logs / "fleet.toml", tmp_path, progress=progress)
        # Four for a thread, and those that are being let go.
        assert 0 < most <= 6 < LOGS
    assert files(tmp_path) == expected


def test_a_store_that_does_not_answer_is_an_error(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    pytest.importorskip("s3fs").S3FileSystem.clear_instance_cache()
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "testing")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "testing")
    monkeypatch.setattr(_store, "PATIENCE", 1.0)
    with socket.create_server(("127.0.0.1", 0)) as deaf:
        monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://127.0.0.1:{deaf.getsockname()[1]}")
        before = time.monotonic()
        with pytest.raises(undrift.UndriftError, match=r"s3://bucket/fleet.toml: no answer for 1 s"):
            fleet.jobs("s3://bucket/fleet.toml")
        assert time.monotonic() - before < 5


def test_a_table_of_logs_in_parquet_and_one_drive_file(
    asked: Counter[tuple[str, str]], logs: Path
) -> None:
    """One drive file for three folders is three logs, and the numbers are those of the drives themselves."""
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    bucket = _store.system(FOLDER)[0]
    table = pandas.DataFrame(
        {
            "data": [f"SN0/{k:02}" for k in range(3)],
            "unit": ["a", "b", None],
            "type": "cheap",
            "temperature_c": [1.5, None, 3.0],
            "vehicle": "van",
        }
    )
    drive = (logs / "SN0/00/drive.toml").read_bytes()
    bucket.pipe_file("bucket/logs/car.toml", drive)
    bucket.pipe_file("bucket/logs/logs.parquet", table.to_parquet())
    of_table = 'table = "logs.parquet"\ndrive = "car.toml"'
    manifest = MANIFEST.replace('drive = "SN*/*/drive.toml"', of_table)
    bucket.pipe_file("bucket/logs/table.toml", manifest.encode())
    by_table = fleet.jobs(f"{FOLDER}/table.toml")
    names = [json.loads(job)["log"] for job in by_table]
    assert names == [f"SN0/{k:02}/car.toml" for k in range(3)]
    pattern = manifest.replace('table = "logs.parquet"', 'data = "SN0/*"')
    bucket.pipe_file("bucket/logs/pattern.toml", pattern.encode())
    listed = fleet.jobs(f"{FOLDER}/pattern.toml")
    assert [json.loads(job)["log"] for job in listed] == names

    outcome = json.loads(fleet.process(by_table[0]))
    assert (outcome["unit"], outcome["sensor"]) == ("a", "cheap")
    assert (outcome["temperature_c"], outcome["labels"]) == (1.5, {"vehicle": "van"})
    alone = json.loads(fleet.process(fleet.jobs(f"{FOLDER}/fleet.toml")[0]))
    assert outcome["rows"] == alone["rows"]
    assert BROKEN > 2

    done = fleet.process_to(by_table[0], "s3://bucket/out")
    fleet.gather([done.fingerprint], "s3://bucket/out")
    rows = pandas.read_parquet(io.BytesIO(bucket.cat_file("bucket/out/results.parquet")))
    assert set(rows["labels"]) == {'{"vehicle":"van"}'}
    assert set(rows["skipped_rows"]) == {0}


def test_a_drive_file_here_of_logs_in_a_store(
    asked: Counter[tuple[str, str]], logs: Path, tmp_path: Path
) -> None:
    """What has changed here is noticed as well."""
    drive = (logs / "SN0/00/drive.toml").read_text()
    (tmp_path / "car.toml").write_text(drive)
    data = f'drive = "car.toml"\ndata = "{FOLDER}/SN0/00"'
    manifest = MANIFEST.replace('drive = "SN*/*/drive.toml"', data)
    (tmp_path / "fleet.toml").write_text(manifest)
    (job,) = fleet.jobs(tmp_path / "fleet.toml")
    first = fleet.process_to(job, tmp_path / "out")
    assert first.processed and not first.failed
    assert read(asked, "/bucket/logs") == {
        f"/bucket/logs/SN0/00/{name}.csv": 1 for name in ("imu", "gnss")
    }
    assert not fleet.process_to(job, tmp_path / "out").processed
    assert max(read(asked, "/bucket/logs").values()) == 1
    (tmp_path / "car.toml").write_text(drive.replace('"0.05 m"', '"0.06 m"'))
    again = fleet.process_to(job, tmp_path / "out")
    assert again.processed and again.fingerprint != first.fingerprint


def test_progress_is_lines_off_a_terminal(
    logs: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    distributed = pytest.importorskip("distributed")
    with distributed.Client(
        processes=False, n_workers=1, threads_per_worker=2, dashboard_address=None
    ) as client:
        fleet.run(client, logs / "fleet.toml", tmp_path)
    lines = capfd.readouterr().err.splitlines()
    first = lines.index("looking for logs")
    assert lines[first + 1] == f"0 of {LOGS} logs"
    assert f"{LOGS} of {LOGS} logs" in lines


def test_a_command_refuses_urls(
    terminal: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path
) -> None:
    done = terminal("fleet", "s3://bucket/fleet.toml", "-o", tmp_path)
    assert done.returncode == 2
    assert "s3://bucket/fleet.toml: the command reads and writes files" in done.stderr
    assert "undrift.fleet.process_to" in done.stderr
