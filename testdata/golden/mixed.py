"""Golden mixed models for crates/py/tests/test_fleet_effects.py, by dense matrices at the maximum of the restricted likelihood.

python3 -m venv venv && venv/bin/pip install statsmodels==0.15.0 scipy==1.17.1 && venv/bin/python testdata/golden/mixed.py

The search starts from MixedLM's variances. Drawn by numpy's default_rng (PCG64).
"""

import json
import pathlib

import numpy as np
import scipy
import statsmodels
from scipy.optimize import minimize
from statsmodels.regression.mixed_linear_model import MixedLM

PARTS, TYPES = 3, 2


def drawn(seed, spread):
    """Rows of logs of units: not balanced, some parts missing."""
    rng = np.random.default_rng(seed)
    unit, log, x, y = [], [], [], []
    logs = 0
    for u in range(12):
        of_unit = rng.normal(0.0, spread[0])
        kind = u % TYPES
        for _ in range(int(rng.integers(2, 8))):
            of_log = rng.normal(0.0, spread[1])
            temperature = round(float(rng.uniform(-30.0, 35.0)), 1)
            for part in range(PARTS):
                if rng.random() < 0.15:
                    continue
                row = [0.0] * PARTS + [temperature, float(kind)]
                row[part] = 1.0
                mean = 1.0 + 0.3 * part + 0.01 * temperature + 0.4 * kind
                unit.append(u)
                log.append(logs)
                x.append(row)
                y.append(round(mean + of_unit + of_log + rng.normal(0.0, spread[2]), 6))
            logs += 1
    return np.array(unit), np.array(log), np.array(x), np.array(y)


def dense(unit, log, x, y, variances):
    """The criterion, coefficients and standard errors by matrices of the size of the rows."""
    zu = (unit[:, None] == np.unique(unit)[None, :]).astype(float)
    zl = (log[:, None] == np.unique(log)[None, :]).astype(float)
    parts = [np.eye(len(y)), zl @ zl.T, zu @ zu.T]
    v = sum(s * m for s, m in zip(variances, parts))
    vi = np.linalg.inv(v)
    c = np.linalg.inv(x.T @ vi @ x)
    beta = c @ x.T @ vi @ y
    r = y - x @ beta
    n, p = x.shape
    criterion = (
        (n - p) * np.log(2 * np.pi)
        + np.linalg.slogdet(v)[1]
        - np.linalg.slogdet(c)[1]
        + r @ vi @ r
    )
    return criterion, beta, np.sqrt(np.diag(c))


cases = []
for seed, spread in ((1, (0.3, 0.4, 0.1)), (2, (0.8, 0.2, 0.3)), (3, (0.0, 0.4, 0.2))):
    unit, log, x, y = drawn(seed, spread)
    components = {"log": {u: [] for u in np.unique(unit)}}
    model = MixedLM(
        y,
        x,
        groups=unit,
        exog_re=np.ones((len(y), 1)),
        exog_vc=statsmodels.regression.mixed_linear_model.VCSpec(
            ["log"],
            [[[f"{u}-{k}" for k in np.unique(log[unit == u])] for u in np.unique(unit)]],
            [[(log[unit == u][:, None] == np.unique(log[unit == u])[None, :]).astype(float) for u in np.unique(unit)]],
        ),
    )
    found = model.fit(reml=True, method="lbfgs", maxiter=2000)
    variances = [found.scale, float(found.vcomp[0]), float(found.cov_re[0, 0])]
    # MixedLM stops at 1e-6 or so of the maximum: the dense criterion takes its place to the end.
    polished = minimize(
        lambda s: dense(unit, log, x, y, np.exp(s))[0],
        np.log(np.maximum(variances, 1e-9)),
        method="Nelder-Mead",
        options={"xatol": 1e-10, "fatol": 1e-12, "maxiter": 4000},
    )
    best = np.exp(polished.x)
    print(seed, variances, best, found.converged)
    if best[2] < 1e-6:
        best[2] = 0.0
    _, beta, errors = dense(unit, log, x, y, best)
    cases.append(
        {
            "unit": unit.tolist(),
            "log": log.tolist(),
            "x": x.tolist(),
            "y": y.tolist(),
            "variances": best.tolist(),
            "beta": beta.tolist(),
            "standard_error": errors.tolist(),
        }
    )

golden = {
    "versions": {
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "statsmodels": statsmodels.__version__,
    },
    "cases": cases,
}
path = pathlib.Path(__file__).with_suffix(".json")
path.write_text(json.dumps(golden) + "\n")
