"""The order of an ARMA model: grids and Pandit and Wu's tests."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from undrift import _undrift
from undrift._arguments import pair, whole
from undrift._arma import ArmaFit, Order, fit_of
from undrift._array import record
from undrift._result import Result


class _Fits(Result):
    """Several fits, one row each in the table."""

    fits: tuple[ArmaFit, ...]

    def __getitem__(self, order: Order) -> ArmaFit:
        """The fit of an order (p, q); KeyError where it was not made."""
        for one in self.fits:
            if one.order == tuple(order):
                return one
        raise KeyError(order)

    def __iter__(self) -> Iterator[ArmaFit]:
        return iter(self.fits)

    def _table(self) -> Mapping[str, Any]:
        names = ["log_likelihood", "residual_sum_of_squares", "aic", "aicc", "bic"]
        orders = {
            "p": np.array([one.order[0] for one in self.fits]),
            "q": np.array([one.order[1] for one in self.fits]),
        }
        return orders | {
            name: np.array([getattr(one, name) for one in self.fits]) for name in names
        }


@dataclass(frozen=True, eq=False, repr=False)
class Selection(_Fits):
    """The fits of a grid of orders and the orders that the criteria choose. ``selection[p, q]`` is a fit."""

    fits: tuple[ArmaFit, ...]
    """By p, then q; orders that the recording is too short for are omitted."""
    by_aic: Order
    """Order of least AIC."""
    by_aicc: Order
    """Order of least AICc."""
    by_bic: Order
    """Order of least BIC."""


def select(
    x: npt.ArrayLike,
    max_order: Order,
    *,
    mean: float | None = None,
    unit_root: bool = False,
    effort: float = 1.0,
) -> Selection:
    """Fits every ARMA(p, q) up to ``max_order`` (with a unit root, p from 1) and compares AIC, AICc and BIC.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor. NaN is a missing sample.
    max_order : tuple of int
        Largest (p, q).
    mean : float, optional
        Known mean [u]; estimated without one.
    unit_root : bool
        Whether one AR root is fixed at exactly 1.
    effort : float
        How hard to search, 0.001 to 1000; 1 is thorough.

    Returns
    -------
    Selection
        All fits and the orders of least AIC, AICc and BIC.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(1000, [0.9], [], 1.0)
    >>> undrift.arma.select(x, (1, 1), effort=0.05).by_bic
    (1, 0)
    """
    found = _undrift.arma_select(record(x), pair(max_order, "max_order"), mean, unit_root, effort)
    fits = tuple(map(fit_of, found["fits"]))
    return Selection(
        fits=fits,
        by_aic=fits[found["index_aic"]].order,
        by_aicc=fits[found["index_aicc"]].order,
        by_bic=fits[found["index_bic"]].order,
    )


@dataclass(frozen=True, eq=False, repr=False)
class OrderTest(Result):
    """One F test between two nested orders."""

    smaller: Order
    """The smaller order (p, q)."""
    larger: Order
    """The larger one."""
    sum_smaller: float
    """Sum of squares of the smaller model [u²]."""
    sum_larger: float
    """Sum of squares of the larger model [u²]."""
    f: float
    """F statistic."""
    added: int
    """Parameters added."""
    remaining: int
    """Degrees of freedom of the denominator."""
    critical: float
    """Critical value at the level asked for."""
    p_value: float
    """Probability of a larger F, were it F-distributed."""
    significant: bool
    """F exceeds the critical value: the larger model is needed."""
    significant_in_paper: bool
    """F exceeds the value that the source paper compares with."""


@dataclass(frozen=True, eq=False, repr=False)
class PanditWu(_Fits):
    """Pandit and Wu's choice of an order. ``result[p, q]`` is a fit."""

    n: int
    """n of the last significant ARMA(2n, 2n-1)."""
    adequate: bool
    """The loop ended because a test was not significant, not because n_max was reached."""
    by_f: Order
    """Order chosen by the F tests, after stepping down."""
    by_bic_step_down: Order
    """Order of least BIC on the way down."""
    by_aic: Order
    """Order of least AIC among the fits."""
    by_bic: Order
    """Order of least BIC among the fits."""
    paper_critical: float
    """The critical value that the source paper takes at every step."""
    rows: tuple[tuple[Order, OrderTest | None], ...]
    """ARMA(1,1), then ARMA(2n, 2n-1), each with its test against the one before."""
    step_down: tuple[OrderTest, ...]
    """The tests of stepping down from (2n, 2n-1)."""
    neighbours: tuple[OrderTest, ...]
    """The neighbours (1,1), (2,1), (3,2), each tested against the next larger."""
    fits: tuple[ArmaFit, ...]
    """All fits made."""

    @property
    def order(self) -> Order:
        """The order that the paper's procedure chooses, :attr:`by_f`."""
        return self.by_f

    @property
    def fit(self) -> ArmaFit:
        """The fit of that order."""
        return self[self.by_f]

    def _table(self) -> Mapping[str, Any]:
        fits = [self[order] for order, _ in self.rows]
        tests = [test for _, test in self.rows]
        return {
            "p": np.array([one.order[0] for one in fits]),
            "q": np.array([one.order[1] for one in fits]),
            "residual_sum_of_squares": np.array([one.residual_sum_of_squares for one in fits]),
            "aic": np.array([one.aic for one in fits]),
            "bic": np.array([one.bic for one in fits]),
            "f": np.array([np.nan if test is None else test.f for test in tests]),
            "f_critical": np.array([np.nan if test is None else test.critical for test in tests]),
            "significant": np.array([test is not None and test.significant for test in tests]),
        }


def pandit_wu(
    x: npt.ArrayLike,
    n_max: int = 3,
    *,
    level: float = 0.05,
    mean: float | None = None,
    unit_root: bool = False,
    effort: float = 1.0,
) -> PanditWu:
    """Fits ARMA(2n, 2n-1) for n = 1, 2, … ``n_max`` until F tests see nothing more, then steps down.

    The F test leads to orders that are too high more often than its ``level`` implies: weigh
    ``by_bic_step_down`` beside it. Pandit & Wu (1983), sections 4.4 and 4.5.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor. NaN is a missing sample.
    n_max : int
        Largest n of ARMA(2n, 2n-1).
    level : float
        Level of the F tests.
    mean : float, optional
        Known mean [u]; estimated without one.
    unit_root : bool
        Whether one AR root is fixed at exactly 1.
    effort : float
        How hard to search, 0.001 to 1000; 1 is thorough.

    Returns
    -------
    PanditWu
        Fits, tests and the orders chosen.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(1000, [0.9], [0.3], 1.0)
    >>> undrift.pandit_wu(x, 1, effort=0.05).order
    (1, 1)
    """
    found = _undrift.arma_pandit_wu(record(x), whole(n_max, "n_max"), level, mean, unit_root, effort)
    found["rows"] = tuple(
        (row["order"], None if row["test"] is None else OrderTest(**row["test"]))
        for row in found["rows"]
    )
    for name in ("step_down", "neighbours"):
        found[name] = tuple(OrderTest(**test) for test in found[name])
    found["fits"] = tuple(map(fit_of, found["fits"]))
    return PanditWu(**found)
