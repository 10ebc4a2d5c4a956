"""Tables come back: what the package gives, it takes."""

from __future__ import annotations

import datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undrift

RATE = 50.0


@pytest.fixture(scope="module")
def sim() -> undrift.Simulation:
    return undrift.simulate("car", 120.0, RATE, seed=5)


@pytest.fixture(scope="module")
def expected(sim: undrift.Simulation) -> undrift.Navigation:
    return undrift.navigate(sim)


def same(found: undrift.Navigation, expected: undrift.Navigation) -> None:
    # Degrees and back for the drive of the simulation, radians here: 1e-15 of a radian, 1e-8 m.
    assert len(found) == len(expected)
    assert found.lat == pytest.approx(expected.lat, abs=1e-13)
    assert found.velocity == pytest.approx(expected.velocity, abs=1e-7)
    assert found.rpy == pytest.approx(expected.rpy, abs=1e-7)


def navigate(*logs: Any, **settings: Any) -> undrift.Navigation:
    """With the antenna where the simulation's drive file puts it."""
    return undrift.navigate(*logs, lever_arm=(0.0, 0.0, 0.0), **settings)


def test_logs_of_a_simulation_are_logs_of_a_drive(
    sim: undrift.Simulation, expected: undrift.Navigation
) -> None:
    same(navigate(sim.imu, sim.gnss, "adis16405", truth=sim.truth), expected)
    assert navigate(sim.imu, sim.gnss, "adis16405", truth=sim.truth).rmse is not None


def test_units_travel_with_a_frame(
    sim: undrift.Simulation, expected: undrift.Navigation, tmp_path: Path
) -> None:
    pandas = pytest.importorskip("pandas")
    imu, gnss = sim.imu.to_pandas(), sim.gnss.to_pandas()
    assert imu.attrs["units"]["gyro_x"] == "rad/s"
    same(navigate(imu, gnss, "adis16405", truth=sim.truth.to_pandas()), expected)
    # In degrees, and the frame states so.
    imu[["gyro_x", "gyro_y", "gyro_z"]] *= 180.0 / np.pi
    imu.attrs["units"] |= dict.fromkeys(("gyro_x", "gyro_y", "gyro_z"), "deg/s")
    same(navigate(imu, gnss, "adis16405"), expected)
    # A unit of the call is above that of the frame.
    imu.attrs["units"] |= dict.fromkeys(("gyro_x", "gyro_y", "gyro_z"), "rad/s")
    same(navigate(imu, gnss, "adis16405", gyro_unit="deg/s"), expected)
    # Through files: Parquet keeps attributes, CSV the names.
    sim.imu.to_pandas().to_parquet(tmp_path / "imu.parquet")
    sim.imu.to_pandas(units=True).to_csv(tmp_path / "imu.csv", index=False)
    sim.gnss.to_pandas(units=True).to_csv(tmp_path / "gnss.csv", index=False)
    assert "gyro_x [rad/s]" in sim.imu.to_pandas(units=True)
    again = pandas.read_parquet(tmp_path / "imu.parquet")
    same(navigate(again, pandas.read_csv(tmp_path / "gnss.csv"), "adis16405"), expected)
    by_name = navigate(
        pandas.read_csv(tmp_path / "imu.csv"), pandas.read_csv(tmp_path / "gnss.csv"), "adis16405"
    )
    same(by_name, expected)
    # Without any a unit is asked for, as before.
    bare = sim.imu.to_pandas()
    bare.attrs.clear()
    with pytest.raises(undrift.UndriftError, match="gyro_unit"):
        undrift.navigate(bare, gnss, "adis16405")


def test_units_travel_with_an_arrow_table(
    sim: undrift.Simulation, expected: undrift.Navigation, tmp_path: Path
) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    parquet.write_table(sim.imu.to_arrow(), tmp_path / "imu.parquet")
    imu = parquet.read_table(tmp_path / "imu.parquet")
    assert imu.schema.field("accel_z").metadata == {b"unit": b"m/s^2"}
    same(navigate(imu, sim.gnss.to_arrow(), "adis16405"), expected)


def test_times_with_a_zone_and_an_index_of_times(
    sim: undrift.Simulation, expected: undrift.Navigation
) -> None:
    pandas = pytest.importorskip("pandas")
    start = pandas.Timestamp("2026-05-01T12:00:00", tz="UTC")

    def dated(log: Any, zone: str | None) -> Any:
        frame = log.to_pandas()
        stamps = start + pandas.to_timedelta(np.round(1e6 * frame["time"]), unit="us")
        frame["time"] = stamps.dt.tz_convert(zone)
        return frame

    for zone in ("Europe/Berlin", "UTC"):
        found = navigate(dated(sim.imu, zone), dated(sim.gnss, zone), "adis16405")
        assert found.time[0] == pytest.approx(start.timestamp() + expected.time[0], abs=1e-5)
        # Stamps to a microsecond, some 1e-5 m at 10 m/s.
        assert found.lat == pytest.approx(expected.lat, abs=1e-10)
    for keys in ({}, {"name": "stamp"}):
        imu, gnss = (
            dated(log, "UTC").set_index("time").rename_axis(keys.get("name"))
            for log in (sim.imu, sim.gnss)
        )
        found = navigate(imu, gnss, "adis16405")
        assert found.lat == pytest.approx(expected.lat, abs=1e-10)
    # Dates of Python, in the list of a dict.
    made = {name: values for name, values in sim.imu.to_pandas(units=True).items()}
    zero = datetime.datetime(2026, 5, 1, 12, tzinfo=datetime.timezone(datetime.timedelta(hours=2)))
    made["time [s]"] = [zero + datetime.timedelta(seconds=t) for t in sim.imu.time]
    times = undrift.Drive(made, sim.gnss, "adis16405").imu.time
    assert times[0] == pytest.approx(zero.timestamp() + sim.imu.time[0], abs=1e-5)


