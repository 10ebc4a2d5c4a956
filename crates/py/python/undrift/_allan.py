"""Allan deviation, the noise terms read from it, and the wavelet variance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt
from undrift import _undrift
from undrift._arguments import positive
from undrift._array import Floats, Ints, record
from undrift._number import Number
from undrift._result import Result, axes
from undrift._units import factor, label_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Kind = Literal["overlapping", "modified", "hadamard", "total"]
Grid = Literal["octave", "decade", "all"]


@dataclass(frozen=True, eq=False, repr=False)
class AllanTerm(Number, Result):
    """One noise term of an Allan deviation; a ``float`` where one is asked for."""

    value: float
    """The term; 0 where the fit leaves it out."""
    standard_error: float
    """Its standard error; NaN where the term is 0."""
    upper_95: float
    """One-sided 95 % upper bound."""
    seen: bool
    """The square of the term is more than two standard errors from 0."""

    def __float__(self) -> float:
        return self.value

    def __repr__(self) -> str:
        return f"{self.value:.6g} ± {self.standard_error:.2g}{'' if self.seen else ' (not detected)'}"


@dataclass(frozen=True, eq=False, repr=False)
class AllanTerms(Result):
    """Noise terms of IEEE Std 952, u the unit of the samples (rad/s, m/s²).

    ``σ²(τ) = 3Q²/τ² + N²/τ + (2 ln 2/π) B² + K² τ/3 + R² τ²/2``
    """

    _UNITS = {"shortest_tau": "s"}

    quantisation: AllanTerm
    """Quantisation Q [u·s]."""
    white: AllanTerm
    """White noise N [u·√s = u/√Hz]: angle or velocity random walk."""
    bias_instability: AllanTerm
    """Bias instability B [u]; the flat of the deviation is 0.664 B."""
    random_walk: AllanTerm
    """Rate random walk K [u/√s]."""
    ramp: AllanTerm
    """Rate ramp R [u/s]."""
    shortest_tau: float
    """Shortest τ that was fitted [s]: below, a sensor's filter may add what none of the terms is."""
    white_variance: float
    """White variance of a sample, N² rate [u²]."""
    reduced_chi2: float
    """About 1 where the terms describe the curve."""

    @property
    def Q(self) -> AllanTerm:
        """Quantisation [u·s]."""
        return self.quantisation

    @property
    def N(self) -> AllanTerm:
        """White noise [u·√s]."""
        return self.white

    @property
    def B(self) -> AllanTerm:
        """Bias instability [u]."""
        return self.bias_instability

    @property
    def K(self) -> AllanTerm:
        """Rate random walk [u/√s]."""
        return self.random_walk

    @property
    def R(self) -> AllanTerm:
        """Rate ramp [u/s]."""
        return self.ramp

    def deviation(self, tau: npt.ArrayLike) -> Floats:
        """The fitted Allan deviation [u] at averaging times [s]."""
        times = record(np.atleast_1d(tau), "tau")
        return np.sqrt(_undrift.allan_terms_variance(self, times))

    def _table(self) -> Mapping[str, Any]:
        names = ["quantisation", "white", "bias_instability", "random_walk", "ramp"]
        terms: list[AllanTerm] = [getattr(self, name) for name in names]
        return {
            "term": np.array(names),
            "symbol": np.array(["Q", "N", "B", "K", "R"]),
            "value": np.array([term.value for term in terms]),
            "standard_error": np.array([term.standard_error for term in terms]),
            "upper_95": np.array([term.upper_95 for term in terms]),
            "seen": np.array([term.seen for term in terms]),
            "unit": np.array(["u s", "u s^0.5", "u", "u s^-0.5", "u s^-1"]),
        }


@dataclass(frozen=True, eq=False, repr=False)
class AllanGaussMarkov(Result):
    """White noise, quantisation and one Gauss-Markov process fitted to an Allan deviation."""

    _UNITS = {"correlation_time": "s"}

    quantisation: float
    """Quantisation Q [u·s]."""
    white: float
    """White noise N [u·√s]."""
    sigma: float
    """Standard deviation of the process [u]."""
    correlation_time: float
    """Its correlation time [s]."""
    reduced_chi2: float
    """About 1 where the model holds."""
    at_limit: bool
    """The correlation time is at a limit of the range searched: the record does not determine it."""


