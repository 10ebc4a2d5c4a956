"""Many logs, on one machine or on many: the same results, to the byte, as ``undrift fleet``.

A job is the JSON of what is to be done with one log; :func:`process_to` does it and keeps its result in a
folder. Whatever runs functions on machines can run it: Dask by :func:`run`, Ray, array jobs, Airflow
(``examples/fleet``).

Files and folders may be URLs that `fsspec` understands (``s3://…``, ``gs://…``). An input behind a URL is read
once; as long as its ETag, or its size and time of change, stay the same it is not read again.
"""

from __future__ import annotations

import dataclasses
import gzip
import hashlib
import io
import json
import os
import posixpath
import tempfile
import warnings
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from undrift import _fleet_inputs, _store, _undrift
from undrift._fleet_effects import Effects, effects
from undrift._fleet_progress import Lines
from undrift._result import Result, optional

if TYPE_CHECKING:
    from pandas import DataFrame
    from polars import DataFrame as PolarsFrame
    from pyarrow import Table

__all__ = [
    "Done",
    "Effects",
    "Fleet",
    "effects",
    "fingerprint",
    "gather",
    "jobs",
    "keep",
    "kept",
    "process",
    "process_to",
    "run",
]

#: What :func:`gather` makes.
_GATHERED = ("results.parquet", "fleet.json", "fleet.html")

#: About as many results are one object of ``packs/``.
_PACK = 500

#: As many tasks are with the scheduler for each thread of the workers.
_WAITING = 4


@dataclasses.dataclass(frozen=True)
class Done:
    """What :func:`process_to` did with a log."""

    #: The log.
    log: str
    #: Name of its result in ``jobs/``.
    fingerprint: str
    #: Whether it was processed, else its result was up to date.
    processed: bool
    #: Whether the result is that the log failed.
    failed: bool
    #: Whether the result that was there was damaged.
    damaged: bool


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Fleet(Result):
    """Result of many logs."""

    #: The folder of the results.
    output: str
    #: Logs that were worked out.
    processed: int
    #: Logs that were up to date.
    skipped: int
    #: Logs that failed; ``summary["failed"]`` has the reasons.
    failed: int
    #: Logs whose results were there but damaged, and were made again.
    damaged: tuple[str, ...]
    #: Logs whose workers died or could not read them again and again, and why: run again.
    lost: dict[str, str]
    #: ``fleet.json``.
    summary: dict[str, Any] = dataclasses.field(repr=False)

    def to_arrow(self) -> Table:
        """``results.parquet``: a row for each outage, bias model or axis of each log."""
        parquet = optional("pyarrow.parquet", "tables")
        content = _store.read(_store.join(self.output, "results.parquet"))
        table: Table = parquet.read_table(io.BytesIO(content))
        return table

    def to_pandas(self) -> DataFrame:
        """:meth:`to_arrow` as a data frame."""
        optional("pandas", "tables")
        frame: DataFrame = self.to_arrow().to_pandas()
        return frame

    def to_polars(self) -> PolarsFrame:
        """:meth:`to_arrow` as a ``polars.DataFrame``. Needs ``undrift[polars]`` too."""
        frame: PolarsFrame = optional("polars", "polars").from_arrow(self.to_arrow())
        return frame


def jobs(manifest: str | os.PathLike[str]) -> list[str]:
    """The jobs of a manifest, as JSON. Its patterns and tables are looked up where it lies."""
    name = os.fspath(manifest)
    try:
        read = partial(_store.read, name)
        content = _store.answered(name, read) if _store.is_url(name) else read()
    except OSError as error:
        raise _undrift.UndriftError(f"{name}: {error.strerror}") from error
    text = content.decode("utf-8")
    home = posixpath.dirname(name)
    lookups = _undrift.fleet_lookups(text, name)
    tables = [table for kind, table in lookups if kind == "text"]
    found: dict[tuple[str, str], list[str]] = {}
    if _store.is_url(name):
        found = _store.matching(home, [look for look in lookups if look[0] != "text"])
    for table in tables:
        if _store.is_url(name) or table.endswith(".parquet"):
            found["text", table] = [_fleet_inputs.table(_store.join(home, table))]
    return _undrift.fleet_jobs(text, name, home, found)


def fingerprint(job: str) -> str:
    """SHA-256 of all that the outcome of a job depends on: the contents of its files, the settings, the
    version of this package. The outcome is kept under it."""
    with _fleet_inputs.local(job) as (here, _):
        return _undrift.fleet_fingerprint(here)


