"""The recording that all files of this folder and of ../mcap hold, and what a reader has to make of it.

Messages are (topic, type, time of recording [ns], fields); the expected numbers are computed from the same
inputs by the definitions: GPS time is Unix time + 18 s since 2017, north-east-down is (y, x, -z) of
east-north-up.
"""

GPS_EPOCH = 315964800  # Unix time of 6 January 1980 [s]
WEEK = 604800
SECOND = 10**9
# Half a second before the end of GPS week 2374.
START = (GPS_EPOCH + 2375 * WEEK - 18) * SECOND - SECOND // 2


def header(stamp, frame):
    return {"stamp": divmod(stamp, SECOND), "frame_id": frame}


def vector(x, y, z):
    return {"x": x, "y": y, "z": z}


def imu(stamp, k, gyro_given=True):
    # Exact in binary, so that readings can be compared for equality.
    rate = [k / 128, -0.25, 0.5 + k / 1024]
    force = [0.125, -0.25 * k, 9.8125]
    return {
        "header": header(stamp, "imu_link"),
        "orientation": {"x": 0.0, "y": 0.0, "z": 0.6, "w": 0.8},
        "orientation_covariance": [-1.0] + [0.0] * 8,
        "angular_velocity": vector(*rate),
        "angular_velocity_covariance": [0.01 if gyro_given else -1.0] + [0.0] * 8,
        "linear_acceleration": vector(*force),
        "linear_acceleration_covariance": [0.1, 0, 0, 0, 0.1, 0, 0, 0, 0.1],
    }, rate, force


COVARIANCE = [4.0, 0.5, -0.25, 0.5, 9.0, 0.75, -0.25, 0.75, 16.0]


def fix(stamp, k, status, kind):
    place = [48.1 + 1e-5 * k, 11.5 - 2e-5 * k, 560.25 + k]
    return {
        "header": header(stamp, "gps"),
        "status": {"status": status, "service": 1},
        "latitude": place[0],
        "longitude": place[1],
        "altitude": place[2],
        "position_covariance": COVARIANCE,
        "position_covariance_type": kind,
    }, place


def twist(values):
    return {"linear": vector(*values), "angular": vector(0.1, 0.2, 0.3)}


def ned(enu):
    return [enu[1], enu[0], -enu[2]]


def ned_covariance(enu):
    e = [enu[0:3], enu[3:6], enu[6:9]]
    order, sign = [1, 0, 2], [1, 1, -1]
    return [sign[i] * sign[j] * e[order[i]][order[j]] for i in range(3) for j in range(3)]


def gps(ns):
    """Seconds of the GPS week of the first stamp."""
    first_week = (START + 18 * SECOND - GPS_EPOCH * SECOND) // (WEEK * SECOND)
    return (ns + 18 * SECOND - (GPS_EPOCH + first_week * WEEK) * SECOND) / SECOND


def recording():
    messages, samples, fixes = [], [], {}
    number = 0

    def add(topic, kind, time, fields):
        nonlocal number
        number += 1
        messages.append((topic, kind, time, fields))
        return number

    for k in range(12):
        stamp = START + k * 100_000_000
        recorded = stamp + 3_000_000
        # The eighth has no stamp; the sixth no rates.
        given = 0 if k == 7 else stamp
        fields, rate, force = imu(given, k, k != 5)
        at = add("/imu/data", "sensor_msgs/msg/Imu", recorded, fields)
        if k != 5:
            time = gps(recorded if given == 0 else stamp)
            samples.append({"at": at, "time": time, "gyro": rate, "accel": force})
        if k % 2 == 1:
            continue
        add("/chatter", "std_msgs/msg/String", recorded, {"data": f"message {k}"})
        wheel = {"header": header(stamp, "base_link"), "twist": twist([3.0, 0.0, 0.0])}
        add("/wheel", "geometry_msgs/msg/TwistStamped", recorded, wheel)
        odometry = {
            "header": header(stamp, "odom"),
            "child_frame_id": "base_link",
            "pose": {
                "pose": {"position": vector(k, 0.0, 0.0), "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}},
                "covariance": [0.0] * 36,
            },
            "twist": {"twist": twist([3.0, 0.0, 0.0]), "covariance": [0.0] * 36},
        }
        add("/odom", "nav_msgs/msg/Odometry", recorded, odometry)
        # Status and type of covariance: the fourth has no fix.
        status, kind = [(0, 3), (1, 2), (2, 0), (-1, 3), (2, 1), (0, 3)][k // 2]
        fields, place = fix(stamp, k, status, kind)
        velocity = [1.0 + k, -2.0, 0.5]
        moving = {
            "header": header(stamp, "gps"),
            "twist": {
                "twist": twist(velocity),
                "covariance": [0.01 * (7 * i + 1) if i % 7 == 0 else 0.0 for i in range(36)],
            },
        }
        at = add("/gps/fix", "sensor_msgs/msg/NavSatFix", recorded, fields)
        entry = fixes.setdefault(stamp, {"at": at, "time": gps(stamp), "quality": "Unknown"})
        if status >= 0:
            diagonal = [c if i % 4 == 0 else 0.0 for i, c in enumerate(COVARIANCE)]
            entry["position"] = place
            entry["position_covariance"] = [None, COVARIANCE, diagonal, COVARIANCE][kind]
            entry["quality"] = {0: "Single", 1: "Differential", 2: "Unknown"}[status]
            if entry["position_covariance"]:
                entry["position_covariance"] = ned_covariance(entry["position_covariance"])
        # The velocity of the last position is missing.
        if k < 10:
            at = add("/gps/vel", "geometry_msgs/msg/TwistWithCovarianceStamped", recorded, moving)
            if "position" not in entry:
                entry["at"] = at
            entry["velocity"] = ned(velocity)
            entry["velocity_covariance"] = ned_covariance(
                [0.01, 0, 0, 0, 0.01 * 50, 0, 0, 0, 0.01 * 99]
            )
    expected = {"imu": samples, "fixes": list(fixes.values()), "messages": number}
    return messages, expected


def two_imus():
    """Two topics of sensor_msgs/Imu; the second begins late."""
    return [
        ("/imu/b" if k in (4, 6) else "/imu/a", "sensor_msgs/msg/Imu", START + k * 100_000_000, imu(START + k * 100_000_000, k)[0])
        for k in range(8)
    ]


def build(store, kind, fields):
    """A message of a rosbags type store from plain fields."""
    import numpy as np

    definition = store.types[kind]
    values = {}
    for name, (node, detail) in store.fielddefs[kind][1]:
        if kind == "std_msgs/msg/Header" and name == "seq":
            values[name] = 0
            continue
        value = fields[name]
        if name == "stamp":
            time = store.types["builtin_interfaces/msg/Time"]
            value = time(sec=int(value[0]), nanosec=int(value[1]))
        elif isinstance(value, dict):
            value = build(store, detail, value)
        elif isinstance(value, list):
            value = np.array(value, dtype=np.float64)
        values[name] = value
    return definition(**values)
