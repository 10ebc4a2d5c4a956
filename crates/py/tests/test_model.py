"""NoiseModel: files, presets, numbers, exports, shaping filters, samples."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undrift
from undrift import NoiseModel


@pytest.mark.parametrize("name", NoiseModel.presets())
def test_presets_save_and_export_as_the_terminal(
    name: str, tmp_path: Path, terminal: Callable[..., Any]
) -> None:
    model = NoiseModel.load(name)
    path = tmp_path / "imu.toml"
    model.save(path)
    assert NoiseModel.load(path).to_toml() == model.to_toml()
    for format in ("kalibr", "kf-gins", "ros", "px4", "matlab", "vins", "openvins", "basalt", "gtsam", "ardupilot", "gazebo"):
        printed = terminal("model", name, "--to", format, "--rate", 200).stdout
        assert model.export(format, 200.0).rstrip() == printed.rstrip()
    assert set(model.axes) == {"gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"}


def test_numbers_in_si_and_texts_with_units_are_the_same_model() -> None:
    deg, hour = np.pi / 180.0, 3600.0
    texts = NoiseModel.of(
        "one",
        gyro={
            "white_noise": "0.15 deg/sqrt(h)",
            "bias_instability": ["2 deg/h", "9 deg/h"],
            "correlation_time": ["100 s", "1 h"],
        },
        gyro_z={"white_noise": "0.1 deg/sqrt(h)"},
        accel={"white_noise": "0.02 m/s/sqrt(h)", "turn_on": "1 mg", "random_walk": "0.05 mg/sqrt(s)"},
    )
    numbers = NoiseModel.of(
        "one",
        gyro={
            "white_noise": 0.15 * deg / 60.0,
            "bias_instability": (2 * deg / hour, 9 * deg / hour),
            "correlation_time": np.array([100.0, hour]),
        },
        gyro_z={"white_noise": 0.1 * deg / 60.0},
        accel={"white_noise": 0.02 / 60.0, "turn_on": 9.80665e-3, "random_walk": 0.05 * 9.80665e-3},
    )
    for name, axis in texts.axes.items():
        other = numbers.axes[name]
        # A unit's factor and the product round once each.
        for key in ("white_noise", "turn_on", "random_walk"):
            ours, theirs = getattr(axis, key), getattr(other, key)
            assert ours == theirs or ours == pytest.approx(theirs, rel=4e-16), key
        assert axis.bias_instability == pytest.approx(other.bias_instability, rel=4e-16)
        assert axis.correlation_time == other.correlation_time
    assert texts.axes["gyro_z"].white_noise < texts.axes["gyro_x"].white_noise


def test_an_arma_is_its_matrices() -> None:
    arma = undrift.ArmaNoise((0.9, -0.2), (0.5,), 0.01, 100.0)
    model = NoiseModel.of(gyro={"arma": arma}, accel={"white_noise": 1e-3})
    assert model.axes["gyro_x"].arma.ar == (0.9, -0.2)
    made = model.shaping("arma", 100.0)["gyro_x"]
    assert np.array_equal(made.f, [[0.9, 1.0], [-0.2, 0.0]])
    assert np.array_equal(made.h, [1.0, 0.0])
    g = np.array([0.9 - 0.5, -0.2]) * 0.01
    # The products are formed in another order there.
    assert made.q == pytest.approx(np.outer(g, g), rel=1e-15)
    assert made.s == pytest.approx(g * 0.01, rel=1e-15)
    assert made.r == pytest.approx(1e-4, rel=1e-15) and made.interval == 0.01
    # Stationary: P = F P F' + Q.
    assert made.p0 == pytest.approx(made.f @ made.p0 @ made.f.T + made.q, rel=1e-12)
    accel = model.shaping("white", 100.0)["accel_x"]
    assert accel.f.shape == (0, 0) and accel.r == pytest.approx(1e-6 * 100.0, rel=1e-15)


def test_fits_of_the_package_are_numbers_of_a_model() -> None:
    noise = NoiseModel.of(gyro={"white_noise": 1e-3}, accel={"white_noise": 1e-3})
    x = noise.simulate(20_000, 100.0, seed=5)["gyro_x"]
    terms = undrift.allan(x, 100.0).terms
    fit = undrift.arma.fit(x[:2000], (1, 1), effort=0.1)
    arma = undrift.ArmaNoise(fit.ar, fit.ma, fit.sigma, 100.0)
    model = NoiseModel.of(gyro={"white_noise": terms.N}, accel={"arma": arma})
    assert model.axes["gyro_x"].white_noise == float(terms.N)
    assert model.axes["accel_x"].arma.ar == tuple(fit.ar)


def test_samples_have_the_variance_and_the_seed() -> None:
    model = NoiseModel.of(gyro={"white_noise": 1e-3}, accel={"white_noise": 2e-3, "turn_on": 0.5})
    noise = model.simulate(20_000, 100.0, seed=3)
    # Variance N²/T; the standard error of a standard deviation is 1/sqrt(2 n) = 0.5 %, 4 of those.
    assert noise["gyro_x"].std() == pytest.approx(1e-2, rel=0.02)
    assert noise["accel_x"].std() == pytest.approx(2e-2, rel=0.02)
    assert abs(noise["accel_x"].mean()) > 0.01
    again = model.simulate(20_000, 100.0, seed=3)
    assert all(np.array_equal(noise[name], again[name]) for name in noise)
    assert not np.array_equal(noise["gyro_x"], noise["gyro_y"])


def test_what_is_wrong_is_said(tmp_path: Path) -> None:
    with pytest.raises(undrift.UndriftError, match=r"a model is a file or a preset; NoiseModel.presets\(\)"):
        NoiseModel.load("nothing")
    with pytest.raises(undrift.UndriftError, match="<model> line .*gyro.white_noise.*expected an angle random walk"):
        NoiseModel.of(gyro={"white_noise": "1 m"}, accel={"white_noise": 1.0})
    with pytest.raises(undrift.UndriftError, match="accel_x: no noise model"):
        NoiseModel.of(gyro={"white_noise": 1e-3}).shaping()
    with pytest.raises(undrift.UndriftError, match="rate: must be above 0"):
        NoiseModel.load("mpu6050").shaping("white", 0.0)
    with pytest.raises(undrift.UndriftError, match="unknown format"):
        NoiseModel.load("mpu6050").export("paper")


def test_the_model_is_the_terminals(terminal_json: Callable[..., Any]) -> None:
    import sys

    if sys.version_info < (3, 11):
        pytest.skip("no reader of TOML")
    import tomllib

    of_terminal = terminal_json("model", "icm20602")
    assert json.loads(json.dumps(tomllib.loads(NoiseModel.load("icm20602").to_toml()))) == of_terminal
