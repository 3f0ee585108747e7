"""Problems in, arrays out, mistakes with their place, interruptions in good order."""

import copy
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import proboscis as pb

PROBLEMS = Path(__file__).parents[2] / "problems"


@pytest.fixture(scope="module")
def pair() -> pb.Problem:
    return pb.Problem.from_file(PROBLEMS / "pair.json")


@pytest.fixture(scope="module")
def optimum(pair: pb.Problem) -> pb.Result:
    return pair.solve()


def expanded() -> Any:
    """The scene of the pair without shorthand."""
    command = [os.environ["PROBOSCIS"], "expand", PROBLEMS / "scenes" / "pair.json"]
    return json.loads(subprocess.run(command, check=True, capture_output=True).stdout)


def own_arm() -> tuple[pb.System, pb.Joint, list[pb.Muscle]]:
    """The pair, made of parts."""
    scene = expanded()
    system = pb.System(scene["name"])
    material, entries = next(iter(scene["materials"].items()))
    silicone = system.add(pb.Material(material, **entries))
    body = system.add(pb.Body(**scene["bodies"][0]))
    joint = system.add(pb.Joint(**{**scene["joints"][0], "child": body}))
    muscles = []
    for entry in scene["muscles"]:
        from_, to = ({**entry[end], "at": np.array(entry[end]["at"])} for end in ("from", "to"))
        rest = {key: value for key, value in entry.items() if key not in ("from", "to", "material", "name")}
        muscles.append(system.add(pb.Muscle(material=silicone, from_=from_, to={**to, "body": body}, **rest)))
    for entry in scene.get("markers", []):
        system.add(pb.Marker(**{**entry, "body": body}))
    return system, joint, muscles


def test_a_system_of_parts_is_the_scene_of_the_file() -> None:
    scene = expanded()
    scene.pop("$schema", None)
    assert own_arm()[0].to_dict() == scene
    assert pb.System.from_dict(scene).to_dict() == scene


def test_a_problem_is_written_back_as_it_was(pair: pb.Problem, tmp_path: Path) -> None:
    written = json.loads((PROBLEMS / "pair.json").read_text())
    assert pair.to_dict() == written
    pair.save(tmp_path / "pair.json")
    assert json.loads((tmp_path / "pair.json").read_text()) == written
    pair.to_dict()["control"]["intervals"] = 3
    assert pair.to_dict() == written
    assert pair.changed({"control.intervals": 3}).to_dict()["control"]["intervals"] == 3


def test_results_are_arrays_in_si_units(optimum: pb.Result) -> None:
    assert optimum.is_solved and optimum.status == "solved" and optimum.iterations > 3
    intervals = optimum.summary["intervals"]
    assert optimum.time.shape == (intervals + 1,)
    assert optimum.time[-1] == optimum.summary["duration"] < 10
    tip = optimum.position("tip")
    assert tip.shape == (intervals + 1, 3)
    assert np.allclose(np.linalg.norm(tip, axis=1), 0.05, rtol=1e-9)
    voltage = optimum.voltage("muscle2")
    assert voltage.shape == (intervals,) and 100 < voltage.max() <= 3000
    # The joint turns the tip about z.
    assert np.allclose(tip[:, 0], -0.05 * np.sin(optimum.joint("joint1")), atol=1e-12)
    assert abs(optimum.joint("joint1")).max() > 0.01
    assert 1e-10 < abs(optimum.charge("muscle1")).max() < 1e-4
    units = optimum.table.units
    assert (units["time"], units["tip_x"], units["muscle1_charge"]) == ("s", "m", "C")
    assert (units["total_energy"], units["linear_momentum_x"], units["angular_momentum_x"]) == ("J", "N s", "N m s")
    solution = json.loads((optimum.folder / "solution.json").read_text())
    assert solution["time"] == list(optimum.time)
    assert solution["voltages"]["muscle2"] == list(voltage)


def test_pandas_has_units_in_its_columns(optimum: pb.Result) -> None:
    frame = optimum.to_pandas()
    assert list(frame["tip_x [m]"]) == list(optimum.table["tip_x"])
    assert "muscle1_stretch" in frame


