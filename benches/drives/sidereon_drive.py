"""sidereon: loose coupling in ECEF axes. Options: `ukf`; `car` adds its non-holonomic and stationary updates; `held` takes the mean
rates of a stand out and leaves its gyro biases at zero (docs/lab/drives.md, what is behind it)."""

import numpy as np
import sidereon as s
from arrays import arguments, write

A, E2 = 6378137.0, 6.69437999014e-3


def ecef(lat, lon, height):
    n = A / np.sqrt(1.0 - E2 * np.sin(lat) ** 2)
    return np.array([(n + height) * np.cos(lat) * np.cos(lon), (n + height) * np.cos(lat) * np.sin(lon), (n * (1.0 - E2) + height) * np.sin(lat)])


def geodetic(place):
    lon, p = np.arctan2(place[1], place[0]), np.hypot(place[0], place[1])
    lat, height = np.arctan2(place[2], p * (1.0 - E2)), 0.0
    for _ in range(6):
        n = A / np.sqrt(1.0 - E2 * np.sin(lat) ** 2)
        height = p / np.cos(lat) - n
        lat = np.arctan2(place[2], p * (1.0 - E2 * n / (n + height)))
    return lat, lon, height


def ned(lat, lon):
    """Takes north, east, down to ECEF."""
    sp, cp, sl, cl = np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon)
    return np.array([[-sp * cl, -sl, -cp * cl], [-sp * sl, cl, -cp * sl], [cp, 0.0, -sp]])


def body(roll, pitch, yaw):
    """Takes body axes to north, east, down."""
    (sr, sp, sy), (cr, cp, cy) = np.sin([roll, pitch, yaw]), np.cos([roll, pitch, yaw])
    return np.array([[cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy],
                     [cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy], [-sp, sr * cp, cr * cp]])


logs, options, out = arguments()
start, (gyro, gyro_walk, gyro_turn_on), (accel, accel_walk, accel_turn_on) = logs.start, logs.gyro, logs.accel
if "held" in options:
    logs.imu[:, 1:4] -= logs.read("still", 0)
    gyro_turn_on, gyro_walk = 1e-6, 1e-9
# Its bias states are Gauss-Markov processes of an instability and a time: here the walk of the model over 300 s.
time_constant = 300.0
spec = s.ImuSpec(accel, gyro, accel_walk * np.sqrt(time_constant / 2.0), gyro_walk * np.sqrt(time_constant / 2.0), time_constant, time_constant)
loose = {"lever_arm_body_m": list(logs.about["lever_arm_m"])}
constrained = "car" in options and logs.about["car"]
if constrained:
    loose["non_holonomic"] = s.NonHolonomicConstraintConfig(0.1, 0.1, 1.0, 0.5)
    detector = s.StationaryDetectorConfig(int(logs.about["rate_hz"]), 0.3, 0.02)
    loose["stationary_updates"] = s.StationaryUpdateConfig(detector, 0.05, 0.005)
kind = s.FusionFilterKind.UKF if "ukf" in options else s.FusionFilterKind.EKF
config = s.InertialFilterConfig(spec, kind, loose=s.LooseCouplingConfig(**loose))
axes = ned(start[1], start[2])
nominal = s.NavState(start[0], ecef(*start[1:4]), axes @ start[4:7], np.ascontiguousarray(axes @ body(*start[7:10])))
covariance = np.diag(np.r_[[logs.position_std**2] * 3, [0.3**2] * 3, np.square(logs.attitude_std), [accel_turn_on**2] * 3, [gyro_turn_on**2] * 3])
covariance[6:9, 6:9] = axes @ covariance[6:9, 6:9] @ axes.T
covariance = 0.5 * (covariance + covariance.T)
filter = s.InertialFilter.with_config(s.InsFilterState.from_covariance(nominal, s.ErrorStateLayout.FIFTEEN, covariance), config)
period = 1.0 / logs.about["rate_hz"]
constraint_every, rows, fix, want = max(1, int(0.1 / period)), [], 0, 0
for count, row in enumerate(logs.imu):
    if row[0] <= start[0] + 1e-6:
        continue
    filter.propagate(s.ImuSample.rate(row[0], row[4:7].tolist(), row[1:4].tolist()))
    while fix < len(logs.gnss) and logs.gnss[fix, 0] <= row[0] + 0.5 * period:
        t, lat, lon, height, *rest = logs.gnss[fix]
        turn, fix = ned(lat, lon), fix + 1
        place, sigma = ecef(lat, lon, height), turn @ np.diag(np.square(rest[3:6])) @ turn.T
        if logs.about["velocity"]:
            both = np.zeros((6, 6))
            both[:3, :3], both[3:, 3:] = sigma, turn @ np.diag(np.square(rest[6:9])) @ turn.T
            measurement = s.GnssFixMeasurement.position_velocity(row[0], place, turn @ np.array(rest[:3]), both, 12)
        else:
            measurement = s.GnssFixMeasurement.position(row[0], place, sigma, 12)
        filter.update_loose(measurement)
    if constrained and count % constraint_every == 0:
        filter.update_non_holonomic()
        filter.update_stationary()
    while want < len(logs.wanted) and row[0] >= logs.wanted[want]:
        state, want = filter.state, want + 1
        lat, lon, height = geodetic(state.nominal.position_ecef_m)
        turn = ned(lat, lon)
        sigma = np.sqrt(np.diag(turn.T @ np.array(state.covariance)[:3, :3] @ turn))
        attitude = turn.T @ np.array(state.nominal.attitude_body_to_ecef)
        rows.append([row[0], lat, lon, height, *(turn.T @ state.nominal.velocity_ecef_mps), *sigma, np.arctan2(attitude[1, 0], attitude[0, 0])])
write(out, rows)
