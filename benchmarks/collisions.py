"""One step of the whole collision algorithm among many balls.

As in Tables 2 and 3 of Van Landeghem et al., arXiv:2402.19093.

    python benchmarks/collisions.py [--most-bodies 125] [--json FILE]
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from grids import RANGE, balls_in_a_box
from mesh_sizes import mesh_sizes
from row_command import at_least, row_parser, show_rows

from rigidfluid.core.mechanics.wrenches import contact_wrench
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Mesh, Pose
from rigidfluid.detectors.narrow_band import NarrowBandDetector, NarrowBandOptions
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.forces.centre import CentreLaw, CentreOptions
from rigidfluid.post.studies.kernels.timing import fastest

PAPER = {
    2: {1: (0, 1), 25: (0, 16), 49: (28, 24), 81: (72, 32), 100: (100, 36)},
    3: {1: (0, 1), 27: (0, 26), 64: (0, 56), 125: (70, 98)},
}
"""Dimension → bodies → pairs of bodies in contact, bodies in contact with the boundary; arXiv:2402.19093."""


@dataclass(frozen=True, slots=True)
class CollisionRow:
    """One arrangement: contacts found, and seconds for detection, forces and wrenches, best of several.

    ``body_body`` and ``body_wall`` are what narrow_band finds, ``paper_…`` the paper's counts; a body at two walls
    counts once.
    """

    dimension: int
    bodies: int
    mesh_nodes: int
    body_body: int
    body_wall: int
    paper_body_body: int
    paper_body_wall: int
    seconds_sphere: float
    seconds_narrow_band: float
    seconds_narrow_band_one_thread: float


def collision_rows(most_bodies: int = 125, repeats: int = 5) -> Iterator[CollisionRow]:
    """Measure the paper's arrangements of at most ``most_bodies``, 2D first; the fastest of ``repeats`` runs counts."""
    for dimension, table in PAPER.items():
        for bodies, counts in table.items():
            if bodies <= most_bodies:
                yield _row(dimension, bodies, counts, repeats)


def _row(dimension: int, bodies: int, counts: tuple[int, int], repeats: int) -> CollisionRow:
    balls, pose, box, walls = balls_in_a_box(dimension, bodies)
    mesh = initial_mesh(FluidDomain(balls, pose, box, walls), mesh_sizes(dimension, bodies))
    detectors = (
        SphereDetector(PartOptions(), balls, walls),
        NarrowBandDetector(NarrowBandOptions(), balls, walls),
        NarrowBandDetector(NarrowBandOptions(threads=1), balls, walls),
    )
    seconds = [fastest(partial(_collide, detector, pose, mesh), repeats) for detector in detectors]
    contacts = _collide(detectors[1], pose, mesh)
    found = count_contacts(contacts, bodies)
    return CollisionRow(dimension, bodies, len(mesh.points), *found, *counts, *seconds)


def count_contacts(contacts: Contacts, bodies: int) -> tuple[int, int]:
    """Number of body pairs in contact, and of bodies in contact with the boundary, among so many ``bodies``."""
    at_wall = contacts.body_b >= bodies
    return int(np.count_nonzero(~at_wall)), len(np.unique(contacts.body_a[at_wall]))


def _collide(detector: Detector, pose: Pose, mesh: Mesh) -> Contacts:
    law = CentreLaw(CentreOptions(epsilon=1.0), RANGE)
    contacts = detector.detect(pose, mesh, RANGE)
    contact_wrench(contacts, law.force(contacts), pose)
    return contacts


def main() -> None:
    """Read the arguments, measure and print."""
    parser = row_parser(__doc__)
    parser.add_argument("--most-bodies", type=at_least(1), default=125, help="leave out arrangements of more")
    arguments = parser.parse_args()
    show_rows(collision_rows(arguments.most_bodies), arguments.json)


if __name__ == "__main__":
    main()