@dataclass(frozen=True, eq=False, repr=False)
class AllanDeviation(Result):
    """A deviation over averaging time, in the unit u of the samples."""

    _UNITS = {"rate": "Hz", "tau": "s"}

    kind: str
    """overlapping, modified, hadamard or total."""
    rate: float
    """Sample rate [Hz]."""
    samples: int
    """Samples of the record."""
    confidence: float | None
    """Probability of the intervals; None without them."""
    m: Ints
    """Samples averaged."""
    tau: Floats
    """Averaging time, m / rate [s]."""
    deviation: Floats
    """Deviation [u]."""
    n: Ints
    """Differences whose squares were averaged."""
    lower: Floats | None
    """Lower bound of the deviation [u]."""
    upper: Floats | None
    """Upper bound of the deviation [u]."""
    noise_type: Ints | None
    """Exponent α of the spectral density ∝ f^α seen at each τ: 2 quantisation, 0 white,
    -1 flicker, -2 random walk."""
    edf: Floats | None
    """Equivalent degrees of freedom."""

    @cached_property
    def terms(self) -> AllanTerms:
        """The noise terms fitted to an overlapping deviation."""
        return self.fit_terms()

    def fit_terms(self, shortest_tau: float | None = None) -> AllanTerms:
        """As :attr:`terms`, from an averaging time [s] on; without one, from where they describe the curve."""
        found = _undrift.allan_terms(self, shortest_tau)
        for name, value in found.items():
            if isinstance(value, dict):
                found[name] = AllanTerm(**value)
        return AllanTerms(**found)

    @cached_property
    def gauss_markov(self) -> AllanGaussMarkov:
        """White noise, quantisation and a Gauss-Markov process fitted to an overlapping deviation."""
        return AllanGaussMarkov(**_undrift.allan_gauss_markov(self))

    @property
    def outside(self) -> npt.NDArray[np.bool_]:
        """Where the fitted terms lie outside of the intervals, False at τ that were not fitted.

        Of intervals of one sigma, 0.683, a third may by chance; many in a row show that the terms do not
        describe the curve there.
        """
        if self.lower is None or self.upper is None:
            raise _undrift.UndriftError("without intervals, confidence=None, no fit is outside of them")
        fit = self.terms.deviation(self.tau)
        fitted = self.tau >= self.terms.shortest_tau
        return np.asarray(fitted & ((fit < self.lower) | (fit > self.upper)))

    def plot(
        self,
        ax: Axes | None = None,
        *,
        terms: bool | None = None,
        label: str | None = None,
        unit: str | None = None,
    ) -> Axes:
        """Deviation over averaging time, logarithmic, with its band and the fitted terms.

        ``terms``: draw the fit, with crosses where it is outside of the band; by default where the deviation
        is overlapping. ``label`` names the curve. ``unit``, such as deg/h or mg, converts from rad/s or m/s².
        Needs ``undrift[plot]``.
        """
        ax = axes(ax)
        scale = factor(unit)
        (line,) = ax.loglog(
            self.tau, scale * self.deviation, marker=".", label=label or f"{self.kind} deviation"
        )
        if self.lower is not None and self.upper is not None and self.confidence is not None:
            ax.fill_between(
                self.tau,
                scale * self.lower,
                scale * self.upper,
                alpha=0.25,
                color=line.get_color(),
                linewidth=0,
                label=f"{100 * self.confidence:.3g} % confidence",
            )
        if self.kind == "overlapping" if terms is None else terms:
            fit = self.terms
            shown = self.tau >= fit.shortest_tau
            fitted = scale * fit.deviation(self.tau)
            ax.loglog(self.tau[shown], fitted[shown], "--", label="fitted terms")
            if self.lower is not None and self.outside.any():
                outside = self.outside
                ax.loglog(self.tau[outside], fitted[outside], "rx", label="fit outside of the band")
        ax.set_xlabel("averaging time [s]")
        ax.set_ylabel(f"deviation [{label_of(unit)}]")
        ax.grid(True, which="both", alpha=0.3)
        ax.legend()
        return ax


