"""Tables of a scene file, one model per table, and how a file becomes a `Scene`.

The description of each key ends with its unit in brackets where it has one; the scene reference is made from it. Units
are free but must be consistent; ``d`` is the dimension.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
)

from rigidfluid.core.scene.table_type import TableType
from rigidfluid.core.scene.vectors import (
    DIMENSION,
    Angular,
    Formula,
    Formulas,
    NotNegative,
    NotNegativeAngular,
    Vector,
)
from rigidfluid.described import Described, first_names
from rigidfluid.errors import SceneError
from rigidfluid.regular_file import MOST_TEXT, require_regular

PRINTABLE = r"^[^\x00-\x1f\x7f]*$"
"""Pattern of names: no control characters, which would break the tables and plots that names stand in."""

Positive = Annotated[float, Field(gt=0)]
Freedom = Literal["x", "y", "z", "rotation", "rx", "ry", "rz"]
# How bodies and mechanisms start, in their keys alike.
InitialPosition = Annotated[Vector, Field(description="Initial position of the centre of mass [length]")]
InitialAngle = Annotated[float | None, Field(description="Initial angle, counter-clockwise; only in 2D [rad]")]
InitialOrientation = Annotated[
    tuple[float, float, float, float] | None,
    Field(description="Initial orientation, a quaternion, scalar first; 3D only; normalised when read [1]"),
]
InitialVelocity = Annotated[Vector | None, Field(description="Initial velocity; zero if not given [length/time]")]
InitialAngularVelocity = Annotated[
    Angular | None,
    Field(description="Initial angular velocity; a number in 2D; zero if not given [rad/time]"),
]
AUTO = "auto"
"""Stands in a file for a number that is computed when the scene is loaded."""
SizeBody = Annotated[
    float, Field(gt=0), WithJsonSchema({"anyOf": [{"exclusiveMinimum": 0, "type": "number"}, {"const": AUTO}]})
]


class _Table(BaseModel, metaclass=TableType):
    """A table whose keys are all given here."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, defer_build=True)


class _OpenTable(_Table):
    """A table that also holds the keys of the part it names; `rigidfluid.core.case` validates those."""

    model_config = ConfigDict(extra="allow")

    @property
    def options(self) -> dict[str, Any]:
        """The keys that belong to the part."""
        return dict(self.model_extra or {})


UnitName = Annotated[str, Field(pattern="^[A-Za-zµμ]+$")]


class UnitsTable(_Table):
    """Names of the units that the scene's numbers are in, for labels alone: no number depends on them."""

    length: UnitName = Field(description="Name of the unit of length, such as `cm`")
    time: UnitName = Field(description="Name of the unit of time, such as `s`")
    mass: UnitName = Field(description="Name of the unit of mass, such as `g`")


class SceneTable(_Table):
    """Name, number of dimensions and random seed of the scene, and names of its units."""

    name: str = Field(pattern=r"^[\w.-]*\w$", description="Name of the scene; results go to `out/<name>` by default")
    dimension: Literal[2, 3] = Field(description="Number of space dimensions d")
    seed: int = Field(default=0, ge=0, description="Seed of all random numbers")
    units: UnitsTable | None = Field(
        default=None, description="Names of units, in labels of pictures and pages; `length`, `time`, … if not given"
    )


class FluidTable(_OpenTable):
    """The fluid, and the backend that computes it."""

    backend: str = Field(default="scikit-fem", description="Name of a fluid backend; `dry` leaves the fluid out")
    model: Literal["navier-stokes", "stokes"] = Field(
        default="navier-stokes", description="Equations of the fluid; `stokes` leaves out its inertia"
    )
    density: Positive | None = Field(
        default=None, description="Density of the fluid; needed by backends with a mesh, else 0 [mass/length^d]"
    )
    viscosity: Positive | None = Field(
        default=None, description="Dynamic viscosity; needed by backends with a mesh [mass·length^(2-d)/time]"
    )
    gravity: Vector | None = Field(default=None, description="Gravity; zero if not given [length/time²]")
    force: Formulas | None = Field(
        default=None, description="Expressions of a force on the fluid alone; none if not given [force/volume]"
    )
    initial: Literal["rest", "steady"] | Formulas = Field(
        default="rest",
        description="Flow at the start: `rest`, except for what moving bodies set in motion, `steady` past bodies that "
        "keep their velocities, or expressions of its velocity [length/time]",
    )


