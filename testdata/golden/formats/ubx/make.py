"""Golden UBX logs for crates/io/src/log/ubx/tests.rs.

python3 -m venv venv && venv/bin/pip install pyubx2==1.4.0 pynmeagps==1.1.8 && venv/bin/python testdata/golden/formats/ubx/make.py

The frames and their checksums are pyubx2's; the values of fixes.csv and messages.csv are what its own reader makes of the
messages before anything else is put between them. The payloads are packed here by the interface descriptions, from integers, so that samples.csv, their closed
form, is exact.

drive.ubx: 4 Hz of NAV-PVT, NAV-HPPOSLLH, NAV-COV, NAV-STATUS and NAV-EOE across the end of a week, and ESF-RAW at 20 Hz
with a counter that is 0.5 % slow and wraps; NMEA and other bytes between. An epoch's messages come right behind the
sample of its time, so that the samples' times come out without a delay.
raw.ubx: ESF-RAW of ten samples each and, in its first word, milliseconds since startup, with NAV-STATUS and
NAV-PVT between.
sensors.ubx: ESF-MEAS with rates and specific forces in messages of their own, calibrated to the milliseconds of NAV-STATUS.
old.ubx: NAV-POSLLH, NAV-VELNED and NAV-SOL of receivers before NAV-PVT.
"""

import csv
import io
import math
import pathlib
import struct

from pynmeagps import NMEAMessage
from pyubx2 import GET, UBX_PROTOCOL, UBXMessage, UBXReader

HERE = pathlib.Path(__file__).parent
WEEK_MS = 604_800_000
START_MS = WEEK_MS - 10_000
RAW_TICK = 39.0625e-6
SLOW = 1.005


def message(name, payload):
    return UBXMessage(name[:3], name, GET, payload=payload).serialize()


