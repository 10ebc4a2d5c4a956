"""Writes flight.ulg and old.ulg after PX4's "ULog File Format", version 1, and what pyulog reads in
them to expected.json, scaled to SI and radians here. Needs pyulog 1.3 and numpy 2.

flight.ulg: topics as PX4 1.14 defines them; increments of two IMUs at 250 Hz, the second thinned.
old.ulg: topics as PX4 1.6 defined them, some of the data appended after a message that was cut off.
"""

import json
import struct
from pathlib import Path

import numpy as np
from pyulog import ULog

HERE = Path(__file__).parent
CODES = {"uint64_t": "Q", "int64_t": "q", "uint32_t": "I", "int32_t": "i", "uint16_t": "H", "uint8_t": "B",
         "bool": "B", "float": "f", "double": "d"}
SYNC = bytes([0x2F, 0x73, 0x13, 0x20, 0x25, 0x0C, 0xBB, 0x12])
SAMPLES, STEP = 40, 4000  # of 4000 µs
START = 5_000_000

random = np.random.default_rng(5)


def message(kind, body):
    return struct.pack("<HB", len(body), ord(kind)) + body


def header():
    return b"ULog\x01\x12\x35\x01" + struct.pack("<Q", START)


def flags(offsets=(0, 0, 0)):
    incompatible = bytes([1 if any(offsets) else 0]) + bytes(7)
    return message("B", bytes(8) + incompatible + struct.pack("<3Q", *offsets))


def define(name, fields):
    return message("F", f"{name}:{fields}".encode())


def subscribe(instance, number, name):
    return message("A", struct.pack("<BH", instance, number) + name.encode())


def data(number, fields, *values):
    """Values in the order of the fields; padding at the end is left out, as PX4 does."""
    code, flat = "<", []
    kinds = [field.split(" ") for field in fields.strip(";").split(";")]
    while kinds[-1][1].startswith("_padding"):
        kinds.pop()
    values = list(values)
    for kind, name in kinds:
        kind, _, count = kind.partition("[")
        count = int(count.rstrip("]") or 1)
        if name.startswith("_padding"):
            code += f"{count}x"
            continue
        value = values.pop(0)
        code += f"{count}{CODES[kind]}"
        flat += list(value) if count > 1 else [value]
    return message("D", struct.pack("<H", number) + struct.pack(code, *flat))


IMU = ("uint64_t timestamp;uint64_t timestamp_sample;uint32_t accel_device_id;uint32_t gyro_device_id;"
       "float[3] delta_angle;float[3] delta_velocity;uint16_t delta_angle_dt;uint16_t delta_velocity_dt;"
       "uint8_t delta_velocity_clipping;uint8_t[3] _padding0;")
COMBINED = ("uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_integral_dt;int32_t accelerometer_timestamp_relative;"
            "float[3] accelerometer_m_s2;uint32_t accelerometer_integral_dt;uint8_t accelerometer_clipping;"
            "uint8_t[3] _padding0;")
GPS = ("uint64_t timestamp;uint64_t timestamp_sample;double latitude_deg;double longitude_deg;double altitude_msl_m;"
       "double altitude_ellipsoid_m;uint32_t device_id;float s_variance_m_s;float eph;float epv;float vel_n_m_s;"
       "float vel_e_m_s;float vel_d_m_s;uint8_t fix_type;bool vel_ned_valid;uint8_t[2] _padding0;")
GLOBAL = ("uint64_t timestamp;uint64_t timestamp_sample;double lat;double lon;float alt;float alt_ellipsoid;")
LOCAL = "uint64_t timestamp;uint64_t timestamp_sample;float vx;float vy;float vz;uint8_t[4] _padding0;"
NESTED = "uint64_t timestamp;point[2] points;uint8_t count;"


