"""Makes poses.bag, ../mcap/poses.mcap and poses.json by the Python package rosbags (0.11.9), which has its own writers: poses of the
four types that a reader knows, beside inertial samples.

    pip install rosbags==0.11.9 && python poses.py

The expected poses are the inputs by topic: time [s of the GPS week that the first stamp of a topic is in], position,
quaternion x, y, z, w (null without one), covariances of position and rotation (null where not stated). The stamps of
/vicon are those of a computer whose clock is a week behind.
"""

import json
import shutil
from pathlib import Path

from rosbags.rosbag1 import Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Bag2Writer
from rosbags.typesys import Stores, get_typestore

from recording import SECOND, START, WEEK, build, gps, header, imu, twist, vector

HERE = Path(__file__).parent
ROS1 = get_typestore(Stores.ROS1_NOETIC)
ROS2 = get_typestore(Stores.ROS2_HUMBLE)
# A quaternion of length 1 in binary, but for the rounding of 0.6 and 0.8.
TURNED = [0.0, 0.6, 0.0, 0.8]
# Symmetric, its blocks of position and rotation are positive definite; the numbers between them are not looked at.
FULL = [[4.0, 0.5, -0.25, 0.1, 0.2, 0.3], [0.5, 9.0, 0.75, 0.4, 0.5, 0.6], [-0.25, 0.75, 16.0, 0.7, 0.8, 0.9],
        [0.1, 0.4, 0.7, 0.25, 0.0625, 0.0], [0.2, 0.5, 0.8, 0.0625, 0.5, 0.125], [0.3, 0.6, 0.9, 0.0, 0.125, 0.75]]


def quaternion(xyzw):
    return dict(zip("xyzw", xyzw))


def block(first):
    return [FULL[first + i][first + j] for i in range(3) for j in range(3)]


def recording():
    messages, expected = [], {"/slam": [], "/amcl": [], "/odom": [], "/vicon": []}
    number = 0

    def add(topic, kind, time, fields, pose=None):
        nonlocal number
        number += 1
        messages.append((topic, kind, time, fields))
        if pose:
            expected[topic].append({"at": number, **pose})

    def pose(time, position, attitude, covariance=None, rotation=None):
        return {"time": time, "position": position, "attitude": attitude, "position_covariance": covariance,
                "attitude_covariance": rotation}

    for k in range(6):
        stamp = START + k * 100_000_000
        recorded = stamp + 3_000_000
        position = [k + 0.5, -0.25 * k, 1.0]
        # The fourth is of another body; the fifth was lost.
        child, lost = "box" if k != 3 else "wand", k == 4
        other = START - WEEK * SECOND + k * 10_000_000
        turned = [0.0] * 4 if lost else TURNED
        there = [0.0] * 3 if lost else position
        fields = {"header": header(other, "world"), "child_frame_id": child,
                  "transform": {"translation": vector(*there), "rotation": quaternion(turned)}}
        add("/vicon", "geometry_msgs/msg/TransformStamped", recorded, fields,
            None if child != "box" else pose(gps(other) + WEEK, there, None if lost else turned))
        add("/imu/data", "sensor_msgs/msg/Imu", recorded, imu(stamp, k)[0])
        # The second is of half the length, the third has no attitude, the sixth no place.
        turned = {1: [x / 2 for x in TURNED], 2: [0.0] * 4}.get(k, TURNED)
        there = [float("nan"), 0.0, 0.0] if k == 5 else position
        fields = {"header": header(stamp, "map"), "pose": {"position": vector(*there), "orientation": quaternion(turned)}}
        add("/slam", "geometry_msgs/msg/PoseStamped", recorded, fields,
            None if k in (1, 5) else pose(gps(stamp), there, None if k == 2 else turned))
        # Stated, zeros, -1 in front, not a number, of the position alone, negative.
        flat = [x for row in FULL for x in row]
        alone = [x if i // 6 < 3 and i % 6 < 3 else 0.0 for i, x in enumerate(flat)]
        covariance = [flat, [0.0] * 36, [-1.0] + [0.0] * 35, [float("nan")] * 36, alone, [-x for x in flat]][k]
        posed = {"pose": {"position": vector(*position), "orientation": quaternion(TURNED)}, "covariance": covariance}
        add("/amcl", "geometry_msgs/msg/PoseWithCovarianceStamped", recorded, {"header": header(stamp, "map"), "pose": posed},
            pose(gps(stamp), position, TURNED, block(0) if k in (0, 4) else None, block(3) if k == 0 else None))
        posed = {"pose": {"position": vector(*position), "orientation": quaternion(TURNED)}, "covariance": flat}
        fields = {"header": header(stamp, "odom"), "child_frame_id": "base_link", "pose": posed,
                  "twist": {"twist": twist([3.0, 0.0, 0.0]), "covariance": [0.0] * 36}}
        add("/odom", "nav_msgs/msg/Odometry", recorded, fields, pose(gps(stamp), position, TURNED, block(0), block(3)))
    return messages, expected


messages, expected = recording()
bag = HERE / "poses.bag"
bag.unlink(missing_ok=True)
with Writer(bag) as writer:
    topics = {}
    for topic, kind, time, fields in messages:
        if topic not in topics:
            topics[topic] = writer.add_connection(topic, kind, typestore=ROS1)
        writer.write(topics[topic], time, ROS1.serialize_ros1(build(ROS1, kind, fields), kind))
folder = HERE / "bag"
shutil.rmtree(folder, ignore_errors=True)
with Bag2Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
    topics = {}
    for topic, kind, time, fields in messages:
        if topic not in topics:
            topics[topic] = writer.add_connection(topic, kind, typestore=ROS2)
        writer.write(topics[topic], time, ROS2.serialize_cdr(build(ROS2, kind, fields), kind))
shutil.move(next(folder.glob("*.mcap")), HERE.parent / "mcap" / "poses.mcap")
shutil.rmtree(folder)
text = json.dumps(expected, separators=(",", ":"))
(HERE / "poses.json").write_text(text.replace("},{", "},\n{") + "\n")
