"""Navigator: pushed while driving it is navigate, whatever comes late."""

from __future__ import annotations

import asyncio
import struct
import subprocess
import sys
import threading
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undrift
from conftest import ROOT

FIELDS = ("lat", "lon", "height", "velocity", "rpy", "position_std", "velocity_std",
          "attitude_std", "gyro_error", "accel_error", "gyro_error_std", "accel_error_std")


@pytest.fixture(scope="module")
def sim() -> undrift.Simulation:
    return undrift.simulate("car", 120.0, 50.0, "adis16465", seed=7)


@pytest.fixture(scope="module")
def sampled(
    terminal: Callable[..., subprocess.CompletedProcess[str]],
    tmp_path_factory: pytest.TempPathFactory,
) -> Path:
    """The drive file of `undrift sample`."""
    folder = tmp_path_factory.mktemp("sample")
    done = terminal("sample", folder / "logs", "-q")
    assert done.returncode == 0, done.stderr
    return folder / "logs" / "drive" / "drive.toml"


def items(
    imu: undrift.ImuLog, gnss: undrift.GnssLog, late: Callable[[int], float]
) -> list[undrift.Sample | undrift.Fix]:
    """Samples and fixes in order of arrival."""
    coming: list[tuple[float, int, Any]] = [
        (t, 1, undrift.Sample(t, g, a)) for t, g, a in zip(imu.time, imu.gyro, imu.accel, strict=True)
    ]
    coming += [(t + late(k), 0, undrift.Fix(t, **gnss.fix(k))) for k, t in enumerate(gnss.time)]
    return [item for _, _, item in sorted(coming, key=lambda one: one[:2])]


def test_with_late_fixes_it_is_navigate_on_the_sample(sampled: Path) -> None:
    drive = undrift.Drive.load(sampled)
    done = undrift.navigate(drive, strict=False)
    pushed = undrift.Navigator.from_drive(drive, horizon=2.0)
    imu, gnss = drive.imu, drive.gnss
    # 0.05 to 1.5 s late; the last samples come after all of them.
    came = items(imu, gnss, lambda k: 0.05 + (k * 7919 % 1000) * 1.45e-3)
    came = [item for item in came if item.time < imu.time[-3]] + [
        undrift.Sample(imu.time[k], imu.gyro[k], imu.accel[k]) for k in (-3, -2, -1)
    ]
    for item in came:
        pushed.push(item)
    state = pushed.state
    assert state is not None and pushed.too_late == 0
    at = int(np.searchsorted(done.time, state.time))
    assert done.time[at] == state.time and at > len(done) - 5
    for name in FIELDS:
        mine, theirs = np.asarray(getattr(state, name)), getattr(done, name)[at]
        assert np.all(np.abs(mine - theirs) <= 1e-9 * np.maximum(1.0, np.abs(theirs))), name
    kinds = [event.kind for event in pushed.events()]
    assert kinds[0] == "started" and "too_late" not in kinds


def test_many_samples_are_one_after_the_other(sim: undrift.Simulation) -> None:
    one, many = (undrift.Navigator("adis16465", 50.0, vehicle="car") for _ in range(2))
    for navigator in (one, many):
        for k in range(len(sim.gnss.time)):
            assert navigator.fix(sim.gnss.time[k], **sim.gnss.fix(k))
    solution = many.imu_many(sim.imu.time, sim.imu.gyro, sim.imu.accel)
    given = [
        item
        for item in one.run(items(sim.imu, sim.gnss, lambda _: 1e9))
        if isinstance(item, undrift.FilterState)
    ]
    assert len(given) == len(solution) > 1000
    assert np.array_equal([state.lat for state in given], solution.lat)
    assert np.array_equal([state.rpy for state in given], solution.rpy)
    assert {"mounting", "time_offset"} <= set(given[-1].parameters)


def test_events_and_solutions_come_asynchronously(sim: undrift.Simulation) -> None:
    navigator = undrift.Navigator("adis16465", 50.0, horizon=0.5)

    async def source() -> AsyncIterator[undrift.Sample | undrift.Fix]:
        # One fix in five is later than the horizon.
        for item in items(sim.imu, sim.gnss, lambda k: 0.9 if k % 5 == 0 else 0.2):
            await asyncio.sleep(0)
            yield item

    async def run() -> list[undrift.Event | undrift.FilterState]:
        return [given async for given in navigator.arun(source())]

    given = asyncio.run(run())
    events = [item for item in given if isinstance(item, undrift.Event)]
    late = [event for event in events if event.kind == "too_late"]
    assert late and len(late) <= navigator.too_late
    assert {event.time for event in late} <= set(sim.gnss.time[::5])
    assert "horizon" in late[0].text and "--" not in late[0].text
    begun = [item.time for item in given if isinstance(item, undrift.FilterState)]
    assert begun[0] >= next(event.time for event in events if event.kind == "started")
    assert np.all(np.diff(begun) > 0.0)


