"""Solutions written as MCAP, read by packages that have nothing of ours: ``mcap``, ``mcap-ros2-support``, ``rosbags``."""

from __future__ import annotations

import io
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import ChunkIndex, Message, MessageIndex
from mcap_ros2.decoder import DecoderFactory
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

import undrift

Floats = npt.NDArray[np.float64]

STORE = get_typestore(Stores.ROS2_HUMBLE)
#: East-north-up of north-east-down, forward-left-up of forward-right-down.
TURN = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]])
FLIP = np.diag([1.0, -1, -1])
#: Unix time of the drive's zero, 8 July 2025 [s].
EPOCH = 1_752_003_240
#: Rows whose messages are decoded: all of them would take minutes.
EVERY = 97


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Any]:
    """A solution as MCAP, and the rows of the same as CSV."""
    folder = tmp_path_factory.mktemp("mcap")
    drive = undrift.simulate("car", 150.0, 50.0, seed=4).save(folder)
    drive.write_text('epoch = "2025-07-08T19:34:00Z"\n' + drive.read_text(encoding="utf-8"), encoding="utf-8")
    table, file = folder / "nav.csv", folder / "nav.mcap"
    undrift.navigate(drive, output=[table, file])
    return file, np.genfromtxt(table, delimiter=",", names=True)


def stamp(row: Any) -> int:
    return EPOCH * 10**9 + round(float(row["time_s"]) * 1e9)


def of(row: Any, *names: str) -> Floats:
    return np.array([float(row[name]) for name in names])


def place(row: Any) -> Floats:
    """Latitude and longitude [rad], height [m]."""
    lat, lon, height = of(row, "lat_deg", "lon_deg", "height_m")
    return np.array([np.radians(lat), np.radians(lon), height])


def ecef(lat: float, lon: float, height: float) -> Floats:
    a, e2 = 6378137.0, 6.69437999014e-3
    n = a / np.sqrt(1 - e2 * np.sin(lat) ** 2)
    east = (n + height) * np.cos(lat)
    return np.array([east * np.cos(lon), east * np.sin(lon), ((1 - e2) * n + height) * np.sin(lat)])


def enu_axes(lat: float, lon: float) -> Floats:
    """Rows: east, north, up."""
    sl, cl, so, co = np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon)
    return np.array([[-so, co, 0], [-sl * co, -sl * so, cl], [cl * co, cl * so, sl]])


def attitude(rpy: Floats) -> Floats:
    """North-east-down of the body."""
    (sr, sp, sy), (cr, cp, cy) = np.sin(rpy), np.cos(rpy)
    yaw = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    pitch = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    roll = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    found: Floats = yaw @ pitch @ roll
    return found


def attitude_covariance(rpy: Floats, std: Floats) -> Floats:
    """By differences of the attitude: how small changes of roll, pitch and yaw turn it, about north, east, down."""
    columns = []
    for axis in np.eye(3) * 1e-5:
        turn = (attitude(rpy + axis) - attitude(rpy - axis)) @ attitude(rpy).T / 2e-5
        columns.append([turn[2, 1], turn[0, 2], turn[1, 0]])
    found: Floats = np.array(columns).T @ np.diag(std**2) @ np.array(columns)
    return found


def rotation(q: Any) -> Floats:
    x, y, z, w = q.x, q.y, q.z, q.w
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


def close(found: Any, expected: Any, tolerance: float, relative: float = 0.0) -> None:
    np.testing.assert_allclose(found, expected, rtol=relative, atol=tolerance)


