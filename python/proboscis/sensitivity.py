"""How an optimum changes with the numbers of its problem."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from proboscis._error import Error
from proboscis._table import Array, Table, si


@dataclass(frozen=True)
class Sensitivity:
    """Derivatives of an optimum by one number of its problem, all in SI units."""

    name: str
    """Its path in the scene or in the problem."""
    unit: str
    value: float
    tolerance: float
    """NaN where none is given."""
    objective: float
    duration: float
    """0 where the duration is given."""
    parameters: dict[str, float]
    """Of constants that were sought, by their paths."""
    valid: tuple[float, float]
    """Values between which the same bounds are reached, to first order."""
    bounds: tuple[str | None, str | None]
    """What ends the range below and above."""
    one_sided: list[str]
    """Bounds that are reached or left at once: the derivatives hold to one side alone."""
    table: dict[str, Array]
    """Derivatives of inputs (in the interval that begins there), joints and places of markers at each instant, by their names."""

    def __repr__(self) -> str:
        return f"<Sensitivity: d objective / d {self.name} = {self.objective:.6g}>"


def sensitivities(summary: Mapping[str, Any], folder: Path) -> dict[str, Sensitivity]:
    """The sensitivities of a result by the names of the numbers."""
    if "sensitivities" not in summary:
        raise Error("sensitivities: only the optimum of a problem with `sensitivity` has some")
    table = Table.read(folder / "sensitivities.csv")

    def derivatives(of: str) -> dict[str, Array]:
        out = {}
        for header, values in table.items():
            name, _, by = header.partition(" / d ")
            if by == of:
                scale, _ = si(table.units[header].partition("/(")[0])
                out[name.removeprefix("d ")] = values / scale
        return out

    def one(entry: Mapping[str, Any]) -> Sensitivity:
        valid = entry["valid"]
        return Sensitivity(
            name=entry["name"],
            unit=entry["unit"],
            value=entry["value"],
            tolerance=entry.get("tolerance", math.nan),
            objective=entry["objective"],
            duration=entry.get("duration", 0.0),
            parameters={of["name"]: of["derivative"] for of in entry.get("parameters", [])},
            valid=(valid.get("from", -math.inf), valid.get("to", math.inf)),
            bounds=(valid.get("bound_below"), valid.get("bound_above")),
            one_sided=list(entry.get("one_sided", [])),
            table=derivatives(entry["name"]),
        )

    return {entry["name"]: one(entry) for entry in summary["sensitivities"]}