class WindowTable(_Table):
    """The meshed part of a long domain, which moves with a body.

    Its rear end is open. Its front end has the condition of the domain's end there: at rest for a wall.
    """

    follow: str = Field(description="Name of the body")
    direction: Literal["x", "y", "z", "-x", "-y", "-z"] = Field(
        description="Direction in which the body moves; the window never moves back"
    )
    ahead: Positive = Field(description="Distance from the body's centre to its front end at the start [length]")
    behind: Positive = Field(description="Distance from the body's centre to its rear end at the start [length]")


class DomainTable(_OpenTable):
    """The region that fluid and bodies share."""

    type: str = Field(default="box", description="Name of a domain")
    window: WindowTable | None = Field(default=None, description="The part that is meshed; all if not given")


class TimeFileTable(_Table):
    """A table over time in a text file; it is read when the scene is loaded, and kept with the scene."""

    file: str = Field(description="Lines of `time, value`; lines that start with # are skipped")


class StrokeTable(_Table):
    """A length or an angle as a function of time: either `piecewise` or `smooth` gives its rows [time, value]."""

    piecewise: tuple[tuple[float, float], ...] | TimeFileTable | None = Field(
        default=None,
        description="Rows [time, value] from time 0 on, linear between them; or a table with a `file` of such rows",
    )
    smooth: tuple[tuple[float, float], ...] | TimeFileTable | None = Field(
        default=None,
        description="The same, joined by a monotone cubic: its rate is continuous, and zero where the value turns back",
    )
    period: Positive | None = Field(
        default=None,
        description="Time after which it repeats; the value is constant after the last row; time of the last row if "
        "not given [time]",
    )
    repeat: bool = Field(default=True, description="Whether it repeats; else the last value is held")


class _BoundaryTable(_Table):
    """A condition on a surface of the domain, or on all of them."""

    on: str = Field(description="Name of a surface of the domain, or `all`")
    type: str


class VaryingTable(_BoundaryTable):
    """A condition with values that may change in time."""

    over_time: tuple[tuple[float, float], ...] | TimeFileTable | None = Field(
        default=None,
        description="Factor of the velocity or pressure in rows [time, factor], linear between them, from 0 to "
        "`time.end`; or a table with a `file` of such rows",
    )
    ramp: Positive | None = Field(
        default=None, description="Time in which the velocity or pressure rises smoothly from zero [time]"
    )


class WallTable(_BoundaryTable):
    """No slip; the only type that repels bodies. A wall may move along itself."""

    type: Literal["wall"] = Field(description="The condition")
    velocity: Vector | None = Field(
        default=None,
        description="Velocity of a wall along itself, in numbers; expressions need type = 'velocity' [length/time]",
    )
    angular_velocity: Angular | None = Field(
        default=None, description="Angular velocity of a wall that rotates along itself; a number in 2D [rad/time]"
    )
    centre: Vector | None = Field(
        default=None, description="Point that such a wall rotates about; the origin if not given [length]"
    )


class VelocityTable(VaryingTable):
    """A prescribed velocity, given directly or by its `flux`.

    Values may be expressions of x, y, z and t in quotes, with `pi`, `+ - * / **`, comparisons, and the functions `sin`,
    `cos`, `tan`, `tanh`, `exp`, `log`, `sqrt`, `abs`, `min`, `max` and `where(condition, then, otherwise)`.
    """

    type: Literal["velocity"] = Field(description="The condition")
    velocity: Formulas | None = Field(default=None, description="Velocity, at the peak of the `profile` [length/time]")
    flux: Formula | None = Field(
        default=None,
        description="Instead of `velocity`, the inflow through the surface, negative for outflow: a number or an "
        "expression of t only [length^d/time]",
    )
    profile: Literal["uniform", "parabolic", "poiseuille", "couette"] = Field(
        default="uniform",
        description="Distribution of the velocity over the surface; `parabolic` is zero on its edges; `poiseuille` is "
        "the developed flow through a segment, rectangle or disk; `couette` rises from one end of a segment to the "
        "other",
    )


class PressureTable(VaryingTable):
    """An open end with a prescribed pressure, a number or an expression; fluid passes it at right angles."""

    type: Literal["pressure"] = Field(description="The condition")
    pressure: Formula = Field(description="Pressure on the surface [force/length^(d-1)]")


