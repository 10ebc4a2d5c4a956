"""Navigation of one simulated drive by undrift, pyins, sidereon, fusion-nav and strapdown-core, and undrift's commands
as whole processes. `navigation.py WHO FOLDER REPEATS` navigates a folder's logs and leaves WHO.f64 there."""

import os
import shutil
import subprocess
import sys
import tempfile

from process import (
    count,
    mebibytes,
    measure,
    print_table,
    python,
    report,
    seconds,
    whole,
)

TASKS = ["navigation", "whole"]
RATE_HZ = 100.0
# White noise, random walk of the bias, turn-on: what all the filters can model, with 15 states.
MODEL = """
format = "undrift-imu"
version = 1
name = "white noise and random walk"
[gyro]
white_noise = "0.3 deg/sqrt(h)"
random_walk = "30 deg/h/sqrt(h)"
turn_on = "0.1 deg/s"
[accel]
white_noise = "100 ug/sqrt(Hz)"
random_walk = "0.01 mg/sqrt(s)"
turn_on = "5 mg"
"""
# A receiver as good in every direction: pyins takes one standard deviation [m], [m/s].
POSITION_STD, VELOCITY_STD = 0.05, 0.03
# Errors that the start is given, and their standard deviations: roll, pitch, yaw [deg].
START_ERROR, START_STD = (0.3, -0.3, 1.0), (0.5, 0.5, 2.0)
# No agreement is asked for before the turns have shown the heading [s]; the car rests for a minute.
SETTLED_S = 120.0
# The filters are optimal for one model, but differ in when they step their covariance (pyins ten times a
# second, with first-order matrices) and in second-order terms: so far may the solutions lie apart, in
# parts of the error against the truth.
APART = 0.25


def densities():
    """The model in SI units: white noise, random walk and turn-on of gyros, then of accelerometers."""
    import math

    degree, g = math.pi / 180.0, 9.80665
    gyro = [0.3 * degree / 60.0, 30.0 * degree / 3600.0 / 60.0, 0.1 * degree]
    return gyro + [100e-6 * g, 0.01e-3 * g, 5e-3 * g]


def simulation(minutes, seed):
    import undrift

    receiver = undrift.GnssReceiver(
        position_std=(POSITION_STD,) * 3, velocity_std=(VELOCITY_STD,) * 3
    )
    model = undrift.NoiseModel.from_toml(MODEL, "imu.toml")
    return undrift.simulate(
        "car", 60.0 * minutes, RATE_HZ, model, gnss=receiver, bias_model="random-walk", seed=seed
    )


def write_logs(made, folder):
    """Raw float64 for the peers: imu and gnss by rows, and the start at the first fix."""
    import numpy as np

    imu, gnss, truth = made.imu, made.gnss, made.truth
    at = np.searchsorted(truth.time, gnss.time[0] - 1e-6)
    rpy = truth.rpy[at] + np.radians(START_ERROR)
    position = [gnss.lat, gnss.lon, gnss.height]
    files = {
        "imu": np.column_stack([imu.time, imu.gyro, imu.accel]),
        "gnss": np.column_stack([gnss.time, *position, gnss.velocity]),
        "start": np.r_[gnss.time[0], [part[0] for part in position], 0.0, 0.0, 0.0, rpy],
        "model": np.r_[densities(), POSITION_STD, VELOCITY_STD, np.radians(START_STD)],
        "truth": np.column_stack([truth.time, truth.lat, truth.lon, truth.height, truth.velocity, truth.rpy]),
    }
    for name, values in files.items():
        values.astype("<f8").tofile(os.path.join(folder, f"{name}.f64"))


def logs(folder, name, columns=None):
    import numpy as np

    values = np.fromfile(os.path.join(folder, f"{name}.f64"), dtype="<f8")
    return values if columns is None else values.reshape(-1, columns)


# What a drive has states for by default, and the other filters have not.
NO_MORE = {"time_offset": "off", "clock_rate": "off", "scale_factor": "off"}