def test_identify_takes_lists_series_and_logs() -> None:
    x = undrift.NoiseModel.load("adis16405").simulate(4_000, RATE, seed=2)["gyro_z"]
    expected = undrift.identify(x, axis="gyro_z", rate=RATE).axes["gyro_z"].adev
    assert undrift.identify(x.tolist(), axis="gyro_z", rate=RATE).axes["gyro_z"].adev.tolist() == expected.tolist()
    pandas = pytest.importorskip("pandas")
    series = pandas.Series(x)
    found = undrift.identify(series, axis="gyro_z", rate=RATE)
    assert found.axes["gyro_z"].adev.tolist() == expected.tolist()
    # A name with a unit, and an index of times.
    stamps = pandas.to_datetime(np.round(1e6 * np.arange(4_000) / RATE), unit="us", utc=True)
    series = pandas.Series(np.degrees(x), index=stamps, name="gz_dps")
    found = undrift.identify(series)
    assert found.rate == pytest.approx(RATE, rel=1e-9)
    assert found.axes["gyro_z"].adev == pytest.approx(expected, rel=1e-9)
    with pytest.raises(TypeError, match="specify the axis"):
        undrift.identify(pandas.Series(x), rate=RATE)
    with pytest.raises(undrift.UndriftError, match="not an array of numbers"):
        undrift.identify([1.0, "x"], axis="gyro_z", rate=RATE)


def test_identify_takes_an_imu_log() -> None:
    sim = undrift.simulate("rest", 100.0, RATE, seed=3)
    found = undrift.identify(sim.imu)
    frame = pytest.importorskip("pandas") and undrift.identify(sim.imu.to_pandas())
    assert found.recommended == frame.recommended and len(found.axes) == 6


def test_the_logs_of_a_drive(sim: undrift.Simulation, tmp_path: Path) -> None:
    drive = undrift.Drive.load(sim.save(tmp_path / "drive"))
    imu, gnss = drive.imu, drive.gnss
    assert np.array_equal(imu.time, sim.imu.time)
    assert imu.gyro == pytest.approx(sim.imu.gyro, abs=1e-15)
    assert imu.accel == pytest.approx(sim.imu.accel, abs=1e-12)
    assert gnss.lat == pytest.approx(sim.gnss.lat, abs=1e-15)
    assert gnss.position_std == pytest.approx(sim.gnss.position_std, rel=1e-12)
    assert gnss.velocity_cov is not None and gnss.velocity_cov.shape == (len(gnss.time), 3, 3)
    # Axes are the body's: a sensor upside down.
    turned = undrift.Drive(
        {"file": undrift.ImuLog(imu.time, imu.gyro * [1, -1, -1], imu.accel * [1, -1, -1]),
         "axes": "x,-y,-z"},
        sim.gnss, "adis16405",
    )
    assert turned.imu.accel == pytest.approx(imu.accel, abs=1e-12)
    state = drive.align()
    solution = undrift.navigate(drive)
    assert state.time == solution.time[0] and np.array_equal(state.rpy, solution.rpy[0])
    assert np.array_equal(state.position_std, solution.position_std[0])


@pytest.mark.parametrize("std_factor", [1.0, 2.0])
def test_a_loop_over_a_drive_is_navigate(sim: undrift.Simulation, std_factor: float) -> None:
    # Without what navigate adds to the filter; fixes hold when their stamps say.
    drive = sim.drive(
        gate=False, states={"time_offset": "off"}, position_std_factor=std_factor
    )

    filter = undrift.Filter.from_drive(drive)
    imu, gnss, path = drive.imu, drive.gnss, [filter.state]
    fix = np.searchsorted(gnss.time, filter.time, side="right")
    for time, gyro, accel in zip(imu.time, imu.gyro, imu.accel, strict=True):
        if time > filter.time:
            filter.begin(gyro, accel, time - filter.time, time=time)
            while fix < len(gnss.time) and gnss.time[fix] <= time + 1e-6:
                filter.advance(gnss.time[fix])
                filter.update_gnss(**gnss.fix(fix))
                fix += 1
            filter.advance()
            path.append(filter.state)

    # The linear filter alone takes what the first turns show for exact.
    solution = undrift.navigate(drive, strict=False)
    assert len(path) == len(solution)
    for name in ("time", "lat", "lon", "height", "velocity", "rpy", "gyro_error", "accel_error",
                 "position_std", "velocity_std", "attitude_std"):
        found = np.array([getattr(state, name) for state in path])
        # The drive's increments become rates and increments again: rounding, summed over two minutes.
        assert found == pytest.approx(getattr(solution, name), abs=1e-9), name
