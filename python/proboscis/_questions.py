"""Keyword arguments of a system and of what it is asked.

Written by `python/generate.py` from the JSON Schema of problems.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from proboscis import entries
    from proboscis.entries import Numbers, Quantity, Text
    from proboscis.problem import Problem, Step
    from proboscis.result import Result


class Questions:
    """What a system is made with, and what it is asked."""

    __slots__ = ()

    def _begin(self, name: str, folder: str | PathLike[str], scene: dict[str, Any]) -> None:
        raise NotImplementedError

    def _problem(self, task: str, asked: dict[str, Any]) -> Problem:
        raise NotImplementedError

    def __init__(
        self,
        name: str,
        /,
        *,
        folder: str | PathLike[str] = ".",
        chain: entries.Chain | None = None,
        gravity: Sequence[Quantity] | Numbers | None = None,
    ) -> None:
        """A scene with a name, to which parts are added; `folder` is where files that it names are looked for.

        * `chain`: Shorthand for a chain of segments with a pair of muscles at each joint.
        * `gravity`: Acceleration of gravity, SI unit m/s².
        """
        self._begin(
            name,
            folder,
            {
                "chain": chain,
                "gravity": gravity,
            },
        )

    def control(
        self,
        *,
        combine: entries.Combined | None = None,
        coordinates: entries.Coordinates | None = None,
        duration: entries.Duration | None = None,
        free: Mapping[Any, entries.Free] | None = None,
        goal: entries.Goal | None = None,
        guess: entries.Guess | None = None,
        hold: entries.Hold | None = None,
        intervals: entries.Intervals | None = None,
        limits: Sequence[entries.Limit] | None = None,
        load_bounds: Mapping[Any, Sequence[Quantity] | Numbers] | None = None,
        loads: Mapping[Any, entries.Signal] | None = None,
        motions: Sequence[entries.Motion] | None = None,
        objective: entries.Objective | None = None,
        phases: Sequence[entries.Motion] | None = None,
        sensitivity: Mapping[Any, entries.Sensitivity] | None = None,
        shared_inputs: Sequence[Text] | None = None,
        solver: entries.Solver | None = None,
        start: entries.Start | None = None,
        voltage_bounds: Sequence[Quantity] | Numbers | None = None,
        voltages: entries.Voltages | None = None,
        waypoints: Sequence[entries.Waypoint] | None = None,
    ) -> Problem:
        """Returns the optimal control problem with these entries of `control` in a problem file.

        * `combine`: The objective of several motions: the `sum` of theirs (where not written), or that of the `worst`, the greatest one.
        * `coordinates`: Coordinates.
        * `duration`: Final time, SI unit s, or its bounds and a guess.
        * `free`: Constants of the scene that are sought, by their paths, such as `materials.silicone.shear_modulus`.
        * `goal`: Final state; may be left out where the objective names something to `track` or where to end (`final`), and is free then.
        * `guess`: Initial guess of the solver; where not written, of elastic blocks whose goal has `hold`, the motion under these voltages,
          otherwise `"interpolate"`.
        * `hold`: Treatment of a goal that cannot be kept, because it is unstable or its voltages are beyond their bounds: it is `reported`
          (where not written), or refused where holding it is `required`.
        * `intervals`: Number of intervals, 1 or more, or `"auto"`, as where it is not written: as many as the verification of the optimum
          needs to confirm an error of 1 % of the path length, or of the part that `--accuracy` gives.
        * `limits`: Path limits.
        * `load_bounds`: Lower and upper bound of each load that is sought, by name, SI units N, N m, Pa, N/m³ and C/m².
        * `loads`: Loads that are given, by name, constant or functions of time, SI units N, N m, Pa, N/m³ and C/m²; 0 where neither given nor
          sought.
        * `motions`: Several motions in one optimisation: what `free` seeks is the same in all of them, and the objective is the sum of
          theirs. Each names the keys that are other ones in it.
        * `objective`: Objective that is minimised.
        * `phases`: Phases of one motion, each of which goes on where the one before ended: the first one begins at `start`, the last one ends
          at `goal`. Each has its `duration`, given or with bounds and a guess, and the keys that are other ones in it; `duration` beside them
          is that of all together.
        * `sensitivity`: Numbers by which the optimum is differentiated, by their paths: constants of the scene, such as
          `materials.silicone.shear_modulus`, and `duration`, `goal.joint_angles.NAME`, `goal.markers.NAME[0]`, `goal.rest_at_voltages.NAME`,
          `start.joint_angles.NAME`, `start.joint_rates.NAME`, `start.rest_at_voltages.NAME`, `voltage_bounds[1]`, `load_bounds.NAME[1]`,
          `objective.effort`, `objective.rate`, `objective.duration`.
        * `shared_inputs`: Names of muscles, driven electrodes (`block.electrode`) and loads whose inputs are sought once for all motions;
          these have one given duration and one number of intervals.
        * `solver`: Options of the solver.
        * `start`: Initial state; of a periodic motion, whose start is sought, the state where the solver begins.
        * `voltage_bounds`: Lower and upper bound of every voltage that is sought, SI unit V; not needed where none is.
        * `voltages`: Voltages that are given, by the names of muscles and driven electrodes (`block.electrode`), SI unit V: they are no
          unknowns, and one of 0 for all the time leaves no electric term at all. Functions of time, a table and those of a solution give all
          voltages, as of a simulation; then a constant of the scene has to be sought.
        * `waypoints`: Places, orientations and joint coordinates that the motion reaches on its way.
        """
        problem = self._problem(
            "control",
            {
                "combine": combine,
                "coordinates": coordinates,
                "duration": duration,
                "free": free,
                "goal": goal,
                "guess": guess,
                "hold": hold,
                "intervals": intervals,
                "limits": limits,
                "load_bounds": load_bounds,
                "loads": loads,
                "motions": motions,
                "objective": objective,
                "phases": phases,
                "sensitivity": sensitivity,
                "shared_inputs": shared_inputs,
                "solver": solver,
                "start": start,
                "voltage_bounds": voltage_bounds,
                "voltages": voltages,
                "waypoints": waypoints,
            },
        )
        return problem

    def simulate(
        self,
        *,
        duration: Quantity,
        controller: entries.Controller | None = None,
        coordinates: entries.Coordinates | None = None,
        integrator: entries.Integrator | None = None,
        linear_solver: entries.LinearSolver | None = None,
        loads: Mapping[Any, entries.Signal] | None = None,
        newton: entries.Newton | None = None,
        start: entries.Start | None = None,
        step: entries.Step | None = None,
        tolerance: float | None = None,
        voltages: entries.Voltages | None = None,
        output: str | PathLike[str] | None = None,
        on_step: Callable[[Step], object] | None = None,
        max_seconds: float | None = None,
    ) -> Result:
        """Simulates with these entries of `simulate` in a problem file; the others are those of `Problem.simulate`.

        * `duration`: Length, SI unit s.
        * `controller`: A controller that gives the voltages which it has gains for.
        * `coordinates`: Coordinates.
        * `integrator`: The method; the midpoint variational integrator where not written.
        * `linear_solver`: Method by which its linear systems are solved; `auto` where not written.
        * `loads`: Loads by name, constant or functions of time, SI units N, N m, Pa, N/m³ and C/m²; 0 where not named.
        * `newton`: Occasions at which the tangent of a step is factorised; where not written `modified` with finite elements, otherwise
          `full`.
        * `start`: Start of the motion; the reference configuration at rest where not written.
        * `step`: Step, SI unit s, or `"auto"`, as where it is not written: steps as short as the tolerance needs, by the midpoint rule.
        * `tolerance`: Sum of the estimated local errors that `"auto"` allows over the duration, of angles in rad, of lengths relative to the
          robot's size; 1e-3 where not written.
        * `voltages`: Constant voltages, those of a solution, or a table; 0 where not written.
        """
        problem = self._problem(
            "simulate",
            {
                "duration": duration,
                "controller": controller,
                "coordinates": coordinates,
                "integrator": integrator,
                "linear_solver": linear_solver,
                "loads": loads,
                "newton": newton,
                "start": start,
                "step": step,
                "tolerance": tolerance,
                "voltages": voltages,
            },
        )
        return problem.simulate(output=output, on_step=on_step, max_seconds=max_seconds)

    def equilibrium(
        self,
        *,
        coordinates: entries.Coordinates | None = None,
        frequency_response: entries.FrequencyResponse | None = None,
        loads: Mapping[Any, Quantity] | None = None,
        modes: int | None = None,
        path: int | None = None,
        response: entries.Response | None = None,
        voltages: Mapping[Any, Quantity] | None = None,
        output: str | PathLike[str] | None = None,
        max_seconds: float | None = None,
    ) -> Result:
        """Finds the state of rest with these entries of `equilibrium` in a problem file; the others are those of `Problem.equilibrium`.

        * `coordinates`: Coordinates.
        * `frequency_response`: Response of joints and markers to an input that oscillates about its value at rest.
        * `loads`: Loads by name, SI units N, N m, Pa, N/m³ and C/m²; 0 where not named.
        * `modes`: Number of vibrations about the state, those of lowest frequencies: natural frequencies, damping ratios and shapes.
        * `path`: Number of points of the path of equilibria from zero voltage that are followed by arc length, past limit points such as
          pull-in.
        * `response`: Response of Maxwell branches; `relaxed` where not written.
        * `voltages`: Voltages by the names of muscles and driven electrodes (`block.electrode`), SI unit V; 0 where not named.
        """
        problem = self._problem(
            "equilibrium",
            {
                "coordinates": coordinates,
                "frequency_response": frequency_response,
                "loads": loads,
                "modes": modes,
                "path": path,
                "response": response,
                "voltages": voltages,
            },
        )
        return problem.equilibrium(output=output, max_seconds=max_seconds)

    def identify(
        self,
        *,
        recordings: Sequence[entries.Recording],
        candidates: Sequence[entries.Candidate] | None = None,
        coordinates: entries.Coordinates | None = None,
        free: Mapping[Any, entries.Free] | None = None,
        inputs: entries.InputConstants | None = None,
        priors: Mapping[Any, entries.Prior] | None = None,
        step: Quantity | None = None,
        output: str | PathLike[str] | None = None,
        max_seconds: float | None = None,
    ) -> Result:
        """Fits constants with these entries of `identify` in a problem file; the others are those of `Problem.identify`.

        * `recordings`: Recordings: those that constants are fitted to, and those that are held out to check their prediction.
        * `candidates`: Experiments that could be done next; the result ranks them by the variance that they leave.
        * `coordinates`: Coordinates.
        * `free`: Free parameters by their paths in the scene, such as `"materials.silicone.shear_modulus"`, each between bounds.
        * `inputs`: Constants of the inputs that are sought: gains of sources, and their delays.
        * `priors`: Constants of `free` that are known beside the recordings, by their paths: each counts as one reading more.
        * `step`: Step of the first grid, SI unit s, which is halved until its bias is below a tenth of the standard errors; by the number of
          readings where not written.
        """
        problem = self._problem(
            "identify",
            {
                "recordings": recordings,
                "candidates": candidates,
                "coordinates": coordinates,
                "free": free,
                "inputs": inputs,
                "priors": priors,
                "step": step,
            },
        )
        return problem.identify(output=output, max_seconds=max_seconds)
