"""The nonlinear program of a joint with two muscles, solved by scipy's trust-region method in place of Ipopt."""

import warnings
from pathlib import Path

import numpy as np
from scipy.optimize import Bounds, NonlinearConstraint, minimize

import proboscis as pb


def solve(nlp: pb.Nlp) -> tuple[float, float]:
    """Objective of the optimum, and how far it violates its constraints."""
    constraint = NonlinearConstraint(
        nlp.constraints, *nlp.constraint_bounds, jac=nlp.jacobian, hess=lambda x, y: nlp.hessian(x, y, 0.0)
    )
    none = np.zeros(nlp.m)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = minimize(
            nlp.objective,
            nlp.start,
            jac=nlp.gradient,
            hess=lambda x: nlp.hessian(x, none),
            bounds=Bounds(*nlp.bounds),
            constraints=constraint,
            method="trust-constr",
            options={"gtol": 1e-9, "xtol": 1e-12, "maxiter": 2000},
        )
    return float(found.fun), float(found.constr_violation)


def main() -> None:
    problem = pb.Problem.from_file(Path(__file__).parents[2] / "problems" / "pair.json")
    optimum = problem.solve()
    objective, violation = solve(problem.nlp())
    print(f"Ipopt {optimum.objective:.9f}, trust-constr {objective:.9f}, violated by {violation:.1e}")


if __name__ == "__main__":
    main()
