"""The noise model of an IMU."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
from undrift import _toml, _undrift
from undrift._arguments import positive, whole
from undrift._array import Floats
from undrift._result import Result

#: SI units of the keys of a model file, of gyros and accelerometers.
_UNITS = {
    "gyro": {
        "white_noise": "rad/s/sqrt(Hz)",
        "bias_instability": "rad/s",
        "correlation_time": "s",
        "quantisation": "rad",
        "random_walk": "rad/s/sqrt(s)",
        "turn_on": "rad/s",
        "paper_sigma": "rad/s",
    },
    "accel": {
        "white_noise": "m/s^2/sqrt(Hz)",
        "bias_instability": "m/s^2",
        "correlation_time": "s",
        "quantisation": "m/s",
        "random_walk": "m/s^2/sqrt(s)",
        "turn_on": "m/s^2",
        "paper_sigma": "m/s^2",
    },
}


@dataclass(frozen=True, eq=False, repr=False)
class ArmaNoise(Result):
    """``x_t − ar[0] x_{t−1} − … = a_t − ma[0] a_{t−1} − …``, a of standard deviation ``sigma``."""

    _UNITS = {"rate": "Hz"}

    ar: Sequence[float] | Floats
    """Autoregressive coefficients φ."""
    ma: Sequence[float] | Floats
    """Moving-average coefficients θ, of the sign above."""
    sigma: float
    """Standard deviation of the innovations [rad/s] or [m/s²]."""
    rate: float
    """Sample rate that it holds at [Hz]."""


@dataclass(frozen=True, eq=False, repr=False)
class TemperatureEffect(Result):
    """The bias over temperature T: ``slope (T − reference) + quadratic (T − reference)²``; "unit" is rad/s or m/s²."""

    _UNITS = {"reference": "°C", "range": "°C"}

    reference: float
    """Temperature at which the effect is 0 [°C]."""
    range: tuple[float, float]
    """Temperatures that it was estimated between [°C]."""
    slope: float
    """Slope [unit/K]."""
    slope_error: float
    """Its standard error [unit/K]."""
    quadratic: float
    """Quadratic part [unit/K²]; 0 without one."""
    quadratic_error: float
    """Its standard error [unit/K²]; 0 without one."""

    def bias(self, temperature: npt.ArrayLike) -> Floats:
        """The bias at temperatures, less that at the reference.

        Parameters
        ----------
        temperature : array_like, shape (n,)
            Temperatures [°C].

        Returns
        -------
        array, n
            Biases [rad/s] or [m/s²].

        Raises
        ------
        ValueError
            For what is not numbers.
        """
        above = np.asarray(temperature, np.float64) - self.reference
        return np.asarray(above * (self.slope + self.quadratic * above))


@dataclass(frozen=True, eq=False, repr=False)
class AxisNoise(Result):
    """What is known of the random error of one axis; "unit" is rad/s or m/s². ``None``: not known."""

    _UNITS = {"correlation_time": "s"}

    white_noise: float | None
    """Density of the white noise N [unit/√Hz]."""
    bias_instability: tuple[float, ...]
    """Standard deviations of Gauss-Markov processes [unit]."""
    correlation_time: tuple[float, ...]
    """Their correlation times [s]."""
    random_walk: float | None
    """Density of the bias' random walk K [unit/√s]."""
    quantisation: float | None
    """Standard deviation of the rounding of the integrated signal Q [unit·s]."""
    turn_on: float
    """Standard deviation of the constant that changes at every switch-on [unit]."""
    paper_sigma: float | None
    """σ of the bias model ``paper`` [unit]."""
    arma: ArmaNoise | None
    """The whole error without its constant as ARMA."""
    temperature: TemperatureEffect | None = None
    """The bias over temperature, where identification has found one."""


