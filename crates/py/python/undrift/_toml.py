"""Keyword arguments as the text of a drive file or a model file."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from undrift._errors import ArgumentError


def value(item: Any, unit: str | None = None) -> str:
    """A value as TOML writes it; numbers and arrays in SI units get ``unit`` where the key has one."""
    if isinstance(item, np.generic):
        item = item.item()
    if isinstance(item, bool):
        return "true" if item else "false"
    if isinstance(item, (str, os.PathLike)):
        return json.dumps(os.fspath(item), ensure_ascii=False).replace("\x7f", "\\u007f")
    if unit is not None and isinstance(item, (int, float)):
        return f'"{float(item)!r} {unit}"'
    if isinstance(item, (int, float)):
        return repr(item)
    if isinstance(item, Mapping):
        inside = ", ".join(f"{_key(key)} = {value(of)}" for key, of in item.items())
        return "{ " + inside + " }"
    if isinstance(item, (list, tuple, np.ndarray)):
        items = list(item)
        numbers = items and all(isinstance(one, (int, float, np.number)) for one in items)
        if unit is not None and numbers:
            return '"' + ", ".join(repr(float(one)) for one in items) + f' {unit}"'
        return "[" + ", ".join(value(one) for one in items) + "]"
    raise ArgumentError(f"a {type(item).__name__} cannot be the value of a key")


def _key(name: object) -> str:
    text = str(name)
    plain = text.isascii() and text.replace("_", "").replace("-", "").isalnum()
    return text if plain else json.dumps(text, ensure_ascii=False)


def table(name: str, keys: Mapping[str, Any], units: Mapping[str, str] | None = None) -> str:
    """A table and its keys, in their order; those that are ``None`` are omitted."""
    lines = [f"[{name}]"]
    for key, item in keys.items():
        if item is not None:
            lines.append(f"{_key(key)} = {value(item, (units or {}).get(key))}")
    return "\n".join(lines) + "\n"