def run_ours(folder, states=NO_MORE):
    """From arrays in memory to arrays in memory."""
    import numpy as np
    import undrift

    imu, gnss, start = logs(folder, "imu", 7), logs(folder, "gnss", 7), logs(folder, "start")
    drive = undrift.Drive(
        {"file": {"t_s": imu[:, 0], "gyro": imu[:, 1:4], "accel": imu[:, 4:7]},
         "time": "t_s", "gyro": ["gyro_x", "gyro_y", "gyro_z"], "gyro_unit": "rad/s",
         "accel": ["accel_x", "accel_y", "accel_z"], "accel_unit": "m/s^2", "rate": RATE_HZ},
        {"file": {"t_s": gnss[:, 0], "lat_rad": gnss[:, 1], "lon_rad": gnss[:, 2], "height_m": gnss[:, 3],
                  "vn": gnss[:, 4], "ve": gnss[:, 5], "vd": gnss[:, 6]},
         "time": "t_s", "position": ["lat_rad", "lon_rad", "height_m"], "position_unit": "rad",
         "velocity": ["vn", "ve", "vd"], "gate": False,
         "position_std": (POSITION_STD,) * 3, "velocity_std": (VELOCITY_STD,) * 3},
        undrift.NoiseModel.from_toml(MODEL, "imu.toml"),
        initial={"attitude": tuple(start[7:10]), "attitude_std": tuple(np.radians(START_STD)),
                 "velocity": (0.0, 0.0, 0.0), "velocity_std": (0.1,) * 3},
        states=states,
    )

    def task():
        found = undrift.navigate(drive, bias_model="random-walk", strict=False)
        return np.column_stack([found.time, found.lat, found.lon, found.height, found.velocity, found.rpy])

    return task


def run_by_default(folder):
    return run_ours(folder, None)


def run_pyins(folder):
    """pyins's feedback filter with its own step of the covariance, 0.1 s."""
    import numpy as np
    import pandas as pd
    from pyins import filters, inertial_sensor, measurements, strapdown
    from pyins.util import ACCEL_COLS, GYRO_COLS, LLA_COLS, TRAJECTORY_COLS, VEL_COLS

    imu, gnss, start = logs(folder, "imu", 7), logs(folder, "gnss", 7), logs(folder, "start")
    gyro_noise, gyro_walk, gyro_turn_on, noise, walk, turn_on = densities()
    step = 1.0 / RATE_HZ
    after = imu[imu[:, 0] > start[0] - 0.5 * step]
    # Rates are means over the interval: increments, of which the first is the "before" sample.
    increments = pd.DataFrame(step * after[:, 1:], index=after[:, 0], columns=GYRO_COLS + ACCEL_COLS)
    fixes = pd.DataFrame(gnss[1:, 1:], index=gnss[1:, 0], columns=LLA_COLS + VEL_COLS)
    fixes[["lat", "lon"]] = np.degrees(fixes[["lat", "lon"]])
    degrees = np.r_[np.degrees(start[1:3]), start[3:7], np.degrees(start[7:10])]
    pva = pd.Series(degrees, index=TRAJECTORY_COLS, name=after[0, 0])

    def task():
        found = filters.run_feedback_filter(
            pva,
            POSITION_STD,
            0.1,
            START_STD[0],
            START_STD[2],
            strapdown.compute_increments_from_imu(increments, "increment"),
            inertial_sensor.EstimationModel(gyro_turn_on, gyro_noise, gyro_walk),
            inertial_sensor.EstimationModel(turn_on, noise, walk),
            [
                measurements.Position(fixes, POSITION_STD),
                measurements.NedVelocity(fixes, VELOCITY_STD),
            ],
        ).trajectory
        values = found[TRAJECTORY_COLS].to_numpy()
        angles = np.radians(values[:, [0, 1, 6, 7, 8]])
        return np.column_stack([found.index, angles[:, :2], values[:, 2:6], angles[:, 2:]])

    return task


