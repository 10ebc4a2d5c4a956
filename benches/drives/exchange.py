"""Writes a drive as plain arrays that every filter reads: `exchange.py UNDRIFT DATA FOLDER [DRIVE ...]`.

FOLDER/DRIVE has, as little-endian float64 in rows: imu (time, rates, specific force), gnss and pass0..2 (time, latitude, longitude [rad],
height, velocity, standard deviations of position and velocity; NaN where unknown; a pass lacks the fixes of its windows), wanted0..2
(times at which an answer is wanted: a withheld fix a second), reference0..2 (a row of gnss for each), start (time, position, velocity,
roll, pitch, yaw), model-sheet, model-rest, model-hand (six densities in SI, standard deviations of fixes, of the start's attitude); the same as CSV for
undrift with its drive files; and drive.json.
"""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
from catalogue import DEGREE, DRIVES, SHEETS, hand, sheet, turned

LONG, SHORT = (60.0, 90.0, (0.0, 30.0, 60.0)), (30.0, 45.0, (0.0, 15.0, 30.0))
HORIZONS = (10.0, 30.0, 60.0)
RADIUS = 6378137.0


def speeds(gnss):
    """Horizontal speed at fixes [m/s]: the receiver's, or over two seconds of positions."""
    if np.isfinite(gnss[:, 4]).all():
        return np.hypot(gnss[:, 4], gnss[:, 5])
    time = gnss[:, 0]
    north, east = RADIUS * gnss[:, 1], RADIUS * gnss[:, 2] * np.cos(gnss[0, 1])
    parts = [np.interp(time + 1, time, x) - np.interp(time - 1, time, x) for x in (north, east)]
    return np.hypot(*parts) / 2.0


def split_time(gnss):
    moving = np.flatnonzero(speeds(gnss) > 1.0)
    return gnss[moving[len(moving) // 2], 0]


def windows(gnss, split):
    """Starts and lengths of the windows of each pass: the start is that of the last fix used."""
    end = gnss[-1, 0] - 1.0
    length, every, offsets = LONG if end - split >= 200.0 else SHORT
    return length, [np.arange(split + offset, end - length, every) for offset in offsets]


def at_rest(imu, gnss, split):
    """Samples of the longest stand of the first half, or none of less than 10 s."""
    slow = (speeds(gnss) < 0.3) & (gnss[:, 0] < split)
    best = (0.0, 0.0)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], slow.astype(int), [0]])))
    for first, last in edges.reshape(-1, 2):
        begin, end = gnss[first, 0] + 0.5, gnss[last - 1, 0] - 0.5
        best = max(best, (end - begin, begin))
    length, begin = best
    inside = (imu[:, 0] >= begin) & (imu[:, 0] <= begin + length)
    return imu[inside] if length >= 10.0 else None


def allan_model(imu, rate, own):
    """As people do it: white noise at 1 s, bias instability from the least deviation, over 100 s."""
    import allantools

    found = list(own)
    for first, at in ((1, 0), (4, 3)):
        white, floor = [], []
        for axis in range(first, first + 3):
            taus, deviation, _, _ = allantools.oadev(imu[:, axis], rate=rate, data_type="freq", taus="octave")
            white.append(np.interp(1.0, taus, deviation))
            floor.append(deviation.min() / 0.664)
        found[at] = float(np.sqrt(np.mean(np.square(white))))
        found[at + 1] = float(np.sqrt(np.mean(np.square(floor))) * np.sqrt(2.0 / 100.0))
    return found


def csv(path, names, rows, angles=()):
    rows = rows.copy()
    rows[:, list(angles)] = np.degrees(rows[:, list(angles)])
    np.savetxt(path, rows, delimiter=",", header=",".join(names), comments="", fmt="%.12g")


GNSS = "t_s lat_deg lon_deg height_m vn ve vd sn se sd svn sve svd".split()
IMU = "t_s gx gy gz ax ay az".split()


def write_gnss(path, rows):
    known = np.isfinite(rows).all(0)
    csv(path, [name for name, keep in zip(GNSS, known) if keep], rows[:, known], (1, 2))


