#!/usr/bin/env python3
"""Compares results and times of this program with those of another commit: `make guard AGAINST=HEAD~3`.

Every kept problem is run by both programs, built alike on this machine. Tables, solutions and summaries are compared number by number, times left
out; then the schemas and what Python offers. Twelve problems are timed in turn. The other commit is built in a worktree, target/guard/base.
Written with the standard library alone.
"""

import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
GUARD = ROOT / "target/guard"
BASE = GUARD / "base"
# What says how long a run took, by which program and where.
LEFT_OUT = {"seconds", "versions", "interval_microseconds", "microseconds", "command", "input", "memory", "created"}
TIMED = (
    "elephant_trunk elephant_trunk_effort elephant_trunk_constant pair pair_time pair_receding swing_up codesign_pair "
    "fe_bending_control fe_trunk bending_actuator recorded_pair"
).split()
REPEATS = 5
SECONDS = 600


def run(*command, cwd=ROOT, **more):
    return subprocess.run(command, cwd=cwd, check=True, text=True, **more)


def built(folder, profile):
    """The program of a source tree."""
    target = GUARD / "here" if folder == ROOT else GUARD / "there"
    run("cargo", "build", "--locked", "--quiet", "--profile", profile, "--bin", "proboscis", "--target-dir", target, cwd=folder)
    return target / ("debug" if profile == "dev" else profile) / "proboscis"


def task(problem):
    return "simulate" if "simulate" in json.loads(problem.read_text()) else "solve"


def solve(program, problem, out):
    command = [program, task(problem), problem.relative_to(ROOT), "-o", out]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=SECONDS, env=environment)
    except subprocess.TimeoutExpired:
        return "no end"
    return done.returncode


def plain(value):
    """A result without times."""
    if isinstance(value, dict):
        return {key: plain(one) for key, one in value.items() if key not in LEFT_OUT and not key.endswith("_seconds")}
    if isinstance(value, list):
        return [plain(one) for one in value]
    return value


def content(file):
    if file.suffix == ".json":
        return plain(json.loads(file.read_text()))
    return [line for line in file.read_text().splitlines() if not line.startswith("#")]


def kept(folder):
    files = folder.rglob("*")
    return {file.relative_to(folder): file for file in files if file.suffix in (".json", ".csv")}


def difference(ours, theirs):
    """The files of two folders that differ."""
    ours, theirs = kept(ours), kept(theirs)
    names = sorted(ours.keys() | theirs.keys())
    return [str(name) for name in names if name not in ours or name not in theirs or content(ours[name]) != content(theirs[name])]


def seconds(program, problem):
    began = time.perf_counter()
    solve(program, problem, GUARD / "timed")
    return time.perf_counter() - began


def main(against, profile="release"):
    GUARD.mkdir(parents=True, exist_ok=True)
    if BASE.exists():
        run("git", "worktree", "remove", "--force", BASE)
    run("git", "worktree", "prune")
    run("git", "worktree", "add", "--quiet", "--detach", BASE, against)
    here, there = built(ROOT, profile), built(BASE, profile)
    differs = []
    problems = [path for path in sorted((ROOT / "problems").glob("*.json")) if not path.name.endswith(".schema.json")]
    for problem in problems:
        outs = [GUARD / "results" / side / problem.stem for side in ("here", "there")]
        codes = [solve(program, problem, out) for program, out in zip((here, there), outs)]
        files = difference(*outs)
        if codes[0] != codes[1] or files:
            differs.append(problem.stem)
            print(f"{problem.stem}: status {codes[0]} for {codes[1]}; {', '.join(files)}", flush=True)
    for name in ("problems/problem.schema.json", "problems/scene.schema.json", "python/proboscis/entries.py", "python/proboscis/_proboscis.pyi"):
        if (ROOT / name).read_text() != (BASE / name).read_text():
            differs.append(name)
            print(f"{name} differs")
    print(f"{len(differs)} of {len(problems)} problems and 4 files differ from {against}", flush=True)
    ratios = []
    for name in TIMED:
        problem = ROOT / "problems" / f"{name}.json"
        pairs = [(seconds(here, problem), seconds(there, problem)) for _ in range(REPEATS)]
        ratio = statistics.median(a / b for a, b in pairs)
        ratios.append(ratio)
        print(f"{name}: {statistics.median(a for a, _ in pairs):.3f} s, {ratio:.3f} of the time before", flush=True)
    print(f"all: {statistics.geometric_mean(ratios):.3f} of the time before")
    return 1 if differs else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:] or ["HEAD~1"]))
