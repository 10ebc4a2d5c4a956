"""Drives by poses, on the room that ``undrift sample`` simulates."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undrift

Run = Callable[..., Any]

#: How much louder the sample's sensor is in the hand (crates/cli/src/sample.rs).
IN_HAND = 4.0


@pytest.fixture(scope="module")
def room(terminal: Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder: Path = tmp_path_factory.mktemp("sample")
    assert terminal("sample", folder, "-q").returncode == 0
    return folder / "room"


@pytest.fixture(scope="module")
def found(room: Path) -> undrift.Drive:
    return undrift.inspect(room / "imu.csv", room / "poses.txt")


@pytest.fixture(scope="module")
def imu(room: Path) -> dict[str, Any]:
    rows = np.loadtxt(room / "imu.csv", delimiter=",", skiprows=1)
    return {"time": rows[:, 0], "gyro [rad/s]": rows[:, 1:4], "accel [m/s^2]": rows[:, 4:7]}


@pytest.fixture(scope="module")
def poses(room: Path) -> dict[str, Any]:
    rows = np.loadtxt(room / "poses.txt")
    return {"time": rows[:, 0], "position": rows[:, 1:4], "attitude": rows[:, 4:8]}


#: How the sample's marker lies, in SI units; the same as a drive file has it.
KEYS: dict[str, Any] = {
    "attitude_order": "x,y,z,w",
    "axes": "x,-y,-z",
    "marker": np.radians([11.5, -5.7, 85.9]),
    "lever_arm": (0.05, 0.02, -0.1),
    "position_std": (1e-3, 1e-3, 1e-3),
    "attitude_std": np.radians([0.1, 0.1, 0.1]),
    "interval": 0.1,
    "time_offset": 0.02,
}
DRIVE = """
model = "mpu6050"
[imu]
file = "imu.csv"
time = "t_s"
gyro = ["gx_radps", "gy_radps", "gz_radps"]
gyro_unit = "rad/s"
accel = ["fx_mps2", "fy_mps2", "fz_mps2"]
accel_unit = "m/s^2"
[poses]
file = "poses.txt"
axes = "x,-y,-z"
marker = "11.5, -5.7, 85.9 deg"
lever_arm = "5, 2, -10 cm"
position_std = "1, 1, 1 mm"
attitude_std = "0.1, 0.1, 0.1 deg"
interval = "100 ms"
time_offset = "20 ms"
"""


def columns_of(imu: dict[str, Any]) -> dict[str, Any]:
    """The IMU as a log with its keys."""
    return {
        "file": {"time": imu["time"], "gyro": imu["gyro [rad/s]"], "accel": imu["accel [m/s^2]"]},
        "gyro_unit": "rad/s",
        "accel_unit": "m/s^2",
    }


def equal(one: undrift.Navigation, other: undrift.Navigation, tolerance: float = 1e-9) -> None:
    assert len(one.time) == len(other.time) > 17_000
    for name in ("lat", "lon", "height", "velocity", "rpy", "position_std", "attitude_std"):
        assert np.abs(getattr(one, name) - getattr(other, name)).max() <= tolerance, name


def test_arrays_give_what_files_give(
    room: Path, imu: dict[str, Any], poses: dict[str, Any]
) -> None:
    (room / "drive.toml").write_text(DRIVE)
    files = undrift.navigate(room / "drive.toml")
    drive = undrift.Drive(columns_of(imu), poses={"file": poses, **KEYS}, model="mpu6050")
    equal(undrift.navigate(drive), files)
    # The other order, as rows of a data frame, and keys of their own.
    x, y, z = poses["position"].T
    qx, qy, qz, qw = poses["attitude"].T
    frame = {"t_ms": 1e3 * poses["time"], "qw": qw, "qx": qx, "qy": qy, "qz": qz}
    frame |= {"x_m": x, "y_m": y, "z_m": z}
    of_log = {key: KEYS[key] for key in ("axes", "time_offset")}
    alone = {key: KEYS[key] for key in KEYS if key not in (*of_log, "attitude_order")}
    drive = undrift.Drive(
        columns_of(imu), poses={"file": frame, **of_log}, model="mpu6050", **alone
    )
    assert 'attitude = ["qx", "qy", "qz", "qw"]\nattitude_order = "x,y,z,w"' in drive.toml
    assert 'time_unit = "ms"' in drive.toml
    # Milliseconds are rounded otherwise.
    equal(undrift.navigate(drive), files, 1e-7)
    # Where names state the parts, their order in the table does not matter.
    log = {"file": frame, **of_log, "attitude_order": "w,x,y,z"}
    assert undrift.Drive(columns_of(imu), poses=log, model="mpu6050", **alone).toml == drive.toml
    turned = np.roll(poses["attitude"], 1, axis=1)
    log = {"file": {**poses, "attitude": turned}, **KEYS, "attitude_order": "w,x,y,z"}
    equal(undrift.navigate(columns_of(imu), poses=log, model="mpu6050"), files)


def test_what_is_found_of_arrays(
    found: undrift.Drive, imu: dict[str, Any], poses: dict[str, Any]
) -> None:
    drive = undrift.inspect(columns_of(imu)["file"], poses)
    keys = [line.partition(" #")[0] for line in found.toml.splitlines()]
    of_poses = keys[keys.index("[poses]") + 2 :]
    assert any(line.startswith("marker = ") for line in of_poses)
    for line in of_poses:
        assert line in drive.toml, line
    assert "[poses] 9000 records at 50 Hz" in drive.description
    equal(undrift.navigate(drive), undrift.navigate(found))


def test_what_is_estimated_has_a_name(found: undrift.Drive) -> None:
    state = found.align()
    for name, width in (("marker_rotation", 3), ("frame_tilt", 2)):
        value, std = state.parameters[name]
        assert value.shape == (width,) and (std > 0.0).all(), name
    done = undrift.navigate(found)
    assert done.verdict == "usable"
    assert done.nis["attitude"] is not None and 0.8 < done.nis["attitude"] < 1.2
    turn = done.data["summary"]["parameters"]["MarkerRotation"]["value"]
    # The hand-eye finds the marker to a degree.
    assert 0.0 < max(map(abs, turn)) < np.radians(1.0)


def test_outages(found: undrift.Drive) -> None:
    cut = undrift.outages(found, length=5.0, bias_models=["arma"])
    assert cut.reference == "gnss" and cut.models["arma"].outages
    assert 0.0 < cut.models["arma"].rms["horizontal_m"] < 1.0


def test_the_noise_in_the_hand(found: undrift.Drive, tmp_path: Path) -> None:
    tuning = undrift.tune(found)
    assert tuning.verdict == "usable"
    at_rest = undrift.NoiseModel.load("icm20602")
    white = {p.name.removesuffix(".white_noise"): p for p in tuning.parameters if p.name.endswith("white_noise")}
    assert len(white) == 6
    for name, parameter in white.items():
        simulated = at_rest.axes[name].white_noise
        assert simulated is not None
        assert parameter.low < IN_HAND * simulated < parameter.high, name
    names = {parameter.name for parameter in tuning.parameters}
    assert {"poses.std_factors.position", "poses.std_factors.attitude"} <= names
    assert "gyroscope_noise_density" in tuning.model.export("kalibr", rate=100.0)
    drift = {one.length_s: one for one in tuning.drift}
    assert drift[3.0].ratio < 1.0
    again = undrift.navigate(found.with_model(tuning.model))
    assert again.verdict == "usable"


def test_what_cannot_be_is_refused(
    found: undrift.Drive, imu: dict[str, Any], poses: dict[str, Any]
) -> None:
    log = {"file": poses, **KEYS}
    sim = undrift.simulate("car", 90.0, 50.0)
    for arguments in ({}, {"gnss": sim.gnss, "poses": log}):
        with pytest.raises(undrift.ArgumentError, match="needs gnss or poses, and not both"):
            undrift.Drive(sim.imu, model="mpu6050", **arguments)
    with pytest.raises(undrift.ArgumentError, match="marker: a key of poses, which is not given"):
        undrift.Drive(sim.imu, sim.gnss, "mpu6050", marker=(0.0, 0.0, 0.0))
    unordered = {key: item for key, item in log.items() if key != "attitude_order"}
    with pytest.raises(undrift.UndriftError, match=r"poses\.attitude_order: missing"):
        undrift.Drive(columns_of(imu), poses=unordered, model="mpu6050")
    with pytest.raises(undrift.UndriftError, match=r"poses\.attitude_std: missing"):
        undrift.Drive(columns_of(imu), poses={**log, "attitude_std": None}, model="mpu6050")
    wide = {**poses, "attitude": np.zeros((9000, 5))}
    with pytest.raises(undrift.ArgumentError, match="column attitude: invalid shape 9000 x 5"):
        undrift.Drive(columns_of(imu), poses={**log, "file": wide}, model="mpu6050")
    for begin in (undrift.Filter.from_drive, undrift.Navigator.from_drive, lambda drive: drive.gnss):
        with pytest.raises(undrift.UndriftError, match="the drive has poses, not fixes"):
            begin(found)


def test_simulated_poses_are_a_drive() -> None:
    axes = undrift.NoiseModel.load("icm20602").axes
    # Without turn-on constants, so that 40 s determine the clock and the marker.
    noise = {name: {"white_noise": axis.white_noise} for name, axis in axes.items()}
    sim = undrift.simulate("handheld", 40.0, 100.0, undrift.NoiseModel.of(**noise), seed=3)
    marker, arm = (0.2, -0.1, 1.5), (0.05, 0.02, -0.1)
    poses = sim.poses(25.0, marker=marker, lever_arm=arm, time_offset=0.02)
    assert {name: rows.shape for name, rows in poses.items()} == {
        "time": (1001,),
        "position": (1001, 3),
        "attitude": (1001, 4),
    }
    assert np.linalg.norm(poses["attitude"], axis=1) == pytest.approx(1.0)
    assert poses["time"][:2] == pytest.approx([-0.02, 0.02])
    # Up from where it begins.
    climbed = sim.truth.height[::4] - sim.truth.height[0]
    assert np.abs(poses["position"][:, 2] - climbed).max() < np.linalg.norm(arm) + 0.006
    lines = dict(
        line.partition(" #")[0].split(" = ", 1)
        for line in undrift.inspect(sim.imu, poses).toml.partition("[poses]")[2].splitlines()
        if " = " in line
    )
    found = [float(angle) for angle in lines["marker"].strip('"').removesuffix(" deg").split(",")]
    # To a degree and 2 cm, as the accelerations of 40 s show it.
    assert found == pytest.approx(np.degrees(marker).tolist(), abs=1.0)
    place = [float(one) for one in lines["lever_arm"].strip('"').removesuffix(" m").split(",")]
    assert place == pytest.approx(arm, abs=0.02)
    with pytest.raises(undrift.UndriftError, match="position_std: must be above 0"):
        sim.poses(position_std=0.0)
