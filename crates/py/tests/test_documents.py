"""What docs/python.md shows runs."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
Terminal = Callable[..., "subprocess.CompletedProcess[str]"]


def blocks(heading: str) -> list[str]:
    """The Python of a section."""
    text = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    section = text.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    return re.findall(r"^```python\n(.*?)^```", section, re.MULTILINE | re.DOTALL)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    matplotlib = pytest.importorskip("matplotlib")
    pytest.importorskip("pandas")
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_tour_runs(folder: Path) -> None:
    tour = blocks("Five minutes")
    assert len(tour) >= 5
    names: dict[str, object] = {}
    for block in tour:
        exec(compile(block, "docs/python.md", "exec"), names)
    assert (folder / "allan.png").stat().st_size > 1000


def test_three_tasks_take_a_few_lines(folder: Path, terminal: Terminal) -> None:
    assert terminal("sample", "logs").returncode == 0
    tasks = blocks("Three tasks")
    lines = [len([line for line in task.splitlines() if line]) for task in tasks]
    assert lines[0] <= 8 and lines[1] <= 6 and lines[2] <= 12, lines
    names: dict[str, object] = {}
    for task in tasks:
        exec(compile(task, "docs/python.md", "exec"), names)
    assert "gyroscope_noise_density" in (folder / "imu.yaml").read_text(encoding="utf-8")
