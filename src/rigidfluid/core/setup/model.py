"""A model: bodies, and what is around them, composed of objects; a scene is one way to make one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import field, replace
from functools import cached_property
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.contact.path.detector_choice import choose_detector
from rigidfluid.core.fluid.conditions import BoundaryCondition, NoSlip
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.mechanism import Mechanism
from rigidfluid.core.model.selected import Selected
from rigidfluid.core.scene.boundary_tables import BoundaryTable
from rigidfluid.core.scene.domain_table import WindowTable
from rigidfluid.core.scene.exchange_tables import SinkTable, SourceTable
from rigidfluid.core.scene.mesh_tables import AUTO
from rigidfluid.core.scene.patterns import FILE_NAME
from rigidfluid.core.scene.run_tables import OutputTable, TimeTable
from rigidfluid.core.scene.scene import Scene, UnitsTable
from rigidfluid.core.scene.swarm_tables import SwarmTable
from rigidfluid.core.setup.checked import AnyRow, NotNegative, Vector, checked
from rigidfluid.core.setup.contact_laws import ContactLaw, told_apart
from rigidfluid.core.setup.description import describe
from rigidfluid.core.setup.fluid import Fluid, NoFluid
from rigidfluid.core.setup.image_checks import crossed_lattice
from rigidfluid.core.setup.model_checks import check_model
from rigidfluid.core.setup.pair_forces import PairForce, told_in_order
from rigidfluid.core.setup.placed_bodies import Arrangement
from rigidfluid.core.setup.rigid_body import JoinedBodies, PlacedMechanism, RigidBody
from rigidfluid.described import Described, first_names
from rigidfluid.registry import Registry

ConditionMaker = Callable[[int, str, FloatArray | None], BoundaryCondition]
"""Class of a boundary condition, or a function, called with the number, the name and the unit normal of a surface."""


@checked
class ContactStepping:
    """Way of bodies through contacts: in ``substeps``, as many as they need if None, or in an ``implicit`` step.

    ``impact_speed``: speed at which free bodies hit, estimated if None [length/time].
    """

    substeps: Annotated[int, Field(ge=1)] | None = None
    implicit: bool = False
    impact_speed: NotNegative | None = None


@checked
class Model(Arrangement, Described):
    """Rigid bodies in a domain, with what is around them and between them: m dv/dt = (m - ρV)g + fluid + contacts.

    Nothing in it needs to be registered: a domain, a shape, a law, a condition or a size field may be any object of its
    class.

    Parameters
    ----------
    domain : Domain
        The region that fluid and bodies share.
    bodies : sequence of RigidBody
        Single bodies.
    time : TimeTable
        End, steps and tolerance.
    output : OutputTable
        Interval of fields and checkpoints, and probes.
    fluid : Fluid or NoFluid
        The fluid around the bodies, or none.
    gravity : sequence of float, optional
        (d,) zero if not given [length/time²].
    boundary : mapping of str to callable
        Class of the condition on each surface of the domain, by its name: it is called with the number, the name and
        the unit normal of the surface; those not named are walls at rest.
    mechanisms : sequence of PlacedMechanism
        Bodies that move as one.
    joints : sequence of JoinedBodies
        Joints of bodies with each other or the ground.
    laws : sequence of ContactLaw
        Forces of contact.
    pair_forces : sequence of PairForce
        Long-range forces between two bodies.
    detector : Selected, optional
        Class of the detector and its options; the cheapest that is exact if not given.
    stepping : ContactStepping
        How bodies go through contacts.
    window : WindowTable, optional
        The part of the domain that is meshed; all if not given.
    name : str
        Name in results.
    seed : int
        Seed of all random numbers.
    registry : Registry
        Installed parts, among which detectors are chosen.

    Raises
    ------
    SceneError
        If it contradicts itself.
    """

    domain: Domain
    bodies: Annotated[tuple[RigidBody, ...], AnyRow]
    time: TimeTable
    output: OutputTable
    fluid: Fluid | NoFluid = field(default_factory=NoFluid)
    gravity: Vector | None = None
    boundary: Mapping[str, ConditionMaker] = field(default_factory=dict)
    mechanisms: Annotated[tuple[PlacedMechanism, ...], AnyRow] = ()
    joints: Annotated[tuple[JoinedBodies, ...], AnyRow] = ()
    laws: Annotated[tuple[ContactLaw, ...], AnyRow] = ()
    pair_forces: Annotated[tuple[PairForce, ...], AnyRow] = ()
    detector: Selected[Detector] | None = None
    stepping: ContactStepping = ContactStepping()
    window: WindowTable | None = None
    name: Annotated[str, Field(pattern=FILE_NAME)] = "model"
    seed: Annotated[int, Field(ge=0)] = 0
    registry: Registry = field(default_factory=Registry.load, repr=False, compare=False)

    _scene: ClassVar[Scene | None] = None
    _detector_why: ClassVar[str] = "the model names it"

    __repr__ = Described.__repr__  # in the place of the dataclass's own, which would tell every option

    def __post_init__(self) -> None:
        check_model(self)

    def _facts(self) -> Mapping[str, object]:
        return {
            "name": self.name,
            "dimension": self.dimension,
            "domain": type(self.domain).__name__,
            "fluid": self.fluid.backend.part.__name__,
            "bodies": first_names([body.name for body in self.bodies]),
            "mechanisms": first_names([placed.name for placed in self.mechanisms]),
            "joints": len(self.joints) or None,
            "laws": first_names([law.part.__name__ for law in self._all_laws]),
            "time": f"to {self.time.end:g} in steps of {self.time.step:g}",
        }

    @property
    def _all_laws(self) -> list[Selected[Any]]:
        return [law.law for law in self.laws] + [force.law for force in self.pair_forces]

    def told_by(self, scene: Scene, detector_why: str) -> Model:
        """The same model, with the scene that it was made of for results and checkpoints, and why its detector was
        chosen; other models that are made of it by `dataclasses.replace` have neither."""
        told = copy(self)
        for name, value in (("_scene", scene), ("_detector_why", detector_why)):
            object.__setattr__(told, name, value)
        return told

    def with_bodies(self, bodies: tuple[RigidBody, ...], mechanisms: tuple[PlacedMechanism, ...]) -> Model:
        """The same model with other bodies, and mechanisms in other places, told in results and checkpoints as this
        one; a detector that nobody named is chosen for them, and laws and long-range forces of those that are gone are
        left out."""
        gone = {body.name for body in self.bodies} - {body.name for body in bodies}
        changed = replace(
            self,
            bodies=bodies,
            mechanisms=mechanisms,
            laws=tuple(law for law in self.named_laws if gone.isdisjoint(law.names)),
            pair_forces=tuple(one for one in told_in_order(self.pair_forces) if gone.isdisjoint(one.between)),
            detector=self.detector if self.names_detector else None,
        )
        if self._scene is not None:
            changed = changed.told_by(self._scene, self._detector_why)
        changed.__dict__["document"] = self.document
        return changed

    @cached_property
    def document(self) -> Mapping[str, Any]:
        """Tables of the scene that it was made of, or else a description that tells it from other models, as JSON can
        hold them."""
        return describe(self) if self._scene is None else self._scene.to_dict()

    @property
    def units(self) -> UnitsTable | None:
        """Names of the units in the scene that it was made of; None if there are none."""
        return None if self._scene is None else self._scene.scene.units

    @property
    def boundary_tables(self) -> tuple[BoundaryTable, ...]:
        """Tables of conditions in the scene that it was made of."""
        return () if self._scene is None else self._scene.boundary

    @property
    def swarm_tables(self) -> tuple[SwarmTable, ...]:
        """Tables of swarms in the scene that it was made of."""
        return () if self._scene is None else self._scene.swarm

    @property
    def names_detector(self) -> bool:
        """Tell whether its detector was named, and not chosen for its bodies."""
        return self.detector is not None and (self._scene is None or self._scene.contact.detector != AUTO)

    @property
    def source_tables(self) -> tuple[SourceTable, ...]:
        """Tables of sources in the scene that it was made of."""
        return () if self._scene is None else self._scene.source

    @property
    def sink_tables(self) -> tuple[SinkTable, ...]:
        """Tables of sinks in the scene that it was made of."""
        return () if self._scene is None else self._scene.sink

    @property
    def wet(self) -> bool:
        """Tell whether there is a fluid around the bodies, on a mesh."""
        return self.fluid.backend.part.wet

    @cached_property
    def crossed(self) -> Lattice:
        """The lattice by which bodies cross periodic surfaces, without vectors where they do not."""
        return crossed_lattice(self)

    @cached_property
    def named_laws(self) -> tuple[ContactLaw, ...]:
        """The laws, each with the field that messages name it by and with the names of surfaces that results have."""
        return told_apart(self.laws, self.domain.pieces)

    @property
    def prescribed(self) -> BoolArray:
        """Tell whether the motion of each body is prescribed (n,)."""
        return np.array([body.is_prescribed for body in self.all_bodies], dtype=bool)

    @property
    def mechanisms_by_name(self) -> dict[str, Mechanism]:
        """Mechanisms by their names, in order."""
        return {placed.name: placed.mechanism for placed in self.mechanisms}

    @cached_property
    def conditions(self) -> tuple[BoundaryCondition, ...]:
        """The condition on each piece of the boundary, in the order of surface numbers."""
        count, images = len(self.all_bodies), dict(self.domain.periodic)
        placed = []
        for number, piece in enumerate(self.domain.pieces):
            plane = piece.shape.plane
            make = self.boundary.get(piece.name, NoSlip)
            condition = make(count + number, piece.name, None if plane is None else plane.unit_normal)
            placed.append(condition.with_image(count + images[number]) if number in images else condition)
        return tuple(placed)

    @cached_property
    def walls(self) -> tuple[Wall, ...]:
        """The pieces of the boundary that repel bodies, with the velocities at which they slide."""
        return tuple(
            Wall(condition.surface, piece.name, piece.shape, condition.sliding)
            for condition, piece in zip(self.conditions, self.domain.pieces, strict=True)
            if condition.is_wall
        )

    @cached_property
    def detection(self) -> tuple[Selected[Detector], str]:
        """The detector, and who chose it for what reason."""
        if self.detector is not None:
            return self.detector, self._detector_why
        mesh = self.wet and bool(self.laws) and not self.domain.periodic
        part, why = choose_detector(self.shapes, self.domain.pieces, mesh, self.registry)
        return Selected(part, part.Options()), why
