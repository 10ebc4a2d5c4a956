"""Makes the bags of this folder and expected.json by the Python package rosbags (0.11.9), which has its own writer.

    pip install rosbags==0.11.9 && python make.py
"""

import json
from pathlib import Path

from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

from recording import build, recording, two_imus

HERE = Path(__file__).parent
STORE = get_typestore(Stores.ROS1_NOETIC)


def write(name, messages, compression, chunk):
    path = HERE / name
    path.unlink(missing_ok=True)
    bag = Writer(path)
    if compression:
        bag.set_compression(compression)
    bag.chunk_threshold = chunk
    topics = {}
    with bag:
        for topic, kind, time, fields in messages:
            if topic not in topics:
                topics[topic] = bag.add_connection(topic, kind, typestore=STORE)
            data = STORE.serialize_ros1(build(STORE, kind, fields), kind)
            bag.write(topics[topic], time, data)


messages, expected = recording()
write("none.bag", messages, None, 8000)
write("bz2.bag", messages, Writer.CompressionFormat.BZ2, 8000)
write("lz4.bag", messages, Writer.CompressionFormat.LZ4, 8000)
write("two-imus.bag", two_imus(), None, 1000)
(HERE / "expected.json").write_text(json.dumps(expected, indent=1) + "\n")
