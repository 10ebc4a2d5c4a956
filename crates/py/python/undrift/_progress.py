"""Bars of progress: tqdm's, any that are made and moved like them, or one line of text."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeAlias

from undrift._errors import ArgumentError

#: ``True`` for a bar, or what makes one as ``tqdm`` does: called with ``total=`` and ``desc=`` it
#: returns an object with ``update(n)`` and ``close()``.
Progress: TypeAlias = bool | Callable[..., Any]


@contextmanager
def reporter(progress: Progress, name: str) -> Iterator[Callable[[int, int], None] | None]:
    """What the compiled half reports to, while the bar is open."""
    if progress is False or progress is None:
        yield None
        return
    if progress is not True and not callable(progress):
        raise ArgumentError(f"progress: True or a callable as tqdm is needed, not {progress!r}")
    bar = _bar(name) if progress is True else progress(total=None, desc=name)
    before = 0

    def report(done: int, total: int) -> None:
        nonlocal before
        if total:
            bar.total = total
        bar.update(done - before)
        before = done

    try:
        yield report
    finally:
        bar.close()


def _bar(name: str) -> Any:
    try:
        # Of a notebook in a notebook, else of a terminal.
        from tqdm.auto import tqdm
    except ImportError:
        return _Line(name)
    return tqdm(total=None, desc=name)


class _Line:
    """A line of text that is written over itself."""

    def __init__(self, name: str) -> None:
        self.name, self.done = name, 0
        self.total: int | None = None

    def update(self, done: int) -> None:
        self.done += done
        of = f"{100 * self.done // self.total} %" if self.total else str(self.done)
        print(f"\r{self.name}: {of}", end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        if self.done:
            print(file=sys.stderr)
