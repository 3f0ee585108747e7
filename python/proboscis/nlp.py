"""The nonlinear program of a control problem, for a solver of one's own."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from proboscis import _proboscis
from proboscis._error import Error
from proboscis._table import Array

if TYPE_CHECKING:
    from scipy.sparse import csc_array

Indices = npt.NDArray[np.uint32]


class Nlp:
    """Minimise f(x) subject to g_L ≤ g(x) ≤ g_U and x_L ≤ x ≤ x_U, of n variables and m constraints.

    Numbers are in the units of the program: g, mm, ms, N, V, voltages and multipliers scaled. Values that do not exist at a point are NaN. Derivatives
    are exact. scipy is needed for matrices alone.
    """

    start: Array
    """Point where the solver of proboscis begins, n numbers."""
    bounds: tuple[Array, Array]
    """x_L and x_U, n numbers each, −∞ or ∞ where there is none."""
    constraint_bounds: tuple[Array, Array]
    """g_L and g_U, m numbers each; equal of an equation."""
    names: list[str]
    """What each variable is."""
    constraint_names: list[str]
    """What each constraint is."""
    jacobian_structure: tuple[Indices, Indices]
    """Rows and columns of the entries of the Jacobian."""
    hessian_structure: tuple[Indices, Indices]
    """Rows and columns of the entries of the lower triangle of the Hessian."""

    def __init__(self, program: _proboscis.Program, /) -> None:
        self._program = program
        self.start = program.start()
        lower, upper, constraint_lower, constraint_upper = program.bounds()
        self.bounds = lower, upper
        self.constraint_bounds = constraint_lower, constraint_upper
        rows, columns, hessian_rows, hessian_columns = program.structures()
        self.jacobian_structure = rows, columns
        self.hessian_structure = hessian_rows, hessian_columns
        self.names, self.constraint_names = program.names()

    @property
    def n(self) -> int:
        """Number of variables."""
        return len(self.start)

    @property
    def m(self) -> int:
        """Number of constraints."""
        return len(self.constraint_bounds[0])

    def objective(self, x: npt.ArrayLike) -> float:
        """f(x)."""
        return self._program.objective(self._vector(x, self.n, "x"))

    def gradient(self, x: npt.ArrayLike) -> Array:
        """∇f(x), n numbers."""
        return self._program.gradient(self._vector(x, self.n, "x"))

    def constraints(self, x: npt.ArrayLike) -> Array:
        """g(x), m numbers."""
        return self._program.constraint(self._vector(x, self.n, "x"))

    def jacobian_values(self, x: npt.ArrayLike) -> Array:
        """Entries of ∇g(x) at `jacobian_structure`."""
        return self._program.jacobian(self._vector(x, self.n, "x"))

    def jacobian(self, x: npt.ArrayLike) -> csc_array:
        """∇g(x), a sparse matrix of m rows and n columns."""
        from scipy.sparse import csc_array

        return csc_array((self.jacobian_values(x), self.jacobian_structure), shape=(self.m, self.n))

    def hessian_values(self, x: npt.ArrayLike, multipliers: npt.ArrayLike, factor: float = 1.0) -> Array:
        """Entries of the lower triangle of `factor` ∇²f(x) + Σ yᵢ ∇²gᵢ(x) at `hessian_structure`, of m multipliers y."""
        y = self._vector(multipliers, self.m, "multipliers")
        return self._program.hessian(self._vector(x, self.n, "x"), factor, y)

    def hessian(self, x: npt.ArrayLike, multipliers: npt.ArrayLike, factor: float = 1.0) -> csc_array:
        """`factor` ∇²f(x) + Σ yᵢ ∇²gᵢ(x), a symmetric sparse matrix of n rows, of m multipliers y."""
        from scipy.sparse import csc_array, tril

        values = self.hessian_values(x, multipliers, factor)
        lower = csc_array((values, self.hessian_structure), shape=(self.n, self.n))
        return csc_array(lower + tril(lower, -1).T)

    @staticmethod
    def _vector(values: npt.ArrayLike, length: int, name: str) -> Array:
        try:
            vector = np.ascontiguousarray(values, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise Error(f"{name}: found {values!r} ({error}), expected {length} numbers", name) from error
        if vector.shape != (length,):
            raise Error(f"{name}: found an array of shape {vector.shape}, expected {length} numbers", name)
        return vector

    def __repr__(self) -> str:
        return f"<Nlp: {self.n} variables, {self.m} constraints>"
