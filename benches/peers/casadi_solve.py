"""Solves the elephant trunk through CasADi, once, and prints what came out and what it took; or compiles an interval.

    python casadi_solve.py scene.json --problem problem.json --variant map --compile interval.so
    python casadi_solve.py scene.json --problem problem.json --intervals 40 --variant map --library interval.so
"""

import argparse
import json
import sys
import time

import casadi as ca
import numpy as np

import casadi_fatrop
import casadi_ipopt
from casadi_trunk import Trunk, compile_interval, compiled_interval, interval_functions

CALLBACKS = {"objective": "f", "gradient": "grad_f", "constraints": "g", "jacobian": "jac_g", "hessian": "hess_l"}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("scene")
    parser.add_argument("--compile", metavar="LIBRARY")
    parser.add_argument("--problem", required=True)
    parser.add_argument("--intervals", type=int)
    parser.add_argument("--variant", choices=("map", "sx", "fatrop"), default="map")
    parser.add_argument("--library", help="the compiled functions of one interval")
    parser.add_argument("--tolerance", type=float, default=1e-8)
    arguments = parser.parse_args()
    began = time.perf_counter()
    with open(arguments.scene) as scene:
        trunk = Trunk(json.load(scene))
    with open(arguments.problem) as problem:
        control = json.load(problem)["control"]
    unit = None if arguments.variant == "fatrop" else casadi_ipopt.unit(control)
    if arguments.compile:
        compile_interval(trunk, unit, arguments.compile)
        json.dump({"seconds": time.perf_counter() - began}, sys.stdout)
        return 0
    functions = compiled_interval(arguments.library) if arguments.library else interval_functions(trunk, unit)
    program = casadi_ipopt.Program(trunk, control, arguments.intervals, unit)
    limits = arguments.tolerance, control["solver"]["max_iterations"]
    if arguments.variant == "fatrop":
        solver, given = casadi_fatrop.build(program, functions, *limits)
    else:
        solver, given = casadi_ipopt.build(program, functions, arguments.variant, *limits)
    ready = time.perf_counter()
    solution = solver(**given)
    done = time.perf_counter()
    stats = solver.stats()
    called = {name: stats.get(f"n_call_nlp_{key}", 0) for name, key in CALLBACKS.items()}
    spent = {name: stats.get(f"t_wall_nlp_{key}", 0.0) for name, key in CALLBACKS.items()}
    json.dump(
        {
            "objective": float(solution["f"]),
            "solved": bool(stats["success"]),
            "iterations": stats["iter_count"],
            "setup": ready - began,
            "solve": done - ready,
            "solver": done - ready - sum(value for key, value in stats.items() if key.startswith("t_wall_nlp_")),
            "calls": called,
            "microseconds": {name: 1e6 * spent[name] / called[name] for name in CALLBACKS if called[name]},
            "violation": float(np.abs(np.array(solution["g"])).max()),
            "version": ca.__version__,
        },
        sys.stdout,
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
