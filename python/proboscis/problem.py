"""A problem: what is asked of a system."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from proboscis import _proboscis
from proboscis._arguments import counted, positive, room
from proboscis._ending import ended
from proboscis._error import Error, told
from proboscis._plain import as_json, plain
from proboscis.result import Result

if TYPE_CHECKING:
    from proboscis import entries
    from proboscis.controller import Controller
    from proboscis.nlp import Nlp
    from proboscis.system import System


@dataclass(frozen=True)
class Iteration:
    """An iterate that the solver accepted."""

    intervals: int
    """Intervals of the grid that is being solved."""
    iteration: int
    """Its number; the starting point is number zero."""
    objective: float
    infeasibility: float
    """Greatest scaled violation of a constraint."""
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

    `scene` is a `System`, a dict, or the path of a scene file; of `control`, `simulate`, `equilibrium` and `identify` exactly one is given, as
    in the file; `feedback` stands beside a `control`. It is checked at once; `Error` has the path of the wrong entry.
    """

    name: str
    """Name of its file in messages and results."""
    folder: Path
    """Where files that the problem names are looked for."""
    task: str
    """What it asks for: `control`, `simulate`, `equilibrium` or `identify`."""

    def __init__(
        self,
        scene: System | entries.Text | Mapping[str, Any],
        *,
        control: entries.Control | None = None,
        simulate: entries.Simulate | None = None,
        equilibrium: entries.Equilibrium | None = None,
        identify: entries.Identify | None = None,
        output: entries.Output | None = None,
        feedback: entries.Feedback | None = None,
        folder: str | PathLike[str] = ".",
    ) -> None:
        given = {
            "control": control,
            "simulate": simulate,
            "equilibrium": equilibrium,
            "identify": identify,
            "output": output,
            "feedback": feedback,
        }
        self._take({"scene": scene, **{key: value for key, value in given.items() if value is not None}}, Path(folder), "problem.json")

    @classmethod
    def _asking(cls, scene: System, task: str, asked: Mapping[str, Any], folder: Path) -> Problem:
        return cls._of({"scene": scene, task: asked}, folder, "problem.json")

    def _take(self, content: Mapping[str, Any], folder: Path, name: str) -> None:
        self._content = {str(key): plain(value, str(key)) for key, value in content.items()}
        _leave_gaps(self._content.get("identify"))
        self.folder = folder
        self.name = name
        self.task = ended(_proboscis.task(self._input, self._text), _answer)

    @property
    def _input(self) -> Path:
        return self.folder / self.name

    @property
    def _text(self) -> str:
        return as_json(self._content, indent=2)

    @classmethod
    def from_dict(cls, content: Mapping[str, Any], /, *, folder: str | PathLike[str] = ".") -> Problem:
        """Makes a problem of the content of a problem file; `folder` is where files that it names are looked for."""
        if not isinstance(content, Mapping):
            raise Error(f"found {content!r}, expected the content of a problem file")
        return cls._of(content, Path(folder), "problem.json")

    @classmethod
    def from_file(cls, path: str | PathLike[str], /) -> Problem:
        """Reads a problem file. Raises `Error` where it is wrong."""
        path = Path(path)
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise Error(f"{path}: found no readable file ({error}), expected a JSON file") from error
        # What is read twice, such as a repeated key, is a mistake of the text alone.
        ended(_proboscis.task(path, text), _answer)
        return cls._of(json.loads(text), path.parent, path.name)

    @classmethod
    def _of(cls, content: Mapping[str, Any], folder: Path, name: str) -> Problem:
        problem = cls.__new__(cls)
        problem._take(content, folder, name)
        return problem

    def to_dict(self) -> dict[str, Any]:
        """Returns the content of the problem file, a copy."""
        return copy.deepcopy(self._content)

    def changed(self, changes: Mapping[str, Any], /) -> Problem:
        """Returns the problem with other entries, such as `{"control.intervals": 80}`.

        Lists are counted from zero: `scene.muscles[1].material`. Where an entry of a scene in a file of its own is another one, the
        problem holds the whole scene.
        """
        words = [f"{path}={as_json(plain(value, path))}" for path, value in changes.items()]
        text = ended(_proboscis.changed(self._input, self._text, words), _answer)
        return self._of(json.loads(text), self.folder, self.name)

    def save(self, path: str | PathLike[str], /) -> None:
        """Writes the problem file."""
        with told(f"{path}"):
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

        `start` is a result to start from in place of the guess. `on_iteration` hears of every iterate; an exception from it ends the run in
        good order and comes out, with the result so far as its attribute `result` (`None` where there is none yet). Ctrl-C raises
        `Interrupted`, a `KeyboardInterrupt`, at once; its `result` waits until the run has ended and written its files. `max_seconds` and
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

    def identify(
        self,
        *,
        max_seconds: float | None = None,
        output: str | PathLike[str] | None = None,
    ) -> Result:
        """Fits constants to recordings; as `solve`, of a problem that asks to `identify`. `identification` of the result has what was found.

        Recordings are CSV files (`"file": "step.csv"`) or arrays (`"columns": {"time [s]": times, "tip [mm]": places}`), in which NaN is a gap.
        """
        self._asks("identify")
        return self._run("identify", None, None, max_seconds, None, None, False, output)

    def nlp(self) -> Nlp:
        """Returns the nonlinear program of a control problem, for a solver of one's own.

        It is that of the first solve: voltages that hold the goal are unknowns where the goal has `"hold": "find"`, not where `solve` seeks them in a
        second one.
        """
        from proboscis.nlp import Nlp

        return Nlp(_proboscis.Program(self._input, self._text))

    def controller(self, intervals: int) -> Controller:
        """Solves the control problem, and returns a controller that plans anew over a horizon of a number of its intervals."""
        from proboscis.controller import Controller

        if intervals < 1:
            raise Error(f"intervals: found {intervals}, expected 1 or more", "intervals")
        return Controller(_proboscis.Controller(self._input, self._text, intervals))

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
        positive("max_seconds", max_seconds)
        positive("accuracy", accuracy)
        counted("max_iterations", max_iterations, least=0)
        problem = self if start is None else self._from(start)
        folder, kept = room(output)
        before = _state(folder / "summary.json")
        outcome = _proboscis.run(
            problem._input,
            problem._text,
            folder,
            f"Problem.{method}",
            max_seconds=max_seconds,
            max_iterations=max_iterations,
            accuracy=accuracy,
            estimate_error=estimate_error,
            observer=observer,
        )

        def read(told: tuple[bool, str, list[str]]) -> Result:
            # A state of rest that is refused leaves no files, and those of an earlier run alone.
            return Result(folder, told, kept, is_written=_state(folder / "summary.json") != before)

        return ended(outcome, read, keeps=kept is None)

    def _from(self, start: Result) -> Problem:
        if self.task != "control":
            raise Error(f"start: the problem asks to {self.task}, which starts from no result", "start")
        content = self.to_dict()
        control = content["control"]
        motions = control.get("motions")
        named = [(one, one.get("name") or f"motion{number}") for number, one in enumerate(motions or [], 1)]
        for place, folder in [(one, start.folder / name) for one, name in named] or [(control, start.folder)]:
            solution = folder / "solution.json"
            if not solution.is_file():
                raise Error("start: the result holds no motion to start from", "start")
            place["guess"] = {"solution": str(solution.resolve())}
        return self._of(content, self.folder, self.name)

    def __repr__(self) -> str:
        scene = self._content.get("scene")
        name = scene.get("name") if isinstance(scene, dict) else scene
        return f"<Problem: {self.task} {name!r}>"


def _leave_gaps(asked: Any) -> None:
    """Takes numbers that are NaN out of the columns of recordings."""
    recordings = asked.get("recordings") if isinstance(asked, dict) else None
    for recording in recordings if isinstance(recordings, list) else []:
        columns: Any = recording.get("columns") if isinstance(recording, dict) else None
        for header, values in columns.items() if isinstance(columns, dict) else []:
            if isinstance(values, list):
                columns[header] = [None if isinstance(one, float) and math.isnan(one) else one for one in values]


def _state(path: Path) -> tuple[int, int] | None:
    """What changes when a file is written anew."""
    try:
        stat = path.stat()
    except OSError:
        return None
    return stat.st_ino, stat.st_mtime_ns


def _answer(told: tuple[bool, str, list[str]]) -> str:
    return told[1]
