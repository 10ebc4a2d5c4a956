"""Solutions written as MCAP, read by packages that have nothing of ours: ``mcap``, ``mcap-ros2-support``, ``rosbags``."""

from __future__ import annotations

import io
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import zstandard
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


@dataclass
class Row:
    """The solution at a sample: radians, metres, north-east-down."""

    stamp: int
    place: Floats
    velocity: Floats
    rpy: Floats
    position_std: Floats
    velocity_std: Floats
    rpy_std: Floats


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Row]]:
    """A solution as MCAP, and its rows."""
    folder = tmp_path_factory.mktemp("mcap")
    drive = undrift.simulate("car", 150.0, 50.0, seed=4).save(folder)
    epoch = 'epoch = "2025-07-08T19:34:00Z"\n'
    drive.write_text(epoch + drive.read_text(encoding="utf-8"), encoding="utf-8")
    table, file = folder / "nav.csv", folder / "nav.mcap"
    done = undrift.navigate(drive, output=[table, file])
    # Only the table has the standard deviations of roll, pitch and yaw.
    names = ("roll_std_deg", "pitch_std_deg", "yaw_std_deg")
    columns = np.genfromtxt(table, delimiter=",", names=True)
    return file, [
        Row(
            EPOCH * 10**9 + round(float(done.time[k]) * 1e9),
            np.array([done.lat[k], done.lon[k], done.height[k]]),
            done.velocity[k],
            done.rpy[k],
            done.position_std[k],
            done.velocity_std[k],
            np.radians([columns[name][k] for name in names]),
        )
        for k in range(len(done))
    ]


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


def close(found: Any, expected: Any, tolerance: float) -> None:
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance)


def check(topic: str, message: Any, row: Row, first: Row) -> None:
    """A message against its row: to some roundings of its numbers."""
    c, tilts = attitude(row.rpy), attitude_covariance(row.rpy, row.rpy_std)
    # The table has 6 decimals of a degree, 1e-8 rad, and a variance twice its deviation times that.
    tilts_off = 4.0 * row.rpy_std.max() * 1e-8
    assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == row.stamp
    if topic == "/undrift/fix":
        assert message.header.frame_id == "base_link"
        close([message.latitude, message.longitude], np.degrees(row.place[:2]), 1e-12)
        assert message.altitude == row.place[2]
        assert (message.status.status, message.position_covariance_type) == (0, 2)
        close(np.reshape(message.position_covariance, (3, 3)), TURN @ np.diag(row.position_std**2) @ TURN, 1e-15)
    elif topic == "/undrift/imu":
        assert message.header.frame_id == "base_link"
        close(rotation(message.orientation), TURN @ c @ FLIP, 1e-14)
        covariance = np.reshape(message.orientation_covariance, (3, 3))
        close(covariance, TURN @ tilts @ TURN, tilts_off)
        assert message.angular_velocity_covariance[0] == -1
        assert message.linear_acceleration_covariance[0] == -1
    else:
        assert (message.header.frame_id, message.child_frame_id) == ("map", "base_link")
        axes, here = enu_axes(*first.place[:2]), enu_axes(*row.place[:2])
        position, turn = message.pose.pose.position, axes @ here.T
        # The radius of the Earth is a number of 2^23 m with 53 bits.
        moved = axes @ (ecef(*row.place) - ecef(*first.place))
        close([position.x, position.y, position.z], moved, 1e-8)
        close(rotation(message.pose.pose.orientation), turn @ TURN @ c @ FLIP, 1e-14)
        covariance = np.reshape(message.pose.covariance, (6, 6))
        position_covariance = TURN @ np.diag(row.position_std**2) @ TURN
        close(covariance[:3, :3], turn @ position_covariance @ turn.T, 1e-13)
        close(covariance[3:, 3:], turn @ TURN @ tilts @ TURN @ turn.T, tilts_off)
        close(covariance[:3, 3:], 0, 0)
        twist = message.twist.twist
        close([twist.linear.x, twist.linear.y, twist.linear.z], FLIP @ c.T @ row.velocity, 1e-13)
        covariance = np.reshape(message.twist.covariance, (6, 6))
        close(covariance[:3, :3], FLIP @ c.T @ np.diag(row.velocity_std**2) @ c @ FLIP, 1e-13)


def test_messages_are_the_rows(written: tuple[Path, list[Row]]) -> None:
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
            assert record.log_time == record.publish_time == row.stamp
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


def test_the_summary_leads_to_every_message(written: tuple[Path, list[Row]]) -> None:
    file, rows = written
    with file.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None and summary.statistics is not None
        assert (len(summary.channels), len(summary.schemas)) == (3, 3)
        statistics = summary.statistics
        assert list(statistics.channel_message_counts.values()) == [len(rows)] * 3
        assert statistics.message_count == 3 * len(rows)
        assert statistics.message_start_time == rows[0].stamp
        assert statistics.message_end_time == rows[-1].stamp
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
