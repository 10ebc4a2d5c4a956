"""The inputs of a job: which they are, whether they have changed, and their copies on this machine."""

from __future__ import annotations

import csv
import io
import json
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from undrift import _store, _undrift
from undrift._result import optional


def table(name: str) -> str:
    """A table of logs as comma-separated text."""
    content = _store.read(name)
    if not name.endswith(".parquet"):
        return content.decode("utf-8")
    table = optional("pyarrow.parquet", "tables").read_table(io.BytesIO(content))
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(table.column_names)
    columns = (column.to_pylist() for column in table.columns)
    # None is an empty field.
    rows.writerows(zip(*columns, strict=True))
    return text.getvalue()


def folders(job: str) -> tuple[dict[str, Any], str, str | None]:
    """A job, its folder and that of its data."""
    fields = json.loads(job)
    folder, data = fields["folder"], fields["data"]
    if data is not None and not _store.is_url(data) and _store.is_url(folder):
        data = _store.join(folder, data)
    return fields, folder, data


def is_remote(job: str) -> bool:
    _, folder, data = folders(job)
    return _store.is_url(folder) or (data is not None and _store.is_url(data))


def unchanged(note: bytes | None) -> str | None:
    """The fingerprint that was noted of a job, if its inputs are what they were."""
    try:
        seen = json.loads(note or b"")
        key: str = seen["fingerprint"]
        inputs: dict[str, str | None] = seen["inputs"]
    except (ValueError, KeyError, TypeError):
        return None
    same = all(was != "" and _store.tag(url) == was for url, was in inputs.items())
    return key if same else None


@contextmanager
def local(job: str) -> Iterator[tuple[str, dict[str, str | None]]]:
    """The job with its files on this machine: those of URLs are fetched for as long as it lasts. With it, the
    :func:`_store.tag` of each of these."""
    _undrift.fleet_inputs(job)  # refuses what is no job
    fields, folder, data = folders(job)
    tags: dict[str, str | None] = {}
    if not is_remote(job):
        yield job, tags
        return
    with tempfile.TemporaryDirectory(prefix="undrift-fleet-") as here:
        roots: list[tuple[Path, str]] = []
        for key, url in (("folder", folder), ("data", data)):
            if url is not None and _store.is_url(url):
                root = Path(here, key)
                roots.append((root, url))
                fields[key] = str(root)
            elif key == "data" and url is not None:
                fields[key] = os.path.abspath(os.path.join(folder, url))
        there = json.dumps(fields)
        # The drive file first: it names the others.
        for _ in range(2):
            for _key, path in _undrift.fleet_inputs(there):
                fetch(path, roots, tags)
        yield there, tags


def fetch(path: Path, roots: list[tuple[Path, str]], tags: dict[str, str | None]) -> None:
    """Fetches a file below one of the roots, if it is there; others are here already."""
    for root, url in roots:
        if not path.is_relative_to(root):
            continue
        name = path.relative_to(root).as_posix()
        if ".." in name.split("/"):
            raise _undrift.UndriftError(f"{url}/{name}: names in URLs have no ..")
        at = _store.join(url, name)
        if at in tags:
            return
        # Before the contents: what changes in between is read again next time.
        ask = partial(_store.tag, at)
        tags[at] = ask() if tags else _store.answered(at, ask)
        if tags[at] is not None:
            files, there = _store.system(at)
            path.parent.mkdir(parents=True, exist_ok=True)
            files.get_file(there, str(path))
        return
    tags[str(path)] = _store.tag(str(path))
