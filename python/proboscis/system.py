"""A system: what exists."""

from __future__ import annotations

import copy
import json
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

from proboscis._error import Error, told
from proboscis._part import Part
from proboscis._plain import as_json, plain
from proboscis._questions import Questions
from proboscis.problem import Problem

_Part = TypeVar("_Part", bound=Part)


class System(Questions):
    """What exists: the content of a scene file.

    `System("arm", gravity=[0, -9.81, 0])` is a scene with a name and other entries of its schema, to which parts are added.
    """

    __slots__ = ("folder", "scene")

    scene: dict[str, Any]
    """The scene; parts stand in it as they were added."""
    folder: Path
    """Where files that the scene names are looked for."""

    def _begin(self, name: str, folder: str | PathLike[str], scene: Mapping[str, Any]) -> None:
        self.scene = {"name": name, **{key: value for key, value in scene.items() if value is not None}}
        self.folder = Path(folder)

    @classmethod
    def from_dict(cls, scene: Mapping[str, Any], /, *, folder: str | PathLike[str] = ".") -> System:
        """Makes a system of the content of a scene file; `folder` is where files that it names are looked for."""
        if not isinstance(scene, Mapping):
            raise Error(f"found {scene!r}, expected the content of a scene file")
        entries = copy.deepcopy(dict(scene))
        name = entries.pop("name", None)
        if not isinstance(name, str):
            raise Error(f"name: found {name!r}, expected the name of the scene", "name")
        system = cls.__new__(cls)
        system._begin(name, folder, entries)
        return system

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
        """Adds a part and returns it; without a name it gets one, such as `muscle3`; contacts `between` shapes are named by these."""
        if not isinstance(part, Part):
            raise Error(f"found {part!r}, expected a part")
        materials = part.kind == "materials"
        there = self.scene.setdefault(part.kind, {} if materials else [])
        if part.name is None and "between" not in part.entries:
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
        text = as_json(self.to_dict(), indent=2)
        with told(f"{path}"):
            Path(path).write_text(text + "\n", encoding="utf-8")

    def _problem(self, task: str, asked: dict[str, Any]) -> Problem:
        given = {key: value for key, value in asked.items() if value is not None}
        return Problem._asking(self, task, given, self.folder)

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
