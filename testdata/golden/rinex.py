"""Made-up RINEX files of versions 2.11 and 3.04, and what georinex 1.16.2 reads of them.

Writes the folder rinex beside it: two.obs, two.nav, three.obs, three.nav; observations.csv (file, satellite, second of the week, code [m],
phase [cycles], Doppler shift [Hz], carrier to noise density) and ephemerides.csv (file, satellite, time of clock, af0, sqrt_a, toe, omega_dot,
i_dot, group delay).

    pip install georinex==1.16.2 && python rinex.py
"""

import random
from datetime import datetime, timedelta
from pathlib import Path

import georinex
import numpy as np

random.seed(50)
HERE = Path(__file__).parent / "rinex"
START = datetime(2025, 8, 28, 17, 30, 39, 748000)
SUNDAY = np.datetime64("2025-08-24")
# More than the twelve of a line of version 2, and systems that are passed over.
SATELLITES = ["G%02d" % n for n in (1, 3, 5, 8, 10, 18, 23, 24, 27, 31)] + ["R07", "E05", "E33", "S31"]


def label(text, name):
    return f"{text:60}{name:20}\n"


def number(width, decimals, value):
    return " " * width if value is None else f"{value:{width}.{decimals}f}"


def rows():
    """Code, phase, Doppler shift, strength on L1, and code, phase, strength on L2."""
    found = []
    for _ in SATELLITES:
        code = random.uniform(2e7, 2.6e7)
        row = [code, code / 0.19029367, random.uniform(-4e3, 4e3), random.randint(25, 52), code + 4, code / 0.2442102, 30]
        found.append(row)
    found[3][1] = None
    found[5][4:] = [None] * 3
    return found


