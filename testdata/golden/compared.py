"""Golden fits for crates/noise/tests/it/compared.rs: power spectrum, autocorrelation and Allan bound of a series.

python3 -m venv venv && venv/bin/pip install scipy==1.17.1 statsmodels==0.15.0 && venv/bin/python testdata/golden/compared.py

The series is uniform white noise plus an AR(1) of 500 samples, both from the Lehmer generator of Riley's 1000-point set
(NIST SP 1065, section 12.4), 40 000 samples at 20 Hz. Spectrum by scipy.signal.welch, its terms by scipy.optimize.least_squares on the
logarithms; autocovariances by statsmodels, their line by numpy.polyfit; the bound by scipy.optimize.linprog on a grid of
correlation times, of Allan variances by their definition.
"""

import json
import pathlib

import numpy as np
import scipy
import statsmodels
from scipy import optimize, signal
from statsmodels.tsa.stattools import acf, acovf

N, RATE = 40_000, 20.0


def uniform(state, count):
    out = []
    for _ in range(count):
        out.append(state / 2147483647 - 0.5)
        state = state * 16807 % 2147483647
    return out


white, drive = uniform(1234567890, N), uniform(987654321, N)
series, slow = [], 0.0
for k in range(N):
    slow = 0.998 * slow + 0.02 * drive[k]
    series.append(white[k] + slow)
x = np.array(series)


def power_spectrum():
    segment = 1 << int(np.log2(N // 4))
    f, p = signal.welch(x, fs=RATE, window="hann", nperseg=segment)
    rows, measured, first = [], [], 2
    while f[2 * first - 1] <= 0.1 * RATE:
        k = slice(first, 2 * first)
        measured.append(p[k].mean() / 2)
        rows.append([1.0, (1 / f[k]).mean() / (2 * np.pi), (1 / f[k] ** 2).mean() / (2 * np.pi) ** 2])
        first *= 2
    rows, measured = np.array(rows), np.array(measured)
    found = min(
        (
            optimize.least_squares(
                lambda c: np.log(rows @ c / measured),
                start,
                bounds=(0, np.inf),
                x_scale=[1e-2, 1e-3, 1e-4],
                xtol=1e-15,
                ftol=1e-15,
                gtol=1e-15,
                max_nfev=10_000,
            )
            for start in ([4e-3, 1e-3, 1e-4], [4e-3, 1e-7, 1e-4], [4e-3, 1e-3, 1e-8])
        ),
        key=lambda r: r.cost,
    )
    return {"segment": segment, "octaves": measured.tolist(), "squares": found.x.tolist(), "cost": found.cost}


def autocorrelation():
    def averages(block):
        return x[: N // block * block].reshape(-1, block).mean(axis=1)

    def neighbours(block):
        return acf(averages(block), nlags=1)[1]

    block = max((20 * 2**i for i in range(12) if N // (20 * 2**i) >= 50), key=neighbours)
    y = averages(block)
    c = acovf(y, adjusted=False, nlag=len(y) // 4)
    after = int(np.argmax(c[1:] < c[1] / np.e))
    lags = np.arange(1, after + 1)
    slope, at_zero = np.polyfit(lags, np.log(c[1 : after + 1]), 1)
    t = block / RATE
    u = -slope
    square = np.exp(at_zero) * u**2 / (2 * (np.cosh(u) - 1))
    v = u / t  # of averages over 1 s
    n2 = averages(20).var() - square * 2 * (v - 1 + np.exp(-v)) / v**2
    return {"white": np.sqrt(n2), "sigma": np.sqrt(square), "tau_s": t / u, "block": block, "lags": after}


def allan_bound():
    s = np.concatenate([[0], np.cumsum(x)])
    taus, variances, m = [], [], 1
    while 9 * m <= N:
        d = s[2 * m :] - 2 * s[m:-m] + s[: -2 * m]
        taus.append(m / RATE)
        variances.append((d**2).mean() / (2 * m * m))
        m *= 2
    tau, var = np.array(taus), np.array(variances)
    best = None
    for i in range(int(10 * np.log2(N)) + 1):
        tc = tau[0] * 2 ** (i / 10)
        z = tau / tc
        g = 2 / z * (1 - (3 - 4 * np.exp(-z) + np.exp(-2 * z)) / (2 * z))
        g = np.where(z < 1e-3, 2 * z / 3 * (1 - z * 3 / 4), g)
        a = np.column_stack([1 / tau, g]) / var[:, None]
        scale = a.max(axis=0)
        r = optimize.linprog((a / scale).sum(axis=0), A_ub=-a / scale, b_ub=-np.ones(len(tau)))
        if r.status == 0 and (best is None or r.fun < best["excess"]):
            n2, s2 = r.x / scale
            best = {"tau_s": tc, "white": np.sqrt(n2), "sigma": np.sqrt(s2), "excess": r.fun}
    return best


golden = {
    "versions": {"numpy": np.__version__, "scipy": scipy.__version__, "statsmodels": statsmodels.__version__},
    "first": series[:3],
    "power_spectrum": power_spectrum(),
    "autocorrelation": autocorrelation(),
    "allan_bound": allan_bound(),
}
path = pathlib.Path(__file__).with_suffix(".json")
path.write_text(json.dumps(golden, indent=1) + "\n")
