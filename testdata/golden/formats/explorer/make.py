"""Golden exports of Inertial Explorer for crates/io/src/log/explorer.rs.

python3 testdata/golden/formats/explorer/make.py

The same 50 states in three profiles: GPS week and second (week.txt), UTC date and h:m:s (date.txt), the latter between commas
(commas.csv); expected.csv. Times are by datetime and the 18 leap seconds of 2025; they run past midnight UTC.
"""

import csv
import datetime
import pathlib

HERE = pathlib.Path(__file__).parent
GPS = datetime.datetime(1980, 1, 6)
WEEK = 2374
START = 345_570.0
LEAP_S = 18

HEAD = """\
Project:     Drive
Program:     Inertial Explorer Version 8.90.2428
Profile:     IE Default
Source:      GNSS/INS Epochs(Smoothed TC Combined)
ProcessInfo: Run (14) by Unknown

Datum:       WGS84, (processing datum)
"""

weeks, dates, commas, rows = [], [], [], []
for k in range(50):
    t = START + 0.5 * k
    utc = GPS + datetime.timedelta(weeks=WEEK, seconds=t - LEAP_S)
    clock = utc.strftime("%H:%M:%S") + f".{utc.microsecond // 1000:03d}"
    state = dict(lat_deg=45.0 + 1e-5 * k, lon_deg=-73.5 - 2e-5 * k, height_m=30.5 + 0.125 * k, ve=0.25 * k, vn=12.5 - 0.25 * k, vu=0.0625,
                 yaw_deg=100.0 + k, pitch_deg=-1.5 + 0.125 * k, roll_deg=0.75)
    state = {name: round(value, 8) for name, value in state.items()}
    values = [str(value) for value in state.values()]
    weeks.append("  ".join([str(WEEK), f"{t:.3f}"] + values + ["1"]))
    dates.append("  ".join([clock, utc.strftime("%m/%d/%Y")] + values + ["1"]))
    commas.append(",".join([clock, utc.strftime("%Y/%m/%d")] + values + ["1"]))
    rows.append(dict(t_s=repr(t), **state))

NAMES = "Latitude      Longitude        H-Ell        VEast       VNorth          VUp      Heading        Pitch         Roll Q"
UNITS = "(deg)          (deg)          (m)        (m/s)        (m/s)        (m/s)        (deg)        (deg)        (deg)"
(HERE / "week.txt").write_text(HEAD + f"\n  Week      GPSTime  {NAMES}\n (weeks)        (sec)  {UNITS}\n" + "\n".join(weeks) + "\n")
(HERE / "date.txt").write_text(HEAD + f"\n   UTCTime        Date  {NAMES}\n     (HMS)       (MDY)  {UNITS}\n" + "\n".join(dates) + "\n")
names = ",".join(["UTCTime", "Date"] + NAMES.split())
units = ",".join(["(HMS)", "(YMD)"] + UNITS.split())
(HERE / "commas.csv").write_text(HEAD + names + "\n" + units + "\n" + "\n".join(commas) + "\n")
with open(HERE / "expected.csv", "w", newline="") as file:
    writer = csv.DictWriter(file, rows[0], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
