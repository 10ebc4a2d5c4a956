"""Speed and memory of undrift's identification, from Rust and through its Python package, beside other
Python packages: same data, same answer checked first, one run, one table.

Every task runs in processes of its own with one thread. CPU time is that of the task alone (not of
starting, importing or reading the record), the best of several calls; memory is the peak of the whole
process. Through Python the ratio to the peer must be at least 0.9 of that from Rust, and the numbers
the same to the last digit. Use `benches/peers/run`, which prepares what is needed.
"""

import argparse
import importlib.metadata
import json
import math
import os
import platform
import subprocess
import sys
import tempfile
import time

PHI, THETA, SIGMA = 0.99995, 0.9994, 0.006
RATE_HZ = 100.0
# Share of the ratio from Rust that must be left through Python.
SHARE = 0.9
# Ours in turns from Rust and from Python, so that a busy machine slows both alike.
ROUNDS = 5


def simulate(samples, seed):
    """ARMA(1,1) x_t = PHI x_{t-1} + a_t - THETA a_{t-1}, stationary from the first sample."""
    import numpy as np
    from scipy.signal import lfilter

    generator = np.random.Generator(np.random.PCG64(seed))
    noise = generator.standard_normal(samples)
    # What the past contributes to x_0: variance (PHI - THETA)^2 / (1 - PHI^2).
    start = generator.standard_normal() * (PHI - THETA) / math.sqrt(1.0 - PHI * PHI)
    return SIGMA * lfilter([1.0, -THETA], [1.0, -PHI], noise, zi=[start])[0]


def log_likelihood(record, phi, theta):
    """Exact Gaussian log-likelihood, sigma at its best: Brockwell & Davis (1991), equation 8.7.4 with
    example 5.3.4. Slow and plain on purpose: the referee between the two fits."""
    ratio = (1.0 + theta * theta - 2.0 * phi * theta) / (1.0 - phi * phi)
    predicted, squares, logs = 0.0, [], []
    for value in record:
        error = value - predicted
        squares.append(error * error / ratio)
        logs.append(math.log(ratio))
        predicted = phi * value - theta / ratio * error
        ratio = 1.0 + theta * theta - theta * theta / ratio
    count = len(record)
    variance = math.fsum(squares) / count
    return -0.5 * (count * (math.log(2.0 * math.pi * variance) + 1.0) + math.fsum(logs))


# The peers. Imports inside, so that a process holds what its own task needs.


def peer_arma():
    from statsmodels.tsa.arima.estimators.innovations import innovations_mle

    def task(record):
        result = innovations_mle(record, order=(1, 0, 1), demean=False)
        model = result.parameters
        reported = -float(result.other_results.minimize_results.fun)
        return [model.ar_params[0], -model.ma_params[0], math.sqrt(model.sigma2), reported]

    return task


def peer_allan():
    import allantools

    def task(record):
        tau, deviation, _, _ = allantools.oadev(
            record, rate=RATE_HZ, data_type="freq", taus="octave"
        )
        return [number for pair in zip(tau, deviation) for number in pair]

    return task


def peer_adf():
    from statsmodels.tsa.stattools import adfuller

    def task(record):
        result = adfuller(record, maxlag=20, regression="c", autolag=None)
        return [result[0], result[1]]

    return task


def peer_ljung_box():
    from statsmodels.stats.diagnostic import acorr_ljungbox

    def task(record):
        table = acorr_ljungbox(record, lags=[20])
        return [table["lb_stat"].iloc[0], table["lb_pvalue"].iloc[0]]

    return task


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


# Ours through Python: the same values as the example `peers` prints.


def ours_arma():
    from undrift import arma

    def task(record):
        fit = arma.fit(record, (1, 1), mean=0.0)
        return [fit.ar[0], fit.ma[0], fit.sigma, fit.log_likelihood]

    return task


def ours_allan(confidence=None):
    import undrift

    def task(record):
        found = undrift.allan(record, RATE_HZ, confidence=confidence)
        return [number for pair in zip(found.tau, found.deviation) for number in pair]

    return task


def ours_allan_intervals():
    return ours_allan(0.683)


def ours_adf():
    import undrift

    def task(record):
        test = undrift.adf(record, lags=20)
        return [test.statistic, test.p_value]

    return task


def ours_ljung_box():
    import undrift

    def task(record):
        test = undrift.ljung_box(record, 20)
        return [test.statistic[0], test.p_value[0]]

    return task


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


