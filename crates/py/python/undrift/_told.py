"""Results that the terminal writes as JSON."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Protocol

from undrift import _undrift
from undrift._result import Result


class HasJson(Protocol):
    """A result that can stand in a report."""

    @property
    def json(self) -> str:
        """The result as the terminal's ``--json`` writes it."""


class Told(Result):
    """A result of a verb of the terminal; a subclass has the field ``json``."""

    json: str

    @property
    def data(self) -> Any:
        """What :attr:`json` holds, as dicts and lists: every test, count and series of the result."""
        return json.loads(self.json)

    def report(
        self,
        output: str | os.PathLike[str] | None = None,
        *,
        figures: str | os.PathLike[str] | None = None,
    ) -> None:
        """Writes a report: one HTML file ``output`` that needs nothing else, its figures into a folder."""
        _undrift.report([(Path(), self.json)], output, figures)


def report(
    results: Iterable[HasJson | str | os.PathLike[str]],
    output: str | os.PathLike[str] | None = None,
    *,
    figures: str | os.PathLike[str] | None = None,
) -> None:
    """Writes one report of several results, or of files that ``--json`` has written.

    Results of one kind are compared: tables side by side, curves over one another.

    Parameters
    ----------
    results : iterable of results or paths
        What it shows.
    output : str or path, optional
        The HTML file.
    figures : str or path, optional
        Folder of the figures.

    Raises
    ------
    UndriftError
        For a file that is no result, or cannot be written.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> cut = undrift.navigate(undrift.simulate("car", 120.0, 50.0))
    >>> page = pathlib.Path(tempfile.mkdtemp()) / "page.html"
    >>> undrift.report([cut], page)
    >>> page.exists()
    True
    """
    told = []
    for result in results:
        if isinstance(result, (str, os.PathLike)):
            told.append((Path(result), Path(result).read_text(encoding="utf-8")))
        else:
            told.append((Path(), result.json))
    _undrift.report(told, output, figures)
