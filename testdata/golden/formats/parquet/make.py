"""Writes Parquet files as pyarrow writes them and what they hold to expected.json. Needs pyarrow 26
and numpy 2.

types.parquet: columns of every kind of number, nulls and text, in three row groups; the others:
the same numbers in every compression that is read, and with the second version of data pages.
imu.parquet: an inertial log at 100 Hz, stamps in microseconds, at rest with the z axis up.
"""

import datetime
import decimal
import json
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

HERE = Path(__file__).parent
N = 50
random = np.random.default_rng(9)
k = np.arange(N)

columns = {
    "time": pa.array(100 + 0.25 * k),
    "single": pa.array(random.normal(0, 1, N).astype(np.float32)),
    "small": pa.array((k - 20).astype(np.int8)),
    "integer": pa.array(k.astype(np.int64) * -10**12),
    "unsigned": pa.array((2**32 - 1 - k).astype(np.uint32)),
    "large": pa.array(np.full(N, 2**63 + 2**20, np.uint64)),
    "flag": pa.array(k % 3 == 0),
    "stamp": pa.array([datetime.datetime(2024, 5, 6, 7, 8, 9, 1000 * int(i)) for i in k], pa.timestamp("ms")),
    "price": pa.array([decimal.Decimal(int(i)).scaleb(-2) for i in k], pa.decimal128(9, 2)),
    "holes": pa.array([None if i % 7 == 3 else float(i) for i in k]),
    "nan": pa.array(np.where(k == 11, np.nan, 1.0 * k)),
    "text": pa.array([f"row {i}" for i in k]),
    "list": pa.array([[1.0, 2.0]] * N),
    "imu": pa.array([None if i == 5 else {"gyro": float(i), "none": None} for i in k],
                    pa.struct([("gyro", pa.float64()), ("none", pa.float64())])),
}

if __name__ == "__main__":
    table = pa.table(columns)
    pq.write_table(table, HERE / "types.parquet", row_group_size=20, store_decimal_as_integer=True)
    numbers = table.select(["time", "integer", "holes"])
    for codec in ["none", "snappy", "gzip", "zstd", "lz4"]:
        pq.write_table(numbers, HERE / f"{codec}.parquet", compression=codec, use_dictionary=False)
    pq.write_table(numbers, HERE / "pages2.parquet", data_page_version="2.0", compression="zstd", column_encoding={
        "time": "BYTE_STREAM_SPLIT", "integer": "DELTA_BINARY_PACKED", "holes": "PLAIN"}, use_dictionary=False)
    n = 400
    rest = {"timestamp_us": pa.array(1_000_000 + 10_000 * np.arange(n))}
    for axis, force in zip("xyz", [0.0, 0.0, 9.80665]):
        rest[f"gyro_{axis}"] = pa.array(random.normal(0, 2e-3, n))
        rest[f"accel_{axis}"] = pa.array(random.normal(force, 2e-2, n))
    pq.write_table(pa.table(rest), HERE / "imu.parquet", compression="zstd")
    read = pq.read_table(HERE / "types.parquet")
    expected = {}
    for name in read.column_names:
        values = read[name]
        if name == "stamp":
            values = values.cast(pa.int64())
        if name == "imu":
            name, values = "imu.gyro", pa.array([None if v is None else v["gyro"] for v in values.to_pylist()])
        if name not in ("text", "list"):
            expected[name] = [None if v is None or v != v else float(v) for v in values.to_pylist()]
    (HERE / "expected.json").write_text(json.dumps(expected, separators=(",", ":")).replace("],", "],\n") + "\n")
