"""Noise models of low-cost inertial sensors, carried exactly into a GNSS/INS filter.

SI units and radians, unless a name states otherwise; arrays are numpy's, ``float64``.
"""

from undrift import arma, fleet, statistics
from undrift._drive import Drive
from undrift._errors import ArgumentError, VerdictError, VerdictWarning
from undrift._filter import Filter, Innovation
from undrift._identify import AxisIdentified, Candidate, Identified, identify
from undrift._inspect import inspect
from undrift._logs import GnssLog, ImuLog
from undrift._model import ArmaNoise, AxisNoise, NoiseModel, Shaping, TemperatureEffect
from undrift._navigate import Navigation, navigate
from undrift._navigator import Event, Fix, Navigator, Sample, Scalar
from undrift._outages import Drift, ModelErrors, Outages, outages
from undrift._simulate import GnssReceiver, Simulation, Truth, simulate
from undrift._solution import FilterState, Solution
from undrift._judged import report
from undrift._tune import TunedDrift, TunedParameter, Tuning, tune
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
    "ArgumentError",
    "ArmaNoise",
    "AxisIdentified",
    "AxisNoise",
    "Candidate",
    "Drift",
    "Drive",
    "Event",
    "Filter",
    "FilterState",
    "Fix",
    "GnssLog",
    "GnssReceiver",
    "Identified",
    "ImuLog",
    "Innovation",
    "ModelErrors",
    "Navigation",
    "Navigator",
    "NoiseModel",
    "Outages",
    "Sample",
    "Scalar",
    "Shaping",
    "Simulation",
    "Solution",
    "TemperatureEffect",
    "Truth",
    "TunedDrift",
    "TunedParameter",
    "Tuning",
    "UndriftError",
    "VerdictError",
    "VerdictWarning",
    "__version__",
    "acf",
    "adf",
    "allan",
    "arma",
    "detrend",
    "fleet",
    "identify",
    "inspect",
    "jarque_bera",
    "kpss",
    "ljung_box",
    "navigate",
    "normality",
    "outages",
    "pacf",
    "pandit_wu",
    "phillips_perron",
    "psd",
    "report",
    "simulate",
    "stationarity",
    "statistics",
    "tune",
    "wavelet_variance",
]
