"""Logs of a drive as tables, and the alterations that tools/altered-drives makes to them."""

import csv
import gzip
import re

import numpy as np

EARTH = 6371000.0


class Table:
    """Numbers of a log by column, written back as they came but for what was changed."""

    def __init__(self, path):
        self.path = path
        self.stated = None  # What the drive file has to state as the positions' σ [m].
        self.lever = 0.0  # By what the drive file's lever arm is wrong, forward [m].
        self.truth = None  # The solution that is right, by the columns of nav.csv.
        if path.suffix == ".pos":
            lines = path.read_text().splitlines()
            self.head = [line for line in lines if line.startswith("%")]
            rows = [line.split() for line in lines if not line.startswith("%")]
            clock = [row[1].split(":") for row in rows]
            seconds = np.array([int(h) * 3600 + int(m) * 60 + float(s) for h, m, s in clock])
            self.day = rows[0][0]
            names = "time lat lon height q ns sdn sde sdu sdne sdeu sdun age ratio vn ve vu sdvn sdve sdvu".split()
            columns = np.array([[float(x) for x in row[2:]] for row in rows])
            self.columns = {"time": seconds}
            self.columns.update(zip(names[1:], columns.T))
        else:
            with gzip.open(path, "rt") as source:
                rows = list(csv.reader(source))
            self.head = rows[0]
            data = np.array([[float(x) if x else np.nan for x in row] for row in rows[1:]])
            self.columns = dict(zip(self.head, data.T))
        names = list(self.columns)

        def of(pattern):
            return [name for name in names if re.search(pattern, name)]

        self.time = names[0]
        self.gyro = of(r"^(g[xyz]_|[pqr]_rad)")
        self.accel = of(r"^a[xyz]_")
        self.lat, self.lon = (of(r"^lat") + of(r"^lon") + [None, None])[:2]
        self.height = (of(r"^(height|alt)") + [None])[0]
        self.velocity = of(r"^v[nedu](_mps)?$")
        self.true_time = self[self.time].copy()

    def __getitem__(self, name):
        return self.columns[name]

    def __setitem__(self, name, values):
        self.columns[name] = values

    @property
    def t(self):
        return self.columns[self.time] - self.columns[self.time][0]

    def keep(self, rows):
        self.columns = {name: values[rows] for name, values in self.columns.items()}
        self.true_time = self.true_time[rows]

    def move(self, north, east, down=0.0):
        """Moves the positions by metres."""
        scale = np.cos(np.radians(self[self.lat]))
        self[self.lat] = self[self.lat] + np.degrees(north / EARTH)
        self[self.lon] = self[self.lon] + np.degrees(east / (EARTH * scale))
        self[self.height] = self[self.height] - down

    def write(self, folder):
        target = folder / self.path.name
        values = np.array(list(self.columns.values())).T
        if self.path.suffix == ".pos":
            with target.open("w") as out:
                out.writelines(line + "\n" for line in self.head)
                for row in values:
                    h, rest = divmod(row[0], 3600)
                    m, s = divmod(rest, 60)
                    numbers = f"{row[1]:.9f} {row[2]:.9f} {row[3]:.4f} {row[4]:.0f} {row[5]:.0f} "
                    numbers += " ".join(f"{x:.7f}" for x in row[6:])
                    out.write(f"{self.day} {int(h):02}:{int(m):02}:{s:06.3f} {numbers}\n")
        else:
            with gzip.open(target, "wt", compresslevel=1) as out:
                writer = csv.writer(out)
                writer.writerow(self.head)
                writer.writerows([f"{x:.10g}" if abs(x) < 1e7 else repr(float(x)) for x in row] for row in values)


def spans(table, starts, length):
    t = table.t
    return np.any([(t >= s) & (t < s + length) for s in starts], axis=0)


def evenly(table, count, first=60.0):
    """Times from `first` to shortly before the end [s]."""
    return np.linspace(first, table.t[-1] - 30.0, count)


