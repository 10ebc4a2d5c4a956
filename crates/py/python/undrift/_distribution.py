"""Is a record normally distributed, is it white, what correlations and spectrum does it have?"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt
from undrift import _undrift
from undrift._arguments import positive, whole
from undrift._array import Floats, Ints, record
from undrift._result import Result, axes
from undrift._units import factor, label_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False, repr=False)
class JarqueBera(Result):
    """Jarque-Bera test of normality."""

    statistic: float
    """n/6 (skewness² + kurtosis²/4)."""
    p_value: float
    """By chi-squared with 2 degrees of freedom."""
    skewness: float
    """0 for a normal distribution."""
    kurtosis_excess: float
    """0 for a normal distribution."""


def jarque_bera(x: npt.ArrayLike) -> JarqueBera:
    """Jarque-Bera test of normality.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor.

    Returns
    -------
    JarqueBera
        Statistic and p-value.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> import numpy as np
    >>> undrift.jarque_bera(np.arange(1000.0)).p_value < 0.01  # uniform
    True
    """
    return JarqueBera(**_undrift.jarque_bera(record(x)))


@dataclass(frozen=True, eq=False, repr=False)
class Normality(Result):
    """Statistics of the distribution of a recording, u its unit."""

    samples: int
    """Samples."""
    mean: float
    """Mean [u]."""
    deviation: float
    """Standard deviation, divisor n - 1 [u]."""
    skewness: float
    """0 for a normal distribution."""
    kurtosis_excess: float
    """0 for a normal distribution."""
    jarque_bera: float
    """Jarque-Bera statistic."""
    jarque_bera_p: float
    """Its p."""
    distance: float
    """Kolmogorov-Smirnov distance to the normal distribution of the record's mean and deviation."""
    plain_critical_5: float
    """5 % critical distance for a distribution known beforehand: too lenient here."""
    plain_p: float
    """p for a distribution known beforehand."""
    lilliefors_critical_5: float
    """5 % critical distance of Lilliefors' test, which allows for the fit."""
    lilliefors_p: float
    """p of Lilliefors' test."""
    quantisation_step: float | None
    """Step of the grid that the samples lie on [u]; None without a grid."""
    levels: int | None
    """Different values, where there is a grid."""


def normality(x: npt.ArrayLike) -> Normality:
    """Jarque-Bera, Kolmogorov-Smirnov and Lilliefors tests, and the quantisation step.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor.

    Returns
    -------
    Normality
        Statistics, p-values, the step of quantisation.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> import numpy as np
    >>> x = undrift.arma.simulate(2000, [], [], 1.0)  # white noise
    >>> undrift.normality(np.round(x, 1)).quantisation_step
    0.1
    """
    return Normality(**_undrift.normality_tests(record(x)))


@dataclass(frozen=True, eq=False, repr=False)
class LjungBox(Result):
    """Portmanteau tests of whiteness at one or several numbers of lags."""

    lags: Ints
    """Autocorrelations summed."""
    freedom: Ints
    """Degrees of freedom: lags less the parameters fitted."""
    statistic: Floats
    """Ljung-Box."""
    p_value: Floats
    """Its p; NaN without degrees of freedom."""
    box_pierce: Floats
    """Box-Pierce."""
    box_pierce_p: Floats
    """Its p; NaN without degrees of freedom."""


def ljung_box(x: npt.ArrayLike, lags: int | Iterable[int] = 20, *, fitted: int = 0) -> LjungBox:
    """Ljung-Box and Box-Pierce tests at each number of ``lags``.

    ``fitted``: parameters p + q where ``x`` are the residuals of an ARMA(p, q).

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor.
    lags : int or iterable of int
        Autocorrelations that are summed.
    fitted : int
        Parameters of the model whose residuals these are.

    Returns
    -------
    LjungBox
        Statistics and p-values, one for each number of lags.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(5000, [0.9], [], 1.0)
    >>> bool(undrift.ljung_box(x, 20).p_value[0] < 0.01)  # not white
    True
    """
    several = lags if isinstance(lags, Iterable) else [lags]
    wanted = [whole(lag, "lags") for lag in several]
    return LjungBox(**_undrift.portmanteau(record(x), wanted, whole(fitted, "fitted")))


@dataclass(frozen=True, eq=False, repr=False)
class Correlations(Result):
    """Autocorrelations or partial autocorrelations from lag 0 on; an array where one is asked for."""

    samples: int
    """Samples of the record."""
    lag: Ints
    """Lag [samples]."""
    value: Floats
    """Correlation; 1 at lag 0."""
    bound: Floats
    """95 % bound: of an autocorrelation by Bartlett, were all from this lag on 0; of a partial one
    that of white noise. NaN at lag 0."""

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> npt.NDArray[Any]:
        made = np.asarray(self.value, dtype=dtype)
        return made.copy() if copy and made is self.value else made

    def plot(self, ax: Axes | None = None, *, label: str | None = None) -> Axes:
        """Correlation over lag with its bounds. Needs ``undrift[plot]``."""
        ax = axes(ax)
        ax.vlines(self.lag[1:], 0.0, self.value[1:])
        ax.plot(self.lag[1:], self.value[1:], ".", label=label)
        ax.fill_between(
            self.lag[1:], -self.bound[1:], self.bound[1:], alpha=0.2, linewidth=0, label="95 %"
        )
        ax.axhline(0.0, linewidth=0.8, color="black")
        ax.set_xlabel("lag [samples]")
        ax.set_ylabel("correlation")
        ax.legend()
        return ax


