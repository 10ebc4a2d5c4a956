"""Golden power spectral densities for crates/noise/tests/it/spectrum.rs, by scipy.signal.welch.

python3 -m venv venv && venv/bin/pip install scipy==1.17.1 && venv/bin/python testdata/golden/welch.py

The series is the Lehmer generator of Riley's 1000-point set (NIST SP 1065, section 12.4).
"""

import json
import pathlib

import numpy
import scipy
from scipy import signal

state, series = 1234567890, []
for _ in range(1000):
    series.append(state / 2147483647)
    state = state * 16807 % 2147483647

cases = []
for segment in (64, 65, 256, 1000):
    f, p = signal.welch(numpy.array(series), fs=50.0, window="hann", nperseg=segment)
    cases.append({"segment": segment, "frequency_hz": f.tolist(), "density": p.tolist()})

golden = {
    "versions": {"numpy": numpy.__version__, "scipy": scipy.__version__},
    "rate_hz": 50.0,
    "cases": cases,
}
path = pathlib.Path(__file__).with_suffix(".json")
path.write_text(json.dumps(golden) + "\n")
