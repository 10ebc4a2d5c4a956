"""python-ins: its extended filter with feedback, its own step of the covariance."""

import numpy as np
import pandas as pd
from arrays import arguments, write
from pyins import filters, inertial_sensor, measurements, strapdown
from pyins.util import ACCEL_COLS, GYRO_COLS, LLA_COLS, TRAJECTORY_COLS, VEL_COLS

logs, _, out = arguments()
start, (gyro, gyro_walk, gyro_turn_on), (accel, accel_walk, accel_turn_on) = logs.start, logs.gyro, logs.accel
imu = pd.DataFrame(logs.imu[:, 1:], index=logs.imu[:, 0], columns=GYRO_COLS + ACCEL_COLS)
increments = strapdown.compute_increments_from_imu(imu, "rate")
fixes = pd.DataFrame(logs.gnss[:, 1:7], index=logs.gnss[:, 0], columns=LLA_COLS + VEL_COLS)
fixes[["lat", "lon"]] = np.degrees(fixes[["lat", "lon"]])
lever = np.array(logs.about["lever_arm_m"])
aiding = [measurements.Position(fixes, logs.position_std, lever)]
if logs.about["velocity"]:
    aiding.append(measurements.NedVelocity(fixes, logs.velocity_std, lever))
state = np.r_[np.degrees(start[1:3]), start[3:7], np.degrees(start[7:10])]
roll, pitch, yaw = np.degrees(logs.attitude_std)
found = filters.run_feedback_filter(
    pd.Series(state, index=TRAJECTORY_COLS, name=imu.index[0]),
    logs.position_std,
    0.3,
    max(roll, pitch),
    yaw,
    increments,
    inertial_sensor.EstimationModel(gyro_turn_on, gyro, gyro_walk),
    inertial_sensor.EstimationModel(accel_turn_on, accel, accel_walk),
    aiding,
)
track, deviation, rows = found.trajectory, found.trajectory_sd, []
for time in logs.wanted:
    at = min(np.searchsorted(track.index, time), len(track) - 1)
    sigma = deviation.iloc[min(np.searchsorted(deviation.index, time), len(deviation) - 1)]
    row = track.iloc[at]
    angles = np.radians([row.lat, row.lon, row.heading])
    rows.append([track.index[at], *angles[:2], row.alt, row.VN, row.VE, row.VD, sigma.north, sigma.east, sigma.down, angles[2]])
write(out, rows)
