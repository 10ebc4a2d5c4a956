"""tune: the terminal's numbers, as objects, and a model that navigates."""

from __future__ import annotations

import dataclasses
import json
import math
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undrift

Run = Callable[..., Any]


def simulated(seed: int) -> undrift.Simulation:
    """Three minutes of a car, after its minute at rest."""
    receiver = undrift.GnssReceiver(rate=1.0, lever_arm=(0.3, 0.1, -1.2))
    return undrift.simulate("car", 240.0, 50.0, "mpu6050", gnss=receiver, seed=seed)


@pytest.fixture(scope="module")
def simulation() -> undrift.Simulation:
    return simulated(4)


@pytest.fixture(scope="module")
def saved(simulation: undrift.Simulation, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return simulation.save(tmp_path_factory.mktemp("drive"))


@pytest.fixture(scope="module")
def tuning(saved: Path) -> undrift.Tuning:
    return undrift.tune(saved, strict=False)


def test_types(tuning: undrift.Tuning) -> None:
    assert isinstance(tuning, undrift.Tuning) and isinstance(tuning.model, undrift.NoiseModel)
    assert isinstance(tuning.converged, bool)
    assert tuning.held_out is False and tuning.unseen == 0.5 and tuning.guessed is False
    assert tuning.start == undrift.NoiseModel.load("mpu6050").name
    assert isinstance(tuning.windows, int) and tuning.windows > 0
    assert isinstance(tuning.evaluations, int) and tuning.evaluations > 0
    assert all(isinstance(warning, str) for warning in tuning.warnings)
    assert all(isinstance(one, undrift.TunedParameter) for one in tuning.parameters)
    assert all(isinstance(one, undrift.TunedDrift) for one in tuning.drift)
    assert tuning.parameters and tuning.drift
    with pytest.raises(dataclasses.FrozenInstanceError):
        tuning.parameters[0].value = 1.0  # type: ignore[misc]
    for drift in tuning.drift:
        assert isinstance(drift.outages, int) and drift.outages > 1
        assert drift.ratio == pytest.approx(drift.after_m / drift.before_m)
        assert drift.ratio_low is not None and drift.ratio_high is not None
        assert drift.ratio_low <= drift.ratio_high
        assert len(drift.before_within) == len(drift.after_within) == 3


def test_values_lie_where_they_may(tuning: undrift.Tuning) -> None:
    names = [parameter.name for parameter in tuning.parameters]
    assert len(set(names)) == len(names)
    assert {"gyro_z.white_noise", "accel_x.random_walk"} <= set(names)
    for parameter in tuning.parameters:
        name = parameter.name
        assert isinstance(name, str) and isinstance(parameter.unit, str)
        assert isinstance(parameter.determined, bool), name
        assert parameter.start is None or parameter.start > 0.0, name
        assert 0.0 < parameter.prior_low <= parameter.prior <= parameter.prior_high, name
        assert parameter.prior_low / 10 < parameter.value < 10 * parameter.prior_high, name
        assert 0.0 < parameter.low <= parameter.value <= parameter.high < math.inf, name


def test_fields_are_the_json(tuning: undrift.Tuning) -> None:
    stored = tuning.data
    assert stored["kind"] == "tune"
    for field in ("start", "guessed", "unseen", "held_out", "converged", "windows", "evaluations"):
        assert getattr(tuning, field) == stored[field], field
    assert [dataclasses.asdict(parameter) for parameter in tuning.parameters] == stored["parameters"]
    for drift, of_json in zip(tuning.drift, stored["drift"], strict=True):
        assert json.loads(json.dumps(dataclasses.asdict(drift))) == of_json


def test_tune_is_the_terminals(tuning: undrift.Tuning, saved: Path, terminal: Run) -> None:
    model = saved.with_name("vehicle.toml")
    done = terminal("tune", saved, "--json", "-", "--model-out", model)
    assert done.returncode in (0, 3), done.stderr
    assert tuning.json == done.stdout.rstrip("\n")
    assert tuning.model.to_toml() == model.read_text(encoding="utf-8")


def test_the_model_navigates(tuning: undrift.Tuning, simulation: undrift.Simulation) -> None:
    white = {p.name: p.value for p in tuning.parameters if p.name.endswith(".white_noise")}
    axes = tuning.model.axes
    assert axes["gyro_z"].white_noise == pytest.approx(white["gyro_z.white_noise"])
    assert axes["accel_x"].white_noise == pytest.approx(white["accel_x.white_noise"])
    done = undrift.navigate(simulation, model=tuning.model)
    assert done.rmse is not None and done.diverged is None
    assert done.rmse != undrift.navigate(simulation).rmse
    assert "in its vehicle" in tuning.model.name


def test_several_drives_and_a_share_held_out(simulation: undrift.Simulation, saved: Path) -> None:
    both = undrift.tune([saved, simulated(5)], model="mpu6050", hold_out=0.5)
    assert both.held_out is True and both.unseen == 0.5
    assert len(both.data["drives"]) == 2
    assert "drive.toml, <simulation>" in both.model.source
    one = undrift.tune(simulation.drive(), hold_out=0.0)
    assert one.held_out is True and one.unseen == 0.0 and one.drift == ()
    assert one.windows > 0 and one.parameters


@pytest.mark.parametrize("share", [1.5, -0.1, math.nan])
def test_a_share_that_is_none_is_refused(saved: Path, share: float) -> None:
    with pytest.raises(ValueError, match=r"hold_out .*: must be 0 to 0\.9, a share of each drive"):
        undrift.tune(saved, hold_out=share)


def test_arguments_that_do_not_fit_are_refused(
    simulation: undrift.Simulation, saved: Path, tmp_path: Path
) -> None:
    with pytest.raises(undrift.UndriftError, match="no drive specified"):
        undrift.tune([])
    with pytest.raises(undrift.UndriftError, match="data has 2 folders for 1 drives"):
        undrift.tune(saved, data=[tmp_path, tmp_path])
    with pytest.raises(TypeError, match="gnss goes with the IMU log of one drive"):
        undrift.tune([saved], "gnss.csv")
    with pytest.raises(TypeError, match="rate: needs logs"):
        undrift.tune(saved, rate=50.0)
    with pytest.raises(TypeError, match="a NoiseModel"):
        undrift.tune(saved, model={"preset": "mpu6050"})
    with pytest.raises(TypeError):
        undrift.tune(saved, hold_out="half")  # type: ignore[arg-type]


def test_it_becomes_a_table_a_report_and_a_copy(tuning: undrift.Tuning, tmp_path: Path) -> None:
    assert "<table>" in tuning._repr_html_() and "gyro_z.white_noise" in tuning.table
    text = repr(tuning)
    assert text.startswith("Tuning(") and "json" not in text and len(text) < 600
    assert f"<{len(tuning.parameters)} TunedParameter>" in text
    tuning.report(tmp_path / "tune.html")
    assert "<html" in (tmp_path / "tune.html").read_text(encoding="utf-8")
    undrift.report([tuning], figures=tmp_path / "figures")
    assert list((tmp_path / "figures").glob("*.svg"))
    copy = pickle.loads(pickle.dumps(tuning))
    assert copy.json == tuning.json and copy.model.name == tuning.model.name
    pytest.importorskip("pandas")
    frame = tuning.to_pandas()
    assert list(frame["value"]) == [parameter.value for parameter in tuning.parameters]
    assert np.array_equal(frame["determined"], [p.determined for p in tuning.parameters])


def test_what_was_found_goes_into_a_drive_by_its_keys(simulation: undrift.Simulation) -> None:
    """The keys that ``undrift tune --output`` writes, as numbers."""
    logs = {table: {"file": dict(log[0]), **log[1]} for table, log in simulation._logs(False).items()}
    factors = {"position": 0.9, "position_correlated": 1.1}
    drive = undrift.Drive(
        logs["imu"],
        {**logs["gnss"], "std_factors": factors},
        "mpu6050",
        vehicle={"profile": "car", "non_holonomic": 0.1, "non_holonomic_down": 0.05, "side_slip": 0.01},
    )
    assert 'side_slip = "0.01 s"' in drive.toml
    assert 'non_holonomic_down = "0.05 m/s"' in drive.toml
    assert len(undrift.navigate(drive)) > 0
