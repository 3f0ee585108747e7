"""A system: what exists."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

from proboscis._error import Error
from proboscis._plain import plain
from proboscis.parts import Part
from proboscis.problem import Problem, Step
from proboscis.result import Result

_Part = TypeVar("_Part", bound=Part)


class System:
    """What exists: the content of a scene file.

    `System("arm", gravity=[0, -9.81, 0])` is a scene with a name and other entries of its schema, to which parts are added.
    """

    scene: dict[str, Any]
    """The scene; parts stand in it as they were added."""
    folder: Path
    """Where files that the scene names are looked for."""

    def __init__(self, name: str, /, *, folder: str | PathLike[str] = ".", **entries: Any) -> None:
        self.scene = {"name": name, **entries}
        self.folder = Path(folder)

    @classmethod
    def from_dict(cls, scene: dict[str, Any], /, *, folder: str | PathLike[str] = ".") -> System:
        """Makes a system of the content of a scene file; `folder` is where files that it names are looked for."""
        entries = copy.deepcopy(scene)
        name = entries.pop("name", None)
        if not isinstance(name, str):
            raise Error(f"name: found {name!r}, expected the name of the scene", "name")
        return cls(name, folder=folder, **entries)

    @classmethod
    def from_file(cls, path: str | PathLike[str], /) -> System:
        """Reads a scene file. Raises `Error` where it is no JSON object."""
        path = Path(path)
        try:
            scene = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise Error(f"{path}: found no readable JSON ({error}), expected a scene file") from error
        if not isinstance(scene, dict):
            raise Error(f"{path}: found {type(scene).__name__}, expected an object")
        return cls.from_dict(scene, folder=path.parent)

    def add(self, part: _Part, /) -> _Part:
        """Adds a part and returns it; without a name it gets one, such as `muscle3`."""
        materials = part.kind == "materials"
        there = self.scene.setdefault(part.kind, {} if materials else [])
        if part.name is None:
            part.name = f"{part.noun}{len(there) + 1}"
        if materials:
            if part.name in there:
                raise Error(f"materials.{part.name}: found a second time, expected a name that is not taken", f"materials.{part.name}")
            there[part.name] = part
        else:
            there.append(part)
        return part

    def to_dict(self) -> dict[str, Any]:
        """Returns the content of the scene file."""
        scene: dict[str, Any] = {}
        for key, value in self.scene.items():
            if key == "materials":
                scene[key] = {name: _entries(entry, f"{key}.{name}") for name, entry in value.items()}
            elif isinstance(value, list):
                scene[key] = [_listed(entry, f"{key}[{index}]") for index, entry in enumerate(value)]
            else:
                scene[key] = plain(value, key)
        return scene

    def save(self, path: str | PathLike[str], /) -> None:
        """Writes the scene file."""
        Path(path).write_text(json.dumps(self.to_dict(), indent=2, ensure_ascii=False) + "\n", encoding="utf-8")

    def control(self, **control: Any) -> Problem:
        """Returns the optimal control problem with these entries of `control` in a problem file: `duration`, `intervals`, `start`, `goal`, `voltage_bounds`, `objective`, …."""
        return Problem(self, control=control, folder=self.folder)

    def simulate(
        self,
        *,
        output: str | PathLike[str] | None = None,
        on_step: Callable[[Step], object] | None = None,
        max_seconds: float | None = None,
        **simulate: Any,
    ) -> Result:
        """Simulates with these entries of `simulate` in a problem file: `duration`, `step`, `start`, `voltages`, …; the others are those of `Problem.solve`."""
        problem = Problem(self, simulate=simulate, folder=self.folder)
        return problem.simulate(output=output, on_step=on_step, max_seconds=max_seconds)

    def equilibrium(
        self,
        *,
        output: str | PathLike[str] | None = None,
        max_seconds: float | None = None,
        **equilibrium: Any,
    ) -> Result:
        """Finds the state of rest with these entries of `equilibrium` in a problem file: `voltages`, `path`, …; the others are those of `Problem.solve`."""
        problem = Problem(self, equilibrium=equilibrium, folder=self.folder)
        return problem.equilibrium(output=output, max_seconds=max_seconds)

    def __proboscis__(self) -> dict[str, Any]:
        return self.to_dict()

    def __repr__(self) -> str:
        counts = [f"{len(value)} {key}" for key, value in self.scene.items() if isinstance(value, (list, dict)) and key != "gravity"]
        return f"<System {self.scene['name']!r}: {', '.join(counts) or 'empty'}>"


def _listed(entry: Any, path: str) -> Any:
    return entry.to_dict() if isinstance(entry, Part) else plain(entry, path)


def _entries(material: Any, path: str) -> Any:
    if isinstance(material, Part):
        return {key: plain(value, f"{path}.{key}") for key, value in material.entries.items()}
    return plain(material, path)
