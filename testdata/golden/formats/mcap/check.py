"""Reads an MCAP file of tools/lab/src/bin/solution_mcap.rs by two independent packages and compares it with its inputs.

    pip install rosbags==0.11.9 mcap==1.6.0 mcap-ros2-support==0.6.0 numpy
    cargo run -p undrift-lab --bin solution_mcap -- /tmp/solution.mcap && python check.py /tmp/solution.mcap
"""

import sys

import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)
TURN = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])  # east-north-up of north-east-down
FLIP = np.diag([1, -1, -1])  # forward-left-up of forward-right-down


def ecef(lat, lon, h):
    a, e2 = 6378137.0, 6.69437999014e-3
    n = a / np.sqrt(1 - e2 * np.sin(lat) ** 2)
    return np.array([(n + h) * np.cos(lat) * np.cos(lon), (n + h) * np.cos(lat) * np.sin(lon), ((1 - e2) * n + h) * np.sin(lat)])


def enu_axes(lat, lon):
    """Rows: east, north, up."""
    sl, cl, so, co = np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon)
    return np.array([[-so, co, 0], [-sl * co, -sl * so, cl], [cl * co, cl * so, sl]])


def about(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    return {
        "x": np.array([[1, 0, 0], [0, c, -s], [0, s, c]]),
        "y": np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]),
        "z": np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]),
    }[axis]


def matrix(q):
    x, y, z, w = q.x, q.y, q.z, q.w
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])


def attitude(rpy):
    return about("z", rpy[2]) @ about("y", rpy[1]) @ about("x", rpy[0])


def close(found, expected, tolerance):
    assert np.allclose(found, expected, rtol=0, atol=tolerance), (found, expected)


def row(k):
    return {
        "stamp": 1752003240_250000000 + k * 500000000,
        "place": np.array([np.radians(48 + 0.25 * k), np.radians(11.5 - 0.5 * k), 560.25 + k]),
        "v": np.array([3.0, 4.0 * k, 0.5]),
        "rpy": np.array([0.1, -0.2 * k, 2.5 + k]),
    }


def attitude_covariance(rpy):
    """By differences of the attitude: how small changes of roll, pitch and yaw turn it, about north, east, down."""
    c = attitude(rpy)
    columns = []
    for i in range(3):
        step = np.zeros(3)
        step[i] = 1e-5
        turn = (attitude(rpy + step) - attitude(rpy - step)) @ c.T / 2e-5
        columns.append([turn[2, 1], turn[0, 2], turn[1, 0]])
    j = np.array(columns).T
    return j @ np.diag([0.01**2, 0.02**2, 0.03**2]) @ j.T


def check(topic, message, k):
    r = row(k)
    stamp = message.header.stamp
    assert stamp.sec * 10**9 + stamp.nanosec == r["stamp"]
    c = attitude(r["rpy"])
    if topic == "/undrift/fix":
        assert message.header.frame_id == "base_link"
        close([message.latitude, message.longitude], np.degrees(r["place"][:2]), 1e-12)
        assert message.altitude == r["place"][2]
        assert (message.status.status, message.position_covariance_type) == (0, 2)
        close(message.position_covariance, np.diag([4.0, 1, 9]).ravel(), 0)
    elif topic == "/undrift/imu":
        assert message.header.frame_id == "base_link"
        close(matrix(message.orientation), TURN @ c @ FLIP, 1e-14)
        # Differences over 1e-5 are good to 1e-10 of the variances of 1e-3.
        close(np.reshape(message.orientation_covariance, (3, 3)), TURN @ attitude_covariance(r["rpy"]) @ TURN, 1e-12)
        assert message.angular_velocity_covariance[0] == -1 and message.linear_acceleration_covariance[0] == -1
    else:
        assert (message.header.frame_id, message.child_frame_id) == ("map", "base_link")
        origin = row(0)["place"]
        axes, here = enu_axes(*origin[:2]), enu_axes(*r["place"][:2])
        position = message.pose.pose.position
        # The radius of the Earth is a number of 2^23 m with 53 bits.
        close([position.x, position.y, position.z], axes @ (ecef(*r["place"]) - ecef(*origin)), 1e-8)
        turn = axes @ here.T
        close(matrix(message.pose.pose.orientation), turn @ TURN @ c @ FLIP, 1e-14)
        covariance = np.reshape(message.pose.covariance, (6, 6))
        close(covariance[:3, :3], turn @ np.diag([4.0, 1, 9]) @ turn.T, 1e-13)
        close(covariance[3:, 3:], turn @ TURN @ attitude_covariance(r["rpy"]) @ TURN @ turn.T, 1e-12)
        close(covariance[:3, 3:], 0, 0)
        twist = message.twist.twist
        close([twist.linear.x, twist.linear.y, twist.linear.z], FLIP @ c.T @ r["v"], 1e-13)
        covariance = np.reshape(message.twist.covariance, (6, 6))
        close(covariance[:3, :3], FLIP @ c.T @ np.diag([0.1**2, 0.2**2, 0.3**2]) @ c @ FLIP, 1e-14)


counts = {}
with open(sys.argv[1], "rb") as file:
    reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
    assert reader.get_header().profile == "ros2"
    for schema, channel, record, decoded in reader.iter_decoded_messages():
        k = counts.get(channel.topic, 0)
        counts[channel.topic] = k + 1
        assert schema.encoding == "ros2msg" and channel.message_encoding == "cdr"
        assert record.log_time == row(k)["stamp"]
        # The definitions are those of ROS 2 itself.
        found = get_types_from_msg(schema.data.decode(), schema.name)
        for name, (_, fields) in found.items():
            assert fields == STORE.fielddefs[name][1], name
        check(channel.topic, decoded, k)
        check(channel.topic, STORE.deserialize_cdr(record.data, schema.name), k)
assert counts == {"/undrift/fix": 3, "/undrift/odom": 3, "/undrift/imu": 3}, counts
print("all as written")
