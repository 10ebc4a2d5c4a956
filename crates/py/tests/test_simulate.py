"""simulate: closed forms, seeds, files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import undrift


def test_a_drive_has_the_logs_it_was_asked_for() -> None:
    sim = undrift.simulate("car", 60.0, 20.0, seed=9, gnss=undrift.GnssReceiver(rate=5.0))
    assert sim.imu.gyro.shape == (1200, 3) and len(sim.truth.time) == 1201
    assert len(sim.gnss.time) == 296 and sim.gnss.time[0] == 1.0
    again = undrift.simulate("car", 60.0, 20.0, seed=9, gnss=undrift.GnssReceiver(rate=5.0))
    assert np.array_equal(sim.imu.accel, again.imu.accel)
    assert not np.array_equal(sim.imu.accel, undrift.simulate("car", 60.0, 20.0, seed=8).imu.accel)


def test_a_rest_without_errors_is_gravity_and_the_earths_turn() -> None:
    rest = undrift.simulate("rest", 10.0, 10.0, None)
    lat = rest.truth.lat[0]
    earth = 7.2921151467e-5 * np.array([np.cos(lat), 0.0, -np.sin(lat)])
    # WGS 84; 1e-15 of rounding in the increments.
    assert rest.imu.gyro == pytest.approx(np.tile(earth, (100, 1)), abs=1e-14)
    assert np.ptp(rest.imu.accel[:, 2]) < 1e-9 and -9.84 < rest.imu.accel[0, 2] < -9.76
    assert np.abs(rest.truth.velocity).max() == 0.0


def test_a_straight_drive_goes_where_it_says() -> None:
    sim = undrift.simulate("straight", 100.0, 10.0, None, speed=20.0, course=np.pi / 2)
    assert sim.truth.velocity[-1] == pytest.approx([0.0, 20.0, 0.0], abs=1e-9)
    assert sim.truth.rpy[-1, 2] == pytest.approx(np.pi / 2, abs=1e-12)
    turn = undrift.simulate("turn", 10.0, 10.0, None, speed=5.0, turn_rate=0.2)
    assert turn.truth.rpy[-1, 2] == pytest.approx(2.0, abs=1e-9)


def test_errors_are_the_models_samples() -> None:
    model = undrift.NoiseModel.load("icm20602")
    noisy = undrift.simulate("rest", 20.0, 50.0, model, seed=6)
    exact = undrift.simulate("rest", 20.0, 50.0, None, seed=6)
    drawn = model.simulate(1000, 50.0, seed=6)
    # The rate is an increment over the interval, twice rounded, beside the Earth's gravity.
    assert (noisy.imu.gyro - exact.imu.gyro)[:, 1] == pytest.approx(drawn["gyro_y"], abs=1e-15)
    assert (noisy.imu.accel - exact.imu.accel)[:, 2] == pytest.approx(drawn["accel_z"], abs=1e-13)


def test_receivers_without_position_or_velocity(tmp_path: Path) -> None:
    sim = undrift.simulate("car", 120.0, 20.0, gnss=undrift.GnssReceiver(velocity=False))
    assert np.isnan(sim.gnss.velocity).all()
    path = sim.save(tmp_path)
    assert "velocity" not in path.read_text().split("[gnss]")[1].split("[truth]")[0]
    files, arrays = undrift.navigate(path), undrift.navigate(sim)
    assert np.array_equal(files.lat, arrays.lat) and files.rmse == arrays.rmse


def test_what_cannot_be_is_said() -> None:
    with pytest.raises(undrift.UndriftError, match='unknown trajectory "boat"; available: car, flight'):
        undrift.simulate("boat")
    with pytest.raises(undrift.UndriftError, match="rate: must be above 0"):
        undrift.simulate(rate=0.0, model=None)
    with pytest.raises(undrift.UndriftError, match="more than 100000000 samples"):
        undrift.simulate(duration=86_000.0, rate=1e5, model=None)
    with pytest.raises(undrift.UndriftError, match="GNSS: the rate must be positive"):
        undrift.simulate(duration=10.0, gnss=undrift.GnssReceiver(rate=-1.0))
    with pytest.raises(undrift.UndriftError, match="duration: nan is not finite"):
        undrift.simulate(duration=float("nan"))