def errors(folder, who, other="truth"):
    """RMS differences of two solutions after SETTLED_S: horizontal, down [m], tilt, yaw [deg]."""
    import numpy as np

    one, two = logs(folder, who, 10), logs(folder, other, 10)
    ticks = [np.rint(RATE_HZ * solution[:, 0]).astype(int) for solution in (one, two)]
    _, first, second = np.intersect1d(*ticks, return_indices=True)
    one, two = one[first], two[second]
    late = one[:, 0] >= min(SETTLED_S, 0.5 * one[-1, 0])
    difference = (one - two)[late]
    assert len(difference) > 0 and np.isfinite(difference).all(), "no solution"
    # The least radius of the ellipsoid's curvature does for differences.
    north, east = 6.36e6 * difference[:, 1], 6.38e6 * np.cos(two[late, 1]) * difference[:, 2]
    angles = np.degrees((difference[:, 7:] + np.pi) % (2.0 * np.pi) - np.pi)
    rms = [north**2 + east**2, difference[:, 3] ** 2, angles[:, 0] ** 2 + angles[:, 1] ** 2, angles[:, 2] ** 2]
    return [float(np.sqrt(np.mean(part))) for part in rms]


def crate(name, version, source, system="a library", beside=("raw_logs.rs", "process.rs"), under="peers-crates", **others):
    """Builds a throw-away crate under target/ that runs a crate of the registry, and others that it needs.
    Its program, or why not: `system` names what a crate that wraps a library of the system looks for, `beside` the files
    that go beside `source`, `under` the folder of target/."""
    folder = os.path.join("target", under, name)
    os.makedirs(os.path.join(folder, "src"), exist_ok=True)
    here = os.path.dirname(os.path.abspath(__file__))
    for origin, copied in [(source, "main.rs"), *((path, os.path.basename(path)) for path in beside)]:
        shutil.copy(os.path.join(here, origin), os.path.join(folder, "src", copied))
    dependencies = [(name, f"={version}"), *others.items()]
    with open(os.path.join(folder, "Cargo.toml"), "w") as manifest:
        manifest.write(
            f'[workspace]\n[package]\nname = "peer-{name}"\nversion = "0.0.0"\nedition = "2024"\n'
            "[dependencies]\n" + "".join(f'{key} = "{value}"\n' for key, value in dependencies)
        )
    built = os.path.join(folder, "target")
    command = ["cargo", "build", "--quiet", "--release", "--manifest-path", os.path.join(folder, "Cargo.toml")]
    done = subprocess.run(command + ["--target-dir", built], capture_output=True, text=True)
    if done.returncode != 0:
        said = [line for line in done.stderr.splitlines() if line.startswith("error")]
        # Crates that link to libraries of the system end so by custom.
        if any("custom build command" in line and "-sys v" in line for line in said):
            return None, f"does not build: needs {system} of the system"
        return None, said[0][:100] if said else "does not build"
    return os.path.join(built, "release", f"peer-{name}"), None


def navigators(folder):
    """Title, name of the solution, command, or why it does not run."""
    yield "undrift, Python, in memory", "ours", python("navigation.py", "ours", folder, 5), None
    yield "undrift, Python, its default states", "defaults", python("navigation.py", "defaults", folder, 5), None
    yield "python-ins", "pyins", python("navigation.py", "pyins", folder, 1), None
    program, fault = crate("sidereon-core", "3.0.6", "sidereon.rs")
    yield "sidereon-core 3.0.6", "sidereon", [program, folder, "3"], fault
    program, fault = crate("fusion-nav", "0.1.0", "fusion_nav.rs")
    yield "fusion-nav 0.1.0, f32", "fusion_nav", [program, folder, "5"], fault
    program, fault = crate(
        "strapdown-core", "0.5.0", "strapdown_core.rs",
        system="libhdf5 and libnetcdf", nalgebra=">=0.33.3, <0.35.0",
    )
    yield "strapdown-core 0.5.0", "strapdown_core", [program, folder, "3"], fault


