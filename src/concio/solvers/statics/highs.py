"""HiGHS for linear programmes: the dual simplex method and the interior point, called without an interface between.

SciPy has HiGHS too. Loading ``scipy.optimize`` takes longer than to solve a small model, and what its interface does
before and after takes longer than HiGHS does on the programmes of statics.
"""

from __future__ import annotations

from typing import Any, Literal

import highspy
import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array

Algorithm = Literal["simplex", "ipm"]

DUAL_SIMPLEX = 1
"""Of HiGHS' ``simplex_strategy``."""

STATUS = {
    highspy.HighsModelStatus.kOptimal: 0,
    highspy.HighsModelStatus.kTimeLimit: 1,
    highspy.HighsModelStatus.kIterationLimit: 1,
    highspy.HighsModelStatus.kInfeasible: 2,
    highspy.HighsModelStatus.kUnbounded: 3,
}
"""What HiGHS ends with, in the numbers of SciPy's ``linprog``; 4 for anything else."""


def minimise(
    cost: Array, matrix: sp.csc_array, rows: Array, bounds: Array, algorithm: Algorithm, tolerance: float
) -> tuple[int, Array, Array, str]:
    """Minimise cost'x, rows[:, 0] <= A x <= rows[:, 1], bounds[:, 0] <= x <= bounds[:, 1].

    Parameters
    ----------
    cost : (n,) array
    matrix : (M, n) sparse array
    rows : (M, 2) array
    bounds : (n, 2) array
    algorithm : {"simplex", "ipm"}
    tolerance : float
        Feasibility asked of x and of the multipliers.

    Returns
    -------
    tuple of int, (n,) array, (M,) array, str
        Status (0 optimal, 1 stopped, 2 infeasible, 3 unbounded, 4 no answer), x and the multipliers of the rows, both
        empty where the status is not 0, and the status in the words of HiGHS.
    """
    solver: Any = highspy.Highs  # its stubs leave out the constructor
    highs = solver()
    options = {
        "output_flag": False, "solver": algorithm, "simplex_strategy": DUAL_SIMPLEX,
        "primal_feasibility_tolerance": tolerance, "dual_feasibility_tolerance": tolerance,
    }  # fmt: skip
    for name, value in options.items():
        highs.setOptionValue(name, value)
    if highs.passModel(_programme(cost, matrix, rows, bounds)) == highspy.HighsStatus.kError:
        return 4, np.zeros(0), np.zeros(0), "HiGHS does not take the programme"
    highs.run()
    ended = highs.getModelStatus()
    status, message = STATUS.get(ended, 4), str(highs.modelStatusToString(ended))
    if status != 0:
        return status, np.zeros(0), np.zeros(0), message
    found = highs.getSolution()
    return status, np.array(found.col_value), np.array(found.row_dual), message


def _programme(cost: Array, matrix: sp.csc_array, rows: Array, bounds: Array) -> highspy.HighsLp:
    programme = highspy.HighsLp()
    programme.num_row_, programme.num_col_ = matrix.shape
    programme.col_cost_ = cost
    programme.col_lower_, programme.col_upper_ = bounds[:, 0].copy(), bounds[:, 1].copy()
    programme.row_lower_, programme.row_upper_ = rows[:, 0].copy(), rows[:, 1].copy()
    held = programme.a_matrix_
    held.num_row_, held.num_col_ = matrix.shape
    held.format_ = highspy.MatrixFormat.kColwise
    held.start_, held.index_, held.value_ = matrix.indptr, matrix.indices, matrix.data
    return programme
