"""The nonlinear program: derivatives against differences, and the same optimum by another solver."""

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import approx_fprime

import proboscis as pb

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "examples"))
import own_solver  # noqa: E402

PROBLEMS = HERE.parents[1] / "problems"


@pytest.fixture(scope="module")
def pair() -> pb.Problem:
    return pb.Problem.from_file(PROBLEMS / "pair.json")


def test_derivatives_agree_with_differences(pair: pb.Problem) -> None:
    nlp = pair.nlp()
    random = np.random.default_rng(1)
    x = nlp.start + 1e-2 * random.standard_normal(nlp.n)
    y = random.standard_normal(nlp.m)
    gradient = nlp.gradient(x)
    jacobian, hessian = nlp.jacobian(x), nlp.hessian(x, y, 0.7)
    assert jacobian.shape == (nlp.m, nlp.n) and hessian.shape == (nlp.n, nlp.n)
    assert np.linalg.norm(gradient) > 1e-3 and jacobian.nnz > nlp.n and hessian.nnz > nlp.n
    assert np.allclose(gradient, approx_fprime(x, nlp.objective), rtol=1e-4, atol=1e-5)
    step = 1e-6
    for j in range(nlp.n):
        ahead, behind = x.copy(), x.copy()
        ahead[j] += step
        behind[j] -= step
        column = (nlp.constraints(ahead) - nlp.constraints(behind)) / (2 * step)
        assert np.allclose(jacobian[:, [j]].toarray().ravel(), column, rtol=1e-5, atol=1e-5)

        def slope(at: np.ndarray) -> np.ndarray:
            return 0.7 * nlp.gradient(at) + nlp.jacobian(at).T @ y

        column = (slope(ahead) - slope(behind)) / (2 * step)
        assert np.allclose(hessian[:, [j]].toarray().ravel(), column, rtol=1e-4, atol=1e-4)


def test_names_and_bounds(pair: pb.Problem) -> None:
    nlp = pair.nlp()
    assert len(nlp.names) == nlp.n == len(set(nlp.names)) and len(nlp.constraint_names) == nlp.m
    assert any("muscle1" in name for name in nlp.names)
    lower, upper = nlp.bounds
    assert (lower <= upper).all() and np.isfinite(upper).any()
    assert (nlp.constraint_bounds[0] == nlp.constraint_bounds[1]).any()
    with pytest.raises(pb.Error, match="expected"):
        nlp.objective(np.zeros(3))
    with pytest.raises(pb.Error, match="only"):
        pb.Problem.from_file(PROBLEMS / "pair_constant.json").nlp()


def test_another_solver_finds_the_same_optimum(pair: pb.Problem) -> None:
    optimum = pair.solve()
    nlp = pair.nlp()
    assert abs(nlp.objective(nlp.start) / optimum.objective - 1) > 1e-3
    objective, violation = own_solver.solve(nlp)
    assert violation < 1e-8
    assert np.isclose(objective, optimum.objective, rtol=1e-5)
