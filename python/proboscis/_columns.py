"""Columns of numbers and words: tables of variants of a problem."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from proboscis._error import Error
from proboscis._table import NoColumn, si

if TYPE_CHECKING:
    import pandas


class Columns(Mapping[str, "npt.NDArray[Any]"]):
    """Columns by name, all of one length: numbers in SI units, NaN where there is none, or texts as they are written."""

    units: dict[str, str]
    """Units by column; empty where a column has none."""

    def __init__(self, path: Path) -> None:
        self._columns: dict[str, npt.NDArray[Any]] = {}
        self.units = {}
        try:
            with path.open(encoding="utf-8", newline="") as file:
                head, *rows = csv.reader(line for line in file if not line.startswith("#"))
            cells = [[row[index] for row in rows] for index in range(len(head))]
        except (OSError, ValueError, IndexError, csv.Error) as error:
            raise Error(f"{path}: found no readable table ({error}), expected rows under a header") from error
        for header, column in zip(head, cells):
            name, _, unit = header.removesuffix("]").partition(" [")
            scale, self.units[name] = si(unit)
            try:
                self._columns[name] = np.array([float(cell) if cell else np.nan for cell in column]) / scale
            except ValueError:
                self._columns[name] = np.array(column, dtype=str)

    def to_pandas(self) -> pandas.DataFrame:
        """Returns the columns as a data frame, with units in their names."""
        import pandas

        return pandas.DataFrame({f"{name} [{self.units[name]}]" if self.units[name] else name: values for name, values in self.items()})

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        if name not in self._columns:
            raise NoColumn(f"no column {name!r}; there are {', '.join(self._columns) or 'none'}")
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)
