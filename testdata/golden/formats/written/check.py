#!/usr/bin/env python3
"""Reads what the writers wrote beside this file with readers of others.

pip install numpy pyyaml opencv-python-headless gtsam pynmeagps gpxpy lxml fastkml geojson shapely

The files come from the tests `equal_to_what_was_checked` of undrift-noise (tests/it/export.rs) and undrift-io
(tests/it/written.rs) with UNDRIFT_BLESS=1; without it they hold that the writers still write the same bytes.
"""

import math
from pathlib import Path

HERE = Path(__file__).parent
DEG = math.pi / 180


def close(ours, expected, relative=6e-9, absolute=0.0):
    ours = ours if isinstance(ours, list) else [ours]
    expected = expected if isinstance(expected, list) else [expected]
    assert len(ours) == len(expected), (ours, expected)
    for a, b in zip(ours, expected):
        assert isinstance(a, (int, float)), f"{a!r} is no number"
        assert abs(a - b) <= relative * abs(b) + absolute, (ours, expected)


# The model of crates/noise/tests/it/export.rs, in SI units. Nine digits are written: 6e-9.
WHITE = [0.3 * DEG / 60, 0.3 * DEG / 60, 0.6 * DEG / 60]
DRIVE = 9 * DEG / 3600 * math.sqrt(2 / 200)
TURN_ON_Z = 12 * DEG / 3600


def rms(values):
    return math.sqrt(sum(v * v for v in values) / len(values))


