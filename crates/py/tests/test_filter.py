"""Filter: stepped by hand it is navigate, to the last digit."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest

import undrift

RATE = 50.0


@pytest.fixture(scope="module")
def sim() -> undrift.Simulation:
    # Fixes every half second lie on stamps of samples, and 7 ms after them with the offset.
    receiver = undrift.GnssReceiver(rate=2.0, time_offset=0.007, lever_arm=(0.3, 0.1, -1.2))
    return undrift.simulate("car", 90.0, RATE, "adis16405", gnss=receiver, seed=4)


RPY, VELOCITY = (0.01, -0.02, 0.5), (0.1, 0.2, 0.0)


def start_of(sim: undrift.Simulation, k: int, at: float | None = None, **keys: Any) -> undrift.Filter:
    """A filter at the fix k, the antenna at the IMU."""
    gnss = sim.gnss
    # As a drive file's numbers: degrees and back.
    lat, lon = (np.degrees(x[k]) * (np.pi / 180.0) for x in (gnss.lat, gnss.lon))
    return undrift.Filter(
        "adis16405",
        "arma",
        RATE,
        position=(lat, lon, gnss.height[k]),
        velocity=VELOCITY,
        rpy=RPY,
        time=gnss.time[k] if at is None else at,
        position_std=gnss.position_std[k],
        velocity_std=0.5,
        attitude_std=(0.05, 0.05, 0.1),
        **keys,
    )


def test_stepped_by_hand_it_is_navigate(sim: undrift.Simulation) -> None:
    drive = sim.drive(
        truth=False,
        gate=False,
        initial={
            "attitude": RPY,
            "attitude_std": (0.05, 0.05, 0.1),
            "velocity": VELOCITY,
            "velocity_std": 0.5,
        },
    )
    text = drive.toml.replace('lever_arm = "0.3, 0.1, -1.2 m"', 'lever_arm = "0 m"')
    assert text != drive.toml
    # The filter here estimates none of what a drive does unless it is switched off.
    text += '\n[states]\nlever_arm = "off"\nscale_factor = "off"\ntime_offset = "off"\n'
    logs = sim._logs(False)
    drive._drive = undrift._undrift.Drive.from_toml(
        text, "<drive>", [(f"<{name}>", log[0]) for name, log in logs.items()]
    ).with_model(undrift.NoiseModel.load("adis16405")._model)
    done = undrift.navigate(drive)

    imu, gnss = sim.imu, sim.gnss
    filter = start_of(sim, 0)
    begun = np.searchsorted(imu.time, gnss.time[0])
    # The rest of the sample that the first fix lies in.
    rest, dt = imu.time[begun] - gnss.time[0], imu.time[begun] - imu.time[begun - 1]
    part = rest / dt
    filter.predict(
        imu.gyro[begun] * dt * part,
        imu.accel[begun] * dt * part,
        rest,
        time=imu.time[begun],
        increments=True,
    )
    states, fix, updates = [filter.state], 1, 0
    for k in range(begun + 1, len(imu.time)):
        filter.begin(imu.gyro[k], imu.accel[k], imu.time[k] - imu.time[k - 1], time=imu.time[k])
        while fix < len(gnss.time) and gnss.time[fix] <= imu.time[k] + 1e-6:
            filter.advance(gnss.time[fix])
            lat, lon = (np.degrees(x[fix]) * (np.pi / 180.0) for x in (gnss.lat, gnss.lon))
            updates += len(
                filter.update_gnss(
                    position=(lat, lon, gnss.height[fix]),
                    position_std=gnss.position_std[fix],
                    velocity=gnss.velocity[fix],
                    velocity_std=gnss.velocity_std[fix],
                )
            )
            fix += 1
        filter.advance()
        states.append(filter.state)
    assert updates == 2 * (len(gnss.time) - 1) and len(states) == len(done)
    for name in ("time", "lat", "lon", "height", "velocity", "rpy", "position_std",
                 "velocity_std", "attitude_std", "gyro_error", "accel_error",
                 "gyro_error_std", "accel_error_std"):
        by_hand = np.array([getattr(state, name) for state in states])
        assert np.array_equal(by_hand, getattr(done, name)), name


def test_many_samples_are_one_after_the_other(sim: undrift.Simulation) -> None:
    one, many = start_of(sim, 0), start_of(sim, 0)
    gyro, accel = sim.imu.gyro[3500:3800], sim.imu.accel[3500:3800]
    for rate, force in zip(gyro, accel, strict=True):
        one.predict(rate, force)
    solution = many.predict_many(gyro, accel)
    assert len(solution) == 300 and solution.time[-1] == many.time == one.time
    assert np.array_equal(one.covariance, many.covariance)
    assert np.array_equal(solution.rpy[-1], one.state.rpy)
    times = sim.imu.time[3500:3800]
    stamped = start_of(sim, 0, at=sim.imu.time[3499]).predict_many(gyro, accel, time=times)
    assert np.array_equal(stamped.time, times)


def test_covariance_and_innovation(sim: undrift.Simulation) -> None:
    filter = start_of(sim, 0)
    assert filter.innovation is None
    p = filter.covariance
    assert p.shape[0] >= 15 and np.array_equal(p, p.T)
    assert np.sqrt(np.diag(p)[:3]) == pytest.approx(sim.gnss.position_std[0], rel=1e-15)
    p[:] = 0.0
    assert filter.covariance[0, 0] > 0.0
    state = filter.state
    # 3 m north: predicted less measured is -3 m, NIS (3 m)^2 over the sum of both variances.
    north = 3.0 / 6_356_752.0
    (update,) = filter.update_gnss(
        position=(state.lat + north, state.lon, state.height), position_cov=np.diag([4.0, 4.0, 9.0])
    )
    assert filter.innovation is update and update.kind == "position" and update.dof == 3
    # The radius of the meridian differs from the polar one by up to 1 %.
    assert update.innovation == pytest.approx([-3.0, 0.0, 0.0], abs=0.03)
    variance = 4.0 + sim.gnss.position_std[0, 0] ** 2
    assert update.nis == pytest.approx(update.innovation[0] ** 2 / variance, rel=1e-9)
    assert update.outcome == "used" and update.factor == 1.0
    (far,) = filter.update_gnss(
        position=(state.lat + 1000 * north, state.lon, state.height), gate=(9.0, 100.0)
    )
    assert far.outcome == "rejected" and filter.state.lat < state.lat + 10 * north


def test_every_measurement_is_taken(sim: undrift.Simulation) -> None:
    parameters = {"lever_arm": 0.1, "odometer_scale": 0.03, "barometer_bias": (100.0, 0.1)}
    filter = start_of(sim, 0, parameters=parameters)
    rest, force = sim.imu.gyro[:50].mean(axis=0), sim.imu.accel[:50].mean(axis=0)
    filter.predict(rest, force)
    for update, kind, dof in (
        (filter.update_zero_velocity(), "zero velocity", 3),
        (filter.update_earth_rate(rest, 0.002), "earth rate", 3),
        (filter.update_level(force, 0.05), "level", 2),
        (filter.update_non_holonomic(), "non-holonomic", 2),
        (filter.update_odometer(0.0), "odometer", 1),
        (filter.update_barometer(20.0), "barometer", 1),
        (filter.update_course(0.5, 0.1), "course", 1),
    ):
        assert update is not None and update.kind == kind and update.dof == dof
        assert len(update.innovation) == len(update.whitened) == dof
    state = filter.state
    assert set(state.parameters) == set(parameters)
    value, std = state.parameters["barometer_bias"]
    assert std[0] < 100.0 and len(value) == 1
    assert np.linalg.norm(state.velocity) < 0.05


def test_what_cannot_be_is_said(sim: undrift.Simulation) -> None:
    filter = start_of(sim, 0)
    with pytest.raises(undrift.UndriftError, match="not finite"):
        filter.predict((np.nan, 0.0, 0.0), (0.0, 0.0, -9.8))
    with pytest.raises(undrift.UndriftError, match="invalid sample: dt = 0 s"):
        filter.predict((0.0, 0.0, 0.0), (0.0, 0.0, -9.8), 0.0)
    with pytest.raises(undrift.UndriftError, match="not positive definite"):
        filter.update_gnss(velocity=(0.0, 0.0, 0.0), velocity_cov=-np.eye(3))
    with pytest.raises(TypeError, match="three numbers"):
        filter.predict((0.0, 0.0), (0.0, 0.0, -9.8))
    with pytest.raises(undrift.UndriftError, match="rows of 3"):
        filter.predict_many(np.zeros((5, 3)), np.zeros((4, 3)))
    with pytest.raises(undrift.UndriftError, match='unknown parameter "spin"'):
        start_of(sim, 0, parameters={"spin": 1.0})
    with pytest.raises(undrift.UndriftError, match="no place in radians"):
        undrift.Filter("adis16405", position=(2.0, 0.0, 0.0))
    with pytest.raises(undrift.UndriftError, match="unknown bias model"):
        undrift.Filter("adis16405", "best", position=(0.5, 0.0, 0.0))


def everything(filter: undrift.Filter) -> list[Any]:
    state = filter.state
    return [state.time, state.lat, state.lon, state.height, *state.velocity, *state.rpy,
            *state.gyro_error, *filter.covariance.ravel()]


REST = ((0.0, 0.0, 0.0), (0.0, 0.0, -9.8))


@pytest.mark.parametrize(
    ("fix", "problem"),
    [
        ({"position": (45.0, 7.0, 300.0)}, "no place in radians: convert degrees by numpy.radians"),
        ({"position": (0.5, 0.1, 1e6)}, "height 1e.06 m is outside"),
        ({"velocity": (1e9, 0.0, 0.0)}, "velocity: the measurement would move the solution"),
        ({"velocity": (np.nan, 0.0, 0.0)}, "velocity: nan is not finite"),
        ({"velocity": (0.0, 0.0, 0.0), "velocity_std": 0.0}, "velocity_std: must be above 0"),
        ({"velocity": (0.0, 0.0, 0.0), "velocity_std": (0.1, -0.1, 0.1)}, "above 0, not -0.1"),
        ({"velocity": (0.0, 0.0, 0.0), "velocity_std": np.inf}, "velocity_std: inf is not finite"),
        ({"velocity": (0.0, 0.0, 0.0), "velocity_cov": np.diag([1.0, -1.0, 1.0])}, "positive definite"),
        ({"velocity": (0.0, 0.0, 0.0), "velocity_cov": np.eye(3) + np.eye(3, k=1)}, "not symmetric"),
        ({"gate": (9.0, 4.0)}, "gate: weaken, 9, is above reject, 4"),
        ({"gate": (0.0, 4.0)}, "gate: must be above 0"),
        ({"gate": (np.nan, 4.0)}, "gate: nan is not finite"),
    ],
)
def test_a_refused_update_leaves_the_filter_as_it_was(
    sim: undrift.Simulation, fix: dict[str, Any], problem: str
) -> None:
    filter = start_of(sim, 0)
    filter.predict(*REST)
    before, innovation = everything(filter), filter.innovation
    state = filter.state
    # A good position precedes what is refused.
    good = {"position": (state.lat + 1e-7, state.lon, state.height)}
    with pytest.raises(undrift.UndriftError, match=problem):
        filter.update_gnss(**{**good, **fix})
    assert everything(filter) == before and filter.innovation is innovation
    filter.predict(*REST)
    assert len(filter.update_gnss(**good)) == 1


@pytest.mark.parametrize(
    ("sample", "problem"),
    [
        ({"time": 0.5}, "time goes backwards: the filter has reached 1.0.. s, the sample ends at 0.5 s"),
        ({"time": 6.0}, "does not begin at the time of the filter, .*to carry it across a gap pass dt = 4.9"),
        ({"dt": 1e6}, "dt = 1000000 s .* at most 10 s"),
        ({"dt": -0.02}, "dt must be above 0"),
        ({"dt": np.nan}, "dt: nan is not finite"),
        ({"time": np.inf}, "time: inf is not finite"),
        ({"accel": (1e9, 0.0, 0.0)}, "gyro and accel would move the solution out of range"),
        ({"gyro": (np.inf, 0.0, 0.0)}, "gyro: inf is not finite"),
    ],
)
def test_a_refused_sample_leaves_the_filter_as_it_was(
    sim: undrift.Simulation, sample: dict[str, Any], problem: str
) -> None:
    filter = start_of(sim, 0)
    filter.predict(*REST)
    before = everything(filter)
    keys = {"gyro": REST[0], "accel": REST[1], **sample}
    with pytest.raises(undrift.UndriftError, match=problem):
        filter.predict(**keys)
    with pytest.raises(undrift.UndriftError, match=problem):
        filter.begin(**keys)
    assert everything(filter) == before
    filter.predict(*REST)


def test_a_gap_is_crossed_on_purpose(sim: undrift.Simulation) -> None:
    filter = start_of(sim, 0)
    before, started = filter.state.position_std, filter.time
    filter.predict(*REST, 5.0)
    assert filter.time == pytest.approx(started + 5.0) and (filter.state.position_std > before).all()


def test_many_samples_are_all_or_none(sim: undrift.Simulation) -> None:
    filter = start_of(sim, 0)
    before = everything(filter)
    gyro, accel = np.zeros((10, 3)), np.tile([0.0, 0.0, -9.8], (10, 1))
    accel[7, 1] = np.nan
    with pytest.raises(undrift.UndriftError, match=r"sample 7 \(from 0\): .*not finite"):
        filter.predict_many(gyro, accel)
    times = filter.time + 0.02 * np.array([1, 2, 3, 3, 4, 5, 6, 7, 8, 9])
    accel[7, 1] = 0.0
    with pytest.raises(undrift.UndriftError, match=r"sample 3 \(from 0\): invalid sample: dt = 0 s"):
        filter.predict_many(gyro, accel, time=times)
    assert everything(filter) == before


def test_advance_stays_within_the_sample_begun(sim: undrift.Simulation) -> None:
    filter = start_of(sim, 0)
    with pytest.raises(undrift.UndriftError, match=r"nothing to advance: call begin\(\) first"):
        filter.advance()
    now = filter.time
    filter.begin(*REST)
    for time in (now - 0.01, now + 0.03):
        with pytest.raises(undrift.UndriftError, match="cannot advance to"):
            filter.advance(time)
    filter.advance(now + 0.01)
    # The rest of the sample comes before the next.
    filter.begin(*REST)
    assert filter.time == pytest.approx(now + 0.02)
    filter.advance()
    filter.advance()
    assert filter.time == pytest.approx(now + 0.04)


@pytest.mark.parametrize(
    ("start", "problem", "kind"),
    [
        ({"position": (45.0, 7.0, 0.0)}, "no place in radians", undrift.UndriftError),
        ({"position": "123"}, "position: three numbers are needed, not '123'", TypeError),
        ({"position": ("0.1", 0.0, 0.0)}, "position: a number is needed, not '0.1'", TypeError),
        ({"velocity": 3.0}, "velocity: three numbers are needed, not a float", TypeError),
        ({"rpy": np.zeros((3, 1))}, "rpy: three numbers are needed, not 3 x 1", TypeError),
        ({"attitude_std": 0.0}, "attitude_std: must be above 0", undrift.UndriftError),
        ({"position_std": -1.0}, "position_std: must be above 0", undrift.UndriftError),
        ({"position_std": True}, "position_std: a number is needed, not a bool", TypeError),
        ({"position_cov": [[1, 2, 0], [2, 1, 0], [0, 0, 1]]}, "position_cov: not positive definite",
         undrift.UndriftError),
        ({"position_cov": [["a"] * 3] * 3}, "position_cov: a 3 x 3 matrix of numbers", TypeError),
        ({"velocity_cov": np.eye(2)}, "velocity_cov: a 3 x 3 matrix is needed", TypeError),
        ({"rate": 0.0}, "rate: must be above 0", undrift.UndriftError),
        ({"time": "now"}, "time: a number is needed, not 'now'", TypeError),
        ({"parameters": {"lever_arm": -0.1}}, "lever_arm: must be above 0", undrift.UndriftError),
    ],
)
def test_a_start_that_cannot_be(start: dict[str, Any], problem: str, kind: type) -> None:
    with pytest.raises(kind, match=problem):
        undrift.Filter("adis16405", **{"position": (0.5, 0.1, 0.0), **start})


def test_numbers_of_numpy_are_numbers(sim: undrift.Simulation) -> None:
    f32 = np.float32
    filter = undrift.Filter(
        "adis16405", rate=np.int64(50), position=np.array([0.5, 0.1, 0.0], f32), time=f32(1.0),
        position_std=f32(2.0), velocity_std=np.array(0.5), attitude_std=np.full(3, 0.1, f32),
    )
    filter.predict(np.zeros(3, f32), [f32(0.0), 0, np.float64(-9.8)], f32(0.02))
    filter.update_zero_velocity(f32(0.1), gate=(f32(9.0), np.inf))
    filter.update_gnss(position=np.array([0.5, 0.1, 0.0]), position_std=f32(2.0))
    filter.update_barometer(f32(1.0), np.int32(2))
    # As in float32.
    assert filter.time == pytest.approx(1.02, abs=1e-6)


def test_two_threads_share_a_filter(sim: undrift.Simulation) -> None:
    filter = start_of(sim, 0)
    gyro, accel = np.zeros((500, 3)), np.tile([0.0, 0.0, -9.8], (500, 1))
    started = filter.time
    failed: list[BaseException] = []

    def work() -> None:
        try:
            for _ in range(4):
                filter.predict_many(gyro, accel)
                filter.update_zero_velocity()
                filter.predict(*REST)
                assert np.isfinite(filter.covariance).all() and filter.state.time > started
        except BaseException as error:
            failed.append(error)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failed
    assert filter.time == pytest.approx(started + 4 * 4 * 501 / RATE)
