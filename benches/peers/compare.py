"""proboscis and CasADi on the elephant trunk, run in turn, as tables.

    python compare.py SCENE PROBLEM FOLDER --proboscis PATH --intervals 20 40 80 160 --repeats 10

Each solve is a process of its own on one core. Times are processor time of the one thread, of which the least of the repeats is kept, for every
time by itself.
"""

import argparse
import csv
import json
import os
import platform
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
README = HERE.parent / "README.md"
# The tolerance of all, and bounds that none relaxes: what is left between the objectives is rounding.
TOLERANCE = 1e-10
CALLBACKS = ("objective", "gradient", "constraints", "jacobian", "hessian")
SOLVERS = {"stages": "proboscis, along the horizon", "mumps": "proboscis, MUMPS"}
COMPILED = {"map": "CasADi, Ipopt with MUMPS, compiled", "fatrop": "CasADi, Fatrop, compiled"}
INTERPRETED = {"map": "CasADi, Ipopt with MUMPS, one interval mapped", "sx": "CasADi, Ipopt with MUMPS, one expression"}
TIMES = ("setup", "solve", "solver")


def on_one_core(command, clock, **options):
    """Runs a command on one core, with one thread, under a clock of processor time, and returns what it prints."""
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "RAYON_NUM_THREADS": "1", "LD_PRELOAD": str(clock)}
    pinned = lambda: os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    ended = subprocess.run(command, capture_output=True, text=True, env=environment, preexec_fn=pinned, **options)
    if ended.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: {ended.stdout}{ended.stderr}")
    return ended.stdout


def proboscis(program, clock, problem, intervals, linear_solver):
    with tempfile.TemporaryDirectory() as folder:
        settings = (f"control.intervals={intervals}", f"control.solver.tolerance={TOLERANCE}",
                    f'control.solver.linear_solver="{linear_solver}"', "control.solver.ipopt.bound_relax_factor=0")
        command = [program, "solve", problem, "-q", "-o", folder]
        on_one_core(command + [word for setting in settings for word in ("--set", setting)], clock)
        summary = json.loads((Path(folder) / "summary.json").read_text())
    if summary["linear_solver"]["name"] != linear_solver:
        sys.exit(f"N = {intervals}: asked for {linear_solver}, solved with {summary['linear_solver']['name']}")
    seconds, calls = summary["seconds"], summary["evaluations"]
    return {
        "solved": True,
        "objective": summary["objective"],
        "iterations": summary["iterations"],
        "setup": seconds["setup"],
        "solve": seconds["solver"] + sum(seconds[name] for name in CALLBACKS),
        "solver": seconds["solver"],
        "microseconds": {name: 1e6 * seconds[name] / calls[name] for name in CALLBACKS},
        "version": summary["versions"]["program"],
    }


def casadi(clock, scene, *options):
    with tempfile.TemporaryDirectory() as folder:
        return json.loads(on_one_core([sys.executable, HERE / "casadi_solve.py", scene, *map(str, options)], clock, cwd=folder))


def least(runs):
    """One run out of several: the least of each time; the rest has to be the same in all of them."""
    first = runs[0]
    for key in ("objective", "iterations"):
        if any(run[key] != first[key] for run in runs):
            sys.exit(f"{key}: a solve that does not repeat itself, {[run[key] for run in runs]}")
    return first | {
        "repeats": len(runs),
        "microseconds": {name: min(run["microseconds"][name] for run in runs) for name in CALLBACKS},
    } | {key: min(run[key] for run in runs) for key in TIMES}


def measure(programs, repeats):
    """The rows of one number of intervals; in turn, so that what else the machine does meets all of them."""
    runs = {name: [] for name in programs}
    for i in range(max(repeats.values())):
        for name, program in programs.items():
            if i < repeats[name] and all(run["solved"] for run in runs[name]):
                runs[name].append(program())
    own = runs[SOLVERS["stages"]][0]["objective"]
    rows = []
    for name, list_of_runs in runs.items():
        if list_of_runs:
            row = least(list_of_runs) | {"program": name}
            row["apart"] = abs(row["objective"] - own) / own
            if row["solved"] and row["apart"] > 1e-8:
                sys.exit(f"{name}: objectives {own} and {row['objective']} differ")
            rows.append(row)
    return rows


