"""Results to look at: short texts, tables, figures, equality, copies."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undrift

RATE = 50.0


@pytest.fixture(scope="module")
def sim() -> undrift.Simulation:
    return undrift.simulate("car", 260.0, RATE, seed=2)


@pytest.fixture(scope="module")
def cut(sim: undrift.Simulation) -> undrift.Outages:
    return undrift.outages(sim, length=10, count=3, start=80, bias_models=["white", "gauss-markov", "arma"])


@pytest.fixture(scope="module")
def curve() -> undrift.statistics.AllanDeviation:
    return undrift.allan(undrift.arma.simulate(50_000, [0.9995], [0.996], 0.006, seed=1), 100.0)


def test_a_result_in_a_result_is_short(sim: undrift.Simulation, cut: undrift.Outages) -> None:
    assert "imu=ImuLog(13000 rows)" in repr(sim) and len(repr(sim)) < 400
    assert "models={white, gauss-markov, arma}" in repr(cut) and len(repr(cut)) < 600


def test_each_outage_is_a_row(cut: undrift.Outages) -> None:
    pytest.importorskip("pandas")
    each = cut.to_pandas("each")
    assert len(each) == 9 and list(each["model"][:3]) == ["white"] * 3
    assert list(each.columns[:7]) == ["model", "start_s", "length_s", "north_m", "east_m", "down_m", "horizontal_m"]
    of_arma = each[each["model"] == "arma"]
    rms = np.sqrt(np.nanmean(of_arma["north_m"] ** 2))
    assert rms == pytest.approx(cut.models["arma"].rms["north_m"], rel=1e-12)
    assert list(of_arma["start_s"]) == cut.cuts[:, 0].tolist()
    components = ["north_m", "east_m", "down_m", "horizontal_m", "vn_mps", "ve_mps", "vd_mps",
                  "roll_deg", "pitch_deg", "yaw_deg"]
    assert list(cut.to_pandas().columns) == ["model", "statistic", *components]
    assert list(cut.models["arma"].max) == components
    with pytest.raises(undrift.UndriftError, match='"statistics" or "each"'):
        cut.to_pandas("all")  # type: ignore[arg-type]


def test_figures_have_labels_and_units(cut: undrift.Outages, curve: Any, sim: undrift.Simulation) -> None:
    pytest.importorskip("matplotlib").use("Agg")
    # White noise alone drifts more than ten times as far as a model of the bias.
    ax = cut.plot(label="car", unit="km")
    assert ax.get_yscale() == "log" and ax.get_ylabel() == "horizontal error, RMS [km]"
    assert [line.get_label() for line in ax.lines] == ["car, white", "car, gauss-markov", "car, arma"]
    expected = cut.models["arma"].mean_drift.horizontal / 1000.0
    assert ax.lines[2].get_ydata() == pytest.approx(expected, rel=1e-12)
    alike = undrift.outages(sim, length=10, count=2, start=80, bias_models=["gauss-markov", "arma"]).plot()
    assert alike.get_yscale() == "linear"
    ax = curve.plot(label="gyro z", unit="deg/h")
    assert ax.get_ylabel() == "deviation [deg/h]" and ax.lines[0].get_label() == "gyro z"
    assert ax.lines[0].get_ydata() == pytest.approx(np.degrees(curve.deviation) * 3600.0)
    curve.plot(ax, label="again", unit="deg/h")
    assert undrift.psd(np.arange(1000.0) % 7, RATE).plot(unit="mg", label="x").get_ylabel() == "density [(mg)²/Hz]"
    assert undrift.acf(np.arange(1000.0) % 7).plot(label="x").lines
    assert sim.plot(unit="km", label="truth").get_xlabel() == "east [km]"
    with pytest.raises(undrift.UndriftError, match="unknown unit 'furlong'; available: rad/s"):
        curve.plot(unit="furlong")


def test_a_fit_outside_of_its_band_is_marked(curve: Any) -> None:
    outside = curve.outside
    fit = curve.terms.deviation(curve.tau)
    fitted = curve.tau >= curve.terms.shortest_tau
    assert np.array_equal(outside, fitted & ((fit < curve.lower) | (fit > curve.upper)))
    # No term models a sine: the residual is large.
    x = np.random.Generator(np.random.PCG64(1)).standard_normal(20_000)
    sine = undrift.allan(x + 3.0 * np.sin(np.arange(20_000) / 100.0), 100.0)
    assert sine.outside.sum() >= 3
    pytest.importorskip("matplotlib").use("Agg")
    marked = [line for line in sine.plot().lines if line.get_label() == "fit outside of the band"]
    assert len(marked[0].get_xdata()) == sine.outside.sum()
    with pytest.raises(undrift.UndriftError, match="without intervals"):
        undrift.allan(x, 100.0, confidence=None).outside


def test_terms_and_likelihoods_are_numbers(curve: Any) -> None:
    term = curve.terms.N
    value = term.value
    assert (term + 1, 1 + term, term - 1, 1 - term) == (value + 1, 1 + value, value - 1, 1 - value)
    assert (2 * term, term * 2, term / 2, 1 / term) == (2 * value, value * 2, value / 2, 1 / value)
    assert (term**2, -term, abs(term)) == (value**2, -value, value)
    assert 0 < term < 1 and term <= value <= term and term == value and term != value + 1
    assert f"{term:.3e}" == f"{value:.3e}" and f"{term}" == str(term) and "±" in str(term)
    assert term == copy.copy(term) and term != curve.terms.K and len({term, value}) == 1
    assert np.sqrt(float(term)) == np.float64(value) ** 0.5
    x = np.random.Generator(np.random.PCG64(1)).standard_normal(500)
    near, far = (undrift.arma.log_likelihood(x, [phi], []) for phi in (0.0, 0.9))
    assert near > far and near - far > 10.0 and f"{near:.1f}" == f"{near.log_likelihood:.1f}"


def test_arrays_of_results_cannot_be_written_to(curve: Any, sim: undrift.Simulation) -> None:
    for array in (curve.tau, sim.imu.gyro, pickle.loads(pickle.dumps(sim.imu)).gyro, copy.copy(sim.truth).lat):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0
    # What was handed in stays its owner's.
    own = np.zeros((3, 3))
    undrift.ImuLog(np.arange(3.0), own, own)
    own[0] = 1.0


def test_equal_results(curve: Any, sim: undrift.Simulation) -> None:
    again = pickle.loads(pickle.dumps(curve))
    assert again == curve and copy.deepcopy(curve) == curve and hash(again) == hash(curve)
    assert curve != undrift.allan(np.arange(100.0) % 7, 100.0) and curve != 3
    assert sim.imu == undrift.simulate("car", 260.0, RATE, seed=2).imu
    assert sim.imu != undrift.simulate("car", 260.0, RATE, seed=3).imu
    # Standard errors of terms that are 0 are NaN, as those of the copy.
    assert curve.terms == again.terms


def test_models_compare_copy_and_pickle() -> None:
    model = undrift.NoiseModel.load("adis16405")
    assert model == undrift.NoiseModel.load("adis16405") and hash(model) == hash(copy.copy(model))
    assert pickle.loads(pickle.dumps(model)) == model
    assert model != undrift.NoiseModel.load("mpu6050") and model != "adis16405"


def test_an_unpickled_identification_has_its_model() -> None:
    x = undrift.NoiseModel.load("adis16405").simulate(4_000, RATE, seed=2)["gyro_z"]
    found = undrift.identify(x, axis="gyro_z", rate=RATE)
    again = pickle.loads(pickle.dumps(found))
    assert again == found and again.model() == found.model()
    twice = pickle.loads(pickle.dumps(again))
    assert twice.model() == found.model()
    with pytest.raises(undrift.UndriftError, match="before it is pickled"):
        again.model(base="adis16405")


def test_a_copied_filter_goes_its_own_way() -> None:
    filter = undrift.Filter("adis16405", rate=RATE, position=(0.5, 0.1, 0.0), parameters={"accel_scale": 1e-3})
    filter.begin((0.01, 0.0, 0.0), (0.1, 0.0, -9.8))
    filter.advance(0.01)
    for made in (copy.copy(filter), copy.deepcopy(filter), pickle.loads(pickle.dumps(filter))):
        assert made.state == filter.state and np.array_equal(made.covariance, filter.covariance)
        made.advance()
        made.update_zero_velocity()
        assert made.time == 0.02 and filter.time == 0.01 and filter.innovation is None
        other = copy.copy(filter)
        other.advance()
        other.update_zero_velocity()
        assert np.array_equal(made.covariance, other.covariance)


def test_a_pickled_filter_of_a_drive_goes_on(sim: undrift.Simulation) -> None:
    filter = undrift.Filter.from_drive(sim.drive())
    again = pickle.loads(pickle.dumps(filter))
    for k in range(4000, 4100):
        for one in (filter, again):
            one.predict(sim.imu.gyro[k], sim.imu.accel[k])
    for one in (filter, again):
        one.update_gnss(**sim.gnss.fix(60))
    assert again.state == filter.state and np.array_equal(again.covariance, filter.covariance)
    with pytest.raises(undrift.UndriftError, match="not the numbers of a filter"):
        undrift._undrift.Filter.from_numbers([0.0] * 100)


def test_the_effect_of_temperature_stands_in_the_model(tmp_path: Path) -> None:
    text = undrift.NoiseModel.of(gyro={"white_noise": "0.01 deg/s/sqrt(Hz)"}).to_toml()
    text += '\n[gyro_x.temperature]\nreference = "25 degC"\nlowest = "10 degC"\nhighest = "40 degC"\n'
    text += 'slope = "0.001 rad/s/K"\nslope_sigma = "0.0001 rad/s/K"\n'
    axes = undrift.NoiseModel.from_toml(text).axes
    effect = axes["gyro_x"].temperature
    assert effect is not None and axes["gyro_y"].temperature is None
    assert (effect.reference, effect.range, effect.quadratic) == (25.0, (10.0, 40.0), 0.0)
    assert (effect.slope, effect.slope_error) == pytest.approx((0.001, 0.0001))
    assert effect.bias([25.0, 35.0]) == pytest.approx([0.0, 0.01])
