"""Golden comparisons of units, levels, temperatures and logs for crates/undrift/src/fleet/ratios/tests.rs, by scipy and statsmodels.

python3 -m venv venv && venv/bin/pip install scipy==1.17.1 statsmodels==0.15.0 && venv/bin/python testdata/golden/fleet_ratios.py

The fleets are drawn by numpy's PCG64. Variances are summed after Satterthwaite by hand; where units have equally many logs
their test is that of a dummy variable among their means.
"""

import json
import pathlib

import numpy as np
import scipy
import statsmodels
from scipy import stats
from statsmodels.regression.linear_model import OLS
from statsmodels.stats.multitest import multipletests

UNITS = 7


def mean_by_unit(unit, values):
    return np.array([values[unit == u].mean() for u in np.unique(unit)])


def interval(value, error, freedom):
    half = stats.t.ppf(0.975, freedom) * error
    return {
        "value": float(value),
        "low": float(value - half),
        "high": float(value + half),
        "freedom": float(freedom),
        "p": float(2 * stats.t.sf(abs(value / error), freedom)),
    }


def of_slope(fit, column=-1):
    return interval(fit.params[column], fit.bse[column], fit.df_resid)


cases = []
for seed, logs_of_unit in ((1, [4] * UNITS), (2, [2, 5, 3, 6, 2, 4, 3])):
    rng = np.random.Generator(np.random.PCG64(seed))
    unit = np.repeat(np.arange(UNITS), logs_of_unit)
    kind = unit % 2
    vehicle = np.arange(len(unit)) % 2
    # Of the first fleet temperatures differ between logs, of the second between units.
    place = np.round(rng.uniform(-10, 50, UNITS), 1)
    temperature = np.round(place[unit] if seed == 2 else rng.uniform(-10, 50, len(unit)), 1)
    y = rng.normal(0, 0.2, UNITS)[unit] + 0.3 * kind + 0.2 * vehicle + 0.01 * temperature
    y = np.round(y + rng.normal(0, 0.2, len(unit)), 6)
    v = y - y.mean()
    dummies = (unit[:, None] == np.arange(UNITS)).astype(float)
    means = mean_by_unit(unit, v)
    n = np.array(logs_of_unit)
    anova = OLS(v, dummies).fit()

    units = []
    for u in range(UNITS):
        others, shares = np.delete(means, u), np.delete(1 / n, u)
        count, spread = UNITS - 1, others.var(ddof=1)

        def summed(parts):
            variances = np.array(parts)
            freedom = variances.sum() ** 2 / (variances**2 / [count - 1, anova.df_resid]).sum()
            return interval(means[u] - others.mean(), np.sqrt(variances.sum()), freedom)

        # A mean of fewer logs than the others' scatters more.
        test = summed([spread * (1 + 1 / count), anova.scale * max(0, 1 / n[u] - shares.mean())])
        if seed == 1:
            x = np.column_stack([np.ones(UNITS), np.arange(UNITS) == u]).astype(float)
            dummy = of_slope(OLS(means, x).fit())
            assert np.allclose(list(dummy.values()), list(test.values()))
        units.append({"test": test, "ratio": summed([spread / count, anova.scale / n[u]])})

    a, b = means[1::2], means[::2]
    welch = stats.ttest_ind(a, b, equal_var=False)
    ends = welch.confidence_interval()
    kind_ratio = {
        "value": float(a.mean() - b.mean()),
        "low": float(ends.low),
        "high": float(ends.high),
        "freedom": float(welch.df),
        "p": float(welch.pvalue),
    }
    if seed == 1:
        slope = of_slope(OLS(v, np.column_stack([dummies, temperature])).fit())
    else:
        line = stats.linregress(place, means)
        slope = interval(line.slope, line.stderr, UNITS - 2)
    cases.append(
        {
            "unit": unit.tolist(),
            "kind": kind.tolist(),
            "vehicle": vehicle.tolist(),
            "temperature": temperature.tolist(),
            "y": y.tolist(),
            "units": units,
            "kind_ratio": kind_ratio,
            "vehicle_ratio": of_slope(OLS(v, np.column_stack([dummies, vehicle])).fit()),
            "slope": slope,
            "deleted": anova.get_influence().resid_studentized_external.tolist(),
        }
    )

p = [0.01, 0.04, 0.03, 0.9, 0.0]
golden = {
    "versions": {
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "statsmodels": statsmodels.__version__,
    },
    "cases": cases,
    "holm": {"p": p, "adjusted": multipletests(p, method="holm")[1].tolist()},
}
path = pathlib.Path(__file__).with_suffix(".json")
path.write_text(json.dumps(golden) + "\n")
