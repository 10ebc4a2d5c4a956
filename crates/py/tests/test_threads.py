"""Computations run beside other threads, and on the caller's memory."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest

import undrift


@pytest.fixture
def patient_interpreter() -> Iterator[None]:
    """A thread keeps the interpreter's lock until it gives it away itself."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(60.0)
    yield
    sys.setswitchinterval(before)


@pytest.mark.usefixtures("patient_interpreter")
def test_another_thread_runs_on_while_one_computes() -> None:
    x = undrift.arma.simulate(1_000_000, [0.999], [0.98], 0.01)
    stop = threading.Event()
    rounds = 0

    def count() -> None:
        nonlocal rounds
        while not stop.is_set():
            rounds += 1
            time.sleep(1e-4)  # Gives the lock away.

    counter = threading.Thread(target=count)
    counter.start()
    try:
        time.sleep(0.01)
        before = rounds
        sum(range(2_000_000))
        # So it is when the lock is held.
        assert rounds <= before + 1
        for compute in (
            lambda: undrift.arma.fit(x, (1, 1), effort=0.05),
            lambda: undrift.allan(x, 100.0, kind="modified"),
            lambda: undrift.normality(x),
            lambda: undrift.stationarity(x),
            lambda: undrift.arma.simulate(3_000_000, [0.9], [], 1.0),
        ):
            before = rounds
            compute()
            assert rounds > before + 5
    finally:
        stop.set()
        counter.join()


MEMORY = """
import sys
import numpy as np
import undrift

def peak():
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmHWM:"))

# Varying without a random generator's temporaries.
x = np.empty(20_000_000)
x[:] = np.tile([1.0, -2.0, 0.5, 3.0, -1.5], 4_000_000)
np.add(x, np.arange(20_000_000) % 7, out=x)
with open("/proc/self/clear_refs", "w") as reset:
    reset.write("5")
before = peak()
{call}
print((peak() - before) / 1024)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the peak is read from /proc")
@pytest.mark.parametrize(
    "call",
    [
        "undrift.adf(x, lags=5)",
        "undrift.jarque_bera(x)",
        "undrift.ljung_box(x, 20)",
        "undrift.acf(x, 100)",
        "undrift.psd(x, 100.0)",
        "undrift.wavelet_variance(x, 100.0)",
        "undrift.arma.log_likelihood(x, [0.5], [0.2])",
    ],
)
def test_a_contiguous_record_is_not_copied(call: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", MEMORY.replace("{call}", call)], capture_output=True, text=True
    )
    if "clear_refs" in done.stderr:
        pytest.skip("the peak cannot be reset")
    assert done.returncode == 0, done.stderr
    # A copy of the record would take 153 MiB; what remains is buffers and pages of the library.
    assert float(done.stdout) < 20.0


def test_threads_share_one_record() -> None:
    x = undrift.arma.simulate(200_000, [0.9], [0.2], 1.0)
    expected = repr(undrift.stationarity(x))
    found: list[str] = []
    threads = [
        threading.Thread(target=lambda: found.append(repr(undrift.stationarity(x))))
        for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [expected] * 4
    assert np.isfinite(x).all()
