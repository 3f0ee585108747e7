"""proboscis and CasADi on the elephant trunk, run in turn, as one table.

    python compare.py PROBOSCIS SCENE PROBLEM FOLDER --intervals 20 40 80 --repeats 5

Each solve is a process of its own on one core. Of the repeats the median is kept, for every column by itself.
"""

import argparse
import csv
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
# The tolerance of both, and bounds that neither relaxes: what is left between the objectives is rounding.
TOLERANCE = 1e-10
CALLBACKS = ("objective", "gradient", "constraints", "jacobian", "hessian")
NAMES = {"proboscis": "proboscis", "map": "CasADi, one interval mapped", "sx": "CasADi, one expression",
         "map_jit": "CasADi, one interval mapped and compiled"}


def on_one_core(command, **options):
    """Runs a command on one core, with one thread, and returns what it prints."""
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "RAYON_NUM_THREADS": "1"}
    pinned = lambda: os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    ended = subprocess.run(command, capture_output=True, text=True, env=environment, preexec_fn=pinned, **options)
    if ended.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: {ended.stdout}{ended.stderr}")
    return ended.stdout


def proboscis(program, problem, intervals):
    with tempfile.TemporaryDirectory() as folder:
        settings = (f"control.intervals={intervals}", f"control.solver.tolerance={TOLERANCE}",
                    "control.solver.ipopt.bound_relax_factor=0")
        command = [program, "solve", problem, "-q", "-o", folder]
        on_one_core(command + [word for setting in settings for word in ("--set", setting)])
        summary = json.loads((Path(folder) / "summary.json").read_text())
    seconds, calls = summary["seconds"], summary["evaluations"]
    return {
        "objective": summary["objective"],
        "iterations": summary["iterations"],
        "setup": seconds["setup"],
        "solve": seconds["solver"] + sum(seconds[name] for name in CALLBACKS),
        "microseconds": {name: 1e6 * seconds[name] / calls[name] for name in CALLBACKS},
        "version": summary["versions"]["program"],
    }


def casadi(scene, problem, intervals, variant):
    command = [sys.executable, HERE / "casadi_trunk.py", scene, problem, "--variant", variant]
    with tempfile.TemporaryDirectory() as folder:
        return json.loads(on_one_core(
            command + ["--intervals", str(intervals), "--tolerance", str(TOLERANCE)], cwd=folder))


def median(runs):
    """One run out of several: the middle of each time; the rest has to be the same in all of them."""
    first = runs[0]
    assert all(run["objective"] == first["objective"] for run in runs), "a solve that does not repeat itself"
    assert all(run["iterations"] == first["iterations"] for run in runs), "a solve that does not repeat itself"
    middle = lambda read: statistics.median(read(run) for run in runs)
    return first | {
        "repeats": len(runs),
        "setup": middle(lambda run: run["setup"]),
        "solve": middle(lambda run: run["solve"]),
        "microseconds": {name: middle(lambda run: run["microseconds"][name]) for name in CALLBACKS},
    }


def conclusion(rows):
    """What the table says: solves and set-up by CasADi as multiples of those by proboscis."""
    own = {row["intervals"]: row for row in rows if row["program"] == "proboscis"}
    parts = []
    for name in NAMES:
        others = [row for row in rows if row["program"] == name != "proboscis"]
        if others:
            ratios = [row["solve"] / own[row["intervals"]]["solve"] for row in others]
            setups = [row["setup"] for row in others]
            parts.append(f"{NAMES[name]}, takes {span(ratios, '.2g')} times as long to solve and {span(setups, '.3g')} s to set up")
    apart = max(row["apart"] for row in rows)
    same = all(row["iterations"] == own[row["intervals"]]["iterations"] for row in rows)
    return (f"**Conclusion.** Objectives agree to {apart:.0e}{', in equally many iterations' if same else ''}. " + "; ".join(parts)
            + f"; proboscis sets up in {span([row['setup'] for row in own.values()], '.1g')} s.")