class SlipTable(_BoundaryTable):
    """No fluid passes; it flows along the surface without traction."""

    type: Annotated[Literal["slip", "symmetry"], AfterValidator(lambda value: "slip")] = Field(
        description="The condition; `symmetry` is another name of it"
    )


class PeriodicTable(_BoundaryTable):
    """On two opposite surfaces: what flows out through one comes in through the other."""

    type: Literal["periodic"] = Field(description="The condition")
    pressure_drop: float | None = Field(
        default=None, description="Excess of the pressure here over that on the opposite surface [force/length^(d-1)]"
    )


BoundaryTable = WallTable | VelocityTable | PressureTable | SlipTable | PeriodicTable


class PrescribedTable(_Table):
    """A motion that the fluid cannot change: velocity(t) = velocity + 2π·frequency·amplitude·cos(2π·frequency·t)."""

    velocity: Vector | None = Field(default=None, description="Constant velocity; zero if not given [length/time]")
    angular_velocity: Angular | None = Field(
        default=None, description="Constant angular velocity; a number in 2D; zero if not given [rad/time]"
    )
    amplitude: Vector | None = Field(default=None, description="Amplitude of a sinusoidal displacement [length]")
    frequency: Positive | None = Field(default=None, description="Frequency of the sinusoidal displacement [1/time]")


class SpringTable(_Table):
    """Springs and dampers between a body and the ground, along the axes: force = -stiffness · displacement - damping
    · velocity, and likewise for rotations."""

    stiffness: NotNegative | None = Field(
        default=None, description="Along x, y (and z); zero if not given [force/length]"
    )
    damping: NotNegative | None = Field(
        default=None, description="Along x, y, z; zero if not given [force·time/length]"
    )
    angular_stiffness: NotNegativeAngular | None = Field(
        default=None, description="A number in 2D, about x, y and z in 3D; zero if not given [force·length/rad]"
    )
    angular_damping: NotNegativeAngular | None = Field(
        default=None, description="A number in 2D, about x, y and z in 3D; zero if not given [force·length·time/rad]"
    )
    rest: Vector | None = Field(
        default=None,
        description="Position of the centre of mass at which springs exert no force; that at the start if not given; "
        "rotational springs rest at the initial orientation [length]",
    )


class BodyTable(_OpenTable):
    """One rigid body."""

    name: str = Field(
        default="",
        pattern=PRINTABLE,
        description="Name in the results, without control characters; `body0`, `body1`, … if not given",
    )
    type: str = Field(description="Name of a body type")
    density: Positive = Field(description="Density of the body [mass/length^d]")
    position: InitialPosition
    angle: InitialAngle = None
    orientation: InitialOrientation = None
    velocity: InitialVelocity = None
    angular_velocity: InitialAngularVelocity = None
    part_of: str | None = Field(
        default=None, description="Name of the articulated body it is a part of; parts of one body do not repel"
    )
    fixed: bool = Field(default=False, description="Whether the body is held in place")
    prescribed: PrescribedTable | None = Field(default=None, description="A motion that the fluid cannot change")
    free: tuple[Freedom, ...] | None = Field(
        default=None,
        description="Directions in which it may move; the others are held. Of `x`, `y`, `z`, in 2D `rotation`, in 3D "
        "rotations `rx`, `ry`, `rz` about the axes; all if not given",
    )
    spring: SpringTable | None = Field(default=None, description="Springs and dampers between it and the ground")


class MechanismTable(_OpenTable):
    """Several bodies that move as one; the keys of its type define them."""

    name: str = Field(
        default="",
        pattern=r"^[^\x00-\x1f\x7f]*$",
        description="Name in the results, before those of its components; `mechanism0`, … if not given",
    )
    type: str = Field(description="Name of a mechanism")
    position: InitialPosition
    angle: InitialAngle = None
    orientation: InitialOrientation = None
    velocity: InitialVelocity = None
    angular_velocity: InitialAngularVelocity = None


class JointTable(_OpenTable):
    """A joint between two bodies, or of one with the ground."""

    name: str = Field(
        default="", pattern=PRINTABLE, description="Name in the results; `joint0`, `joint1`, … if not given"
    )
    type: str = Field(description="Name of a joint type; `rod` has no keys of its own: the bodies move as one")
    between: Annotated[tuple[str, ...], Field(min_length=1, max_length=2)] = Field(
        description="Names of two bodies or components, or of one that is joined to the ground"
    )
    at: Vector | None = Field(
        default=None,
        description="Point of the joint at the start; for a rod and a slider the first body's centre of mass if not "
        "given [length]",
    )


