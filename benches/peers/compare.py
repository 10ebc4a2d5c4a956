"""Speed and memory of undrift, from Rust and through its Python package, beside other packages: same
data, same answer checked first, one run, one table for identification and two for navigation.

Every task runs in processes of its own with one thread. CPU time is that of the task alone (not of
starting, importing or reading the record), the best of several calls; memory is the peak of the whole
process. Through Python the ratio to the peer must be at least 0.9 of that from Rust, and the numbers
the same to the last digit. Use `benches/peers/run`, which prepares what is needed.
"""

import argparse
import importlib.metadata
import os
import platform
import sys
import tempfile

import navigation
from checks import (
    check_allan,
    check_arma,
    check_correlations,
    check_pandit_wu,
    check_values,
    simulate,
)
from process import count, in_turns, mebibytes, measure, print_table, python, seconds
from tasks import MODELS, SIGMA

# Share of the ratio from Rust that must be left through Python.
SHARE = 0.9
MILLION = 1_000_000
SIZES = (100_000, MILLION, 2 * MILLION)
LONG = (2 * MILLION,)
# Title, task, order of the record, sizes, peer's package, calls of ours a round, calls of the peer, check.
# Sizes are what the peer can do: Ljung-Box's autocorrelation and the Allan deviation at all τ take quadratic
# time there, and one fit after the other takes minutes. All τ is compared at 100 000 samples; at the longer
# ones the peer is stopped and the ratio a bound.
ROWS = [
    ("ARMA(1,1)", "arma_1_1", (1, 1), SIZES, "statsmodels", 2, 1, check_arma(1, 1)),
    ("ARMA(2,1)", "arma_2_1", (2, 1), SIZES, "statsmodels", 1, 1, check_arma(2, 1)),
    ("ARMA(4,3)", "arma_4_3", (4, 3), SIZES, "statsmodels", 1, 1, check_arma(4, 3)),
    ("ARMA(1,1), peer's own start", "arma_1_1_own", (1, 1),
     (100_000, *LONG), "statsmodels", 2, 1, check_arma(1, 1)),
    ("ARMA(2,1), peer's own start", "arma_2_1_own", (2, 1), (100_000,), "statsmodels", 1, 1, check_arma(2, 1)),
    ("ARMA(4,3), peer's own start", "arma_4_3_own", (4, 3), (100_000,), "statsmodels", 1, 1, check_arma(4, 3)),
    ("Pandit-Wu to (4,3), five fits", "pandit_wu", (2, 1), (20_000,), "statsmodels", 1, 1, check_pandit_wu),
    ("Overlapping Allan deviation, octaves", "allan", (1, 1),
     (*LONG, 20 * MILLION), "allantools", 10, 3, check_allan),
    ("The same with intervals by noise type", "allan_intervals", (1, 1),
     LONG, "allantools", 20, 3, check_allan),
    ("Overlapping Allan deviation, all τ", "allan_all", (1, 1),
     (100_000, *LONG, 20 * MILLION), "allantools", 3, 1, check_allan),
    ("Overlapping Allan deviation, octaves", "allan_sidereon", (1, 1),
     (*LONG, 20 * MILLION), "sidereon", 10, 3, check_allan),
    ("Overlapping Allan deviation, all τ", "allan_all_sidereon", (1, 1), (100_000,), "sidereon", 3, 1, check_allan),
    ("Modified Allan deviation, octaves", "allan_modified", (1, 1), LONG, "sidereon", 10, 3, check_allan),
    ("Overlapping Hadamard deviation, octaves", "allan_hadamard", (1, 1), LONG, "sidereon", 10, 3, check_allan),
    ("ADF, constant, 20 lags", "adf", (1, 1), LONG, "statsmodels", 10, 3, check_values),
    ("KPSS, level, 40 lags", "kpss", (1, 1), LONG, "statsmodels", 10, 3, check_values),
    ("Phillips-Perron, constant", "phillips_perron", (1, 1), LONG, "arch", 5, 3, check_values),
    ("Ljung-Box, 20 lags", "ljung_box", (1, 1), (200_000,), "statsmodels", 30, 1, check_values),
    ("Autocorrelation, 100 lags", "acf", (1, 1), LONG, "statsmodels", 5, 3, check_correlations),
    ("Jarque-Bera", "jarque_bera", (1, 1), LONG, "scipy", 20, 3, check_values),
    ("Jarque-Bera and Lilliefors", "normality", (1, 1), LONG, "scipy, statsmodels", 5, 3, check_values),
]
HEAD = ["task", "samples", "peer", "CPU, Rust", "CPU, Python", "CPU, peer", "ratio, Rust", "ratio, Python"]
HEAD += [f"at least {SHARE}", "peak, Rust", "peak, Python", "peak, peer", "difference"]


