"""What the commands do is what the functions of their names do."""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import proboscis as pb

PROBLEMS = Path(__file__).parents[2] / "problems"
SWEEP: dict[str, Any] = {
    "problem": "pair.json",
    "vary": {"scene.materials.silicone.shear_modulus": ["50 kPa", "100 kPa"], "control.intervals": [10, 20]},
}


def command(*words: object) -> str:
    done = subprocess.run([os.environ["PROBOSCIS"], *map(str, words)], check=True, capture_output=True, text=True)
    return done.stdout


def test_sweeps_are_those_of_the_command(tmp_path: Path) -> None:
    path = tmp_path / "sweep.json"
    path.write_text(json.dumps({**SWEEP, "problem": str(PROBLEMS / "pair.json")}))
    command("sweep", path, "-o", tmp_path / "there", "--quiet")
    swept = pb.sweep(SWEEP, folder=PROBLEMS, output=tmp_path / "here")
    assert swept.is_solved and len(swept["objective"]) == 4 and len(set(swept["objective"])) == 4
    assert set(swept["scene.materials.silicone.shear_modulus"]) == {50e3, 100e3}
    there = pb.sweep(path, output=tmp_path / "there")
    for name in swept:
        if name != "seconds":
            np.testing.assert_array_equal(swept[name], there[name], err_msg=name)
    # In SI units, as the results of the variants.
    assert swept.units["end: tip_x"] == "m"
    for place, result in zip(swept["end: tip_x"], swept.results()):
        assert result is not None and np.isclose(result.position("tip")[-1, 0], place, rtol=1e-12)
    # Half of it, and then the other half alone.
    half = pb.sweep(SWEEP, folder=PROBLEMS, output=tmp_path / "halves", shard="1/2")
    assert [result is not None for result in half.results()] == [True, False, True, False]
    whole = pb.sweep(SWEEP, folder=PROBLEMS, output=tmp_path / "halves", shard="2/2")
    assert whole.is_solved and "2 found solved before" in whole.message
    assert len(pb.sweep(SWEEP, folder=PROBLEMS).to_pandas()) == 4


def test_solves_that_need_the_process_alone_are_swept_in_turn(tmp_path: Path) -> None:
    content = {"problem": "pair.json", "set": {"control.solver.linear_solver": "mumps"}, "vary": {"control.intervals": [5, 10]}}
    swept = pb.sweep(content, folder=PROBLEMS)
    assert list(swept["status"]) == ["solved", "solved"]
    for result in swept.results():
        assert result is not None and result.summary["linear_solver"]["name"] == "mumps"


def test_a_study_has_its_figures_and_its_conclusion(tmp_path: Path) -> None:
    content = {
        "title": "steps",
        "problem": "pair_constant.json",
        "set": {"simulate.duration": "0.1 s"},
        "methods": [{"name": "midpoint"}],
        "refine": {"name": "step", "set": {"simulate.step": ["10 ms", "5 ms", "2.5 ms", "1.25 ms"]}},
    }
    study = pb.study(content, folder=PROBLEMS, output=tmp_path, runs=2)
    assert study.is_solved and list(study["value"]) == ["10 ms", "5 ms", "2.5 ms", "1.25 ms"]
    assert study["path"][0] > 4 * study["path"][2] > 0 and study.units["path"] == "m"
    assert list(study["runs"]) == [2] * 4 and study.summary["conclusion"] == study.conclusion != ""
    assert (tmp_path / "report.html").is_file()


def test_starts_have_a_best_one() -> None:
    pair = pb.Problem.from_file(PROBLEMS / "pair.json")
    starts = pb.starts(pair, 3, seed=5)
    assert starts.is_solved and list(starts["start"]) == [1, 2, 3] and np.isnan(starts["seed"][0])
    best = starts.best
    del starts
    assert best.is_solved and np.isclose(best.objective, pair.solve().objective, rtol=1e-7)
    assert best.summary["starts"]["count"] == 3


def test_a_problem_is_inspected_and_checked(tmp_path: Path) -> None:
    told = command("inspect", PROBLEMS / "pair.json")
    found = pb.inspect(PROBLEMS / "pair.json")
    assert found["sizes"]["variables"] == pb.Problem.from_file(PROBLEMS / "pair.json").nlp().n
    for name, count in found["sizes"].items():
        assert any(line.split() == [*name.split(), str(count)] for line in told.splitlines()), name
    assert all(effect["name"] in told and effect["why"] in told for effect in found["effects"])
    checked = pb.check(PROBLEMS / "pair.json")
    assert checked["agrees"] and checked["checked"] == checked["variables"] == found["sizes"]["variables"]
    assert 0 < checked["errors"]["jacobian"] < 1e-5 and checked["wrong"] == []
    assert checked["message"] in command("check", PROBLEMS / "pair.json")
