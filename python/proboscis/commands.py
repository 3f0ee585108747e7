"""What the command line does with problems and with variants of them, as functions."""

from __future__ import annotations

import json
from collections.abc import Mapping
from os import PathLike, fspath
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from proboscis import _proboscis
from proboscis._arguments import counted, positive, room
from proboscis._columns import Columns
from proboscis._ending import ended
from proboscis._error import Error, told
from proboscis._plain import as_json, plain
from proboscis.problem import Problem
from proboscis.result import Result

_Told = tuple[bool, str, list[str]]


class Variants(Columns):
    """What came of variants of a problem: a table of them, one row each, and the folder of all files."""

    folder: Path
    """The files, those of the command line."""
    is_solved: bool
    """What exit status 0 of the command says."""
    message: str
    """What the command says."""
    notes: list[str]
    """What else there is to say."""

    def __init__(self, table: str, folder: Path, told: _Told, kept: TemporaryDirectory[str] | None) -> None:
        super().__init__(folder / table)
        self.folder = folder
        # A folder of its own lasts as long as this.
        self._kept = kept
        self.is_solved, self.message, self.notes = told

    def __repr__(self) -> str:
        rows = len(next(iter(self.values()))) if len(self) else 0
        return f"<{type(self).__name__}: {len(self)} columns of {rows} rows, {'solved' if self.is_solved else 'not solved'}>"


class Sweep(Variants):
    """Variants of a problem, each solved once: `variant`, `status`, `seconds`, what varies, and numbers of what came of it."""

    def results(self) -> list[Result | None]:
        """Returns the result of each row, or None where it has left none."""
        folders = [self.folder / "variants" / str(name) for name in self["variant"]]
        return [Result(folder) if (folder / "summary.json").is_file() else None for folder in folders]


class Study(Variants):
    """Points of a study: `method`, what is refined, seconds and errors."""

    summary: dict[str, Any]
    """`study.json`: every run of each point, orders, references, the machine."""
    conclusion: str
    """What the figures say, in words."""

    def __init__(self, table: str, folder: Path, told: _Told, kept: TemporaryDirectory[str] | None) -> None:
        super().__init__(table, folder, told, kept)
        self.summary = _json(folder / "study.json")
        self.conclusion = str(self.summary.get("conclusion", ""))


class Starts(Variants):
    """Starting points of a control problem: `start`, `seed`, `status`, `objective`, `iterations`, `seconds`, `optimum`."""

    @property
    def best(self) -> Result:
        """The best of the results. Raises `Error` where no start has left one."""
        return Result(self.folder, kept=self._kept)


def sweep(
    sweep: str | PathLike[str] | Mapping[str, Any],
    /,
    *,
    folder: str | PathLike[str] = ".",
    output: str | PathLike[str] | None = None,
    shard: str = "1/1",
    max_seconds: float | None = None,
) -> Sweep:
    """Solves many variants of a problem, as the command `proboscis sweep` does; those that are solved in `output` already are not solved again.

    `sweep` is a sweep file or its content, of which paths are relative to `folder`. `shard`, such as `"2/8"`, is the part of the variants
    that is solved. The files go to the folder `output`, or to one that lasts as long as what is returned. Ctrl-C ends it as it ends
    `Problem.solve`; the same call goes on.
    """
    positive("max_seconds", max_seconds)
    if not isinstance(shard, str):
        raise Error(f"shard: found {shard!r}, expected i/n with 1 <= i <= n, such as 2/8", "shard")
    input, written = _file(sweep, folder, "sweep.json")
    place, kept = room(output)
    outcome = _proboscis.sweep(input, place, "proboscis.sweep", shard, max_seconds=max_seconds)

    def read(told: _Told) -> Sweep:
        del written[:]
        return Sweep("sweep.csv", place, told, kept)

    return ended(outcome, read, keeps=kept is None)


