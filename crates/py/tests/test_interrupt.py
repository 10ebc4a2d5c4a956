"""Ctrl-C ends a long computation, and progress is reported while it runs."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import undrift


@pytest.fixture(autouse=True)
def interruptible() -> Iterator[None]:
    """Shells have what they run in the background ignore Ctrl-C, and Python then leaves it so."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(scope="module")
def long_record() -> Any:
    return undrift.arma.simulate(2_000_000, [0.9995], [0.99], 1e-3, seed=1)


@pytest.fixture(scope="module")
def drive() -> undrift.Drive:
    return undrift.simulate("car", 3600.0, 100.0, seed=1).drive()


@pytest.mark.parametrize(
    "compute",
    [
        lambda x, _: undrift.arma.fit(x, (4, 4), effort=1000.0),
        lambda x, _: undrift.pandit_wu(x, 4, effort=100.0),
        lambda x, _: undrift.allan(x, 100.0, kind="modified", taus="all"),
        lambda x, _: undrift.identify(x, rate=100.0, axis="gyro_x"),
        lambda _, drive: undrift.outages(drive, length=30, every=60, start=60),
        lambda _, drive: undrift.tune(drive),
        lambda _, drive: [undrift.navigate(drive, solution=False, smooth=True) for _ in range(9)],
    ],
    ids=["fit", "pandit_wu", "allan", "identify", "outages", "tune", "navigate"],
)
def test_ctrl_c_is_heard(
    compute: Callable[[Any, Any], Any], long_record: Any, drive: undrift.Drive
) -> None:
    pressed = [0.0]

    def press() -> None:
        pressed[0] = time.monotonic()
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(0.5, press)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        compute(long_record, drive)
    # Uninterrupted each takes ten seconds to many minutes; two may pass on a busy machine, the rest is slack.
    assert time.monotonic() - pressed[0] < 5.0
    # What is computed next does not stop.
    assert undrift.allan(long_record[:1000], 100.0).samples == 1000


class Bar:
    """As tqdm's."""

    def __init__(self, total: int | None = None, desc: str = "") -> None:
        self.total, self.desc, self.n, self.calls, self.closed = total, desc, 0, 0, False
        Bar.last = self

    def update(self, done: int) -> None:
        self.n += done
        self.calls += 1

    def close(self) -> None:
        self.closed = True


def test_progress_reaches_its_total() -> None:
    drive = undrift.simulate("car", 900.0, 100.0, seed=1).drive()
    undrift.outages(drive, length=30, count=2, bias_models=["white", "arma"], progress=Bar)
    bar: Any = Bar.last
    assert bar.desc == "outages" and bar.closed and bar.calls > 2
    # Two models, and the drive without outages.
    assert bar.n == bar.total == 3 * 90_000
    undrift.navigate(drive, solution=False, progress=Bar)
    bar = Bar.last
    assert bar.desc == "navigate" and bar.closed and 80_000 < bar.n <= 90_000
    x = undrift.arma.simulate(6_000, [0.99], [0.9], 1e-3)
    undrift.identify(x, rate=100.0, axis="gyro_x", progress=Bar)
    assert (Bar.last.n, Bar.last.total) == (1, 1)


def test_a_bar_that_raises_ends_the_computation(drive: undrift.Drive) -> None:
    class Broken(Bar):
        def update(self, done: int) -> None:
            raise RuntimeError("no room for a bar")

    with pytest.raises(RuntimeError, match="no room for a bar"):
        undrift.navigate(drive, solution=False, progress=Broken)
    assert Bar.last.closed
    with pytest.raises(TypeError, match="progress: True or a callable"):
        undrift.navigate(drive, progress=3)


def test_a_bar_of_ones_own(drive: undrift.Drive, capsys: pytest.CaptureFixture[str]) -> None:
    undrift.outages(drive, length=30, count=1, start=120, bias_models="white", progress=True)
    assert "outages: " in capsys.readouterr().err
