"""Golden logs of headings by two antennas for crates/io/src/log/receiver/tests.rs.

python3 -m venv venv && venv/bin/pip install pyubx2==1.4.0 pysbf2==1.0.7 pynmeagps==1.1.8 && venv/bin/python testdata/golden/formats/headings/make.py

Each table has time of week [s], heading and its standard deviation [deg, empty where the log states none] of those that a receiver vouches
for, as the library named reads the log; what the libraries do not know (PASHR, PTNL,AVR) is what was put in.

moving.ubx: NAV-PVT and NAV-RELPOSNED of version 1 at 5 Hz (pyubx2), with a float solution, no fix, a base that does not move and a heading
that is not valid between. first.ubx: the same of version 0, where the heading is that of north and east.
attitude.sbf: AttEuler with AttCovEuler at 10 Hz (pysbf2), with a float solution, an error of a baseline and a heading that is not known.
hdt.nmea, ths.nmea, pashr.nmea, avr.nmea: RMC and one sentence with a heading at 5 Hz, of which some are not valid.
heading2.asc: the HEADING2 example of NovAtel's OEM7 documentation and a float one; heading2.bin: the same two as binary messages.
"""

import csv
import io
import math
import pathlib
import struct
import zlib

from pynmeagps import NMEAMessage, NMEAReader
from pysbf2 import SBF_PROTOCOL, SBFReader
from pysbf2.sbfhelpers import calc_crc
from pyubx2 import GET, UBXMessage, UBXReader

HERE = pathlib.Path(__file__).parent
WEEK = 2374
START = 345_600  # Thursday, 2025-07-10 00:00:00 GPS


