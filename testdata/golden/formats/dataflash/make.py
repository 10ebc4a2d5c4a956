"""Writes flight.BIN, old.BIN and flight.log after ArduPilot's description of its logs (libraries/AP_Logger/README.md and the
LogStructure.h of AP_Logger, AP_GPS and AP_InertialSensor), and what pymavlink reads in the binary ones to expected.json,
scaled to SI and radians here. Needs pymavlink 2.4.50 and numpy 2.

flight.BIN: messages as ArduPilot 4.6 has them, instances in a field, GPA with undulation, raw samples of one IMU.
flight.log: the same as text. old.BIN: messages as ArduPilot 3.1 had them, times in milliseconds, no accuracies.
"""

import json
import struct
from pathlib import Path

import numpy as np
from pymavlink import DFReader

HERE = Path(__file__).parent
CODES = dict(b="b", B="B", h="h", H="H", i="i", I="I", f="f", d="d", n="4s", N="16s", Z="64s", c="h", C="H", e="i", E="I",
             L="i", M="B", q="q", Q="Q")
SCALES = dict(c=100, C=100, e=100, E=100, L=1e7)

# The autopilot starts at this GPS time; its clock is 20 ppm fast. A fix arrives 110 ms after its validity or later.
WEEK, BOOT, FAST, LATENCY = 2374, 345_600.0, 20e-6, 0.110
SECONDS = 3
FIXES = 5  # a second

NEW = {
    128: ("FMT", "BBnNZ", "Type,Length,Name,Format,Columns", "-b---", "-----"),
    32: ("PARM", "QNff", "TimeUS,Name,Value,Default", "s---", "F---"),
    172: ("FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", "s---", "F---"),
    173: ("IMU", "QBffffffIIfBBHH", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz",
          "s#EEEooo--O--zz", "F-000000-----00"),
    174: ("GPS", "QBBIHBcLLeffffB", "TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,Yaw,U",
          "s#-s-S-DUmnhnh-", "F--C-0BGGB000--"),
    # HAcc in centimetres with a multiplier, the others by the letter of their type.
    175: ("GPA", "QBCHCCfBIHfB", "TimeUS,I,VDop,HAcc,VAcc,SAcc,YAcc,VV,SMS,Delta,Und,CN0",
          "s#-mmnd-ssm-", "F-BBBB0-CC0-"),
    176: ("ACC", "QBQfff", "TimeUS,I,SampleUS,AccX,AccY,AccZ", "s#sooo", "F-F000"),
    177: ("GYR", "QBQfff", "TimeUS,I,SampleUS,GyrX,GyrY,GyrZ", "s#sEEE", "F-F000"),
    178: ("ATT", "Qcccc", "TimeUS,DesRoll,Roll,DesPitch,Pitch", "sddhh", "FBBBB"),
    179: ("MSG", "QZ", "TimeUS,Message", "s-", "F-"),
}
OLD = {
    128: ("FMT", "BBnNZ", "Type,Length,Name,Format,Columns", "", ""),
    130: ("GPS", "BIHBcLLeeEefI", "Status,TimeMS,Week,NSats,HDop,Lat,Lng,RelAlt,Alt,Spd,GCrs,VZ,T", "", ""),
    131: ("IMU", "Iffffff", "TimeMS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ", "", ""),
    132: ("IMU2", "Iffffff", "TimeMS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ", "", ""),
}


class Log:
    def __init__(self, formats):
        self.formats, self.binary, self.text = formats, b"", ""
        self.types = {form[0]: number for number, form in formats.items()}
        for number, (name, letters, labels, _, _) in formats.items():
            length = 3 + struct.calcsize("<" + "".join(CODES[letter] for letter in letters))
            self.add("FMT", number, length, name, letters, labels)
        for number, (name, _, _, units, multipliers) in formats.items():
            if units:
                self.add("FMTU", 1000 * number, number, units, multipliers)

    def add(self, name, *values):
        letters = self.formats[self.types[name]][1]
        stored = []
        for letter, value in zip(letters, values, strict=True):
            if letter in "nNZ":
                value = value.encode()
            elif letter in SCALES:
                value = round(value * SCALES[letter])
            stored.append(value)
        code = "<" + "".join(CODES[letter] for letter in letters)
        self.binary += b"\xa3\x95" + bytes([self.types[name]]) + struct.pack(code, *stored)
        shown = []
        for letter, value in zip(letters, values):
            if letter in "cCeE":
                value = f"{value:.2f}"
            elif letter == "L":
                value = f"{value:.7f}"
            elif letter == "f":
                value = repr(float(np.float32(value)))
            shown.append(str(value))
        self.text += ", ".join([name, *shown]) + "\n"


def own(gps):
    """The autopilot's clock at a GPS time [s]."""
    return (gps - BOOT) * (1 + FAST)


def motion(random, t):
    """Rates and specific force [rad/s, m/s2]."""
    return random.normal(0, 0.3, 3), random.normal(0, 1, 3) - [0, 0, 9.8]


def place(k):
    return 47.3977418 + 1e-5 * k, -8.5455939 + 2e-5 * k, 488.25 + 0.25 * k


