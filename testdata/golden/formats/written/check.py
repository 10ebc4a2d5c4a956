#!/usr/bin/env python3
"""Reads what the writers wrote beside this file with readers of others.

pip install pyyaml pynmeagps gpxpy lxml fastkml geojson shapely

The files come from the ignored tests `write_golden` of undrift-noise (tests/export.rs) and
undrift-io (tests/written.rs); other tests hold that the writers still write the same bytes.
"""

import math
from pathlib import Path

HERE = Path(__file__).parent
DEG = math.pi / 180


def close(ours, expected, relative=6e-9, absolute=0.0):
    ours = ours if isinstance(ours, list) else [ours]
    expected = expected if isinstance(expected, list) else [expected]
    assert len(ours) == len(expected), (ours, expected)
    for a, b in zip(ours, expected):
        assert isinstance(a, (int, float)), f"{a!r} is no number"
        assert abs(a - b) <= relative * abs(b) + absolute, (ours, expected)


# The model of crates/noise/tests/export.rs, in SI units. Nine digits are written: 6e-9.
WHITE = [0.3 * DEG / 60, 0.3 * DEG / 60, 0.6 * DEG / 60]
DRIVE = 9 * DEG / 3600 * math.sqrt(2 / 200)
TURN_ON_Z = 12 * DEG / 3600


def rms(values):
    return math.sqrt(sum(v * v for v in values) / len(values))


def models():
    import yaml

    def load(name):
        return yaml.safe_load((HERE / name).read_text(encoding="utf-8"))

    imu = load("imu.kalibr.yaml")
    assert set(imu) == {
        "accelerometer_noise_density", "accelerometer_random_walk", "gyroscope_noise_density",
        "gyroscope_random_walk", "rostopic", "update_rate",
    }
    close(imu["gyroscope_noise_density"], rms(WHITE))
    close(imu["gyroscope_random_walk"], DRIVE)
    close(imu["accelerometer_noise_density"], 1e-3)
    close(imu["accelerometer_random_walk"], 1e-4)
    close(imu["update_rate"], 100.0)
    assert imu["rostopic"].startswith("/")

    # The filter of KF-GINS turns these into q = 2 std²/corrtime.
    kf = load("imu.kf-gins.yaml")
    noise = kf["imunoise"]
    close([v * DEG / 60 for v in noise["arw"]], WHITE)
    close([v / 60 for v in noise["vrw"]], [1e-3] * 3)
    tau = noise["corrtime"] * 3600
    close([v * DEG / 3600 * math.sqrt(2 / tau) for v in noise["gbstd"]], [DRIVE] * 3)
    close([v * 1e-5 * math.sqrt(2 / tau) for v in noise["abstd"]], [1e-4] * 3)
    assert noise["gsstd"] == noise["asstd"] == [0.0] * 3
    close(kf["initbgstd"][2] ** 2 - kf["initbgstd"][0] ** 2, 144.0, relative=1e-6)

    ros = load("imu.ros.yaml")["imu"]["ros__parameters"]
    close([ros["angular_velocity_covariance"][i] for i in (0, 4, 8)], [n * n * 100 for n in WHITE])
    close([ros["linear_acceleration_covariance"][i] for i in (0, 4, 8)], [1e-4] * 3)
    assert all(len(ros[f"{q}_covariance"]) == 9 for q in ("angular_velocity", "linear_acceleration", "orientation"))
    assert ros["orientation_covariance"][0] == -1

    rows = [
        line.split("\t")
        for line in (HERE / "imu.px4.params").read_text(encoding="utf-8").splitlines()
        if not line.startswith("#")
    ]
    px4 = {name: float(value) for _, _, name, value, kind in rows if kind == "9"}
    # EKF2 adds (noise dt)² a prediction: over one second of 100 it must be N².
    close([(px4["EKF2_GYR_NOISE"] * 0.01) ** 2 * 100], [rms(WHITE) ** 2], relative=2e-8)
    close([(px4["EKF2_ACC_B_NOISE"] * 0.01) ** 2 * 100], [1e-8], relative=2e-8)
    close(px4["EKF2_GBIAS_INIT"], TURN_ON_Z / math.sqrt(3))
    print("models: kalibr, kf-gins, ros (PyYAML) and px4 hold what the model says")


if __name__ == "__main__":
    models()