def drive_file(spec, model, velocity):
    """What a user of undrift writes for this drive, with the noise model's lines."""
    lever = ", ".join(str(part) for part in spec["lever"])
    text = f'{model}\n[imu]\nfile = "imu.csv"\ntime = "t_s"\ngyro = ["gx", "gy", "gz"]\ngyro_unit = "rad/s"\n'
    text += 'accel = ["ax", "ay", "az"]\naccel_unit = "m/s^2"\n\n[gnss]\nfile = "gnss.csv"\ntime = "t_s"\n'
    text += 'position = ["lat_deg", "lon_deg", "height_m"]\nposition_std_columns = ["sn", "se", "sd"]\n'
    if velocity:
        text += 'velocity = ["vn", "ve", "vd"]\nvelocity_std_columns = ["svn", "sve", "svd"]\n'
    text += f'lever_arm = "{lever} m"\n' if any(spec["lever"]) else ""
    text += '\n[vehicle]\nprofile = "car"\n' if spec["car"] else ""
    text += f'\n[initial]\n{spec["initial"]}' if spec["initial"] else ""
    return text + (f'\n{spec["states"]}' if spec["states"] else "")


def densities(name, numbers):
    keys = [f"{sensor}.{key}" for sensor in ("gyro", "accel") for key in ("white_noise", "random_walk", "turn_on")]
    units = ["rad/s/sqrt(Hz)", "rad/s/sqrt(s)", "rad/s", "m/s^2/sqrt(Hz)", "m/s^2/sqrt(s)", "m/s^2"]
    lines = "".join(f'{key} = "{value:.6g} {unit}"\n' for key, value, unit in zip(keys, numbers, units))
    return f'[model]\nname = "{name}"\n{lines}'


def sheet_lines(name):
    n, b, on, an, ab, aon, tau = SHEETS[name]
    return (
        f'[model]\nname = "{name}, data sheet"\ngyro.white_noise = "{n} deg/sqrt(h)"\ngyro.bias_instability = "{b} deg/h"\n'
        f'gyro.correlation_time = "{tau} s"\ngyro.turn_on = "{on} deg/s"\naccel.white_noise = "{an} ug/sqrt(Hz)"\n'
        f'accel.bias_instability = "{ab} mg"\naccel.correlation_time = "{tau} s"\naccel.turn_on = "{aon} mg"\n'
    )


def run(*arguments):
    return subprocess.run([str(part) for part in arguments], capture_output=True, text=True, check=False)


def half(folder, imu, gnss, split):
    """The logs of the first half, in a folder of their own."""
    folder.mkdir(exist_ok=True)
    csv(folder / "imu.csv", IMU, imu[imu[:, 0] <= split])
    write_gnss(folder / "gnss.csv", gnss[gnss[:, 0] <= split])
    return folder


def estimated_mounting(undrift, folder, spec, imu, gnss, split):
    """Roll, pitch, yaw [deg] that undrift finds in the first half."""
    first = half(folder / "half", imu, gnss, split)
    text = drive_file(spec, densities("by hand", hand(spec["hand"])), np.isfinite(gnss[0, 4]))
    text = text.replace('[imu]\n', '[imu]\nmounting = "auto"\n')
    (first / "auto.toml").write_text(text)
    done = run(undrift, "navigate", first / "auto.toml", "--json", first / "auto.json", "-q")
    if not (first / "auto.json").exists():
        raise SystemExit(f"{folder.name}: no mounting from the first half: {done.stderr}")
    found = json.loads((first / "auto.json").read_text())["mounting"]
    numbers = re.match(r"roll (\S+), pitch (\S+), yaw (\S+) deg", found)
    return [float(number) for number in numbers.groups()]


def first_state(undrift, first, name):
    """The first row of undrift's forward solution of the first half: state, standard deviations of the attitude."""
    done = run(undrift, "navigate", first / name, "-o", first / "nav.csv", "-q")
    if not (first / "nav.csv").exists():
        return None, None, (done.stderr.strip().splitlines() or ["no solution"])[0]
    with (first / "nav.csv").open() as source:
        names = source.readline().strip().split(",")
        row = dict(zip(names, map(float, source.readline().split(","))))
    angle = [row[name] * DEGREE for name in ("lat_deg", "lon_deg")]
    state = [row["time_s"], *angle, row["height_m"], row["vn_mps"], row["ve_mps"], row["vd_mps"]]
    state += [row[f"{name}_deg"] * DEGREE for name in ("roll", "pitch", "yaw")]
    return state, [row[f"{name}_std_deg"] * DEGREE for name in ("roll", "pitch", "yaw")], None


