"""What tools/live-tests runs beside `undrift live`: CycloneDDS publishes sensor_msgs/Imu and NavSatFix of the drive of `undrift sample` and
subscribes to what undrift publishes, on loopback alone.

    tools/live-tests-ros2.py LOGS DOMAIN BEGIN END PACE RESULT.json
"""
import csv
import json
import math
import pathlib
import sys
import time
from dataclasses import dataclass

PEERS = """<CycloneDDS><Domain id="any"><General><AllowMulticast>false</AllowMulticast><Interfaces><NetworkInterface name="lo"/></Interfaces></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers></Discovery></Domain></CycloneDDS>"""

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float64, int32, int8, sequence, uint8, uint16, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


def ros(package, name):
    return f"{package}::msg::dds_::{name}_"


@dataclass
class Time(IdlStruct, typename=ros("builtin_interfaces", "Time")):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct, typename=ros("std_msgs", "Header")):
    stamp: Time
    frame_id: str


@dataclass
class Vector3(IdlStruct, typename=ros("geometry_msgs", "Vector3")):
    x: float64
    y: float64
    z: float64


@dataclass
class Quaternion(IdlStruct, typename=ros("geometry_msgs", "Quaternion")):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
class Imu(IdlStruct, typename=ros("sensor_msgs", "Imu")):
    header: Header
    orientation: Quaternion
    orientation_covariance: array[float64, 9]
    angular_velocity: Vector3
    angular_velocity_covariance: array[float64, 9]
    linear_acceleration: Vector3
    linear_acceleration_covariance: array[float64, 9]


@dataclass
class NavSatStatus(IdlStruct, typename=ros("sensor_msgs", "NavSatStatus")):
    status: int8
    service: uint16


@dataclass
class NavSatFix(IdlStruct, typename=ros("sensor_msgs", "NavSatFix")):
    header: Header
    status: NavSatStatus
    latitude: float64
    longitude: float64
    altitude: float64
    position_covariance: array[float64, 9]
    position_covariance_type: uint8


@dataclass
class Twist(IdlStruct, typename=ros("geometry_msgs", "Twist")):
    linear: Vector3
    angular: Vector3


@dataclass
class TwistWithCovariance(IdlStruct, typename=ros("geometry_msgs", "TwistWithCovariance")):
    twist: Twist
    covariance: array[float64, 36]


@dataclass
class TwistStamped(IdlStruct, typename=ros("geometry_msgs", "TwistWithCovarianceStamped")):
    header: Header
    twist: TwistWithCovariance


@dataclass
class Point(IdlStruct, typename=ros("geometry_msgs", "Point")):
    x: float64
    y: float64
    z: float64


@dataclass
class Pose(IdlStruct, typename=ros("geometry_msgs", "Pose")):
    position: Point
    orientation: Quaternion


@dataclass
class PoseWithCovariance(IdlStruct, typename=ros("geometry_msgs", "PoseWithCovariance")):
    pose: Pose
    covariance: array[float64, 36]


@dataclass
class Odometry(IdlStruct, typename=ros("nav_msgs", "Odometry")):
    header: Header
    child_frame_id: str
    pose: PoseWithCovariance
    twist: TwistWithCovariance


@dataclass
class KeyValue(IdlStruct, typename=ros("diagnostic_msgs", "KeyValue")):
    key: str
    value: str


@dataclass
class DiagnosticStatus(IdlStruct, typename=ros("diagnostic_msgs", "DiagnosticStatus")):
    level: uint8
    name: str
    message: str
    hardware_id: str
    values: sequence[KeyValue]


@dataclass
class DiagnosticArray(IdlStruct, typename=ros("diagnostic_msgs", "DiagnosticArray")):
    header: Header
    status: sequence[DiagnosticStatus]


UNKNOWN = [-1.0] + [0.0] * 8
EPOCH = 1_764_400_000  # The drive's time 0 as Unix time [s].


