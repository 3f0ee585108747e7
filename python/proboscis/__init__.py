"""Simulation and optimal control of robots driven by dielectric elastomer muscles.

A `System` of parts is asked to `simulate`, for an `equilibrium`, for a `control` problem, which is then solved, or to `identify` constants; a `Problem` does what a
problem file asks. Entries are those of the JSON files; numbers are in SI units, texts have a unit. What comes back is a `Result`: numpy arrays in SI units
and the files of the command line. All mistakes are one exception, `Error`, with the path of the wrong entry. `sweep`, `study`, `starts`, `inspect` and `check` are the commands of these names.
"""

from __future__ import annotations

import json
from typing import Any

from proboscis import _proboscis, entries
from proboscis._ending import Interrupted
from proboscis._error import Error
from proboscis._table import Table
from proboscis.commands import Starts, Study, Sweep, check, inspect, starts, study, sweep
from proboscis.controller import Controller
from proboscis.identification import Identification
from proboscis.nlp import Nlp
from proboscis.parts import GROUND, Body, Contact, ContactShape, Joint, Load, Marker, Material, Muscle, Part, Solid, Spring, Tendon
from proboscis.problem import Iteration, Problem, Step
from proboscis.result import Figure, Result
from proboscis.sensitivity import Sensitivity
from proboscis.system import System

__version__ = _proboscis.version

__all__ = [
    "GROUND",
    "Body",
    "Contact",
    "ContactShape",
    "Controller",
    "Error",
    "Figure",
    "Identification",
    "Interrupted",
    "Iteration",
    "Joint",
    "Load",
    "Marker",
    "Material",
    "Muscle",
    "Nlp",
    "Part",
    "Problem",
    "Result",
    "Sensitivity",
    "Solid",
    "Spring",
    "Starts",
    "Step",
    "Study",
    "Sweep",
    "System",
    "Table",
    "Tendon",
    "check",
    "entries",
    "inspect",
    "load",
    "schema",
    "starts",
    "study",
    "sweep",
]

load = Result.load


def schema(file: str = "problem") -> dict[str, Any]:
    """Returns the JSON Schema of a `scene` or of a `problem`."""
    scene, problem = _proboscis.schema()
    files = {"scene": scene, "problem": problem}
    if file not in files:
        raise Error(f"file: found {file!r}, expected 'scene' or 'problem'", "file")
    schema: dict[str, Any] = json.loads(files[file])
    return schema