def check(topic: str, message: Any, row: Any, first: Any) -> None:
    """A message against its row. The table has 11 decimals of a degree, 4 of a metre and of its standard deviation, 5
    of a metre per second, 6 of a degree of attitude: tolerances are those, a little widened by what is made of them.
    """
    rpy = np.radians(of(row, "roll_deg", "pitch_deg", "yaw_deg"))
    rpy_std = np.radians(of(row, "roll_std_deg", "pitch_std_deg", "yaw_std_deg"))
    position_std = of(row, "north_std_m", "east_std_m", "down_std_m")
    c, tilts = attitude(rpy), attitude_covariance(rpy, rpy_std)
    assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == stamp(row)
    if topic == "/undrift/fix":
        assert message.header.frame_id == "base_link"
        close([message.latitude, message.longitude], of(row, "lat_deg", "lon_deg"), 1e-11)
        close(message.altitude, row["height_m"], 1e-4)
        assert (message.status.status, message.position_covariance_type) == (0, 2)
        covariance = np.reshape(message.position_covariance, (3, 3))
        close(np.sqrt(np.diag(covariance)), position_std[[1, 0, 2]], 1e-4)
        close(covariance - np.diag(np.diag(covariance)), 0, 0)
    elif topic == "/undrift/imu":
        assert message.header.frame_id == "base_link"
        close(rotation(message.orientation), TURN @ c @ FLIP, 1e-7)
        covariance = np.reshape(message.orientation_covariance, (3, 3))
        close(covariance, TURN @ tilts @ TURN, 1e-10, 1e-4)
        assert message.angular_velocity_covariance[0] == -1
        assert message.linear_acceleration_covariance[0] == -1
    else:
        assert (message.header.frame_id, message.child_frame_id) == ("map", "base_link")
        axes, here = enu_axes(*place(first)[:2]), enu_axes(*place(row)[:2])
        position, turn = message.pose.pose.position, axes @ here.T
        moved = axes @ (ecef(*place(row)) - ecef(*place(first)))
        close([position.x, position.y, position.z], moved, 2e-4)
        close(rotation(message.pose.pose.orientation), turn @ TURN @ c @ FLIP, 1e-7)
        covariance = np.reshape(message.pose.covariance, (6, 6))
        close(covariance[:3, :3], turn @ TURN @ np.diag(position_std**2) @ TURN @ turn.T, 1e-4, 1e-3)
        close(covariance[3:, 3:], turn @ TURN @ tilts @ TURN @ turn.T, 1e-10, 1e-4)
        close(covariance[:3, 3:], 0, 0)
        twist = message.twist.twist
        velocity = of(row, "vn_mps", "ve_mps", "vd_mps")
        close([twist.linear.x, twist.linear.y, twist.linear.z], FLIP @ c.T @ velocity, 2e-5)
        std = of(row, "vn_std_mps", "ve_std_mps", "vd_std_mps")
        covariance = np.reshape(message.twist.covariance, (6, 6))
        close(covariance[:3, :3], FLIP @ c.T @ np.diag(std**2) @ c @ FLIP, 1e-5, 1e-4)


def test_messages_are_the_rows(written: tuple[Path, Any]) -> None:
    file, rows = written
    decode = DecoderFactory()
    decoders: dict[str, Any] = {}
    seen: Counter[str] = Counter()
    with file.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        for schema, channel, record in reader.iter_messages(log_time_order=False):
            assert schema is not None
            topic = channel.topic
            row = rows[seen[topic]]
            seen[topic] += 1
            assert record.log_time == record.publish_time == stamp(row)
            if topic not in decoders:
                assert (schema.encoding, channel.message_encoding) == ("ros2msg", "cdr")
                decoders[topic] = decode.decoder_for("cdr", schema)
                # The definitions are those of ROS 2 itself.
                types = get_types_from_msg(schema.data.decode(), schema.name)
                for name, (_, fields) in types.items():
                    assert fields == STORE.fielddefs[name][1], name
            if seen[topic] % EVERY == 1:
                check(topic, decoders[topic](record.data), row, rows[0])
                check(topic, STORE.deserialize_cdr(record.data, schema.name), row, rows[0])
    assert seen == dict.fromkeys(("/undrift/fix", "/undrift/odom", "/undrift/imu"), len(rows))


def places(stream: io.BufferedReader, chunk: ChunkIndex) -> Iterator[tuple[int, int, int]]:
    """Channel, time and place of the messages of a chunk, by the indices after it."""
    for channel, start in chunk.message_index_offsets.items():
        stream.seek(start)
        data = ReadDataStream(stream)
        assert data.read1() == Opcode.MESSAGE_INDEX
        data.read8()
        index = MessageIndex.read(data)
        assert index.channel_id == channel
        yield from ((channel, time, at) for time, at in index.records)


def test_the_summary_leads_to_every_message(written: tuple[Path, Any]) -> None:
    zstandard = pytest.importorskip("zstandard")
    file, rows = written
    with file.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None and summary.statistics is not None
        assert (len(summary.channels), len(summary.schemas)) == (3, 3)
        statistics = summary.statistics
        assert list(statistics.channel_message_counts.values()) == [len(rows)] * 3
        assert statistics.message_count == 3 * len(rows)
        assert statistics.message_start_time == stamp(rows[0])
        assert statistics.message_end_time == stamp(rows[-1])
        assert statistics.chunk_count == len(summary.chunk_indexes) > 3
        found = 0
        for chunk in summary.chunk_indexes:
            assert chunk.compression == "zstd"
            assert chunk.compressed_size < chunk.uncompressed_size / 2
            start = chunk.chunk_start_offset + chunk.chunk_length
            stream.seek(start - chunk.compressed_size)
            packed = stream.read(chunk.compressed_size)
            records = zstandard.decompress(packed, chunk.uncompressed_size)
            times = []
            for channel, time, at in places(stream, chunk):
                assert records[at] == Opcode.MESSAGE
                data = ReadDataStream(io.BytesIO(records[at + 1 :][:64]))
                length = data.read8()
                data = ReadDataStream(io.BytesIO(records[at + 9 :][:length]))
                message = Message.read(data, length)
                assert (message.channel_id, message.log_time) == (channel, time)
                times.append(time)
                found += 1
            assert (min(times), max(times)) == (chunk.message_start_time, chunk.message_end_time)
            assert stream.tell() <= start + chunk.message_index_length
        assert found == 3 * len(rows)
        [about] = reader.iter_metadata()
        assert about.name == "undrift"
        assert "stamps" in about.metadata