def test_results_are_saved_and_loaded(optimum: pb.Result, tmp_path: Path) -> None:
    optimum.save(tmp_path / "kept")
    loaded = pb.load(tmp_path / "kept")
    assert loaded.is_solved and loaded.objective == optimum.objective
    assert all(np.array_equal(loaded.table[name], optimum.table[name], equal_nan=True) for name in optimum.table)
    page = loaded.report().read_text()
    assert page.lstrip().startswith("<!") and loaded.report().parent == tmp_path / "kept"
    frame = loaded._repr_html_()
    assert frame.startswith('<iframe srcdoc="&lt;!') and frame.count("<") == 2
    assert loaded.figure("voltages").svg.count("<svg") == 1
    with pytest.raises(pb.Error, match="summary.json"):
        pb.load(tmp_path)
    for text in ("[]", "{", '{"status": 3}'):
        (tmp_path / "summary.json").write_text(text)
        with pytest.raises(pb.Error, match="summary.json"):
            pb.load(tmp_path)
    (tmp_path / "kept" / "trajectory.csv").write_text("# x\ntime [ms],b\n1,2\n3\n")
    with pytest.raises(pb.Error, match="trajectory.csv"):
        print(pb.load(tmp_path / "kept").time)


def test_a_folder_of_its_own_goes_with_the_result(pair: pb.Problem) -> None:
    result = pair.solve(max_iterations=1)
    assert not result.is_solved and result.status == "iteration_limit" and result.message
    folder = result.folder
    assert folder.is_dir()
    del result
    assert not folder.exists()


def test_a_simulation_and_an_equilibrium() -> None:
    system, joint, muscles = own_arm()
    heard: list[pb.Step] = []
    voltages = {muscles[0]: "1 kV"}
    motion = system.simulate(duration="50 ms", step="10 ms", voltages=voltages, on_step=heard.append)
    assert motion.status == "simulated" and len(motion.time) == 6
    assert [step.step for step in heard] == [1, 2, 3, 4, 5]
    assert heard[-1].time == 0.05 and abs(motion.joint(joint)[-1]) > 1e-3
    rest = system.equilibrium(voltages=voltages)
    assert rest.status == "at_rest" and abs(rest.joint(joint)[0]) > 1e-3
    with pytest.raises(pb.Error, match="only the result of a control problem"):
        print(rest.objective)


def test_a_refused_state_of_rest_tells_nothing_of_an_earlier_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    system, _, muscles = own_arm()
    assert system.equilibrium(voltages={muscles[0]: "1 kV"}, output=tmp_path).is_solved
    lost = system.equilibrium(voltages={muscles[0]: "100 kV"}, output=tmp_path)
    assert not lost.is_solved and lost.status == "pull_in" and "pull-in at" in str(lost.message)
    # A run that ends without files.
    monkeypatch.setattr(pb._proboscis, "run", lambda *_, **__: ((False, "no equilibrium", ["no way there"]), None, None))
    refused = system.equilibrium(voltages={muscles[0]: "2 kV"}, output=tmp_path)
    assert not refused.is_solved and refused.message == "no way there"
    assert refused.status == "no_equilibrium" and not refused.summary


def test_mistakes_have_a_place(tmp_path: Path) -> None:
    written = json.loads((PROBLEMS / "pair.json").read_text())
    content = {**written, "control": {**written["control"], "intervals": -3}}
    with pytest.raises(pb.Error, match="whole number|integer|expected") as caught:
        pb.Problem.from_dict(content, folder=PROBLEMS)
    assert caught.value.path == "control.intervals" and "^" in caught.value.excerpt
    with pytest.raises(pb.Error) as caught:
        pb.Problem.from_dict({**written, "scene": "nowhere.json"}, folder=PROBLEMS)
    assert "nowhere.json" in str(caught.value)
    with pytest.raises(pb.Error) as caught:
        pb.Problem.from_dict({**written, "control": {"intervals": object()}}, folder=PROBLEMS)
    assert caught.value.path == "control.intervals"
    system, _, muscles = own_arm()
    muscles[1].entries["to"]["body"] = "nobody"
    with pytest.raises(pb.Error, match="nobody") as caught:
        system.equilibrium()
    assert caught.value.path == "scene.muscles[1].to.body"
    with pytest.raises(pb.Error, match="finite"):
        pb.Problem.from_dict({**written, "control": {**written["control"], "duration": float("nan")}}, folder=PROBLEMS)
    (tmp_path / "twice.json").write_text('{"scene": "a", "scene": "b"}')
    with pytest.raises(pb.Error, match="twice"):
        pb.Problem.from_file(tmp_path / "twice.json")
    with pytest.raises(pb.Error, match="has no name"):
        pb.Problem.from_dict({**written, "scene": {"bodies": [pb.Body(mass=1, position=[0, 0, 0])]}})
    with pytest.raises(pb.Error, match="does not ask"):
        pb.Problem.from_file(PROBLEMS / "pair.json").simulate()


