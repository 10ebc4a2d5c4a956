"""ARMA models of a record by exact Gaussian maximum likelihood.

Sign convention: ``x_t - φ1 x_{t-1} - … - φp x_{t-p} = a_t - θ1 a_{t-1} - … - θq a_{t-q}``, x about
its mean, ``a_t ~ N(0, σ²)``. θ is subtracted: the MA coefficients are minus those of statsmodels.
NaN marks a missing sample, which is exactly accounted for.
"""

from undrift._arma import (
    ArFit,
    ArmaFit,
    Likelihood,
    ProfileInterval,
    burg,
    fit,
    log_likelihood,
    order_by_aicc,
    profile_interval,
    simulate,
    yule_walker,
)
from undrift._orders import OrderTest, PanditWu, Selection, pandit_wu, select

__all__ = [
    "ArFit",
    "ArmaFit",
    "Likelihood",
    "OrderTest",
    "PanditWu",
    "ProfileInterval",
    "Selection",
    "burg",
    "fit",
    "log_likelihood",
    "order_by_aicc",
    "pandit_wu",
    "profile_interval",
    "select",
    "simulate",
    "yule_walker",
]
