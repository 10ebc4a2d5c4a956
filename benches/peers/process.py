"""Processes of one thread, measured: CPU time, peak memory, at most so much of both."""

import json
import math
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time

ONE_THREAD = {
    f"{name}_NUM_THREADS": "1" for name in ("OPENBLAS", "OMP", "MKL", "NUMBA", "RAYON")
}
# Ours in turns from Rust and from Python, so that a busy machine slows both alike ...
ROUNDS = 3
# ... but no more rounds once they took so long [s].
ENOUGH_S = 60.0
# A peer that needs more memory than this is not waited for [GiB].
MOST_GIB = 14


def peak_kib(process="self"):
    """Largest resident memory of a process so far [KiB]; 0 when it has ended."""
    with open(f"/proc/{process}/status") as status:
        for line in status:
            if line.startswith("VmHWM:"):
                return int(line.split()[1])
    return 0


def cpu_seconds():
    """CPU time of this process so far [s]. The kernel may bring it up to date only when a thread leaves the
    core: hence the nap."""
    time.sleep(0.002)
    return time.process_time()


def report(task, repeats=1):
    """Runs a task in this process and prints what `measure` reads: CPU time is the best of the calls."""
    before, fastest = peak_kib(), math.inf
    for _ in range(repeats):
        start = cpu_seconds()
        values = task()
        fastest = min(fastest, cpu_seconds() - start)
    found = {"values": [float(value) for value in values], "cpu_s": fastest}
    print(json.dumps({**found, "peak_kib": peak_kib(), "before_kib": before}))


def limited(limit_s):
    """What a child does before it starts: no more than so much CPU time [s] and memory."""

    def apply():
        most = MOST_GIB << 30
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
        if limit_s:
            resource.setrlimit(resource.RLIMIT_CPU, (limit_s, limit_s + 5))

    return apply


def measure(command, limit_s=None):
    """The result that a process prints in its last line, or a sentence on how it failed."""
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        env={**os.environ, **ONE_THREAD},
        preexec_fn=limited(limit_s),
    )
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL) and limit_s:
        return None, f"> {limit_s} s"
    if done.returncode < 0:
        return None, f"killed by signal {-done.returncode}"
    if done.returncode > 0:
        lines = done.stderr.strip().splitlines()
        if lines and "MemoryError" in lines[-1]:
            return None, f"> {MOST_GIB} GiB"
        return None, lines[-1][:100] if lines else f"exit status {done.returncode}"
    return json.loads(done.stdout.strip().splitlines()[-1]), None


def in_turns(commands):
    """The best of several rounds of each command: result or None, and how it failed."""
    best = [None] * len(commands)
    start = time.monotonic()
    for _ in range(ROUNDS):
        for k, command in enumerate(commands):
            found, fault = measure(command)
            if fault:
                return None, fault
            if best[k] is None or found["cpu_s"] < best[k]["cpu_s"]:
                best[k] = found
        if time.monotonic() - start > ENOUGH_S:
            break
    return best, None


def whole(command):
    """CPU time [s] and peak memory of a whole process with one thread, or a sentence on how it failed."""
    with tempfile.TemporaryFile() as told:
        child = subprocess.Popen(command, stdout=told, stderr=told, env={**os.environ, **ONE_THREAD})
        ended, peak = 0, 0
        # What wait4 tells of memory counts what this interpreter had when it forked: hence the looking.
        while not ended:
            peak = peak_kib(child.pid) or peak
            time.sleep(0.01)
            ended, status, used = os.wait4(child.pid, os.WNOHANG)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            told.seek(0)
            lines = told.read().decode(errors="replace").strip().splitlines()
            return None, lines[-1][:100] if lines else f"exit status {child.returncode}"
    return {"cpu_s": used.ru_utime + used.ru_stime, "peak_kib": peak}, None


def python(script, *arguments):
    """The command of a script beside this one, in this interpreter."""
    here = os.path.dirname(os.path.abspath(__file__))
    return [sys.executable, os.path.join(here, script), *map(str, arguments)]


def seconds(value):
    for least, factor, unit in ((10.0, 1.0, "s"), (1.0, 1.0, "s"), (1e-3, 1e3, "ms")):
        if value >= least:
            return f"{value * factor:.1f} {unit}" if least != 1.0 else f"{value:.2f} s"
    return f"{1e6 * value:.2f} µs"


def mebibytes(found):
    return f"{found['peak_kib'] / 1024:.0f} MiB"


def count(samples):
    """A number of samples as text: 20 k, 2 M."""
    for unit, name in ((1_000_000, "M"), (1_000, "k")):
        if samples >= unit:
            return f"{samples / unit:g} {name}"
    return str(samples)


def print_table(head, rows):
    widths = [max(len(row[k]) for row in [head, *rows]) for k in range(len(head))]
    print()
    for row in [head, ["-" * width for width in widths], *rows]:
        print("| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |")
    print(flush=True)
