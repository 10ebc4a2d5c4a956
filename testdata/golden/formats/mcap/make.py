"""Makes the MCAP files of this folder, which hold the recording of ../rosbag/recording.py, by independent writers:
rosbags (0.11.9), as rosbag2 stores it, mcap (1.6.0) and mcap-ros2-support (0.6.0).

    pip install rosbags==0.11.9 mcap==1.6.0 mcap-ros2-support==0.6.0 && python make.py
"""

import shutil
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "rosbag"))

from mcap.writer import CompressionType, IndexType
from mcap.writer import Writer as McapWriter
from mcap_ros2.writer import Writer as Ros2Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Bag2Writer
from rosbags.typesys import Stores, get_typestore

from recording import build, recording, two_imus

ROS1 = get_typestore(Stores.ROS1_NOETIC)
ROS2 = get_typestore(Stores.ROS2_HUMBLE)


def stamped(fields):
    """Fields as mcap-ros2-support takes them."""
    plain = {}
    for name, value in fields.items():
        if name == "stamp":
            value = {"sec": value[0], "nanosec": value[1]}
        elif isinstance(value, dict):
            value = stamped(value)
        plain[name] = value
    return plain


def by_ros2_support(name, messages, compression):
    with open(HERE / name, "wb") as file:
        writer = Ros2Writer(file, chunk_size=3000, compression=compression)
        schemas = {}
        for topic, kind, time, fields in messages:
            if kind not in schemas:
                schemas[kind] = writer.register_msgdef(kind, ROS2.generate_msgdef(kind, ros_version=2)[0])
            writer.write_message(topic, schemas[kind], stamped(fields), log_time=time)
        writer.finish()


def by_rosbags(name, messages):
    folder = HERE / "bag"
    shutil.rmtree(folder, ignore_errors=True)
    with Bag2Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as bag:
        topics = {}
        for topic, kind, time, fields in messages:
            if topic not in topics:
                topics[topic] = bag.add_connection(topic, kind, typestore=ROS2)
            data = ROS2.serialize_cdr(build(ROS2, kind, fields), kind)
            bag.write(topics[topic], time, data)
    shutil.move(next(folder.glob("*.mcap")), HERE / name)
    shutil.rmtree(folder)


def by_mcap(name, messages, profile, serialise, msgdef, chunks):
    with open(HERE / name, "wb") as file:
        writer = McapWriter(
            file, use_chunking=chunks, compression=CompressionType.NONE, index_types=IndexType.NONE, enable_data_crcs=True
        )
        writer.start(profile=profile, library="")
        encoding = {"ros1": "ros1msg", "ros2": "ros2msg"}[profile]
        schemas, topics = {}, {}
        for topic, kind, time, fields in messages:
            if kind not in schemas:
                shown = kind.replace("/msg/", "/") if profile == "ros1" else kind
                schemas[kind] = writer.register_schema(shown, encoding, msgdef(kind).encode())
            if topic not in topics:
                topics[topic] = writer.register_channel(topic, "ros1" if profile == "ros1" else "cdr", schemas[kind])
            writer.add_message(topics[topic], time, bytes(serialise(kind, fields)), time)
        writer.finish()


def ros1(kind, fields):
    return ROS1.serialize_ros1(build(ROS1, kind, fields), kind)


def big_endian(kind, fields):
    return ROS2.serialize_cdr(build(ROS2, kind, fields), kind, little_endian=False)


messages, _ = recording()
by_rosbags("rosbag2.mcap", messages)
by_ros2_support("zstd.mcap", messages, CompressionType.ZSTD)
by_ros2_support("lz4.mcap", messages, CompressionType.LZ4)
by_mcap("ros1.mcap", messages, "ros1", ros1, lambda kind: ROS1.generate_msgdef(kind)[0], True)
by_mcap("big-endian.mcap", messages, "ros2", big_endian, lambda kind: ROS2.generate_msgdef(kind, ros_version=2)[0], False)
by_ros2_support("two-imus.mcap", two_imus(), CompressionType.ZSTD)