def models():
    import json

    import cv2
    import yaml

    def load(name):
        return yaml.safe_load((HERE / name).read_text(encoding="utf-8"))

    imu = load("imu.kalibr.yaml")
    assert set(imu) == {
        "accelerometer_noise_density", "accelerometer_random_walk", "gyroscope_noise_density",
        "gyroscope_random_walk", "rostopic", "update_rate",
    }
    close(imu["gyroscope_noise_density"], rms(WHITE))
    # The best walk for an outage of 30 s of a process of 200 s: a little less than its driving noise.
    assert 0.7 * DRIVE < imu["gyroscope_random_walk"] < 0.95 * DRIVE
    close(imu["accelerometer_noise_density"], 1e-3)
    close(imu["accelerometer_random_walk"], 1e-4)
    close(imu["update_rate"], 100.0)
    assert imu["rostopic"].startswith("/")

    # The filter of KF-GINS turns these into q = 2 std²/corrtime.
    kf = load("imu.kf-gins.yaml")
    noise = kf["imunoise"]
    close([v * DEG / 60 for v in noise["arw"]], WHITE)
    close([v / 60 for v in noise["vrw"]], [1e-3] * 3)
    tau = noise["corrtime"] * 3600
    close([v * DEG / 3600 * math.sqrt(2 / tau) for v in noise["gbstd"]], [DRIVE] * 3)
    close([v * 1e-5 * math.sqrt(2 / tau) for v in noise["abstd"]], [1e-4] * 3)
    assert noise["gsstd"] == noise["asstd"] == [0.0] * 3
    close(kf["initbgstd"][2] ** 2 - kf["initbgstd"][0] ** 2, 144.0, relative=1e-6)

    ros = load("imu.ros.yaml")["imu"]["ros__parameters"]
    close([ros["angular_velocity_covariance"][i] for i in (0, 4, 8)], [n * n * 100 for n in WHITE])
    close([ros["linear_acceleration_covariance"][i] for i in (0, 4, 8)], [1e-4] * 3)
    assert all(len(ros[f"{q}_covariance"]) == 9 for q in ("angular_velocity", "linear_acceleration", "orientation"))
    assert ros["orientation_covariance"][0] == -1

    rows = [
        line.split("\t")
        for line in (HERE / "imu.px4.params").read_text(encoding="utf-8").splitlines()
        if not line.startswith("#")
    ]
    px4 = {name: float(value) for _, _, name, value, kind in rows if kind == "9"}
    # EKF2 adds (noise dt)² a prediction: over one second of 100 it must be N².
    close([(px4["EKF2_GYR_NOISE"] * 0.01) ** 2 * 100], [rms(WHITE) ** 2], relative=2e-8)
    close([(px4["EKF2_ACC_B_NOISE"] * 0.01) ** 2 * 100], [1e-8], relative=2e-8)
    close(px4["EKF2_GBIAS_INIT"], TURN_ON_Z / math.sqrt(3))

    # A step of VINS adds (noise dt)²/2 and (bias noise dt)²: over one second of 100 they must be N² and K².
    vins = cv2.FileStorage("%YAML:1.0\n" + (HERE / "imu.vins.yaml").read_text(encoding="utf-8"), cv2.FILE_STORAGE_MEMORY)
    of_vins = {key: vins.getNode(key).real() for key in ("acc_n", "gyr_n", "acc_w", "gyr_w", "g_norm")}
    close([0.5 * (of_vins["gyr_n"] * 0.01) ** 2 * 100], [rms(WHITE) ** 2], relative=2e-8)
    close([0.5 * (of_vins["acc_n"] * 0.01) ** 2 * 100], [1e-6], relative=2e-8)
    close([(of_vins["gyr_w"] * 0.01) ** 2 * 100], [imu["gyroscope_random_walk"] ** 2], relative=4e-8)
    close([(of_vins["acc_w"] * 0.01) ** 2 * 100], [1e-8], relative=2e-8)
    close(of_vins["g_norm"], 9.80665)

    openvins = cv2.FileStorage(str(HERE / "imu.openvins.yaml"), cv2.FILE_STORAGE_READ)
    chain = openvins.getNode("imu0")
    for key, value in imu.items():
        if key != "rostopic":
            close(chain.getNode(key).real(), value)
    assert chain.getNode("rostopic").string() == imu["rostopic"] and chain.getNode("model").string() == "kalibr"
    for name, size, diagonal in [("T_i_b", 4, 1), ("Tw", 3, 1), ("Ta", 3, 1), ("R_IMUtoGYRO", 3, 1), ("R_IMUtoACC", 3, 1), ("Tg", 3, 0)]:
        matrix = chain.getNode(name)
        rows = [[matrix.at(i).at(j).real() for j in range(size)] for i in range(matrix.size())]
        assert rows == [[diagonal if i == j else 0 for j in range(size)] for i in range(size)], (name, rows)

    basalt = json.loads((HERE / "imu.basalt.json").read_text(encoding="utf-8"))["value0"]
    close(basalt["gyro_noise_std"], WHITE)
    close(basalt["accel_noise_std"], [1e-3] * 3)
    close(rms(basalt["gyro_bias_std"]), imu["gyroscope_random_walk"], relative=2e-8)
    close(basalt["accel_bias_std"], [1e-4] * 3)
    close(basalt["imu_update_rate"], 100.0)
    # GTSAM itself integrates a second at 100 Hz at rest; angle, position, velocity, biases of accelerometer and gyro.
    import gtsam
    import numpy

    names = {}
    exec((HERE / "imu.gtsam.py").read_text(encoding="utf-8"), names)
    factor = gtsam.PreintegratedCombinedMeasurements(names["params"], gtsam.imuBias.ConstantBias())
    for _ in range(100):
        factor.integrateMeasurement(numpy.array([0, 0, 9.80665]), numpy.zeros(3), 0.01)
    variances = numpy.diag(factor.preintMeasCov())
    walks = numpy.array(basalt["gyro_bias_std"]) ** 2
    close(list(variances[:3]), list(numpy.array(WHITE) ** 2 + walks / 3), relative=1e-3)
    close([variances[8]], [1e-6 + 1e-8 / 3], relative=1e-3)
    close(list(variances[9:]), [1e-8] * 3 + list(walks), relative=4e-8)

    # EKF3 adds (noise dt)² and, to biases that are angles of a step, (noise dt²)²: over a second at 100 Hz N² and K².
    lines = (HERE / "imu.ardupilot.param").read_text(encoding="utf-8").splitlines()
    pilot = {name: float(value) for name, value in (line.split(",") for line in lines if not line.startswith("#"))}
    close([(pilot["EK3_GYRO_P_NSE"] * 0.01) ** 2 * 100], [rms(WHITE) ** 2], relative=2e-8)
    close([(pilot["EK3_ACC_P_NSE"] * 0.01) ** 2 * 100], [1e-6], relative=2e-8)
    close([(pilot["EK3_GBIAS_P_NSE"] * 0.01**2 / 0.01) ** 2 * 100], [imu["gyroscope_random_walk"] ** 2], relative=4e-8)
    close([(pilot["EK3_ABIAS_P_NSE"] * 0.01**2 / 0.01) ** 2 * 100], [1e-8], relative=2e-8)

    # A step of Gazebo's bias: φ = exp(−dt/τ), variance σ_b² τ/2 (1 − φ²), so that of the process is σ_b² τ/2.
    from xml.etree import ElementTree

    root = ElementTree.parse(HERE / "imu.gazebo.sdf").getroot()
    assert root.tag == "imu" and [child.tag for child in root] == ["angular_velocity", "linear_acceleration"]
    for axis, white, turn_on in zip("xyz", WHITE, [0, 0, TURN_ON_Z]):
        noise = root.find(f"angular_velocity/{axis}/noise")
        assert noise.get("type") == "gaussian"
        value = {child.tag: float(child.text) for child in noise}
        close(value["stddev"], white * 10)
        tau = value["dynamic_bias_correlation_time"]
        close([tau, value["dynamic_bias_stddev"] ** 2 * tau / 2], [200.0, (9 * DEG / 3600) ** 2], relative=2e-8)
        close(value["bias_stddev"], turn_on)
    value = {child.tag: float(child.text) for child in root.find("linear_acceleration/y/noise")}
    close([value["stddev"], value["dynamic_bias_stddev"], value["dynamic_bias_correlation_time"]], [0.01, 1e-4, 3600.0])
    print("models: kalibr, kf-gins, ros (PyYAML), px4, vins, openvins (OpenCV), basalt, gtsam (GTSAM), ardupilot and gazebo hold what the model says")


