"""Golden NMEA logs for crates/io/src/log/nmea/tests.rs.

python3 -m venv venv && venv/bin/pip install pynmeagps==1.1.8 && venv/bin/python testdata/golden/formats/nmea/make.py

The sentences are pynmeagps's, and so are the values of fixes.csv: what its own parser makes of them. Times are closed form.

drive.nmea: 5 Hz across the end of a GPS week, RMC, VTG, GGA and GST in the order of u-blox receivers, all fix
indicators, and in between damaged sentences, other lines and binary bytes.
undated.nmea: GGA alone, 1 Hz across midnight.
late.nmea: GGA across midnight, its date told by a ZDA only after it.
"""

import csv
import pathlib

from pynmeagps import GET, NMEAMessage, NMEAReader

HERE = pathlib.Path(__file__).parent


def clock(seconds):
    seconds = round(seconds * 100) % 8_640_000
    return f"{seconds // 360_000:02d}{seconds // 6_000 % 60:02d}{seconds % 6_000 / 100:05.2f}"


def angle(degrees, width, decimals=7):
    minutes = round(abs(degrees) * 60, decimals)
    return f"{int(minutes // 60):0{width}d}{minutes % 60:0{decimals + 3}.{decimals}f}"


def sentence(talker, kind, fields):
    """The sentence with its checksum by pynmeagps, its fields as they are given."""
    body = f"{talker}{kind}," + ",".join(fields)
    parsed = NMEAMessage(talker, kind, GET, payload=[str(field) for field in fields])
    line = parsed.serialize()
    assert line.startswith(f"${body}*".encode()), (line, body)
    return line


def gga(time, k, quality, separation="-35.987"):
    if quality == 0:
        fields = [clock(time), "", "", "", "", "0", "00", "99.99", "", "", "", "", "", ""]
    else:
        lat, lon = -33.8567844 + 1e-6 * k, 151.2152967 - 2e-6 * k
        unit = "M" if separation else ""
        fields = [clock(time), angle(lat, 2), "S", angle(lon, 3), "E", str(quality), "12", "0.62", f"{161.034 + 0.01 * k:.3f}", "M", separation, unit, "", ""]
    return sentence("GN", "GGA", fields)


def rmc(time, date, k, status="A", mode="A"):
    lat, lon = -33.8567844 + 1e-6 * k, 151.2152967 - 2e-6 * k
    fields = [clock(time), status, angle(lat, 2), "S", angle(lon, 3), "E", "12.345", "87.65", date, "", "", mode, "V"]
    return sentence("GN", "RMC", fields)


def gst(time, k):
    if k % 7 == 3:
        fields = ["1.2", "0.051", "0.021", f"{10 * k % 360}.5", "", "", "0.062"]
    elif k % 7 == 5:
        fields = ["", "", "", "", "", "", ""]
    else:
        fields = ["1.2", "", "", "", f"{0.014 + 0.001 * k:.3f}", f"{0.017 + 0.001 * k:.3f}", f"{0.031 + 0.001 * k:.3f}"]
    return sentence("GN", "GST", [clock(time), *fields])


def drive():
    out, clean, times = bytearray(), bytearray(), []
    # UTC is 18 s behind GPS: 2025-07-12 23:59:36 UTC is 6 s before the end of GPS week 2374.
    start = 86_400 - 24
    for k in range(150):
        time = start + 0.2 * k
        date = "120725" if time < 86_400 else "130725"
        quality = (1, 2, 4, 5, 0, 6, 7, 8, 4, 3)[k // 3 % 10]
        void = k % 50 == 49
        lines = [
            rmc(time, date, k, status="V" if void else "A", mode="N" if void else "D"),
            sentence("GN", "VTG", ["87.65", "T", "", "M", "12.345", "N", "22.863", "K", "D"]),
            gga(time, k, quality),
        ]
        if k % 5:
            lines.append(gst(time, k))
        for line in lines:
            out += line
            clean += line
        if k % 10 == 4:
            damaged = bytearray(gga(time, k + 1, 4))
            damaged[30] ^= 0x01
            out += damaged
        if k % 10 == 6:
            out += b"\xb5\x62\x05\x01\x02\x00\x06\x01\x0f\x38$\xd3\x00\x13"
        if k % 10 == 8:
            out += b"$GNGGA,cut short $PUBX,00,nothing*00\r\n# a line of text\r\n"
        times.append(604_800 - 6 + 0.2 * k)
    (HERE / "drive.nmea").write_bytes(out)
    return clean, times


def fixes(clean, times):
    """One row to an epoch of what pynmeagps reads, empty where a sentence is missing."""
    rows, row = [], None
    for line in clean.splitlines(keepends=True):
        parsed = NMEAReader.parse(bytes(line))
        assert parsed is not None, line
        if parsed.msgID == "RMC":
            row = {"status": parsed.status}
            rows.append(row)
        names = {
            "GGA": ["lat", "lon", "alt", "sep", "quality"],
            "GST": ["stdMajor", "stdMinor", "orient", "stdLat", "stdLong", "stdAlt"],
        }.get(parsed.msgID, [])
        row.update({name: getattr(parsed, name) for name in names})
    header = ["t_s", "status", "lat", "lon", "alt", "sep", "quality", "stdMajor", "stdMinor", "orient", "stdLat", "stdLong", "stdAlt"]
    with open(HERE / "fixes.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        for time, row in zip(times, rows, strict=True):
            writer.writerow([f"{time:.1f}", *(row.get(name, "") for name in header[1:])])


fixes(*drive())
(HERE / "undated.nmea").write_bytes(b"".join(gga(86_395 + k, k, 1, "" if k < 4 else "20.0") for k in range(10)))
late = [gga(86_395 + k, k, 1) for k in range(10)]
late.append(sentence("GN", "ZDA", [clock(4), "13", "07", "2025", "00", "00"]))
late.extend(gga(86_405 + k, k, 1) for k in range(3))
(HERE / "late.nmea").write_bytes(b"".join(late))
