"""Sensitivities of an optimum beside `pounce-solver`: the same program, its constants pinned by equations, and one step of the optimum.

    python sensitivity.py

proboscis holds a constant and differentiates the optimum by it. pounce-solver, an interior-point method of its own, has the constant as a
variable, a row that pins it, and its own factors. The run ends with an error where a derivative differs by more than 1e-6 of the
greatest one of voltages or of coordinates; what is left of the barrier of pounce-solver is 7e-7.
"""

import pathlib
import tempfile

import numpy as np
import pounce

import proboscis as pb

SCENE = pathlib.Path(__file__).parents[2] / "problems" / "scenes" / "pair.json"
SAME = 1e-6
UPPER = 1200.0
KINDS = {
    "voltages": [("muscle1", "voltage of muscle1 in interval"), ("muscle2", "voltage of muscle2 in interval")],
    "coordinates": [("joint1", "coordinate of joint1 at instant")],
}
# Constants that move no state of rest: start and goal are given by the joint.
CONSTANTS = ["materials.silicone.shear_modulus", "materials.silicone.viscosity", "materials.silicone.relative_permittivity", "chain.mass"]


def problem(constants):
    """A motion from joint angle to joint angle, whose voltages reach bounds with multipliers."""
    control = {
        "duration": "0.15 s",
        "intervals": 20,
        "start": {"joint_angles": {"joint1": "0 rad"}},
        "goal": {"joint_angles": {"joint1": "0.1 rad"}, "hold": "none"},
        "voltage_bounds": ["0.3 kV", f"{UPPER} V"],
        "objective": {"effort": 1.0, "rate": 0.001},
        "solver": {"tolerance": 1e-12},
    }
    return pb.Problem(str(SCENE), control={**control, **constants})


class Pinned:
    """The program of proboscis with a row for each of its parameters, in the interface of Ipopt."""

    def __init__(self, nlp, pins):
        self.nlp, self.pins = nlp, pins

    def objective(self, x):
        return self.nlp.objective(x)

    def gradient(self, x):
        return self.nlp.gradient(x)

    def constraints(self, x):
        return np.concatenate([self.nlp.constraints(x), x[self.pins]])

    def jacobianstructure(self):
        rows, columns = self.nlp.jacobian_structure
        more = self.nlp.m + np.arange(len(self.pins))
        return np.concatenate([rows, more]), np.concatenate([columns, self.pins])

    def jacobian(self, x):
        return np.concatenate([self.nlp.jacobian_values(x), np.ones(len(self.pins))])

    def hessianstructure(self):
        return self.nlp.hessian_structure

    def hessian(self, x, multipliers, factor):
        return self.nlp.hessian_values(x, multipliers[: self.nlp.m], factor)


def by_pounce(nlp, pins):
    """Derivatives of all variables by each pinned one, in the units of the program."""
    at = nlp.start[pins]
    bounds = [np.concatenate([limit, at]) for limit in nlp.constraint_bounds]
    lower, upper = nlp.bounds
    out = []
    for pin in range(len(pins)):
        solver = pounce.Problem(n=nlp.n, m=nlp.m + len(pins), problem_obj=Pinned(nlp, pins), lb=lower, ub=upper, cl=bounds[0], cu=bounds[1])
        for option, value in {"tol": 1e-10, "print_level": 0, "bound_relax_factor": 0.0, "sb": "yes"}.items():
            solver.add_option(option, value)
        _, found = solver.solve_with_sens(nlp.start, pin_constraint_indices=[nlp.m + pin], deltas=[1.0])
        if found["status"] != 0:
            raise SystemExit(f"pounce-solver: {found['status_msg']}")
        out.append(np.asarray(found["dx"])[: nlp.n])
    return out


def main():
    held = problem({"sensitivity": {name: {} for name in CONSTANTS}})
    with tempfile.TemporaryDirectory() as folder:
        found = held.solve(output=folder).sensitivities
    free = {name: {"min": 0.9 * one.value, "max": 1.1 * one.value, "guess": one.value} for name, one in found.items()}
    nlp = problem({"free": free}).nlp()
    pins = np.array([nlp.names.index(name) for name in CONSTANTS])
    volts = UPPER / nlp.bounds[1][nlp.names.index("voltage of muscle1 in interval 0")]
    worst = 0.0
    for name, pin, step in zip(CONSTANTS, pins, by_pounce(nlp, pins)):
        unit = found[name].value / nlp.start[pin]
        for kind, scale in {"voltages": volts, "coordinates": 1.0}.items():
            places = [(quantity, at) for quantity, of in KINDS[kind] for at, word in enumerate(nlp.names) if word.startswith(of)]
            ours = np.array([found[name].table[quantity][int(nlp.names[at].split()[-1])] for quantity, at in places])
            theirs = np.array([step[at] for _, at in places]) * scale / unit
            size = np.abs(ours).max()
            difference = np.abs(theirs - ours).max() / size
            worst = max(worst, difference)
            print(f"d {kind} / d {name}: {np.count_nonzero(ours)} of {len(ours)} not zero, difference {difference:.1e} of {size:.4g}")
    if not worst <= SAME:
        raise SystemExit(f"derivatives differ by {worst:.1e}, expected at most {SAME:.0e}")


if __name__ == "__main__":
    main()