def test_an_entry_set_beside_the_scene_is_no_attribute() -> None:
    system = pb.System("arm")
    with pytest.raises(AttributeError):
        system.gravity = [0, -9.81, 0]  # type: ignore[attr-defined]
    system.scene["gravity"] = [0, -9.81, 0]
    assert copy.deepcopy(system).scene == system.scene


def test_what_does_not_apply_is_refused(pair: pb.Problem, optimum: pb.Result) -> None:
    simulation = pb.Problem.from_file(PROBLEMS / "pair_constant.json")
    for wrong in ({"start": optimum}, {"on_iteration": print}, {"max_iterations": 3}):
        with pytest.raises(pb.Error):
            simulation.solve(**wrong)  # type: ignore[arg-type]
    for limit in (0.0, -1.0, float("nan")):
        with pytest.raises(pb.Error, match="max_seconds"):
            pair.solve(max_seconds=limit)


def test_a_solve_starts_from_a_result(pair: pb.Problem, optimum: pb.Result) -> None:
    again = pair.solve(start=optimum)
    assert again.is_solved and again.iterations < optimum.iterations
    assert np.allclose(again.objective, optimum.objective, rtol=1e-7)


def test_a_simulation_starts_at_the_end_of_a_result() -> None:
    constant = pb.Problem.from_file(PROBLEMS / "pair_constant.json").changed({"simulate.duration": "50 ms"})
    first = constant.simulate()
    second = constant.changed({"simulate.start": {"end_of": first}}).simulate()
    whole = constant.changed({"simulate.duration": "100 ms"}).simulate()
    assert abs(whole.position("tip")[10, 0] - whole.position("tip")[20, 0]) > 1e-4
    np.testing.assert_array_equal(second.position("tip"), whole.position("tip")[10:])


def test_iterations_are_told(pair: pb.Problem, optimum: pb.Result) -> None:
    heard: list[pb.Iteration] = []
    main = threading.get_ident()

    def hear(iteration: pb.Iteration) -> None:
        assert threading.get_ident() == main
        heard.append(iteration)

    result = pair.solve(on_iteration=hear)
    assert [one.iteration for one in heard] == list(range(optimum.iterations + 1))
    assert heard[0].infeasibility > heard[-1].infeasibility
    assert heard[-1].optimality < 1e-6 and heard[0].intervals == optimum.summary["intervals"]
    assert result.objective == optimum.objective


def test_an_exception_of_a_callback_comes_out(pair: pb.Problem) -> None:
    class Enough(Exception):
        result: pb.Result | None

    heard = []

    def stop(iteration: pb.Iteration) -> None:
        heard.append(iteration.iteration)
        if iteration.iteration == 3:
            raise Enough("of it")

    with pytest.raises(Enough, match="of it") as caught:
        pair.solve(on_iteration=stop)
    assert heard == [0, 1, 2, 3]
    result = caught.value.result
    assert result is not None and result.status == "interrupted" and not result.is_solved
    assert result.iterations == 3 and len(result.time) == result.summary["intervals"] + 1
    assert pair.solve().is_solved


def long_simulation() -> pb.Problem:
    """A million steps."""
    content = json.loads((PROBLEMS / "elephant_trunk_constant.json").read_text())
    content["simulate"].update(duration="10000 s", step="10 ms")
    return pb.Problem.from_dict(content, folder=PROBLEMS)


