"""Names the body, and the surface near it, in the error of a run that cannot go on."""

from __future__ import annotations

from operator import itemgetter

from rigidfluid.core.mechanics.frames import to_world
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.errors import StepError, StepRejected

_SAMPLES = 200
"""Points of each body's surface whose distances are looked at."""

_LEAVES = "Bodies cannot pass through the domain's surfaces: end the run before, or make the domain longer there."


def stuck(system: System, state: State, rejection: StepRejected, time: float, shortest: float) -> StepError:
    """The error of a step that was rejected at its ``shortest`` size, from a state at a ``time``."""
    near = [
        (gap, body, "the nearest surface", rejection.remedy)
        for gap, body in zip(state.gaps.tolist(), system.surfaces, strict=False)
    ]
    near += [(gap, body, repr(opening), _LEAVES) for gap, body, opening in _near_openings(system, state)]
    gap, body, surface, remedy = min(near, default=(0.0, "", "", rejection.remedy), key=itemgetter(0))
    where = f"; body {body} is {gap:.3g} from {surface}" if near else ""
    error = StepError(
        f"{rejection.subject} at time {time:g}",
        f"{rejection.found}, even with a step of {shortest:g}{where}",
        rejection.allowed,
        f"{remedy} What was computed until then is kept.",
    )
    error.source = rejection.source
    return error


def _near_openings(system: System, state: State) -> list[tuple[float, str, str]]:
    """Gap, body and name of the surface, of each body and each surface that neither repels nor is crossed: those are in
    no contact."""
    passed = {wall.name for wall in system.walls}
    if len(system.lattice.vectors):
        passed |= {system.domain.names[number] for number in system.domain.periodic_pieces}
    openings = [piece for piece in system.meshed(state.pose).pieces if piece.name not in passed]
    found = []
    for number, body in enumerate(system.bodies):
        points = to_world(state.pose, number, body.sample_surface(_SAMPLES))
        for piece in openings:
            gap = float(piece.shape.signed_distance(points).min())
            found.append((gap, system.surfaces[number], piece.name))
    return found