def test_what_is_refused_leaves_it_as_it_was(sim: undrift.Simulation) -> None:
    navigator = undrift.Navigator("adis16465", 50.0)
    assert navigator.state is None and repr(navigator) == "Navigator(not aligned)"
    gyro, accel = (0.0, 0.0, 0.0), (0.0, 0.0, -9.81)
    assert not navigator.imu(1.0, gyro, accel)
    with pytest.raises(undrift.UndriftError, match="does not follow"):
        navigator.imu(1.0, gyro, accel)
    with pytest.raises(undrift.UndriftError, match="not finite"):
        navigator.imu(1.02, (0.0, float("nan"), 0.0), accel)
    with pytest.raises(undrift.UndriftError, match="radians"):
        navigator.fix(1.0, position=(45.0, 7.0, 300.0))
    with pytest.raises(undrift.ArgumentError, match="Sample, Fix"):
        navigator.push((1.0, 2.0))  # type: ignore[arg-type]
    with pytest.raises(undrift.UndriftError, match="sample 1"):
        navigator.imu_many([1.02, 1.01], [gyro, gyro], [accel, accel])
    assert not navigator.imu(1.04, gyro, accel)
    assert navigator.odometer(1.05, 3.0) and navigator.barometer(1.05, 300.0)


def test_threads_share_a_navigator(sim: undrift.Simulation) -> None:
    """A receiver's thread pushes fixes while another pushes samples: late ones count as if they were in time."""
    navigator = undrift.Navigator("adis16465", 50.0, horizon=60.0)
    turn = threading.Event()

    def receive() -> None:
        turn.wait(60)
        for k in range(len(sim.gnss.time)):
            navigator.fix(sim.gnss.time[k], **sim.gnss.fix(k))

    thread = threading.Thread(target=receive)
    thread.start()
    turn.set()
    cut = np.searchsorted(sim.imu.time, sim.gnss.time[-1]) - 50
    navigator.imu_many(sim.imu.time[:cut], sim.imu.gyro[:cut], sim.imu.accel[:cut])
    thread.join()
    navigator.imu_many(sim.imu.time[cut:], sim.imu.gyro[cut:], sim.imu.accel[cut:])
    assert navigator.state is not None
    assert navigator.state.position_std[0] < 3.0


@pytest.mark.skipif(sys.version_info < (3, 11), reason="asyncio.TaskGroup")
def test_the_example_navigates_the_sample(sampled: Path) -> None:
    example = ROOT / "examples" / "live" / "navigator.py"
    assert len(example.read_text().splitlines()) <= 60
    done = subprocess.run(
        [sys.executable, example, sampled, "100"], capture_output=True, text=True, check=True
    )
    lines = done.stdout.splitlines()
    assert any("navigation begins" in line for line in lines), done.stdout
    end = undrift.Drive.load(sampled).imu.time[-1]
    assert float(lines[-1].split()[0]) > end - 2.0 and "σ" in lines[-1]


def iio(folder: Path) -> tuple[Path, Path]:
    """A device as the kernel shows one: gyroscopes of 16 bits big-endian, accelerometers of 12 of 16 bits, a temperature, times."""
    device = folder / "iio:device0"
    scans = device / "scan_elements"
    scans.mkdir(parents=True)
    (device / "buffer").mkdir()
    kinds = {"accel": "le:s12/16>>4", "anglvel": "be:s16/16>>0"}
    names = [(f"in_{kind}_{axis}", kinds[kind]) for kind in kinds for axis in "xyz"]
    names.append(("in_timestamp", "le:s64/64>>0"))
    for index, (name, layout) in enumerate([*names, ("in_temp", "be:s16/16>>0")]):
        for key, text in [("index", str(index)), ("type", layout), ("en", "1")]:
            (scans / f"{name}_{key}").write_text(f"{text}\n")
    (device / "in_anglvel_scale").write_text("0.001\n")
    (device / "in_anglvel_y_scale").write_text("0.002\n")
    (device / "in_accel_scale").write_text("0.01\n")
    (device / "in_accel_z_offset").write_text("-3\n")
    (device / "sampling_frequency").write_text("50\n")
    scan = struct.pack("<3h", *(value << 4 for value in (-2048, 7, 983)))
    scan += struct.pack(">3h", -32768, 250, 3) + bytes(4)
    stream = folder / "dev"
    times = [1_764_400_000_000_000_000 + k * 5_000_000 for k in range(3)]
    # The last one is not whole.
    stream.write_bytes(b"".join(scan + struct.pack("<q", time) for time in times) + scan)
    return device, stream


@pytest.mark.skipif(sys.platform != "linux", reason="IIO is of Linux")
def test_the_program_for_iio_prints_lines_in_si_units(tmp_path: Path) -> None:
    example = ROOT / "examples" / "live" / "iio.py"
    assert len(example.read_text().splitlines()) <= 60
    device, stream = iio(tmp_path)
    command = [sys.executable, example, device, "200", stream]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    header, *lines = done.stdout.splitlines()
    assert header == "t,gx,gy,gz,ax,ay,az" and len(lines) == 3
    time, *values = map(float, lines[1].split(","))
    assert abs(time - 1_764_400_000.005) < 1e-6
    expected = [-32.768, 0.5, 0.003, -20.48, 0.07, 9.8]
    assert np.allclose(values, expected, rtol=1e-9)
    scans = device / "scan_elements"
    enabled = {file.name: file.read_text() for file in scans.glob("*_en")}
    assert enabled.pop("in_temp_en") == "0" and set(enabled.values()) == {"1"}
    assert (device / "sampling_frequency").read_text() == "200"
    assert (device / "buffer" / "enable").read_text() == "1"