def gyro_unit(imu):
    """One degree a second in the log's unit."""
    return 1.0 if "dps" in imu.gyro[0] else np.radians(1.0)


def accel_unit(imu):
    """One m/s² in the log's unit."""
    return 1.0 if "mps2" in imu.accel[0] else 1.0 / 9.80665


def ar1(rng, t, std, tau):
    out = np.zeros((3, len(t)))
    out[:, 0] = rng.normal(0, std, 3)
    for k in range(1, len(t)):
        phi = np.exp(-(t[k] - t[k - 1]) / tau)
        out[:, k] = phi * out[:, k - 1] + rng.normal(0, std * np.sqrt(1 - phi * phi), 3)
    return out


# Alterations: each changes the tables in place.


def spikes(axis, value, count=1):
    def alter(imu, gnss, rng):
        names = imu.gyro if axis < 3 else imu.accel
        unit = gyro_unit(imu) if axis < 3 else accel_unit(imu)
        for time in evenly(imu, count + 2)[1:-1]:
            imu[names[axis % 3]][np.searchsorted(imu.t, time)] = value * unit

    return alter


def saturation(axis, value, count, length):
    def alter(imu, gnss, rng):
        names = imu.gyro if axis < 3 else imu.accel
        unit = gyro_unit(imu) if axis < 3 else accel_unit(imu)
        imu[names[axis % 3]][spans(imu, evenly(imu, count), length)] = value * unit

    return alter


def frozen(axis, length, value=None):
    def alter(imu, gnss, rng):
        name = (imu.gyro + imu.accel)[axis]
        rows = spans(imu, [0.5 * imu.t[-1]], length)
        imu[name][rows] = imu[name][rows][0] if value is None else value

    return alter


def bias_jump(axis, value):
    def alter(imu, gnss, rng):
        names = imu.gyro if axis < 3 else imu.accel
        unit = gyro_unit(imu) if axis < 3 else accel_unit(imu)
        imu[names[axis % 3]][imu.t > 0.5 * imu.t[-1]] += value * unit

    return alter


def scale(axes, factor):
    def alter(imu, gnss, rng):
        for axis in axes:
            name = (imu.gyro + imu.accel)[axis]
            imu[name] = imu[name] * factor

    return alter


def clock_back(imu, gnss, rng):
    imu[imu.time] = imu[imu.time] - 0.3 * (imu.t > 0.5 * imu.t[-1])


def clock_rate(ppm):
    def alter(imu, gnss, rng):
        imu[imu.time] = imu[imu.time] + imu.t * ppm * 1e-6

    return alter


def imu_gap(length):
    def alter(imu, gnss, rng):
        imu.keep(~spans(imu, [0.5 * imu.t[-1]], length))

    return alter


def noisier(factor):
    def alter(imu, gnss, rng):
        for name in imu.gyro + imu.accel:
            imu[name] = imu[name] + rng.normal(0, factor * np.std(np.diff(imu[name][:500])), len(imu.t))

    return alter


def multipath(std, tau):
    def alter(imu, gnss, rng):
        gnss.move(*ar1(rng, gnss.t, std, tau))
        stated(gnss, std)

    return alter


def stated(gnss, std):
    """States a standard deviation of the positions, in the log or, where that has none, in the drive file."""
    gnss.stated = std
    for name in gnss.columns:
        if re.match(r"sd[neu]$|pos_std", name):
            gnss[name] = np.full(len(gnss.t), std)


def white(std):
    def alter(imu, gnss, rng):
        gnss.move(*rng.normal(0, std, (3, len(gnss.t))))
        stated(gnss, std)

    return alter


def outliers(share, low, high):
    def alter(imu, gnss, rng):
        hit = (rng.random(len(gnss.t)) < share) & (gnss.t > 60)
        size, angle = rng.uniform(low, high, len(hit)), rng.uniform(0, 2 * np.pi, len(hit))
        gnss.move(hit * size * np.cos(angle), hit * size * np.sin(angle))

    return alter