def process(job: str, threads: int = 1) -> str:
    """The outcome of a job, as JSON: nothing but the job and the files that it names bears on it.

    A log that fails has an outcome too, with the reason. Inputs that cannot be fetched raise.
    """
    with _fleet_inputs.local(job) as (here, _):
        return _undrift.fleet_process(here, threads)


def process_to(
    job: str,
    output: str | os.PathLike[str],
    *,
    threads: int = 1,
    retry_failed: bool = False,
) -> Done:
    """Works a job out and keeps the outcome in a folder, unless an outcome that is up to date is kept there.

    This is all that a worker does with a log, on its own: any number of them may share the folder. Inputs behind
    URLs are read once, and only if they have changed since (``seen/`` remembers them). A log that fails has an
    outcome too; inputs that cannot be fetched, and an outcome that cannot be kept, raise.
    """
    folder = os.fspath(output)
    log = _log(job)

    def there_already(key: str) -> Done | None:
        """What is kept under a fingerprint; ``processed`` is whether it has to be."""
        content = _store.read_if_there(_kept_at(folder, key))
        if content is None:
            return None
        try:
            failed = _undrift.fleet_failed(content.decode())
        except ValueError:
            return Done(log, key, processed=True, failed=False, damaged=True)
        return Done(log, key, processed=failed and retry_failed, failed=failed, damaged=False)

    note = None
    if _fleet_inputs.is_remote(job):
        note = _store.join(folder, "seen", f"{hashlib.sha256(job.encode()).hexdigest()}.json")
        before = _store.answered(note, partial(_store.read_if_there, note))
        key = _fleet_inputs.unchanged(before)
        there = there_already(key) if key else None
        if there and not there.processed:
            return there
    with _fleet_inputs.local(job) as (here, tags):
        key = _undrift.fleet_fingerprint(here)
        there = there_already(key)
        if there is None or there.processed:
            outcome = _undrift.fleet_process(here, threads)
            keep(key, outcome, folder)
            failed = _undrift.fleet_failed(outcome)
            there = Done(log, key, True, failed, damaged=there is not None and there.damaged)
    if note:
        text = json.dumps({"fingerprint": key, "inputs": tags}, indent=1)
        _store.write(note, text.encode())
    return there


def keep(key: str, outcome: str, output: str | os.PathLike[str]) -> None:
    """Keeps the outcome of a job, whose fingerprint is ``key``, in a folder, whole or not at all."""
    _store.write(_kept_at(os.fspath(output), key), outcome.encode())


def kept(output: str | os.PathLike[str]) -> set[str]:
    """The fingerprints of the outcomes that are kept in a folder."""
    return {
        name.removesuffix(".json")
        for name in _store.names(_store.join(os.fspath(output), "jobs"))
        if name.endswith(".json") and not name.startswith(".")
    }


def gather(keys: Iterable[str], output: str | os.PathLike[str]) -> dict[str, Any]:
    """Makes ``results.parquet``, ``fleet.json`` and ``fleet.html`` of the outcomes kept in a folder under
    these fingerprints, in their order, each once; returns the summary.

    Outcomes pass through one by one. Behind a URL they are also put together in ``packs/`` of some hundred, so that
    gathering again reads only what is new.
    """
    order = list(dict.fromkeys(keys))
    folder = os.fspath(output)
    remote = _store.is_url(folder)
    with tempfile.TemporaryDirectory(prefix="undrift-fleet-") as here:
        if not remote:
            Path(folder).mkdir(parents=True, exist_ok=True)
        gathering = _undrift.FleetGathering(Path(here if remote else folder))
        packs = set(_store.names(_store.join(folder, "packs"))) if remote else set()
        for group in _groups(order):
            outcomes = _pack(group, folder, packs) if remote else _each(group, folder)
            for key, outcome in zip(group, outcomes, strict=True):
                gathering.add(key, outcome)
        summary: dict[str, Any] = json.loads(gathering.finish())
        for name in _GATHERED if remote else ():
            _store.write(_store.join(folder, name), Path(here, name).read_bytes())
    return summary