def span(values, digits):
    """Least and greatest of some numbers, or the one that they round to."""
    low, high = format(min(values), digits), format(max(values), digits)
    return low if low == high else f"{low} to {high}"


def conclusion(rows, compilation):
    """What the table says: times of the others as multiples of those by proboscis along the horizon."""
    own = {row["intervals"]: row for row in rows if row["program"] == SOLVERS["stages"]}
    parts = []
    for name in dict.fromkeys(row["program"] for row in rows):
        others = [row for row in rows if row["program"] == name != SOLVERS["stages"]]
        unsolved = [f"N = {row['intervals']} in {row['iterations']} iterations" for row in others if not row["solved"]]
        others = [row for row in others if row["solved"]]
        if others:
            ratio = lambda key: span([row[key] / own[row["intervals"]][key] for row in others], ".2g")
            parts.append(f"- {name}: {ratio('solve')} times the solve, {ratio('solver')} times the time inside the solver, "
                         f"{span([row['setup'] for row in others], '.2g')} s to set up, {span([row['iterations'] for row in others], 'd')} iterations."
                         + (f" Not solved: {', '.join(unsolved)}." if unsolved else ""))
    return [f"**Conclusion.** Objectives agree to {max(row['apart'] for row in rows if row['solved']):.0e}. Against {SOLVERS['stages']}, which sets up in "
            f"{span([row['setup'] for row in own.values()], '.1g')} s and takes {span([row['iterations'] for row in own.values()], 'd')} iterations:",
            "", *parts, "",
            f"Each compiled one needs the C compiler once besides, for all numbers of intervals, here for {span(compilation, '.0f')} s."]


def short_table(rows):
    """Solve and solver side by side."""
    names = list(SOLVERS.values()) + list(COMPILED.values())
    lines = ["| N | " + " | ".join(names) + " |", "|--:|" + "--:|" * len(names)]
    for intervals in dict.fromkeys(row["intervals"] for row in rows):
        of = {row["program"]: row for row in rows if row["intervals"] == intervals}
        own = of[names[0]]
        cells = []
        for name in names:
            row = of[name]
            if not row["solved"]:
                cells.append(f"not solved in {row['iterations']} iterations")
                continue
            ratios = f" ({row['solve'] / own['solve']:.2f} / {row['solver'] / own['solver']:.2f})" if row is not own else ""
            cells.append(f"{1e3 * row['solve']:.0f} / {1e3 * row['solver']:.0f}{ratios}, {row['iterations']}")
        lines.append(f"| {intervals} | " + " | ".join(cells) + " |")
    return lines


def long_table(rows):
    lines = [
        "| N | program | repeats | set-up [s] | solve [ms] | solver alone [ms] | iterations | objective | apart |"
        + "".join(f" {name} [µs] |" for name in CALLBACKS),
        "|--:|:--|--:|--:|--:|--:|--:|--:|--:|" + "--:|" * len(CALLBACKS),
    ]
    for row in rows:
        cells = [str(row["intervals"]), row["program"], str(row["repeats"]), f"{row['setup']:.3f}", f"{1e3 * row['solve']:.1f}",
                 f"{1e3 * row['solver']:.1f}", str(row["iterations"]) + ("" if row["solved"] else ", not solved"), f"{row['objective']:.12f}", f"{row['apart']:.0e}"]
        cells += [f"{row['microseconds'][name]:.1f}" for name in CALLBACKS]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def page(rows, about):
    return "\n".join([
        "# The elephant trunk, proboscis beside CasADi",
        "",
        *conclusion(rows, about["compilation"]),
        "",
        f"{about['processor']}, one core shared with other programs; proboscis {about['proboscis']}, CasADi {about['casadi']}; load of the "
        f"machine {about['load'][0]:.1f} before and {about['load'][1]:.1f} after. Times are processor time, the least of the repeats, which took turns; that of the C compiler is real time. All "
        f"solve the same program to {TOLERANCE:g} from the same guess, with squares of voltages as unknowns; Fatrop has voltages, since it finds no search direction with their squares, the momenta as further "
        "unknowns and another interior-point method, hence other iterations. Written by `benches/peers/run.sh`.",
        "",
        "Solve / of which solver without callbacks in ms (ratios to the first column), iterations:",
        "",
        *short_table(rows),
        "",
        *long_table(rows),
        "",
    ])


