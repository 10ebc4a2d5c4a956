"""Subframes of made-up GPS ephemerides, and where RTKLIB (through pyrtklib 0.2.7) puts the satellites.

Writes ephemerides.csv beside it: the thirty words of subframes 1, 2, 3 as a receiver gives them, a time by the satellite's clock
[s of the week], place [m, Earth-centred Earth-fixed] and clock [s, with relativity, without group delay], and the group delay [s].

    pip install pyrtklib==0.2.7 && python ephemerides.py
"""

import random
from pathlib import Path

import pyrtklib as rtk

WEEK = 2381
random.seed(50)


def word_bits(fields):
    """Fields of (value, bits) as the 24-bit words of a subframe behind its first two."""
    text = "".join(format(value & ((1 << bits) - 1), f"0{bits}b") for value, bits in fields)
    assert len(text) == 8 * 24, len(text)
    return [int(text[at : at + 24], 2) for at in range(0, len(text), 24)]


def subframe(number, tow, fields):
    """Ten words of 30 bits; the parity, which nobody looks at, is random."""
    telemetry = 0x8B << 16 | random.getrandbits(16)
    handover = tow << 7 | random.getrandbits(2) << 5 | number << 2 | random.getrandbits(2)
    words = [telemetry, handover, *word_bits(fields)]
    return [word << 6 | random.getrandbits(6) for word in words]


def signed(bits, share=1.0):
    most = int((1 << (bits - 1)) * share) - 1
    return random.randint(-most, most)


def rand(bits):
    return random.getrandbits(bits)


def orbit(toe):
    iode = rand(8)
    af2, af1, af0 = signed(8, 0.05), signed(16, 0.05), signed(22, 0.5)
    m0, e, root_a = signed(32), random.randint(0, int(0.03 * 2**33)), int((5153.6 + random.uniform(-2, 2)) * 2**19)
    omega0, i0, omega = signed(32), int((0.305 + random.uniform(-0.01, 0.01)) * 2**31), signed(32)
    omega_dot, i_dot, delta_n = int(-2.6e-9 * 2**43) + signed(10), signed(14, 0.1), random.randint(8000, 16000)
    toc = toe // 16
    first = [(WEEK % 1024, 10), (1, 2), (rand(1), 4), (0, 6), (rand(2), 2)]
    first += [(rand(24), 24) for _ in range(3)] + [(rand(16), 16), (signed(8, 0.3), 8), (iode, 8), (toc, 16)]
    first += [(af2, 8), (af1, 16), (af0, 22), (rand(2), 2)]
    second = [(iode, 8), (signed(16, 0.2), 16), (delta_n, 16), (m0, 32), (signed(16, 0.1), 16), (e, 32)]
    second += [(signed(16, 0.1), 16), (root_a, 32), (toc, 16), (0, 1), (rand(5), 5), (rand(2), 2)]
    third = [(signed(16, 0.01), 16), (omega0, 32), (signed(16, 0.01), 16), (i0, 32), (signed(16, 0.3), 16), (omega, 32)]
    third += [(omega_dot, 24), (iode, 8), (i_dot, 14), (rand(2), 2)]
    tow = toe // 6
    return [subframe(1, tow, first), subframe(2, tow + 1, second), subframe(3, tow + 2, third)]


def decoded(frames):
    """RTKLIB takes the words without parity, ten times 24 bits a subframe."""
    eph, almanac = rtk.eph_t(), rtk.alm_t()
    ionosphere, utc = rtk.Arr1Ddouble(8), rtk.Arr1Ddouble(8)
    buffer = getattr(rtk, "Arr1Dunsigned char")(150)
    data = b"".join((word >> 6).to_bytes(3, "big") for frame in frames for word in frame)
    for k in range(150):
        buffer[k] = data[k] if k < len(data) else 0
    rtk.decode_frame(buffer, eph, almanac, ionosphere, utc)
    assert eph.toes > 0 and 0.9 < eph.i0 < 1.0 and eph.A > 2.6e7 and eph.f0 != 0.0, "not decoded"
    eph.toe, eph.toc = rtk.gpst2time(WEEK, eph.toes), rtk.gpst2time(WEEK, eph.toes)
    return eph


rows = ["words,time_s,x_m,y_m,z_m,clock_s,tgd_s"]
for toe in [7200, 302400, 453584, 597600]:
    for _ in range(3):
        frames = orbit(toe)
        eph = decoded(frames)
        tgd = eph.tgd[0]
        for after in [-7000, -1234.567, 0.5, 3600.25, 7150]:
            clock_time = toe + after
            time = rtk.gpst2time(WEEK, clock_time)
            time = rtk.timeadd(time, -rtk.eph2clk(time, eph))
            place, clock, variance = rtk.Arr1Ddouble(3), rtk.Arr1Ddouble(1), rtk.Arr1Ddouble(1)
            rtk.eph2pos(time, eph, place, clock, variance)
            words = " ".join(f"{word:08x}" for frame in frames for word in frame)
            numbers = [f"{place[k]:.5f}" for k in range(3)] + [f"{clock[0]:.15e}", f"{tgd:.10e}"]
            rows.append(",".join([words, f"{clock_time}", *numbers]))
Path(__file__).with_suffix(".csv").write_text("\n".join(rows) + "\n")