def position_jump(north, length):
    def alter(imu, gnss, rng):
        gnss.move(north * spans(gnss, [0.5 * gnss.t[-1]], length), 0.0)

    return alter


def repeated(imu, gnss, rng):
    """A receiver of 1 Hz merged into the table by holding its last fix."""
    held = np.searchsorted(gnss.t, np.floor(gnss.t))
    for name in gnss.columns:
        if name != gnss.time:
            gnss[name] = gnss[name][np.minimum(held, len(held) - 1)]


def rounded(digits):
    def alter(imu, gnss, rng):
        for name in (gnss.lat, gnss.lon):
            gnss[name] = np.round(gnss[name], digits)

    return alter


def jitter(std):
    def alter(imu, gnss, rng):
        moved = gnss[gnss.time] + rng.normal(0, std, len(gnss.t))
        gnss[gnss.time] = np.maximum.accumulate(moved + np.arange(len(moved)) * 1e-6)

    return alter


def between(wanted, t, values, slopes):
    """`values` with these `slopes` at t, at the times wanted: a cubic in each interval, since a line cuts the turns."""
    wanted = np.clip(wanted, t[0], t[-1])
    k = np.clip(np.searchsorted(t, wanted, side="right") - 1, 0, len(t) - 2)
    step = np.maximum(t[k + 1] - t[k], 1e-9)
    u = (wanted - t[k]) / step
    bent = (1 + 2 * u) * values[k] + u * step * slopes[k]
    other = (3 - 2 * u) * values[k + 1] - (1 - u) * step * slopes[k + 1]
    return (1 - u) ** 2 * bent + u**2 * other


def late(position, velocity):
    def alter(imu, gnss, rng):
        t = gnss.t
        north, east = (gnss[name] for name in gnss.velocity[:2])
        level = np.cos(np.radians(gnss[gnss.lat]))
        slopes = [np.degrees(north / EARTH), np.degrees(east / (EARTH * level)), np.gradient(gnss[gnss.height], t)]
        for name, slope in zip((gnss.lat, gnss.lon, gnss.height), slopes):
            gnss[name] = between(t + position, t, gnss[name], slope)
        for name in gnss.velocity:
            gnss[name] = between(t + velocity, t, gnss[name], np.gradient(gnss[name], t))

    return alter


def no_fixes(count, length):
    def alter(imu, gnss, rng):
        starts = evenly(gnss, count) if count > 1 else [max(60.0, 0.5 * (gnss.t[-1] - length))]
        gnss.keep(~spans(gnss, starts, length))

    return alter


def velocity_bias(north):
    def alter(imu, gnss, rng):
        gnss[gnss.velocity[0]] = gnss[gnss.velocity[0]] + north

    return alter


def two_receivers(offset):
    """Every other fix comes from a second receiver, which errs slowly, with the accuracy that the first one states."""

    def alter(imu, gnss, rng):
        other = np.arange(len(gnss.t)) % 2
        north, east, down = ar1(rng, gnss.t, offset / np.sqrt(2), 120.0)
        gnss.move(north * other, east * other, down * other)

    return alter


def switching(offset):
    """A second receiver, which errs slowly, takes over for a minute four times; the accuracy stays that of the first one."""

    def alter(imu, gnss, rng):
        other = spans(gnss, evenly(gnss, 4, 120.0), 60.0)
        north, east, down = ar1(rng, gnss.t, offset / np.sqrt(2), 120.0)
        gnss.move(north * other, east * other, down * other)

    return alter


def height_datum(offset):
    def alter(imu, gnss, rng):
        gnss.move(0.0, 0.0, offset * (gnss.t > 0.5 * gnss.t[-1]))

    return alter