def header(t, frame):
    ns = round((EPOCH + t) * 1000) * 1_000_000
    return Header(Time(ns // 10**9, ns % 10**9), frame)


def imu(row):
    t, *numbers = map(float, row)
    # A body of forward, right, down in the file; forward, left, up in ROS.
    gx, gy, gz, ax, ay, az = numbers
    nothing = [0.0] * 9
    return Imu(header(t, "imu"), Quaternion(0.0, 0.0, 0.0, 1.0), UNKNOWN, Vector3(gx, -gy, -gz), nothing, Vector3(ax, -ay, -az), nothing)


def fix(row):
    n, e, d = (float(row[name]) ** 2 for name in ("sn_m", "se_m", "sd_m"))
    covariance = [e, 0.0, 0.0, 0.0, n, 0.0, 0.0, 0.0, d]
    place = [float(row[name]) for name in ("lat_deg", "lon_deg", "height_m")]
    return NavSatFix(header(float(row["t_s"]), "gnss"), NavSatStatus(0, 1), *place, covariance, 2)


def velocity(row):
    vn, ve, vd = (float(row[name]) for name in ("vn_mps", "ve_mps", "vd_mps"))
    n, e, d = (float(row[name]) ** 2 for name in ("svn_mps", "sve_mps", "svd_mps"))
    covariance = [0.0] * 36
    covariance[0], covariance[7], covariance[14] = e, n, d
    return TwistStamped(header(float(row["t_s"]), "gnss"), TwistWithCovariance(Twist(Vector3(ve, vn, -vd), Vector3(0.0, 0.0, 0.0)), covariance))


def main():
    logs, domain, begin, end, pace, result = pathlib.Path(sys.argv[1]), int(sys.argv[2]), *map(float, sys.argv[3:6]), sys.argv[6]
    kept = Domain(domain, PEERS)
    participant = DomainParticipant(domain)
    reliable = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(200))
    # As ROS has it for sensors.
    sensor = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(200))
    imu_writer = DataWriter(participant, Topic(participant, "rt/imu/data", Imu), sensor)
    fix_writer = DataWriter(participant, Topic(participant, "rt/fix", NavSatFix), reliable)
    velocity_writer = DataWriter(participant, Topic(participant, "rt/vel", TwistStamped), reliable)
    every = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepAll)
    odometry = DataReader(participant, Topic(participant, "rt/undrift/odom", Odometry), every)
    fixes = DataReader(participant, Topic(participant, "rt/undrift/fix", NavSatFix), every)
    diagnostics = DataReader(participant, Topic(participant, "rt/diagnostics", DiagnosticArray), every)
    parts = []
    with open(logs / "imu.csv") as file:
        rows = csv.reader(file)
        next(rows)
        parts += [(float(row[0]), imu_writer, imu(row)) for row in rows if begin <= float(row[0]) <= end]
    with open(logs / "gnss.csv") as file:
        for row in csv.DictReader(file):
            t = float(row["t_s"])
            if begin <= t <= end:
                parts += [(t + 0.1, fix_writer, fix(row)), (t + 0.1, velocity_writer, velocity(row))]
    parts.sort(key=lambda part: part[0])
    waited = time.monotonic()
    while not (imu_writer.get_matched_subscriptions() and fix_writer.get_matched_subscriptions() and velocity_writer.get_matched_subscriptions()):
        assert time.monotonic() - waited < 60, "no subscriber"
        time.sleep(0.1)
    time.sleep(1)
    found = {"odometry": [], "fix": [], "diagnostics": []}

    def take():
        for message in odometry.take(N=1000):
            pose, twist = message.pose, message.twist
            p, q, v = pose.pose.position, pose.pose.orientation, twist.twist.linear
            found["odometry"].append(
                {
                    "time": message.header.stamp.sec - EPOCH + message.header.stamp.nanosec * 1e-9,
                    "frames": [message.header.frame_id, message.child_frame_id],
                    "position": [p.x, p.y, p.z],
                    "orientation": [q.x, q.y, q.z, q.w],
                    "velocity": [v.x, v.y, v.z],
                    "pose_covariance": list(pose.covariance),
                    "twist_covariance": list(twist.covariance),
                }
            )
        for message in fixes.take(N=1000):
            place = [message.latitude, message.longitude, message.altitude]
            t = message.header.stamp.sec - EPOCH + message.header.stamp.nanosec * 1e-9
            found["fix"].append({"time": t, "place": place, "covariance": list(message.position_covariance)})
        for message in diagnostics.take(N=1000):
            for status in message.status:
                values = {value.key: value.value for value in status.values}
                found["diagnostics"].append({"level": status.level, "name": status.name, "message": status.message, "values": values})

    started = time.monotonic()
    for k, (t, writer, message) in enumerate(parts):
        wait = (t - begin) / pace - (time.monotonic() - started)
        if wait > 0:
            time.sleep(wait)
        writer.write(message)
        if k % 50 == 0:
            take()
    for _ in range(20):
        time.sleep(0.1)
        take()
    pathlib.Path(result).write_text(json.dumps(found))
    del kept


if __name__ == "__main__":
    main()