def acf(x: npt.ArrayLike, lags: int = 100) -> Correlations:
    """Autocorrelations at lags 0 to ``lags``: about the mean, divisor n.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor.
    lags : int
        Largest lag.

    Returns
    -------
    Correlations
        Correlations and their 95 % bounds, lags 0 to ``lags``.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(5000, [0.9], [], 1.0)
    >>> f"{undrift.acf(x, 5).value[1]:.1f}"
    '0.9'
    """
    return Correlations(**_undrift.acf(record(x), whole(lags, "lags")))


def pacf(
    x: npt.ArrayLike,
    lags: int = 100,
    *,
    method: Literal["yule-walker", "yule-walker-adjusted", "burg"] = "yule-walker",
) -> Correlations:
    """Partial autocorrelations at lags 0 to ``lags``; Burg's are the ones to trust near a unit root.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor.
    lags : int
        Largest lag.
    method : {"yule-walker", "yule-walker-adjusted", "burg"}
        How they are estimated.

    Returns
    -------
    Correlations
        Partial correlations and their 95 % bounds, lags 0 to ``lags``.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(5000, [0.9], [], 1.0)
    >>> f"{undrift.pacf(x, 5).value[1]:.1f}"
    '0.9'
    """
    return Correlations(**_undrift.pacf(record(x), whole(lags, "lags"), method))


@dataclass(frozen=True, eq=False, repr=False)
class SpectralLines(Result):
    """Narrow lines that stand out of a spectrum, strongest first."""

    _UNITS = {"frequency": "Hz"}

    frequency: Floats
    """Frequency [Hz]."""
    amplitude: Floats
    """Amplitude of a sine of that power [u]."""
    over_median: Floats
    """Density of the peak over the median around it."""


@dataclass(frozen=True, eq=False, repr=False)
class Spectrum(Result):
    """One-sided power spectral density, u the unit of the samples."""

    _UNITS = {"rate": "Hz", "frequency": "Hz"}

    rate: float
    """Sample rate [Hz]."""
    segments: int
    """Segments averaged."""
    frequency: Floats
    """Frequency [Hz]."""
    density: Floats
    """Density [u²/Hz]; its integral is the variance. White noise N of the Allan deviation has 2 N²."""

    def lines(self, factor: float = 10.0) -> SpectralLines:
        """The peaks above ``factor`` times the median around them."""
        found = _undrift.spectral_lines(self.frequency, self.density, self.segments, factor)
        return SpectralLines(**found)

    def plot(
        self, ax: Axes | None = None, *, label: str | None = None, unit: str | None = None
    ) -> Axes:
        """Density over frequency, logarithmic; ``label`` names the curve, ``unit`` converts the samples. Needs ``undrift[plot]``."""
        ax = axes(ax)
        ax.loglog(self.frequency[1:], factor(unit) ** 2 * self.density[1:], label=label)
        ax.set_xlabel("frequency [Hz]")
        ax.set_ylabel(f"density [({label_of(unit)})²/Hz]")
        if label is not None:
            ax.legend()
        ax.grid(True, which="both", alpha=0.3)
        return ax


def psd(x: npt.ArrayLike, rate: float, *, segment: int | None = None) -> Spectrum:
    """Power spectral density of a record sampled at ``rate`` [Hz] by Welch's method.

    Hann window, half overlapped, the mean of each segment taken out. ``segment`` in samples: by
    default an eighth of the record, 256 to 8192.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor.
    rate : float
        Sample rate [Hz].
    segment : int, optional
        Samples of a segment.

    Returns
    -------
    Spectrum
        One-sided density [u²/Hz] over frequency [Hz].

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(2000, [], [], 1.0)  # white noise
    >>> spectrum = undrift.psd(x, 100.0)
    >>> f"{spectrum.density[1:-1].mean():.2f}"  # 2 σ²/rate
    '0.02'
    """
    rate = positive(rate, "rate")
    return Spectrum(rate=rate, **_undrift.psd(record(x), rate, segment))


@dataclass(frozen=True, eq=False, repr=False)
class Detrended(Result):
    """A record less its trend, u its unit."""

    mean: float
    """Mean of the record [u]."""
    slope: float
    """Slope: [u a sample] of a line, [u/K] over temperature, 0 of a constant."""
    explained: float
    """Share of the variance about the mean that the slope explains, 0 to 1."""
    residuals: Floats
    """What is left [u]."""


def detrend(
    x: npt.ArrayLike,
    kind: Literal["constant", "linear", "temperature"] = "constant",
    *,
    temperature: npt.ArrayLike | None = None,
) -> Detrended:
    """Takes out the mean, a straight line, or the mean and a multiple of the temperature [°C or K].

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor.
    kind : {"constant", "linear", "temperature"}
        What is taken out.
    temperature : array_like, shape (n,), optional
        Temperature of each sample [°C or K].

    Returns
    -------
    Detrended
        What is left, the mean and the slope.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> import numpy as np
    >>> f"{undrift.detrend(2.0 * np.arange(100.0), 'linear').slope:.3f}"
    '2.000'
    """
    given = None if temperature is None else record(temperature, "the temperature")
    return Detrended(**_undrift.detrend(record(x), kind, given))