def varying_latency(least, most):
    """Fixes are stamped when they arrive, by a delay that wanders within the bounds in about 20 s; their order stays."""

    def alter(imu, gnss, rng):
        wander = ar1(rng, gnss.t, 1.0, 20.0)[0]
        share = 0.5 + 0.5 * np.tanh(wander)
        moved = gnss[gnss.time] + least + (most - least) * share
        gnss[gnss.time] = np.maximum.accumulate(moved + np.arange(len(moved)) * 1e-4)

    return alter


def sensors_late(names, delay):
    def alter(imu, gnss, rng):
        t = imu.t
        for name in getattr(imu, names):
            imu[name] = np.interp(t - delay, t, imu[name])

    return alter


def low_pass(names, corner):
    """A second-order Butterworth filter of `corner` Hz in the sensor."""

    def alter(imu, gnss, rng):
        step = np.median(np.diff(imu.t))
        c = 1.0 / np.tan(np.pi * min(corner * step, 0.45))
        a0 = 1.0 + np.sqrt(2.0) * c + c * c
        a1, a2 = 2.0 * (1.0 - c * c) / a0, (1.0 - np.sqrt(2.0) * c + c * c) / a0
        for name in sum((getattr(imu, part) for part in names.split()), []):
            x = imu[name]
            y = np.empty_like(x)
            y1 = y2 = x1 = x2 = x[0]
            for k, value in enumerate(x):
                y[k] = (value + 2.0 * x1 + x2) / a0 - a1 * y1 - a2 * y2
                x1, x2, y1, y2 = value, x1, y[k], y1
            imu[name] = y

    return alter


def turned(imu, axis, angle):
    """The IMU as it reads when it is turned by `angle` [rad] about its own axis."""
    j, k = [(1, 2), (2, 0), (0, 1)][axis]
    rate = np.gradient(angle, imu.t)
    for names in (imu.gyro, imu.accel):
        a, b = imu[names[j]], imu[names[k]]
        imu[names[j]], imu[names[k]] = np.cos(angle) * a + np.sin(angle) * b, np.cos(angle) * b - np.sin(angle) * a
    imu[imu.gyro[axis]] = imu[imu.gyro[axis]] + np.degrees(rate) * gyro_unit(imu)


def rocking(degrees, frequency):
    """A loose mount: the IMU nods at the frequency of its holder, driven by the road, by so many degrees RMS about its y axis."""

    def alter(imu, gnss, rng):
        step = np.median(np.diff(imu.t))
        omega, damping = 2.0 * np.pi * frequency, 0.2
        angle, rate, angles = 0.0, 0.0, np.empty(len(imu.t))
        for k, push in enumerate(rng.normal(0, 1, len(angles))):
            rate += step * (-2.0 * damping * omega * rate - omega * omega * angle) + push
            angle += step * rate
            angles[k] = angle
        turned(imu, 1, np.radians(degrees) * angles / np.std(angles))

    return alter


def crabbing(degrees):
    """The craft points so many degrees to the right of its motion."""

    def alter(imu, gnss, rng):
        turned(imu, 2, np.full(len(imu.t), np.radians(degrees)))
        imu.truth["yaw_deg"] = imu.truth["yaw_deg"] + degrees

    return alter


def wrong_integer(offset):
    """RTK fixes on a wrong integer twice, for 60 and 90 s, with the accuracy of right ones."""

    def alter(imu, gnss, rng):
        first, second = 0.35 * gnss.t[-1], 0.65 * gnss.t[-1]
        for start, length, angle in ((first, 60.0, 0.7), (second, 90.0, 3.9)):
            inside = spans(gnss, [start], length) * offset
            gnss.move(inside * np.cos(angle), inside * np.sin(angle), inside)

    return alter


def lever_arm(forward):
    def alter(imu, gnss, rng):
        gnss.lever = forward

    return alter


def decimated(rate):
    def alter(imu, gnss, rng):
        step = np.median(np.diff(imu.t))
        imu.keep(np.arange(len(imu.t)) % max(1, round(1.0 / (rate * step))) == 0)

    return alter


