"""identify: the terminal's numbers, of files and of arrays."""

from __future__ import annotations

import copy
import json
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undrift

RATE = 50.0


@pytest.fixture(scope="module")
def noise() -> dict[str, Any]:
    model = undrift.NoiseModel.load("adis16405")
    record = model.simulate(4_000, RATE, seed=2)
    record["accel_z"] = record["accel_z"] - 9.80665
    return record


@pytest.fixture(scope="module")
def found(noise: dict[str, Any]) -> undrift.Identified:
    return undrift.identify({f"{name}": column for name, column in noise.items()}, rate=RATE,
                            units="rad/s,m/s^2")


def test_identify_is_the_terminals(
    noise: dict[str, Any], found: undrift.Identified, tmp_path: Path, terminal: Callable[..., Any]
) -> None:
    path, model = tmp_path / "static.csv", tmp_path / "imu.toml"
    np.savetxt(path, np.column_stack(list(noise.values())), delimiter=",", fmt="%.17g",
               header=",".join(noise), comments="")
    done = terminal("identify", path, "--rate", RATE, "--units", "rad/s,m/s^2", "-o", model,
                    "--json", "-")
    printed = json.loads(done.stdout)
    of_file = undrift.identify(path, rate=RATE, units="rad/s,m/s^2")
    assert json.loads(of_file.json) == printed
    printed["record"] = "<record>"
    assert json.loads(found.json) == printed
    assert of_file.model().to_toml() == model.read_text()
    bare = undrift.identify(np.column_stack(list(noise.values())), rate=RATE)
    assert bare.data["axes"] == printed["axes"]


def test_what_was_found_has_names(found: undrift.Identified) -> None:
    axis = found.axes["gyro_z"]
    printed = found.data["axes"]["gyro_z"]
    assert [c.name for c in axis.candidates] == printed["ranking"]
    assert found.recommended["gyro_z"] == axis.recommended.name == printed["chosen"]["name"]
    assert axis.adev.tolist() == printed["allan"]["adev"] and axis.tests["adf"] == printed["adf"]
    assert list(found.axes) == ["gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"]
    assert found.verdict == "usable"
    assert axis.reason and axis.stationarity and not found.failed
    assert "gyro_z" in repr(found) and "<table>" in found._repr_html_()
    model = found.model(base="adis16405")
    assert model.axes["gyro_x"].turn_on == undrift.NoiseModel.load("adis16405").axes["gyro_x"].turn_on
    model.shaping("arma", RATE)


def test_tables_and_figures(found: undrift.Identified, tmp_path: Path) -> None:
    found.report(tmp_path / "identify.html")
    assert "<html" in (tmp_path / "identify.html").read_text()
    pytest.importorskip("pandas")
    assert list(found.to_pandas()["axis"]) == list(found.axes)
    assert len(found.axes["gyro_x"].to_pandas()) == len(found.axes["gyro_x"].candidates)
    pytest.importorskip("matplotlib").use("Agg")
    assert found.plot().lines and found.axes["accel_x"].plot().lines


def test_one_axis_with_stamps_and_a_unit_in_its_name(noise: dict[str, Any]) -> None:
    table = {"t_s": np.arange(4_000) / RATE, "gz_dps": np.degrees(noise["gyro_z"])}
    found = undrift.identify(table)
    assert list(found.axes) == ["gyro_z"] and found.rate == pytest.approx(RATE, rel=1e-9)
    alone = undrift.identify(noise["gyro_z"], axis="gyro_z", rate=RATE)
    # Degrees and back round twice.
    assert alone.axes["gyro_z"].adev == pytest.approx(found.axes["gyro_z"].adev, rel=1e-9)


def test_what_is_wrong_is_said(noise: dict[str, Any]) -> None:
    with pytest.raises(undrift.UndriftError, match="<record>: the recording has no time column"):
        undrift.identify(noise["gyro_z"], axis="gyro_z")
    with pytest.raises(TypeError, match="specify the axis"):
        undrift.identify(noise["gyro_z"], rate=RATE)
    with pytest.raises(undrift.UndriftError, match="<record>: the header does not identify the columns of the six axes"):
        undrift.identify({"u": noise["gyro_z"]}, rate=RATE)
    with pytest.raises(undrift.UndriftError, match="no axis could be identified"):
        undrift.identify(np.zeros(5000), axis="gyro_z", rate=RATE)
    with pytest.raises(undrift.UndriftError, match="nowhere.csv: no such file"):
        undrift.identify("nowhere.csv")


def test_results_pickle_and_copy(found: undrift.Identified) -> None:
    again = pickle.loads(pickle.dumps(found))
    assert again.json == found.json and again.recommended == found.recommended
    assert again.model() == found.model()
    model = found.model()
    assert copy.deepcopy(model) is model
    unpickled = pickle.loads(pickle.dumps(model)).shaping("white", RATE)
    for name, shaping in model.shaping("white", RATE).items():
        # By way of the model file, whose numbers have six significant digits; r is a square of such.
        assert unpickled[name].r == pytest.approx(shaping.r, rel=1.1e-5)


def test_what_is_no_static_recording_is_refused(noise: dict[str, Any]) -> None:
    in_g = {**noise, "accel_z": noise["accel_z"] / 9.80665}
    with pytest.raises(undrift.UndriftError, match="specific force is .* not 9.81.*force=True"):
        undrift.identify(in_g, rate=RATE, units="rad/s,m/s^2")
    forced = undrift.identify(in_g, rate=RATE, units="rad/s,m/s^2", force=True)
    assert any("specific force" in warning for warning in forced.warnings)
    # The errors alone, as a model simulates them, have no gravity.
    alone = undrift.NoiseModel.load("adis16405").simulate(4_000, RATE, seed=3)
    undrift.identify(alone, rate=RATE, units="rad/s,m/s^2", force=True)
