"""Golden NovAtel logs for crates/io/src/log/novatel/tests.rs.

python3 testdata/golden/formats/novatel/make.py

Written by NovAtel's OEM7 documentation alone, with struct and zlib; the CRC is checked against the examples of that
documentation before anything is written. The tables are what was put in, in the units of the messages.

fixes.bin, fixes.asc: BESTPOS and BESTVEL at 5 Hz across the end of a week, as binary messages and as ASCII, with PSRPOS (which
is worse and to be passed over), messages nobody reads, NMEA and stray bytes between; fixes.csv. fixes.bin has other messages with
CRCs that are wrong.
late.asc: BESTVEL with a latency of 0.25 s at 2 Hz beside BESTPOS.
raw.bin: RAWIMUSX of an STIM300 at 125 Hz with two samples lost; raw.csv has rates and specific forces along x, y, z.
epson.asc: RAWIMUS of an Epson G320, whose type INSCONFIG tells; epson.csv.
reference.bin: INSPVAS at 10 Hz and INSPVAX at 1 Hz; reference.csv of INSPVAS, extended.csv of INSPVAX.
"""

import csv
import math
import pathlib
import struct
import zlib

HERE = pathlib.Path(__file__).parent
WEEK = 2374
WEEK_MS = 604_800_000
START_MS = WEEK_MS - 6_000


def crc(data):
    """CRC-32 that begins with 0 and is not inverted: zlib inverts before and after."""
    return zlib.crc32(data, 0xFFFFFFFF) ^ 0xFFFFFFFF


EXAMPLES = """\
#BESTPOSA,USB1,0,58.5,FINESTEERING,2209,502061.000,02000020,cdba,16809;SOL_COMPUTED,PPP,51.15043706870,-114.03067882331,1097.3462,-17.0001,WGS84,0.0154,0.0139,0.0288,"TSTR",11.000,0.000,43,39,39,38,00,00,7f,37*52483ac5
#BESTGNSSVELA,USB1,0,64.0,FINESTEERING,2209,488172.000,02000020,00b0,16809;SOL_COMPUTED,PPP,0.250,12.000,0.0025,23.890175,0.0021,0.0*f40aab04
%RAWIMUSXA,2209,491674.014;04,41,2209,491674.013699,ea59fe00,329308016,-2706935,4508389,196192,417138,-1000837*038422a7
"""
for line in EXAMPLES.splitlines():
    text, given = line[1:].split("*")
    assert f"{crc(text.encode()):08x}" == given, line


def long_binary(number, ms, body):
    week, ms = WEEK + ms // WEEK_MS, ms % WEEK_MS
    header = struct.pack("<3sBHBBHHBBHIIHH", b"\xaa\x44\x12", 28, number, 0, 0x20, len(body), 0, 120, 180, week, ms, 0, 0, 16809)
    return header + body + struct.pack("<I", crc(header + body))


def short_binary(number, ms, body):
    week, ms = WEEK + ms // WEEK_MS, ms % WEEK_MS
    header = struct.pack("<3sBHHI", b"\xaa\x44\x13", len(body), number, week, ms)
    return header + body + struct.pack("<I", crc(header + body))


def long_ascii(name, ms, body):
    week, ms = WEEK + ms // WEEK_MS, ms % WEEK_MS
    text = f"{name}A,COM1,0,58.5,FINESTEERING,{week},{ms / 1e3:.3f},02000020,cdba,16809;{body}".encode()
    return b"#" + text + b"*%08x\r\n" % crc(text)


def short_ascii(name, ms, body):
    week, ms = WEEK + ms // WEEK_MS, ms % WEEK_MS
    text = f"{name}A,{week},{ms / 1e3:.3f};{body}".encode()
    return b"%" + text + b"*%08x\r\n" % crc(text)


def nmea(ms):
    body = f"GPGST,{ms // 1000 % 60:06.2f},,,,,1.2,1.3,2.4".encode()
    check = 0
    for byte in body:
        check ^= byte
    return b"$" + body + b"*%02X\r\n" % check


