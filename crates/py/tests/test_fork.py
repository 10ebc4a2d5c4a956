"""A forked child computes: threads do not survive a fork, those of the package are made again."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import undrift

pytestmark = [
    pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork"),
    # Python 3.12 warns of any fork beside threads.
    pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning"),
]

#: A child that hangs is ended after so long [s]; it has a second's work.
PATIENCE = 60


def deviation(seed: int = 1) -> float:
    x = undrift.arma.simulate(30_000, [0.99], [0.9], 1.0, seed=seed)
    return float(undrift.allan(x, 100.0, taus="all").deviation[-1])


def identified(_: int = 0) -> str:
    x = undrift.arma.simulate(6_000, [0.99], [0.9], 1e-3, seed=3)
    return undrift.identify(x, rate=100.0, axis="gyro_x").recommended["gyro_x"]


def drift(_: int = 0) -> Any:
    sim = undrift.simulate("car", 120.0, 50.0, seed=2)
    return undrift.outages(sim, length=5, count=2, bias_models=["white", "arma"]).data["models"]


@pytest.fixture(autouse=True)
def patience() -> Iterator[None]:
    """What hangs fails."""

    def give_up(*_: object) -> None:
        raise TimeoutError("a child hangs")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(PATIENCE)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("compute", [deviation, identified, drift])
def test_a_forked_child_computes_the_same(compute: Callable[[], Any]) -> None:
    expected = compute()  # The threads of this process are there now.
    child = os.fork()
    if child == 0:
        code = 1
        try:
            signal.signal(signal.SIGALRM, signal.SIG_DFL)
            signal.alarm(PATIENCE // 2)
            code = 0 if compute() == expected else 2
        finally:
            os._exit(code)
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == 0
    assert compute() == expected


def test_a_pool_of_forked_processes() -> None:
    expected = [deviation(seed) for seed in range(4)]
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(deviation, range(4)).get(PATIENCE) == expected
        assert pool.map_async(identified, range(2)).get(PATIENCE) == [identified()] * 2


def test_joblib() -> None:
    joblib = pytest.importorskip("joblib")
    expected = [deviation(seed) for seed in range(3)]
    for backend in ("loky", "threading", "multiprocessing"):
        done = joblib.Parallel(n_jobs=2, backend=backend)(
            joblib.delayed(deviation)(seed) for seed in range(3)
        )
        assert done == expected, backend


def _loader(wanted: Any, made: Any) -> None:
    """A worker as of PyTorch's DataLoader: forked once, it makes items until it is asked for none."""
    while (index := wanted.get()) is not None:
        made.put((index, deviation(index)))


def test_the_workers_of_a_data_loader() -> None:
    expected = {index: deviation(index) for index in range(4)}
    context = multiprocessing.get_context("fork")
    wanted, made = context.SimpleQueue(), context.SimpleQueue()
    workers = [context.Process(target=_loader, args=(wanted, made)) for _ in range(2)]
    for worker in workers:
        worker.start()
    for index in expected:
        wanted.put(index)
    found = dict(made.get() for _ in expected)
    for _ in workers:
        wanted.put(None)
    for worker in workers:
        worker.join(PATIENCE)
        assert worker.exitcode == 0
    assert found == expected


def test_a_child_of_a_child(tmp_path: Any) -> None:
    expected = deviation()
    child = os.fork()
    if child == 0:
        code = 1
        try:
            deviation()
            grandchild = os.fork()
            if grandchild == 0:
                os._exit(0 if deviation() == expected else 2)
            code = os.waitstatus_to_exitcode(os.waitpid(grandchild, 0)[1])
        finally:
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


if sys.platform == "linux":

    def test_threads_end_with_their_calls_not_with_every_call() -> None:
        """Teams are used again: a thousand calls leave no more threads than two at once need."""
        x = np.random.Generator(np.random.PCG64(1)).standard_normal(500)
        for _ in range(1000):
            undrift.allan(x, 1.0)
        assert len(os.listdir("/proc/self/task")) < 50 + 4 * (os.cpu_count() or 1)