def run(
    client: Any,
    manifest: str | os.PathLike[str],
    output: str | os.PathLike[str],
    *,
    retries: int = 3,
    progress: bool | Callable[[int, int], None] = True,
    retry_failed: bool = False,
    threads: int = 1,
) -> Fleet:
    """Works a manifest's logs out on the workers of a ``dask.distributed.Client``.

    Each log is one task, :func:`process_to`: its worker reads it and keeps its result in ``output``, and a run that
    ends goes on where it was. A log is done again, on another worker, when its worker dies or its inputs cannot be
    read, ``retries`` times. The scheduler has only a few tasks for each thread at a time.

    ``threads`` are those of one log; Dask decides how many logs a worker has at a time. ``progress`` is shown as lines
    on standard error, or given to a function of the numbers done and to do. Workers and this process must see
    the manifest's files and ``output`` under the same names.
    """
    distributed = optional("distributed", "fleet")
    folder = os.fspath(output)
    if not _store.is_url(folder):
        folder = os.path.abspath(folder)
    tell: Any = progress if callable(progress) else Lines(bool(progress))
    if _store.is_url(folder):
        files, path = _store.system(folder)
        _store.answered(folder, lambda: files.exists(path))
    work = list(dict.fromkeys(jobs(manifest)))
    tell(0, len(work))
    keys: list[str | None] = [None] * len(work)
    lost: dict[str, str] = {}
    damaged: list[str] = []
    processed = count = 0
    waiting = iter(enumerate(work))
    places: dict[Any, int] = {}
    tasks = distributed.as_completed(loop=client.loop)

    def submit() -> None:
        room = _WAITING * max(1, sum(client.ncores().values())) - len(places)
        for _, (place, job) in zip(range(room), waiting, strict=False):
            task = client.submit(
                process_to,
                job,
                folder,
                threads=threads,
                retry_failed=retry_failed,
                retries=retries,
                pure=False,
            )
            places[task] = place
            tasks.add(task)

    submit()
    for task in tasks:
        place = places.pop(task)
        try:
            done: Done = task.result()
        except Exception as error:  # of a dead worker, or of any reader behind fsspec
            lost[_log(work[place])] = str(error) or repr(error)
        else:
            keys[place] = done.fingerprint
            processed += done.processed
            damaged += [done.log] * done.damaged
        task.release()
        count += 1
        tell(count, len(work))
        submit()
    for trouble, names in (
        ("were lost, run again", list(lost)),
        ("had damaged results that were replaced", damaged),
    ):
        if names:
            listed = ", ".join(names[:10]) + (", …" if len(names) > 10 else "")
            warnings.warn(f"{len(names)} logs {trouble}: {listed}", stacklevel=2)
    summary = gather((key for key in keys if key is not None), folder)
    return Fleet(
        output=folder,
        processed=processed,
        skipped=len(work) - processed - len(lost),
        failed=len(summary["failed"]),
        damaged=tuple(damaged),
        lost=lost,
        summary=summary,
    )


def _kept_at(folder: str, key: str) -> str:
    return _store.join(folder, "jobs", f"{key}.json")


def _log(job: str) -> str:
    _undrift.fleet_inputs(job)  # refuses what is no job
    name: str = json.loads(job)["log"]
    return name


def _groups(order: list[str]) -> Iterator[list[str]]:
    """Keys in groups of some hundred. Where a group ends depends on its last key: one that is inserted changes one
    group."""
    group: list[str] = []
    for key in order:
        group.append(key)
        if int(key[:8], 16) % _PACK == 0 or len(group) == 4 * _PACK:
            yield group
            group = []
    if group:
        yield group


def _each(group: list[str], folder: str) -> Iterator[str]:
    """The outcomes, one by one."""
    for key in group:
        try:
            yield _store.read(_kept_at(folder, key)).decode()
        except FileNotFoundError as error:
            raise _undrift.UndriftError(f"no result is kept under {key}; run again") from error


def _pack(group: list[str], folder: str, packs: set[str]) -> list[str]:
    """The outcomes of a group behind a URL: of its pack, which is made if there is none."""
    name = hashlib.sha256("\n".join(group).encode()).hexdigest() + ".json.gz"
    at = _store.join(folder, "packs", name)
    if name in packs:
        try:
            outcomes: list[str] = json.loads(gzip.decompress(_store.read(at)))
            return outcomes
        except (OSError, EOFError, ValueError):
            pass  # damaged: it is made again
    files, path = _store.system(folder)
    paths = [_kept_at(path, key) for key in group]
    try:
        # Many requests at a time.
        found = files.cat(paths) if len(paths) > 1 else {paths[0]: files.cat_file(paths[0])}
    except FileNotFoundError as error:
        raise _undrift.UndriftError(f"{folder}: {error}; run again") from error
    outcomes = [found[one].decode() for one in paths]
    _store.write(at, gzip.compress(json.dumps(outcomes).encode(), 6, mtime=0))
    return outcomes
