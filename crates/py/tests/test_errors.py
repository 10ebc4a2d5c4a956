"""One family of exceptions, in Python's words."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import undrift

X = np.random.Generator(np.random.PCG64(1)).standard_normal(500)


@pytest.mark.parametrize(
    ("call", "problem"),
    [
        (lambda: undrift.identify(X, axis="gyro_z"), r"set its sample rate \(rate, or"),
        (lambda: undrift.identify({"u": X}, rate=50.0), "specify them with columns=gx,gy,gz,ax,ay,az"),
        (lambda: undrift.identify({"gyro_z": X}, rate=50.0), 'set units="?, for instance|set units, for instance'),
        (lambda: undrift.identify(X, axis="gyro_z", rate=50.0, columns=[1.5]), "columns: a whole number is needed"),
        (lambda: undrift.NoiseModel.load("nothing"), r"NoiseModel.presets\(\)"),
        (lambda: undrift.NoiseModel.load("adis16405").export("matlab"), "set rate"),
        (lambda: undrift.navigate(undrift.simulate("rest", 60.0, 50.0, None)), "specify one with model or"),
        (lambda: undrift.adf(X, lags=2.5), "lags: a whole number is needed, not a float"),
        (lambda: undrift.kpss(X, lags=None), "lags: a whole number is needed, not a NoneType"),
        (lambda: undrift.acf(X, lags=-1), "lags: must not be negative"),
        (lambda: undrift.acf(X, lags="ten"), "lags: a whole number is needed, not 'ten'"),
        (lambda: undrift.ljung_box(X, [5, 2.5]), "lags: a whole number is needed"),
        (lambda: undrift.allan(X, "100"), "rate: a number is needed, not '100'"),
        (lambda: undrift.allan(X, -1.0), "rate: must be above 0, not -1"),
        (lambda: undrift.allan(X, 1.0, taus=object()), "taus is not an array of numbers"),
        (lambda: undrift.allan(X.reshape(50, 10), 1.0), "has 2 dimensions"),
        (lambda: undrift.psd(X, 0.0), "rate: must be above 0"),
        (lambda: undrift.arma.fit(X, 2), r"order: two whole numbers are needed, \(p, q\)"),
        (lambda: undrift.arma.fit(X, (1.5, 1)), "order: a whole number is needed"),
        (lambda: undrift.arma.simulate(-3, [], [], 1.0), "n: must not be negative"),
        (lambda: undrift.arma.simulate(3, [], [], "1"), "sigma: a number is needed"),
        (lambda: undrift.simulate("car", "long"), "duration: a number is needed, not 'long'"),
        (lambda: undrift.simulate("car", seed=1.5), "seed: a whole number is needed"),
        (lambda: undrift.NoiseModel.load("adis16405").simulate(10, None, 1), "rate: a number is needed"),
        (lambda: undrift.navigate(3), "is no drive"),
    ],
)
def test_every_exception_is_an_undrift_error(call: Callable[[], Any], problem: str) -> None:
    with pytest.raises(undrift.UndriftError, match=problem) as raised:
        call()
    text = str(raised.value)
    assert " --" not in text and "(--" not in text and "failed to extract" not in text
    assert isinstance(raised.value, ValueError)


def test_a_wrong_type_is_a_type_error_too() -> None:
    with pytest.raises(TypeError) as raised:
        undrift.acf(X, lags="ten")  # type: ignore[arg-type]
    assert type(raised.value) is undrift.ArgumentError


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("set --units, for instance \"deg/s,g\"", "set units, for instance \"deg/s,g\""),
        ("--start 60: reduce --start", "start=60: reduce start"),
        ("give --units \"g\" (--rate)", "give units=\"g\" (rate)"),
        ("--bias-model arma", "bias_model arma"),
        ("a -- b, 3--4, --", "a -- b, 3--4, --"),
        ("no options, ° and µ", "no options, ° and µ"),
    ],
)
def test_options_become_arguments(text: str, expected: str) -> None:
    assert undrift._undrift.in_python(text) == expected
