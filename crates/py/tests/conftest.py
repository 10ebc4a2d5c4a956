"""What the tests share: the command to compare with, and simulated records."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

ROOT = Path(__file__).resolve().parents[3]


def command() -> str | None:
    """The built command: ``UNDRIFT``, or in the target directory, or on the path."""
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    built = [target / profile / "undrift" for profile in ("release", "debug")]
    newest = sorted(filter(Path.exists, built), key=lambda path: path.stat().st_mtime)
    return os.environ.get("UNDRIFT") or (str(newest[-1]) if newest else shutil.which("undrift"))


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Reports what is skipped in the file ``UNDRIFT_SKIPPED`` too, which the gate collects."""
    record = os.environ.get("UNDRIFT_SKIPPED")
    if report.skipped and record and isinstance(report.longrepr, tuple):
        reason = report.longrepr[2].removeprefix("Skipped: ")
        with Path(record).open("a") as out:
            out.write(f"skipped: python::{report.nodeid} without {reason}\n")


@pytest.fixture(scope="session")
def terminal() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Runs the command with arguments, whatever its exit code."""
    program = command()
    if program is None:
        pytest.skip("the command undrift is not built")

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [program, *map(str, arguments)], capture_output=True, text=True, check=False
        )

    return run


@pytest.fixture(scope="session")
def terminal_json(
    terminal: Callable[..., subprocess.CompletedProcess[str]],
) -> Callable[..., Any]:
    """Runs a verb with ``--json -`` and gives what it prints."""

    def run(*arguments: object) -> Any:
        done = terminal(*arguments, "--json", "-")
        assert done.returncode in (0, 3), done.stderr
        return json.loads(done.stdout)

    return run


@pytest.fixture(scope="session")
def record() -> npt.NDArray[np.float64]:
    """20 000 samples of white noise over a slow bias: an ARMA(1,1), phi 0.999, theta 0.98."""
    generator = np.random.Generator(np.random.PCG64(5))
    noise = generator.standard_normal(20_001)
    values = np.empty(20_000)
    level = 0.0
    for k in range(values.size):
        level = 0.999 * level + noise[k + 1] - 0.98 * noise[k]
        values[k] = level
    return 0.01 * values