def span(values, digits):
    """Least and greatest of some numbers, or the one that they round to."""
    least, most = format(min(values), digits), format(max(values), digits)
    return least if least == most else f"{least} to {most}"


def markdown(rows, about):
    lines = [
        "# The elephant trunk, proboscis beside CasADi",
        "",
        conclusion(rows),
        "",
        f"{about['processor']}, one core; proboscis {about['proboscis']}, CasADi {about['casadi']}; load of the machine "
        f"{about['load'][0]:.1f} before and {about['load'][1]:.1f} after. Times are medians over the repeats; both solve the "
        f"same program with Ipopt and MUMPS to {TOLERANCE:g} from the same guess. Written by `benches/peers/run.sh`.",
        "",
        "| N | program | repeats | set-up [s] | solve [s] | iterations | objective | apart |"
        + "".join(f" {name} [µs] |" for name in CALLBACKS),
        "|--:|:--|--:|--:|--:|--:|--:|--:|" + "--:|" * len(CALLBACKS),
    ]
    for row in rows:
        cells = [str(row["intervals"]), NAMES[row["program"]], str(row["repeats"]), f"{row['setup']:.3f}",
                 f"{row['solve']:.3f}", str(row["iterations"]), f"{row['objective']:.12f}", f"{row['apart']:.0e}"]
        cells += [f"{row['microseconds'][name]:.1f}" for name in CALLBACKS]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("proboscis", type=Path)
    parser.add_argument("scene", type=Path)
    parser.add_argument("problem", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--intervals", type=int, nargs="+", default=[20, 40, 80])
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--compiled-repeats", type=int, default=1)
    arguments = parser.parse_args()
    program, problem = arguments.proboscis.resolve(), arguments.problem.resolve()
    load = [os.getloadavg()[0]]
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "scene.json"
        scene.write_text(subprocess.run([program, "expand", arguments.scene], check=True, capture_output=True, text=True).stdout)
        for intervals in arguments.intervals:
            # In turn, so that what else the machine does meets all of them.
            runs = {"proboscis": [], "map": [], "sx": [], "map_jit": []}
            for i in range(arguments.repeats):
                runs["proboscis"].append(proboscis(program, problem, intervals))
                for variant in ("map", "sx") + (("map_jit",) if i < arguments.compiled_repeats else ()):
                    runs[variant].append(casadi(scene, problem, intervals, variant))
                    print(f"N = {intervals}, repeat {i + 1}, {variant}", file=sys.stderr)
            own = runs["proboscis"][0]["objective"]
            for name, list_of_runs in runs.items():
                if list_of_runs:
                    row = median(list_of_runs)
                    row |= {"intervals": intervals, "program": name, "apart": abs(row["objective"] - own) / own}
                    rows.append(row)
                    if row["apart"] > 1e-8:
                        sys.exit(f"N = {intervals}, {name}: objectives {own} and {row['objective']} differ")
    load.append(os.getloadavg()[0])
    about = {
        "processor": next((line.split(":")[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                           if line.startswith("model name")), platform.processor()),
        "proboscis": next(row["version"] for row in rows if row["program"] == "proboscis"),
        "casadi": next(row["version"] for row in rows if row["program"] != "proboscis"),
        "load": load,
    }
    arguments.folder.mkdir(parents=True, exist_ok=True)
    (arguments.folder / "peer.json").write_text(json.dumps({"about": about, "runs": rows}, indent=1) + "\n")
    (arguments.folder / "peer.md").write_text(markdown(rows, about))
    with open(arguments.folder / "peer.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["intervals", "program", "repeats", "setup [s]", "solve [s]", "iterations", "objective",
                         "relative difference"] + [f"{name} [us]" for name in CALLBACKS])
        for row in rows:
            writer.writerow([row["intervals"], row["program"], row["repeats"], row["setup"], row["solve"],
                             row["iterations"], row["objective"], row["apart"]]
                            + [row["microseconds"][name] for name in CALLBACKS])
    print(markdown(rows, about))


if __name__ == "__main__":
    main()