# Solution status, kind of solution: by number and name.
COMPUTED, INSUFFICIENT = (0, "SOL_COMPUTED"), (1, "INSUFFICIENT_OBS")
SINGLE, PROPAGATED, FLOAT, FIXED, PSRDIFF = (16, "SINGLE"), (19, "PROPAGATED"), (34, "NARROW_FLOAT"), (50, "NARROW_INT"), (17, "PSRDIFF")


def fix(k):
    status = INSUFFICIENT if k in (10, 11) else COMPUTED
    kind = PROPAGATED if k in (20, 21) else (SINGLE, PSRDIFF, FLOAT, FIXED)[k // 2 % 4]
    place = (43.4813263 - 1.7e-6 * k, -79.7366625 + 3.1e-6 * k, 160.25 + 0.125 * k)
    # Fractions that single precision holds.
    std = (1.5 + k / 128, 1.25 + k / 128, 2.5 + k / 64)
    motion = (12.5 + 0.25 * k, (340.0 + k) % 360, -0.125 + 0.015625 * k)
    return status, kind, place, -35.5, std, motion


def bestpos_binary(k, number=42, more=0.0):
    status, kind, (lat, lon, msl), undulation, std, _ = fix(k)
    return struct.pack("<II3dfI3f4s2f8B", status[0], kind[0], lat + more, lon, msl, undulation, 61, *std, b"TSTR", 1, 0, 20, 19, 19, 18, 0, 0, 0x7F, 0x37)


def bestpos_ascii(k):
    status, kind, (lat, lon, msl), undulation, std, _ = fix(k)
    std = ",".join(repr(x) for x in std)
    return f'{status[1]},{kind[1]},{lat!r},{lon!r},{msl!r},{undulation},WGS84,{std},"TSTR",1.000,0.000,20,19,19,18,00,00,7f,37'


def bestvel_binary(k):
    status, kind, _, _, _, motion = fix(k)
    return struct.pack("<II2f3df", status[0], kind[0], 0.0, 1.0, *motion, 0.0)


def bestvel_ascii(k, latency="0.000"):
    status, kind, _, _, _, (speed, course, up) = fix(k)
    return f"{status[1]},{kind[1]},{latency},1.000,{speed!r},{course!r},{up!r},0.0"


def write(name, rows):
    with open(HERE / name, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def make_fixes():
    binary, text, rows = b"", b"", []
    for k in range(60):
        ms = START_MS + 200 * k
        binary += long_binary(47, ms, bestpos_binary(k, more=1e-4)) if k > 3 else b""
        binary += long_binary(42, ms, bestpos_binary(k)) + long_binary(99, ms, bestvel_binary(k))
        binary += (nmea(ms), b"\xaa\x44stray #A%B\xaa", long_binary(43, ms, bytes(range(200))))[k % 3]
        text += long_ascii("BESTPOS", ms, bestpos_ascii(k)) + long_ascii("BESTVEL", ms, bestvel_ascii(k))
        text += (nmea(ms), b"<TIME COM1 0 58.5 FINESTEERING\r\n#comment\r\n", long_ascii("RXSTATUS", ms, "00000000,5"))[k % 3]
        status, kind, (lat, lon, msl), undulation, std, (speed, course, up) = fix(k)
        used = int(status is COMPUTED and kind is not PROPAGATED)
        rows.append(dict(t_s=repr((ms - START_MS + START_MS) / 1e3), used=used, kind=kind[0], lat_deg=repr(lat), lon_deg=repr(lon), height_m=repr(msl + undulation),
                         std_lat=std[0], std_lon=std[1], std_height=std[2], speed=speed, course_deg=course, up=up))
    # A CRC that is wrong does not hide what follows.
    damaged = bytearray(long_binary(43, START_MS, bytes(100)))
    damaged[60] ^= 1
    (HERE / "fixes.bin").write_bytes(bytes(damaged) + binary)
    (HERE / "fixes.asc").write_bytes(text)
    write("fixes.csv", rows)


def make_late():
    text = b""
    for k in range(20):
        ms = 100_000_000 + 500 * k
        text += long_ascii("BESTPOS", ms, bestpos_ascii(30 + k)) + long_ascii("BESTVEL", ms, bestvel_ascii(30 + k, "0.250"))
    (HERE / "late.asc").write_bytes(text)


def counts(k):
    """Of z, -y, x: accelerometers, then gyros."""
    wave = [round(a * math.sin(0.05 * k + a)) for a in (40_000, 9_000, 21_000, 5_000, 700)]
    return [-330_000 + k % 7, wave[0], wave[1], wave[2], wave[3], wave[4]]


def axes(of, accel, gyro):
    """x, y, z from z, -y, x."""
    az, may, ax, gz, mgy, gx = of
    return [gx * gyro, -mgy * gyro, gz * gyro, ax * accel, -may * accel, az * accel]


def row(seconds, values):
    return dict(zip(("t_s", "gx", "gy", "gz", "ax", "ay", "az"), [repr(seconds)] + [repr(v) for v in values]))


def make_raw():
    binary, rows = b"", []
    for k in range(250):
        if k in (150, 151):
            continue
        ms = START_MS + 8 * k
        week, seconds = WEEK + ms // WEEK_MS, ms % WEEK_MS / 1e3
        # A fault of the IMU at one.
        fault = int(k == 200)
        body = struct.pack("<BBHdI6i", 0x10 | fault, 32, week, seconds, 0, *counts(k))
        binary += short_binary(1462, ms, body)
        if not fault:
            scaled = axes(counts(k), 2.0**-22 * 125, math.radians(2.0**-21) * 125)
            rows.append(row(ms / 1e3, scaled))
    (HERE / "raw.bin").write_bytes(binary)
    write("raw.csv", rows)


def make_epson():
    text, rows = b"", []
    for k in range(40):
        ms = 100_000_000 + 8 * k
        if k == 2:
            text += long_ascii("INSCONFIG", ms, "EPSON_G320,6,50,20,DEFAULT,00ffdcbf,AUTOMATIC,ROVER,FALSE,00000000,0")
        body = f"{WEEK},{ms / 1e3:.6f},ea59fe00," + ",".join(map(str, (1000 * x for x in counts(k))))
        text += short_ascii("RAWIMUS", ms, body)
        if k >= 2:
            scaled = axes([1000 * x for x in counts(k)], 0.2 / 65536 * 1e-3 * 9.80665, math.radians(0.008 / 65536))
            rows.append(row(ms / 1e3, scaled))
    (HERE / "epson.asc").write_bytes(text)
    write("epson.csv", rows)


def make_reference():
    binary, rows, extended = b"", [], []
    for k in range(80):
        ms = START_MS + 100 * k
        week, seconds = WEEK + ms // WEEK_MS, ms % WEEK_MS / 1e3
        # Aligning, aligned, good, free.
        state = 1 if k < 5 else 7 if k < 20 else 6 if k == 40 else 3
        place = (51.0 + 1e-5 * k, -114.0 - 2e-5 * k, 1080.5 + 0.01 * k)
        velocity, attitude = (3.5 - 0.1 * k, 0.25 * k, 0.0625 * k), (1.5 - 0.01 * k, -2.5, (350.0 + k) % 360)
        binary += short_binary(508, ms, struct.pack("<Id9dI", week, seconds, *place, *velocity, *attitude, state))
        columns = ("t_s", "lat_deg", "lon_deg", "height_m", "vn", "ve", "vu", "roll_deg", "pitch_deg", "yaw_deg")
        values = [repr(x) for x in (ms / 1e3, *place, *velocity, *attitude)]
        if state != 1:
            rows.append(dict(zip(columns, values)))
        if k % 10 == 0:
            undulation, std = -17.0, [0.5, 0.25, 1.0, 0.03125, 0.0625, 0.125, 0.5, 0.5, 1.5]
            binary += long_binary(1465, ms, struct.pack("<II3df6d9fIH", state, 56, *place, undulation, *velocity, *attitude, *std, 0, 0))
            values[3] = repr(place[2] + undulation)
            if state != 1:
                extended.append(dict(zip(columns, values)))
    (HERE / "reference.bin").write_bytes(binary)
    write("reference.csv", rows)
    write("extended.csv", extended)


make_fixes()
make_late()
make_raw()
make_epson()
make_reference()
