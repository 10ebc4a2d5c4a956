"""undrift: the command on the exchange's CSV with the drive file of the row (`sheet`, `tuned`, `hand`). Options: the command; `smooth`."""

import csv
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

folder, number, model, out, command, *options = sys.argv[1:]
folder = Path(folder)
wanted = np.fromfile(folder / f"wanted{number}.f64", dtype="<f8")
with tempfile.TemporaryDirectory() as work:
    work = Path(work)
    (work / "imu.csv").symlink_to((folder / "imu.csv").resolve())
    (work / "gnss.csv").symlink_to((folder / f"pass{number}.csv").resolve())
    shutil.copy(folder / f"{model}.toml", work / "drive.toml")
    call = [command, "navigate", work / "drive.toml", "-o", work / "nav.csv", "-q"]
    done = subprocess.run(call + (["--smooth"] if "smooth" in options else []), capture_output=True, text=True)
    if not (work / "nav.csv").exists():
        sys.exit(done.stderr.strip())
    with (work / "nav.csv").open() as source:
        names = next(csv.reader(source))
    columns = [names.index(name) for name in "time_s lat_deg lon_deg height_m vn_mps ve_mps vd_mps north_std_m east_std_m down_std_m yaw_deg".split()]
    solution = np.loadtxt(work / "nav.csv", delimiter=",", skiprows=1, usecols=columns)
solution[:, [1, 2, 10]] = np.radians(solution[:, [1, 2, 10]])
at = np.searchsorted(solution[:, 0], wanted).clip(0, len(solution) - 1)
solution[at].astype("<f8").tofile(out)
