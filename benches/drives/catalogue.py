"""The drives: where their logs are, how they are read into forward-right-down SI arrays, what is known of their sensors."""

import gzip
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
DEGREE, G = np.pi / 180.0, 9.80665
UNKNOWN = [np.nan] * 3
# White noise and bias instability of gyros [deg/sqrt(h), deg/h], turn-on [deg/s]; of accelerometers [ug/sqrt(Hz), mg], turn-on
# [mg]; correlation time [s]. Data sheets as in the presets of the same names; where the sensor is unknown, the consumer sensor that
# `undrift inspect` proposes.
SHEETS = {
    "icm45686": (0.228, 10.0, 0.4, 70.0, 0.05, 20.0, 300.0),
    "mpu6050": (0.3, 20.0, 20.0, 400.0, 0.1, 80.0, 300.0),
    "adis16405": (2.0, 25.2, 3.0, 340.0, 0.2, 50.0, 100.0),
    "xsens-dot": (0.42, 10.0, 1.0, 120.0, 0.03, 20.0, 300.0),
    "drive30": (0.1, 25.0, 0.007, 170.0, 0.204, 0.2, 3600.0),
}
# Densities of the example files: gyro [deg/s/sqrt(Hz), deg/s/sqrt(s), deg/s], accelerometer [mg/sqrt(Hz), mg/sqrt(s), mg].
HANDS = {
    "rtk": (0.12, 0.0005, 0.5, 2.0, 0.05, 20.0),
    "ublox": (0.02, 0.0003, 0.5, 2.0, 0.05, 30.0),
    "uav": (0.05, 0.001, 0.5, 5.0, 0.1, 30.0),
    "wid": (0.05, 0.0003, 1.0, 2.0, 0.05, 20.0),
    "vibrating": (0.0083, 2e-4, 0.007, 0.85, 0.005, 0.2),
}


def sheet(name):
    """White noise, random walk, turn-on of gyros and accelerometers in SI; the walk is that of the Gauss-Markov process."""
    n, b, on, an, ab, aon, tau = SHEETS[name]
    walk = np.sqrt(2.0 / tau)
    return [n * DEGREE / 60, b * DEGREE / 3600 * walk, on * DEGREE, an * 1e-6 * G, ab * 1e-3 * G * walk, aon * 1e-3 * G]


def hand(name):
    n, walk, on, an, awalk, aon = HANDS[name]
    return [n * DEGREE, walk * DEGREE, on * DEGREE, an * 1e-3 * G, awalk * 1e-3 * G, aon * 1e-3 * G]


def table(path, **options):
    source = gzip.open(path, "rt") if path.suffix == ".gz" else path.open()
    with source:
        return np.genfromtxt(source, **options)


def fixes(time, lla, velocity=None, position_std=None, velocity_std=None):
    """Rows of time, latitude, longitude [rad], height, velocity, standard deviations of both."""
    count = len(time)

    def part(values):
        return np.broadcast_to(UNKNOWN if values is None else values, (count, 3))

    radians = np.column_stack([np.radians(lla[:, :2]), lla[:, 2]])
    rows = np.column_stack([time, radians, part(velocity), part(position_std), part(velocity_std)])
    return rows[np.concatenate([[True], np.diff(rows[:, 0]) > 1e-3])]


def turned(imu, rpy):
    """Samples with the sensor's axes taken to the vehicle's by roll, pitch, yaw [deg]."""
    (sr, sp, sy), (cr, cp, cy) = np.sin(np.radians(rpy)), np.cos(np.radians(rpy))
    matrix = np.array([
        [cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy],
        [cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy],
        [-sp, sr * cp, cr * cp],
    ])
    return np.column_stack([imu[:, 0], imu[:, 1:4] @ matrix.T, imu[:, 4:7] @ matrix.T])


