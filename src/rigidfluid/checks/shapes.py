"""Are shapes made of facets what was meant: how large are they, and where is their centre of mass?"""

from __future__ import annotations

from collections.abc import Iterator

from rigidfluid.checks.finding import Finding, figure
from rigidfluid.core.model.system import System

QUESTION = "shape"


def facet_findings(system: System) -> Iterator[Finding]:
    """Report the sizes of bodies of facets, and the centre of mass in the coordinates of the facets, which `position`
    places; once for each shape."""
    seen: list[object] = []
    for name, body in zip(system.surfaces, system.bodies, strict=False):
        if body.facets is None or (body.name, body.options) in seen:
            continue
        seen.append((body.name, body.options))
        count, centre = len(body.facets.vertices), body.given_centre.tolist()
        found = {
            "facets": count,
            "volume": body.volume,
            **{f"centre_{axis}": value for axis, value in zip("xyz", centre, strict=False)},
        }
        text = f"{name} has {count} facets and a volume of {figure(body.volume)}; `position` is where the point "
        text += f"({', '.join(map(figure, centre))}) of its facets is put, its centre of mass"
        yield Finding("note", QUESTION, (name,), text, found=found)
