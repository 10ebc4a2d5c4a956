#!/usr/bin/env python3
"""The numbers of a recording by the rules of MATLAB, allan_variance_ros and imu_utils beside those of `undrift identify`.

    pip install numpy scipy
    python3 tools/other-rules.py [COMMAND] [HOURS] [SEED]

Simulated gyros of known noise at 100 Hz: a table in Markdown, as docs/lab/identify.md has it. Rules, from:

* MATLAB, "Inertial Sensor Noise Analysis Using Allan Variance": overlapping, 100 times; at the pair whose slope is nearest to -1/2, 1/2, 0
  a line of that slope, read at 1 s (N), 3 s (K), divided by 0.664 (B).
* allan_variance_ros 1d54b60, AllanVarianceComputor.cpp and analysis.py: clusters side by side, 0.1 to 999.9 s; lines of slope -1/2 through all
  times below 10 s (read at 1 s) and of 1/2 through all times (read at 3 s), in logarithms; B the least.
* imu_utils 2cdda91, fitallan_gyr.cpp: overlapping; five terms fitted to the logarithm of the variance; gyr_n = sqrt(rate) of the fit at 1 s,
  gyr_w its least value, which configurations of VINS take for the walk.
"""

import itertools
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

RATE = 100
N = 1e-4
B_FLOOR = np.sqrt(2 * np.log(2) / np.pi)


def process(random, count, sigma, tau):
    from scipy.signal import lfilter

    phi = np.exp(-1 / (RATE * tau))
    drive = sigma * np.sqrt(1 - phi * phi) * random.normal(size=count)
    drive[0] = sigma * random.normal()
    return lfilter([1], [1, -phi], drive)


def kinds(random, count):
    """Name, samples, and the true B and K over N, of kinds that have them."""
    from scipy.signal import butter, lfilter

    white = lambda: N * np.sqrt(RATE) * random.normal(size=count)
    walk = lambda: N / 30 / np.sqrt(RATE) * np.cumsum(random.normal(size=count))
    flicker = sum(
        process(random, count, 0.3 * N * np.sqrt(np.log(10) / 2 / np.pi), 0.016 * 10 ** (k / 2)) for k in range(15)
    )
    filtered = lfilter(*butter(2, 10 / (RATE / 2)), white())
    yield "white", white(), None, None
    yield "white + walk", white() + walk(), None, 1 / 30
    yield "white + flicker, B 0.3 N", white() + flicker, 0.3, None
    yield "white + Gauss-Markov, τ 100 s", white() + process(random, count, 0.39 * N, 100), None, None
    yield "white behind 10 Hz + walk", filtered + walk(), None, 1 / 30


def overlapping(samples, factors):
    theta = np.concatenate([[0], np.cumsum(samples)]) / RATE
    def variance(m):
        differences = theta[2 * m :] - 2 * theta[m:-m] + theta[: -2 * m]
        return np.mean(differences**2) / (2 * (m / RATE) ** 2)
    return np.array(factors) / RATE, np.array([variance(m) for m in factors])


def log_spaced(samples, count):
    most = np.log2(len(samples) / 2) // 1
    return np.unique(np.ceil(np.logspace(0, most * np.log10(2), count))).astype(int)


def matlab(samples):
    tau, variance = overlapping(samples, log_spaced(samples, 100))
    x, y = np.log10(tau), np.log10(variance) / 2
    slopes = np.diff(y) / np.diff(x)
    def at(slope, time):
        i = np.argmin(abs(slopes - slope))
        return 10 ** (y[i] + slope * (np.log10(time) - x[i]))
    return at(-0.5, 1), at(0, 1) / B_FLOOR, at(0.5, 3)


def allan_variance_ros(samples):
    sums = np.concatenate([[0], np.cumsum(samples)])
    tau, deviation = [], []
    for period in range(1, 10000):
        m = int(period * 0.1 * RATE)
        means = np.diff(sums[::m]) / m
        tau.append(period * 0.1)
        deviation.append(np.sqrt(np.mean(np.diff(means) ** 2) / 2))
    x, y = np.log(tau), np.log(deviation)
    line = lambda used, slope, time: np.exp(np.mean(y[used] - slope * x[used]) + slope * np.log(time))
    return line(slice(0, 99), -0.5, 1), min(deviation), line(slice(None), 0.5, 3)


def imu_utils(samples):
    tau, variance = overlapping(samples, log_spaced(samples, 100))
    powers = np.array([tau ** float(k) for k in (-2, -1, 0, 1, 2)])
    roots = np.sqrt(powers).T
    start = abs(np.linalg.lstsq(roots, np.sqrt(variance), rcond=None)[0])
    fit = lambda c: np.log10((c * c) @ powers) - np.log10(variance)
    scale = np.maximum(start, 1e-12)
    found = least_squares(lambda c: fit(c * scale), start / scale, max_nfev=2000).x * scale
    fitted = (found * found) @ powers
    at_one = found @ (found * np.ones(5))
    return np.sqrt(at_one), np.sqrt(min(fitted)), np.sqrt(min(fitted))


def undrift(command, samples, folder):
    record, result = Path(folder, "record.csv"), Path(folder, "result.json")
    times = np.arange(len(samples)) / RATE
    np.savetxt(record, np.c_[times, samples], delimiter=",", header="time,gx", comments="", fmt="%.10g")
    options = ["--columns", "gx", "--units", "rad/s,m/s^2", "--json", str(result), "-q"]
    subprocess.run([command, "identify", str(record), *options], check=True, stdout=subprocess.DEVNULL)
    axis = json.loads(result.read_text())["axes"]["gyro_x"]
    chosen = axis["chosen"]
    # The floor as the table of the command has it: where the upper end of the 68 % interval is within half of the deviation.
    points = zip(axis["allan"]["adev"], axis["allan"]["upper"])
    known = list(itertools.takewhile(lambda point: point[1] <= 1.5 * point[0], points))
    return chosen["white"], min(known)[0] / B_FLOOR, chosen["random_walk"], chosen["name"]


def main():
    command, hours, seed = (sys.argv[1:] + ["target/release/undrift", "3", "1"][len(sys.argv) - 1 :])[:3]
    count = int(float(hours) * 3600 * RATE)
    cell = lambda value: "–" if not value else f"{value / N:.3f}"
    print(f"{hours} h at {RATE} Hz, seed {seed}; N, B, K over the true N:\n")
    print("| noise | truth | MATLAB | allan_variance_ros | imu_utils: gyr_n/√rate, gyr_w | undrift | recommended |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name, samples, b, k in kinds(np.random.default_rng(int(seed)), count):
            truth = f"1, {b or '–'}, {f'{k:.3f}' if k else '–'}"
            of_imu_utils = ", ".join(cell(value) for value in imu_utils(samples)[:2])
            *ours, chosen = undrift(command, samples, folder)
            read = [", ".join(map(cell, rule(samples))) for rule in (matlab, allan_variance_ros)]
            print(f"| {name} | {truth} | {read[0]} | {read[1]} | {of_imu_utils} | {', '.join(map(cell, ours))} | {chosen} |", flush=True)


if __name__ == "__main__":
    main()
