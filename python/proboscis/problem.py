"""A problem: what is asked of a system."""

from __future__ import annotations

import copy
import json
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from proboscis import _proboscis
from proboscis._error import Error
from proboscis._plain import plain
from proboscis.result import Result

if TYPE_CHECKING:
    from proboscis.nlp import Nlp


@dataclass(frozen=True)
class Iteration:
    """An iterate that the solver accepted."""

    intervals: int
    """Intervals of the grid that is being solved."""
    iteration: int
    """Its number; the starting point is number zero."""
    objective: float
    infeasibility: float
    """Greatest violation of a constraint, as the solver measures it."""
    optimality: float
    """Greatest entry of the gradient of the Lagrangian."""


@dataclass(frozen=True)
class Step:
    """A step that a simulation has done."""

    step: int
    """Its number, from 1 on."""
    time: float
    """Its end in s."""


class Problem:
    """A problem: the content of a problem file.

    `scene` is a `System`, a dict, or the path of a scene file; of `control`, `simulate` and `equilibrium` exactly one is given, as in the
    file. It is checked at once; `Error` has the path of the wrong entry.
    """

    name: str
    """Name of its file in messages and results."""
    folder: Path
    """Where files that the problem names are looked for."""
    task: str
    """What it asks for: `control`, `simulate` or `equilibrium`."""

    def __init__(
        self,
        scene: Any,
        *,
        control: Mapping[str, Any] | None = None,
        simulate: Mapping[str, Any] | None = None,
        equilibrium: Mapping[str, Any] | None = None,
        folder: str | PathLike[str] = ".",
    ) -> None:
        tasks = {"control": control, "simulate": simulate, "equilibrium": equilibrium}
        given = {key: plain(value, key) for key, value in tasks.items() if value is not None}
        self._take({"scene": plain(scene, "scene"), **given}, Path(folder), "problem.json")

    def _take(self, content: dict[str, Any], folder: Path, name: str) -> None:
        self._content = content
        self.folder = folder
        self.name = name
        self.task = _proboscis.check(self._input, self._text, [])

    @property
    def _input(self) -> Path:
        return self.folder / self.name

    @property
    def _text(self) -> str:
        try:
            return json.dumps(self._content, indent=2, ensure_ascii=False, allow_nan=False)
        except ValueError as error:
            raise Error(f"found a number that is not finite ({error}), expected finite numbers") from error

    @classmethod
    def from_dict(cls, content: Mapping[str, Any], /, *, folder: str | PathLike[str] = ".") -> Problem:
        """Makes a problem of the content of a problem file; `folder` is where files that it names are looked for."""
        return cls._of(copy.deepcopy(plain(content)), Path(folder), "problem.json")

    @classmethod
    def from_file(cls, path: str | PathLike[str], /) -> Problem:
        """Reads a problem file. Raises `Error` where it is wrong."""
        path = Path(path)
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise Error(f"{path}: found no readable file ({error}), expected a JSON file") from error
        # What is read twice, such as a repeated key, is a mistake of the text alone.
        _proboscis.check(path, text, [])
        return cls._of(json.loads(text), path.parent, path.name)

    @classmethod
    def _of(cls, content: dict[str, Any], folder: Path, name: str) -> Problem:
        problem = cls.__new__(cls)
        problem._take(content, folder, name)
        return problem

    def to_dict(self) -> dict[str, Any]:
        """Returns the content of the problem file, a copy."""
        return copy.deepcopy(self._content)

    def changed(self, changes: Mapping[str, Any], /) -> Problem:
        """Returns the problem with other entries, such as `{"control.intervals": 80}`.

        Lists are counted from zero: `scene.muscles[1].material`. The scene has to be in the problem, not in a file of its own.
        """
        content: dict[str, Any] = self.to_dict()
        for path, value in changes.items():
            _put(content, path, plain(value, path))
        return self._of(content, self.folder, self.name)

    def save(self, path: str | PathLike[str], /) -> None:
        """Writes the problem file."""
        Path(path).write_text(self._text + "\n", encoding="utf-8")

    def solve(
        self,
        *,
        start: Result | None = None,
        on_iteration: Callable[[Iteration], object] | None = None,
        max_seconds: float | None = None,
        max_iterations: int | None = None,
        accuracy: float | None = None,
        estimate_error: bool = False,
        output: str | PathLike[str] | None = None,
    ) -> Result:
        """Does what the problem asks for, as the command `proboscis solve` does, with the same bits.

        `start` is a result to start from in place of the guess. `on_iteration` hears of every iterate; an exception from it, and Ctrl-C, end the
        run in good order and come out, with the result so far as their attribute `result` (`None` where there is none yet). `max_seconds` and
        `max_iterations` end it as well; the status of the result tells so. `accuracy` refines the grid until the error is estimated
        below it, `estimate_error` estimates it. The files of the result go to the folder `output`, or to one that lasts as long as the result.
        Other threads run meanwhile.

        Raises `Error` where the problem is wrong, or has no state of rest to start from.
        """
        if on_iteration is not None and self.task != "control":
            raise Error(f"on_iteration: the problem asks to {self.task}, for which no solver iterates", "on_iteration")
        observer = None if on_iteration is None else lambda *told: on_iteration(Iteration(*told))
        return self._run("solve", start, observer, max_seconds, max_iterations, accuracy, estimate_error, output)

    def simulate(
        self,
        *,
        on_step: Callable[[Step], object] | None = None,
        max_seconds: float | None = None,
        accuracy: float | None = None,
        estimate_error: bool = False,
        output: str | PathLike[str] | None = None,
    ) -> Result:
        """Simulates; as `solve`, of a problem that asks to `simulate`."""
        self._asks("simulate")
        observer = None if on_step is None else lambda step, time: on_step(Step(step, time / 1e3))
        return self._run("simulate", None, observer, max_seconds, None, accuracy, estimate_error, output)

    def equilibrium(
        self,
        *,
        max_seconds: float | None = None,
        output: str | PathLike[str] | None = None,
    ) -> Result:
        """Finds the state of rest; as `solve`, of a problem that asks for an `equilibrium`."""
        self._asks("equilibrium")
        return self._run("equilibrium", None, None, max_seconds, None, None, False, output)

    def nlp(self) -> Nlp:
        """Returns the nonlinear program of a control problem, for a solver of one's own."""
        from proboscis.nlp import Nlp

        return Nlp(_proboscis.Program(self._input, self._text))

    def _asks(self, task: str) -> None:
        if self.task != task:
            raise Error(f"{self.task}: the problem does not ask for {task!r}", self.task)

    def _run(
        self,
        method: str,
        start: Result | None,
        observer: Callable[..., object] | None,
        max_seconds: float | None,
        max_iterations: int | None,
        accuracy: float | None,
        estimate_error: bool,
        output: str | PathLike[str] | None,
    ) -> Result:
        for name, limit in (("max_seconds", max_seconds), ("accuracy", accuracy)):
            if limit is not None and not limit > 0:
                raise Error(f"{name}: found {limit!r}, expected a positive number", name)
        problem = self if start is None else self._from(start)
        kept = tempfile.TemporaryDirectory(prefix="proboscis-") if output is None else None
        folder = Path(output if output is not None else kept.name if kept else "")
        before = _state(folder / "summary.json")
        told, raised = _proboscis.run(
            problem._input,
            problem._text,
            [],
            folder,
            f"Problem.{method}",
            max_seconds=max_seconds,
            max_iterations=max_iterations,
            accuracy=accuracy,
            estimate_error=estimate_error,
            observer=observer,
        )
        # A state of rest that is refused leaves no files, and those of an earlier run alone.
        is_written = _state(folder / "summary.json") != before
        result = Result(folder, told, kept, is_written=is_written) if told else None
        if raised is not None:
            raised.result = result  # type: ignore[attr-defined]
            raise raised
        assert result is not None, "a run without an exception has a result"
        return result

    def _from(self, start: Result) -> Problem:
        if self.task != "control":
            raise Error(f"start: the problem asks to {self.task}, which starts from no result", "start")
        solution = start.folder / "solution.json"
        if not solution.is_file():
            raise Error("start: the result holds no motion to start from", "start")
        content = self.to_dict()
        content["control"]["guess"] = {"solution": str(solution.resolve())}
        return self._of(content, self.folder, self.name)

    def __repr__(self) -> str:
        scene = self._content["scene"]
        name = scene if isinstance(scene, str) else scene["name"]
        return f"<Problem: {self.task} {name!r}>"


def _state(path: Path) -> tuple[int, int] | None:
    """What changes when a file is written anew."""
    try:
        stat = path.stat()
    except OSError:
        return None
    return stat.st_ino, stat.st_mtime_ns


def _put(content: Any, path: str, value: Any) -> None:
    """Puts a value at a path such as `scene.muscles[1].material`."""
    steps: list[str | int] = []
    for word in path.split("."):
        key, *indices = word.split("[")
        steps += [key] if key else []
        for index in indices:
            if not (index.endswith("]") and index[:-1].isdecimal()):
                raise Error(f"{path}: found {word!r}, expected a path such as scene.muscles[1].material", path)
            steps.append(int(index[:-1]))
    place = content
    for step, following in zip(steps, steps[1:] + [None]):
        fits = isinstance(place, dict) if isinstance(step, str) else isinstance(place, list) and step < len(place)
        if not fits:
            raise Error(f"{path}: there is no place {step!r}", path)
        if following is None:
            place[step] = value
        elif isinstance(step, str):
            place = place.setdefault(step, {})
        else:
            place = place[step]
