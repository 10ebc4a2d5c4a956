"""Results that the terminal writes as JSON."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Protocol, TypeVar

from undrift import _undrift
from undrift._errors import VerdictError, VerdictWarning
from undrift._result import Result


class HasJson(Protocol):
    """A result that can stand in a report."""

    @property
    def json(self) -> str:
        """The result as the terminal's ``--json`` writes it."""


class Judged(Result):
    """A result of a verb of the terminal; a subclass has the fields ``verdict`` and ``json``."""

    verdict: str
    json: str

    @property
    def usable(self) -> bool:
        """Whether the verdict is ``usable``, without reservation."""
        return self.verdict == "usable"

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
        """Writes a report: one HTML file ``output`` that needs nothing else, its figures into a folder.

        A name that ends in .md, .tex or .csv has the tables alone, as Markdown, LaTeX or CSV.
        """
        _undrift.report([(Path(), self.json)], output, figures)


_Result = TypeVar("_Result", bound=Judged)


def judged(result: _Result, line: str, strict: bool | None) -> _Result:
    """The result, where its verdict permits it; ``line`` is the terminal's first one. To be called by the function that
    people call.

    With care it warns, or raises if ``strict``; what is not usable raises, or warns if ``strict`` is False.
    """
    text = _undrift.in_python(line[:1].lower() + line[1:])
    if result.verdict == "not usable" and strict is not False:
        raise VerdictError(f"{text}; strict=False returns the result all the same", result)
    if not result.usable:
        if strict:
            raise VerdictError(f"{text}; without strict=True this is a warning", result)
        warnings.warn(text, VerdictWarning, stacklevel=3)
    return result


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
        The HTML file; of .md, .tex or .csv, the tables alone as Markdown, LaTeX or CSV.
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
    contents = []
    for result in results:
        if isinstance(result, (str, os.PathLike)):
            contents.append((Path(result), Path(result).read_text(encoding="utf-8")))
        else:
            contents.append((Path(), result.json))
    _undrift.report(contents, output, figures)
