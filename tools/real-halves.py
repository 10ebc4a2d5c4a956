#!/usr/bin/env python3
"""Real records at rest, one half predicted from the other: real over predicted drift of the recommended models.

    tools/real-halves.py target/release/undrift DATA [RECORD ...]

Every axis is identified on one half of its record and scored on the other, both ways, as `identify` does it; of several
records of one type, those that the fit has not seen are scored (cross-validation). Prints a table for docs/lab/real-records.md: over the axes of a
record the geometric mean of real over predicted drift, and the range, at each horizon; then each axis outside of 0.7 to 1.4
beside the standard error of its score. The record of the MPU-6050 is a MATLAB file: it needs h5py, and has no row without.
"""

import gzip
import json
import math
import pathlib
import subprocess
import sys
import tempfile

HORIZONS = ["1", "10", "60", "300"]
BOUNDS = 0.7, 1.4


def ig500n(data, folder):
    """Text without times, 4.16 Hz by the name of the file; the second temperature, near the sensors."""
    path = folder / "ig500n.csv"
    with gzip.open(data / "static-ig500n-warmup/IG-500N_2.44h.txt.gz", "rt") as rows, open(path, "w") as out:
        out.write("t_s,gx_dps,gy_dps,gz_dps,ax_mps2,ay_mps2,az_mps2,temp_C\n")
        for k, row in enumerate(rows):
            row = row.split()
            out.write(",".join([f"{k / 4.16:.4f}", *row[6:9], *row[3:6], row[13]]) + "\n")
    return [path]


def mpu6050(data, folder):
    """Evenly spaced, since its stamps come in bursts."""
    try:
        import h5py
    except ImportError:
        return []
    def table(name):
        with h5py.File(data / f"static-mpu6050-temperature/mpu6050_{name}.mat") as file:
            return file[{"gyroscope": "gyroBuffer", "accelerometer": "accelBuffer", "temperature": "temperatureBuffer"}[name]][:]
    gyro, accel, temperature = map(table, ("gyroscope", "accelerometer", "temperature"))
    interval = (gyro[0, -1] - gyro[0, 0]) / (gyro.shape[1] - 1)
    path = folder / "mpu6050.csv"
    with open(path, "w") as out:
        out.write("t_s,gx_dps,gy_dps,gz_dps,ax_g,ay_g,az_g,temp_C\n")
        for k in range(gyro.shape[1]):
            values = [*gyro[1:, k], *accel[1:, k], temperature[1, k]]
            out.write(",".join([f"{k * interval:.5f}", *(f"{value:.7f}" for value in values)]) + "\n")
    return [path]


def records(data, folder):
    """Names, files and options."""
    for run in (1, 2, 4):
        yield f"ADIS16405, run{run}", [data / f"adis16405-static/run{run}.csv.gz"], ["--rate", "100"]
    yield "IG-500N, warm-up", ig500n(data, folder), []
    yield "MPU-6050", mpu6050(data, folder), []
    array = [data / f"dot-array-static/dot{k}.csv.gz" for k in range(1, 11)]
    for k, path in enumerate(array, 1):
        yield f"DOT {k}", [path], []
    yield "DOT 1 to 10 as one type", array, []


def main():
    undrift, data, wanted = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3:]
    print("| record | axes | 1 s | 10 s | 60 s | 300 s |\n|---|---|---|---|---|---|")
    outside = []
    with tempfile.TemporaryDirectory() as folder:
        for name, paths, options in records(data, pathlib.Path(folder)):
            if not paths or (wanted and not any(of in name for of in wanted)):
                continue
            found = subprocess.run([undrift, "identify", *paths, *options, "--json", "-"], capture_output=True, text=True)
            if found.returncode not in (0, 1) or not found.stdout.lstrip().startswith("{"):
                print(f"{name}: {found.stderr.strip()}", file=sys.stderr)
                continue
            axes = json.loads(found.stdout)["axes"]
            cells = []
            for horizon in HORIZONS:
                ratios = []
                for axis, of in axes.items():
                    chosen = of["chosen"]
                    real = chosen["drift_score"].get(horizon)
                    if real is None:
                        continue
                    ratio = real / chosen["drift_predicted"][horizon]
                    ratios.append(ratio)
                    if horizon != "1" and not BOUNDS[0] <= ratio <= BOUNDS[1]:
                        error = chosen["drift_score_error"][horizon] / real
                        outside.append(f"| {name} | {axis} | {horizon} s | {ratio:.2f} | {100 * error:.0f} % | {chosen['name']} |")
                if not ratios:
                    cells.append("")
                    continue
                mean = math.exp(sum(map(math.log, ratios)) / len(ratios))
                cells.append(f"{mean:.2f} ({min(ratios):.2f} to {max(ratios):.2f})")
            print(f"| {name} | {len(axes)} | {' | '.join(cells)} |", flush=True)
    print("\n| outside | axis | | real over predicted | standard error | recommended |\n|---|---|---|---|---|---|")
    print("\n".join(outside))


if __name__ == "__main__":
    main()
