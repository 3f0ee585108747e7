"""The package does what the command line does, bit by bit."""

import json
import os
import subprocess
from pathlib import Path

import pytest

import proboscis as pb

PROBLEMS = Path(__file__).parents[2] / "problems"


def without_origin(path: Path) -> str:
    lines = path.read_text().splitlines()
    assert lines[0].startswith("#") and len(lines) > 1
    return "\n".join(lines[1:])


@pytest.mark.parametrize("name", ["pair", "elephant_trunk", "pair_constant", "pull_in"])
def test_command_line_and_package_agree(name: str, tmp_path: Path) -> None:
    program = os.environ["PROBOSCIS"]
    path = PROBLEMS / f"{name}.json"
    there, here = tmp_path / "there", tmp_path / "here"
    subprocess.run([program, "solve", path, "-o", there, "--quiet"], check=True, capture_output=True)
    result = pb.Problem.from_file(path).solve(output=here)
    assert result.is_solved
    names = sorted(file.name for file in there.iterdir())
    assert names == sorted(file.name for file in here.iterdir())
    compared = [file for file in names if file.endswith(".csv")]
    assert compared
    for file in compared:
        assert without_origin(there / file) == without_origin(here / file), file
    if (there / "solution.json").is_file():
        compared.append("solution.json")
        assert (there / "solution.json").read_bytes() == (here / "solution.json").read_bytes()
    one, other = (json.loads((folder / "summary.json").read_text()) for folder in (there, here))
    for key in ("status", "objective", "iterations", "variables", "jacobian_nonzeros"):
        assert one.get(key) == other.get(key), key
    # Nothing is compared with itself.
    assert one["command"] != other["command"]
    loaded = pb.load(there)
    assert loaded.is_solved and loaded.status == result.status
    assert list(loaded.table) == list(result.table)
