"""A result: the folder that a run has written, read as arrays in SI units."""

from __future__ import annotations

import html
import json
import shutil
import webbrowser
from functools import cached_property
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from proboscis._error import Error
from proboscis._error import told as _told
from proboscis._plain import plain
from proboscis._table import Array, Table
from proboscis.identification import Identification
from proboscis.sensitivity import Sensitivity, sensitivities

if TYPE_CHECKING:
    import pandas

_TABLES = ("trajectory.csv", "path.csv", "equilibrium.csv")
_SOLVED = ("solved", "acceptable", "feasible_point", "simulated", "at_rest", "path_followed", "identified", "explained")


class Result:
    """What a run has found, solved or not; `Result.load(folder)` reads that of an earlier run or of the command line."""

    folder: Path
    """Its files, those of the command line."""
    summary: dict[str, Any]
    """`summary.json`: sizes, computing times, energies, versions."""
    is_solved: bool
    """Whether the question has an answer that passed its checks; otherwise `status` and `message` say why not."""
    notes: list[str]
    """What else there is to say of it: warnings, causes."""

    def __init__(
        self,
        folder: Path,
        told: tuple[bool, str, list[str]] | None = None,
        kept: TemporaryDirectory[str] | None = None,
        *,
        is_written: bool = True,
    ) -> None:
        self.folder = folder
        # A folder of its own lasts as long as the result.
        self._kept = kept
        self.summary = _summary(folder / "summary.json") if is_written else {}
        if told is None:
            is_met = (self.summary.get("accuracy") or {}).get("is_met") is not False
            notes = [f"{note['severity']}: {note['text']}" for note in self.summary.get("notes", [])]
            told = (self.status in _SOLVED and is_met, self.status, notes)
        self.is_solved, self._line, self.notes = told
        self._line = self._line.removesuffix(f", {folder}")

    def __fspath__(self) -> str:
        """Returns the folder: a result stands for it in a problem, such as `{"start": {"end_of": result}}`."""
        return str(self.folder.resolve())

    @classmethod
    def load(cls, folder: str | PathLike[str], /) -> Result:
        """Reads the folder of a result. Raises `Error` where it holds none."""
        return cls(Path(_named(folder)))

    def save(self, folder: str | PathLike[str], /) -> None:
        """Copies its files into a folder, which is made where it is missing."""
        with _told("the files of the result"):
            shutil.copytree(self.folder, folder, dirs_exist_ok=True)

    @property
    def status(self) -> str:
        """How it ended, in a word: `solved`, `simulated`, `at_rest`, `infeasible`, `time_limit`, …."""
        return str(self.summary.get("status", "no_equilibrium"))

    @property
    def message(self) -> str | None:
        """Why it is not solved, in words."""
        reasons = [self.summary.get("message"), *([] if self.is_solved else self.notes)]
        return next((str(reason) for reason in reasons if reason), None)

    @property
    def objective(self) -> float:
        """Value of the objective of a control problem."""
        return float(self._of_summary("objective"))

    @property
    def iterations(self) -> int:
        """Iterations of the solver of a control problem."""
        return int(self._of_summary("iterations"))

    @cached_property
    def identification(self) -> Identification:
        """Constants that were fitted to recordings, with what the data say of them."""
        return Identification(self.summary, self.folder)

    @cached_property
    def sensitivities(self) -> dict[str, Sensitivity]:
        """How the optimum changes with the numbers that `sensitivity` of its problem names, by these names."""
        return sensitivities(self.summary, self.folder)

    @cached_property
    def feedback(self) -> dict[str, Array]:
        """Arrays of the regulator that `feedback` of a problem asks for, by step: `A`, `B`, `Q`, `R`, `K` of the deviations
        `x[k + 1] = A[k] x[k] + B[k] u[k]`, `u = -K x`, of coordinates, momenta and integrals in rad, mm, ms, g, and of inputs in V (V² of
        lumped muscles) and N; those at the held goal end with `_held`, `S_end` is the cost at the end.
        """
        path = self.folder / "feedback.npz"
        try:
            with np.load(path) as arrays:
                return {name: arrays[name] for name in arrays}
        except (OSError, ValueError) as error:
            raise Error(f"feedback: found no readable arrays ({error}), expected the optimum of a problem with `feedback`") from error

    @cached_property
    def motions(self) -> dict[str, Result]:
        """Results of the motions that were optimised together, by their names."""
        entries = self._of_summary("motions")
        return {entry["name"]: Result(self.folder / entry["folder"], kept=self._kept) for entry in entries}

    @cached_property
    def table(self) -> Table:
        """Columns by name: of a motion one row per instant, of a path one per equilibrium, of an equilibrium one; all at the time of the row.

        Where the problem says how its `output` is sampled, these rows."""
        return self._table(*_TABLES)

    @cached_property
    def controls(self) -> Table:
        """Columns by name, one row per interval: `start`, `end` (s) and the voltage of each source (V)."""
        return self._table("controls.csv")

    @cached_property
    def tracking(self) -> Table:
        """What the objective of a control problem follows, what the motion did, and the deviation, one row per instant."""
        return self._table("tracking.csv")

    @property
    def modes(self) -> list[dict[str, Any]]:
        """Vibrations about a state of rest by their frequencies: `frequency` in Hz, `damping_ratio`, and what `moves`."""
        if "vibrations" not in self.summary:
            raise Error("modes: only the result of an equilibrium with modes or frequency_response has them")
        modes: list[dict[str, Any]] = self.summary["vibrations"]["modes"]
        return modes

    @cached_property
    def frequency_response(self) -> Table:
        """Amplitude and phase of each joint and marker, for a unit of the input (V, N, N m), one row per frequency."""
        return self._table("frequency_response.csv")

    @property
    def time(self) -> Array:
        """Instants of a motion in s."""
        return self.table["time"]

    def joint(self, joint: Any, /) -> Array:
        """Coordinate of a joint at each instant: rad (revolute), m (prismatic); of others see `table`."""
        return self.table[plain(joint)]

    def rate(self, joint: Any, /) -> Array:
        """Rate of the coordinate of a joint at each instant: rad/s (revolute), m/s (prismatic)."""
        return self.table[f"{plain(joint)}_rate"]

    def speed(self, marker: Any, /) -> Array:
        """Size of the velocity of a marker at each instant in m/s."""
        return self.table[f"{plain(marker)}_speed"]

    def force(self, joint: Any, /) -> Array:
        """Force in N that the parent of a joint exerts on its child through it, an array of one row of three numbers per instant."""
        name = plain(joint)
        return np.column_stack([self.table[f"{name}_force_{axis}"] for axis in "xyz"])

    def torque(self, joint: Any, /) -> Array:
        """Torque in N m that the parent of a joint exerts on its child, about the point of the joint, one row per instant."""
        name = plain(joint)
        return np.column_stack([self.table[f"{name}_torque_{axis}"] for axis in "xyz"])

    def position(self, marker: Any, /) -> Array:
        """Position of a marker in m, an array of one row of three numbers per instant."""
        name = plain(marker)
        return np.column_stack([self.table[f"{name}_{axis}"] for axis in "xyz"])

    def stretch(self, muscle: Any, /) -> Array:
        """Stretch of a muscle at each instant."""
        return self.table[f"{plain(muscle)}_stretch"]

    def tension(self, muscle: Any, /) -> Array:
        """Force in N with which a lumped muscle pulls its ends together, at each instant."""
        return self.table[f"{plain(muscle)}_tension"]

    def field(self, muscle: Any, /) -> Array:
        """True electric field of a lumped muscle in V/m at each instant."""
        return self.table[f"{plain(muscle)}_field"]

    def current(self, muscle: Any, /) -> Array:
        """Current in A from the source of a lumped muscle at each instant."""
        return self.table[f"{plain(muscle)}_current"]

    def power(self, source: Any, /) -> Array:
        """Power in W of the source of a lumped muscle, or of a load, at each instant."""
        return self.table[f"{plain(source)}_power"]

    def charge(self, source: Any, /) -> Array:
        """Charge of a muscle or electrode in C at each instant."""
        return self.table[f"{plain(source)}_charge".replace(".", "_")]

    def voltage(self, source: Any, /) -> Array:
        """Voltage of a muscle or electrode in V, or size of a load in N or N m, in each interval."""
        return self.controls[plain(source)]

    def to_pandas(self) -> pandas.DataFrame:
        """Returns `table` as a data frame, with units in the names of its columns."""
        return self.table.to_pandas()

    def report(self) -> Path:
        """Returns the path of its page, which works offline."""
        path = self.folder / "report.html"
        if not path.is_file():
            raise Error(f"{self.folder}: there is no report.html in this result")
        return path

    def animate(self) -> None:
        """Opens the page in a browser."""
        webbrowser.open(self.report().resolve().as_uri())

    def figure(self, name: str = "configuration", /) -> Figure:
        """Returns a figure: `configuration`, `voltages`, `tip_path`, `joint_angles`, `energy`, …; a notebook shows it."""
        path = self.folder / f"{name}.svg"
        if not path.is_file():
            there = ", ".join(sorted(file.stem for file in self.folder.glob("*.svg")))
            raise Error(f"{name}: there is no such figure; there are {there or 'none'}")
        with _told("the figure"):
            return Figure(path.read_text(encoding="utf-8"))

    def _table(self, *names: str) -> Table:
        arrays = self.folder / "tables.npz"
        for name in names:
            path = self.folder / name
            if arrays.is_file() and name in ("trajectory.csv", "controls.csv"):
                return Table.read_arrays(arrays, path.stem)
            if path.is_file():
                return Table.read(path)
        raise Error(f"{self.folder}: there is no {' or '.join(names)} in this result ({self.status})")

    def _of_summary(self, key: str) -> Any:
        if key not in self.summary:
            raise Error(f"{key}: only the result of a control problem has one")
        return self.summary[key]

    def __repr__(self) -> str:
        # That of an equilibrium has several lines.
        line = self.status if "\n" in self._line else self._line
        return f"<Result: {line}>"

    def _repr_html_(self) -> str:
        with _told("the page"):
            page = html.escape(self.report().read_text(encoding="utf-8"))
        return f'<iframe srcdoc="{page}" width="100%" height="640" style="border:0" title="proboscis"></iframe>'


def _named(folder: object) -> str | PathLike[str]:
    if not isinstance(folder, (str, PathLike)):
        raise Error(f"found {folder!r}, expected the path of the folder of a result")
    return folder


def _summary(path: Path) -> dict[str, Any]:
    try:
        summary = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise Error(f"{path}: found no readable JSON ({error}), expected the folder of a result") from error
    if not (isinstance(summary, dict) and isinstance(summary.get("status"), str)):
        raise Error(f'{path}: found no "status", expected the summary of a result', "status")
    return summary


class Figure:
    """A figure in SVG, shown by a notebook."""

    svg: str

    def __init__(self, svg: str) -> None:
        self.svg = svg

    def save(self, path: str | PathLike[str], /) -> None:
        """Writes the figure."""
        with _told("the figure"):
            Path(path).write_text(self.svg, encoding="utf-8")

    def _repr_svg_(self) -> str:
        return self.svg
