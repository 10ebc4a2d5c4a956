"""Files by their paths, or by URLs that `fsspec` opens (``s3://…``, ``gs://…``)."""

from __future__ import annotations

import hashlib
import os
import posixpath
import re
import threading
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar

from undrift._errors import UndriftError
from undrift._result import optional

T = TypeVar("T")

#: A store that has not answered its first request after this time does not answer [s].
PATIENCE = 30.0

#: What the stores call a value that changes with the contents of an object.
_TAGS = ("ETag", "etag", "md5Hash", "content_md5", "md5", "crc32c")
#: What they call the time of the last change.
_TIMES = ("LastModified", "last_modified", "mtime", "updated", "modified", "created")


def is_url(name: str) -> bool:
    """Whether fsspec has to open it."""
    return "://" in name or "::" in name


def join(folder: str, *names: str) -> str:
    """The name of something in a folder."""
    return posixpath.join(folder, *names)


def system(url: str) -> tuple[Any, str]:
    """The file system of a URL and the path in it."""
    core = optional("fsspec.core", "fleet")
    found, path = core.url_to_fs(url)
    return found, path


def answered(url: str, action: Callable[[], T]) -> T:
    """Does the first thing with a store: an error if it has not answered after 30 s."""
    done: list[T] = []
    failed: list[BaseException] = []

    def ask() -> None:
        try:
            done.append(action())
        except BaseException as error:
            failed.append(error)

    thread = threading.Thread(target=ask, daemon=True)
    thread.start()
    thread.join(PATIENCE)
    if failed:
        raise UndriftError(f"{url}: {failed[0] or type(failed[0]).__name__}") from failed[0]
    if not done:
        raise UndriftError(
            f"{url}: no answer for {PATIENCE:.0f} s; check the address, the network and the credentials"
        )
    return done[0]


def read(name: str) -> bytes:
    """The contents."""
    if not is_url(name):
        return Path(name).read_bytes()
    files, path = system(name)
    content: bytes = files.cat_file(path)
    return content


def read_if_there(name: str) -> bytes | None:
    """The contents, if the file is there."""
    try:
        return read(name)
    except FileNotFoundError:
        return None


def write(name: str, content: bytes) -> None:
    """Writes a file that is there whole or not at all, whoever else writes it."""
    if is_url(name):
        files, path = system(name)
        # An object appears when it is whole.
        try:
            files.pipe_file(path, content)
        except FileNotFoundError:
            files.makedirs(posixpath.dirname(path), exist_ok=True)
            files.pipe_file(path, content)
        return
    target = Path(name)
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_name(f".{target.name}.part{os.getpid()}-{threading.get_ident()}")
    with open(part, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    os.replace(part, target)


def names(folder: str) -> list[str]:
    """The names of the files in a folder, none if it is not there."""
    if not is_url(folder):
        return os.listdir(folder) if os.path.isdir(folder) else []
    files, path = system(folder)
    files.invalidate_cache()
    try:
        found = files.ls(path, detail=False)
    except FileNotFoundError:
        return []
    return [posixpath.basename(name) for name in found]


def tag(name: str) -> str | None:
    """What changes when the contents do. Of a URL, without reading them: the object's ETag or hash, or its size and
    time of change; of a file here, its hash. ``None`` if it is not there, empty without any of these."""
    if not is_url(name):
        if os.path.isdir(name):
            return ""
        content = read_if_there(name)
        return None if content is None else hashlib.sha256(content).hexdigest()
    files, path = system(name)
    files.invalidate_cache(path)
    try:
        info = files.info(path)
    except FileNotFoundError:
        return None
    if info.get("type") == "directory":
        return None
    for key in _TAGS:
        if info.get(key):
            return f"{key} {info[key]}"
    for key in _TIMES:
        if info.get(key) and info.get("size") is not None:
            return f"{info['size']} bytes of {info[key]}"
    return ""


def matching(home: str, patterns: Iterable[tuple[str, str]]) -> dict[tuple[str, str], list[str]]:
    """What patterns of "files" and "folders" stand for in a store, by names relative to ``home``: a listing of what lies
    below the part of the pattern that has no wildcard, a thousand names a request."""
    translate = optional("fsspec.utils", "fleet").glob_translate
    found: dict[tuple[str, str], list[str]] = {}
    for kind, pattern in patterns:
        files, path = system(home)
        files.invalidate_cache()
        parts = pattern.split("/")
        wild = next((k for k, part in enumerate(parts) if set("*?[") & set(part)), len(parts))
        root = posixpath.join(path, *parts[:wild])
        wanted = re.compile(translate(posixpath.join(path, pattern.rstrip("/"))))
        below = files.find(root)
        if kind == "folders":
            below = {folder for name in below for folder in _above(name, root)}
        match = (posixpath.relpath(name, path) for name in below if wanted.match(name))
        found[kind, pattern] = sorted(match)
    return found


def _above(name: str, root: str) -> Iterable[str]:
    """The folders that a file is in, below a root."""
    folder = posixpath.dirname(name)
    while len(folder) > len(root):
        yield folder
        folder = posixpath.dirname(folder)
