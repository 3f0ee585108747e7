"""What an optimum is good for: sensitivities against re-solves, gains against a recursion of their own."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import proboscis as pb

PROBLEMS = Path(__file__).parents[2] / "problems"


def changed(name: str, changes: dict[str, Any]) -> pb.Problem:
    return pb.Problem.from_file(PROBLEMS / f"{name}.json").changed(changes)


@pytest.fixture(scope="module")
def optimum() -> pb.Result:
    return changed("pair_sensitivity", {"control.solver": {"tolerance": 1e-12}}).solve()


def test_sensitivities_are_those_of_optima_beside(optimum: pb.Result) -> None:
    path = "materials.silicone.shear_modulus"
    of = optimum.sensitivities[path]
    assert of.unit == "Pa" and of.value == pytest.approx(1e5) and of.tolerance == pytest.approx(5e3)
    assert of.valid[0] < of.value < of.valid[1]
    step = 10.0

    def beside(change: float) -> pb.Result:
        changes = {"control.solver": {"tolerance": 1e-12}, f"scene.{path}": of.value + change}
        return changed("pair_sensitivity", changes).solve()

    above, below = beside(step), beside(-step)
    expected = (above.objective - below.objective) / (2 * step)
    assert abs(expected) > 1e-9 and of.objective == pytest.approx(expected, rel=1e-5)
    path_by = (above.joint("joint1") - below.joint("joint1")) / (2 * step)
    assert np.abs(path_by).max() > 1e-9
    np.testing.assert_allclose(of.table["joint1"], path_by, atol=1e-4 * np.abs(path_by).max())
    assert "Sensitivity" in repr(of) and set(optimum.sensitivities) > {"duration", path}


def test_results_without_them_say_so(optimum: pb.Result) -> None:
    with pytest.raises(pb.Error, match="feedback"):
        _ = optimum.feedback
    with pytest.raises(pb.Error, match="sensitivity"):
        _ = changed("pair", {}).solve().sensitivities


def test_gains_are_those_of_the_riccati_recursion() -> None:
    result = pb.Problem.from_file(PROBLEMS / "pair_feedback.json").solve()
    of = result.feedback
    a, b, q, r, k = (of[name] for name in "ABQRK")
    cost = of["S_end"]
    assert len(k) == 20 and np.abs(k).max() > 0
    for n in reversed(range(len(a))):
        inner = r[n] + b[n].T @ cost @ b[n]
        gain = np.linalg.solve(inner, b[n].T @ cost @ a[n])
        np.testing.assert_allclose(k[n], gain, atol=1e-8 * np.abs(gain).max())
        closed = a[n] - b[n] @ gain
        cost = q[n] + gain.T @ r[n] @ gain + closed.T @ cost @ closed
    linalg = pytest.importorskip("scipy.linalg")
    a, b, q, r = (of[f"{name}_held"] for name in "ABQR")
    # Entries near one: inputs are squares of voltages, up to 1e7.
    sizes = np.sqrt(np.diag(r))
    held = linalg.solve_discrete_are(a, b / sizes, q, r / np.outer(sizes, sizes))
    np.testing.assert_allclose(of["S_held"], held, atol=1e-6 * np.abs(held).max())


def test_vibrations_about_an_equilibrium() -> None:
    found = pb.Problem.from_file(PROBLEMS / "trunk_modes.json").equilibrium()
    frequencies = [mode["frequency"] for mode in found.modes]
    assert len(frequencies) == 6 and frequencies == sorted(frequencies)
    response = found.frequency_response
    amplitude = response["tip_x_amplitude"]
    assert response["frequency"][np.argmax(amplitude)] == pytest.approx(frequencies[0], rel=1e-2)
    with pytest.raises(pb.Error, match="only the result"):
        print(changed("pull_in", {"equilibrium.path": 3}).equilibrium().modes)