def rtk(folder):
    raw = table(folder / "imu.csv.gz", delimiter=",", skip_header=1)
    imu = np.column_stack([raw[:, 0], np.radians(raw[:, 4:7]), G * raw[:, 1:4]])
    rows = []
    for line in (folder / "gnss.pos").read_text().splitlines():
        parts = line.split()
        if not line.startswith("%") and len(parts) > 20:
            clock = [float(part) for part in parts[1].split(":")]
            rows.append([clock[0] * 3600 + clock[1] * 60 + clock[2], *(float(part) for part in parts[2:])])
    rows = np.array(rows)
    # Seconds of the GPS week: the log of samples has them, the solution file the time of the day.
    rows[:, 0] += 86400.0 * np.round((imu[0, 0] - rows[0, 0]) / 86400.0)
    velocity, velocity_std = rows[:, [14, 15, 16]] * [1, 1, -1], rows[:, [17, 18, 19]]
    return turned(imu, (-179.3639, 6.7603, -174.6124)), fixes(rows[:, 0], rows[:, 1:4], velocity, rows[:, 6:9], velocity_std), None


def uav(folder):
    imu = table(folder / "imu.csv.gz", delimiter=",", skip_header=1)
    imu = imu[np.abs(imu[:, 4:7]).sum(1) > 0]
    gnss = table(folder / "gnss.csv.gz", delimiter=",", skip_header=1)
    return imu, fixes(gnss[:, 0], gnss[:, 1:4], gnss[:, 4:7], (2.0, 2.0, 4.0), (0.3, 0.3, 0.5)), None


def ublox(folder):
    imu = table(folder / "imu.csv.gz", delimiter=",", skip_header=1)
    gnss = table(folder / "gnss.csv.gz", delimiter=",", skip_header=1)
    return imu, fixes(gnss[:, 0], gnss[:, 1:4], gnss[:, 4:7], gnss[:, 7:10], gnss[:, 10:13]), None


def wid(folder):
    raw = table(folder / "imu.csv.gz", delimiter=",", skip_header=1)
    imu = np.column_stack([raw[:, 0], np.radians(raw[:, 1:4]), raw[:, 4:7]])
    gnss = table(folder / "gnss.csv.gz", delimiter=",", skip_header=1)
    return turned(imu, (176.4, -2.5, 95.9)), fixes(gnss[:, 0], gnss[:, 1:4], None, (3.0, 3.0, 6.0)), None


def quad(folder):
    raw, gnss = table(folder / "IMU.txt.gz"), table(folder / "GPS.txt.gz")
    imu = np.column_stack([raw[:, 0] / 1e3, raw[:, 2:8]])
    speed, course = gnss[:, 10], np.radians(gnss[:, 11])
    velocity = np.column_stack([speed * np.cos(course), speed * np.sin(course), gnss[:, 12]])
    if (folder / "GPSraw.txt.gz").exists():
        velocity = table(folder / "GPSraw.txt.gz")[:, 4:7]
    imu = imu[np.concatenate([[True], np.diff(imu[:, 0]) > 1e-3])]
    return imu, fixes(gnss[:, 0] / 1e3, gnss[:, 6:9], velocity, (3.0, 3.0, 6.0), (0.5, 0.5, 0.8)), None


def navego(folder):
    imu = table(folder / "imu.csv.gz", delimiter=",", skip_header=1)
    gnss = table(folder / "gnss.csv.gz", delimiter=",", skip_header=1)
    truth = table(folder / "truth.csv.gz", delimiter=",", skip_header=1)
    truth[:, [1, 2, 7, 8, 9]] = np.radians(truth[:, [1, 2, 7, 8, 9]])
    return imu, fixes(gnss[:, 0], gnss[:, 1:4], gnss[:, 4:7], (5.0, 5.0, 10.0), (0.05,) * 3), truth


def simulated(folder):
    step = 0.005
    raw = np.loadtxt(folder / "imu.txt")
    imu = np.column_stack([raw[:, 0], raw[:, 1:7] / step])
    gnss = np.loadtxt(folder / "gnss.txt")
    truth = np.loadtxt(folder / "truth.nav")[:, 1:11]
    truth[:, [1, 2, 7, 8, 9]] = np.radians(truth[:, [1, 2, 7, 8, 9]])
    return imu, fixes(gnss[:, 0], gnss[:, 1:4], None, gnss[:, 4:7]), truth


