"""tools/data, which converts published drives and records into what the examples and tests expect."""

from __future__ import annotations

import gzip
import importlib.machinery
import importlib.util
import os
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]
TOOL = ROOT / "tools" / "data"


def tool() -> Any:
    loader = importlib.machinery.SourceFileLoader("tools_data", str(TOOL))
    spec = importlib.util.spec_from_loader("tools_data", loader)
    assert spec
    module = importlib.util.module_from_spec(spec)
    loader.exec_module(module)
    return module


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, TOOL, *map(str, arguments)], capture_output=True, text=True, check=False
    )


def test_the_public_data_are_what_the_tests_expect() -> None:
    folder = tool().default()
    if not folder.is_dir():
        pytest.skip("DATA")
    done = run("--check")
    assert done.returncode == 0, done.stderr


def test_published_files_become_what_the_tests_expect(tmp_path: Path) -> None:
    """Every conversion of which the published files are in UNDRIFT_DOWNLOADS, a folder of clones."""
    downloads = os.environ.get("UNDRIFT_DOWNLOADS")
    if not downloads:
        pytest.skip("UNDRIFT_DOWNLOADS")
    done = run("--into", tmp_path, downloads)
    assert done.returncode == 0, done.stderr
    assert run("--into", tmp_path, "--check").returncode == 0


def test_another_content_is_not_written(tmp_path: Path) -> None:
    published = tmp_path / "clones/pymavlink/tests/test.BIN"
    published.parent.mkdir(parents=True)
    published.write_bytes(b"cut short")
    done = run("--into", tmp_path / "data", tmp_path / "clones")
    assert done.returncode == 1
    assert "fixtures/ardupilot-test.BIN: not the file" in done.stderr
    assert not (tmp_path / "data").exists()
    assert run("--into", tmp_path, tmp_path / "data").returncode == 1
    # And one that is there already is found out.
    there = tmp_path / "rtk-drive/imu.csv.gz"
    there.parent.mkdir()
    there.write_bytes(gzip.compress(b"gps_sow_s\n")[:-3])
    done = run("--into", tmp_path, "--check")
    assert done.returncode == 1
    assert "rtk-drive/imu.csv.gz: not the file" in done.stderr


@pytest.mark.parametrize("compressed", [False, True])
def test_a_mat_file_is_read_as_scipy_wrote_it(tmp_path: Path, compressed: bool) -> None:
    scipy_io = pytest.importorskip("scipy.io")
    values = np.arange(12.0).reshape(4, 3) / 7
    of = {"t": np.arange(5.0), "table": values, "counts": np.array([[1, -300, 70000]]), "note": "x"}
    scipy_io.savemat(tmp_path / "a.mat", {"imu": of, "plain": values}, do_compression=compressed)
    found = tool().mat(tmp_path / "a.mat")
    assert found["plain"] == values.T.tolist()
    assert found["imu"]["table"] == values.T.tolist()
    assert found["imu"]["t"] == [[0.0], [1.0], [2.0], [3.0], [4.0]]
    assert found["imu"]["counts"] == [[1], [-300], [70000]]
    assert found["imu"]["note"] is None


def test_a_log_of_ticks_gets_the_times_of_its_tags(tmp_path: Path) -> None:
    # Ticks of a clock that runs half a per cent slow: 2 s are 2.01 s by the tags, from Tuesday 0 h of GPS week 2374 on.
    ticks = [100, 500, 1500, 2500, 2600]
    log = "".join(f"0.1,0.2,1.0,0.3,0.4,0.5,{tick}\n" for tick in ticks)
    (tmp_path / "imu.csv").write_text(log)
    begun = 315964800 + 2374 * 604800 + 172800
    tags = bytes(60) + struct.pack("<IId", 7, begun, 0.25) + struct.pack("<IIII", 0, 0, 2010, 99)
    (tmp_path / "imu.csv.tag").write_bytes(tags)
    (tmp_path / "a.pos").write_text("% solution\n")
    made = tool().rtk_drive(tmp_path / "imu.csv", tmp_path / "imu.csv.tag", tmp_path / "a.pos")
    rows = made["imu.csv.gz"].decode().splitlines()[1:]
    # Less the log's delay of 0.125 s.
    assert [row.split(",")[0] for row in rows] == ["172800.1250", "172801.1300", "172802.1350"]
    assert rows[0].split(",")[1:] == ["0.1", "0.2", "1.0", "0.3", "0.4", "0.5"]
