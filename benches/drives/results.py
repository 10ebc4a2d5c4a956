"""Writes what the judge found on a drive in undrift's schema of results, kind `outages`: models are the filters, `undrift report` shows it."""

import json
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
COMPONENTS = ["north_m", "east_m", "down_m", "vn_mps", "ve_mps", "vd_mps", "yaw_deg", "horizontal_m"]
TRACK = 2000


def number(value, digits=6):
    """A number rounded; what is not finite is missing."""
    return float(f"{value:.{digits}g}") if np.isfinite(value) else None


def numbers(values):
    """By component, without those that are missing."""
    return {name: number(value) for name, value in zip(COMPONENTS, values) if np.isfinite(value)}


def track(time, latitude, longitude):
    def rounded(values):
        return [number(value, 12) for value in values]

    return {"time_s": rounded(time), "lat_deg": rounded(np.degrees(latitude)), "lon_deg": rounded(np.degrees(longitude))}


def rms(values):
    return np.sqrt(np.mean(np.square(values), axis=0))


def model(about, judged):
    """Errors of a filter by outage and over all, the drift since the cut, its way. Lost, it has a horizontal error only."""
    per_outage, largest, ends, since, drift, way = [], [], [], [], [], []
    for outage in about["outages"]:
        passed = judged.get(outage["pass"])
        if passed is None or not outage["count"]:
            continue
        rows = slice(outage["at"], outage["at"] + outage["count"])
        errors = passed["errors"][rows]
        largest.append(np.abs(errors).max(0))
        ends.append(np.abs(errors[-1]))
        since.append(passed["time"][rows] - outage["begin"])
        drift.append(errors[:, -1])
        way.append(passed["place"][rows])
        sigma = numbers(passed["sigma"][rows][-1])
        per_outage.append({"start_s": outage["begin"], "max": numbers(largest[-1]), "end": numbers(ends[-1]), "sigma": sigma, "nees": {}})
    order = np.argsort([outage["start_s"] for outage in per_outage])
    scaled = np.concatenate([passed["scaled"].ravel() for passed in judged.values()])
    scaled = scaled[np.isfinite(scaled)]
    largest, ends = np.array(largest), np.array(ends)
    found = {
        "max": numbers(largest.max(0)), "rms": numbers(rms(largest)), "median": numbers(np.median(largest, axis=0)),
        "end_rms": numbers(rms(ends)), "nees": {},
        "inside_sigma": {"position": [number(np.mean(scaled <= k)) for k in (1, 2, 3)]} if len(scaled) else {},
        "left_out": 0, "per_outage": [per_outage[at] for at in order],
    }
    since, drift = np.round(np.concatenate(since)), np.concatenate(drift)
    seconds = np.unique(since)
    curve = {"since_cut_s": seconds.tolist(), "horizontal_rms_m": [number(rms(drift[since == s])) for s in seconds]}
    return found, curve, np.concatenate([way[at] for at in order])


def write(path, version, folder, name, filters, fixes, lost_m):
    """`filters`: by title, what was judged by pass, and why passes could not be run. Checked against the schema."""
    import jsonschema

    about = json.loads((folder / name / "drive.json").read_text())
    run = {title: judged for title, (judged, _) in filters.items() if judged}
    result = {
        "undrift": version, "kind": "outages", "schema": 1,
        "drive": {"file": name, "imu": "imu.csv", "gnss": "gnss.csv", "truth": None, "odometer": None, "barometer": None,
                  "rate_hz": number(about["rate_hz"]), "model": None},
        "outages": [{"start_s": o["begin"], "length_s": o["length"]} for o in sorted(about["outages"], key=lambda o: o["begin"]) if o["count"]],
        "order": list(run), "models": {},
        "failed": {title: (f"{len(faults)} of {about['passes']} passes: " if judged else "") + "; ".join(dict.fromkeys(faults))
                   for title, (judged, faults) in filters.items() if faults},
        "reference": "truth" if about["truth"] else "gnss", "smooth": False, "nis_per_dof": {}, "findings": [], "warnings": [],
        "series": {"track": track(*fixes[:: max(1, len(fixes) // TRACK), :3].T), "drift": {}, "ways": {}},
    }
    for title, judged in run.items():
        found, curve, way = model(about, judged)
        result["models"][title], result["series"]["drift"][title] = found, curve
        # A way that is lost would only make the map small.
        if found["max"]["horizontal_m"] < lost_m:
            result["series"]["ways"][title] = track(*way[::5].T)
    schema = json.loads((ROOT / "docs/schema/results.schema.json").read_text())
    # The kind alone: the union of all would only say that none fits.
    jsonschema.validate(result, {"$schema": schema["$schema"], "$ref": "#/$defs/outages", "$defs": schema["$defs"]})
    path.write_text(json.dumps(result))
