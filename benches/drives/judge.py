"""Judges the answers of all filters against the withheld fixes or the exact track."""

import json
from pathlib import Path

import numpy as np
import results

RADIUS, LOST, DRAWS = 6378137.0, 1000.0, 2000
HORIZONS = (10.0, 30.0, 60.0)


def lines(path):
    """Lines that are neither blank nor comment nor the module's text."""
    text = Path(path).read_text()
    if path.suffix == ".py":
        text = text.split('"""', 2)[2]
    kept = [line.strip() for line in text.splitlines()]
    return sum(1 for line in kept if line and not line.startswith(("#", "//")))


def rows(path, columns):
    return np.fromfile(path, dtype="<f8").reshape(-1, columns) if path.exists() else np.empty((0, columns))


def compare(answer, reference):
    """Of every withheld fix: time, place, errors (`results.COMPONENTS`; a lost horizontal one is LOST), standard deviations, north and east
    errors in standard deviations."""
    full = np.full((len(reference), 11), np.nan)
    full[: len(answer)] = answer[: len(reference)]
    late = reference[:, 0] - full[:, 0]
    errors = np.full((len(reference), 8), np.nan)
    north = RADIUS * (full[:, 1] - reference[:, 1]) + full[:, 4] * late
    east = RADIUS * (full[:, 2] - reference[:, 2]) * np.cos(reference[:, 1]) + full[:, 5] * late
    drift = np.hypot(north, east)
    lost = ~np.isfinite(drift) | (np.abs(late) > 0.5) | (drift > LOST)
    errors[:, 0], errors[:, 1], errors[:, 2] = north, east, reference[:, 3] - full[:, 3]
    errors[:, 3:6] = full[:, 4:7] - reference[:, 4:7]
    errors[:, 6] = np.degrees((full[:, 10] - reference[:, 13] + np.pi) % (2 * np.pi) - np.pi)
    errors[lost, :6] = np.nan
    errors[:, 7] = np.where(lost, LOST, drift)
    place = np.column_stack([reference[:, 0], full[:, 1:3]])
    scaled = np.abs(np.column_stack([north, east])) / np.hypot(full[:, 7:9], reference[:, 7:9])
    return {"time": reference[:, 0], "place": place, "errors": errors, "sigma": full[:, 7:10], "scaled": scaled}


def errors(folder, name, title, answers):
    """Of each pass what `compare` gives; faults; CPU time of a sample [us]."""
    about = json.loads((folder / name / "drive.json").read_text())
    judged, faults, cpu = {}, [], []
    for number in range(about["passes"]):
        out = answers / f"{title.replace(', ', '_').replace(' ', '-')}.{name}.{number}"
        record = out.with_suffix(out.suffix + ".json")
        if not record.exists():
            continue
        record = json.loads(record.read_text())
        if "fault" in record:
            faults.append(record["fault"])
            continue
        cpu.append(record["cpu_s"])
        judged[number] = compare(rows(out, 11), rows(folder / name / f"reference{number}.f64", 14))
    return judged, faults, (np.mean(cpu) / about["samples"] * 1e6 if cpu else np.nan)


def at_horizons(about, judged):
    """Of each window and horizon: horizontal error [m], north and east error in standard deviations, yaw error [rad]."""
    found = {}
    for window in about["windows"]:
        of = judged.get(window["pass"])
        if of is not None:
            at = window["at"]
            error = of["errors"][at]
            found[window["pass"], window["begin"], window["horizon"]] = (float(error[7]), *of["scaled"][at], np.radians(error[6]))
    return found


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def pooled_ratio(one, other, horizon, random):
    """Geometric mean over drives of the ratio of RMS drifts, windows that both have; 95 % interval, drives, windows."""
    pairs = []
    for name in one:
        keys = [key for key in one[name] if key[2] == horizon and key in other.get(name, {})]
        if keys:
            pairs.append((np.array([one[name][key][0] for key in keys]), np.array([other[name][key][0] for key in keys])))
    if not pairs:
        return None

    def ratio(draw):
        logs = []
        for mine, theirs in pairs:
            at = random.integers(0, len(mine), len(mine)) if draw else slice(None)
            logs.append(0.5 * np.log(np.mean(theirs[at] ** 2 + 1e-4) / np.mean(mine[at] ** 2 + 1e-4)))
        return np.exp(np.mean(logs))

    spread = np.percentile([ratio(True) for _ in range(DRAWS)], [2.5, 97.5])
    return {"ratio": float(ratio(False)), "low": float(spread[0]), "high": float(spread[1]), "drives": len(pairs),
            "windows": int(sum(len(mine) for mine, _ in pairs))}