def save(name, rows):
    with (HERE / name).open("w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["time", "heading", "std"])
        out.writerows(rows)


def pvt(ms):
    second = ms // 1000 - 18
    hour, minute = second % 86400 // 3600, second % 3600 // 60
    return UBXMessage("NAV", "NAV-PVT", GET, iTOW=ms, year=2025, month=7, day=9 if second % 604800 < 345600 else 10, hour=hour, min=minute,
                      second=second % 60, validDate=1, validTime=1, fullyResolved=1, tAcc=20, nano=ms % 1000 * 1_000_000, fixType=3,
                      gnssFixOk=1, diffSoln=1, carrSoln=2, numSV=20, lon=8.5, lat=47.25, height=450_000, hMSL=400_000, hAcc=14, vAcc=20,
                      sAcc=50).serialize()


def flags(k):
    """Fix, vector valid, kind of solution, moving base, heading valid."""
    return {5: (1, 1, 1, 1, 1), 8: (0, 0, 0, 1, 0), 11: (1, 1, 2, 0, 1), 14: (1, 1, 2, 1, 0)}.get(k, (1, 1, 2, 1, 1))


for name, version in (("moving", 1), ("first", 0)):
    data = b""
    for k in range(25):
        ms = START * 1000 + 200 * k
        fix, valid, solution, moving, heading = flags(k)
        north, east = 30 + k, 40 - 3 * k
        common = dict(refStationID=1, iTOW=ms, relPosN=north, relPosE=east, relPosD=-2, accN=5.0, accE=6.0 + k, accD=9.0)
        bits = dict(gnssFixOK=fix, diffSoln=1, relPosValid=valid, carrSoln=solution, isMoving=moving)
        if version:
            angle = math.degrees(math.atan2(east, north)) % 360
            message = UBXMessage("NAV", "NAV-RELPOSNED", GET, version=1, relPosLength=int(math.hypot(north, east)), relPosHeading=angle,
                                 accLength=8.0, accHeading=0.3 + 0.01 * k, relPosHeadingValid=heading, **common, **bits)
        else:
            message = UBXMessage("NAV", "NAV-RELPOSNED", GET, version=0, **common, **bits)
        data += pvt(ms) + message.serialize()
    (HERE / f"{name}.ubx").write_bytes(data)
    rows = []
    for _, read in UBXReader(io.BytesIO(data)):
        if not read.identity.startswith("NAV-RELPOSNED"):
            continue
        good = read.gnssFixOK and read.relPosValid and read.carrSoln == 2 and read.isMoving
        if version:
            if good and read.relPosHeadingValid:
                rows.append([read.iTOW / 1000, repr(read.relPosHeading), repr(read.accHeading)])
        elif good:
            north, east = read.relPosN, read.relPosE  # [cm]
            std = math.hypot(east * read.accN, north * read.accE) * 0.1 / (north**2 + east**2)  # [mm] over [cm]
            rows.append([read.iTOW / 1000, math.degrees(math.atan2(east, north)), math.degrees(std)])
    save(f"{name}.csv", rows)


def block(number, ms, body):
    body = struct.pack("<IH", ms, WEEK) + body
    body += bytes(-len(body) % 4)
    covered = struct.pack("<HH", number, 8 + len(body)) + body
    return b"$@" + struct.pack("<H", calc_crc(covered)) + covered


data = b""
for k in range(30):
    ms = START * 1000 + 100 * k
    mode, error = {6: (1, 0), 9: (3, 0), 12: (0, 2)}.get(k, (4 if k % 2 else 2, 0))
    heading = -2e10 if k == 15 else (350.5 + 1.25 * k) % 360
    data += block(5938, ms, struct.pack("<BBHHffffff", 12, error, mode, 0, heading, 0.5, -0.25, 0.0, 0.0, 0.0))
    variance = -2e10 if k in (18, 19) else 0.0625 * (1 + k / 16)
    if k != 21:
        data += block(5939, ms, struct.pack("<BBffffff", 0, error, variance, 0.25, 0.25, 0.0, 0.0, 0.0))
(HERE / "attitude.sbf").write_bytes(data)
rows = []
for _, read in SBFReader(io.BytesIO(data), protfilter=SBF_PROTOCOL):
    if read.identity == "AttEuler" and read.Mode in (2, 4) and read.Error == 0 and read.Heading > -1e10:
        rows.append([read.TOW / 1000, repr(read.Heading), ""])
    elif read.identity == "AttCovEuler" and rows and rows[-1][0] == read.TOW / 1000 and read.Cov_HeadHead > 0:
        rows[-1][2] = repr(math.sqrt(read.Cov_HeadHead))
save("attitude.csv", rows)


def sentence(body):
    check = 0
    for byte in body.encode():
        check ^= byte
    return f"${body}*{check:02X}\r\n".encode()


def hms(second):
    of_day = (second - 18) % 86400
    return f"{int(of_day // 3600):02d}{int(of_day % 3600 // 60):02d}{of_day % 60:05.2f}"


kinds = {"hdt": [], "ths": [], "pashr": [], "avr": []}
for kind, rows in kinds.items():
    data = b""
    for k in range(20):
        second = START + 60 + 0.2 * k
        heading = (358.0 + 0.5 * k) % 360
        good = k not in (4, 9)
        date = "100725"
        data += sentence(f"GNRMC,{hms(second)},A,4715.0000,N,00830.0000,E,0.5,270.0,{date},,,R")
        # A course over ground is no heading.
        data += sentence("GNVTG,270.0,T,,M,0.5,N,0.9,K,D")
        row = [round(second, 3), heading, ""]
        if kind == "hdt":
            data += sentence(f"GNHDT,{heading:.3f},T" if good else "GNHDT,,T")
        elif kind == "ths":
            data += sentence(f"GNTHS,{heading:.3f},{'A' if good else 'E'}")
        elif kind == "pashr":
            data += sentence(f"PASHR,{hms(second)},{heading:.2f},T,+01.50,-00.25,+00.10,0.050,0.060,0.{120 + k:03d},{2 if good else 0},1")
            row[2] = (120 + k) / 1000
        else:
            yaw = heading if heading < 180 else heading - 360
            data += sentence(f"PTNL,AVR,{hms(second)},{yaw:+.4f},Yaw,+0.5000,Tilt,,,0.512,{3 if good else 2},1.4,16")
            row[1] = yaw
        if good:
            rows.append(row)
    (HERE / f"{kind}.nmea").write_bytes(data)
    read = []
    for _, message in NMEAReader(io.BytesIO(data)):
        if message is not None and message.msgID == "HDT" and message.headingT != "":
            read.append(message.headingT)
        elif message is not None and message.msgID == "THS" and message.mi == "A":
            read.append(message.headt)
    assert kind in ("pashr", "avr") or read == [row[1] for row in rows], kind
    save(f"{kind}.csv", rows)


def crc(data):
    return zlib.crc32(data, 0xFFFFFFFF) ^ 0xFFFFFFFF


EXAMPLE = """HEADING2A,COM1,0,39.5,FINESTEERING,1622,422892.200,02040000,f9bf,6521;SOL_COMPUTED,NARROW_INT,0.927607417,178.347869873,-1.3037414550,0,\
0.261901051,0.391376048,"R222","AAAA",18,17,17,16,0,01,0,33"""
assert crc(EXAMPLE.encode()) == 0x8C48D77C
second = EXAMPLE.replace("422892.200", "422893.200").replace("NARROW_INT", "NARROW_FLOAT")
(HERE / "heading2.asc").write_bytes(b"".join(b"#%s*%08x\r\n" % (text.encode(), crc(text.encode())) for text in (EXAMPLE, second)))
data = b""
for ms, kind in ((422_892_200, 50), (422_893_200, 34)):
    body = struct.pack("<II6f4s4s8B", 0, kind, 0.927607417, 178.347869873, -1.303741455, 0, 0.261901051, 0.391376048, b"R222", b"AAAA", 18, 17,
                       17, 16, 0, 1, 0, 0x33)
    header = struct.pack("<3sBHBBHHBBHIIHH", b"\xaa\x44\x12", 28, 1335, 0, 0x20, len(body), 0, 120, 180, 1622, ms, 0, 0, 16809)
    data += header + body + struct.pack("<I", crc(header + body))
(HERE / "heading2.bin").write_bytes(data)