def press_at(step: int) -> Callable[[pb.Step], None]:
    """Ctrl-C at a step: what is written of so few is there in time on a slow machine too."""

    def press(at: pb.Step) -> None:
        if at.step == step:
            os.kill(os.getpid(), signal.SIGINT)

    return press


def ctrl_c_after(seconds: float) -> threading.Thread:
    def press() -> None:
        time.sleep(seconds)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=press)
    thread.start()
    return thread


def test_ctrl_c_ends_a_run_in_good_order() -> None:
    simulation = long_simulation()
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt) as caught:
        simulation.simulate(on_step=press_at(100))
    result: Any = getattr(caught.value, "result")
    assert result.status == "interrupted" and not result.is_solved
    assert 1 < len(result.time) < 1_000_000 and result.joint("joint1").shape == result.time.shape
    assert signal.getsignal(signal.SIGINT) is before
    # The next run knows nothing of it.
    assert pb.Problem.from_file(PROBLEMS / "pair.json").solve().is_solved


def test_time_is_limited() -> None:
    result = long_simulation().simulate(max_seconds=0.3)
    assert result.status == "time_limit" and not result.is_solved and result.summary["steps"] > 1


def test_solves_run_at_once_in_threads(pair: pb.Problem, optimum: pb.Result) -> None:
    meeting = threading.Barrier(2, timeout=20)

    def meet(iteration: pb.Iteration) -> None:
        # Each solve goes on only when the other one is within a solve too.
        if iteration.iteration == 2:
            meeting.wait()

    with ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda _: pair.solve(on_iteration=meet), range(2)))
    assert [result.objective for result in results] == [optimum.objective] * 2


def test_others_run_while_a_run_does() -> None:
    ticks = 0
    done = threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not done.wait(0.001):
            ticks += 1

    thread = threading.Thread(target=tick)
    thread.start()
    before = ticks
    assert long_simulation().simulate(max_seconds=1).status == "time_limit"
    after = ticks
    done.set()
    thread.join()
    # Several hundred, against a handful while the result is read.
    assert after - before > 100


def test_ctrl_c_does_not_wait_for_what_cannot_stop(tmp_path: Path) -> None:
    """The result is waited for where it is asked for, and only there."""
    simulation = long_simulation()
    with pytest.raises(pb.Interrupted) as caught:
        simulation.simulate(on_step=press_at(100), output=tmp_path / "kept")
    result = caught.value.result
    assert caught.value.result is result and result.folder == tmp_path / "kept"
    assert result.status == "interrupted" and len(result.time) > 1
    assert (tmp_path / "kept" / "solution.json").is_file()