def flight():
    out = header() + flags()
    out += message("I", bytes([16]) + b"char[3] sys_namePX4")
    out += define("nested", NESTED) + define("point", "float x;float y;uint16_t[3] z;")
    for name, fields in [("vehicle_imu", IMU), ("sensor_combined", COMBINED), ("sensor_gps", GPS),
                         ("vehicle_gps_position", GPS), ("vehicle_global_position", GLOBAL),
                         ("vehicle_local_position", LOCAL)]:
        out += define(name, fields)
    names = [(0, "nested"), (0, "vehicle_imu"), (1, "vehicle_imu"), (0, "sensor_combined"), (0, "sensor_gps"),
             (0, "vehicle_global_position"), (0, "vehicle_local_position"), (0, "vehicle_gps_position")]
    for number, (instance, name) in enumerate(names):
        out += subscribe(instance, number, name)
    for k in range(SAMPLES):
        sample = START + k * STEP
        rate, force = random.normal(0, 0.3, 3), random.normal(0, 1, 3) - [0, 0, 9.8]
        out += data(0, "uint64_t timestamp;float[4] p;uint8_t[6] q;uint8_t count;", sample, [1.5] * 4, range(6), 2) \
            if k == 3 else b""
        dt = STEP + int(random.integers(-3, 4))
        increments = [rate * dt * 1e-6, force * dt * 1e-6, dt, dt, 0]
        out += data(1, IMU, sample + 350, sample, 7, 8, *increments)
        if k % 20 == 0:
            out += data(2, IMU, sample + 390, sample + 40, 9, 10, *increments)
        out += data(3, COMBINED, sample, rate, STEP, 2**31 - 1 if k == 9 else 0, force, STEP, 0)
        if k % 10 == 5:
            out += message("S", SYNC)
            fix_type = [2, 3, 5, 6][k // 10]
            place = [47.3977418 + 1e-6 * k, 8.5455939 + 2e-6 * k, 488.25 + 0.01 * k, 535.5 + 0.01 * k]
            velocity = random.normal(0, 3, 3)
            # The first has no time of its own, the last no usable standard deviation.
            eph = 0.0 if k > 30 else 0.44
            values = [*place, 3, 0.25, eph, 0.54, *velocity, fix_type, k != 25]
            out += data(4, GPS, sample + 90, 0 if k < 20 else sample - 110_000, *values)
            out += data(6, LOCAL, sample + 20, sample - 8000, *(velocity + 0.1))
            out += data(5, GLOBAL, sample + 20, sample - 8000 + (1 if k > 30 else 0), *place)
            if k > 30:
                out += data(7, GPS, sample + 95, sample - 110_000, *values)
    out += message("L", b"6" + struct.pack("<Q", START) + b"the end")
    return out


OLD_COMBINED = ("uint64_t timestamp;float[3] gyro_rad;float gyro_integral_dt;int32_t accelerometer_timestamp_relative;"
                "float[3] accelerometer_m_s2;float accelerometer_integral_dt;float baro_alt_meter;")
OLD_GPS = ("uint64_t timestamp;uint64_t time_utc_usec;int32_t lat;int32_t lon;int32_t alt;int32_t alt_ellipsoid;"
           "float s_variance_m_s;float eph;float epv;float vel_n_m_s;float vel_e_m_s;float vel_d_m_s;"
           "int32_t timestamp_time_relative;uint8_t fix_type;bool vel_ned_valid;uint8_t[2] _padding0;")
OLD_GLOBAL = ("uint64_t timestamp;double lat;double lon;float alt;float vel_n;float vel_e;float vel_d;float yaw;"
              "uint8_t[4] _padding0;")


def old():
    def build(offset):
        out = header() + flags((offset, 0, 0))
        for number, (name, fields) in enumerate([("sensor_combined", OLD_COMBINED),
                                                 ("vehicle_gps_position", OLD_GPS),
                                                 ("vehicle_global_position", OLD_GLOBAL)]):
            out += define(name, fields)
        names = ["sensor_combined", "vehicle_gps_position", "vehicle_global_position"]
        subscriptions = b"".join(subscribe(0, number, name) for number, name in enumerate(names))
        out += subscriptions
        rng = np.random.default_rng(6)
        for k in range(20):
            rate, force = rng.normal(0, 0.3, 3), rng.normal(0, 1, 3) - [0, 0, 9.8]
            time = START + k * STEP
            one = data(0, OLD_COMBINED, time, rate, STEP * 1e-6, 0, force, STEP * 1e-6, 300.5)
            if k == 12:
                # The log breaks off here; the rest was appended later. pyulog forgets the
                # subscriptions there.
                out += one[:17]
                cut = len(out)
                out += subscriptions
            else:
                out += one
            if k % 5 == 4:
                velocity = rng.normal(0, 3, 3)
                lat, lon = 473977418 + 10 * k, -85455939 + 20 * k
                out += data(1, OLD_GPS, time, 1_500_000_000_000_000 + time, lat, lon, 488_250, 535_500 + k, 0.25,
                            0.44, 0.54, *velocity, 0, 3, 1)
                out += data(2, OLD_GLOBAL, time, lat * 1e-7, lon * 1e-7, 488.25, *velocity, 0.5)
        return out, cut

    _, cut = build(1)
    return build(cut)[0]


def three(topic, name):
    return [topic.data[f"{name}[{i}]"].astype(float) for i in range(3)]


def times(topic):
    sampled = topic.data.get("timestamp_sample", topic.data["timestamp"])
    return np.where(sampled > 0, sampled, topic.data["timestamp"]) / 1e6


def rows(*columns):
    return np.stack([np.asarray(column, float) for column in columns], axis=1).tolist()


def expected(path):
    log = ULog(str(path))
    out = {"streams": {}, "imu": {}, "fixes": {}, "poses": {}}
    for topic in log.data_list:
        name, values = f"{topic.name}.{topic.multi_id}", topic.data
        out["streams"][name] = out["streams"].get(name, 0) + len(values["timestamp"])
        if topic.name == "vehicle_imu":
            gyro = [v / (values["delta_angle_dt"] * 1e-6) for v in three(topic, "delta_angle")]
            accel = [v / (values["delta_velocity_dt"] * 1e-6) for v in three(topic, "delta_velocity")]
            kind, found = "imu", rows(times(topic), *gyro, *accel)
        elif topic.name == "sensor_combined":
            kept = values["accelerometer_timestamp_relative"] != 2**31 - 1
            columns = [times(topic), *three(topic, "gyro_rad"), *three(topic, "accelerometer_m_s2")]
            kind, found = "imu", rows(*[column[kept] for column in columns])
        elif topic.name in ("sensor_gps", "vehicle_gps_position"):
            if "lat" in values:
                place = [values["lat"] * 1e-7, values["lon"] * 1e-7, values["alt_ellipsoid"] * 1e-3]
            else:
                place = [values[k] for k in ("latitude_deg", "longitude_deg", "altitude_ellipsoid_m")]
            velocity = [values[k] for k in ("vel_n_m_s", "vel_e_m_s", "vel_d_m_s")]
            more = [values[k] for k in ("eph", "epv", "s_variance_m_s", "fix_type", "vel_ned_valid")]
            all_rows = rows(times(topic), *np.radians(place[:2]), place[2], *velocity, *more)
            kind, found = "fixes", [row for row in all_rows if row[10] >= 3]
        elif topic.name == "vehicle_global_position":
            height = values.get("alt_ellipsoid", values["alt"])
            kind, found = "poses", rows(times(topic), np.radians(values["lat"]), np.radians(values["lon"]), height)
        else:
            continue
        # The appended part of a log is a topic of its own here.
        out[kind].setdefault(name, []).extend(found)
    return out


if __name__ == "__main__":
    found = {}
    for name, content in [("flight", flight()), ("old", old())]:
        path = HERE / f"{name}.ulg"
        path.write_bytes(content)
        found[name] = expected(path)
    (HERE / "expected.json").write_text(json.dumps(found, indent=None, separators=(",", ":")).replace("],[", "],\n[") + "\n")
