"""Can bodies cross the periodic surfaces of a fluid, and if not, do they meet what is beyond?"""

from __future__ import annotations

from collections.abc import Iterator

from rigidfluid.checks.finding import Finding, figure
from rigidfluid.core.mesh.adaptation.crossing import bodies_cross, unseen_contacts
from rigidfluid.core.model.system import System

QUESTION = "periodic"


def periodic_findings(system: System) -> Iterator[Finding]:
    """Report periodic surfaces of a fluid that bodies do not cross; an error for a contact across them that no detector
    sees."""
    if not system.has_fluid or bodies_cross(system):
        return
    text = "bodies do not cross periodic surfaces here, and do not meet images of each other"
    text += ": the run ends where one leaves the domain, or comes within the range of the laws to an image"
    yield Finding("note", QUESTION, (), text)
    for body, other, gap in unseen_contacts(system, system.pose):
        name = system.surfaces[body]
        text = f"{name} starts at a gap of {figure(gap)} to {other} across a periodic surface, where no contact is seen"
        yield Finding("error", QUESTION, (name, other), text, "Move it, or lengthen the domain.", {"gap": gap})
