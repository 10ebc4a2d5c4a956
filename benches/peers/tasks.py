"""The tasks of identification, through undrift's Python package and through the peers.

Each function imports what it needs and returns the task, a function of the record: so that a process
holds what its own task needs, and importing is not timed. Ours return what the example `peers` prints.
`tasks.py WHO TASK FILE REPEATS` runs one on a file of float64.
"""

import math
import sys

from process import report

RATE_HZ = 100.0
# The orders that the Pandit-Wu procedure fits for n up to 2.
PANDIT_WU = [(1, 0), (1, 1), (2, 1), (3, 2), (4, 3)]
LEVEL = 0.05


def innovations_fit(record, p, q):
    """statsmodels' fit of ARMA(p, q) about a mean of zero: φ, θ with our sign, σ, log-likelihood."""
    from statsmodels.tsa.arima.estimators.innovations import innovations_mle

    result = innovations_mle(record, order=(p, 0, q), demean=False)
    model = result.parameters
    reported = -float(result.other_results.minimize_results.fun)
    return [*model.ar_params, *(-model.ma_params), math.sqrt(model.sigma2), reported]


def peer_arma(p, q):
    import statsmodels.tsa.arima.estimators.innovations  # noqa: F401

    return lambda record: innovations_fit(record, p, q)


def peer_pandit_wu():
    """A plain loop of fits with the F rule and the way down by BIC, as `undrift_noise::pandit_wu`."""
    import numpy as np
    import statsmodels.tsa.arima.estimators.innovations  # noqa: F401
    from scipy.stats import f

    def task(record):
        n = len(record)
        fits = {order: innovations_fit(record, *order) for order in PANDIT_WU}
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


def peer_allan(taus="octave"):
    import allantools
    import numpy as np

    def task(record):
        tau, deviation, _, _ = allantools.oadev(record, rate=RATE_HZ, data_type="freq", taus=taus)
        return np.column_stack([tau, deviation]).ravel()

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


def ours_allan(taus="octave", confidence=None):
    import numpy as np
    import undrift

    def task(record):
        found = undrift.allan(record, RATE_HZ, taus=taus, confidence=confidence)
        return np.column_stack([found.tau, found.deviation]).ravel()

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
    "arma_1_1": (lambda: ours_arma(1, 1), lambda: peer_arma(1, 1)),
    "arma_2_1": (lambda: ours_arma(2, 1), lambda: peer_arma(2, 1)),
    "arma_4_3": (lambda: ours_arma(4, 3), lambda: peer_arma(4, 3)),
    "pandit_wu": (ours_pandit_wu, peer_pandit_wu),
    "allan": (ours_allan, peer_allan),
    "allan_intervals": (lambda: ours_allan(confidence=0.683), peer_allan),
    "allan_all": (lambda: ours_allan("all"), lambda: peer_allan("all")),
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
