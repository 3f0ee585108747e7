"""From what is written in Python to plain JSON values."""

from __future__ import annotations

import json
from collections.abc import Mapping
from os import PathLike, fspath
from typing import Any

import numpy as np

from proboscis._error import Error


def as_json(value: Any, *, indent: int | None = None) -> str:
    """Returns the text of JSON values; raises `Error` where they have none."""
    try:
        text = json.dumps(value, indent=indent, ensure_ascii=False, allow_nan=False)
        text.encode()
    except (TypeError, ValueError, RecursionError) as error:
        raise Error(f"found what no JSON can hold ({error}), expected finite numbers, texts, lists and dicts") from error
    return text


def plain(value: Any, path: str = "") -> Any:
    """Returns `value` as JSON values: parts become their names, arrays and tuples lists, paths texts.

    Raises `Error` with the path of what has no meaning in JSON.
    """
    name = getattr(value, "__proboscis__", None)
    if name is not None:
        return name()
    if value is None or isinstance(value, (str, bool, int, float)):
        return value
    if isinstance(value, np.generic):
        return plain(value.item(), path)
    if isinstance(value, np.ndarray):
        return plain(value.tolist(), path)
    if isinstance(value, Mapping):
        return {str(plain(key)): plain(entry, f"{path}.{plain(key)}" if path else str(plain(key))) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(entry, f"{path}[{index}]") for index, entry in enumerate(value)]
    if isinstance(value, PathLike):
        return fspath(value)
    raise Error(f"{path}: found {value!r}, expected a number, a text, a list, a dict or a part", path)