TASKS = {
    "ours": {
        "arma": ours_arma,
        "allan": ours_allan,
        "allan_intervals": ours_allan_intervals,
        "adf": ours_adf,
        "ljung_box": ours_ljung_box,
        "jarque_bera": ours_jarque_bera,
        "normality": ours_normality,
        "phillips_perron": ours_phillips_perron,
    },
    "peer": {
        "arma": peer_arma,
        "allan": peer_allan,
        "allan_intervals": peer_allan,
        "adf": peer_adf,
        "ljung_box": peer_ljung_box,
        "jarque_bera": peer_jarque_bera,
        "normality": peer_normality,
        "phillips_perron": peer_phillips_perron,
    },
}


def peak_kib():
    with open("/proc/self/status") as status:
        for line in status:
            if line.startswith("VmHWM:"):
                return int(line.split()[1])
    raise OSError("/proc has no peak memory")


def run_task(who, name, path, repeats):
    import numpy as np

    task = TASKS[who][name]()
    record = np.fromfile(path, dtype="<f8")
    before, fastest = peak_kib(), math.inf
    for _ in range(repeats):
        start = time.process_time()
        values = task(record)
        fastest = min(fastest, time.process_time() - start)
    print(
        json.dumps(
            {
                "values": [float(value) for value in values],
                "cpu_s": fastest,
                "peak_kib": peak_kib(),
                "before_kib": before,
            }
        )
    )


def measure(command):
    """The result of a process, or a sentence on how it failed."""
    one = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "RAYON_NUM_THREADS": "1"}
    done = subprocess.run(
        command, capture_output=True, text=True, env={**os.environ, **one}
    )
    if done.returncode < 0:
        return None, f"killed by signal {-done.returncode}"
    if done.returncode > 0:
        lines = done.stderr.strip().splitlines()
        return None, lines[-1][:100] if lines else f"exit status {done.returncode}"
    return json.loads(done.stdout.strip().splitlines()[-1]), None


def in_turns(commands):
    """The best of several rounds of each command: result or None, and how it failed."""
    best = [None] * len(commands)
    for _ in range(ROUNDS):
        for k, command in enumerate(commands):
            found, fault = measure(command)
            if fault:
                return None, fault
            if best[k] is None or found["cpu_s"] < best[k]["cpu_s"]:
                best[k] = found
    return best, None


def relative(ours, peer):
    return abs(ours - peer) / max(abs(peer), sys.float_info.min)


def check_arma(ours, peer, record):
    record = record.tolist()
    mine = log_likelihood(record, ours[0], ours[1])
    theirs = log_likelihood(record, peer[0], peer[1])
    print(f"  ours: phi {ours[0]:.9f}, theta {ours[1]:.9f}, sigma {ours[2]:.9f}")
    print(f"  peer: phi {peer[0]:.9f}, theta {peer[1]:.9f}, sigma {peer[2]:.9f}")
    print(f"  reported log-likelihood: ours {ours[3]:.6f}, peer {peer[3]:.6f}")
    print(f"  referee's at these:      ours {mine:.6f}, peer {theirs:.6f}")
    assert abs(mine - ours[3]) < 1e-3, "our log-likelihood is not the exact one"
    assert mine >= theirs - 0.01, "our fit is below the peer's"
    if mine - theirs > 0.01:
        return f"peer ends {mine - theirs:.2g} below in log L"
    return f"log L: ours {mine - theirs:+.1e}"


def check_allan(ours, peer, _):
    mine = {round(t * RATE_HZ): d for t, d in zip(ours[::2], ours[1::2])}
    theirs = {round(t * RATE_HZ): d for t, d in zip(peer[::2], peer[1::2])}
    print(f"  ours: {len(mine)} points, {list(mine.values())[:3]} ...")
    print(f"  peer: {len(theirs)} points, {list(theirs.values())[:3]} ...")
    missing = sorted(set(theirs) - set(mine))
    assert not missing, f"averaging factors {missing} are missing in ours"
    worst = max(relative(mine[m], theirs[m]) for m in theirs)
    assert worst < 1e-10, f"deviations differ by {worst:.1e}"
    return f"{len(theirs)} points, {worst:.0e}"


def check_values(relative_to, absolute_p):
    """The statistic, relative; p, absolute; the rest relative."""

    def check(ours, peer, _):
        ours = ours[: len(peer)]
        print(f"  ours: {ours}\n  peer: {peer}")
        worst = max(relative(a, b) for a, b in zip(ours[:1] + ours[2:], peer[:1] + peer[2:]))
        assert worst < relative_to, f"statistics differ by {worst:.1e}"
        assert abs(ours[1] - peer[1]) < absolute_p, "p-values differ"
        return f"{worst:.0e}"

    return check