def pvt(ms, k):
    # Two epochs of each of: no fix, dead reckoning alone, a time without a fix, a fix that is not good.
    fix_type, ok = {20: (0, 0), 21: (0, 0), 30: (1, 1), 31: (1, 1), 40: (5, 1), 41: (5, 1), 50: (3, 0), 51: (3, 0)}.get(k, (3, 1))
    carrier = (0, 1, 2)[k // 2 % 3]
    flags = ok | (k % 2 << 1) | (carrier << 6)
    utc_s = (ms // 1000 - 18) % 86_400
    nano = ms % 1000 * 1_000_000 - 123_456
    return struct.pack(
        "<IHBBBBBBIiBBBBiiiiIIiiiiiIIHHIihH",
        ms % WEEK_MS, 2025, 7, 13, utc_s // 3600, utc_s // 60 % 60, utc_s % 60, 0b0111, 25, nano, fix_type, flags, 0, 17,
        -797_366_625 + 31 * k, 434_813_263 - 17 * k, 125_258 + k, 161_000 + k, 1414 + k, 2100 + k, 1234 - 7 * k, -567 + 5 * k, -89 + k,
        1358, 33_500_000, 321 + k, 100_000, 150, 0, 0, 0, 0, 0)


def hpposllh(ms, k):
    return struct.pack(
        "<BBBBIiiiibbbbII", 0, 0, 0, int(k % 16 == 7), ms % WEEK_MS,
        -797_366_625 + 31 * k, 434_813_263 - 17 * k, 125_258 + k, 161_000 + k, k % 100 - 49, 49 - k % 100, k % 10 - 4, 3, 141 + k, 210 + k)


def cov(ms, k):
    valid = int(k % 8 != 3)
    position = (0.02, 0.003, -0.004, 0.03, 0.005, 0.09)
    velocity = (0.0025, 0.0003, -0.0002, 0.0016, 0.0001, 0.0049)
    return struct.pack("<IBBB9x12f", ms % WEEK_MS, 0, valid, 1, *(x * (1 + k / 100) for x in position + velocity))


def status(ms, k, startup):
    return struct.pack("<IBBBBII", ms % WEEK_MS, 3, 0b1101, 0, 0, 30_000, startup)


def word(kind, value):
    return struct.pack("<I", (kind << 24) | (value & 0xFFFFFF))


def rates(k):
    """Integers of the six axes: gyro x y z in 2^-12 deg/s, accelerometer x y z in 2^-10 m/s^2."""
    wave = [round(a * math.sin(0.1 * k + a)) for a in (40_960, 8_192, 20_480, 2_048, 512)]
    return [wave[0], wave[1], wave[2], wave[3], wave[4], -10_040 + k % 7]


def sample_row(time, axes):
    gyro = [repr(math.radians(x / 4096)) for x in axes[:3]]
    return [repr(time), *gyro, *(repr(x / 1024) for x in axes[3:])]


def drive():
    out, clean, samples = bytearray(b"\x00\xb5garbage\xb5\x62\x01"), bytearray(), []

    def add(name, payload):
        frame = message(name, payload)
        out.extend(frame)
        clean.extend(frame)

    kinds = (14, 13, 5, 12, 16, 17, 18)
    for k in range(420):
        # One sample every 50 ms from 0.5 s before the first epoch on.
        time = (START_MS - 500 + 50 * k) / 1000
        tag = (2**24 - 100_000 + round(k * 0.05 / SLOW / RAW_TICK)) % 2**24
        axes = rates(k)
        values = (*axes[:3], 2_534, *axes[3:])
        add("ESF-RAW", bytes(4) + b"".join(word(kind, value) + struct.pack("<I", tag) for kind, value in zip(kinds, values)))
        samples.append(sample_row(time, axes))
        if k >= 10 and (k - 10) % 5 == 0:
            ms, n = START_MS + 50 * (k - 10), (k - 10) // 5
            add("NAV-PVT", pvt(ms, n))
            if n % 4 != 2:
                add("NAV-HPPOSLLH", hpposllh(ms, n))
            if n % 5 != 4:
                add("NAV-COV", cov(ms, n))
            add("NAV-STATUS", status(ms, n, 77_000 + 250 * n))
            if n % 2:
                add("NAV-EOE", struct.pack("<I", ms % WEEK_MS))
            if n % 3 == 0:
                out += NMEAMessage("GN", "GGA", GET, time="12:00:00", lat=43.5, NS="N", lon=-79.7, EW="W", quality=1, numSV=17, HDOP=0.6, alt=161.0, altUnit="M", sep=-36.0, sepUnit="M").serialize()
            if n % 7 == 0:
                out += bytes([0xB5, 0x62, 0x01, 0x07, 92, 0]) + b"cut short"
    (HERE / "drive.ubx").write_bytes(out)
    table("samples.csv", ["t_s", "gx_radps", "gy_radps", "gz_radps", "ax_mps2", "ay_mps2", "az_mps2"], samples)
    return clean


def sensors():
    out, samples = bytearray(), []
    for k in range(240):
        startup = 4_000_000 + 100 * k
        # In the middle of the tags.
        time = (START_MS + 100 * k - 1_234.5) / 1000
        axes = rates(k)
        # The receivers tag specific forces 5 ms after the rates, but send them first.
        for kinds, values, tag in (((16, 17, 18), axes[3:], startup + 2), ((14, 13, 5, 12), (*axes[:3], 2_534), startup - 3)):
            flags = len(values) << 11 | 8
            data = b"".join(word(kind, value) for kind, value in zip(kinds, values))
            out += message("ESF-MEAS", struct.pack("<IHH", 100 * k, flags, 0) + data + struct.pack("<I", tag))
        # Wheel ticks alone are no inertial sample.
        out += message("ESF-MEAS", struct.pack("<IHH", 100 * k, 1 << 11, 0) + word(10, k))
        samples.append(sample_row(time, axes))
        if k % 10 == 0:
            ms = START_MS + 100 * k
            out += message("NAV-STATUS", status(ms, k, startup + 1_234))
            out += message("NAV-PVT", pvt(ms, 0))
    (HERE / "sensors.ubx").write_bytes(out)
    table("sensors.csv", ["t_s", "gx_radps", "gy_radps", "gz_radps", "ax_mps2", "ay_mps2", "az_mps2"], samples)


def raw():
    """Samples every 9.9 ms by a counter that is 1.5 % fast, ten to a message, as an M8L sends them."""
    out, samples, kinds = bytearray(), [], (16, 17, 18, 14, 13, 5, 12)
    for block in range(130):
        data = b""
        for k in range(10 * block, 10 * block + 10):
            tag = struct.pack("<I", 781_070 + round(k * 0.0099 * 1.015 / RAW_TICK))
            axes = rates(k)
            values = (*axes[3:], *axes[:3], 2_534)
            data += b"".join(word(kind, value) + tag for kind, value in zip(kinds, values))
            if block % 10 == 0:
                samples.append([k, *sample_row((START_MS + 9.9 * k) / 1000, axes)])
        out += message("ESF-RAW", struct.pack("<I", 37_815 + 99 * block) + data)
        if block % 5 == 0:
            # The epoch of 40 ms after the message's first sample.
            ms = START_MS + 99 * block + 40
            out += message("NAV-STATUS", status(ms, block, 37_855 + 99 * block)) + message("NAV-PVT", pvt(ms, 0))
    (HERE / "raw.ubx").write_bytes(out)
    table("raw.csv", ["sample", "t_s", "gx_radps", "gy_radps", "gz_radps", "ax_mps2", "ay_mps2", "az_mps2"], samples)


def old():
    out = bytearray()
    for k in range(6):
        ms = 1_000_000 + 1000 * k
        out += message("NAV-POSLLH", struct.pack("<IiiiiII", ms, 85_417_000 + k, 473_769_000 - k, 450_000 + k, 402_000 + k, 2500, 3600))
        out += message("NAV-SOL", struct.pack("<IihBBiiiIiiiIHBBI", ms, -250, 1800, 3, 0b1101 | (k % 2 << 1), 0, 0, 0, 400, 0, 0, 0, 30, 180, 0, 9, 0))
        out += message("NAV-VELNED", struct.pack("<IiiiIIiII", ms, 1234 + k, -567, 8, 1358, 1358, 0, 45, 100_000))
    (HERE / "old.ubx").write_bytes(out)
    return out


def table(name, header, rows):
    with open(HERE / name, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)


FIELDS = {
    "NAV-PVT": ["fixType", "gnssFixOk", "diffSoln", "carrSoln", "nano", "lat", "lon", "height", "hAcc", "vAcc", "velN", "velE", "velD", "sAcc"],
    "NAV-HPPOSLLH": ["invalidLlh", "lat", "lon", "height", "hAcc", "vAcc"],
    "NAV-COV": ["posCovValid", *(f"{what}Cov{pair}" for what in ("pos", "vel") for pair in ("NN", "NE", "ND", "EE", "ED", "DD"))],
    "NAV-POSLLH": ["lat", "lon", "height", "hAcc", "vAcc"],
    "NAV-VELNED": ["velN", "velE", "velD", "sAcc"],
    "NAV-SOL": ["gpsFix", "diffSoln"],
}


def read_back(name, clean, table_name, kinds):
    """One row to an epoch of what pyubx2 reads, empty where a message is missing; the messages' counts."""
    epochs, counts = {}, {}
    for _, parsed in UBXReader(io.BytesIO(clean), protfilter=UBX_PROTOCOL):
        counts[parsed.identity] = counts.get(parsed.identity, 0) + 1
        if parsed.identity in kinds:
            epochs.setdefault(parsed.iTOW, {})[parsed.identity] = parsed
    header = ["iTOW"] + [f"{kind}.{field}" for kind in kinds for field in FIELDS[kind]]
    rows = []
    for tow, found in epochs.items():
        values = [repr(getattr(found[kind], field)) if kind in found else "" for kind in kinds for field in FIELDS[kind]]
        rows.append([tow, *values])
    table(table_name, header, rows)
    return [[name, kind, count] for kind, count in sorted(counts.items())]


sensors()
raw()
counts = read_back("drive.ubx", drive(), "fixes.csv", ["NAV-PVT", "NAV-HPPOSLLH", "NAV-COV"])
counts += read_back("old.ubx", old(), "old.csv", ["NAV-POSLLH", "NAV-VELNED", "NAV-SOL"])
table("messages.csv", ["file", "message", "count"], counts)
