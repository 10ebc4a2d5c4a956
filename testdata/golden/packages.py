"""Golden values for crates/noise/tests/it/packages.rs: what statsmodels, arch, scipy and allantools make of three series.

python3 -m venv venv && venv/bin/pip install numpy==2.4.6 scipy==1.17.1 statsmodels==0.15.0 arch==8.0.0 AllanTools==2024.6
venv/bin/python testdata/golden/packages.py

The series are of 600 samples, from the Lehmer generator of Riley's 1000-point set (NIST SP 1065, section 12.4) alone, so that the test
makes the same ones: an ARMA(2,1) about a mean, a random walk, and white noise beside an AR(1) of 50 samples.
"""

import json
import pathlib
import warnings

import allantools
import arch
import numpy as np
import scipy
import statsmodels
from arch.unitroot import PhillipsPerron
from scipy import stats
from statsmodels.stats.diagnostic import acorr_ljungbox
from statsmodels.tsa import adfvalues, stattools
from statsmodels.tsa.arima.model import ARIMA

N = 600
KINDS = ("n", "c", "ct")


def uniform(state, count):
    out = []
    for _ in range(count):
        out.append(state / 2147483647 - 0.5)
        state = state * 16807 % 2147483647
    return out


def made():
    drive = uniform(1234567890, N)
    white = uniform(987654321, N)
    arma, walk, slow = [], [], []
    for k in range(N):
        last = arma[k - 1] - 3.0 if k > 0 else 0.0
        before = arma[k - 2] - 3.0 if k > 1 else 0.0
        arma.append(3.0 + 1.2 * last - 0.4 * before + drive[k] - (0.5 * drive[k - 1] if k > 0 else 0.0))
        walk.append((walk[k - 1] if k > 0 else 0.0) + drive[k])
        level = 0.98 * level + 0.1 * drive[k] if k > 0 else 0.1 * drive[k]
        slow.append(level + white[k])
    return {"arma": arma, "walk": walk, "slow": slow}


def correlations(x):
    methods = ("ywmle", "ywadjusted", "burg")
    partial = {method: stattools.pacf(x, nlags=6, method=method).tolist() for method in methods}
    return {"acf": stattools.acf(x, nlags=12).tolist(), "acovf": stattools.acovf(x, nlag=4).tolist(), "pacf": partial}


def whiteness(x):
    table = acorr_ljungbox(x, lags=[3, 20], boxpierce=True)
    return {str(lag): [float(v) for v in row] for lag, row in zip(table.index, table.to_numpy())}


def normality(x):
    z = (x - x.mean()) / x.std(ddof=1)
    bera = stats.jarque_bera(x)
    return {
        "moments": [x.mean(), x.var(ddof=1), stats.skew(x), stats.kurtosis(x)],
        "jarque_bera": [float(bera.statistic), float(bera.pvalue)],
        "distance": float(stats.kstest(z, "norm").statistic),
    }


def dickey_fuller(x):
    rows = []
    for kind in KINDS:
        for lags in (0, 1, 5, "AIC", "BIC", "t-stat"):
            fixed = {"maxlag": lags, "autolag": None} if isinstance(lags, int) else {"maxlag": 8, "autolag": lags}
            result = stattools.adfuller(x, regression=kind, **fixed)
            critical = [result[4][level] for level in ("1%", "5%", "10%")]
            rows.append([kind, lags, result[0], result[1], int(result[2]), int(result[3]), *critical])
    return rows


def kpss(x):
    return [[kind, lags, *stattools.kpss(x, regression=kind, nlags=lags)[:3]] for kind in KINDS[1:] for lags in ("auto", "legacy", 7)]


def perron(x):
    def row(kind):
        tau, rho = (PhillipsPerron(x, trend=kind, lags=10, test_type=test) for test in ("tau", "rho"))
        return [kind, float(tau.stat), float(tau.pvalue), float(rho.stat)]

    return [row(kind) for kind in KINDS]


def likelihoods(x):
    """Of differences from the mean, at coefficients: the best innovations' variance for them too."""
    rows = []
    for ar, ma in [([0.9], [0.5]), ([1.2, -0.4], [0.5]), ([0.5, 0.2, -0.1, 0.05], [-0.3, -0.2, -0.1]), ([], [0.6, -0.3])]:
        model = ARIMA(x - x.mean(), order=(len(ar), 0, len(ma)), trend="n", concentrate_scale=True)
        # Theirs adds the moving average.
        found = model.smooth([*ar, *(-v for v in ma)])
        rows.append({"ar": ar, "ma": ma, "log_likelihood": float(found.llf), "variance": float(found.scale)})
    return rows


def fits(x):
    rows = []
    for order in [(1, 0, 0), (2, 0, 1), (1, 0, 1), (0, 1, 1)]:
        found = ARIMA(x, order=order, trend="n" if order[1] else "c").fit(method_kwargs={"maxiter": 2000, "pgtol": 1e-9, "factr": 10})
        p, q = order[0], order[2]
        rows.append({"order": list(order), "log_likelihood": float(found.llf), "ar": found.arparams.tolist(), "ma": (-found.maparams).tolist()})
    return rows


def deviations(x):
    found = {}
    for kind in ("oadev", "mdev", "ohdev", "totdev"):
        taus, values, _, counts = getattr(allantools, kind)(x, rate=10.0, data_type="freq", taus="octave")
        found[kind] = {"tau": taus.tolist(), "deviation": values.tolist(), "terms": [int(n) for n in counts]}
    return found


warnings.simplefilter("ignore")
golden = {
    "versions": {m.__name__: m.__version__ for m in (np, scipy, statsmodels, arch, allantools)},
    "mackinnon": {
        kind: {
            "critical": [[rows, *adfvalues.mackinnoncrit(N=1, regression=kind, nobs=rows).tolist()] for rows in (25, 100, 1000, 2_000_000)],
            "p": [[tau, float(adfvalues.mackinnonp(tau, regression=kind))] for tau in (-20.0, -5.0, -2.95, -2.85, -1.65, -1.57, -1.1, -1.0, 0.5, 3.0)],
        }
        for kind in KINDS
    },
}
for name, values in made().items():
    x = np.array(values)
    golden[name] = {
        "first": values[:3],
        "correlations": correlations(x),
        "whiteness": whiteness(x),
        "normality": normality(x),
        "dickey_fuller": dickey_fuller(x),
        "kpss": kpss(x),
        "perron": perron(x),
        "deviations": deviations(x),
    }
    if name != "walk":
        golden[name]["likelihoods"] = likelihoods(x)
    golden[name]["fits"] = fits(x) if name != "walk" else []


def lines(value, depth=0):
    """JSON with a line an entry to the third level."""
    if isinstance(value, dict) and depth < 3:
        inner = ",\n".join(" " * (depth + 1) + json.dumps(key) + ": " + lines(entry, depth + 1) for key, entry in value.items())
        return "{\n" + inner + "\n" + " " * depth + "}"
    return json.dumps(value)


path = pathlib.Path(__file__).with_suffix(".json")
path.write_text(lines(golden) + "\n")
