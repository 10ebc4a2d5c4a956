"""Makes transforms.bag and ../mcap/transforms.mcap by the Python package rosbags (0.11.9), which has its own writers: /tf with two
transforms in each message, odom to base_link and map to odom, and /tf_static with one.

    pip install rosbags==0.11.9 && python transforms.py

Of the k-th message odom to base_link is at (k + 0.5, -0.25 k, 1) with the quaternion x, y, z, w = 0, 0.6, 0, 0.8, at 0.1 k s behind the
start of the recording; map to odom is at (10, 20, 30) without a turn, and 0.05 s later.
"""

import shutil
from pathlib import Path

from rosbags.rosbag1 import Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Bag2Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from recording import START, build, header, vector

HERE = Path(__file__).parent
ROS1 = get_typestore(Stores.ROS1_NOETIC)
ROS2 = get_typestore(Stores.ROS2_HUMBLE)
KIND = "tf2_msgs/msg/TFMessage"
for store in [ROS1, ROS2]:
    store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", KIND))


def transform(stamp, frame, child, place, xyzw):
    return {"header": header(stamp, frame), "child_frame_id": child,
            "transform": {"translation": vector(*place), "rotation": dict(zip("xyzw", xyzw))}}


def recording():
    fixed = transform(START, "base_link", "imu_link", [0.0, 0.0, 0.5], [0.0, 0.0, 0.0, 1.0])
    messages = [("/tf_static", START, [fixed])]
    for k in range(6):
        stamp = START + k * 100_000_000
        moving = transform(stamp, "odom", "base_link", [k + 0.5, -0.25 * k, 1.0], [0.0, 0.6, 0.0, 0.8])
        other = transform(stamp + 50_000_000, "map", "odom", [10.0, 20.0, 30.0], [0.0, 0.0, 0.0, 1.0])
        messages.append(("/tf", stamp, [moving, other]))
    return messages


def message(store, transforms):
    each = [build(store, "geometry_msgs/msg/TransformStamped", fields) for fields in transforms]
    return store.types[KIND](transforms=each)


bag = HERE / "transforms.bag"
bag.unlink(missing_ok=True)
with Writer(bag) as writer:
    topics = {topic: writer.add_connection(topic, KIND, typestore=ROS1) for topic in ["/tf", "/tf_static"]}
    for topic, time, transforms in recording():
        writer.write(topics[topic], time, ROS1.serialize_ros1(message(ROS1, transforms), KIND))
folder = HERE / "bag"
shutil.rmtree(folder, ignore_errors=True)
with Bag2Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
    topics = {topic: writer.add_connection(topic, KIND, typestore=ROS2) for topic in ["/tf", "/tf_static"]}
    for topic, time, transforms in recording():
        writer.write(topics[topic], time, ROS2.serialize_cdr(message(ROS2, transforms), KIND))
shutil.move(next(folder.glob("*.mcap")), HERE.parent / "mcap" / "transforms.mcap")
shutil.rmtree(folder)
