"""What a system is made of: thin names for the entries of a scene file.

Entries are those of the scene's JSON Schema (`proboscis.schema("scene")`); numbers are in SI units, texts have a unit. Positions and axes are given in the
reference configuration, in the ground frame. Where JSON wants a name, the part itself may stand; a keyword of Python has an underscore
behind it (`from_`).
"""

from __future__ import annotations

from typing import Any, ClassVar

from proboscis._error import Error
from proboscis._plain import plain

GROUND = "ground"
"""The body that does not move."""


class Part:
    """An entry of a scene with a name; a system gives one to a part without."""

    kind: ClassVar[str]
    """Its list in the scene."""
    noun: ClassVar[str]

    name: str | None
    entries: dict[str, Any]
    """What is written of it, but its name."""

    def __init__(self, name: str | None = None, /, **entries: Any) -> None:
        given = {key.removesuffix("_"): value for key, value in entries.items()}
        self.name = name if name is not None else given.pop("name", None)
        self.entries = given

    @classmethod
    def from_dict(cls, entries: dict[str, Any], /) -> Part:
        """Makes the part of its JSON object."""
        return cls(**entries)

    def to_dict(self) -> dict[str, Any]:
        """Returns its JSON object."""
        named = {} if self.name is None else {"name": self.name}
        return {**named, **{key: plain(value, key) for key, value in self.entries.items()}}

    def __proboscis__(self) -> str:
        if self.name is None:
            raise Error(f"{self!r} has no name: add it to a system first, or name it")
        return self.name

    def __repr__(self) -> str:
        entries = "".join(f", {key}={value!r}" for key, value in self.entries.items())
        return f"{type(self).__name__}({self.name!r}{entries})"


class Material(Part):
    """A dielectric elastomer: `shear_modulus` (Pa), `density` (kg/m³), `relative_permittivity`, `viscosity` (Pa s), `lame_lambda` (Pa) or `poisson_ratio`."""

    kind, noun = "materials", "material"


class Body(Part):
    """A rigid body: `mass` (kg), `position` (m, three numbers), and `cylinder`, `box`, `sphere` or `inertia` (kg m²)."""

    kind, noun = "bodies", "body"


class Joint(Part):
    """A joint: `parent`, `child`, `at` (m), and `revolute={"axis": …}`, `prismatic={"axis": …}`, `spherical={}`, `floating={}` or `fixed={}`."""

    kind, noun = "joints", "joint"


class Muscle(Part):
    """A muscle: `material`, `cross_section` (m, two numbers), `layer_thickness` (m), `from_` and `to`, each `{"body": …, "at": …}`."""

    kind, noun = "muscles", "muscle"


class Solid(Part):
    """An elastic block of finite elements: `material`, `box` or a mesh file, electrodes, supports."""

    kind, noun = "solids", "solid"


class Spring(Part):
    """A spring or damper between two points: `from_`, `to`, `stiffness` (N/m), `damping` (N s/m), …."""

    kind, noun = "springs", "spring"


class Tendon(Part):
    """An elastic cable through points."""

    kind, noun = "tendons", "tendon"


class Marker(Part):
    """A point whose motion is reported: `body`, `at` (m)."""

    kind, noun = "markers", "marker"
