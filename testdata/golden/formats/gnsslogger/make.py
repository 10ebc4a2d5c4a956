"""Golden GnssLogger texts for crates/io/src/log/gnsslogger/tests.rs.

python3 testdata/golden/formats/gnsslogger/make.py

By the page LOGGING.md of GPSTest and the comments that the app writes at the beginning. Times of the tables are by datetime and
the 18 leap seconds of 2025, not by the reader's calendar.

phone.txt: Fix lines of GPS at 1 Hz and of FLP between, UncalGyro at 100 Hz, UncalAccel at 90 Hz, 3.7 ms later, Raw and Status lines;
fixes.csv, samples.csv (the force at a rate's time on the straight line between its neighbours: the force is one, so that
the line is exact).
old.txt: Fix lines as the first versions have them, without the time since boot, speed accuracy and vertical accuracy.
slow.txt.gz (by gzip -9 -n): UncalAccel at 20 Hz.
"""

import csv
import datetime
import math
import pathlib

HERE = pathlib.Path(__file__).parent
START = datetime.datetime(2025, 7, 12, 23, 59, 30, tzinfo=datetime.timezone.utc)
GPS = datetime.datetime(1980, 1, 6, tzinfo=datetime.timezone.utc)
UNIX_MS = round(START.timestamp() * 1000)
BOOT_NS = 123_456_789_012_345
LEAP_S = 18
# Seconds of the GPS week that the file starts in: that of the first line, 18 s before the week's end in UTC.
SECONDS = (START - GPS).total_seconds() + LEAP_S
WEEK_S = SECONDS // 604_800 * 604_800

COMMENTS = """\
#
# Header Description:
#
# Version: v3.0.6.4 Platform: 14 Manufacturer: Google Model: Pixel 7
#
# Raw,utcTimeMillis,TimeNanos,LeapSecond,TimeUncertaintyNanos,FullBiasNanos
#
# UncalAccel,utcTimeMillis,elapsedRealtimeNanos,UncalAccelXMps2,UncalAccelYMps2,UncalAccelZMps2,BiasXMps2,BiasYMps2,BiasZMps2
#
# UncalGyro,utcTimeMillis,elapsedRealtimeNanos,UncalGyroXRadPerSec,UncalGyroYRadPerSec,UncalGyroZRadPerSec,DriftXRadPerSec,DriftYRadPerSec,DriftZRadPerSec
#
# Fix,Provider,LatitudeDegrees,LongitudeDegrees,AltitudeMeters,SpeedMps,AccuracyMeters,BearingDegrees,UnixTimeMillis,SpeedAccuracyMps,BearingAccuracyDegrees,elapsedRealtimeNanos,VerticalAccuracyMeters,MockLocation
#
"""


def at(ns):
    """UTC in milliseconds by a clock that is read late, and time since boot."""
    return UNIX_MS + ns // 1_000_000 + (3 if ns else 0), BOOT_NS + ns


def force(ns):
    s = ns * 1e-9
    return [0.25 * s, -0.5 + 0.125 * s, 9.75 - 0.03125 * s]


def rates(s):
    return [round(x, 6) for x in (0.5 * math.sin(s), 0.25 * math.cos(s), 0.01 * s)]


def phone(accel_ns=11_111_111, seconds=16):
    lines = []
    for k in range(100 * seconds):
        ns = 10_000_000 * k
        utc, boot = at(ns)
        s = ns * 1e-9
        rate = rates(s)
        lines.append((ns, f"UncalGyro,{utc},{boot},{rate[0]!r},{rate[1]!r},{rate[2]!r},0.0,0.0,0.0"))
    for k in range(seconds * 1_000_000_000 // accel_ns):
        ns = 3_700_000 + accel_ns * k
        utc, boot = at(ns)
        x, y, z = force(ns)
        lines.append((ns, f"UncalAccel,{utc},{boot},{x!r},{y!r},{z!r},0.0,0.0,0.0"))
    return lines


def fix(k):
    return dict(lat=45.0 + 1e-5 * k, lon=-73.5 - 2e-5 * k, height=30.5 + 0.5 * k, speed=0.0 if k == 5 else 12.5 + 0.25 * k,
                accuracy=3.5 + 0.125 * k, bearing=(350.0 + 3 * k) % 360, speed_std=0.5, bearing_std=2.0 + 0.25 * k, vertical=4.5)


def write(name, rows):
    with open(HERE / name, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


lines, rows = phone(), []
for k in range(15):
    ns = 1_000_000_000 * k + 400_000_000
    utc, boot = at(ns)
    f = fix(k)
    text = f"{f['lat']!r},{f['lon']!r},{f['height']},{f['speed']},{f['accuracy']},{f['bearing']},{utc - 3},{f['speed_std']},{f['bearing_std']},{boot},{f['vertical']}"
    # Written some tenths of a second later.
    lines.append((ns + 300_000_000, f"Fix,GPS,{text},0"))
    lines.append((ns + 350_000_000, f"Fix,FLP,{text.replace('45.', '45.9', 1)},0"))
    lines.append((ns + 310_000_000, f"Raw,{utc},{boot},18,,-1436000000000000000"))
    rows.append(dict(t_s=repr(SECONDS - WEEK_S + ns * 1e-9), **{name: repr(value) for name, value in f.items()}))
lines.sort()
(HERE / "phone.txt").write_text(COMMENTS + "\n".join(line for _, line in lines) + "\n")
write("fixes.csv", rows)
samples = []
for k in range(1, 100 * 16):
    ns = 10_000_000 * k
    if 3_700_000 + 11_111_111 * (16_000_000_000 // 11_111_111 - 1) < ns:
        break
    s = ns * 1e-9
    values = rates(s) + force(ns)
    samples.append(dict(zip(("t_s", "gx", "gy", "gz", "ax", "ay", "az"), map(repr, [SECONDS - WEEK_S + s] + values))))
write("samples.csv", samples)

old = "# Fix,Provider,Latitude,Longitude,Altitude,Speed,Accuracy,(UTC)TimeInMs\n"
for k in range(10):
    f = fix(k)
    old += f"Fix,gps,{f['lat']!r},{f['lon']!r},{f['height']},{f['speed']},{f['accuracy']},{UNIX_MS + 1000 * k}\n"
(HERE / "old.txt").write_text(old)
slow = sorted(phone(50_000_000, 10))
(HERE / "slow.txt").write_text(COMMENTS + "\n".join(line for _, line in slow) + "\n")