def no_vertical_velocity(imu, gnss, rng):
    if len(gnss.velocity) > 2:
        gnss[gnss.velocity[2]] = np.zeros(len(gnss.t))


def carried(speed):
    """At rest on something that moves off gently, northwards, while there are no fixes for half a minute: in vehicles that are at rest
    at the start and whose IMU has the vehicle's axes."""

    def alter(imu, gnss, rng):
        begin, ramp = 15.0, 25.0

        def moved(t):
            since = np.clip(t - begin, 0.0, ramp)
            return 0.5 * speed / ramp * since**2 + speed * np.maximum(t - begin - ramp, 0.0), speed / ramp * since

        gnss.move(moved(gnss.t)[0], 0.0)
        gnss[gnss.velocity[0]] = gnss[gnss.velocity[0]] + moved(gnss.t)[1]
        truth, start = imu.truth, gnss[gnss.time][0]
        north, velocity = moved(truth["time_s"] - start)
        truth["lat_deg"] = truth["lat_deg"] + np.degrees(north / EARTH)
        truth["vn_mps"] = truth["vn_mps"] + velocity
        t = imu[imu.time]
        push = speed / ramp * ((t - start > begin) & (t - start < begin + ramp)) * accel_unit(imu)
        yaw = np.radians(np.interp(t, truth["time_s"], truth["yaw_deg"]))
        imu[imu.accel[0]] = imu[imu.accel[0]] + push * np.cos(yaw)
        imu[imu.accel[1]] = imu[imu.accel[1]] - push * np.sin(yaw)
        gnss.keep(~spans(gnss, [begin - 5.0], 35.0))

    return alter

def unit_changes(axis, factor):
    """One axis is in another unit or range from the middle on."""

    def alter(imu, gnss, rng):
        name = (imu.gyro if axis < 3 else imu.accel)[axis % 3]
        imu[name] = np.where(imu.t > 0.5 * imu.t[-1], factor, 1.0) * imu[name]

    return alter


def copied(source, target):
    def alter(imu, gnss, rng):
        names = imu.gyro + imu.accel
        imu[names[target]] = imu[names[source]].copy()

    return alter


def wraps(axis, limit):
    """Counts of too few bits: what is beyond the limit comes back from the other side."""

    def alter(imu, gnss, rng):
        names, unit = (imu.gyro, gyro_unit(imu)) if axis < 3 else (imu.accel, accel_unit(imu))
        name, span = names[axis % 3], limit * unit
        imu[name] = (imu[name] + span) % (2 * span) - span

    return alter


def turned_while_driving(degrees):
    """The IMU is turned about its z axis in the middle."""

    def alter(imu, gnss, rng):
        after = imu.t > 0.5 * imu.t[-1]
        cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        for x, y, _ in (imu.gyro, imu.accel):
            old = imu[x].copy(), imu[y].copy()
            imu[x] = np.where(after, cos * old[0] + sin * old[1], old[0])
            imu[y] = np.where(after, -sin * old[0] + cos * old[1], old[1])

    return alter


def receiver_filter(tau):
    """The receiver's own filter: its positions and velocities follow with a time constant."""

    def alter(imu, gnss, rng):
        for name in (gnss.lat, gnss.lon, gnss.height, *gnss.velocity):
            values = gnss[name].copy()
            for k in range(1, len(values)):
                gain = 1.0 - np.exp(-(gnss.t[k] - gnss.t[k - 1]) / tau)
                values[k] = values[k - 1] + gain * (values[k] - values[k - 1])
            gnss[name] = values

    return alter


def velocity_scale(factor):
    def alter(imu, gnss, rng):
        for name in gnss.velocity:
            gnss[name] = factor * gnss[name]

    return alter


