"""The mixed model of a fleet's results, against dense matrices and by what it refuses."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from undrift import fleet

pandas = pytest.importorskip("pandas")
pytest.importorskip("statsmodels")
pytestmark = pytest.mark.filterwarnings("ignore:The MLE may be on the boundary")

GOLDEN = Path(__file__).resolve().parents[3] / "testdata" / "golden" / "mixed.json"
CASES = json.loads(GOLDEN.read_text())["cases"]


def results(case: dict[str, Any]) -> Any:
    """A case as ``results.parquet`` has it: two outages of a log and part with the same root mean square."""
    rows = []
    for unit, log, x, y in zip(case["unit"], case["log"], case["x"], case["y"], strict=True):
        for outage, times in ((1, 0.6), (2, 0.8)):
            rows.append(
                {
                    "log": f"log {log}",
                    "unit": f"SN{unit}",
                    "sensor": "ab"[int(x[4])],
                    "task": "outages",
                    "part": "xyz"[x.index(1.0)],
                    "note": None,
                    "fingerprint": f"{log:x}",
                    "labels": json.dumps({"vehicle": ["van", "car"][log % 2], "sort": "ab"[int(x[4])]}),
                    "outage": outage,
                    "temperature_c": x[3],
                    "max_horizontal_m": times * 2**0.5 * np.exp(y),
                }
            )
    return pandas.DataFrame(rows)


@pytest.mark.parametrize("case", CASES)
def test_the_model_is_that_of_dense_matrices(case: dict[str, Any]) -> None:
    found = fleet.effects(results(case))
    # Columns there are parts, temperature, sensor, at 0 °C. MixedLM stops at 1e-6 or so of the likelihood's maximum,
    # which is flat: 1e-3 of the variances, 1e-5 of the coefficients.
    *parts, slope, sensor = case["beta"]
    expected = [*(part + 25.0 * slope for part in parts), sensor, slope]
    names = ["part[x]", "part[y]", "part[z]", "sensor[T.b]", "temperature"]
    assert list(found.factors.index) == names
    np.testing.assert_allclose(np.log(found.factors["times"]), expected, rtol=0, atol=1e-5)
    rest, log, unit = case["variances"]
    squares = [found.scatter[name] ** 2 for name in ("rest", "log", "unit")]
    np.testing.assert_allclose(squares, [rest, log, unit], rtol=1e-3, atol=1e-6)
    # MixedLM's errors are of the observed information, those there of the expected one: up to 6 % apart where the
    # spread of units is zero.
    for name, error in zip(("temperature", "sensor[T.b]"), case["standard_error"][3:], strict=True):
        row = found.factors.loc[name]
        half = 0.5 * (np.log(row["high"]) - np.log(row["low"]))
        np.testing.assert_allclose(half, 1.959964 * error, rtol=0.06)
        assert row["low"] < row["times"] < row["high"]
    percent = 100 * np.expm1(slope)
    assert abs(found.temperature["percent_per_k"] - percent) < 1e-3
    assert found.temperature["low"] < percent < found.temperature["high"]
    assert found.temperature["p"] == found.factors.loc["temperature", "p"]
    assert (found.logs, found.units, found.rows) == (
        len(set(case["log"])),
        len(set(case["unit"])),
        len(case["y"]),
    )


def test_a_path_a_table_and_a_frame_are_the_same(tmp_path: Path) -> None:
    arrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    frame = results(CASES[0])
    table = arrow.Table.from_pandas(frame)
    parquet.write_table(table, tmp_path / "results.parquet")
    known = fleet.effects(frame).factors
    for form in (tmp_path / "results.parquet", str(tmp_path / "results.parquet"), table):
        pandas.testing.assert_frame_equal(fleet.effects(form).factors, known)


def test_what_cannot_be_trusted_is_left_out() -> None:
    frame = results(CASES[0])
    known = fleet.effects(frame)
    bad = frame[(frame["fingerprint"] == "3") & (frame["part"] == "x")].copy()
    # One outage with a note, or without a number, is enough.
    for log, column, value in (("noted", "note", "diverged"), ("empty", "max_horizontal_m", np.nan)):
        bad = bad.assign(log=log, fingerprint=log, max_horizontal_m=1e6, note=None)
        bad.loc[bad["outage"] == 2, column] = value
        frame = pandas.concat([frame, bad], ignore_index=True)
    found = fleet.effects(frame)
    assert found.rows == known.rows
    pandas.testing.assert_frame_equal(found.factors, known.factors)


def test_labels_temperatures_and_units_may_be_unknown() -> None:
    frame = results(CASES[0])
    trucks = frame["labels"].str.contains("car")
    frame.loc[trucks, "max_horizontal_m"] *= 0.5
    frame.loc[frame["fingerprint"].isin(["1", "8"]), "temperature_c"] = np.nan
    frame.loc[frame["fingerprint"].isin(["2", "9"]), "labels"] = None
    frame.loc[frame["fingerprint"] == "4", "unit"] = None
    found = fleet.effects(frame, labels=["vehicle"])
    assert found.units == 13
    # Of ln 2, and unknown is the first value.
    car, van = (found.factors.loc[f"vehicle[T.{name}]", "times"] for name in ("car", "van"))
    alone = fleet.effects(results(CASES[0]), labels=["vehicle"]).factors.loc["vehicle[T.van]"]
    assert van / car == pytest.approx(2.0 * alone["times"], rel=0.1)
    assert "temperature_known" in found.factors.index
    own = fleet.effects(frame, labels=["vehicle"], formula="part + vehicle")
    assert list(own.factors.index)[:3] == ["Intercept", "part[T.y]", "part[T.z]"]
    assert own.temperature == {}


def test_without_units_or_parts_a_level_of_scatter_is_missing() -> None:
    frame = results(CASES[1])
    assert set(fleet.effects(frame.assign(unit=None)).scatter) == {"log", "rest"}
    one = frame[frame["part"] == "x"]
    assert set(fleet.effects(one).scatter) == {"unit", "rest"}


@pytest.mark.parametrize(
    ("change", "options", "message"),
    [
        (lambda frame: frame, {"measure": "drift"}, "the table has no column drift"),
        (lambda frame: frame, {"labels": ["driver"]}, "no log has a label driver"),
        (lambda frame: frame, {"labels": ["sort"]}, r"sort\[T.b\] cannot be separated"),
        (lambda frame: frame, {"labels": ["unit"]}, "the label unit is called like a column"),
        (lambda frame: frame[:2], {}, "too few logs"),
        (
            lambda frame: pandas.concat([frame, frame.assign(task="tune")]),
            {},
            r"values of several tasks \(outages, tune\)",
        ),
    ],
)
def test_what_it_refuses(change: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        fleet.effects(change(results(CASES[0])), **options)


def test_without_statsmodels_the_extra_is_named() -> None:
    program = """
import sys
sys.modules["statsmodels"] = None
from undrift import fleet
try:
    fleet.effects(None)
except ImportError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stderr == ""
    assert done.stdout == 'statsmodels is needed for this: pip install "undrift[fleet]"\n'
