"""The tasks of identification, through undrift's Python package and through the peers.

Each function imports what it needs and returns the task, a function of the record: so that a process
holds what its own task needs, and importing is not timed. Ours return what the program `peers` prints.
`tasks.py WHO TASK FILE REPEATS` runs one on a file of float64.
"""

import math
import sys
from functools import partial

from process import report

RATE_HZ = 100.0
# The orders that the Pandit-Wu procedure fits for n up to 2.
PANDIT_WU = [(1, 0), (1, 1), (2, 1), (3, 2), (4, 3)]
LEVEL = 0.05


# φ and θ of the records by order, and their σ. The (1,1) is the source paper's case; the others have its slow
# pole and zero, and further ones that do not cancel: poles 0.99995, 0.6 (0.9, ±0.5i), zeros 0.9994 (0.3, −0.4).
MODELS = {
    (1, 1): ([0.99995], [0.9994]),
    (2, 1): ([1.59995, -0.59997], [0.9994]),
    (4, 3): (
        [1.89995, -1.149955, 0.4749875, -0.22498875],
        [0.8994, 0.21994, -0.119928],
    ),
}
SIGMA = 0.006


def innovations_fit(record, p, q, start=None):
    """statsmodels' fit of ARMA(p, q) about a mean of zero: φ, θ with our sign, σ, log-likelihood. `start`
    is φ and θ to start from, else its own (Hannan-Rissanen)."""
    import numpy as np
    from statsmodels.tsa.arima.estimators.innovations import innovations_mle

    if start is not None:
        start = np.r_[start[0], -np.asarray(start[1]), SIGMA**2]
    result = innovations_mle(record, order=(p, 0, q), demean=False, start_params=start)
    model = result.parameters
    reported = -float(result.other_results.minimize_results.fun)
    return [*model.ar_params, *(-model.ma_params), math.sqrt(model.sigma2), reported]


def peer_arma(p, q, start=None):
    import statsmodels.tsa.arima.estimators.innovations  # noqa: F401

    return lambda record: innovations_fit(record, p, q, start)


def starts():
    """Of each order of the procedure the true ARMA(2,1), or what comes near; further pairs of a pole and a
    zero cancel."""
    import numpy as np

    ar, ma = (np.r_[1.0, -np.array(part)] for part in MODELS[2, 1])
    found = {(1, 0): ([0.6], []), (1, 1): MODELS[1, 1], (2, 1): MODELS[2, 1]}
    for order, root in ((3, 2), 0.3), ((4, 3), -0.3):
        ar, ma = np.convolve(ar, [1.0, -root]), np.convolve(ma, [1.0, -root])
        found[order] = (-ar[1:], -ma[1:])
    return found


def peer_pandit_wu():
    """A plain loop of fits with the F rule and the way down by BIC, as `undrift_noise::pandit_wu`."""
    import numpy as np
    import statsmodels.tsa.arima.estimators.innovations  # noqa: F401
    from scipy.stats import f

    started = starts()

    def task(record):
        n = len(record)
        fits = {order: innovations_fit(record, *order, started[order]) for order in PANDIT_WU}
        squares = {order: n * fit[-2] ** 2 for order, fit in fits.items()}
        bic = {order: (sum(order) + 1) * np.log(n) - 2.0 * fit[-1] for order, fit in fits.items()}

        def needed(smaller, larger):
            added, left = sum(larger) - sum(smaller), n - sum(larger)
            ratio = (squares[smaller] - squares[larger]) / added / (squares[larger] / left)
            return ratio > f.isf(LEVEL, added, left)

        top = (4, 3) if needed((2, 1), (4, 3)) else (2, 1)
        way = PANDIT_WU[1 : PANDIT_WU.index(top)][::-1]
        by_f = top
        for order in way:
            if needed(order, by_f):
                break
            by_f = order
        by_bic = min([top, *way], key=bic.get)
        return [*by_f, *by_bic, *(fits[order][-1] for order in PANDIT_WU)]

    return task


