"""Whether a result can be used: warnings and exceptions by its verdict. Logs into drives, models side by side, tables."""

from __future__ import annotations

import pickle
import sys
import types
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undrift

RATE = 50.0


@pytest.fixture(scope="module")
def sim() -> undrift.Simulation:
    return undrift.simulate("car", 200.0, RATE, seed=2)


@pytest.fixture(scope="module")
def short() -> undrift.Simulation:
    """Of 120 s the first minute is the rest before the drive: the solution covers less than half."""
    return undrift.simulate("car", 120.0, RATE, seed=2)


def backwards(sim: undrift.Simulation, **keys: Any) -> undrift.Navigation:
    """The IMU faces backwards, as nobody states."""
    turn = np.array([-1.0, -1.0, 1.0])
    imu = {"time": sim.imu.time, "gyro": turn * sim.imu.gyro, "accel": turn * sim.imu.accel}
    units = {"gyro_unit": "rad/s", "accel_unit": "m/s^2"}
    return undrift.navigate(imu, sim.gnss, "adis16405", **units, **keys)


def test_with_care_warns_or_raises(short: undrift.Simulation) -> None:
    with pytest.warns(undrift.VerdictWarning, match="^usable with care: the solution covers") as said:
        done = undrift.navigate(short)
    assert done.verdict == "usable with care" and not done.usable
    assert [Path(one.filename) for one in said] == [Path(__file__)]
    with pytest.raises(undrift.VerdictError, match="^usable with care: the solution covers") as raised:
        undrift.navigate(short, strict=True)
    assert raised.value.result == done and isinstance(raised.value, undrift.UndriftError)
    again = pickle.loads(pickle.dumps(raised.value))
    assert str(again) == str(raised.value) and again.result == done


def test_not_usable_raises_or_warns(sim: undrift.Simulation) -> None:
    with pytest.raises(undrift.VerdictError, match="^not usable: GNSS shows .* backwards .*; strict=False returns") as raised:
        backwards(sim)
    with pytest.warns(undrift.VerdictWarning, match="^not usable: GNSS shows"):
        done = backwards(sim, strict=False)
    assert done.verdict == "not usable" and not done.usable and raised.value.result == done


def test_usable_says_nothing() -> None:
    found = undrift.NoiseModel.load("adis16405").simulate(40_000, RATE, seed=2)["gyro_z"]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = undrift.identify(found, axis="gyro_z", rate=RATE, strict=True)
    assert result.usable and result.verdict == "usable"


def test_every_verb_judges(short: undrift.Simulation) -> None:
    with pytest.warns(undrift.VerdictWarning):
        cut = undrift.outages(short, length=5, count=2, start=80, bias_models="arma")
    assert cut.verdict == "usable with care"
    with pytest.raises(undrift.VerdictError) as raised:
        undrift.outages(short, length=5, count=2, start=80, bias_models="arma", strict=True)
    assert raised.value.result == cut
    with pytest.warns(undrift.VerdictWarning, match="too short to hold out outages"):
        tuning = undrift.tune(short, hold_out=0.0)
    assert tuning.verdict == "usable with care" and tuning.table.startswith(tuning.verdict)


@pytest.mark.filterwarnings("ignore::undrift.VerdictWarning")
def test_noise_models_are_compared_in_the_same_outages(sim: undrift.Simulation, tmp_path: Path) -> None:
    undrift.NoiseModel.load("mpu6050").save(tmp_path / "imu.toml")
    plan: dict[str, Any] = {"length": 10, "count": 3, "start": 100}
    both = undrift.outages(sim, models=["adis16405", tmp_path / "imu.toml"], **plan)
    assert list(both.models) == ["adis16405", "imu"]
    for name, model in (("adis16405", "adis16405"), ("imu", tmp_path / "imu.toml")):
        alone = undrift.outages(sim, model=model, bias_models="arma", **plan)
        assert both.models[name] == alone.models["arma"]
    named = undrift.outages(sim, models={"a": "adis16405", "b": tmp_path / "imu.toml"}, bias_models="gauss-markov", **plan)
    assert list(named.models) == ["a", "b"] and named.data["noise_models"]["b"]["bias_model"] == "gauss-markov"
    with pytest.raises(undrift.ArgumentError, match="one bias model, but bias_models has 2"):
        undrift.outages(sim, models=["adis16405"], bias_models=["white", "arma"])
    with pytest.raises(undrift.ArgumentError, match="model and models"):
        undrift.outages(sim, model="adis16405", models=["mpu6050"])
    with pytest.raises(undrift.ArgumentError, match="one model is model="):
        undrift.outages(sim, models="mpu6050")


