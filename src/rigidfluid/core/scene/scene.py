"""A whole scene: all its tables, and those of its name and units."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationInfo, field_validator

from rigidfluid.core.scene.body_tables import BodyTable, MechanismTable
from rigidfluid.core.scene.boundary_tables import BoundaryTable
from rigidfluid.core.scene.contact_tables import ContactTable, InteractionTable
from rigidfluid.core.scene.domain_table import DomainTable
from rigidfluid.core.scene.exchange_tables import SinkTable, SourceTable
from rigidfluid.core.scene.fluid_table import FluidTable
from rigidfluid.core.scene.joint_tables import JointTable
from rigidfluid.core.scene.mesh_tables import MeshTable
from rigidfluid.core.scene.patterns import FILE_NAME, LETTERS
from rigidfluid.core.scene.run_tables import OutputTable, TimeTable
from rigidfluid.core.scene.scalar_table import ScalarTable
from rigidfluid.core.scene.swarm_tables import SwarmTable
from rigidfluid.core.scene.table import Table
from rigidfluid.core.scene.vectors import DIMENSION
from rigidfluid.described import Described, first_names

UnitName = Annotated[str, Field(pattern=LETTERS)]


class UnitsTable(Table):
    """Names of the units that the scene's numbers are in, for labels alone: no number depends on them."""

    length: UnitName = Field(description="Name of the unit of length, such as `cm`")
    time: UnitName = Field(description="Name of the unit of time, such as `s`")
    mass: UnitName = Field(description="Name of the unit of mass, such as `g`")


class SceneTable(Table):
    """Name, number of dimensions and random seed of the scene, and names of its units."""

    name: str = Field(pattern=FILE_NAME, description="Name of the scene; results go to `out/<name>` by default")
    dimension: Literal[2, 3] = Field(description="Number of space dimensions d")
    seed: int = Field(default=0, ge=0, description="Seed of all random numbers")
    units: UnitsTable | None = Field(
        default=None, description="Names of units, in labels of pictures and pages; `length`, `time`, … if not given"
    )


class Scene(Described, Table):
    """A whole scene, validated; `scene_from_dict` and `load_scene` are the ways to make one."""

    scene: SceneTable
    fluid: FluidTable
    scalar: ScalarTable | None = Field(default=None, description="A scalar that the fluid carries along")
    domain: DomainTable
    boundary: tuple[Annotated[BoundaryTable, Field(discriminator="type")], ...] = Field(
        default=(),
        description="Conditions on surfaces of the domain; a later entry overrides an earlier one, unnamed surfaces "
        "are walls",
    )
    body: tuple[BodyTable, ...] = ()
    swarm: tuple[SwarmTable, ...] = ()
    source: tuple[SourceTable, ...] = ()
    sink: tuple[SinkTable, ...] = ()
    mechanism: tuple[MechanismTable, ...] = ()
    joint: tuple[JointTable, ...] = ()
    contact: ContactTable = ContactTable()
    interaction: tuple[InteractionTable, ...] = ()
    mesh: MeshTable | None = Field(default=None, description="The mesh; needed by backends with a mesh")
    time: TimeTable
    output: OutputTable

    @field_validator("scene")
    @classmethod
    def _tell_dimension(cls, table: SceneTable, info: ValidationInfo) -> SceneTable:
        """Vectors of the tables below need it."""
        if info.context is not None:
            info.context[DIMENSION] = table.dimension
        return table

    @field_validator("body")
    @classmethod
    def _name_bodies(cls, bodies: tuple[BodyTable, ...]) -> tuple[BodyTable, ...]:
        return tuple(body.model_copy(update={"name": body.name or f"body{i}"}) for i, body in enumerate(bodies))

    @field_validator("mechanism")
    @classmethod
    def _name_mechanisms(cls, tables: tuple[MechanismTable, ...]) -> tuple[MechanismTable, ...]:
        return tuple(one.model_copy(update={"name": one.name or f"mechanism{i}"}) for i, one in enumerate(tables))

    @field_validator("joint")
    @classmethod
    def _name_joints(cls, tables: tuple[JointTable, ...]) -> tuple[JointTable, ...]:
        return tuple(one.model_copy(update={"name": one.name or f"joint{i}"}) for i, one in enumerate(tables))

    @property
    def name(self) -> str:
        """Name of the scene."""
        return self.scene.name

    @property
    def dimension(self) -> int:
        """Number of space dimensions."""
        return self.scene.dimension

    def _facts(self) -> Mapping[str, object]:
        laws = [self.contact.law] if self.contact.law else []
        return {
            "name": self.name,
            "dimension": self.dimension,
            "domain": self.domain.type,
            "fluid": self.fluid.backend,
            "bodies": first_names([body.name for body in self.body]),
            "mechanisms": first_names([one.name for one in self.mechanism]),
            "joints": len(self.joint) or None,
            "laws": first_names(laws + [one.law for one in self.interaction]),
            "time": f"to {self.time.end:g} in steps of {self.time.step:g}",
        }

    def to_dict(self) -> dict[str, Any]:
        """The tables again, in values that TOML and JSON can hold; `scene_from_dict` reads them back to an equal
        scene."""
        # Without keys that came later a scene is the same as before there were such, and its checkpoints go on.
        left_out: dict[str, Any] = {
            name: True
            for name in ("interaction", "mechanism", "joint", "swarm", "source", "sink")
            if not getattr(self, name)
        }
        if self.fluid.initial == "rest":
            left_out["fluid"] = {"initial"}
        if self.mesh is not None:
            defaults = {name: MeshTable.model_fields[name].default for name in ("refine", "mesher_timeout", "field")}
            left_out["mesh"] = {name for name, value in defaults.items() if getattr(self.mesh, name) == value}
        return self.model_dump(mode="json", exclude_none=True, exclude=left_out)
