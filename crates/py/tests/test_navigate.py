"""navigate and outages: the terminal's numbers, of files and of tables in memory."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undrift

Run = Callable[..., Any]


@pytest.fixture(scope="module")
def simulation() -> undrift.Simulation:
    """A minute and a half of a car, after its minute at rest."""
    receiver = undrift.GnssReceiver(rate=2.0, lever_arm=(0.3, 0.1, -1.2))
    return undrift.simulate("car", 150.0, 50.0, "adis16405", gnss=receiver, seed=4)


@pytest.fixture(scope="module")
def saved(simulation: undrift.Simulation, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return simulation.save(tmp_path_factory.mktemp("drive"))


def without_names(of_terminal: Any) -> Any:
    """A result without what its files are called."""
    of_terminal["drive"] = {
        key: value
        for key, value in of_terminal["drive"].items()
        if key not in ("file", "imu", "gnss", "truth", "odometer", "barometer", "heading")
    }
    return of_terminal


def test_a_stated_date_is_that_of_the_solution(saved: Path) -> None:
    assert undrift.navigate(saved).utc is None
    dated = saved.parent / "dated.toml"
    stated = 'epoch = "2025-07-08T19:34:00Z"\n'
    dated.write_text(stated + saved.read_text(encoding="utf-8"), encoding="utf-8")
    done = undrift.navigate(dated)
    assert done.utc is not None
    since = (done.utc - np.datetime64("2025-07-08T19:34:00")) / np.timedelta64(1, "s")
    np.testing.assert_allclose(since, done.time, atol=1e-6)


@pytest.mark.parametrize("bias_model", ["white", "arma"])
@pytest.mark.parametrize("smooth", [False, True])
def test_navigate_is_the_terminals(
    saved: Path, terminal_json: Run, bias_model: str, smooth: bool
) -> None:
    # Without bias states the solution is not usable.
    done = undrift.navigate(saved, bias_model=bias_model, smooth=smooth, strict=False)
    flags = ["--smooth"] if smooth else []
    of_terminal = terminal_json("navigate", saved, "--bias-model", bias_model, *flags)
    assert json.loads(done.json) == of_terminal
    assert done.rmse == of_terminal["rms_error"]
    assert done.fixes == of_terminal["summary"]["fixes"]


def test_the_text_is_the_terminals(saved: Path, terminal: Run) -> None:
    printed = terminal("navigate", saved, "--json", "-").stdout
    assert undrift.navigate(saved).json == printed.rstrip("\n")


def test_a_simulation_navigates_as_its_files(simulation: undrift.Simulation, saved: Path) -> None:
    of_files, of_arrays = undrift.navigate(saved), undrift.navigate(simulation)
    assert without_names(of_files.data) == without_names(of_arrays.data)
    for name in ("time", "lat", "height", "velocity", "rpy", "position_std", "gyro_error"):
        assert np.array_equal(getattr(of_files, name), getattr(of_arrays, name)), name


def test_files_written_and_arrays_are_one_solution(saved: Path, tmp_path: Path) -> None:
    path, kml = tmp_path / "nav.csv", tmp_path / "nav.kml"
    done = undrift.navigate(saved, output=[path, kml])
    table = np.genfromtxt(path, delimiter=",", names=True)
    assert len(table) == len(done)
    # The file has 11 decimals of a degree, 4 of a metre, 6 of a degree of attitude.
    assert np.abs(table["lat_deg"] - done.lat_deg).max() < 0.6e-11
    assert np.abs(table["height_m"] - done.height).max() < 0.6e-4
    yaw = np.degrees(done.rpy[:, 2]) - table["yaw_deg"]
    assert np.abs((yaw + 180.0) % 360.0 - 180.0).max() < 0.6e-6
    assert "<kml" in kml.read_text()


def frames(simulation: undrift.Simulation) -> dict[str, Any]:
    """The logs as frames with names and units of their own, sensor axes x forward, y left, z up."""
    pandas = pytest.importorskip("pandas")
    imu, gnss = simulation.imu, simulation.gnss
    signs = np.array([1.0, -1.0, -1.0])
    return {
        "imu": pandas.DataFrame(
            {
                "stamp": imu.time,
                **dict(zip(("p", "q", "r"), (imu.gyro * signs).T, strict=True)),
                **dict(zip(("a", "b", "c"), (imu.accel * signs).T, strict=True)),
                "remark": "text",
            }
        ),
        "gnss": pandas.DataFrame(
            {
                "stamp": gnss.time,
                "lat": gnss.lat,
                "lon": gnss.lon,
                "h": gnss.height,
                **dict(zip(("vn", "ve", "vd"), gnss.velocity.T, strict=True)),
            }
        ),
    }


KEYS: dict[str, Any] = {
    "imu": {
        "time": "stamp",
        "gyro": ["p", "q", "r"],
        "gyro_unit": "rad/s",
        "accel": ["a", "b", "c"],
        "accel_unit": "m/s^2",
        "axes": "x,-y,-z",
    },
    "gnss": {
        "time": "stamp",
        "position": ["lat", "lon", "h"],
        "position_unit": "rad",
        "position_std": "0.02, 0.02, 0.04 m",
        "velocity": ["vn", "ve", "vd"],
        "velocity_std": (0.03, 0.03, 0.03),
        "lever_arm": "0.3, 0.1, -1.2 m",
    },
}


@pytest.mark.parametrize("kind", ["pandas", "arrow", "structured", "dict"])
def test_tables_of_all_kinds_are_one_drive(
    simulation: undrift.Simulation, tmp_path: Path, kind: str, terminal_json: Run
) -> None:
    logs = frames(simulation)
    text = 'model = "adis16405"\n'
    for name, keys in KEYS.items():
        logs[name].to_csv(tmp_path / f"{name}.csv", index=False, float_format="%.17g")
        text += f'[{name}]\nfile = "{name}.csv"\n'
        for key, value in keys.items():
            value = "0.03, 0.03, 0.03 m/s" if isinstance(value, tuple) else value
            text += f"{key} = {json.dumps(value)}\n"
    (tmp_path / "drive.toml").write_text(text)
    of_terminal = terminal_json("navigate", tmp_path / "drive.toml")

    def convert(frame: Any) -> Any:
        if kind == "arrow":
            return pytest.importorskip("pyarrow").Table.from_pandas(frame)
        if kind == "structured":
            return frame.drop(columns="remark", errors="ignore").to_records(index=False)
        if kind == "dict":
            return {name: frame[name].to_numpy() for name in frame}
        return frame

    given = {name: {"file": convert(logs[name]), **KEYS[name]} for name in logs}
    done = undrift.navigate(given["imu"], given["gnss"], "adis16405")
    assert without_names(done.data) == without_names(of_terminal)


def test_short_keys_and_columns_known_by_their_names(simulation: undrift.Simulation) -> None:
    imu, gnss = simulation.imu, simulation.gnss
    done = undrift.navigate(
        {"time": imu.time, "gyro": imu.gyro, "accel": imu.accel},
        {
            "t_s": gnss.time,
            "lat_deg": gnss.lat_deg,
            "lon_deg": gnss.lon_deg,
            "height_m": gnss.height,
            "v_n_mps": gnss.velocity[:, 0],
            "v_e_mps": gnss.velocity[:, 1],
            "v_d_mps": gnss.velocity[:, 2],
        },
        undrift.NoiseModel.load("adis16405"),
        gyro_unit="rad/s",
        accel_unit="m/s^2",
        lever_arm=(0.3, 0.1, -1.2),
        position_std=(0.02, 0.02, 0.04),
        velocity_std="0.03 m/s",
    )
    assert done.rmse is None and np.array_equal(
        done.lat, undrift.navigate(simulation.drive(truth=False)).lat
    )


def test_dates_are_seconds_since_1970(simulation: undrift.Simulation) -> None:
    start = np.datetime64("2024-05-01T00:00:00", "ns")

    def dates(time: np.ndarray) -> np.ndarray:
        return start + np.round(time * 1e9).astype("timedelta64[ns]")

    logs = frames(simulation)
    for frame in logs.values():
        frame["stamp"] = dates(frame["stamp"].to_numpy())
    given = {name: {"file": logs[name], **KEYS[name]} for name in logs}
    done = undrift.navigate(given["imu"], given["gnss"], "adis16405")
    assert 1714521600.0 < done.time[0] < 1714521700.0
    # Stamps of this size are rounded to a quarter of a microsecond.
    plain = undrift.navigate(
        *({"file": log, **KEYS[name]} for name, log in frames(simulation).items()), "adis16405"
    )
    assert np.abs(done.height - plain.height).max() < 1e-4


def test_messages_name_table_row_and_column(simulation: undrift.Simulation) -> None:
    imu, gnss = simulation.imu, simulation.gnss
    log = {"time": imu.time, "gyro": imu.gyro.copy(), "accel": imu.accel}
    units = {"gyro_unit": "rad/s", "accel_unit": "m/s^2"}
    fixes = {"file": {"t_s": gnss.time, "lat_deg": gnss.lat_deg, "lon_deg": gnss.lon_deg,
             "h": gnss.height}, "position_std": (1, 1, 1)}
    with pytest.raises(undrift.UndriftError) as refused:
        undrift.navigate({"file": log, "gyro": ["gx", "gy", "gz"], **units}, fixes, "adis16405")
    assert str(refused.value) == (
        '<imu>: no column "gx" (key imu.gyro); the file has: '
        "time, gyro_x, gyro_y, gyro_z, accel_x, accel_y, accel_z"
    )
    with pytest.raises(undrift.UndriftError, match=r"<drive> line 1, imu.gyro_unit: missing: the unit"):
        undrift.navigate(log, fixes, "adis16405")
    with pytest.raises(undrift.UndriftError, match="imu.axle: unknown key"):
        undrift.navigate({"file": log, "axle": "1 m", **units}, fixes, "adis16405")
    with pytest.raises(undrift.UndriftError, match="no noise model"):
        undrift.navigate(log, fixes, **units)
    with pytest.raises(undrift.UndriftError, match='<imu>: column "time" has 2 rows|has 7500 rows'):
        undrift.navigate({**log, "time": [0.0, 1.0]}, fixes, "adis16405", **units)
    with pytest.raises(TypeError, match="gnss is missing"):
        undrift.navigate(log)
    with pytest.raises(TypeError, match="lever"):
        undrift.navigate(log, fixes, "adis16405", lever="1 m")
    with pytest.raises(undrift.UndriftError, match="nowhere.toml: no such file"):
        undrift.navigate("nowhere.toml")
    log["gyro"][16, 0] = np.nan
    done = undrift.navigate(log, fixes, "adis16405", **units)
    assert done.data["skipped"]["imu"] == "1 row with NaN or infinity, at line 17: NaN in column 2"


@pytest.mark.parametrize("smooth", [False, True])
def test_outages_are_the_terminals(
    simulation: undrift.Simulation, saved: Path, terminal_json: Run, smooth: bool
) -> None:
    names = ["white", "gauss-markov", "arma"]
    done = undrift.outages(saved, bias_models=names, length=8.0, count=3, start=75.0, smooth=smooth)
    of_terminal = terminal_json(
        "outages", saved, "--bias-models", ",".join(names), "--length", 8, "--count", 3,
        "--start", 75, *(["--smooth"] if smooth else []),
    )
    assert json.loads(done.json) == of_terminal
    of_arrays = undrift.outages(
        simulation, bias_models=names, length=8.0, count=3, start=75.0, smooth=smooth
    )
    assert without_names(of_arrays.data) == without_names(of_terminal)
    assert list(done.models) == names and done.cuts.shape == (3, 2)
    arma = done.models["arma"]
    assert arma.max == of_terminal["models"]["arma"]["max"]
    curve = arma.outages[0]
    assert curve.start == done.cuts[0, 0] and curve.since[-1] <= 8.0 + 1e-6
    largest = max(drift.horizontal.max() for drift in arma.outages)
    # The curves have ten points a second, the maximum is over all samples.
    assert 0.8 * arma.max["horizontal_m"] < largest <= arma.max["horizontal_m"]


def test_outages_refuse_what_does_not_fit(saved: Path) -> None:
    assert len(undrift.outages(saved, bias_models="arma").cuts) > 1
    with pytest.raises(undrift.UndriftError, match="overlap"):
        undrift.outages(saved, count=40, length=10.0)
    with pytest.raises(undrift.UndriftError, match='unknown bias model "gray"'):
        undrift.outages(saved, bias_models="gray", count=1)


def test_results_become_tables_figures_and_reports(saved: Path, tmp_path: Path) -> None:
    done = undrift.navigate(saved)
    cut = undrift.outages(saved, bias_models=["white", "arma"], count=3, start=75.0, length=5.0)
    assert "arma" in cut.table and "arma" in repr(cut) and "<table>" in cut._repr_html_()
    assert "bias_model" in repr(done) and "json" not in repr(done)
    for result in (done, cut):
        path = tmp_path / "report.html"
        result.report(path)
        assert "<html" in path.read_text()
    white = undrift.navigate(saved, bias_model="white", strict=False)
    undrift.report([done, white], tmp_path / "two.html")
    undrift.report([cut], figures=tmp_path / "figures")
    assert list((tmp_path / "figures").glob("*.svg"))
    pytest.importorskip("pandas")
    frame = done.to_pandas()
    assert len(frame) == len(done) and frame["vn"].iloc[-1] == done.velocity[-1, 0]
    assert set(cut.to_pandas()["model"]) == {"white", "arma"}
    pytest.importorskip("pyarrow")
    assert done.to_arrow().num_rows == len(done)
    pytest.importorskip("matplotlib").use("Agg")
    for drawn in (done.plot(), done.plot_std(), cut.plot()):
        assert drawn.lines


def test_examples_and_their_model(saved: Path, tmp_path: Path) -> None:
    drive = undrift.Drive.load(saved)
    assert drive.model is not None and drive.model.name
    assert undrift.Drive.load(saved, model="mpu6050").model.name != drive.model.name
    assert undrift.navigate(drive, model="mpu6050").rmse != undrift.navigate(drive).rmse
    moved = tmp_path / "drive.toml"
    moved.write_text(saved.read_text().replace('model = "imu.toml"', 'model = "adis16405"'))
    assert undrift.navigate(moved, data=saved.parent).rmse == undrift.navigate(drive).rmse
    assert len(undrift.navigate(drive, solution=False)) == 0


def test_columns_of_all_kinds() -> None:
    from undrift._tables import columns

    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(
        {
            "whole": np.array([1, 2], dtype=np.int32),
            "single": np.array([0.5, 1.5], dtype=np.float32),
            "yes": [True, False],
            "missing": pandas.array([7, None], dtype="Int64"),
            "written": ["1.5", "2"],
            "text": ["a", "b"],
            "date": pandas.to_datetime(["1970-01-01T00:00:01.5", None]),
        }
    )
    found = dict(columns(frame))
    expected = {
        "whole": [1.0, 2.0],
        "single": [0.5, 1.5],
        "yes": [1.0, 0.0],
        "missing": [7.0, np.nan],
        "written": [1.5, 2.0],
        "text": [np.nan, np.nan],
        "date": [1.5, np.nan],
    }
    assert {name: column.dtype for name, column in found.items()} == dict.fromkeys(
        expected, np.dtype(np.float64)
    )
    for name, values in expected.items():
        assert np.array_equal(found[name], values, equal_nan=True), name
    own = np.arange(3.0)
    ((_, same),) = columns({"t": own})
    assert same is own
    masked = np.ma.masked_array([1, 2], mask=[False, True])
    assert np.isnan(columns({"m": masked})[0][1][1])
    with pytest.raises(TypeError, match="column g: invalid shape 2 x 2"):
        columns({"g": np.zeros((2, 2))})


def test_plain_arrays_and_the_verdict(simulation: undrift.Simulation) -> None:
    imu, gnss = simulation.imu, simulation.gnss
    samples = {"time": imu.time, "gyro": imu.gyro, "accel": imu.accel}
    fixes = {"time": gnss.time, "lat_deg": gnss.lat_deg, "lon_deg": gnss.lon_deg, "height": gnss.height}
    units = {"gyro_unit": "rad/s", "accel_unit": "m/s^2", "lever_arm": (0.3, 0.1, -1.2)}
    keys = {**units, "position_std": (1.5, 1.5, 3.0)}
    done = undrift.navigate(samples, fixes, "adis16405", **keys)
    assert done.verdict == "usable" and len(done.time) > 4000, done.warnings
    upright = {**samples, "accel": -imu.accel}
    wrong = undrift.navigate(upright, fixes, "adis16405", strict=False, **keys)
    assert wrong.verdict in ("usable with care", "not usable") and wrong.warnings


def test_a_solution_has_the_times_of_the_clock_that_is_asked_for(simulation: undrift.Simulation) -> None:
    imu = undrift.navigate(simulation, clock="imu")
    gnss = undrift.navigate(simulation, clock="gnss")
    assert not np.array_equal(imu.time, gnss.time)
    # The clocks are the same: found to a few hundredths of a second.
    common = min(len(imu.time), len(gnss.time))
    assert np.abs(imu.time[-common:] - gnss.time[-common:]).max() < 0.3
    # Of a moving car the doubt about the offset is not in a position on the receiver's clock.
    assert np.median(gnss.position_std[:, 0]) < np.median(imu.position_std[:, 0])
    with pytest.raises(undrift.UndriftError, match="no clock"):
        undrift.navigate(simulation, clock="pc")