@pytest.mark.filterwarnings("ignore::undrift.VerdictWarning")
def test_logs_become_a_drive(sim: undrift.Simulation, tmp_path: Path) -> None:
    drive = undrift.inspect(sim.imu, sim.gnss, model="adis16405", vehicle="car")
    assert "[imu] 10000 records at 50 Hz" in drive.description and 'profile = "car"' in drive.toml
    assert np.allclose(drive.gnss.lat, sim.gnss.lat, rtol=1e-15, atol=0.0)
    # The mounting is estimated: the axes may differ, the rates are the same.
    rates = np.linalg.norm(sim.imu.gyro, axis=1)
    assert np.linalg.norm(drive.imu.gyro, axis=1) == pytest.approx(rates, rel=1e-12)
    sim.save(tmp_path)
    files = undrift.inspect(tmp_path / "imu.csv", tmp_path / "gnss.csv")
    assert np.linalg.norm(files.imu.gyro, axis=1) == pytest.approx(rates, abs=1e-6)
    assert files.model is not None and "guessed" in files.toml
    assert len(undrift.navigate(drive).time) > 5000
    with pytest.raises(undrift.UndriftError, match=r"no positions in .*imu.csv: specify their log too"):
        undrift.inspect(tmp_path / "imu.csv")
    with pytest.raises(undrift.UndriftError, match='unknown vehicle "cart"; available: '):
        undrift.inspect(sim.imu, sim.gnss, vehicle="cart")
    with pytest.raises(undrift.ArgumentError, match="neither a file nor a table"):
        undrift.inspect(3)


def test_texts_have_units(sim: undrift.Simulation) -> None:
    assert "lat=[" in repr(sim.truth) and "] rad, " in repr(sim.truth) and "rate=50 Hz" in repr(sim)
    assert "gyro=<array 10000×3> rad/s" in repr(sim.imu)
    parameter = undrift._tune.TunedParameter("gyro N", "rad/s/√Hz", None, 1.0, 0.5, 2.0, 1.5, 1.0, 2.5, True)
    assert "value=1.5 rad/s/√Hz" in repr(parameter) and "start=None," in repr(parameter)


def test_polars_frames(sim: undrift.Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of what polars is given, and what it makes of it where it is installed."""

    class Frame(dict[str, Any]):
        def rename(self, names: dict[str, str]) -> Frame:
            return Frame({names[name]: column for name, column in self.items()})

    stand_in = types.ModuleType("polars")
    stand_in.DataFrame = Frame  # type: ignore[attr-defined]
    frames = [stand_in]
    try:
        import polars

        frames.append(polars)
    except ImportError:
        pass
    for module in frames:
        monkeypatch.setitem(sys.modules, "polars", module)
        frame = sim.imu.to_polars()
        assert np.array_equal(frame["gyro_y"], sim.imu.gyro[:, 1])
        named = sim.imu.to_polars(units=True)
        assert np.array_equal(named["accel_z [m/s^2]"], sim.imu.accel[:, 2])


@pytest.mark.filterwarnings("ignore::undrift.VerdictWarning")
def test_tables_of_a_report(short: undrift.Simulation, tmp_path: Path) -> None:
    cut = undrift.outages(short, length=5, count=2, start=80, bias_models=["white", "arma"])
    cut.report(tmp_path / "t.csv")
    undrift.report([cut], tmp_path / "t.tex")
    rows = [line.split(",") for line in (tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()]
    (row,) = (row for row in rows if row[:2] == ["errors-rms", "arma"])
    found = float(row[rows[0].index("horizontal [m]")])
    # Three digits of it.
    assert found == pytest.approx(cut.models["arma"].rms["horizontal_m"], rel=0.005)
    assert "\\toprule" in (tmp_path / "t.tex").read_text(encoding="utf-8")
    with pytest.raises(undrift.UndriftError, match=r"t.pdf: a report is .html"):
        cut.report(tmp_path / "t.pdf")