def differenced(step):
    """Velocities are differences of the positions over some fixes, stamped with the last of them."""

    def alter(imu, gnss, rng):
        metres = np.radians(1.0) * EARTH
        north, east = metres * gnss[gnss.lat], metres * np.cos(np.radians(gnss[gnss.lat][0])) * gnss[gnss.lon]
        up = gnss[gnss.height] * (1.0 if gnss.velocity[2].startswith("vu") else -1.0)
        interval = np.maximum(gnss.t[step:] - gnss.t[:-step], 1e-3)
        for name, moved in zip(gnss.velocity, (north, east, up)):
            values = gnss[name].copy()
            values[step:] = (moved[step:] - moved[:-step]) / interval
            gnss[name] = values

    return alter


def held_when_slow(speed):
    """The receiver holds its position, with a velocity of zero, below a speed."""

    def alter(imu, gnss, rng):
        slow = np.hypot(gnss[gnss.velocity[0]], gnss[gnss.velocity[1]]) < speed
        for k in np.flatnonzero(slow):
            if k == 0:
                continue
            for name in (gnss.lat, gnss.lon, gnss.height):
                gnss[name][k] = gnss[name][k - 1]
            for name in gnss.velocity:
                gnss[name][k] = 0.0

    return alter


def height_wanders(std, tau):
    def alter(imu, gnss, rng):
        gnss.move(0.0, 0.0, ar1(rng, gnss.t, std, tau)[2])

    return alter


def understated(factor):
    """White errors of so many times the stated standard deviation."""

    def alter(imu, gnss, rng):
        names = [name for name in gnss.columns if re.match(r"sd[neu]$|pos_std", name)]
        std = np.median(gnss[names[0]]) if names else 0.2
        gnss.move(*rng.normal(0, factor * std, (3, len(gnss.t))))

    return alter


def canyon(std, stated_std):
    """Three minutes between high buildings: errors of a few seconds to tens, a third of the fixes missing, and a modest σ."""

    def alter(imu, gnss, rng):
        deep = spans(gnss, evenly(gnss, 3, 120.0), 60.0)
        gnss.move(*(ar1(rng, gnss.t, std, 8.0) * deep))
        for name in gnss.columns:
            if re.match(r"sd[neu]$|pos_std", name):
                gnss[name] = np.where(deep, stated_std, gnss[name])
        gnss.keep(~deep | (rng.random(len(gnss.t)) > 0.3))

    return alter


def appended(length):
    """Two logs appended: what lies between them is cut out, and the clock goes on."""

    def alter(imu, gnss, rng):
        middle = 0.5 * (imu[imu.time][0] + imu[imu.time][-1]) % 86400
        for table in (imu, gnss):
            time = table[table.time] % 86400
            table[table.time] = np.where(time >= middle + length, table[table.time] - length, table[table.time])
            table.keep((time < middle) | (time >= middle + length))

    return alter


