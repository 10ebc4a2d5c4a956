"""What the adapters in Python share: the arrays of `exchange.py`, the answers of a filter."""

import json
import sys
from pathlib import Path

import numpy as np


class Exchange:
    """A pass of a drive: samples from the start on, fixes, start, model, times at which an answer is wanted."""

    def __init__(self, folder, number, model):
        self.folder = Path(folder)
        self.about = json.loads((self.folder / "drive.json").read_text())
        self.start, self.wanted = self.read("start", 0), self.read(f"wanted{number}", 0)
        self.imu, self.gnss = self.read("imu", 7), self.read(f"pass{number}", 13)
        self.imu = self.imu[self.imu[:, 0] > self.start[0] - 0.5 / self.about["rate_hz"]]
        self.gnss = self.gnss[self.gnss[:, 0] > self.start[0]]
        numbers = self.read(f"model-{model}", 0)
        # White noise, random walk, turn-on of gyros and of accelerometers; standard deviations of fixes and of roll, pitch, yaw.
        self.gyro, self.accel, self.attitude_std = numbers[:3], numbers[3:6], numbers[8:11]
        self.position_std, self.velocity_std = numbers[6:8]

    def read(self, name, columns):
        values = np.fromfile(self.folder / f"{name}.f64", dtype="<f8")
        return values.reshape(-1, columns) if columns else values


def arguments():
    """The pass that the command line asks for, its options and where the answers go."""
    folder, number, model, out, *options = sys.argv[1:]
    return Exchange(folder, number, model), options, out


def write(out, rows):
    """Rows of time, latitude, longitude [rad], height, velocity, standard deviations north, east, down, yaw."""
    np.asarray(rows, dtype="<f8").reshape(-1, 11).tofile(out)