def one(row, samples, record, path, options):
    """One line of the table, and whether something is wrong."""
    title, task, _, _, package, calls, peer_calls, check = row
    record.astype("<f8").tofile(path)
    print(f"{title}, {samples} samples: ours against {package}", flush=True)
    line = [title, count(samples), package]

    def command(who, repeats):
        return python("tasks.py", who, task, path, repeats)

    rust = [options.statistics, task.removesuffix("_own").removesuffix("_sidereon"), path, str(calls)]
    ours, fault = in_turns([rust, command("ours", calls)])
    if fault:
        print(f"  ours failed: {fault}")
        return line + ["failed"] + [""] * (len(HEAD) - 5) + [fault], True
    rust, through = ours
    left = rust["cpu_s"] / through["cpu_s"]
    same = rust["values"] == through["values"]
    wrong = not same or left < SHARE
    says = f"{'FAIL' if wrong else 'pass'}, {left:.2f}"
    if not same:
        print(f"  through Python: {through['values'][:10]}")
        says = "FAIL: other numbers"
    print(f"  through Python: the same numbers: {same}; of the ratio is left {left:.3f}: {says}")
    line += [seconds(rust["cpu_s"]), seconds(through["cpu_s"])]
    peaks = [mebibytes(rust), mebibytes(through)]
    peer, fault = measure(command("peer", peer_calls), options.limit)
    if fault:
        print(f"  peer: {fault}", flush=True)
        # A peer that was stopped gives a bound of the ratio.
        bounds = [f"> {options.limit / mine['cpu_s']:.3g}" for mine in ours]
        ratios = bounds if fault == f"> {options.limit} s" else ["", ""]
        return line + [fault] + ratios + [says] + peaks + ["", "not compared"], wrong
    try:
        verdict = check(rust["values"], peer["values"], record)
    except AssertionError as error:
        verdict, wrong = f"WRONG: {error}", True
    ratios = [f"{peer['cpu_s'] / mine['cpu_s']:.3g}" for mine in ours]
    print(f"  {verdict}; {seconds(peer['cpu_s'])} of the peer, ratio {ratios[0]}", flush=True)
    line += [seconds(peer["cpu_s"]), *ratios, says, *peaks, mebibytes(peer), verdict]
    return line, wrong


def identification(options):
    """The table of identification. Returns how many rows are wrong."""
    rows = [row for row in ROWS if not options.only or row[1] in options.only]
    table, wrong, records = [], 0, {}
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "record.f64")
        for row in rows:
            order, sizes = row[2:4]
            # A quick run has each task once, at its least size or what was asked for.
            for samples in sorted({min(size, options.samples) for size in sizes}):
                if len(records.get(order, [])) < samples:
                    records = {order: simulate(order, samples, options.seed)}
                line, bad = one(row, samples, records[order][:samples], path, options)
                print(f"| {' | '.join(line)} |\n", flush=True)
                table.append(line)
                wrong += bad
    if table:
        print_table(HEAD, table)
    return wrong


def versions():
    for name in ("numpy", "scipy", "statsmodels", "allantools", "arch", "sidereon", "python-ins"):
        try:
            yield f"{name} {importlib.metadata.version(name)}"
        except importlib.metadata.PackageNotFoundError:
            yield f"no {name}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=20 * MILLION, help="at most so many a record")
    parser.add_argument("--minutes", type=float, default=10.0, help="length of the drive beside peers")
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--limit", type=int, default=200, help="CPU time left to a peer [s]")
    parser.add_argument("--statistics", required=True, help="the built program `peers` of tools/lab")
    parser.add_argument("--undrift", required=True, help="the built command")
    names = [row[1] for row in ROWS] + navigation.TASKS
    parser.add_argument("--only", nargs="+", metavar="TASK", choices=names, help=f"of {', '.join(names)}")
    options = parser.parse_args()
    print(", ".join([f"Python {platform.python_version()}", *versions()]))
    print(f"records by numpy's PCG64({options.seed}), sigma {SIGMA}: phi, theta {list(MODELS.values())}\n")
    wrong = identification(options)
    wrong += navigation.compare(options)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