# The track of crates/io/tests/it/written.rs: row k of 241, 20 a second, without GNSS from 80 to 160.
NAME = 'Harbour <1> & "back"'
START = 604794.0


def lat(k):
    return -33.86 + 1e-6 * k


def lon(k):
    return 151.2 - 2e-6 * k


def height(k):
    return 25 + 0.01 * k


def place(k):
    return [lon(k), lat(k), height(k)]


def near(point, k):
    """Nine decimals of degrees, three of metres, half of the last one."""
    close(list(point), place(k), relative=1e-12, absolute=6e-10)


def utc(k):
    """12 July 2025 is the Saturday of GPS week 2374; GPS was 18 s ahead of UTC."""
    from datetime import datetime, timedelta, timezone

    epoch = datetime(1980, 1, 6, tzinfo=timezone.utc)
    return epoch + timedelta(weeks=2374, seconds=START - 18, milliseconds=50 * k)


# First and last row of the lines; every other row is there.
SPANS = [(0, 80, True), (80, 160, False), (160, 240, True)]


def nav():
    import numpy

    rows = numpy.loadtxt(HERE / "track.nav")
    assert rows.shape == (241, 11)
    for k, row in enumerate(rows):
        gps = row[0] * 604800 + row[1] - (2374 * 604800 + START)
        assert 0 <= row[1] < 604800 and abs(gps - 0.05 * k) < 1e-6
        close(list(row[2:4]), [lat(k), lon(k)], relative=1e-13, absolute=6e-12)
        close(list(row[4:]), [height(k), 2.0, -3.5, 0.25, 1.5, -2.25, 300.0], relative=1e-9)
    print("track.nav: 241 rows of 11 columns (numpy)")


def nmea():
    from pynmeagps import NMEAReader

    epochs = {}
    with open(HERE / "track.nmea", "rb") as stream:
        # validate=1 checks the checksums, quitonerror=2 raises on what is wrong.
        for _, message in NMEAReader(stream, validate=1, quitonerror=2):
            assert message.talker == "GN"
            epochs.setdefault(message.msgID, []).append(message)
    assert {kind: len(all) for kind, all in epochs.items()} == {"RMC": 121, "GGA": 121, "GST": 121, "HDT": 121}
    for i in range(121):
        k, outage = 2 * i, 80 <= 2 * i < 160
        rmc, gga, gst, hdt = (epochs[kind][i] for kind in ("RMC", "GGA", "GST", "HDT"))
        time = utc(k)
        assert (rmc.date, rmc.time) == (time.date(), time.time()), (rmc.date, rmc.time, time)
        for message in (rmc, gga):
            # 1e-7 of a minute is 1.7e-9 deg, and pynmeagps rounds to ten decimals.
            close([message.lat, message.lon], [lat(k), lon(k)], relative=0, absolute=1e-9)
        close([gga.alt + float(gga.sep)], [height(k)], relative=1e-12)
        assert gga.quality == (6 if outage else 1) and rmc.posMode == ("E" if outage else "A")
        close([rmc.spd * 1852 / 3600, rmc.cog], [math.hypot(2, 3.5), 360 - math.degrees(math.atan2(3.5, 2))], relative=1e-4)
        close([gst.stdLat, gst.stdLong, gst.stdAlt, hdt.headingT], [0.5, 0.75, 1.25, 300.0])
    print("track.nmea: 484 sentences with right checksums (pynmeagps)")


