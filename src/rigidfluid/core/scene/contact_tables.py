"""Tables of a scene's contacts: their detection, and the force laws that act in them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from rigidfluid.core.scene.table import OpenTable, Positive

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
_ROUGHNESS = Field(
    default=None,
    description="Gap at which the film ends and surfaces touch: an impact is a dry one behind the film down to this "
    "gap, whether the mesh resolves it or not; at most `smallest_gap` [length]",
)
_FRICTION = Field(
    default=None,
    ge=0,
    description="Coefficient of friction μ: the largest ratio of tangential to normal force, 0 if not given [1]",
)
_TANGENTIAL_STIFFNESS = Field(
    default=None,
    description="Stiffness of springs along the surfaces, which hold static friction; 2/7 of the law's down to "
    "`smallest_gap` if not given, and no springs with `spring-dashpot` [force/length]",
)
_TANGENTIAL_DAMPING = Field(
    default=None,
    ge=0,
    description="Ratio of the dashpot's coefficient along the surfaces to that by `restitution`, 1 if not given [1]",
)
_ROLLING_FRICTION = Field(
    default=None,
    ge=0,
    description="Coefficient of rolling friction μ_r of balls, beside `friction`: the largest couple is μ_r R F_n, "
    "0 if not given [1]",
)
_TWISTING_FRICTION = Field(
    default=None,
    ge=0,
    description="Coefficient of twisting friction μ_o of balls, beside `friction`: the largest couple is μ_o R F_n, "
    "0 if not given [1]",
)


class ContactTable(OpenTable):
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
    roughness: Positive | None = _ROUGHNESS
    friction: float | None = _FRICTION
    tangential_stiffness: Positive | None = _TANGENTIAL_STIFFNESS
    tangential_damping: float | None = _TANGENTIAL_DAMPING
    rolling_friction: float | None = _ROLLING_FRICTION
    twisting_friction: float | None = _TWISTING_FRICTION
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


class InteractionTable(OpenTable):
    """A force law, and the contacts that it acts in; forces of several tables, and of `[contact]`, add up."""

    law: str = Field(description="Name of a force law")
    range: Positive = Field(description="Gap above which the law is zero [length]")
    smallest_gap: Positive | None = Field(
        default=None, description="Gap at which the expected impact is to end; range/4 if not given [length]"
    )
    restitution: float | None = _RESTITUTION
    restitution_stokes: float | None = _RESTITUTION_STOKES
    roughness: Positive | None = _ROUGHNESS
    friction: float | None = _FRICTION
    tangential_stiffness: Positive | None = _TANGENTIAL_STIFFNESS
    tangential_damping: float | None = _TANGENTIAL_DAMPING
    rolling_friction: float | None = _ROLLING_FRICTION
    twisting_friction: float | None = _TWISTING_FRICTION
    between: Literal["all", "walls", "pairs"] = Field(
        default="all", description="Contacts at `walls`, of `pairs` of bodies, or both"
    )
    names: Annotated[tuple[str, ...], Field(min_length=1, max_length=2)] | None = Field(
        default=None,
        description="Names of bodies or walls: one for all its contacts, two for those between them; `grain*` is any "
        "of `grain0`, `grain1` and so on of a swarm or a source",
    )
