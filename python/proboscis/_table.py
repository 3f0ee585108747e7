"""Tables of results: CSV files as columns in SI units."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from proboscis._error import Error

if TYPE_CHECKING:
    import pandas

Array = npt.NDArray[np.float64]

class NoColumn(Error, KeyError):
    """A column that is not there: what `in` and `get` of a mapping go by."""


_SCALES = {"mm": (1e3, "m"), "ms": (1e3, "s"), "nC": (1e9, "C"), "V/um": (1e-6, "V/m")}
_NAMES = {"N m": "J"}


class Table(Mapping[str, Array]):
    """Columns of numbers in SI units by name, all of one length; NaN where there is no number."""

    units: dict[str, str]
    """Units by column; empty where a column has none."""

    def __init__(self, columns: Mapping[str, Array], units: Mapping[str, str]) -> None:
        self._columns = dict(columns)
        self.units = dict(units)

    @classmethod
    def read(cls, path: Path) -> Table:
        """Reads a table of results."""
        try:
            with path.open(encoding="utf-8", newline="") as file:
                rows = list(csv.reader(line for line in file if not line.startswith("#")))
            values = np.array([[float(cell) if cell else np.nan for cell in row] for row in rows[1:]])
            values = values.reshape(len(rows) - 1, len(rows[0]))
        except (OSError, ValueError, IndexError) as error:
            raise Error(f"{path}: found no readable table ({error}), expected rows of numbers under a header") from error
        return cls._of({header: values[:, index] for index, header in enumerate(rows[0])})

    @classmethod
    def read_arrays(cls, path: Path, table: str) -> Table:
        """Reads one of the complete tables of a long motion, of which the CSV file has some rows."""
        try:
            with np.load(path) as arrays:
                return cls._of({name.partition("/")[2]: arrays[name] for name in arrays if name.startswith(f"{table}/")})
        except (OSError, ValueError) as error:
            raise Error(f"{path}: found no readable tables ({error}), expected arrays of numbers") from error

    @classmethod
    def _of(cls, headed: Mapping[str, Array]) -> Table:
        columns, units = {}, {}
        for header, values in headed.items():
            if header[:2] in ("'=", "'+", "'-", "'@"):  # kept from spreadsheets, which would take it for a formula
                header = header[1:]
            name, _, unit = header.removesuffix("]").partition(" [")
            scale, units[name] = si(unit)
            columns[name] = values / scale
        return cls(columns, units)

    def to_pandas(self) -> pandas.DataFrame:
        """Returns the columns as a data frame, with units in their names: `tip_x [m]`."""
        import pandas

        def name(column: str) -> str:
            unit = self.units[column]
            return f"{column} [{unit}]" if unit else column

        return pandas.DataFrame({name(column): values for column, values in self._columns.items()})

    def __getitem__(self, name: str) -> Array:
        try:
            return self._columns[name]
        except KeyError:
            raise NoColumn(f"no column {name!r}; there are {', '.join(self._columns) or 'none'}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        rows = len(next(iter(self._columns.values()))) if self._columns else 0
        return f"<Table: {len(self)} columns of {rows} rows>"


def si(unit: str) -> tuple[float, str]:
    """How many of a unit an SI unit is, and that unit."""
    scale, words = 1.0, []
    for word in unit.split():
        factor, name = _SCALES.get(word, (1.0, word))
        scale *= factor
        words.append(name)
    name = " ".join(words)
    return scale, _NAMES.get(name, name)
