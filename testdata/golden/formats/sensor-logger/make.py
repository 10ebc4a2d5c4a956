"""A golden folder of Sensor Logger for crates/io/src/log/sensor_logger/tests.rs.

python3 testdata/golden/formats/sensor-logger/make.py

Columns as the app's exports have them. Rates at 100 Hz, forces at 95 Hz on a straight line of time, so that what is between two of
them is known; places at 1 Hz.
"""

import pathlib

HERE = pathlib.Path(__file__).parent / "drive"
START_NS = 1_752_003_240_000_000_000


def write(name, header, rows):
    (HERE / f"{name}.csv").write_text(header + "\n" + "".join(",".join(map(str, row)) + "\n" for row in rows))


axes = "time,seconds_elapsed,z,y,x"
gyro = [(START_NS + 10_000_000 * k, k / 100, 0.25, -0.125, round(0.001 * k, 6)) for k in range(300)]
force = []
for k in range(280):
    ns = 3_000_000 + 10_526_316 * k
    s = ns * 1e-9
    force.append((START_NS + ns, s, 9.75 - 0.03125 * s, 0.125 * s, 0.25 * s))
places = [(START_NS + 1_000_000_000 * k, k, 2.0, 0.5, 4.5, 3.5, -1 if k == 2 else 12.5, 90.0, 30.5, -73.5, 45.0 + 1e-5 * k) for k in range(3)]
write("Gyroscope", axes, gyro)
write("TotalAcceleration", axes, force)
write("Accelerometer", axes, [(t, s, 0.0, y, x) for t, s, _, y, x in force[:5]])
write("Location", "time,seconds_elapsed,bearingAccuracy,speedAccuracy,verticalAccuracy,horizontalAccuracy,speed,bearing,altitude,longitude,latitude", places)
