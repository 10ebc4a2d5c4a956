"""Noise models of low-cost inertial sensors, carried exactly into a GNSS/INS filter.

SI units and radians, unless a name says otherwise; arrays are numpy's, ``float64``.
"""

from undrift import arma, fleet, statistics
from undrift._undrift import UndriftError, __version__
from undrift.arma import pandit_wu
from undrift.statistics import (
    acf,
    adf,
    allan,
    detrend,
    jarque_bera,
    kpss,
    ljung_box,
    normality,
    pacf,
    phillips_perron,
    psd,
    stationarity,
    wavelet_variance,
)

__all__ = [
    "UndriftError",
    "__version__",
    "acf",
    "adf",
    "allan",
    "arma",
    "detrend",
    "fleet",
    "jarque_bera",
    "kpss",
    "ljung_box",
    "normality",
    "pacf",
    "pandit_wu",
    "phillips_perron",
    "psd",
    "stationarity",
    "statistics",
    "wavelet_variance",
]