VALUES = check_values(1e-8, 1e-6)
# Title, task, peer's package, calls of ours a round, calls of the peer, check, most samples (the peer's
# autocorrelation takes quadratic time: 20 lags of 2 000 000 samples would be a quarter of an hour).
ROWS = [
    ("ARMA(1,1), exact likelihood", "arma", "statsmodels", 2, 1, check_arma, None),
    ("Overlapping Allan deviation, octaves", "allan", "allantools", 20, 3, check_allan, None),
    ("The same with intervals by noise type", "allan_intervals", "allantools", 20, 3, check_allan, None),
    ("ADF, constant, 20 lags", "adf", "statsmodels", 10, 3, VALUES, None),
    ("Ljung-Box, 20 lags", "ljung_box", "statsmodels", 30, 1, VALUES, 200_000),
    ("Jarque-Bera", "jarque_bera", "scipy", 20, 3, VALUES, None),
    ("Jarque-Bera and Lilliefors", "normality", "scipy, statsmodels", 5, 3, VALUES, None),
    ("Phillips-Perron, constant", "phillips_perron", "arch", 5, 3, VALUES, None),
]


def seconds(value):
    return f"{value:.1f} s" if value >= 10 else f"{value:.2f} s" if value >= 1 else f"{1e3 * value:.1f} ms"


def mebibytes(found):
    return f"{found['peak_kib'] / 1024:.0f} MiB"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=2_000_000)
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--example", help="the built example `peers`")
    parser.add_argument("--only", nargs="+", metavar="TASK", help="these tasks alone")
    parser.add_argument(
        "--task", nargs=4, metavar=("WHO", "TASK", "FILE", "REPEATS"), help=argparse.SUPPRESS
    )
    options = parser.parse_args()
    if options.task:
        who, name, path, repeats = options.task
        return run_task(who, name, path, int(repeats))
    if not options.example:
        parser.error("--example is needed: use benches/peers/run")

    versions = [f"Python {platform.python_version()}"] + [
        f"{name} {importlib.metadata.version(name)}"
        for name in ("numpy", "scipy", "statsmodels", "allantools", "arch")
    ]
    print(", ".join(versions))
    print(
        f"{options.samples} samples of ARMA(1,1), phi {PHI}, theta {THETA}, sigma {SIGMA}, "
        f"numpy's PCG64({options.seed})\n"
    )
    record = simulate(options.samples, options.seed)
    table, wrong = [], 0
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "record.f64")
        for title, task, package, calls, peer_calls, check, most in ROWS:
            if options.only and task not in options.only:
                continue
            if most and most < options.samples:
                title += f", {most} samples"
            record[:most].astype("<f8").tofile(path)
            print(f"{title}: ours against {package}", flush=True)

            def python(who, repeats):
                return [sys.executable, os.path.abspath(__file__), "--task", who, task, path, str(repeats)]

            ours, fault = in_turns([[options.example, task, path, str(calls)], python("ours", calls)])
            if fault:
                print(f"  ours failed: {fault}")
                table.append([title, package, "failed"] + [""] * 8 + [fault])
                wrong += 1
                continue
            rust, through = ours
            left = rust["cpu_s"] / through["cpu_s"]
            same = rust["values"] == through["values"]
            wrong += not same or left < SHARE
            says = f"{'pass' if same and left >= SHARE else 'FAIL'}, {left:.2f}"
            if not same:
                print(f"  through Python: {through['values']}")
                says = "FAIL: other numbers"
            print(f"  through Python: the same numbers: {same}; of the ratio is left {left:.3f}: {says}")
            row = [title, package, seconds(rust["cpu_s"]), seconds(through["cpu_s"])]
            peaks = [mebibytes(rust), mebibytes(through)]
            peer, fault = measure(python("peer", peer_calls))
            if fault:
                print(f"  peer failed: {fault}")
                table.append(row + ["failed", "", "", says] + peaks + ["", fault])
                continue
            try:
                verdict = check(rust["values"], peer["values"], record[:most])
            except AssertionError as error:
                verdict, wrong = f"WRONG: {error}", wrong + 1
            ratios = [f"{peer['cpu_s'] / one['cpu_s']:.3g}" for one in (rust, through)]
            table.append(
                row + [seconds(peer["cpu_s"])] + ratios + [says] + peaks + [mebibytes(peer), verdict]
            )
    head = ["task", "peer", "CPU, Rust", "CPU, Python", "CPU, peer", "ratio, Rust", "ratio, Python"]
    head += [f"at least {SHARE}", "peak, Rust", "peak, Python", "peak, peer", "difference"]
    widths = [max(len(row[k]) for row in [head, *table]) for k in range(len(head))]
    print()
    for row in [head, ["-" * width for width in widths], *table]:
        print("| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