def kml():
    from fastkml import kml as fast
    from fastkml.utils import find_all
    from fastkml import Placemark
    from fastkml.validator import validate
    from lxml import etree

    etree.parse(HERE / "track.kml")
    assert validate(file_to_validate=HERE / "track.kml") is True
    document = fast.KML.parse(HERE / "track.kml")
    assert document.features[0].name == NAME
    every = list(find_all(document, of_type=Placemark))
    places = [place for place in every if place.name.startswith("With")]
    assert [p.style_url.url for p in places] == ["#gnss", "#no-gnss", "#gnss"]
    # Of constant standard deviations there is an ellipse at the two ends of each span.
    ellipses = [place for place in every if place not in places]
    assert [p.style_url.url for p in ellipses] == ["#gnss"] * 2 + ["#no-gnss"] * 2 + ["#gnss"] * 2
    for placemark, k in zip(ellipses, [k for span in SPANS for k in span[:2]], strict=True):
        assert placemark.name == f"95 % at {START + 0.05 * k:.1f} s: 1σ north 0.500 m, east 0.750 m"
        ellipse(placemark.kml_geometry.geometry.exterior.coords, k)
    for placemark, (first, last, gnss) in zip(places, SPANS):
        assert placemark.name.startswith("With GNSS" if gnss else "Without GNSS")
        points = [item for track in placemark.kml_geometry.tracks for item in track.track_items]
        for point, k in zip(points, range(first, last + 1, 2), strict=True):
            near(point.coord.coords[0], k)
            assert point.when.dt == utc(k), (point.when.dt, utc(k))
    print("track.kml: valid by the schema of KML 2.2, three tracks with instants, six ellipses (fastkml, lxml)")


def ellipse(corners, k):
    """Closed, counterclockwise, its half axes 2.448 times 0.5 m north and 0.75 m east of the row's place."""
    assert len(corners) == 25 and corners[0] == corners[-1]
    metres = [((x - lon(k)) * 111320 * math.cos(math.radians(lat(k))), (y - lat(k)) * 110900) for x, y, _ in corners]
    scale = math.sqrt(-2 * math.log(0.05))
    for east, north in metres:
        close(math.hypot(east / 0.75, north / 0.5), scale, relative=4e-3)
    area = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(metres, metres[1:])) / 2
    close(area, 12 * math.sin(math.pi / 12) * 0.75 * 0.5 * scale**2, relative=8e-3)


def geo():
    from datetime import datetime

    import geojson

    geojson.geometry.DEFAULT_PRECISION = 9
    from shapely.geometry import shape

    with open(HERE / "track.geojson", encoding="utf-8") as stream:
        collection = geojson.load(stream)
    assert collection.is_valid, collection.errors()
    assert collection["name"] == NAME
    lines = [feature for feature in collection.features if feature.geometry["type"] == "LineString"]
    ellipses = [feature for feature in collection.features if feature not in lines]
    for feature, k in zip(ellipses, [k for span in SPANS for k in span[:2]], strict=True):
        assert shape(feature.geometry).is_valid and feature.geometry["type"] == "Polygon"
        close([feature.properties[key] for key in ["time_s", "north_std_m", "east_std_m"]], [START + 0.05 * k, 0.5, 0.75], relative=1e-9)
        ellipse(feature.geometry["coordinates"][0], k)
    for feature, (first, last, gnss) in zip(lines, SPANS, strict=True):
        assert feature.properties["gnss"] is gnss
        close(feature.properties["start_s"], START + 0.05 * first, relative=1e-12)
        for key, k in [("start", first), ("end", last)]:
            assert datetime.fromisoformat(feature.properties[key]) == utc(k), feature.properties
        line = shape(feature.geometry)
        assert line.has_z and line.is_valid and line.geom_type == "LineString"
        for point, k in zip(line.coords, range(first, last + 1, 2), strict=True):
            near(point, k)
    print("track.geojson: a valid collection of three lines and six ellipses (geojson, shapely)")


def gpx():
    import gpxpy

    track = gpxpy.parse((HERE / "track.gpx").read_text(encoding="utf-8"))
    assert track.version == "1.1" and track.tracks[0].name == NAME
    (segment,) = track.tracks[0].segments
    assert len(segment.points) == 121
    for i, point in enumerate(segment.points):
        k = 2 * i
        near([point.longitude, point.latitude, point.elevation], k)
        assert point.time == utc(k), (point.time, utc(k))
        assert point.type_of_gpx_fix == ("none" if 80 <= k < 160 else "3d")
    print("track.gpx: 121 points with their times (gpxpy)")


if __name__ == "__main__":
    models()
    nav()
    nmea()
    kml()
    geo()
    gpx()