def observations():
    two = label("     2.11           OBSERVATION DATA    M: Mixed", "RINEX VERSION / TYPE")
    types = ["C1", "L1", "D1", "S1", "C2", "L2", "S2"]
    two += label("     7" + "".join(f"{t:>6}" for t in types), "# / TYPES OF OBSERV")
    three = label("     3.04           OBSERVATION DATA    M: Mixed", "RINEX VERSION / TYPE")
    for system, l2 in (("G", "2X"), ("R", "2C"), ("E", "7Q"), ("S", "5I")):
        types = ["C1C", "L1C", "D1C", "S1C", f"C{l2}", f"L{l2}", f"S{l2}"]
        three += label(f"{system}    7 " + " ".join(types), "SYS / # / OBS TYPES")
    first = f"  2025    08    28    17    30   39.7480000     GPS"
    end = label(first, "TIME OF FIRST OBS") + label("", "END OF HEADER")
    two, three = two + end, three + end
    for k in range(3):
        time = START + timedelta(seconds=k)
        second = time.second + time.microsecond * 1e-6
        day = f"{time.month:02} {time.day:02} {time.hour:02} {time.minute:02} {second:10.7f}"
        two += f" {time.year % 100:02} {day}  0{len(SATELLITES):3}" + "".join(SATELLITES[:12]) + "\n"
        two += " " * 32 + "".join(SATELLITES[12:]) + "\n"
        three += f"> {time.year} {day}  0{len(SATELLITES):3}\n"
        for name, row in zip(SATELLITES, rows()):
            # The second epoch of G10 has lost lock, the third of G18 has half a cycle open.
            lost = {("G10", 1): "1", ("G18", 2): "2"}.get((name, k), " ")
            strength = str(int(row[3] // 6))
            marks = ["  ", lost + strength, "  ", "  ", "  ", "  ", "  "]
            cells = [number(14, 3, value) + mark for value, mark in zip(row, marks)]
            two += "".join(cells[:5]).rstrip() + "\n" + "".join(cells[5:]).rstrip() + "\n"
            three += name + "".join(cells).rstrip() + "\n"
    (HERE / "two.obs").write_text(two)
    (HERE / "three.obs").write_text(three)


def fortran(value):
    mantissa, exponent = f"{value:.12e}".split("e")
    return f"{mantissa:>15}D{int(exponent):+03}"


def ephemeris(galileo):
    uniform = random.uniform
    numbers = [uniform(-5e-4, 5e-4), uniform(-1e-11, 1e-11), 0.0]
    numbers += [random.randint(1, 99), uniform(-200, 200), uniform(3e-9, 6e-9), uniform(-3, 3)]
    numbers += [uniform(-5e-6, 5e-6), uniform(1e-4, 0.02), uniform(-1e-5, 1e-5), 5440.6 if galileo else uniform(5153, 5154)]
    numbers += [410400.0, uniform(-1e-7, 1e-7), uniform(-3, 3), uniform(-1e-7, 1e-7)]
    numbers += [uniform(0.9, 1), uniform(100, 300), uniform(-3, 3), uniform(-9e-9, -7e-9)]
    numbers += [uniform(-5e-10, 5e-10), 517.0 if galileo else 1.0, 2381.0, 0.0]
    numbers += [3.12 if galileo else 2.0, 0.0, uniform(-2e-8, 2e-8), uniform(-2e-8, 2e-8) if galileo else 77.0]
    return numbers + [408756.0, 4.0]


def navigation():
    two = label("     2.11           N: GPS NAV DATA", "RINEX VERSION / TYPE") + label("", "END OF HEADER")
    three = label("     3.04           N: GNSS NAV DATA    M: Mixed", "RINEX VERSION / TYPE") + label("", "END OF HEADER")
    for name in ("G03", "R07", "G31", "E05"):
        if name == "R07":
            three += "R07 2025 08 28 17 45 00" + "".join(map(fortran, [1e-5, 0.0, 4e5])) + "\n"
            three += ("    " + "".join(map(fortran, [1e4, 1.0, 0.0, 0.0])) + "\n") * 3
            continue
        numbers = ephemeris(name[0] == "E")
        lines = [numbers[:3]] + [numbers[k : k + 4] for k in range(3, len(numbers), 4)]
        body = ["".join(map(fortran, line)) + "\n" for line in lines]
        three += f"{name} 2025 08 28 18 00 00" + body[0] + "".join("    " + line for line in body[1:])
        if name[0] == "G":
            two += f"{int(name[1:]):2} 25  8 28 18  0  0.0" + body[0] + "".join("   " + line for line in body[1:])
    (HERE / "two.nav").write_text(two)
    (HERE / "three.nav").write_text(three)


def seconds(time):
    return (np.datetime64(time) - SUNDAY) / np.timedelta64(1, "ns") * 1e-9


def read():
    with (HERE / "observations.csv").open("w") as out:
        for file, suffix in (("two.obs", ""), ("three.obs", "C")):
            data = georinex.load(HERE / file)
            for time in data.time.values:
                for name in data.sv.values:
                    if name[0] not in "GE":
                        continue
                    values = [float(data[kind + "1" + suffix].sel(time=time, sv=name)) for kind in "CLDS"]
                    print(file, name, f"{seconds(time):.3f}", *map(repr, values), sep=",", file=out)
    with (HERE / "ephemerides.csv").open("w") as out:
        for file in ("two.nav", "three.nav"):
            data = georinex.load(HERE / file)
            for name in data.sv.values:
                if name[0] not in "GE":
                    continue
                one = data.sel(sv=name).dropna(dim="time", how="all")
                time = one.time.values[0]
                one = one.sel(time=time)
                delay = "BGDe5b" if name[0] == "E" else "TGD"
                keys = ["SVclockBias", "sqrtA", "Toe", "OmegaDot", "IDOT", delay]
                print(file, name, seconds(time), *(repr(float(one[key])) for key in keys), sep=",", file=out)


HERE.mkdir(exist_ok=True)
observations()
navigation()
read()
