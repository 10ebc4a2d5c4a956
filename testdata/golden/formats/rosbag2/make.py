"""Makes the bags of this folder, which hold the recording of ../rosbag/recording.py, by rosbags (0.11.9): it writes
SQLite databases by Python's sqlite3, and MCAP. Zstandard of whole files by zstandard (0.25.0).

    pip install rosbags==0.11.9 zstandard==0.25.0 && python make.py

plain.db3: one file; file.db3.zstd: compressed as a whole; messages.db3: each message compressed.
small-pages.db3: pages of 512 bytes, so that messages go over several and the trees have inner pages; with other tables,
and rows deleted. tiny.db3: the same of the first messages, small enough for arbitrary bytes to reach all of it. no-messages.db3: topics alone. unwritten/: a recorder that was killed with all in its log of changes.
split/ and split-mcap/: folders of three files each, one whose list is in another order than the names of the files.
"""

import shutil
import sqlite3
import sys
from pathlib import Path

import zstandard

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "rosbag"))

from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer
from rosbags.typesys import Stores, get_typestore

from recording import build, recording

STORE = get_typestore(Stores.ROS2_HUMBLE)


def write(folder, messages, storage, compression=None):
    """A bag as the library writes it: its only file with messages."""
    shutil.rmtree(folder, ignore_errors=True)
    bag = Writer(folder, version=9, storage_plugin=storage)
    if compression:
        bag.set_compression(compression, CompressionFormat.ZSTD)
    topics = {}
    with bag:
        for topic, kind, time, fields in messages:
            if topic not in topics:
                topics[topic] = bag.add_connection(topic, kind, typestore=STORE)
            bag.write(topics[topic], time, STORE.serialize_cdr(build(STORE, kind, fields), kind))
    return next(path for path in folder.iterdir() if path.suffix != ".yaml")


def single(name, messages, compression=None):
    folder = HERE / "bag"
    shutil.move(write(folder, messages, StoragePlugin.SQLITE3, compression), HERE / name)
    shutil.rmtree(folder)


def small_pages(source, name, most=-1):
    (HERE / name).unlink(missing_ok=True)
    old, new = sqlite3.connect(HERE / source), sqlite3.connect(HERE / name)
    new.execute("PRAGMA page_size = 512")
    new.execute("CREATE TABLE \"other, and more\" (a TEXT DEFAULT ('x, y'), b DECIMAL(4, 2))")
    # Columns in another order than usual, the data not last.
    new.execute("CREATE TABLE topics(offered_qos_profiles TEXT, id INTEGER PRIMARY KEY, type TEXT, \"name\" TEXT NOT NULL, serialization_format TEXT)")
    new.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, data BLOB NOT NULL, timestamp INTEGER NOT NULL)")
    new.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
    topics = old.execute("SELECT offered_qos_profiles, id + 5000000000, type, name, serialization_format FROM topics").fetchall()
    new.executemany("INSERT INTO topics VALUES (?, ?, ?, ?, ?)", topics)
    rows = old.execute("SELECT id, topic_id + 5000000000, data, timestamp FROM messages ORDER BY id LIMIT ?", (most,)).fetchall()
    new.executemany("INSERT INTO messages VALUES (?, ?, ?, ?)", [(-1000 + 70000 * id, *rest) for id, *rest in rows])
    junk = [(-1000 + 70000 * id + 1, rows[0][1], bytes(2000), 0) for id in range(5, 25 if most < 0 else 6)]
    new.executemany("INSERT INTO messages VALUES (?, ?, ?, ?)", junk)
    new.commit()
    new.executemany("DELETE FROM messages WHERE id = ?", [row[:1] for row in junk])
    new.commit()
    assert new.execute("PRAGMA page_size").fetchone() == (512,)
    new.close()


def without_messages(source, name):
    shutil.copy(HERE / source, HERE / name)
    bag = sqlite3.connect(HERE / name)
    bag.execute("DELETE FROM messages")
    bag.commit()
    bag.close()


def unwritten(source, folder):
    """What is on the disk while a recorder with a log of changes runs."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    without_messages(source, "running.db3")
    running = HERE / "running.db3"
    bag = sqlite3.connect(running)
    bag.execute("PRAGMA journal_mode = WAL")
    bag.execute("PRAGMA wal_autocheckpoint = 0")
    old = sqlite3.connect(HERE / source)
    bag.executemany("INSERT INTO messages VALUES (?, ?, ?, ?)", old.execute("SELECT id, topic_id, timestamp, data FROM messages").fetchall())
    bag.commit()
    for name in ["running.db3", "running.db3-wal"]:
        shutil.copy(HERE / name, folder / name)
    bag.close()
    running.unlink()


def split(folder, messages, storage, suffix, names, listed):
    shutil.rmtree(folder, ignore_errors=True)
    parts = [messages[:20], messages[20:21], messages[21:]]
    kept = HERE / "kept"
    kept.mkdir(exist_ok=True)
    for name, part in zip(names, parts):
        shutil.move(write(folder, part, storage), kept / (name + suffix))
    text = (folder / "metadata.yaml").read_text().splitlines()
    shutil.rmtree(folder)
    kept.rename(folder)
    if listed:
        # As rosbag2 lists them; the library writes one file only.
        at = next(i for i, line in enumerate(text) if "relative_file_paths" in line)
        indent = text[at + 1].split("-")[0]
        text[at + 1 : at + 2] = [f"{indent}- {name}{suffix}" for name in names]
        (folder / "metadata.yaml").write_text("\n".join(text) + "\n")


messages, _ = recording()
single("plain.db3", messages)
single("messages.db3", messages, CompressionMode.MESSAGE)
(HERE / "file.db3.zstd").write_bytes(zstandard.compress((HERE / "plain.db3").read_bytes()))
small_pages("plain.db3", "small-pages.db3")
small_pages("plain.db3", "tiny.db3", 7)
without_messages("plain.db3", "no-messages.db3")
unwritten("plain.db3", HERE / "unwritten")
split(HERE / "split", messages, StoragePlugin.SQLITE3, ".db3", ["bag_b", "bag_c", "bag_a"], True)
split(HERE / "split-mcap", messages, StoragePlugin.MCAP, ".mcap", ["bag_9", "bag_10", "bag_11"], False)