ALTERATIONS = {
    "none": lambda imu, gnss, rng: None,
    "one gyro z sample at 2000 deg/s": spikes(2, 2000.0),
    "ten gyro z samples at -1000 deg/s": spikes(2, -1000.0, 10),
    "one accelerometer x sample at 1000 m/s2": spikes(3, 1000.0),
    "accelerometer x saturated 20 x 1.5 s": saturation(3, 40.0, 20, 1.5),
    "gyro z saturated 20 x 0.3 s": saturation(2, 250.0, 20, 0.3),
    "gyro z frozen for 60 s": frozen(2, 60.0),
    "gyro z dead for 60 s": frozen(2, 60.0, 0.0),
    "accelerometer y frozen for 60 s": frozen(4, 60.0),
    "gyro z bias +0.3 deg/s from the middle on": bias_jump(2, 0.3),
    "gyro z bias +1 deg/s from the middle on": bias_jump(2, 1.0),
    "accelerometer x bias +0.5 m/s2 from the middle on": bias_jump(3, 0.5),
    "gyros read 5 % too much": scale([0, 1, 2], 1.05),
    "gyro z reads 2 % too little": scale([2], 0.98),
    "accelerometers read 2 % too much": scale([3, 4, 5], 1.02),
    "IMU clock steps back by 0.3 s": clock_back,
    "IMU clock 500 ppm fast": clock_rate(500.0),
    "IMU clock 100 ppm slow": clock_rate(-100.0),
    "no samples for 2 s": imu_gap(2.0),
    "no samples for 10 s": imu_gap(10.0),
    "sensor noise three times": noisier(3.0),
    "multipath 5 m, 60 s, stated 5 m": multipath(5.0, 60.0),
    "multipath 2 m, 20 s, stated 2 m": multipath(2.0, 20.0),
    "white position error 2 m, stated": white(2.0),
    "2 % of positions 20 to 500 m off": outliers(0.02, 20.0, 500.0),
    "position 30 m off for 5 s": position_jump(30.0, 5.0),
    "position 10 m off for 60 s": position_jump(10.0, 60.0),
    "1 Hz fixes repeated": repeated,
    "positions rounded to 1e-5 deg": rounded(5),
    "stamps of fixes jitter by 20 ms": jitter(0.02),
    "positions 0.2 s late, velocities 0.1 s early": late(-0.2, 0.1),
    "no fixes six times for 30 s": no_fixes(6, 30.0),
    "velocity north 0.5 m/s too much": velocity_bias(0.5),
    # Three strengths each.
    **{f"height reference {x:g} m lower from the middle on": height_datum(x) for x in (5.0, 35.0, 50.0)},
    **{f"fixes stamped 50 to {x * 1e3:g} ms late, varying": varying_latency(0.05, x) for x in (0.15, 0.4, 0.8)},
    **{f"accelerometers {x:g} s late": sensors_late("accel", x) for x in (0.05, 0.1, 0.2)},
    **{f"IMU behind a low-pass of {x:g} Hz": low_pass("gyro accel", x) for x in (1.0, 2.0, 5.0)},
    **{f"gyros behind a low-pass of {x:g} Hz": low_pass("gyro", x) for x in (1.0, 2.0, 5.0)},
    **{f"IMU rocks by 3 deg at {x:g} Hz": rocking(3.0, x) for x in (0.3, 0.6, 1.0)},
    **{f"wrong integer of {x:g} m twice": wrong_integer(x) for x in (0.3, 0.5, 1.0)},
    **{f"crabs by {x:g} deg": crabbing(x) for x in (1.5, 3.0, 6.0)},
    **{f"lever arm wrong by {x:g} m": lever_arm(x) for x in (0.5, 1.0, 2.0)},
    **{f"{x:g} Hz IMU log": decimated(x) for x in (5.0, 10.0, 20.0)},
    "vertical velocity always 0": no_vertical_velocity,
    **{f"two receivers alternate, {x:g} m": two_receivers(x) for x in (1.0, 5.0, 10.0)},
    **{f"a second receiver takes over, {x:g} m": switching(x) for x in (1.0, 5.0, 10.0)},
    **{f"at rest on a ferry that reaches {x:g} m/s": carried(x) for x in (1.0, 3.0, 6.0)},
    "no fixes for 300 s": no_fixes(1, 300.0),
    **{f"gyro z counts {x:g} times from the middle on": unit_changes(2, x) for x in (0.5, 2.0, 57.3)},
    **{f"accelerometer x counts {x:g} times from the middle on": unit_changes(3, x) for x in (0.5, 2.0, 9.81)},
    "gyro y copied into gyro z": copied(1, 2),
    "gyro z copied into gyro x": copied(2, 0),
    "accelerometer x copied into accelerometer y": copied(3, 4),
    **{f"gyro z wraps at {x:g} deg/s": wraps(2, x) for x in (10.0, 20.0, 30.0)},
    **{f"accelerometer z wraps at {x:g} m/s2": wraps(5, x) for x in (10.3, 11.0, 12.0)},
    **{f"IMU turned by {x:g} deg while driving": turned_while_driving(x) for x in (10.0, 30.0, 90.0)},
    **{f"receiver's filter of {x:g} s": receiver_filter(x) for x in (0.3, 1.0, 3.0)},
    **{f"velocities {x:g} times": velocity_scale(x) for x in (0.9, 1.05, 1.2)},
    **{f"velocities are differences over {x} fixes": differenced(x) for x in (1, 2, 5)},
    **{f"position held below {x:g} m/s": held_when_slow(x) for x in (0.5, 1.0, 2.0)},
    **{f"height wanders by {x:g} m": height_wanders(x, 100.0) for x in (1.0, 3.0, 10.0)},
    **{f"standard deviation {x:g} times too small": understated(x) for x in (5.0, 15.0, 50.0)},
    **{f"urban canyon of {x:g} m": canyon(x, 0.3 * x) for x in (5.0, 15.0, 30.0)},
    **{f"two logs appended, {x:g} s apart": appended(x) for x in (10.0, 60.0, 120.0)},
}

