"""A controller that plans anew in each interval of a control problem."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from proboscis import _proboscis
from proboscis._error import Error
from proboscis._table import Array


class Controller:
    """Inputs of each interval of a control problem, planned anew over a receding horizon from what is measured at its start.

    Numbers are in SI units. While the robot moves, another thread prepares the next step.
    """

    measured: dict[str, str]
    """Names of what is measured, in order, with their units."""
    inputs: dict[str, str]
    """Names of the inputs, in order, with their units."""
    interval: float
    """Length of the intervals in s."""
    source: str
    """Origin of the inputs of the last step: `plan`; `late`, `unusable` or `kept` of the plan as it was, where nothing was measured, what was measured is
    no state of the robot, or the step failed; `regulator` of the gains that act where the plan has failed. Empty before the first step."""

    def __init__(self, native: _proboscis.Controller, /) -> None:
        self._native = native
        measured, inputs = native.names()
        self.measured, self.inputs = dict(measured), dict(inputs)
        self.interval = native.interval()
        self.source = ""

    def step(self, time: float, measured: npt.ArrayLike | None) -> Array:
        """The inputs that act from a time in s on, with what is measured there; `None` where it did not come in time. Called again within an interval, or
        at a time that is no finite number, it gives the same inputs."""
        state = None
        if measured is not None:
            state = np.ascontiguousarray(measured, dtype=float)
            if state.ndim != 1:
                raise Error(f"measured: found {state.ndim} dimensions, expected 1", "measured")
        self.source, inputs = self._native.step(float(time), state)
        return inputs
