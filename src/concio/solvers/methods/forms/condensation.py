"""Condensation onto the contacts (23-25): the standard problem of a structure no body of which floats (Klarbring)."""

from __future__ import annotations

from concio.errors import MethodError
from concio.solvers.lcp.linear_problem import LinearComplementarity
from concio.solvers.methods.forms.forms import MixedForm


def condense(form: MixedForm) -> LinearComplementarity:
    """Return the standard problem of a form without rigid motions.

    Raises
    ------
    MethodError
        A body floats.
    """
    if form.motions:
        msg = f"condensation needs a positive definite stiffness, and there are {form.motions} rigid motions"
        raise MethodError(msg, hint="use ercolano, lee, lemke or interior-point, which take floating blocks")
    return LinearComplementarity(form.M, form.q)
