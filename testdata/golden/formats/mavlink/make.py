"""Makes stream.mavlink, drive.tlog and their values by pymavlink, and reads solution.mavlink, which the test of
crates/io/src/write/mavlink.rs writes (UNDRIFT_BLESS=1).

    pip install pymavlink==2.4.50
    MAVLINK20=1 python make.py
"""

import csv
import math
import random
import struct
from pathlib import Path

from pymavlink.dialects.v10 import common as one
from pymavlink.dialects.v20 import common as two

HERE = Path(__file__).parent


def packers():
    second = two.MAVLink(None, srcSystem=1, srcComponent=1)
    first = one.MAVLink(None, srcSystem=1, srcComponent=1)
    return first, second


def imu(k):
    """Accelerometer [mg], gyro [mrad/s]."""
    return [int(100 * math.sin(k)), -k, -1000 + k], [k, int(50 * math.cos(k)), -2 * k]


def gps(k):
    """Values of GPS_RAW_INT from its type of fix on."""
    return dict(fix_type=[3, 6, 1, 2, 4][k % 5], lat=475000000 + 10 * k, lon=-82500000 - 7 * k, alt=400000 + k,
                eph=80, epv=120, vel=65535 if k % 7 == 6 else 1000 + k, cog=(9000 * k) % 36000, satellites_visible=12)