_RESTITUTION = Field(
    default=None,
    gt=0,
    le=1,
    description="Ratio of the speeds after and before a dry head-on impact, 1 if not given [1]",
)
_RESTITUTION_STOKES = Field(
    default=None,
    gt=0,
    description="β: an impact, including the film that the mesh resolves, ends with `restitution` · exp(-β/St) of its "
    "speed, where St is its Stokes number; 35 for balls in a liquid [1]",
)


class ContactTable(_OpenTable):
    """Detection and time stepping of contacts, and a force law for all of them; `[[interaction]]` adds more laws."""

    detector: str = Field(
        default="auto", description="Name of a detector; `auto` takes the cheapest that is exact for the scene"
    )
    law: str | None = Field(default=None, description="Name of a force law for all contacts; none if not given")
    range: Positive | None = Field(default=None, description="Gap above which the law is zero [length]")
    smallest_gap: Positive | None = Field(
        default=None, description="Gap at which the expected impact is to end; range/4 if not given [length]"
    )
    restitution: float | None = _RESTITUTION
    restitution_stokes: float | None = _RESTITUTION_STOKES
    impact_speed: float | None = Field(
        default=None,
        ge=0,
        description="Impact speed of free bodies; estimated from gravity, drag and the box if not given [length/time]",
    )
    stepping: Literal["substeps", "implicit"] = Field(
        default="substeps",
        description="Integration of bodies in contacts: by `substeps`, or by `implicit` steps that conserve energy",
    )
    substeps: int | None = Field(
        default=None,
        ge=1,
        description="Number of substeps of contacts in each step; as many as they need if not given [1]",
    )


class InteractionTable(_OpenTable):
    """A force law, and the contacts that it acts in; forces of several tables, and of `[contact]`, add up."""

    law: str = Field(description="Name of a force law")
    range: Positive = Field(description="Gap above which the law is zero [length]")
    smallest_gap: Positive | None = Field(
        default=None, description="Gap at which the expected impact is to end; range/4 if not given [length]"
    )
    restitution: float | None = _RESTITUTION
    restitution_stokes: float | None = _RESTITUTION_STOKES
    between: Literal["all", "walls", "pairs"] = Field(
        default="all", description="Contacts at `walls`, of `pairs` of bodies, or both"
    )
    names: Annotated[tuple[str, ...], Field(min_length=1, max_length=2)] | None = Field(
        default=None, description="Names of bodies or walls: one for all its contacts, two for those between them"
    )


class WakeTable(_Table):
    """Finer cells behind free and prescribed bodies, from x - time·velocity to x and as wide as the body.

    They exist from the second mesh on. A flow past a fixed body needs `[[mesh.refine]]`, or a `[[mesh.field]]` that
    follows the flow.
    """

    time: Positive = Field(
        description="Time for which the wake behind a body stays fine, at the body's present velocity [time]"
    )
    size: Positive = Field(description="Edge length in the wake [length]")


class RefineTable(_Table):
    """A box with finer cells, which grow outside as they do away from a body."""

    lower: Vector = Field(description="Corner of the box with the smallest coordinates [length]")
    upper: Vector = Field(description="Corner of the box with the largest coordinates [length]")
    size: Positive = Field(description="Edge length in the box [length]")


class SizeFieldTable(_OpenTable):
    """A size field, which sets the cell size by position and flow; of several the smallest size counts."""

    type: str = Field(description="Name of a size field")


