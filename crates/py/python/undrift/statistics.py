"""Statistics of a static record of one axis: Allan variance, tests, correlations, spectrum.

A record is anything that numpy takes for a one-dimensional array of numbers; contiguous ``float64`` is
read where it lies. Every function releases the interpreter's lock while it computes.
"""

from undrift._allan import (
    AllanDeviation,
    AllanGaussMarkov,
    AllanTerm,
    AllanTerms,
    WaveletVariance,
    allan,
    wavelet_variance,
)
from undrift._distribution import (
    Correlations,
    Detrended,
    JarqueBera,
    LjungBox,
    Normality,
    SpectralLines,
    Spectrum,
    acf,
    detrend,
    jarque_bera,
    ljung_box,
    normality,
    pacf,
    psd,
)
from undrift._stationarity import (
    Adf,
    Kpss,
    PhillipsPerron,
    Stationarity,
    adf,
    kpss,
    phillips_perron,
    stationarity,
)

__all__ = [
    "Adf",
    "AllanDeviation",
    "AllanGaussMarkov",
    "AllanTerm",
    "AllanTerms",
    "Correlations",
    "Detrended",
    "JarqueBera",
    "Kpss",
    "LjungBox",
    "Normality",
    "PhillipsPerron",
    "SpectralLines",
    "Spectrum",
    "Stationarity",
    "WaveletVariance",
    "acf",
    "adf",
    "allan",
    "detrend",
    "jarque_bera",
    "kpss",
    "ljung_box",
    "normality",
    "pacf",
    "phillips_perron",
    "psd",
    "stationarity",
    "wavelet_variance",
]