def test_files_that_are_to_stay_are_written_before_python_ends(tmp_path: Path) -> None:
    code = """
import os, signal, sys, threading
import proboscis as pb
problem = pb.Problem.from_file(sys.argv[1]).changed({"simulate.duration": "10000 s", "simulate.step": "10 ms"})
def press(step):
    if step.step == 1000:
        os.kill(os.getpid(), signal.SIGINT)
try:
    problem.simulate(output=sys.argv[2], on_step=press)
except KeyboardInterrupt:
    print("interrupted")
"""
    command = [sys.executable, "-c", code, PROBLEMS / "elephant_trunk_constant.json", tmp_path / "kept"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout == "interrupted\n", done.stderr
    assert pb.load(tmp_path / "kept").status == "interrupted"


def test_ctrl_c_ends_all_that_takes_long(pair: pb.Problem) -> None:
    control = pb.Problem.from_file(PROBLEMS / "fe_trunk_control.json")
    content = {"problem": PROBLEMS / "elephant_trunk.json", "vary": {"control.intervals": list(range(50, 250))}}
    calls: list[Any] = [lambda: pb.check(control), lambda: pb.sweep(content), lambda: pb.starts(PROBLEMS / "elephant_trunk.json", 500)]
    for call in calls:
        thread = ctrl_c_after(1.0)
        with pytest.raises(pb.Interrupted) as caught:
            call()
        thread.join()
        result = caught.value.result
        if call is calls[0]:
            # While the program is built there is nothing to tell yet.
            assert result is None or (not result["agrees"] and result["checked"] < result["variables"])
        else:
            assert {"not_started", "interrupted"} & set(result["status"]), set(result["status"])
    assert pair.solve().is_solved


def test_schemas() -> None:
    assert "control" in pb.schema()["properties"]
    assert "muscles" in pb.schema("scene")["properties"]
    with pytest.raises(pb.Error):
        pb.schema("study")


def test_changes_reach_a_scene_of_a_file(pair: pb.Problem, optimum: pb.Result) -> None:
    assert isinstance(pair.to_dict()["scene"], str)
    soft = pair.changed({"scene.materials.silicone.shear_modulus": "50 kPa", "control.intervals": 10})
    assert soft.to_dict()["scene"]["materials"]["silicone"]["shear_modulus"] == "50 kPa"
    assert isinstance(pair.to_dict()["scene"], str)
    # As the command line has it.
    swept = pb.sweep({"problem": "pair.json", "set": {"control.intervals": 10}, "vary": {"scene.materials.silicone.shear_modulus": ["50 kPa"]}}, folder=PROBLEMS)
    objective = soft.solve().objective
    assert list(swept["objective"]) == [objective] and abs(objective / optimum.objective - 1) > 0.1
    for wrong in ({"scene.materials.silicone.shear_modulus": "50 mm"}, {"control.intervls": 3}, {"scene.muscles[9].to": 1}, {"": 3}, {"control.duration": float("nan")}):
        with pytest.raises(pb.Error):
            pair.changed(wrong)
    with pytest.raises(pb.Error, match="did you mean") as caught:
        pair.changed({"control.intervls": 3})
    assert caught.value.path == "control.intervls"


def test_a_change_of_a_scene_keeps_the_meshes_of_its_bodies() -> None:
    arm = pb.Problem.from_file(PROBLEMS / "mesh_arm.json")
    heavy = arm.changed({"scene.bodies[0].density": "2400 kg/m^3", "simulate.duration": "5 ms"})
    file = heavy.to_dict()["scene"]["bodies"][0]["mesh"]["file"]
    assert file == "scenes/../meshes/bracket.stl"
    assert heavy.simulate().status == "simulated"


def test_all_mistakes_are_one_exception(pair: pb.Problem, optimum: pb.Result, tmp_path: Path) -> None:
    with pytest.raises(pb.Error, match="no column 'x'"):
        optimum.table["x"]
    assert "x" not in optimum.table and optimum.table.get("x") is None
    nowhere = tmp_path / "none" / "x"
    nlp = pair.nlp()
    calls: list[Any] = [
        lambda: pair.save(nowhere),
        lambda: pb.System("a").save(nowhere),
        lambda: optimum.figure().save(nowhere),
        lambda: optimum.save("/dev/null/x"),
        lambda: pb.load(nowhere),
        lambda: pb.load(3),  # type: ignore[arg-type]
        lambda: pair.solve(output="/dev/null/x"),
        lambda: pair.solve(max_iterations=-1),
        lambda: pair.solve(max_iterations=10**30),
        lambda: pair.solve(max_seconds="x"),  # type: ignore[arg-type]
        lambda: nlp.objective("abc"),
        lambda: pb.System.from_dict([]),  # type: ignore[arg-type]
        lambda: pb.System("a").add(3),  # type: ignore[type-var]
        lambda: pb.Problem.from_dict({}),
        lambda: pb.Problem.from_dict([]),  # type: ignore[arg-type]
        lambda: pb.Problem.from_dict({"scene": [1]}),
        lambda: pb.Muscle.from_dict(3),  # type: ignore[arg-type]
        lambda: pb.starts(pair, 0),
        lambda: pb.starts(pair, 2, seed=-1),
        lambda: pb.starts(PROBLEMS / "pair_constant.json", 2),
        lambda: pb.sweep(nowhere),
        lambda: pb.sweep(PROBLEMS / "pair.json"),
        lambda: pb.sweep({"problem": "x", "vary": {}}),
        lambda: pb.study(nowhere),
        lambda: pb.study({}, runs=0),
        lambda: pb.inspect(nowhere),
        lambda: pb.inspect(3),  # type: ignore[arg-type]
        lambda: pb.check(nowhere),
    ]
    for number, call in enumerate(calls):
        with pytest.raises(pb.Error) as caught:
            call()
        assert str(caught.value), number
