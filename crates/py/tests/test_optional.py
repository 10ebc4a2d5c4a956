"""Plots and tables: with the packages, and what is said without them."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import numpy.typing as npt
import pytest

import undrift


def test_plots(record: npt.NDArray[np.float64]) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    allan = undrift.allan(record, 100.0)
    axes = allan.plot()
    assert axes.get_xscale() == axes.get_yscale() == "log"
    # The curve, the fitted terms, where these are outside of the band, and the band.
    assert len(axes.lines) == 3 and len(axes.collections) == 1
    assert allan.plot(axes, terms=False) is axes and len(axes.lines) == 4
    assert len(undrift.allan(record, 100.0, kind="total", confidence=None).plot().lines) == 1
    for result in (
        undrift.wavelet_variance(record, 100.0),
        undrift.psd(record, 100.0),
        undrift.acf(record, 20),
    ):
        result.plot().figure.canvas.draw()
    axes.figure.canvas.draw()
    pyplot.close("all")


@pytest.mark.parametrize(
    ("missing", "call", "extra"),
    [
        ("pandas", "to_pandas", "tables"),
        ("pyarrow", "to_arrow", "tables"),
        ("polars", "to_polars", "polars"),
        ("matplotlib", "plot", "plot"),
    ],
)
def test_what_is_missing_is_named(missing: str, call: str, extra: str) -> None:
    program = f"""
import sys
sys.modules[{missing!r}] = None
import undrift
result = undrift.allan(range(100), 1.0)
try:
    result.{call}()
except ImportError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stderr == ""
    assert done.stdout == f'{missing} is needed for this: pip install "undrift[{extra}]"\n'


def test_importing_the_package_brings_numpy_only() -> None:
    program = (
        "import sys, undrift\n"
        "print([m for m in ('pandas', 'pyarrow', 'matplotlib', 'polars', 'scipy', 'dask') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout == "[]\n", done.stderr