class MeshTable(_Table):
    """Resolution of the mesh, and when it is regenerated."""

    size: Positive = Field(description="Edge length far from the bodies [length]")
    size_body: SizeBody = Field(
        description="Edge length on the bodies; `auto`: half of the thinnest boundary layer d/√Re at the expected "
        "speeds, at most d/10, where d is the diameter of a ball of the body's volume [length]"
    )
    size_wall: Positive | None = Field(
        default=None,
        description="Edge length on walls that are not flat; if not given, a quarter of the smallest radius of "
        "curvature, where it is known [length]",
    )
    growth: float = Field(default=0.2, gt=0, le=10, description="Growth of the edge length per distance to a body [1]")
    cells_per_gap: int = Field(
        default=2, ge=1, le=100, description="Cells across the gap between surfaces near contact [1]"
    )
    quality: float = Field(default=0.25, gt=0, lt=1, description="Cell quality below which the mesh is regenerated [1]")
    refinements: int = Field(
        default=5, ge=0, le=20, description="Number of times that a facet may be halved in a gap [1]"
    )
    order: Literal[1, 2] = Field(
        default=2, description="1: cells with straight edges; 2: curved along bodies and curved walls [1]"
    )
    inserter: Literal["cad", "fill", "level_set"] | None = Field(
        default=None,
        description="How the first mesh is made. cad: Netgen meshes the domain minus the bodies; fill: Netgen fills "
        "the space between the facets of both, which are kept; level_set: MMG cuts the bodies out of a mesh of the "
        "domain, for comparison. If not given, fill if a shape is made of facets, else cad",
    )
    mesher_timeout: Positive = Field(
        default=600.0, description="Time after which the mesher that fills between facets is stopped [s]"
    )
    remesh_every: Positive | None = Field(
        default=None, description="Age of a mesh at which it is always regenerated; never if not given [time]"
    )
    wake: WakeTable | None = Field(default=None, description="Finer cells behind moving bodies")
    refine: tuple[RefineTable, ...] = Field(default=(), description="Boxes with finer cells")
    field: tuple[SizeFieldTable, ...] = Field(default=(), description="Size fields")


class TimeTable(_Table):
    """End, steps and tolerance of the simulation."""

    end: Positive = Field(description="Time at which the simulation ends [time]")
    step: Positive = Field(description="Size of a step [time]")
    tolerance: Annotated[float, Field(ge=1e-6, le=0.1)] | None = Field(
        default=None,
        description="Allowed local error of a step, relative and per unit time; `step` is then the longest step. If "
        "not given, only steps that cannot be taken whole are shorter than `step` [1]",
    )
    shortest: Positive = Field(
        default_factory=lambda table: table["step"] / 1024,
        description="Size below which a step is not shortened further; step/1024 if not given [time]",
    )


class OutputTable(_Table):
    """Interval of fields and checkpoints, and points that record the flow."""

    every: Positive = Field(description="Time between two written fields and checkpoints [time]")
    probes: tuple[Vector, ...] = Field(default=(), description="Points that record velocity and pressure [length]")


class Scene(Described, _Table):
    """A whole scene, validated; `scene_from_dict` and `load_scene` are the ways to make one."""

    scene: SceneTable
    fluid: FluidTable
    domain: DomainTable
    boundary: tuple[Annotated[BoundaryTable, Field(discriminator="type")], ...] = Field(
        default=(),
        description="Conditions on surfaces of the domain; a later entry overrides an earlier one, unnamed surfaces "
        "are walls",
    )
    body: tuple[BodyTable, ...] = ()
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
            name: True for name in ("interaction", "mechanism", "joint") if not getattr(self, name)
        }
        if self.fluid.initial == "rest":
            left_out["fluid"] = {"initial"}
        if self.mesh is not None:
            defaults = {name: MeshTable.model_fields[name].default for name in ("refine", "mesher_timeout", "field")}
            left_out["mesh"] = {name for name, value in defaults.items() if getattr(self.mesh, name) == value}
        return self.model_dump(mode="json", exclude_none=True, exclude=left_out)


def read_toml(path: Path, kind: str = "scene") -> dict[str, Any]:
    """Read the tables of a TOML file; ``kind`` says in messages what file it should be.

    The path under a key ``file`` is relative to the file it stands in.
    """
    require_regular(path, str(path), MOST_TEXT, f"a readable {kind} file")
    try:
        return _resolve_files(tomllib.loads(path.read_text(encoding="utf-8")), path.resolve().parent)
    except OSError as error:
        raise SceneError(str(path), error.strerror, f"a readable {kind} file", "Check path and permissions.") from None
    except (ValueError, RecursionError) as error:
        raise SceneError(str(path), f"invalid TOML ({error})", "a TOML file in UTF-8", "Mend the file there.") from None


def _resolve_files(table: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A table with every ``file`` in it, and in the tables within, as an absolute path, seen from a folder."""
    found = {key: _resolve_each_file(inner, folder) for key, inner in table.items()}
    return found | {"file": str(folder / found["file"])} if isinstance(found.get("file"), str) else found


def _resolve_each_file(value: Any, folder: Path) -> Any:
    if isinstance(value, list):
        return [_resolve_each_file(inner, folder) for inner in value]
    return _resolve_files(value, folder) if isinstance(value, dict) else value
