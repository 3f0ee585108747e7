"""A controller in a loop with a simulated robot."""

from pathlib import Path

import numpy as np
import pytest

import proboscis as pb

PROBLEMS = Path(__file__).parents[2] / "problems"


@pytest.fixture(scope="module")
def pair() -> pb.Problem:
    return pb.Problem.from_file(PROBLEMS / "pair.json")


def test_inputs_follow_what_is_measured(pair: pb.Problem) -> None:
    controller = pair.controller(6)
    assert list(controller.measured.values()) == ["rad", "rad/s"]
    assert controller.inputs == {"muscle1": "V", "muscle2": "V"} and controller.interval == 0.01
    # At its goal the pair is held by 1.7 kV of one muscle; off it the muscle pulls more or less.
    held = controller.step(1.0, [0.1514, 0.0])
    assert controller.source == "plan" and held[1] == pytest.approx(1700.0, abs=10.0)
    assert np.array_equal(controller.step(1.001, [0.2, 0.0]), held)
    less = controller.step(1.01, [0.16, 0.0])
    more = controller.step(1.02, [0.14, 0.0])
    assert less[1] < held[1] < more[1]
    controller.step(1.03, None)
    assert controller.source == "late"
    kept = controller.step(1.04, [np.nan, 0.0])
    assert controller.source == "unusable"
    # A time that is none, and one that is far ahead; then all goes on.
    assert np.array_equal(controller.step(np.inf, [0.16, 0.0]), kept)
    controller.step(1e30, [0.16, 0.0])
    assert controller.step(1.05, [0.16, 0.0])[1] < held[1] and controller.source == "plan"


def test_mistakes(pair: pb.Problem) -> None:
    with pytest.raises(pb.Error, match="intervals"):
        pair.controller(0)
    with pytest.raises(pb.Error, match="no more than 10000"):
        pair.controller(10**9)
    with pytest.raises(pb.Error, match="expected 2"):
        pair.controller(2).step(0.0, [1.0])
    with pytest.raises(pb.Error, match="integral"):
        pb.Problem.from_file(PROBLEMS / "pair_feedback.json").controller(4)
    with pytest.raises(pb.Error, match="only"):
        pb.Problem.from_file(PROBLEMS / "pair_constant.json").controller(4)
