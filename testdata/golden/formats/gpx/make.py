"""Golden GPX tracks for crates/io/src/log/gpx/tests.rs.

python3 -m venv venv && venv/bin/pip install gpxpy==1.6.2 && venv/bin/python testdata/golden/formats/gpx/make.py

gpxpy writes the files and reads points.csv out of them, times being seconds since the GPS epoch by Python's calendar.
"""

import csv
import datetime
import pathlib

import gpxpy
import gpxpy.gpx

HERE = pathlib.Path(__file__).parent
GPS_EPOCH = datetime.datetime(1980, 1, 6, tzinfo=datetime.timezone.utc)
# GPS time minus UTC since 2017.
LEAP_SECONDS = 18


def track(start, count):
    gpx = gpxpy.gpx.GPX()
    gpx.name = "Zürich <&> back"
    gpx.waypoints.append(gpxpy.gpx.GPXWaypoint(1.0, 2.0, elevation=3.0, time=start))
    route = gpxpy.gpx.GPXRoute()
    route.points.append(gpxpy.gpx.GPXRoutePoint(1.0, 2.0, elevation=3.0, time=start))
    gpx.routes.append(route)
    out = gpxpy.gpx.GPXTrack(name="in and out")
    gpx.tracks.append(out)
    for k in range(count):
        if k % 20 == 0:
            segment = gpxpy.gpx.GPXTrackSegment()
            out.segments.append(segment)
        # Half a minute of nothing between segments; fractions in every other point.
        time = start + datetime.timedelta(seconds=k + 30 * (k // 20), milliseconds=250 * (k % 2))
        point = gpxpy.gpx.GPXTrackPoint(
            round(47.3769 + 1.7e-5 * k, 7), round(-8.5417 - 2.3e-5 * k, 7),
            elevation=None if k % 17 == 16 else round(408.25 + 0.3 * k, 2),
            time=None if k % 13 == 12 else time,
            horizontal_dilution=0.9,
        )
        if k % 5 == 4:
            point.geoid_height = 47.5
        segment.points.append(point)
    return gpx


def table(name, text):
    with open(HERE / name, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["gps_s", "lat_deg", "lon_deg", "elevation_m", "geoid_m"])
        for point in (p for t in gpxpy.parse(text).tracks for s in t.segments for p in s.points):
            gps = "" if point.time is None else repr((point.time - GPS_EPOCH).total_seconds() + LEAP_SECONDS)
            values = [point.latitude, point.longitude, point.elevation, point.geoid_height]
            writer.writerow([gps, *("" if value is None else repr(value) for value in values)])


# Across the end of GPS week 2374, on Saturday 2025-07-12 at 23:59:42 UTC.
start = datetime.datetime(2025, 7, 12, 23, 59, 12, tzinfo=datetime.timezone.utc)
text = track(start, 60).to_xml(version="1.1")
(HERE / "track.gpx").write_text(text)
table("points.csv", text)
# The same in GPX 1.0, with the times of a zone.
text = track(start.astimezone(datetime.timezone(datetime.timedelta(hours=-3, minutes=-30))), 60).to_xml(version="1.0")
(HERE / "track10.gpx").write_text(text)
