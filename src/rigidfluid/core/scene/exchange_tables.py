"""Tables of sources and sinks: bodies that enter and leave while a scene runs."""

from __future__ import annotations

from pydantic import Field

from rigidfluid.core.scene.numbered_names import is_numbered
from rigidfluid.core.scene.swarm_tables import MOST_BODIES, NotNegative, RandomBodies, RegionTable, SwarmTable
from rigidfluid.core.scene.table import Positive, Table


class SourceTable(RandomBodies):
    """Bodies that enter one by one while the scene runs, the same ones for the same `scene.seed`.

    Either `times` or `every` is given. A body for which its region has no room waits until the next step.
    [How to let bodies enter and leave](howto/enter-and-leave.md) has examples.
    """

    times: tuple[NotNegative, ...] | None = Field(
        default=None, min_length=1, description="Times at which a body enters, in order [time]"
    )
    every: Positive | None = Field(default=None, description="Interval at which a body enters [time]")
    start: NotNegative = Field(default=0.0, description="Time of the first one with `every` [time]")
    number: int | None = Field(
        default=None, ge=1, le=MOST_BODIES, description="Greatest number of bodies with `every`; no end if not given"
    )

    def due(self, time: float) -> int:
        """Number of bodies that are to have entered by a ``time``."""
        slack = 1e-9 * time
        if self.times is not None:
            return sum(entry <= time + slack for entry in self.times)
        assert self.every is not None
        if time + slack < self.start:
            return 0
        count = 1 + int((time + slack - self.start) / self.every)
        return count if self.number is None else min(count, self.number)

    def gives(self, name: str) -> bool:
        """Tell whether one of its bodies may have this name."""
        return is_numbered(name, self.name)

    def swarm(self, number: int) -> SwarmTable:
        """The body of that number as a swarm of one."""
        shared = {name: getattr(self, name) for name in RandomBodies.model_fields}
        return SwarmTable.model_construct(**{**shared, "name": f"{self.name}{number}"}, number=1)


class SinkTable(Table):
    """Bodies leave in a region, near a surface, by a rule, or where a rule holds in such a place.

    A sink has a `region` or `on`, a rule `when`, or both. Bodies stay that are prescribed or fixed, that a joint, a
    spring to the ground or held directions hold, or that are components of a mechanism, and so does the last one of
    all.

    A rule is an expression as those of a [velocity](#boundary-type-velocity), of these names: `x`, `y`, `z`, the centre
    of mass, between periodic surfaces that of its image in the domain; `vx`, `vy`, `vz` and `speed`; `w` in 2D, `wx`,
    `wy`, `wz` in 3D, the angular velocity; `age`, the time since the body entered or the run started; `t`, the time;
    `radius`, of the smallest ball around the centre of mass that contains the body; `volume` and `mass`.
    """

    region: RegionTable | None = Field(
        default=None, description="Region; a body leaves when its centre of mass is inside"
    )
    on: str | None = Field(default=None, description="Name of a surface of the domain, as of an outlet")
    gap: Positive | None = Field(
        default=None,
        description="Distance of the body's bounding ball from `on` below which the body leaves; its bounding radius "
        "if not given [length]",
    )
    when: str | None = Field(
        default=None, description='Rule: a body leaves when its value is above 0, as `"age > 5 and speed < 0.01"`'
    )
