"""Formula of a force law for one contact, which compiled loops evaluate in place of the law's arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple
from warnings import catch_warnings, simplefilter

from rigidfluid.core.geometry.arrays import FloatArray

if TYPE_CHECKING:
    from rigidfluid.core.model.force_law import ForceLaw

Formula = Callable[[FloatArray, float, float, float, float, float, float], tuple[float, float, float, float]]


class PairFormula(NamedTuple):
    """Energy U of a law in one contact of ball a with a ball or flat wall b, and its force on a, (f + g) n - c v_t.

    f comes from the energy and g from damping [force], both along the normal n, and c >= 0 resists the velocity v_t
    along the surfaces [force·time/length]. No memory and no couples are possible.

    Parameters
    ----------
    function : callable
        ``function(parameters, gap, radius_a, radius_b, mass, opening, sliding)`` gives (U, f, g, c) for a gap up to the
        law's range [length], two radii, that of a wall infinite [length], the effective mass [mass], and the rate of
        the gap and \\|v_t\\| [length/time]. It is a plain function at the top of a module, of numbers and of NumPy's
        functions, so that Numba compiles it once and keeps it on disk.
    parameters : (p,) array
        The law's own numbers, handed to the function as they are.
    """

    function: Formula
    parameters: FloatArray


def own_formula(law: ForceLaw) -> PairFormula | None:
    """Formula of a law whose class gives one itself; an inherited one may leave out what the class has changed."""
    return law.pair_formula() if "pair_formula" in vars(type(law)) else None


@contextmanager
def formulas_compiled() -> Iterator[None]:
    """Let loops be compiled without Numba's warning that functions as arguments are experimental."""
    with catch_warnings():
        simplefilter("ignore")
        yield


@cache
def compiled(function: Formula) -> Any:
    """The function, compiled for calls from compiled loops; as it is where Numba compiles nothing."""
    from numba import cfunc, config

    if getattr(config, "DISABLE_JIT", False):
        return function
    numbers = ", ".join(["float64"] * 6)
    return cfunc(f"UniTuple(float64, 4)(float64[::1], {numbers})", cache=True)(function)