def beside_peers(options):
    made = simulation(options.minutes, options.seed)
    samples = len(made.imu.time)
    print(f"Navigation of {samples} samples and {len(made.gnss.time)} fixes, 15 states each", flush=True)
    rows, wrong, ours = [], 0, None
    with tempfile.TemporaryDirectory() as folder:
        write_logs(made, folder)
        for title, who, command, fault in navigators(folder):
            found = None
            if not fault:
                found, fault = measure(command, None if who == "ours" else options.limit)
            if fault:
                print(f"  {title}: {fault}")
                rows.append([title, fault] + [""] * 8)
                wrong += who == "ours"
                continue
            try:
                against = errors(folder, who)
            except AssertionError as error:
                print(f"  {title}: {error}")
                rows.append([title, str(error)] + [""] * 8)
                wrong += who == "ours"
                continue
            verdict = "the reference"
            if who == "ours":
                ours = (found, against)
            elif ours is None:
                continue
            else:
                apart = errors(folder, who, "ours")
                share = max(a / b for a, b in zip(apart, ours[1]))
                verdict = f"apart by {share:.2f} of our error"
                # Only pyins has the whole model and uses it. The others need not agree: f32 on a plane without the Earth's
                # rotation, gyro biases that run away, and a filter that adds noise of its own at every fix. Ours with
                # its default states has more than the 15.
                if share > APART:
                    verdict = f"another answer: {verdict}"
                    wrong += who == "pyins"
            print(f"  {title}: RMS horizontal, down [m], tilt, yaw [deg]: {against}; {verdict}", flush=True)
            ratio = found["cpu_s"] / ours[0]["cpu_s"]
            rows.append(
                [title, seconds(found["cpu_s"]), seconds(found["cpu_s"] / samples), f"{ratio:.3g}"]
                + [mebibytes(found)]
                + [f"{value:.3f}" for value in against]
                + [verdict]
            )
    head = ["navigation", "CPU", "a sample", "ratio", "peak"]
    print_table(head + ["horizontal [m]", "down [m]", "tilt [°]", "yaw [°]", "agreement"], rows)
    return wrong


def whole_processes(options):
    """The command on files of half an hour (or what `--samples` leaves), solution written."""
    import undrift

    duration = min(1800.0, max(options.samples / RATE_HZ, 300.0))
    rows, wrong = [], 0
    with tempfile.TemporaryDirectory() as folder:
        drive, rest = (
            undrift.simulate(kind, duration, RATE_HZ, "adis16405", seed=options.seed)
            for kind in ("car", "rest")
        )
        drive = str(drive.save(f"{folder}/drive"))
        record = str(rest.save(f"{folder}/rest").parent / "imu.csv")
        samples = len(rest.imu.time)
        navigate = ["navigate", drive, "--bias-model"]
        for title, arguments in [
            ("navigate, random-walk (15 states)", [*navigate, "random-walk", "-o", f"{folder}/nav.csv"]),
            ("navigate, arma (21 states)", [*navigate, "arma", "-o", f"{folder}/nav.csv"]),
            ("navigate, arma, no solution written", [*navigate, "arma"]),
            ("identify, six axes", ["identify", record, "--rate", "100", "-o", f"{folder}/imu.toml"]),
            ("outages, six models, 15 of 10 s", ["outages", drive, "--count", "15", "--length", "10"]),
        ]:
            best = None
            for _ in range(3):
                found, fault = whole([options.undrift, *arguments])
                if fault:
                    break
                if best is None or found["cpu_s"] < best["cpu_s"]:
                    best = found
                if found["cpu_s"] > 5.0:
                    break
            print(f"  {title}: {fault or seconds(best['cpu_s'])}", flush=True)
            if fault:
                rows.append([title, count(samples), fault, "", ""])
                wrong += 1
                continue
            each = seconds(best["cpu_s"] / samples)
            rows.append([title, count(samples), seconds(best["cpu_s"]), each, mebibytes(best)])
    print_table(["whole process", "samples", "CPU", "a sample", "peak"], rows)
    return wrong


def compare(options):
    """The tables of navigation. Returns how many rows are wrong."""
    wrong = 0
    if not options.only or "navigation" in options.only:
        wrong += beside_peers(options)
    if not options.only or "whole" in options.only:
        wrong += whole_processes(options)
    return wrong


def main():
    who, folder, repeats = sys.argv[1:]
    task = {"ours": run_ours, "defaults": run_by_default, "pyins": run_pyins}[who](folder)
    solution = None

    def timed():
        nonlocal solution
        solution = task()
        return [len(solution)]

    report(timed, int(repeats))
    solution.astype("<f8").tofile(os.path.join(folder, f"{who}.f64"))


if __name__ == "__main__":
    main()