def cells(values):
    return f"| {' | '.join(values)} |"


def group(name):
    """Drives of one vehicle and sensor share a column."""
    for kind in ("ublox", "wid"):
        if name.startswith(kind):
            return kind
    return name


def judge(folder, answers, drives, filters, version, out, figure):
    """Prints the tables; leaves in `out` a result of each drive, as `undrift report` reads it, and all numbers in `folder`/all.json."""
    titles = [title for title, _, _ in filters]
    all_found = {title: {} for title in titles}
    by_drive = {name: {} for name in drives}
    known = {name: json.loads((folder / name / "drive.json").read_text()) for name in drives}
    result = {"format": "undrift-drives", "version": 1, "filters": {}, "ratios": {}}
    for title, count, _ in filters:
        entry = {"lines": count, "drives": {}}
        for name in drives:
            judged, faults, cpu = errors(folder, name, title, answers)
            if not judged and not faults:
                continue
            by_drive[name][title] = judged, faults
            found = at_horizons(known[name], judged)
            row = {"fault": faults[0] if faults else None, "cpu_us": None if np.isnan(cpu) else round(float(cpu), 2), "horizons": {}}
            if found:
                all_found[title][name] = found
            for horizon in HORIZONS:
                of = [value for key, value in found.items() if key[2] == horizon]
                if not of:
                    continue
                scaled = np.array([value[1:3] for value in of]).ravel()
                scaled = scaled[np.isfinite(scaled)]
                yaws = [value[3] for value in of if np.isfinite(value[3])]
                row["horizons"][f"{horizon:.0f}"] = {
                    "windows": len(of), "rms_m": rms([value[0] for value in of]), "median_m": float(np.median([value[0] for value in of])),
                    "lost": sum(value[0] >= LOST for value in of),
                    "inside": [float(np.mean(scaled <= k)) for k in (1, 2, 3)] if len(scaled) else None,
                    "yaw_deg": float(np.degrees(rms(yaws))) if yaws else None,
                }
            entry["drives"][name] = row
        result["filters"][title] = entry
    for horizon in HORIZONS:
        key = f"{horizon:.0f}"
        print(f"\nRMS drift at {key} s [m]; ublox, wid: geometric mean of their drives\n")
        have = [name for name in drives if any(key in entry["drives"].get(name, {}).get("horizons", {}) for entry in result["filters"].values())]
        groups = list(dict.fromkeys(map(group, have)))
        print(cells(["filter", *groups]))
        print(cells(["---"] * (len(groups) + 1)))
        for title, entry in result["filters"].items():
            if not entry["drives"]:
                continue
            values = []
            for of in groups:
                names = [name for name in have if group(name) == of]
                at = [entry["drives"][name]["horizons"].get(key) for name in names if name in entry["drives"]]
                at = [row for row in at if row]
                mean = np.exp(np.mean([np.log(max(row["rms_m"], 0.01)) for row in at])) if at else np.nan
                lost = sum(row["lost"] for row in at)
                values.append(
                    (f"{mean:.3g}" + (f", {lost} lost" if lost else "") + (f" ({len(at)} of {len(names)})" if len(at) < len(names) else ""))
                    if at else "–"
                )
            print(cells([title, *values]))
    print("\nAll drives together\n")
    print(cells(["filter", "drives", "windows", "pooled 10 s", "30 s", "60 s [m]", "lost", "inside 1, 2, 3 σ at 30 s", "yaw at 30 s [°]", "CPU [µs a sample]", "lines"]))
    print(cells(["---"] * 11))
    for title, entry in result["filters"].items():
        if not any(row["horizons"] for row in entry["drives"].values()):
            continue
        pooled, lost, shares, yaws = [], 0, [], []
        for horizon in HORIZONS:
            of = [row["horizons"][f"{horizon:.0f}"] for row in entry["drives"].values() if f"{horizon:.0f}" in row["horizons"]]
            pooled.append(float(np.exp(np.mean([np.log(max(at["rms_m"], 0.01)) for at in of]))) if of else np.nan)
            lost += sum(at["lost"] for at in of)
            if horizon == 30.0:
                shares = [(at["inside"], at["windows"]) for at in of if at["inside"]]
                yaws = [at["yaw_deg"] for at in of if at["yaw_deg"] is not None]
        inside = np.average([s for s, _ in shares], axis=0, weights=[n for _, n in shares]) if shares else None
        ran = [row for row in entry["drives"].values() if row["horizons"]]
        entry["pooled_m"], entry["inside"] = pooled, None if inside is None else [float(x) for x in inside]
        entry["lost"] = lost
        cpu = [row["cpu_us"] for row in ran]
        print(cells([title, str(len(ran)), str(sum(row["horizons"]["10"]["windows"] for row in ran if "10" in row["horizons"])),
                     *(f"{value:.3g}" for value in pooled), str(lost), " ".join(f"{x:.2f}" for x in inside) if inside is not None else "–",
                     f"{np.mean(yaws):.2g}" if yaws else "–", f"{np.median(cpu):.3g}", str(entry["lines"])]))
    print("\nDrift of a filter over that of ours, same windows\n")
    random = np.random.default_rng(1)
    print(cells(["filter", "against", "10 s", "30 s", "60 s", "drives", "windows at 10 s"]))
    print(cells(["---"] * 7))
    for title in titles:
        for ours in titles[:2]:
            if title == ours or not all_found[title] or not all_found[ours]:
                continue
            found = [pooled_ratio(all_found[ours], all_found[title], horizon, random) for horizon in HORIZONS]
            if found[0] is None:
                continue
            result["ratios"].setdefault(title, {})[ours] = found
            print(cells([title, ours, *(f"{f['ratio']:.2f} ({f['low']:.2f} to {f['high']:.2f})" if f else "–" for f in found),
                         str(found[0]["drives"]), str(found[0]["windows"])]))
    print("\nNot run\n")
    for title, entry in result["filters"].items():
        reasons = {}
        for name, row in entry["drives"].items():
            if row["fault"]:
                reasons.setdefault(row["fault"], []).append(name)
        for reason, names in reasons.items():
            print(f"* {title}: {', '.join(names)}: {reason}")
    (folder / "all.json").write_text(json.dumps(result, indent=1))
    out.mkdir(parents=True, exist_ok=True)
    for name, filters in by_drive.items():
        if filters:
            results.write(out / f"{name}.json", version, folder, name, filters, rows(folder / name / "gnss.f64", 13), LOST)
    if figure:
        draw(result, figure)


def draw(result, path):
    """Pooled drift of all filters, a dot for each length."""
    import matplotlib

    matplotlib.use("svg")
    from matplotlib import pyplot

    shown = {title: entry for title, entry in result["filters"].items() if "pooled_m" in entry}
    figure, axes = pyplot.subplots(figsize=(8, 0.32 * len(shown) + 1.2))
    for at, (title, entry) in enumerate(reversed(shown.items())):
        for value, colour in zip(entry["pooled_m"], ("#2a7", "#27a", "#a42")):
            axes.plot(value, at, "o", color=colour, markersize=7 if title.startswith("undrift") else 5)
    axes.set_yticks(range(len(shown)), list(reversed(shown)))
    axes.set_xscale("log")
    axes.set_xlabel("geometric mean over the drives of the RMS drift at 10 (green), 30 (blue), 60 s (red) [m]")
    axes.grid(axis="x", alpha=0.3)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
