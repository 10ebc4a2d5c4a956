"""Prints the samples of a gyroscope and an accelerometer of Linux IIO (one device, such as an MPU-6050, ICM-20602 or BMI160 on I2C) as
lines t,gx,gy,gz,ax,ay,az [s, rad/s, m/s^2], at the kernel's times, through the buffer of the device:

    sudo python3 iio.py /sys/bus/iio/devices/iio:device0 200 | undrift live drive.toml --imu - --gnss serial:/dev/ttyACM0
"""

import pathlib
import re
import sys

NAMES = [f"in_{kind}_{axis}" for kind in ("anglvel", "accel") for axis in "xyz"]
STAMP = "in_timestamp"


def number(folder, name, key, otherwise):
    """A number of a channel, which channels of a kind may share."""
    files = [folder / f"{name}_{key}", folder / f"{name.rpartition('_')[0]}_{key}"]
    return next((float(file.read_text()) for file in files if file.exists()), otherwise)


def layout(scans):
    """Where each channel is in a scan: first byte, bytes, their order, sign, bits, shift; and the bytes of a scan."""
    fields, end, widest = {}, 0, 1
    for name in sorted([*NAMES, STAMP], key=lambda name: int((scans / f"{name}_index").read_text())):
        found = re.fullmatch(r"(le|be):([su])(\d+)/(\d+)>>(\d+)", (scans / f"{name}_type").read_text().strip())
        order, sign, bits, width, shift = found.groups()
        width = int(width) // 8
        begin = -(-end // width) * width  # At a multiple of its width.
        fields[name] = (begin, begin + width, {"le": "little", "be": "big"}[order], sign, int(bits), int(shift))
        end, widest = begin + width, max(widest, width)
    return fields, -(-end // widest) * widest


def raw(scan, begin, end, order, sign, bits, shift):
    value = (int.from_bytes(scan[begin:end], order) >> shift) & ((1 << bits) - 1)
    return value - (1 << bits) if sign == "s" and value >> (bits - 1) else value


def main(folder, rate="200", device=None):
    folder = pathlib.Path(folder)
    scans, buffer = folder / "scan_elements", folder / "buffer"
    (buffer / "enable").write_text("0")
    for file in scans.glob("*_en"):
        file.write_text(str(int(file.name[:-3] in [*NAMES, STAMP])))
    for file in folder.glob("*sampling_frequency"):
        file.write_text(rate)
    (buffer / "length").write_text("256")
    fields, size = layout(scans)
    units = [(name, number(folder, name, "offset", 0.0), number(folder, name, "scale", 1.0)) for name in NAMES]
    (buffer / "enable").write_text("1")
    with open(device or f"/dev/{folder.name}", "rb") as file:
        print("t,gx,gy,gz,ax,ay,az", flush=True)
        while len(scan := file.read(size)) == size:
            values = [(raw(scan, *fields[name]) + offset) * scale for name, offset, scale in units]
            print(f"{raw(scan, *fields[STAMP]) * 1e-9:.6f}", *(f"{value:.9g}" for value in values), sep=",", flush=True)


main(*sys.argv[1:])
