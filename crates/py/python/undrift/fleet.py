"""Many logs, on one machine or on many: the same results, to the byte, as ``undrift fleet``.

A job is the JSON of what is to be done with one log; :func:`process` is a pure function of it and of the
files that it names. Whatever runs functions on machines can run it: Dask by :func:`run`, Ray by
``ray.remote(undrift.fleet.process)``, Slurm by ``undrift fleet --shard``.

Files and folders may be URLs that `fsspec` understands (``s3://…``, ``gs://…``): inputs are fetched to
the machine that needs them.
"""

from __future__ import annotations

import dataclasses
import json
import os
import posixpath
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from undrift import _undrift
from undrift._result import Result, optional

if TYPE_CHECKING:
    from pandas import DataFrame
    from pyarrow import Table

__all__ = ["Fleet", "fingerprint", "gather", "jobs", "keep", "kept", "process", "run"]

#: What :func:`gather` makes.
_GATHERED = ("results.parquet", "fleet.json", "fleet.html")


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
    #: Logs whose workers died or could not read them again and again, and why: run again.
    lost: dict[str, str]
    #: ``fleet.json``.
    summary: dict[str, Any] = dataclasses.field(repr=False)

    def to_arrow(self) -> Table:
        """``results.parquet``: a row for each outage, bias model or axis of each log."""
        parquet = optional("pyarrow.parquet", "tables")
        with _open(posixpath.join(self.output, "results.parquet")) as file:
            table: Table = parquet.read_table(file)
            return table

    def to_pandas(self) -> DataFrame:
        """:meth:`to_arrow` as a data frame."""
        optional("pandas", "tables")
        frame: DataFrame = self.to_arrow().to_pandas()
        return frame


def jobs(manifest: str | os.PathLike[str]) -> list[str]:
    """The jobs of a manifest, as JSON. Its patterns are looked up where it lies."""
    name = os.fspath(manifest)
    if not _is_url(name):
        try:
            text = Path(name).read_text(encoding="utf-8")
        except OSError as error:
            raise _undrift.UndriftError(f"{name}: {error.strerror}") from error
        return _undrift.fleet_jobs(text, name, os.path.dirname(name), None)
    system, path = _system(name)
    text = system.cat_file(path).decode("utf-8")
    home = posixpath.dirname(path)
    found = {
        pattern: sorted(
            posixpath.relpath(match, home)
            for match in system.glob(posixpath.join(home, pattern))
            if system.isfile(match)
        )
        for pattern in _undrift.fleet_patterns(text, name)
    }
    return _undrift.fleet_jobs(text, name, posixpath.dirname(name), found)


def fingerprint(job: str) -> str:
    """SHA-256 of all that the outcome of a job depends on: the contents of its files, the settings, the
    version of this package. The outcome is kept under it."""
    with _local(job) as here:
        return _undrift.fleet_fingerprint(here)


def process(job: str, threads: int = 1) -> str:
    """The outcome of a job, as JSON: nothing but the job and the files that it names bears on it.

    A log that fails has an outcome too, with the reason. Inputs that cannot be fetched raise.
    """
    with _local(job) as here:
        return _undrift.fleet_process(here, threads)


def keep(key: str, outcome: str, output: str | os.PathLike[str]) -> None:
    """Keeps the outcome of a job, whose fingerprint is ``key``, in a folder, whole or not at all."""
    folder = posixpath.join(os.fspath(output), "jobs")
    name = f"{key}.json"
    if _is_url(folder):
        system, path = _system(folder)
        system.makedirs(path, exist_ok=True)
        # An object appears when it is whole.
        system.pipe_file(posixpath.join(path, name), outcome.encode())
        return
    Path(folder).mkdir(parents=True, exist_ok=True)
    part = Path(folder, f".{name}.part{os.getpid()}")
    with open(part, "wb") as file:
        file.write(outcome.encode())
        file.flush()
        os.fsync(file.fileno())
    os.replace(part, Path(folder, name))


def kept(output: str | os.PathLike[str]) -> set[str]:
    """The fingerprints of the outcomes that are kept in a folder."""
    folder = posixpath.join(os.fspath(output), "jobs")
    if _is_url(folder):
        system, path = _system(folder)
        system.invalidate_cache()
        there = system.ls(path, detail=False) if system.isdir(path) else []
    else:
        there = os.listdir(folder) if os.path.isdir(folder) else []
    names = (posixpath.basename(name) for name in there)
    return {
        name.removesuffix(".json")
        for name in names
        if name.endswith(".json") and not name.startswith(".")
    }


