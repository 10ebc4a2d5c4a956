"""ZIP archives by Python's zipfile: one log deflated beside what macOS adds and a folder, one stored, two logs."""
import zipfile

LOG = "".join(f"{k},0.5,-9.8\n" for k in range(50))
for name, method, others in [
    ("deflated.zip", zipfile.ZIP_DEFLATED, ["logs/", "__MACOSX/logs/._imu.csv"]),
    ("stored.zip", zipfile.ZIP_STORED, []),
    ("two.zip", zipfile.ZIP_DEFLATED, ["gnss.csv"]),
]:
    with zipfile.ZipFile(name, "w", method) as archive:
        for member, text in [(other, "" if other.endswith("/") else "x") for other in others] + [("logs/imu.csv", LOG)]:
            archive.writestr(zipfile.ZipInfo(member, (2026, 1, 1, 0, 0, 0)), text, method)