# What names the cause of an alteration in the first line, by words in its name: any of these is right. What is not here has
# no cause that a user could mend: noise, gaps, accuracies that are stated.
CAUSES = {
    r"one gyro z sample|ten gyro z samples|one accelerometer x": r"replaced \d+ samples? of (gyro z|accelerometer x)",
    r"saturated": r"(gyro z|accelerometer x) stays at .*saturated|saturated",
    r"frozen|dead": r"(gyro z|accelerometer y) (stays at|repeats|is constant)",
    r"gyro z bias|gyro z counts": r"vertical gyro|gyro z",
    r"gyros read|gyro z reads": r"gyro scale|gyro_unit|scale of the (vertical )?gyro",
    r"accelerometers read": r"accelerometers? (measure|scale)|accel_unit",
    r"accelerometer x (bias|counts)": r"accelerometer (x|along body)|accel(erometer)?s?'? (bias|scale|unit)|specific force",
    r"clock steps back": r"clock steps back",
    r"IMU clock": r"clock",
    r"outliers|% of positions|position \d+ m off|wrong integer": r"rejected|positions of the fixes jump|reflections|multipath",
    r"repeated": r"repeat",
    r"rounded": r"rounded",
    r"jitter|varying": r"jitter|stamp|late",
    r"late, velocities": r"late|early|time offset|time_offset",
    r"velocity north": r"velocit(y|ies) .*(differ|disagree|wrong)|positions and velocities disagree",
    r"height reference": r"height of the fixes jumps",
    r"accelerometers \S+ s late": r"accelerometers? .*late|late .*accelerometer",
    r"low-pass|Hz IMU log": r"low-pass|samples a second|late",
    r"rocks": r"rock|loose|mount|IMU was moved|lever arm or the axes",
    r"crabs": r"side slip|across its forward axis|course",
    r"lever arm": r"lever arm",
    r"vertical velocity always": r"vertical velocity of the fixes is always 0",
    r"two receivers|second receiver": r"two receivers|another base or receiver|another receiver",
    r"ferry": r"at rest|stands? .*(moves|carried)|ferry",
    r"copied": r"copie?s?d?|same (values|column)|check imu\.(gyro|accel|axes)|turns? of the GNSS course|axes",
    r"wraps": r"wraps?|range|saturated|replaced|bits",
    r"turned by": r"IMU was (moved|turned)|turned|imu\.mounting|imu\.axes",
    r"receiver's filter": r"receiver'?s? (own )?(filter|smooth)|low-pass|late|lag",
    r"velocities \S+ times": r"velocit(y|ies) .*(scale|times|unit|disagree)",
    r"differences over": r"velocit(y|ies) .*(late|early|differences)|time offset",
    r"held below": r"repeat|held|rejected .*repeated",
    r"height wanders": r"height",
    r"too small": r"stated|scatter",
    r"canyon": r"rejected|reflections|multipath|scatter|disagree .*positions|positions of the fixes disagree",
    r"appended": r"appended|positions of the fixes jump|two logs|clock|gap",
}