def gather(keys: Iterable[str], output: str | os.PathLike[str]) -> dict[str, Any]:
    """Makes ``results.parquet``, ``fleet.json`` and ``fleet.html`` of the outcomes kept in a folder under
    these fingerprints, in their order, each once; returns the summary."""
    order = list(dict.fromkeys(keys))
    folder = os.fspath(output)
    if not _is_url(folder):
        Path(folder, "jobs").mkdir(parents=True, exist_ok=True)
        summary: dict[str, Any] = json.loads(_undrift.fleet_gather(order, folder))
        return summary
    system, path = _system(folder)
    with tempfile.TemporaryDirectory(prefix="undrift-fleet-") as here:
        Path(here, "jobs").mkdir()
        for name in (f"{one}.json" for one in order):
            system.get_file(posixpath.join(path, "jobs", name), str(Path(here, "jobs", name)))
        summary = json.loads(_undrift.fleet_gather(order, here))
        for name in _GATHERED:
            system.put_file(str(Path(here, name)), posixpath.join(path, name))
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

    What is kept in ``output`` is skipped. Every outcome is kept as soon as it is complete, so that a run
    that ends goes on where it was. A log is done again, on another worker, when its worker dies or its
    inputs cannot be read, ``retries`` times; its outcome counts once, whichever worker computed it.

    ``threads`` are those of one log; Dask decides how many logs a worker has at a time. ``progress`` is
    told on the terminal, or to a function of the numbers done and to do. The workers must see the
    manifest's files under the same names; ``output`` is written from here.
    """
    distributed = optional("distributed", "fleet")
    work = jobs(manifest)
    lost: dict[str, str] = {}
    # Each job once, in the manifest's order.
    order: dict[str, str] = {}
    looked = client.map(fingerprint, work, pure=False, retries=retries)
    for job, future in zip(work, looked, strict=True):
        try:
            order.setdefault(future.result(), job)
        except Exception as error:  # of a dead worker, or of any reader behind fsspec
            lost[_log(job)] = str(error) or repr(error)
    done = kept(output).intersection(order)
    if retry_failed:
        done -= _failures(done, output)
    futures = {
        client.submit(process, job, threads, key=f"undrift-{key}", retries=retries, pure=True): key
        for key, job in order.items()
        if key not in done
    }
    told = _told(progress)
    told(0, len(futures))
    processed = 0
    for count, future in enumerate(distributed.as_completed(list(futures)), start=1):
        key = futures[future]
        try:
            outcome = future.result()
        except Exception as error:
            lost[_log(order[key])] = str(error) or repr(error)
        else:
            keep(key, outcome, output)
            done.add(key)
            processed += 1
        # Dask forgets the outcome: it need not stay in the workers' memory.
        future.release()
        told(count, len(futures))
    if lost:
        names = ", ".join(lost)
        warnings.warn(f"{len(lost)} logs were lost, run again: {names}", stacklevel=2)
    summary = gather((key for key in order if key in done), output)
    return Fleet(
        output=os.fspath(output),
        processed=processed,
        skipped=len(order) - len(futures),
        failed=len(summary["failed"]),
        lost=lost,
        summary=summary,
    )


def _failures(keys: Iterable[str], output: str | os.PathLike[str]) -> set[str]:
    """Those of the outcomes that are failures."""
    failures = set()
    for key in keys:
        with _open(posixpath.join(os.fspath(output), "jobs", f"{key}.json")) as file:
            if json.load(file)["failed"] is not None:
                failures.add(key)
    return failures


def _told(progress: bool | Callable[[int, int], None]) -> Callable[[int, int], None]:
    if callable(progress):
        return progress
    if not progress or not sys.stderr.isatty():
        return lambda done, all_: None

    def tell(done: int, all_: int) -> None:
        end = "\n" if done == all_ else ""
        print(f"\r{done} of {all_} logs", end=end, file=sys.stderr, flush=True)

    return tell


def _log(job: str) -> str:
    name: str = json.loads(job)["log"]
    return name


def _is_url(name: str) -> bool:
    return "://" in name or "::" in name


def _system(url: str) -> tuple[Any, str]:
    """The file system of a URL and the path in it."""
    core = optional("fsspec.core", "fleet")
    system, path = core.url_to_fs(url)
    return system, path


def _open(name: str) -> Any:
    if not _is_url(name):
        return open(name, "rb")
    system, path = _system(name)
    return system.open(path, "rb")


@contextmanager
def _local(job: str) -> Iterator[str]:
    """The job with its files on this machine: those of URLs are fetched for as long as it lasts."""
    _undrift.fleet_inputs(job)  # refuses what is no job
    fields = json.loads(job)
    folder, data = fields["folder"], fields["data"]
    if data is not None and not _is_url(data) and _is_url(folder):
        data = posixpath.join(folder, data)
    if not (_is_url(folder) or (data is not None and _is_url(data))):
        yield job
        return
    with tempfile.TemporaryDirectory(prefix="undrift-fleet-") as here:
        roots: list[tuple[Path, str]] = []
        for key, url in (("folder", folder), ("data", data)):
            if url is not None and _is_url(url):
                root = Path(here, key)
                roots.append((root, url))
                fields[key] = str(root)
            elif key == "data" and url is not None:
                fields[key] = os.path.abspath(os.path.join(folder, url))
        there = json.dumps(fields)
        # The drive file first: it names the others.
        for _ in range(2):
            for _key, path in _undrift.fleet_inputs(there):
                _fetch(path, roots)
        yield there


def _fetch(path: Path, roots: list[tuple[Path, str]]) -> None:
    """Fetches a file below one of the roots, if it is there."""
    for root, url in roots:
        if path.is_relative_to(root) and not path.exists():
            name = path.relative_to(root).as_posix()
            if ".." in name.split("/"):
                raise _undrift.UndriftError(f"{url}/{name}: names in URLs have no ..")
            system, folder = _system(url)
            there = posixpath.join(folder, name)
            if system.isfile(there):
                path.parent.mkdir(parents=True, exist_ok=True)
                system.get_file(there, str(path))
