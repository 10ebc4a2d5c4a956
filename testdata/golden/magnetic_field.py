"""Golden values of the World Magnetic Model 2025 for crates/nav/tests/it/magnetic.rs, by pygeomag.

python3 -m venv venv && venv/bin/pip install pygeomag==1.1.0 && venv/bin/python testdata/golden/magnetic_field.py

Columns: latitude [deg], longitude [deg], height above the ellipsoid [km], year; field north, east, down [nT].
"""

import pathlib

from pygeomag import GeoMag

model = GeoMag(coefficients_file="wmm/WMM_2025.COF")
places = [
    (80.0, 0.0, 0.0, 2025.0),
    (0.0, 120.0, 0.0, 2025.0),
    (-80.0, 240.0, 0.0, 2025.0),
    (80.0, 0.0, 100.0, 2025.0),
    (0.0, 120.0, 100.0, 2027.5),
    (-80.0, 240.0, 100.0, 2027.5),
    (47.4, 8.5, 0.5, 2026.9),
    (-37.9, 144.8, 0.02, 2029.3),
    (39.84, -105.2, 1.8, 2025.0),
    (-26.0, -54.0, 0.1, 2028.0),
    (64.0, -21.0, 11.0, 2026.0),
    (1.3, 103.8, 0.0, 2029.9),
]
rows = ["lat_deg,lon_deg,height_km,year,north_nt,east_nt,down_nt"]
for lat, lon, height, year in places:
    at = model.calculate(glat=lat, glon=lon, alt=height, time=year)
    rows.append(f"{lat},{lon},{height},{year},{at.x:.3f},{at.y:.3f},{at.z:.3f}")
pathlib.Path(__file__).with_suffix(".csv").write_text("\n".join(rows) + "\n")
