"""Writes MATLAB files as scipy writes them, with NaveGo's structures in them, and what they hold to
expected.json. Needs scipy 1.17 and numpy 2.

plain.mat, compressed.mat: the same, as with -v6 and with -v7; columns.mat: the vectors as columns,
numbers stored as small integers, the attitude as matrices; big.mat: plain.mat's samples, big-endian.
"""

import json
import struct
from pathlib import Path

import numpy as np
from scipy.io import savemat
from scipy.spatial.transform import Rotation

HERE = Path(__file__).parent
random = np.random.default_rng(7)
N, M = 40, 8


def column(values):
    return np.asarray(values, float).reshape(-1, 1)


t = 100 + 0.005 * np.arange(N)
imu = {"t": column(t), "fb": random.normal(0, 1, (N, 3)) - [0, 0, 9.8], "wb": random.normal(0, 0.1, (N, 3)),
       "freq": 200.0, "arw": np.full((1, 3), 1e-3), "name": "ADIS16405", "empty": np.zeros((0, 0))}
gt = 100 + 0.2 * np.arange(M)
gnss = {"t": column(gt), "lat": column(-0.573 + 1e-7 * np.arange(M)), "lon": column(-1.2 + 2e-7 * np.arange(M)),
        "h": column(700 + random.normal(0, 3, M)), "vel": random.normal(0, 5, (M, 3)),
        "stdm": np.array([[5, 5, 10]], np.uint8), "stdv": np.full((1, 3), 0.05), "larm": column([0.1, 0.2, -0.3]),
        "freq": 5.0}
rpy = random.uniform(-1.5, 1.5, (N, 3))
ref = {"t": column(t), "lat": column(-0.573 + 1e-9 * np.arange(N)), "lon": column(-1.2 + 2e-9 * np.arange(N)),
       "h": column(700 + 0.01 * np.arange(N)), "vel": random.normal(0, 5, (N, 3)), "roll": column(rpy[:, 0]),
       "pitch": column(rpy[:, 1]), "yaw": column(rpy[:, 2])}

# The other way round: columns, small numbers, a standard deviation for each fix, one unusable number.
gnss2 = {k: v.T.copy() if getattr(v, "ndim", 0) == 2 else v for k, v in gnss.items()}
gnss2["t"] = np.arange(M, dtype=np.uint8).reshape(1, -1)
gnss2["vel"] = np.round(gnss2["vel"]).astype(np.int16)
gnss2["stdm"] = np.arange(3 * M, dtype=np.single).reshape(3, M)
gnss2["lat"][0, 2] = np.nan
del gnss2["stdv"]
imu2 = {"t": imu["t"].T, "fb": imu["fb"].T.astype(np.single), "wb": imu["wb"].T}
imu2["wb"] = imu2["wb"].copy()
imu2["wb"][1, 4] = np.inf
body_to_navigation = Rotation.from_euler("ZYX", rpy[:, ::-1]).as_matrix()
ref2 = {k: v for k, v in ref.items() if k not in ("roll", "pitch", "yaw", "vel")}
# Each row: the matrix from navigation to body axes, column by column.
ref2["DCMnb_m"] = body_to_navigation.reshape(N, 9)


def big_endian(path, name, fields):
    """A structure of doubles, big-endian, by hand: scipy writes little-endian only."""
    def element(kind, content):
        return struct.pack(">II", kind, len(content)) + content + bytes(-len(content) % 8)

    def matrix(array_class, shape, name, rest):
        flags = element(6, struct.pack(">II", array_class, 0))
        return element(14, flags + element(5, struct.pack(">2i", *shape)) + element(1, name.encode()) + rest)

    width = 8
    rest = element(5, struct.pack(">i", width)) + element(1, b"".join(k.encode().ljust(width, b"\0") for k in fields))
    for value in fields.values():
        rest += matrix(6, value.shape, "", element(9, value.astype(">f8").tobytes(order="F")))
    header = b"MATLAB 5.0 MAT-file, big-endian".ljust(124) + b"\x01\x00MI"
    path.write_bytes(header + matrix(2, (1, 1), name, rest))


if __name__ == "__main__":
    variables = {"imu": imu, "gnss": gnss, "ref": ref, "note": "text", "cells": np.array([[1, "a"]], object),
                 "velocity": {"t": gnss["t"], "vel": gnss["vel"]}, "table": np.eye(3), "several": np.array(
                     [(1, 2), (3, 4)], [("a", "O"), ("b", "O")])}
    savemat(HERE / "plain.mat", variables, do_compression=False)
    savemat(HERE / "compressed.mat", variables, do_compression=True)
    savemat(HERE / "columns.mat", {"my_imu": imu2, "gnss1": gnss2, "gnss2": gnss, "ref": ref2}, do_compression=True)
    big_endian(HERE / "big.mat", "imu", {k: imu[k] for k in ("t", "fb", "wb")})

    from scipy.io import loadmat
    assert np.array_equal(loadmat(HERE / "big.mat")["imu"]["wb"][0, 0], imu["wb"])

    def rows(*parts):
        return np.hstack(parts).astype(float).tolist()

    expected = {
        "imu": rows(imu["t"], imu["wb"], imu["fb"]),
        "gnss": rows(gnss["t"], gnss["lat"], gnss["lon"], gnss["h"], gnss["vel"]),
        "ref": rows(ref["t"], ref["lat"], ref["lon"], ref["h"], ref["vel"], rpy),
        "my_imu": [row for k, row in enumerate(rows(imu2["t"].T, imu2["wb"].T, imu2["fb"].T)) if k != 4],
        "gnss1": [row for k, row in enumerate(rows(gnss2["t"].T, gnss2["lat"].T, gnss2["lon"].T, gnss2["h"].T,
                                                   gnss2["vel"].T, gnss2["stdm"].T)) if k != 2],
    }
    text = json.dumps(expected, separators=(",", ":")).replace("],[", "],\n[")
    (HERE / "expected.json").write_text(text + "\n")