def write_short_table(rows):
    before, rest = README.read_text().split("<!-- peers -->\n")
    _, after = rest.split("<!-- end of peers -->")
    README.write_text("\n".join([before + "<!-- peers -->", "", *short_table(rows), "", "<!-- end of peers -->"]) + after)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("scene", type=Path)
    parser.add_argument("problem", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--proboscis", type=Path, required=True)
    parser.add_argument("--intervals", type=int, nargs="+", default=[20, 40, 80, 160, 320, 640])
    parser.add_argument("--repeats", type=int, default=10)
    parser.add_argument("--interpreted-repeats", type=int, default=1)
    parser.add_argument("--interpreted-most", type=int, default=160, help="intervals up to which interpreted functions are run: they take minutes to set up")
    parser.add_argument("--library", type=Path, help="folder for the compiled functions, of an earlier run or for the next one")
    arguments = parser.parse_args()
    binary, problem = arguments.proboscis.resolve(), arguments.problem.resolve()
    load = [os.getloadavg()[0]]
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        scene, libraries = Path(folder) / "scene.json", arguments.library or Path(folder)
        clock = Path(folder) / "processor_clock.so"
        subprocess.run(["gcc", "-O1", "-fPIC", "-shared", HERE / "processor_clock.c", "-o", clock], check=True)
        scene.write_text(subprocess.run([binary, "expand", arguments.scene], check=True, capture_output=True, text=True).stdout)
        compilation = []
        for variant in COMPILED:
            library = libraries.resolve() / f"{variant}.so"
            told = library.with_suffix(".json")
            if not told.exists():
                told.write_text(json.dumps(casadi("", scene, "--problem", problem, "--variant", variant, "--compile", library)))
            compilation.append(json.loads(told.read_text())["seconds"])
        for intervals in arguments.intervals:
            given = "--problem", problem, "--intervals", intervals, "--tolerance", TOLERANCE, "--variant"
            programs, repeats = {}, {}
            for solver, name in SOLVERS.items():
                programs[name] = lambda solver=solver: proboscis(binary, clock, problem, intervals, solver)
                repeats[name] = arguments.repeats
            for variant, name in COMPILED.items():
                programs[name] = lambda variant=variant: casadi(clock, scene, *given, variant, "--library", libraries.resolve() / f"{variant}.so")
                repeats[name] = arguments.repeats
            for variant, name in INTERPRETED.items():
                programs[name] = lambda variant=variant: casadi(clock, scene, *given, variant)
                repeats[name] = arguments.interpreted_repeats if intervals <= arguments.interpreted_most else 0
            rows += [row | {"intervals": intervals} for row in measure(programs, repeats)]
            print(f"N = {intervals} done", file=sys.stderr)
    load.append(os.getloadavg()[0])
    about = {
        "processor": next((line.split(":")[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                           if line.startswith("model name")), platform.processor()),
        "proboscis": next(row["version"] for row in rows if row["program"] in SOLVERS.values()),
        "casadi": next(row["version"] for row in rows if row["program"] not in SOLVERS.values()),
        "load": load,
        "compilation": compilation,
    }
    arguments.folder.mkdir(parents=True, exist_ok=True)
    (arguments.folder / "peer.json").write_text(json.dumps({"about": about, "runs": rows}, indent=1) + "\n")
    (arguments.folder / "peer.md").write_text(page(rows, about))
    with open(arguments.folder / "peer.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["intervals", "program", "repeats", "setup [s]", "solve [s]", "solver [s]", "iterations", "objective",
                         "relative difference"] + [f"{name} [us]" for name in CALLBACKS])
        for row in rows:
            writer.writerow([row["intervals"], row["program"], row["repeats"], row["setup"], row["solve"], row["solver"],
                             row["iterations"], row["objective"], row["apart"]]
                            + [row["microseconds"][name] for name in CALLBACKS])
    write_short_table(rows)
    print(page(rows, about))


if __name__ == "__main__":
    main()
