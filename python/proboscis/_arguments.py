"""Arguments of calls: numbers in their ranges, folders of results."""

from __future__ import annotations

import numbers
import tempfile
from os import PathLike
from pathlib import Path

from proboscis._error import Error


def positive(name: str, value: float | None) -> None:
    """Refuses what is no positive number."""
    if value is not None and not (isinstance(value, numbers.Real) and value > 0):
        raise Error(f"{name}: found {value!r}, expected a positive number", name)


def counted(name: str, value: int | None, *, least: int = 1, most: int = 2**63 - 1) -> None:
    """Refuses what is no whole number in a range."""
    if value is not None and not (isinstance(value, numbers.Integral) and least <= value <= most):
        raise Error(f"{name}: found {value!r}, expected a whole number of {least} or more", name)


def room(output: str | PathLike[str] | None) -> tuple[Path, tempfile.TemporaryDirectory[str] | None]:
    """Returns the folder for results; without one that is given, a folder that lasts as long as it is held."""
    if output is not None:
        return Path(output), None
    kept = tempfile.TemporaryDirectory(prefix="proboscis-")
    return Path(kept.name), kept