def vibrating(folder):
    """The first 15 minutes of the simulated drive at 100 Hz with vibration, five times the sensor's white noise and lines of 28 and 41 Hz, and with
    fixes whose errors last for half a minute: 1.5 m of Gauss-Markov process beside 0.3 m of white noise. Seed 7."""
    imu, gnss, truth = simulated(folder)
    imu = imu[: 2 * (len(imu) // 2)]
    imu = np.column_stack([imu[1::2, 0], 0.5 * (imu[0::2, 1:] + imu[1::2, 1:])])
    imu, gnss = imu[imu[:, 0] < imu[0, 0] + 900.0], gnss[gnss[:, 0] < imu[0, 0] + 900.0]
    random, own = np.random.default_rng(7), sheet("drive30")
    for first, density, line in ((1, own[0], 0.02), (4, own[3], 0.5)):
        scale = np.sqrt(24.0) * density * 10.0
        imu[:, first : first + 3] += scale * random.standard_normal((len(imu), 3))
        for hertz in (28.0, 41.0):
            phase = 2.0 * np.pi * (hertz * imu[:, :1] + random.random(3))
            imu[:, first : first + 3] += line * np.sin(phase)
    error, lasting = np.zeros((len(gnss), 3)), 1.5 * random.standard_normal(3)
    share = np.exp(-1.0 / 30.0)
    for row in error:
        row[:] = lasting + 0.3 * random.standard_normal(3)
        lasting = share * lasting + 1.5 * np.sqrt(1.0 - share**2) * random.standard_normal(3)
    radius = 6378137.0
    gnss[:, 1] += error[:, 0] / radius
    gnss[:, 2] += error[:, 1] / (radius * np.cos(gnss[:, 1]))
    gnss[:, 3] -= error[:, 2]
    gnss[:, 7:10] = np.hypot(1.5, 0.3)
    return imu, gnss, truth


SPEED = 'min_speed = "{} m/s"\n'
AUTO = 'heading = "auto"\n'
START30 = """attitude = "1.5497434056521708, -0.05204363229687356, 41.4318456483079 deg"
attitude_std = "0.5, 0.5, 1.0 deg"
velocity = "-0.011362701751761694, 0.04370870001322649, -0.05613285867780946 m/s"
velocity_std = "0.05 m/s"
"""
PLAIN = '[states]\nscale_factor = "off"\ntime_offset = "off"\n'


def drive(read, folder, preset, by_hand, initial, car=False, lever=(0.0, 0.0, 0.0), states="", mounting=None):
    return {"read": read, "folder": folder, "preset": preset, "hand": by_hand, "initial": initial, "car": car,
            "lever": lever, "states": states, "mounting": mounting}


DRIVES = {"rtk-drive": drive(rtk, "rtk-drive", "icm45686", "rtk", SPEED.format(1), True, (0.0, -0.05, 0.0))}
for group, names in {
    "ublox-drives": "mixed-road-long-drive-nominal-001 parkinglot-maneuvers urban-stop-go-tight-turns-nominal-001",
    "ublox-drives-more": "parking-lot-figure8-nominal-001 urban-long-turn-loop-nominal-001 urban-low-speed-low-signal-001"
    " urban-medium-turn-loop-nominal-001 urban-short-turn-loop-nominal-001",
}.items():
    for name in names.split():
        short = "ublox-" + name.removesuffix("-001").removesuffix("-nominal")
        DRIVES[short] = drive(ublox, f"{group}/{name}", "mpu6050", "ublox", AUTO, True, mounting="auto")
for trial in "02 03 04 06 07 09 10".split():
    DRIVES[f"wid-trial{trial}"] = drive(wid, f"wid-car/trial{trial}", "xsens-dot", "wid", "", True)
DRIVES["uav-flight"] = drive(uav, "uav-flight", "mpu6050", "uav", SPEED.format(6))
DRIVES["quad106"] = drive(quad, "apm-quad/quad106", "mpu6050", "uav", AUTO)
DRIVES["f450-glitch"] = drive(quad, "apm-quad/f450_glitch_log", "mpu6050", "uav", AUTO)
DRIVES["navego-adis16405"] = drive(
    navego, "navego-adis16405", "adis16405", None, 'attitude = "0, 0, -15 deg"\nattitude_std = "1, 1, 5 deg"\n', states=PLAIN
)
SEED = ROOT / "target/drive30/seed1"
DRIVES["drive30"] = drive(simulated, SEED, "drive30", None, START30, lever=(0.136, -0.301, -0.184), states=PLAIN)
DRIVES["sim-vibration"] = drive(vibrating, SEED, "drive30", "vibrating", START30, lever=(0.136, -0.301, -0.184))