@dataclass(frozen=True, eq=False, repr=False)
class Shaping(Result):
    """The shaping filter of an axis: ``x_{k+1} = F x_k + G w_k``, ``ε_k = H x_k + D w_k``.

    ε is in [rad/s] or [m/s²]; w is white with unit variance, a step is one sample interval.
    """

    _UNITS = {"interval": "s"}

    f: Floats
    """Transition F, n × n."""
    h: Floats
    """Output row H, n."""
    q: Floats
    """Driving covariance G Gᵀ, n × n."""
    s: Floats
    """Cross-covariance G Dᵀ, n."""
    r: float
    """Variance D Dᵀ of one sample."""
    p0: Floats
    """Covariance of the state before the first sample, n × n."""
    interval: float
    """Sample interval [s]."""


class NoiseModel:
    """The noise model of an IMU: six axes in the terms of a data sheet or as ARMA.

    ``NoiseModel.load("adis16405")`` is a preset, ``NoiseModel.load("imu.toml")`` a model file
    (docs/imu-file.md), ``NoiseModel.of(…)`` takes its keys as arguments, and
    ``undrift.identify(…).model()`` finds one in a static record.

    Examples
    --------
    >>> model = undrift.NoiseModel.load("adis16405")
    >>> model.axes["gyro_z"].white_noise > 0.0
    True
    """

    def __init__(self, model: _undrift.NoiseModel) -> None:
        self._model = model

    @classmethod
    def load(cls, name_or_path: str | os.PathLike[str]) -> NoiseModel:
        """A preset by its name, or a model file."""
        return cls(_undrift.NoiseModel.load(name_or_path))

    @classmethod
    def from_toml(cls, text: str, file: str = "<model>") -> NoiseModel:
        """A model file's text; ``file`` is what messages call it."""
        return cls(_undrift.NoiseModel.from_toml(text, file))

    @classmethod
    def of(
        cls,
        name: str = "",
        source: str = "",
        *,
        preset: str | None = None,
        gyro: Mapping[str, Any] | None = None,
        accel: Mapping[str, Any] | None = None,
        **axes: Mapping[str, Any],
    ) -> NoiseModel:
        """A model from the keys of a model file, axis by axis.

        ``gyro`` and ``accel`` hold for their three axes, ``gyro_x`` … ``accel_z`` override them.
        A value is a text with its unit, ``white_noise="0.15 deg/sqrt(h)"``, or a number in SI:
        ``white_noise`` [rad/s/√Hz], [m/s²/√Hz], ``bias_instability`` [rad/s], [m/s²] with
        ``correlation_time`` [s], ``random_walk`` [rad/s/√s], [m/s²/√s], ``quantisation`` [rad],
        [m/s], ``turn_on`` [rad/s], [m/s²]. ``arma`` is a mapping of ``rate``, ``ar``, ``ma``,
        ``sigma``, or an :class:`ArmaNoise`.
        """
        top: dict[str, Any] = {"format": "undrift-imu", "version": 1}
        top.update({"name": name, "source": source})
        if preset is not None:
            top["preset"] = preset
        text = "".join(f"{key} = {_toml.value(item)}\n" for key, item in top.items())
        for axis, keys in {"gyro": gyro, "accel": accel, **axes}.items():
            if keys is not None:
                units = _UNITS["accel" if axis.startswith("accel") else "gyro"]
                text += _toml.table(axis, _stated(keys, units))
        return cls.from_toml(text, "<model>")

    @staticmethod
    def presets() -> list[str]:
        """Names of the presets."""
        return _undrift.NoiseModel.presets()

    @property
    def name(self) -> str:
        """Name of the sensor."""
        return self._model.name

    @property
    def source(self) -> str:
        """Where the numbers come from."""
        return self._model.source

    @property
    def axes(self) -> dict[str, AxisNoise]:
        """The known axes, ``gyro_x`` … ``accel_z``; unknown axes are omitted."""
        return {name: _axis(terms) for name, terms in self._model.axes() if terms is not None}

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the model file."""
        self._model.save(path)

    def to_toml(self) -> str:
        """Text of the model file."""
        return self._model.to_toml()

    def export(self, format: str, rate: float | None = None) -> str:
        """The model as another program reads it (docs/export.md).

        ``format``: ``kalibr``, ``kf-gins``, ``ros``, ``px4``, ``matlab``, ``vins``, ``openvins``, ``basalt``, ``gtsam``, ``ardupilot``, ``gazebo``, ``undrift``.
        ``rate`` [Hz] is the rate of the samples, if not that of the identified record.
        """
        return self._model.export(format, rate)

    def shaping(self, bias_model: str = "arma", rate: float = 100.0) -> dict[str, Shaping]:
        """The matrices that a filter runs at ``rate`` [Hz], of each axis."""
        made = self._model.shaping(bias_model, positive(rate, "rate"))
        names = (name for name, _ in self._model.axes())
        return {name: Shaping(**matrices) for name, matrices in zip(names, made, strict=True)}

    def simulate(
        self, n: int, rate: float, seed: int, bias_model: str = "gauss-markov"
    ) -> dict[str, Floats]:
        """``n`` samples of the error of each axis [rad/s] or [m/s²] at ``rate`` [Hz].

        The turn-on constant is drawn too. One seed gives the same samples everywhere.
        """
        samples = self._model.simulate(
            whole(n, "n"), positive(rate, "rate"), bias_model, whole(seed, "seed")
        )
        names = (name for name, _ in self._model.axes())
        return {
            name: np.ascontiguousarray(column)
            for name, column in zip(names, samples.T, strict=True)
        }

    def __eq__(self, other: object) -> bool:
        """Whether both are written as the same model file."""
        if not isinstance(other, NoiseModel):
            return NotImplemented
        return self.to_toml() == other.to_toml()

    def __hash__(self) -> int:
        return hash(self.to_toml())

    def __copy__(self) -> NoiseModel:
        return self

    def __deepcopy__(self, memo: object) -> NoiseModel:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return NoiseModel.from_toml, (self.to_toml(), self.name)

    def __repr__(self) -> str:
        return f"NoiseModel({self.name!r}, axes={', '.join(self.axes)})"


#: A noise model: a preset's name, a model file, or a model.
ModelLike: TypeAlias = "str | os.PathLike[str] | NoiseModel"


def compiled(model: ModelLike) -> _undrift.NoiseModel:
    """The compiled half of a model."""
    return (model if isinstance(model, NoiseModel) else NoiseModel.load(model))._model


def _axis(terms: dict[str, Any]) -> AxisNoise:
    arma = terms.pop("arma")
    terms["bias_instability"] = tuple(terms["bias_instability"])
    terms["correlation_time"] = tuple(terms["correlation_time"])
    made = None
    if arma is not None:
        ar, ma, sigma, rate = arma
        made = ArmaNoise(tuple(ar), tuple(ma), sigma, rate)
    effect = terms.pop("temperature")
    found = None
    if effect is not None:
        reference, within, slope, quadratic = effect
        found = TemperatureEffect(reference, within, *slope, *quadratic)
    return AxisNoise(**terms, arma=made, temperature=found)


def _stated(keys: Mapping[str, Any], units: Mapping[str, str]) -> dict[str, Any]:
    """The keys with the units of numbers in SI."""
    stated: dict[str, Any] = {}
    for key, item in keys.items():
        if key == "arma" and isinstance(item, ArmaNoise):
            item = {"rate": item.rate, "ar": item.ar, "ma": item.ma, "sigma": item.sigma}
        if key == "arma" and isinstance(item, Mapping):
            item = _stated(item, {"rate": "Hz", "sigma": units["turn_on"]})
        elif key in units:
            several = isinstance(item, (list, tuple, np.ndarray))
            item = [_with_unit(one, units[key]) for one in (item if several else [item])]
            item = item if several else item[0]
        stated[key] = item
    return stated


def _with_unit(item: Any, unit: str) -> Any:
    """A number, or a fitted term that is one, with its unit."""
    return f"{float(item)!r} {unit}" if hasattr(item, "__float__") else item