def allan(
    x: npt.ArrayLike,
    rate: float,
    *,
    kind: Kind = "overlapping",
    taus: Grid | npt.ArrayLike = "octave",
    confidence: float | None = 0.683,
) -> AllanDeviation:
    """Allan deviation of rates (angular rate [rad/s], specific force [m/s²]) sampled at ``rate`` [Hz].

    ``kind``: overlapping, modified (separates white phase noise from flicker phase), hadamard (blind to a
    ramp) or total (better confidence at the longest τ). ``taus``: octave (1, 2, 4, … samples), decade
    (1, 2, 5, 10, …), all, or averaging times [s], each taken to the nearest whole number of samples. All of
    the overlapping kind take N log² N time and deviations are within 5e-10 of the definition; all of
    another kind take N².
    ``confidence``: probability of the two-sided interval of each point, 0.683 for one sigma; None
    leaves intervals and noise types out, which takes half the time or less.

    NIST SP 1065, section 5; intervals by noise type as in its section 5.4. ``.terms`` are the noise
    terms of IEEE Std 952.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor.
    rate : float
        Sample rate [Hz].
    kind : {"overlapping", "modified", "hadamard", "total"}
        Which deviation.
    taus : {"octave", "decade", "all"} or array_like
        Averaging times: a grid, or times [s].
    confidence : float or None
        Probability of the intervals; None for none.

    Returns
    -------
    AllanDeviation
        Deviation [u] over averaging time [s], with intervals and, by ``.terms``, noise terms.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(2000, [], [], 1.0)  # white noise
    >>> curve = undrift.allan(x, 100.0)
    >>> f"{curve.deviation[0]:.1f}"  # of one sample
    '1.0'
    >>> f"{curve.terms.N:.2f}"  # σ/√rate
    '0.10'
    """
    times = taus if isinstance(taus, str) else record(taus, "taus")
    rate = positive(rate, "rate")
    found = _undrift.allan_deviation(record(x), rate, kind, times, confidence)
    return AllanDeviation(kind=kind, rate=rate, confidence=confidence, **found)


@dataclass(frozen=True, eq=False, repr=False)
class WaveletVariance(Result):
    """Haar wavelet variance at octave scales, u the unit of the samples."""

    _UNITS = {"rate": "Hz", "scale": "s"}

    rate: float
    """Sample rate [Hz]."""
    samples: int
    """Samples of the record, missing ones counted."""
    m: Ints
    """Samples to a mean."""
    scale: Floats
    """Scale, m / rate [s]."""
    variance: Floats
    """Wavelet variance [u²]: half the Allan variance at τ = scale."""
    edf: Floats
    """Equivalent degrees of freedom."""
    n: Ints
    """Coefficients whose squares were averaged."""

    def plot(
        self, ax: Axes | None = None, *, label: str | None = None, unit: str | None = None
    ) -> Axes:
        """Wavelet variance over scale, logarithmic; ``label`` names the curve, ``unit`` converts the samples. Needs ``undrift[plot]``."""
        ax = axes(ax)
        ax.loglog(self.scale, factor(unit) ** 2 * self.variance, marker=".", label=label)
        ax.set_xlabel("scale [s]")
        ax.set_ylabel(f"wavelet variance [({label_of(unit)})²]")
        if label is not None:
            ax.legend()
        ax.grid(True, which="both", alpha=0.3)
        return ax


def wavelet_variance(x: npt.ArrayLike, rate: float) -> WaveletVariance:
    """Haar wavelet variance of a record sampled at ``rate`` [Hz], at scales 1, 2, 4, … up to a quarter of it.

    NaN is a missing sample. Percival & Walden (2000), chapter 8.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor. NaN is a missing sample.
    rate : float
        Sample rate [Hz].

    Returns
    -------
    WaveletVariance
        Variance [u²] over scale [s].

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(2000, [], [], 1.0)  # white noise
    >>> undrift.wavelet_variance(x, 100.0).scale[:3].tolist()
    [0.01, 0.02, 0.04]
    """
    rate = positive(rate, "rate")
    return WaveletVariance(rate=rate, **_undrift.wavelet_variance(record(x), rate))
