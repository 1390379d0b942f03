"""The methods by name, as they are listed: ours come in through ``register`` as anybody's own do."""

from __future__ import annotations

from concio.solvers.registry import LAWS, METHODS, Method, check_options, find, laws_of, names_for, register

__all__ = ["LAWS", "METHODS", "Method", "check_options", "find", "laws_of", "names_for", "register"]

BOTH, PLANE = (2, 3), (2,)


def _enter(name: str, module: str, dimensions: tuple[int, ...] = BOTH, *, without: tuple[str, ...] = ()) -> None:
    """Register a module of ``concio.solvers`` under a name; ``without`` are the joint laws it does not treat."""
    laws = [law for law in LAWS if law not in without]
    register(name, f"concio.solvers.{module}", dimensions=dimensions, laws=laws, load=False)


_enter("auto", "auto.chain")
_enter("interior-point", "interior.engine")
_enter("lemke", "methods.forms.lemke", PLANE, without=("cap",))
_enter("sparse-lemke", "pivoting.sparse_lemke", PLANE)
_enter("exhaustive", "methods.exhaustive.state_search", PLANE, without=("cohesion", "tension", "dilatancy", "cap"))
_enter("klarbring", "methods.forms.klarbring", PLANE, without=("cap",))
_enter("ercolano", "methods.forms.ercolano", PLANE, without=("cap",))
_enter("lee", "methods.forms.lee", PLANE, without=("cap",))
_enter("del-piero", "methods.forms.del_piero", PLANE, without=("friction", "cap"))
_enter("penalty", "methods.iterative.penalty")
_enter("alart-curnier", "methods.iterative.alart_curnier")
_enter("simo-laursen", "methods.iterative.simo_laursen")
_enter("de-saxce", "methods.iterative.de_saxce")
_enter("panagiotopoulos", "methods.iterative.panagiotopoulos")
_enter("lagrange", "methods.iterative.lagrange", PLANE)
_enter("uzawa", "methods.iterative.uzawa")
_enter("gauss-seidel", "methods.iterative.gauss_seidel")
_enter("admm", "methods.iterative.admm")
