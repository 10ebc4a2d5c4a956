"""Golden SBF logs for crates/io/src/log/sbf/tests.rs.

python3 -m venv venv && venv/bin/pip install pysbf2==1.0.7 && venv/bin/python testdata/golden/formats/sbf/make.py

The checksums are pysbf2's, and fixes.csv is what its own reader makes of PVTGeodetic, PosCovGeodetic and VelCovGeodetic before
anything else is put between them. It does not know the fields of ExtSensorMeas and INSNavGeod: their tables are what was put in.

fixes.sbf: 5 Hz across the end of a week; NMEA, blocks nobody reads, stray bytes and a damaged block between.
plain.sbf: PVTGeodetic of revisions 0 and 2 without covariances.
sensors.sbf: ExtSensorMeas at 100 Hz with temperatures between, one sample without rates, two sensors, and INSNavGeod at 10 Hz;
sensors.csv, ins.csv.
"""

import csv
import io
import math
import pathlib
import struct

from pysbf2 import SBF_PROTOCOL, SBFReader
from pysbf2.sbfhelpers import calc_crc

HERE = pathlib.Path(__file__).parent
WEEK, WEEK_MS = 2374, 604_800_000
START_MS = WEEK_MS - 4_000
UNKNOWN = -2e10


def block(number, ms, body, revision=0):
    body = struct.pack("<IH", ms % WEEK_MS, WEEK + ms // WEEK_MS) + body
    body += bytes(-len(body) % 4)
    covered = struct.pack("<HH", number | revision << 13, 8 + len(body)) + body
    return b"$@" + struct.pack("<H", calc_crc(covered)) + covered


def pvt(ms, k, revision=2):
    # Two epochs each: no fix, an error, a velocity that is not known, two dimensions.
    mode = {10: 0, 11: 0, 14: 0x84, 15: 0x84}.get(k, (1, 2, 4, 5, 6, 10)[k // 2 % 6])
    error = 4 if k in (20, 21) else 0
    velocity = (UNKNOWN, UNKNOWN, UNKNOWN) if k in (30, 31) else (3.5 - k / 8, k / 4, 0.25 + k / 64)
    body = struct.pack("<BB3d5fdfBBBBHHIB", mode, error, math.radians(50.87 + 1e-6 * k), math.radians(4.7 - 2e-6 * k), 120.5 + k / 8,
                       45.5, *velocity, 33.0, 1e-3, 0.5, 0, 0, 20, 0, 0, 100, 0, 0)
    if revision:
        body += struct.pack("<BHHHHB", 1, 0, 50, 250 + k, 400 + k, 0)
    return block(4007, ms, body, revision)


def covariance(number, ms, k, scale):
    valid = k not in (24, 25)
    nn, ee, uu = (0.5 * scale, 0.25 * scale, 1.0 * scale) if valid else (UNKNOWN,) * 3
    ne, nu, eu = (x * scale * (1 + k / 64) for x in (0.0625, -0.03125, 0.125))
    return block(number, ms, struct.pack("<BB10f", 1, 0, nn, ee, uu, 1.0, ne, nu, 0.0, eu, 0.0, 0.0))


def nmea(ms):
    body = f"GPGST,{ms // 1000 % 60:06.2f},,,,,1.2,1.3,2.4".encode()
    check = 0
    for byte in body:
        check ^= byte
    return b"$" + body + b"*%02X\r\n" % check


def write(name, rows):
    with open(HERE / name, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def make_fixes():
    clean, dirty, rows = [], b"", []
    for k in range(40):
        ms = START_MS + 200 * k
        epoch = [pvt(ms, k), covariance(5906, ms, k, 1.0), covariance(5908, ms, k, 0.0625)]
        clean.append(b"".join(epoch))
        dirty += b"".join(epoch)
        dirty += (nmea(ms), b"$@stray", block(4027, ms, bytes(range(200))), block(5921, ms, b""))[k % 4]
    for k, epoch in enumerate(clean):
        row = {}
        for _, parsed in SBFReader(io.BytesIO(epoch), protfilter=SBF_PROTOCOL):
            names = [n for n in vars(parsed) if not n.startswith("_") and n not in ("TOW", "WNc")]
            row["TOW"], row["WNc"] = parsed.TOW, parsed.WNc
            row.update({f"{parsed.identity}.{n}": repr(getattr(parsed, n)) for n in names})
        rows.append(row)
    damaged = bytearray(block(4027, START_MS, bytes(100)))
    damaged[50] ^= 1
    (HERE / "fixes.sbf").write_bytes(bytes(damaged) + dirty)
    write("fixes.csv", rows)
    plain = b"".join(pvt(START_MS + 200 * k, 2, revision=2 * (k % 2)) for k in range(10))
    (HERE / "plain.sbf").write_bytes(plain)


def part(source, kind, values):
    return struct.pack("<BBBB3d", source, 11, kind, 0, *values)


def make_sensors():
    binary, samples, solutions = b"", [], []
    for k in range(300):
        ms = START_MS + 10 * k
        accel = [0.5 * math.sin(0.05 * k), 0.25 * math.cos(0.03 * k), -9.81 + 0.001 * k]
        rates = [2.0 * math.sin(0.02 * k), -1.0, 0.01 * k]
        if k == 100:
            rates = [UNKNOWN, 0.0, 0.0]
        parts = [part(1, 0, accel), part(1, 1, rates), part(2, 0, (1.0, 2.0, 3.0))]
        if k % 50 == 0:
            binary += block(4050, ms, struct.pack("<BB", 1, 28) + struct.pack("<BBBBh22x", 1, 11, 3, 0, 2500))
        binary += block(4050, ms, struct.pack("<BB", len(parts), 28) + b"".join(parts))
        if k != 100:
            values = [math.radians(x) for x in rates] + accel
            samples.append(dict(zip(("t_s", "gx", "gy", "gz", "ax", "ay", "az"), map(repr, [ms / 1e3] + values))))
        if k % 10 == 0:
            # Without a solution at first; parts: standard deviations, attitude, its own, velocity, its own.
            error, parts = (5, 0) if k < 30 else (0, 0b11111 if k % 20 == 0 else 0b01010)
            place = (math.radians(50.87 + 1e-6 * k), math.radians(4.7 - 2e-6 * k), 165.5 + k / 8)
            attitude, velocity = ((350.0 + k / 16) % 360, 1.5, -2.25), (k / 4, 3.5 - k / 8, 0.125)
            groups = [(0.5, 0.25, 1.0), attitude, (0.5, 0.25, 0.25), velocity, (0.0625, 0.03125, 0.125)]
            body = struct.pack("<BBHH3dfHHBBH", 4, error, 0, 10, *place, 45.5, 50, 30, 0, 0, parts)
            body += b"".join(struct.pack("<3f", *g) for bit, g in enumerate(groups) if parts >> bit & 1)
            binary += block(4226, ms, body)
            if not error:
                columns = ("t_s", "lat", "lon", "height", "yaw_deg", "pitch_deg", "roll_deg", "ve", "vn", "vu", "std")
                solutions.append(dict(zip(columns, map(repr, (ms / 1e3, *place, *attitude, *velocity, parts & 1)))))
    (HERE / "sensors.sbf").write_bytes(binary)
    write("sensors.csv", samples)
    write("ins.csv", solutions)


make_fixes()
make_sensors()
