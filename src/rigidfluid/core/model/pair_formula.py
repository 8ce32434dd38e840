"""Formula of a force law for one contact, which compiled loops evaluate in place of the law's arrays."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import FunctionType
from typing import TYPE_CHECKING, Any, NamedTuple
from warnings import filterwarnings

import numpy as np

from rigidfluid.core.geometry.answers import refuse_others
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.value_types import describe
from rigidfluid.core.geometry.wrong import Wrong
from rigidfluid.error_text import error_text
from rigidfluid.errors import PluginError

if TYPE_CHECKING:
    from rigidfluid.core.model.force_law import ForceLaw
    from rigidfluid.core.model.types import Contacts

Formula = Callable[[FloatArray, float, float, float, float, float, float], tuple[float, float, float, float]]


class PairSprings(NamedTuple):
    """Springs along the surfaces of two balls, or of one and a wall, and the friction that shortens them.

    Force and couple on ball a are -k_t ξ - min(c |v_t|, μ |F_n|) v_t/|v_t| and -R [k_t ζ + min(c R |w|, μ_r |F_n|)
    w/|w|], with F_n = f + g and c of the formula; ξ and ζ are shortened until force and couple are at most μ |F_n| and
    μ_r R |F_n|. For the part of ζ along the normal it is μ_o in place of μ_r.

    Parameters
    ----------
    stiffness : float
        Stiffness k_t [force/length].
    friction : float
        Coefficient μ of friction along the surfaces [1].
    rolling : float
        Coefficient μ_r of rolling friction, zero without [1].
    twisting : float
        Coefficient μ_o of friction that resists turning about the normal, zero without [1].
    bounded : bool
        Whether the dashpot along the surfaces is bounded by itself; if not, its force is -c v_t.
    """

    stiffness: float
    friction: float
    rolling: float = 0.0
    twisting: float = 0.0
    bounded: bool = True


class PairFormula(NamedTuple):
    """Energy U of a law in one contact of ball a with a ball or flat wall b, and its force on a, (f + g) n - c v_t.

    f comes from the energy and g from damping [force], both along the normal n, and c >= 0 resists the velocity v_t
    along the surfaces [force·time/length]. The only memory and the only couples are those of ``springs``.

    Parameters
    ----------
    function : callable
        ``function(parameters, gap, radius_a, radius_b, mass, opening, sliding)`` gives (U, f, g, c) for a gap up to the
        law's range [length], two radii, that of a wall infinite [length], the effective mass [mass], and the rate of
        the gap and \\|v_t\\| [length/time]. It is a plain function at the top of a module, of numbers and of NumPy's
        functions, so that Numba compiles it once and keeps it on disk. It raises nothing: a division by zero is
        infinite or not a number, as in arrays.
    parameters : (p,) array
        The law's own numbers, handed to the function as they are.
    springs : PairSprings, optional
        Springs along the surfaces, None without any; c is then that of their dashpot, which they bound.
    each : callable, optional
        ``each(contacts)`` gives the parameters of each contact, (m, p), by its surfaces and their radii alone, where
        they differ; then ``parameters`` are not read.
    """

    function: Formula
    parameters: FloatArray
    springs: PairSprings | None = None
    each: Callable[[Contacts], FloatArray] | None = None


def refuse_no_formula(answer: Any, *_: Any, **__: Any) -> None:
    """Refuse what is neither None nor a formula with a function and a row of numbers."""
    if answer is None:
        return
    refuse_others(answer, PairFormula)
    refuse_others(answer.function, FunctionType, "function")
    numbers = np.asarray(answer.parameters)
    if numbers.ndim != 1 or numbers.dtype.kind not in "fiu":
        raise Wrong(f"parameters {describe(numbers)}", "a row of real numbers")
    if answer.springs is not None:
        refuse_others(answer.springs, PairSprings, "springs")


def own_formula(law: ForceLaw) -> PairFormula | None:
    """Formula of a law whose class gives one itself; an inherited one may leave out what the class has changed."""
    formula = law.pair_formula() if "pair_formula" in vars(type(law)) else None
    return formula and formula._replace(parameters=np.ascontiguousarray(formula.parameters, dtype=np.float64))


def common_formula(law: ForceLaw) -> PairFormula | None:
    """Own formula of a law, if it has one with the same parameters in all contacts."""
    formula = own_formula(law)
    return formula if formula is None or formula.each is None else None


@cache
def compiled(function: Formula) -> Any:
    """The function, compiled for calls from compiled loops; itself where Numba compiles nothing.

    Raises PluginError if it cannot be compiled.
    """
    from numba import cfunc, config
    from numba.core.errors import NumbaError

    if getattr(config, "DISABLE_JIT", False):
        return function
    filterwarnings("ignore", "First-class function type feature is experimental")
    numbers = ", ".join(["float64"] * 6)
    signature = f"UniTuple(float64, 4)(float64[::1], {numbers})"
    try:
        return cfunc(signature, cache=True, error_model="numpy")(function)
    except (NumbaError, RuntimeError) as error:
        told = " ".join(error_text(error).splitlines()[:2])
        raise PluginError(
            f"formula {function.__module__}.{function.__qualname__}",
            f"what Numba cannot compile or keep: {told}",
            "a plain function in a module's file, of numbers and of NumPy's functions",
            "Mend it, or let pair_formula give None: then force and damping are asked.",
        ) from error