def study(
    study: str | PathLike[str] | Mapping[str, Any],
    /,
    *,
    folder: str | PathLike[str] = ".",
    output: str | PathLike[str] | None = None,
    runs: int | None = None,
) -> Study:
    """Runs variants of a problem, to see what accuracy costs in time, as the command `proboscis study` does.

    `study` is a study file or its content, of which paths are relative to `folder`. Each point is timed `runs` times, in place of what the
    study says. The files go to the folder `output`, or to one that lasts as long as what is returned.
    """
    counted("runs", runs)
    input, written = _file(study, folder, "study.json")
    place, kept = room(output)
    outcome = _proboscis.study(input, place, "proboscis.study", runs)

    def read(told: _Told) -> Study:
        del written[:]
        return Study("table.csv", place, told, kept)

    return ended(outcome, read, keeps=kept is None)


def starts(
    problem: Problem | str | PathLike[str],
    count: int,
    /,
    *,
    seed: int = 1,
    output: str | PathLike[str] | None = None,
    max_seconds: float | None = None,
    max_iterations: int | None = None,
) -> Starts:
    """Solves a control problem from `count` starting points, its own guess and random ones, as `proboscis solve --starts` does.

    The files of the best result go to the folder `output`, or to one that lasts as long as what is returned; each start has one of its own in it.
    """
    counted("count", count)
    counted("seed", seed, least=0)
    positive("max_seconds", max_seconds)
    counted("max_iterations", max_iterations, least=0)
    asked = _problem(problem)
    place, kept = room(output)
    outcome = _proboscis.starts(
        asked._input,
        asked._text,
        place,
        "proboscis.starts",
        count,
        seed,
        max_seconds=max_seconds,
        max_iterations=max_iterations,
    )
    return ended(outcome, lambda told: Starts("starts.csv", place, told, kept), keeps=kept is None)


def inspect(problem: Problem | str | PathLike[str], /) -> dict[str, Any]:
    """Returns what a problem consists of, as the command `proboscis inspect` shows it: `effects`, `absent`, `coordinates`, and `sizes` by name."""
    asked = _problem(problem)
    return ended(_proboscis.inspect(asked._input, asked._text), _dict)


def check(problem: Problem | str | PathLike[str], /, *, max_seconds: float | None = None) -> dict[str, Any]:
    """Compares the derivatives of a problem with differences, as the command `proboscis check` does.

    Returns whether it `agrees`, the `message`, the greatest relative `errors`, how many `variables` were `checked`, and the entries that are `wrong`.
    """
    positive("max_seconds", max_seconds)
    asked = _problem(problem)
    return ended(_proboscis.check(asked._input, asked._text, max_seconds), _dict)


def _problem(problem: Problem | str | PathLike[str]) -> Problem:
    if isinstance(problem, Problem):
        return problem
    if isinstance(problem, (str, PathLike)):
        return Problem.from_file(problem)
    raise Error(f"problem: found {problem!r}, expected a problem or the path of its file", "problem")


def _file(content: object, folder: str | PathLike[str], name: str) -> tuple[Path, list[TemporaryDirectory[str]]]:
    """The file with a content, and what holds it where it was written for this alone."""
    if isinstance(content, (str, PathLike)):
        return Path(content), []
    if not isinstance(content, Mapping):
        raise Error(f"found {content!r}, expected the path of a file or its content")
    text = as_json(_seen_from_anywhere(plain(content), Path(folder)), indent=2)
    written = TemporaryDirectory(prefix="proboscis-")
    path = Path(written.name) / name
    with told(f"{path}"):
        path.write_text(text, encoding="utf-8")
    return path, [written]


def _seen_from_anywhere(value: Any, folder: Path) -> Any:
    """The content of a sweep or a study with complete paths."""
    if isinstance(value, list):
        return [_seen_from_anywhere(entry, folder) for entry in value]
    if not isinstance(value, dict):
        return value

    def entry(key: str, one: Any) -> Any:
        is_path = key in ("problem", "table") and isinstance(one, str)
        return fspath((folder / one).resolve()) if is_path else _seen_from_anywhere(one, folder)

    return {key: entry(key, one) for key, one in value.items()}


def _dict(told: _Told) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(told[1])
    return found


def _json(path: Path) -> dict[str, Any]:
    with told(f"{path}"):
        text = path.read_text(encoding="utf-8")
    try:
        found: dict[str, Any] = json.loads(text)
    except ValueError as error:
        raise Error(f"{path}: found no readable JSON ({error})") from error
    return found