def export(undrift, data, folder, name):
    spec = DRIVES[name]
    imu, gnss, truth = spec["read"](Path(spec["folder"]) if Path(spec["folder"]).is_absolute() else data / spec["folder"])
    gnss = gnss[(gnss[:, 0] > imu[0, 0]) & (gnss[:, 0] < imu[-1, 0]) & np.isfinite(gnss[:, 1])]
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    split = split_time(gnss)
    mounting = None
    if spec["mounting"] == "auto":
        mounting = estimated_mounting(undrift, folder, spec, imu, gnss, split)
        imu = turned(imu, mounting)
    csv(folder / "imu.csv", IMU, imu)
    velocity = bool(np.isfinite(gnss[0, 4]))
    rate = float((len(imu) - 1) / (imu[-1, 0] - imu[0, 0]))
    own = sheet(spec["preset"])
    stand = at_rest(imu, gnss, split)
    models = {"sheet": own, "hand": hand(spec["hand"]) if spec["hand"] else own}
    arrays = {"imu": imu, "gnss": gnss, "lever": np.array(spec["lever"])}
    # Mean rates of the stand: what a user without an estimator of biases takes out.
    arrays["still"] = stand[:, 1:4].mean(0) if stand is not None else np.zeros(3)
    models["rest"] = allan_model(stand, rate, own) if stand is not None else own
    files = {"sheet": sheet_lines(spec["preset"]), "hand": densities("by hand", models["hand"])}
    if not spec["hand"]:
        files["hand"] = files["sheet"]
    first = half(folder / "half", imu, gnss, split)
    for label, lines in files.items():
        for target in (folder, first):
            (target / f"{label}.toml").write_text(drive_file(spec, lines, velocity))
    state, attitude_std, fault = first_state(undrift, first, "hand.toml")
    if state:
        early = gnss[gnss[:, 0] <= split]
        stds = [float(np.median(early[:, 7:9])), float(np.median(early[:, 10:12])) if velocity else 0.0]
        arrays["start"] = np.array(state)
        for label, numbers in models.items():
            arrays[f"model-{label}"] = np.array([*numbers, *stds, *attitude_std])
    length, passes = windows(gnss, split)
    listed, outages = [], []
    for k, starts in enumerate(passes):
        kept, wanted, reference = np.ones(len(gnss), bool), [], []
        for start in starts:
            # The window begins after a fix, so that all horizons count from one that was used.
            begin = gnss[np.searchsorted(gnss[:, 0], start), 0]
            inside = (gnss[:, 0] > begin) & (gnss[:, 0] <= begin + length)
            kept &= ~inside
            outages.append({"pass": k, "begin": float(begin), "length": length, "at": len(wanted)})
            before = None
            for second in range(1, int(length) + 1):
                ends = np.flatnonzero(inside & (gnss[:, 0] <= begin + second + 0.01))
                if not len(ends) or gnss[ends[-1], 0] < begin + second - 1.5:
                    continue
                if truth is not None or ends[-1] != before:
                    before = ends[-1]
                    row = gnss[before].copy()
                    if truth is not None:
                        row[0] = begin + second
                        row[1:7] = [np.interp(row[0], truth[:, 0], truth[:, column]) for column in range(1, 7)]
                        row[7:] = 0.0
                    yaw = np.interp(row[0], truth[:, 0], np.unwrap(truth[:, 9])) if truth is not None else np.nan
                    wanted.append(row[0])
                    reference.append(np.append(row, yaw))
                if second in HORIZONS:
                    listed.append({"pass": k, "begin": float(begin), "horizon": float(second), "at": len(wanted) - 1})
            outages[-1]["count"] = len(wanted) - outages[-1]["at"]
        write_gnss(folder / f"pass{k}.csv", gnss[kept])
        arrays |= {f"pass{k}": gnss[kept], f"wanted{k}": np.array(wanted), f"reference{k}": np.array(reference)}
    for label, values in arrays.items():
        np.asarray(values).astype("<f8").tofile(folder / f"{label}.f64")
    about = {"drive": name, "rate_hz": rate, "samples": len(imu), "fixes": len(gnss), "split_s": float(split), "velocity": velocity,
             "car": spec["car"], "lever_arm_m": spec["lever"], "mounting_deg": mounting, "stand_s": 0.0 if stand is None else len(stand) / rate,
             "truth": truth is not None, "passes": len(passes), "windows": listed, "outages": outages, "no_start": fault}
    (folder / "drive.json").write_text(json.dumps(about, indent=1))
    print(f"{name}: {len(imu)} samples, split {split:.0f}, {len({(w['pass'], w['begin']) for w in listed})} windows of {length:.0f} s"
          f"{', no start: ' + fault if fault else ''}", flush=True)


def main():
    undrift, data, folder, *names = sys.argv[1:]
    for name in names or DRIVES:
        export(Path(undrift).resolve(), Path(data).resolve(), Path(folder) / name, name)


if __name__ == "__main__":
    main()
