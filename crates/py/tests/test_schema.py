"""The published schemas take every example file and every documented table, and no misspelled key."""

import copy
import json
import sys
from pathlib import Path

import pytest

jsonschema = pytest.importorskip("jsonschema")
if sys.version_info >= (3, 11):
    import tomllib
else:
    tomllib = pytest.importorskip("tomli")

ROOT = Path(__file__).parents[3]
DRIVES = sorted(path for path in (ROOT / "examples").glob("*.toml") if "montecarlo" not in path.name)
MODELS = sorted((ROOT / "crates/noise/presets").glob("*.toml"))


def schema(name):
    return json.loads((ROOT / f"docs/schema/{name}.schema.json").read_text())


def drive_validator():
    # The inline model of a drive file refers to the model file's schema.
    referencing = pytest.importorskip("referencing")
    imu = referencing.Resource.from_contents(schema("imu"))
    registry = referencing.Registry().with_resource("imu.schema.json", imu)
    return jsonschema.Draft202012Validator(schema("drive"), registry=registry)


def problems(validator, document):
    return [error.message for error in validator.iter_errors(document)]


@pytest.mark.parametrize("path", DRIVES, ids=lambda path: path.name)
def test_drive_files_are_valid_and_a_misspelled_key_is_not(path):
    validator = drive_validator()
    document = tomllib.loads(path.read_text())
    assert problems(validator, document) == []
    for table in (name for name, value in document.items() if isinstance(value, dict)):
        wrong = copy.deepcopy(document)
        wrong[table]["tyme"] = "t_s"
        assert any("tyme" in problem for problem in problems(validator, wrong)) or table == "model"


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.name)
def test_model_files_are_valid_and_a_misspelled_key_is_not(path):
    validator = jsonschema.Draft202012Validator(schema("imu"))
    document = tomllib.loads(path.read_text())
    assert problems(validator, document) == []
    document["gyro"]["white_noize"] = "1 deg/sqrt(h)"
    assert any("white_noize" in problem for problem in problems(validator, document))


@pytest.mark.parametrize(
    ("page", "name"), [("drive-file.md", "drive"), ("imu-file.md", "imu")], ids=["drive", "imu"]
)
def test_the_files_of_the_documentation_are_valid(page, name):
    text = (ROOT / "docs" / page).read_text()
    first = text.split("```toml\n")[1].split("```")[0]
    validator = drive_validator() if name == "drive" else jsonschema.Draft202012Validator(schema("imu"))
    assert problems(validator, tomllib.loads(first)) == []