def allan_points(tau, deviation, taus, record):
    """τ and deviation in turns; of all τ at most 50 000, by the rule of the program `peers`."""
    import numpy as np

    stride = max(len(record) // 100_000, 1) if taus == "all" else 1
    return np.column_stack([tau, deviation])[::stride].ravel()


def peer_allan(taus="octave"):
    import allantools

    def task(record):
        tau, deviation, _, _ = allantools.oadev(record, rate=RATE_HZ, data_type="freq", taus=taus)
        return allan_points(tau, deviation, taus, record)

    return task


def sidereon_allan(kind, taus="octave", fewest=2):
    """sidereon takes averaging factors: 1, 2, 4 … or all, of which a record has `fewest` at least."""
    import sidereon

    def task(record):
        most = len(record) // fewest
        factors = range(1, most) if taus == "all" else [1 << k for k in range(most.bit_length())]
        series = sidereon.AllanSeries.fractional_frequency(record)
        found = getattr(sidereon, kind)(series, 1.0 / RATE_HZ, factors)
        return allan_points(found.tau_s, found.deviation, taus, record)

    return task


def peer_adf():
    from statsmodels.tsa.stattools import adfuller

    return lambda record: adfuller(record, maxlag=20, regression="c", autolag=None)[:2]


def peer_kpss():
    import warnings

    from statsmodels.tsa.stattools import kpss

    # It warns where p is a bound of its table.
    warnings.simplefilter("ignore")
    return lambda record: kpss(record, regression="c", nlags=40)[:2]


def peer_ljung_box():
    from statsmodels.stats.diagnostic import acorr_ljungbox

    def task(record):
        table = acorr_ljungbox(record, lags=[20])
        return [table["lb_stat"].iloc[0], table["lb_pvalue"].iloc[0]]

    return task


def peer_acf():
    from statsmodels.tsa.stattools import acf

    return lambda record: acf(record, nlags=100, fft=True)


def peer_jarque_bera():
    from scipy.stats import jarque_bera

    def task(record):
        result = jarque_bera(record)
        return [result.statistic, result.pvalue]

    return task


def peer_normality():
    from scipy.stats import jarque_bera
    from statsmodels.stats.diagnostic import lilliefors

    def task(record):
        result = jarque_bera(record)
        return [result.statistic, result.pvalue, lilliefors(record, pvalmethod="approx")[0]]

    return task


def peer_phillips_perron():
    from arch.unitroot import PhillipsPerron

    def task(record):
        test = PhillipsPerron(record, trend="c", test_type="tau")
        return [test.stat, test.pvalue, test.lags]

    return task


def ours_arma(p, q):
    from undrift import arma

    def task(record):
        fit = arma.fit(record, (p, q), mean=0.0)
        return [*fit.ar, *fit.ma, fit.sigma, fit.log_likelihood]

    return task


def ours_pandit_wu():
    from undrift import arma

    def task(record):
        table = arma.pandit_wu(record, 2, level=LEVEL, mean=0.0)
        likelihoods = {tuple(fit.order): fit.log_likelihood for fit in table.fits}
        orders = (*table.by_f, *table.by_bic_step_down)
        return [*orders, *(likelihoods[order] for order in PANDIT_WU)]

    return task


def ours_allan(taus="octave", confidence=None, kind="overlapping"):
    import undrift

    def task(record):
        found = undrift.allan(record, RATE_HZ, kind=kind, taus=taus, confidence=confidence)
        return allan_points(found.tau, found.deviation, taus, record)

    return task


def ours_adf():
    import undrift

    def task(record):
        test = undrift.adf(record, lags=20)
        return [test.statistic, test.p_value]

    return task


def ours_kpss():
    import undrift

    def task(record):
        test = undrift.kpss(record, lags=40)
        return [test.statistic, test.p_value]

    return task


def ours_ljung_box():
    import undrift

    def task(record):
        test = undrift.ljung_box(record, 20)
        return [test.statistic[0], test.p_value[0]]

    return task


def ours_acf():
    import undrift

    return lambda record: undrift.acf(record, 100).value


def ours_jarque_bera():
    import undrift

    def task(record):
        test = undrift.jarque_bera(record)
        return [test.statistic, test.p_value]

    return task


def ours_normality():
    import undrift

    def task(record):
        test = undrift.normality(record)
        return [test.jarque_bera, test.jarque_bera_p, test.distance]

    return task


def ours_phillips_perron():
    import undrift

    def task(record):
        test = undrift.phillips_perron(record)
        return [test.statistic, test.p_value, test.lags]

    return task


# Of each task: ours, the peer's.
TASKS = {
    **{
        f"arma_{p}_{q}": (partial(ours_arma, p, q), partial(peer_arma, p, q, MODELS[p, q]))
        for p, q in MODELS
    },
    # The peer left to its own start.
    **{
        f"arma_{p}_{q}_own": (partial(ours_arma, p, q), partial(peer_arma, p, q))
        for p, q in MODELS
    },
    "pandit_wu": (ours_pandit_wu, peer_pandit_wu),
    "allan": (ours_allan, peer_allan),
    "allan_intervals": (partial(ours_allan, confidence=0.683), peer_allan),
    "allan_all": (partial(ours_allan, "all"), partial(peer_allan, "all")),
    "allan_sidereon": (ours_allan, partial(sidereon_allan, "overlapping_adev")),
    "allan_all_sidereon": (partial(ours_allan, "all"), partial(sidereon_allan, "overlapping_adev", "all")),
    "allan_modified": (
        partial(ours_allan, kind="modified"),
        partial(sidereon_allan, "modified_adev", fewest=3),
    ),
    "allan_hadamard": (
        partial(ours_allan, kind="hadamard"),
        partial(sidereon_allan, "hadamard_deviation", fewest=3),
    ),
    "adf": (ours_adf, peer_adf),
    "kpss": (ours_kpss, peer_kpss),
    "ljung_box": (ours_ljung_box, peer_ljung_box),
    "acf": (ours_acf, peer_acf),
    "jarque_bera": (ours_jarque_bera, peer_jarque_bera),
    "normality": (ours_normality, peer_normality),
    "phillips_perron": (ours_phillips_perron, peer_phillips_perron),
}


def main():
    import numpy as np

    who, name, path, repeats = sys.argv[1:]
    ours, peer = TASKS[name]
    task = ours() if who == "ours" else peer()
    record = np.fromfile(path, dtype="<f8")
    report(lambda: task(record), int(repeats))


if __name__ == "__main__":
    main()
