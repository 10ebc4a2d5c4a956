"""Every public function documents its parameters, and its examples run."""

from __future__ import annotations

import doctest
import inspect
import types
from collections.abc import Iterator
from typing import Any

import pytest

import undrift


def functions() -> Iterator[tuple[str, Any]]:
    """The public functions, by name."""
    for module in (undrift, undrift.statistics, undrift.arma):
        for name in module.__all__:
            if isinstance(found := getattr(module, name), types.FunctionType):
                yield f"{module.__name__}.{name}", found


CALLABLES = dict(functions())
CLASSES = {name: getattr(undrift, name) for name in ("Drive", "Filter", "GnssReceiver", "NoiseModel")}


def test_there_are_as_many_as_there_should_be() -> None:
    assert len(set(CALLABLES.values())) >= 27


@pytest.mark.parametrize("name", CALLABLES)
def test_parameters_are_documented(name: str) -> None:
    found = CALLABLES[name]
    text = inspect.getdoc(found) or ""
    assert "\nRaises\n------\n" in text, name
    section = text.partition("\nParameters\n----------\n")[2].partition("\n\n")[0]
    documented = [
        one.strip().lstrip("*")
        for line in section.split("\n")
        if not line.startswith(" ")
        for one in line.partition(" : ")[0].split(",")
    ]
    assert documented == list(inspect.signature(found).parameters), name
    if inspect.signature(found).return_annotation != "None":
        assert "\nReturns\n-------\n" in text, name


@pytest.mark.parametrize("name", {**CALLABLES, **CLASSES})
def test_examples_run(name: str) -> None:
    found = {**CALLABLES, **CLASSES}[name]
    finder = doctest.DocTestFinder(recurse=False)
    (test,) = finder.find(found, name, globs={"undrift": undrift})
    assert test.examples, name
    done = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test)
    assert done.failed == 0 and done.attempted >= 1
