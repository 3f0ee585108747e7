"""What all parts of a system have in common."""

from __future__ import annotations

import keyword
from collections.abc import Mapping
from typing import Any, ClassVar, TypeVar

from proboscis._error import Error
from proboscis._plain import plain

GROUND = "ground"
"""The body that does not move."""

_Part = TypeVar("_Part", bound="Part")


class Part:
    """An entry of a scene with a name; a system gives one to a part without."""

    kind: ClassVar[str]
    """Its list in the scene."""
    noun: ClassVar[str]

    name: str | None
    entries: dict[str, Any]
    """What is written of it, but its name."""

    def __init__(self, name: str | None, entries: Mapping[str, Any], /) -> None:
        self.name = name
        self.entries = {key: value for key, value in entries.items() if value is not None}

    @classmethod
    def from_dict(cls: type[_Part], entries: Mapping[str, Any], /) -> _Part:
        """Makes the part of its JSON object."""
        if not isinstance(entries, Mapping):
            raise Error(f"found {entries!r}, expected the entries of a {cls.noun}")
        given = dict(entries)
        name = given.pop("name", None)
        if not (name is None or isinstance(name, str)):
            raise Error(f"name: found {name!r}, expected a text", "name")
        part = cls.__new__(cls)
        Part.__init__(part, name, given)
        return part

    def to_dict(self) -> dict[str, Any]:
        """Returns its JSON object."""
        named = {} if self.name is None else {"name": self.name}
        return {**named, **{key: plain(value, key) for key, value in self.entries.items()}}

    def __proboscis__(self) -> str:
        if self.name is None:
            raise Error(f"{self!r} has no name: add it to a system first, or name it")
        return self.name

    def __repr__(self) -> str:
        words = ((f"{key}_" if keyword.iskeyword(key) else key, value) for key, value in self.entries.items())
        entries = "".join(f", {key}={value!r}" for key, value in words)
        return f"{type(self).__name__}({self.name!r}{entries})"
