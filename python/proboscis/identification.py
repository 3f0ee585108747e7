"""What an identification has found: constants with intervals, correlations, residuals and verdicts."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from proboscis._error import Error
from proboscis._table import Array


@dataclass(frozen=True)
class Constant:
    """A constant that was sought, in SI units."""

    name: str
    """Its path in the scene."""
    unit: str
    value: float
    """NaN where the data do not determine it."""
    standard_error: float
    """NaN where it has no interval."""
    interval: tuple[float, float] | None
    """Interval of 95 %; none at a bound, or where the data do not determine it."""
    at_bound: bool


@dataclass(frozen=True)
class Residuals:
    """The readings of a quantity of a recording beside their predictions, in SI units."""

    recording: str
    quantity: str
    unit: str
    held_out: bool
    time: Array
    measured: Array
    predicted: Array
    standard_deviation: Array

    @property
    def residual(self) -> Array:
        """Measured minus predicted."""
        return self.measured - self.predicted


@dataclass(frozen=True)
class HeldOut:
    """The prediction of a recording that no constant was fitted to."""

    is_explained: bool
    statistic: float
    """Squared differences over those that the deviations of readings and constants let expect: 1 where all is as expected."""
    quantile: float
    """The value that the statistic exceeds with a probability of 1 %."""
    p: float
    """Probability of so large a statistic where the model is right."""
    not_white: list[str]
    """Quantities whose differences are not white."""
    reduced_chi_square: float
    """The same as the statistic by the deviations of the readings alone."""


@dataclass(frozen=True)
class Start:
    """Coordinate of a joint at a start that was sought, and its rate: rad and rad/s, or m and m/s."""

    value: float
    rate: float


class Identification:
    """Constants that were fitted to recordings, with what the data say of them: `result.identification`."""

    def __init__(self, summary: Mapping[str, Any], folder: Path) -> None:
        if "constants" not in summary or "correlation" not in summary:
            raise Error("identification: only the result of an identification has one")
        self._summary = summary
        self._folder = folder

    @cached_property
    def constants(self) -> dict[str, Constant]:
        """The constants by their paths in the scene."""

        def constant(entry: Mapping[str, Any]) -> Constant:
            interval = entry.get("interval")
            return Constant(
                name=entry["name"],
                unit=entry["unit"],
                value=entry.get("value", math.nan),
                standard_error=entry.get("standard_error", math.nan),
                interval=None if interval is None else (interval[0], interval[1]),
                at_bound=entry["at_bound"],
            )

        return {entry["name"]: constant(entry) for entry in self._summary["constants"]}

    @cached_property
    def correlation(self) -> Array:
        """Correlations of the constants in their order; NaN of those without an interval."""
        rows = [[math.nan if one is None else one for one in row] for row in self._summary["correlation"]]
        return np.array(rows, dtype=float).reshape(len(rows), len(rows))

    @cached_property
    def covariance(self) -> Array:
        """Covariances of the constants in SI units; NaN of those without an interval."""
        errors = np.array([constant.standard_error for constant in self.constants.values()])
        return self.correlation * np.outer(errors, errors)

    @property
    def undetermined(self) -> list[str]:
        """What the data do not determine, in words."""
        return [str(entry["text"]) for entry in self._summary["undetermined"]]

    @property
    def determined(self) -> dict[str, tuple[float, float]]:
        """Products of constants that are determined where these are not: value and standard error in SI units."""
        found = [entry["determined"] for entry in self._summary["undetermined"] if "determined" in entry]
        return {entry["product"]: (entry["value"], entry["standard_error"]) for entry in found}

    @property
    def reduced_chi_square(self) -> float:
        """Sum of the squared residuals in standard deviations over the degrees of freedom."""
        return float(self._summary["reduced_chi_square"])

    @property
    def held_out(self) -> dict[str, HeldOut]:
        """Verdicts on the recordings that were held out, by their names."""
        return {
            entry["recording"]: HeldOut(
                is_explained=entry["verdict"] == "explained",
                statistic=entry["statistic"],
                quantile=entry["quantile"],
                p=entry["p"],
                not_white=entry["not_white"],
                reduced_chi_square=entry["reduced_chi_square"],
            )
            for entry in self._summary["held_out"]
        }

    @property
    def starts(self) -> dict[str, dict[str, Start]]:
        """Starts that were sought, by recording and joint."""
        return {
            entry["recording"]: {joint["name"]: Start(joint["value"], joint["rate"]) for joint in entry["joints"]}
            for entry in self._summary.get("starts", [])
        }

    @property
    def next_experiments(self) -> list[str]:
        """Candidates for the next experiment, the best one first."""
        return [str(entry["name"]) for entry in self._summary.get("next_experiments", [])]

    @cached_property
    def residuals(self) -> list[Residuals]:
        """All readings, quantity by quantity: those of the fit first."""
        path = self._folder / "residuals.csv"
        try:
            with path.open(encoding="utf-8", newline="") as file:
                rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
            series: dict[tuple[str, str], list[dict[str, str]]] = {}
            for row in rows:
                series.setdefault((row["recording"], row["quantity"]), []).append(row)
            return [_residuals(rows) for rows in series.values()]
        except (OSError, ValueError, KeyError, csv.Error) as error:
            raise Error(f"{path}: found no readable table ({error}), expected the readings of an identification") from error

    def __repr__(self) -> str:
        constants = self.constants.values()
        return f"<Identification: {', '.join(f'{one.name} = {one.value:.6g} {one.unit}'.rstrip() for one in constants)}>"


def _residuals(rows: list[dict[str, str]]) -> Residuals:
    def column(name: str) -> Array:
        return np.array([float(row[name]) for row in rows])

    first = rows[0]
    return Residuals(
        recording=first["recording"],
        quantity=first["quantity"],
        unit=first["unit"],
        held_out=first["held out"] == "true",
        time=column("time [s]"),
        measured=column("measured"),
        predicted=column("predicted"),
        standard_deviation=column("standard deviation"),
    )
