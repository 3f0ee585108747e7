"""Keyword arguments are those of the schema, and a checker of types refuses others."""

import importlib.util
import inspect
import json
import keyword
import subprocess
import sys
from pathlib import Path

import pytest

import proboscis as pb
from proboscis import _proboscis

PYTHON = Path(__file__).parents[1]


def test_entries_are_those_of_the_schema() -> None:
    spec = importlib.util.spec_from_file_location("generate", PYTHON / "generate.py")
    assert spec is not None and spec.loader is not None
    generate = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(generate)
    scene, problem = (json.loads(text) for text in _proboscis.schema())
    files = generate.files(scene, problem)
    assert len(files) == 3
    for name, text in files.items():
        assert (PYTHON / "proboscis" / name).read_text(encoding="utf-8") == text, f"{name} is old: run python python/generate.py"
    # One entry more is another text.
    problem["$defs"]["SimulateSpec"]["properties"]["another"] = {"type": "integer"}
    assert generate.files(scene, problem) != files


def test_parts_have_keyword_arguments_of_their_own() -> None:
    definitions = pb.schema("scene")["$defs"]
    for part, spec in ((pb.Material, "MaterialSpec"), (pb.Muscle, "MuscleSpec"), (pb.Tendon, "TendonSpec")):
        names = [f"{key}_" if keyword.iskeyword(key) else key for key in definitions[spec]["properties"]]
        assert set(inspect.signature(part).parameters) == {"name", *names}
        assert all(f"`{name}`" in str(part.__doc__) for name in names if name != "name")
    asked = set(inspect.signature(pb.System.control).parameters) - {"self"}
    assert asked == set(pb.schema()["$defs"]["ControlSpec"]["properties"])
    with pytest.raises(TypeError, match="mas"):
        pb.Body(mas=1)  # type: ignore[call-arg]


GOOD = """
import numpy as np
import proboscis as pb
arm = pb.System("arm", gravity=[0, "-9.81 m/s^2", 0])
silicone = arm.add(pb.Material(shear_modulus="100 kPa", density=1000, relative_permittivity=3))
link = arm.add(pb.Body(mass="30 g", position=np.zeros(3), cylinder={"length": "50 mm", "radius": 0.02, "axis": [0, 1, 0]}))
arm.add(pb.Joint(parent=pb.GROUND, child=link, at=[0, 0, 0], revolute={"axis": [0, 0, 1]}))
muscle = arm.add(pb.Muscle(material=silicone, cross_section=[0.01, "10 mm"], layer_thickness="50 um",
                           from_={"body": pb.GROUND, "at": [0, 0, 0]}, to=pb.entries.Point(body=link, at=np.ones(3))))
problem = arm.control(duration="0.3 s", intervals=40, start={"rest_at_voltages": {}}, goal={"rest_at_voltages": {muscle: "1 kV"}},
                      voltage_bounds=[0, "3 kV"], objective={"effort": 1}, limits=[{"electric_field": {"muscles": "all", "max": "80 V/um"}}])
swing = arm.simulate(duration=1, step="auto", voltages={muscle: {"ramp": {"from": 0, "to": "1 kV", "duration": "0.1 s"}}})
"""

#: What is written in place of what of it.
TYPOS = {
    "shear_modulus": "shear_modulos",
    '"radius"': '"radios"',
    '"axis": [0, 0, 1]': '"axes": [0, 0, 1]',
    "layer_thickness": "layer_thikness",
    "pb.entries.Point(body=": "pb.entries.Point(boddy=",
    "intervals=40": "intervls=40",
    '{"effort": 1}': '{"efort": 1}',
    '"max": "80 V/um"': '"maximum": "80 V/um"',
    'step="auto"': "stepp=1",
    "gravity=": "gravitiy=",
    "intervals=40, start": 'intervals="many", start',
    "parent=pb.GROUND, ": "",
}


def test_mypy_refuses_typos(tmp_path: Path) -> None:
    (tmp_path / "good.py").write_text(GOOD)
    names = ["good.py"]
    for number, (right, wrong) in enumerate(TYPOS.items()):
        assert GOOD.count(right) >= 1, right
        names.append(f"typo{number}.py")
        (tmp_path / names[-1]).write_text(GOOD.replace(right, wrong, 1))
    command = [sys.executable, "-m", "mypy", "--config-file", PYTHON / "pyproject.toml", *names]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    lines = [line for line in done.stdout.splitlines() if ": error: " in line]
    wrong = {line.split(":")[0] for line in lines}
    assert wrong == set(names[1:]), done.stdout + done.stderr