def stream():
    """Version 2: HIGHRES_IMU and GPS_RAW_INT since the start, a date, a message that is not known, other bytes between."""
    _, mav = packers()
    out, samples, fixes = bytearray(b"$GPTXT,starting\xfe\xfd\r\n"), [], []
    random.seed(1)
    for k in range(100):
        micro = 5_000_000 + 10_000 * k
        accel = [0.1 * k, -0.2, -9.81]
        gyro = [0.01 * k, 0.0, -0.02]
        message = two.MAVLink_highres_imu_message(micro, *accel, *gyro, 0, 0, 0, 0, 0, 0, 25.5, 0x1fff if k % 2 else 0x3f, 0)
        out += message.pack(mav)
        single = [struct.unpack("<f", struct.pack("<f", x))[0] for x in gyro + accel]
        samples.append([micro * 1e-6, *single, 25.5 if k % 2 else ""])
        if k == 3:
            out += two.MAVLink_system_time_message(1_760_000_000_250_000, 4250).pack(mav)
        if k % 10 == 5:
            out += two.MAVLink_param_value_message(b"GPS_TYPE", 1.0, 9, 1000, k).pack(mav)
            # Another system's samples are not taken.
            other = two.MAVLink(None, srcSystem=2, srcComponent=1)
            out += two.MAVLink_highres_imu_message(micro, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0x3f, 0).pack(other)
        if k % 10 == 9:
            j = k // 10
            values = gps(j)
            std = dict(h_acc=1500 + j, v_acc=2500, vel_acc=300) if j != 1 else {}
            ellipsoid = 447000 + j
            out += two.MAVLink_gps_raw_int_message(time_usec=micro + 123, alt_ellipsoid=ellipsoid, **values, **std).pack(mav)
            fixes.append([micro * 1e-6 + 123e-6, values, ellipsoid, std])
        if k == 50:
            out += bytes(random.randrange(256) for _ in range(200))
    (HERE / "stream.mavlink").write_bytes(out)
    with open(HERE / "samples.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["time", "gx", "gy", "gz", "ax", "ay", "az", "temperature"])
        writer.writerows(samples)
    with open(HERE / "fixes.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["time", "fix_type", "lat_deg", "lon_deg", "height", "vel", "cog_deg", "h_acc", "v_acc", "vel_acc"])
        for time, v, ellipsoid, std in fixes:
            known = [std[name] * 1e-3 if std else "" for name in ("h_acc", "v_acc", "vel_acc")]
            writer.writerow([time, v["fix_type"], v["lat"] * 1e-7, v["lon"] * 1e-7, ellipsoid * 1e-3,
                             "" if v["vel"] == 65535 else v["vel"] * 1e-2, v["cog"] * 1e-2, *known])


def tlog():
    """A .tlog of versions 1 and 2 by turns: RAW_IMU by Unix time, SCALED_IMU2 whose stamps begin again, GPS2_RAW."""
    first, second = packers()
    out, rows = bytearray(), []
    for k in range(40):
        mav, dialect = (first, one) if k % 2 else (second, two)
        unix = 1_760_000_000_000_000 + 20_000 * k
        accel, gyro = imu(k)
        milli = (2**32 - 300 + 20 * k) % 2**32
        for message in [
            dialect.MAVLink_raw_imu_message(unix, *accel, *gyro, 0, 0, 0),
            dialect.MAVLink_scaled_imu2_message(milli, *accel, *gyro, 0, 0, 0),
            dialect.MAVLink_gps2_raw_message(unix, dgps_numch=0, dgps_age=0, **gps(k)),
        ]:
            out += struct.pack(">Q", unix + 5) + message.pack(mav)
        rows.append([k, *gyro, *accel])
    (HERE / "drive.tlog").write_bytes(out)
    with open(HERE / "counts.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["k", "gx", "gy", "gz", "ax", "ay", "az"])
        writer.writerows(rows)


def solution():
    """What undrift writes is what pymavlink reads."""
    path = HERE / "solution.mavlink"
    if not path.exists():
        return
    _, mav = packers()
    mav.robust_parsing = False
    messages = mav.parse_buffer(path.read_bytes())
    names = [message.get_type() for message in messages]
    assert names == ["HEARTBEAT", "ODOMETRY", "GPS_INPUT", "ODOMETRY", "GPS_INPUT"], names
    odometry, gps_input = messages[3], messages[4]

    def near(a, b, within):
        assert abs(a - b) <= within, (a, b)

    for value, expected in zip((odometry.x, odometry.y, odometry.z), (1.5, 2.0, -0.25)):
        near(value, expected, 1e-3)
    # The velocity in body axes, by the turn of the quaternion.
    w, x, y, z = odometry.q
    v = (odometry.vx, odometry.vy, odometry.vz)
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    turned = [v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2], v[2] + w * t[2] + x * t[1] - y * t[0]]
    for value, expected in zip(turned, (3.0, 4.0, -0.5)):
        near(value, expected, 1e-5)
    near(2 * math.atan2(z, w), 0.5, 2e-3)
    near(odometry.pose_covariance[0], 0.09, 1e-6)
    near(odometry.pose_covariance[6], 0.16, 1e-6)
    near(odometry.pose_covariance[20], 9e-6, 1e-9)
    trace = odometry.velocity_covariance[0] + odometry.velocity_covariance[6] + odometry.velocity_covariance[11]
    near(trace, 0.03**2 + 0.04**2 + 0.05**2, 1e-7)
    assert odometry.frame_id == two.MAV_FRAME_LOCAL_NED and odometry.child_frame_id == two.MAV_FRAME_BODY_FRD
    assert odometry.estimator_type == two.MAV_ESTIMATOR_TYPE_GPS_INS
    near(messages[2].lat, 475000000, 0)
    near(messages[2].lon, 82500000, 0)
    near(gps_input.alt, 432.1 + 0.25, 1e-3)
    near(gps_input.vn, 3.0, 1e-6)
    near(gps_input.horiz_accuracy, 0.5, 1e-6)
    near(gps_input.vert_accuracy, 0.5, 1e-6)
    near(gps_input.speed_accuracy, math.sqrt(0.005), 1e-6)
    near(gps_input.yaw, 2865, 0)
    assert (gps_input.time_week, gps_input.time_week_ms) == (2400, 101000)
    # GPS second 101 of week 2400, 18 leap seconds later than UTC.
    assert gps_input.time_usec == (315964800 + 2400 * 604800 + 101 - 18) * 1_000_000
    print("solution.mavlink is what undrift wrote")


stream()
tlog()
solution()
