"""Golden critical values and p of the Dickey-Fuller statistic for crates/noise/tests/it/stationarity.rs, by statsmodels.

python3 -m venv venv && venv/bin/pip install statsmodels==0.15.0 scipy==1.17.1 && venv/bin/python testdata/golden/mackinnon.py

Critical values at 1, 5 and 10 % by the response surfaces of MacKinnon (2010), p by his two polynomials of 1994: of
each regression the tau up to which the polynomial of small p holds, p there, just above it and around it, and at
the ends of the range.
"""

import json
import pathlib

import numpy
import scipy
import statsmodels
from statsmodels.tsa.adfvalues import _tau_maxs, _tau_mins, _tau_stars, mackinnoncrit, mackinnonp

regressions = {}
for name in ("n", "c", "ct"):
    switch, least, most = (float(table[name][0]) for table in (_tau_stars, _tau_mins, _tau_maxs))
    taus = [least - 0.01, least, -6.0, -4.0, -3.0, -2.0]
    taus += [switch + step for step in (-0.5, -0.05, 0.0, 1e-9, 0.05, 0.5)]
    taus += [-1.0, 0.0, 0.5, *((most, most + 0.01) if numpy.isfinite(most) else (1.0, 3.0))]
    regressions[name] = {
        "critical": [
            {"rows": rows, "values": mackinnoncrit(N=1, regression=name, nobs=rows).tolist()}
            for rows in (20, 25, 50, 100, 250, 1000, 2_000_000)
        ],
        "switch": switch,
        "p": [{"tau": tau, "p": float(mackinnonp(tau, regression=name, N=1))} for tau in taus],
    }

golden = {
    "versions": {
        "numpy": numpy.__version__,
        "scipy": scipy.__version__,
        "statsmodels": statsmodels.__version__,
    },
    "regressions": regressions,
}
path = pathlib.Path(__file__).with_suffix(".json")
path.write_text(json.dumps(golden) + "\n")
