"""Writes imu.csv as the EuRoC MAV data set has its mav0/imu0/data.csv: the header word for word, times in
nanoseconds of Unix time, angular rates and specific forces of the sensor's axes, 200 Hz. The numbers are noise about a
sensor at rest whose x axis points up, as the data set's does. Needs numpy 2.
"""

from pathlib import Path

import numpy as np

random = np.random.default_rng(4)
lines = ["#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]"]
for k in range(300):
    gyro = random.normal(0, 2e-3, 3)
    accel = random.normal([9.80665, 0, 0], 2e-2)
    lines.append(",".join([str(1403636579758555392 + 5_000_000 * k), *(repr(float(v)) for v in [*gyro, *accel])]))
Path(__file__).with_name("imu.csv").write_text("\n".join(lines) + "\n")
