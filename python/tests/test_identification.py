"""Constants from recordings: arrays and files in, values with intervals and residuals out."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import proboscis as pb

MASS, DAMPING, STIFFNESS = 0.05, 0.6, 200.0
TIMES = np.linspace(0.0, 0.15, 31)
FREE: Any = {"springs.stay.stiffness": {"min": "50 N/m", "max": "900 N/m"}, "joints.slide.damping": {"min": 0.1, "max": 5}}


def cart() -> pb.System:
    """A cart on a damped slide, held by a spring."""
    system = pb.System("cart")
    cart = system.add(pb.Body("cart", mass=MASS, position=[0, 0, 0], box={"size": ["20 mm", "20 mm", "20 mm"]}))
    system.add(pb.Joint("slide", prismatic={"axis": [1, 0, 0]}, parent=pb.GROUND, child=cart, at=[0, 0, 0], damping=1.0))
    ends: Any = {"from_": {"body": pb.GROUND, "at": ["-50 mm", 0, 0]}, "to": {"body": cart, "at": [0, 0, 0]}}
    system.add(pb.Spring("stay", stiffness=120, **ends))
    return system


def place(times: Any, start: float) -> Any:
    """The motion in closed form from rest."""
    decay = 0.5 * DAMPING / MASS
    omega = math.sqrt(STIFFNESS / MASS - decay**2)
    return start * np.exp(-decay * times) * (np.cos(omega * times) + decay / omega * np.sin(omega * times))


def recording(name: str, start: float, **others: Any) -> Any:
    noise = 2e-5 * np.random.default_rng(len(name)).standard_normal(len(TIMES))
    places = place(TIMES, start) + noise
    places[7] = np.nan
    return {
        "name": name,
        "columns": {"time [s]": TIMES, "place [m]": places},
        "measured": [{"joint": "slide", "column": "place", "standard_deviation": 2e-5}],
        "experiment": {"start": {"joint_angles": {"slide": start}}},
        **others,
    }


@pytest.fixture(scope="module")
def found() -> pb.Result:
    recordings = [recording("released", 0.005), recording("held out", -0.003, held_out=True)]
    return cart().identify(free=FREE, recordings=recordings)


def test_constants_come_back_with_intervals(found: pb.Result) -> None:
    assert found.is_solved and found.status == "explained"
    of = found.identification
    assert list(of.constants) == sorted(FREE)
    for path, truth in (("springs.stay.stiffness", STIFFNESS), ("joints.slide.damping", DAMPING)):
        constant = of.constants[path]
        assert 0 < constant.standard_error < 0.02 * truth and not constant.at_bound
        assert abs(constant.value - truth) < 4 * constant.standard_error
        assert constant.interval is not None and constant.interval[0] < constant.value < constant.interval[1]
    assert of.constants["springs.stay.stiffness"].unit == "N/m"
    assert of.correlation.shape == (2, 2) and np.allclose(np.diag(of.correlation), 1)
    errors = [constant.standard_error for constant in of.constants.values()]
    assert np.allclose(np.sqrt(np.diag(of.covariance)), errors)
    assert of.undetermined == [] and 0.3 < of.reduced_chi_square < 3
    assert of.held_out["held out"].is_explained and of.next_experiments == []


def test_residuals_are_arrays_without_gaps(found: pb.Result) -> None:
    fitted, held_out = found.identification.residuals
    assert (fitted.recording, fitted.quantity, fitted.unit, fitted.held_out) == ("released", "place", "m", False)
    assert held_out.held_out and fitted.time.shape == (30,) and TIMES[7] not in fitted.time
    assert np.allclose(fitted.predicted, place(fitted.time, 0.005), atol=3e-5)
    assert 1e-5 < np.std(fitted.residual) < 4e-5 and np.all(fitted.standard_deviation == 2e-5)
    assert abs(fitted.measured).max() > 4e-3


def test_results_are_loaded_and_problems_written_back(found: pb.Result, tmp_path: Path) -> None:
    found.save(tmp_path)
    loaded = pb.load(tmp_path)
    assert loaded.is_solved and loaded.identification.constants == found.identification.constants
    table = "\n".join(["time [ms],place [mm]", *(f"{1e3 * t},{1e3 * x}" for t, x in zip(TIMES, place(TIMES, 0.005)))])
    (tmp_path / "step.csv").write_text(table)
    entry = {**recording("released", 0.005), "file": "step.csv"}
    del entry["columns"]
    asked: Any = {"free": FREE, "recordings": [entry]}
    problem = pb.Problem(cart(), identify=asked, folder=tmp_path)
    assert problem.task == "identify" and problem.to_dict()["identify"]["recordings"][0]["file"] == "step.csv"
    value = problem.identify().identification.constants["springs.stay.stiffness"].value
    assert abs(value / STIFFNESS - 1) < 1e-4


def test_a_start_that_is_sought_is_told() -> None:
    entry = recording("released", 0.005)
    entry["experiment"] = {"sought_start": "state"}
    start = cart().identify(free=FREE, recordings=[entry]).identification.starts["released"]["slide"]
    assert abs(start.value - 0.005) < 1e-4 and abs(start.rate) < 0.02


def test_mistakes_have_their_place(found: pb.Result) -> None:
    short: Any = {**recording("one", 0.005), "columns": {"time [s]": [0, 1], "place [m]": [1]}}
    with pytest.raises(pb.Error, match="columns") as told:
        cart().identify(free=FREE, recordings=[short])
    assert told.value.path.startswith("identify.recordings[0].columns")
    with pytest.raises(pb.Error, match="does not ask"):
        pb.Problem(cart(), identify={"free": FREE, "recordings": [recording("one", 0.005)]}).simulate()
    with pytest.raises(pb.Error, match="only the result of an identification"):
        _ = cart().simulate(duration="10 ms", step="5 ms").identification