def flight():
    log, random = Log(NEW), np.random.default_rng(7)
    log.add("MSG", 1_000_000, "ArduCopter V4.6.0")
    for n in range(50 * SECONDS):
        gps = BOOT + 30 + n / 50
        micros = round(own(gps) * 1e6)
        rate, force = motion(random, gps)
        # The gyro is read twice as often as the accelerometer, 1 ms later; logged after it.
        for half in (0, 1):
            sampled = micros + 10_000 * half
            if half == 0:
                log.add("ACC", sampled + 300, 0, sampled, *force)
            log.add("GYR", sampled + 400, 0, sampled + 1000, *(rate + half))
        if n % 2 == 0:
            log.add("IMU", micros, 0, *rate, *force, 0, 0, 44.5, 1, 1, 1000, 1000)
            log.add("IMU", micros, 1, *(rate + 0.01), *(force - 0.1), 0, 0, 44.5, 1, 1, 1000, 1000)
        if n % 10 == 5:
            k = n // 10
            # The fix before now, by the latency and up to 19 ms more.
            late = 0.001 * ((k + 19) * 7 % 20)
            valid = BOOT + 30 + n // 10 / FIXES
            arrived = round(own(valid + LATENCY + late) * 1e6)
            status = [1, 3, 4, 5, 6][min(k, 4)]
            lat, lon, alt = place(k)
            millis = round((valid % 604_800) * 1000)
            log.add("GPS", arrived, 0, status, millis, WEEK, 14, 0.7, lat, lon, alt, 5.5 + 0.25 * k, 10.0 * k, -0.5, 0, 1)
            log.add("GPS", arrived + 5, 1, 3, millis, WEEK, 9, 1.7, lat + 1e-5, lon, alt, 5.5, 10.0 * k, -0.5, 0, 0)
            # The sixth accuracies are lost, the seventh fix has no vertical velocity.
            if k != 5:
                log.add("GPA", arrived, 0, 1.2, 25 + k, 0.5 + 0.01 * k, 0.25, 0, int(k != 6), arrived // 1000, 200, -47.5, 40)
            log.add("GPA", arrived + 5, 1, 1.2, 300, 5, 0.5, 0, 1, arrived // 1000, 200, -47.5, 40)
            log.add("ATT", arrived + 9, 0.5, -0.5, 1.5, -1.5)
    return log


def old():
    log, random = Log(OLD), np.random.default_rng(8)
    for n in range(20):
        millis = 30_000 + 20 * n
        rate, force = motion(random, 0)
        log.add("IMU", millis, *rate, *force)
        log.add("IMU2", millis, *(rate + 0.01), *(force - 0.1))
        if n % 10 == 5:
            lat, lon, alt = place(n)
            log.add("GPS", 3, 345_600_000 + millis - 110, WEEK, 9, 1.7, lat, lon, 3.0, alt, 5.5, 10.0, -0.5, millis)
    return log


def expected(path):
    """What pymavlink reads: times of the autopilot's clock, the rest in SI and radians."""
    log = DFReader.DFReader_binary(str(path), zero_time_base=True)
    found = {"imu": {}, "fixes": {}}
    raw, accuracies = {"GYR": [], "ACC": []}, {}
    while (message := log.recv_msg()) is not None:
        m, kind = message.to_dict(), message.get_type()
        own = m["TimeUS"] / 1e6 if "TimeUS" in m else m.get("T" if kind == "GPS" else "TimeMS", 0) / 1e3
        instance = m.get("I", 1 if kind.endswith("2") else 0)
        if kind in ("IMU", "IMU2"):
            row = [own, *(m[name] for name in ("GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ"))]
            found["imu"].setdefault(f"IMU{instance}", []).append(row)
        elif kind in ("GYR", "ACC"):
            raw[kind].append([m["SampleUS"] / 1e6, *(m[kind.title()[:3] + axis] for axis in "XYZ")])
        elif kind == "GPA":
            accuracies[instance, m["TimeUS"]] = m
        elif kind == "GPS":
            millis, week = m.get("GMS", m["TimeMS"] if "Week" in m else None), m.get("GWk", m.get("Week"))
            course, speed = np.radians(m["GCrs"]), m["Spd"]
            row = {"status": m["Status"], "week": week, "tow": millis / 1e3, "own": own, "id": [instance, m.get("TimeUS")],
                   "lat": np.radians(m["Lat"]), "lon": np.radians(m["Lng"]), "height": m["Alt"],
                   "velocity": [speed * np.cos(course), speed * np.sin(course), m["VZ"]]}
            found["fixes"].setdefault(f"GPS{instance}", []).append(row)
    for row in sum(found["fixes"].values(), []):
        accuracy = accuracies.get(tuple(row.pop("id")))
        if accuracy:
            row["height"] -= accuracy["Und"]
            # pymavlink scales by the letters of types, not by the multipliers of FMTU.
            row["std"] = [accuracy["HAcc"] / 100, accuracy["VAcc"], accuracy["SAcc"]]
            if not accuracy["VV"]:
                del row["velocity"]
    if raw["GYR"]:
        gyro, accel = np.array(raw["GYR"]), np.array(raw["ACC"])
        # Those between two samples of the accelerometer.
        gyro = gyro[(gyro[:, 0] >= accel[0, 0]) & (gyro[:, 0] <= accel[-1, 0])]
        force = [np.interp(gyro[:, 0], accel[:, 0], accel[:, axis]) for axis in (1, 2, 3)]
        found["imu"]["RAW0"] = np.column_stack([gyro, *force]).tolist()
    return found


if __name__ == "__main__":
    new = flight()
    (HERE / "flight.BIN").write_bytes(new.binary)
    (HERE / "flight.log").write_text(new.text)
    (HERE / "old.BIN").write_bytes(old().binary)
    found = {name: expected(HERE / f"{name}.BIN") for name in ("flight", "old")}
    text = json.dumps(found, separators=(",", ":"))
    (HERE / "expected.json").write_text(text.replace("],[", "],\n[").replace("},{", "},\n{") + "\n")
