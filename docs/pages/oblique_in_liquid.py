"""Steel spheres hit a wall obliquely in a liquid: the angle of rebound over that of incidence, for two surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

import rigidfluid
from rigidfluid.core.scene.scene import Scene

RADIUS, STEEL, DRY, SPEED = 0.635, 7.78, 0.97, 20.0
"""Radius [cm], density [g/cm³], dry restitution and speed towards the wall at the start [cm/s]."""
LIQUID = {"density": 1.091, "viscosity": 0.03}
"""Glycerol and water, 37 % [g, cm, s]."""
RANGE, END = 0.1 * RADIUS, 0.045
"""Range of the law [cm] and end of the runs [s]."""


@dataclass(frozen=True)
class Surface:
    """Sphere and wall: their ``roughness`` [cm] and coefficient of ``friction`` in the liquid."""

    roughness: float
    friction: float


SURFACES = {"smooth": Surface(24e-7, 0.02), "rough": Surface(272e-7, 0.11)}
ANGLES = (0.1, 0.3, 0.7, 1.4, 3.0)
"""Speed along the wall over that towards it, at the start."""


def scene(label: str) -> Scene:
    """The sphere a radius from the wall; ``label`` names surface and angle, and ``_dry`` a run without a liquid."""
    name, angle, *dry = label.split("_")
    surface, ratio = SURFACES[name], float(angle)
    speed = SPEED * np.hypot(1.0, ratio)
    contact = {"law": "normal", "range": RANGE, "epsilon": "auto", "restitution": DRY}
    contact |= {"friction": surface.friction}
    wet = {
        "fluid": LIQUID,
        "boundary": [{"on": side, "type": "slip"} for side in ("left", "right", "front", "back")],
        "mesh": {"size": 5.0 * RADIUS, "size_body": 0.4 * RADIUS, "growth": 0.4},
    }
    return rigidfluid.scene_from_dict(
        {
            "scene": {"name": "oblique", "dimension": 3, "units": {"length": "cm", "time": "s", "mass": "g"}},
            "domain": {
                "lower": [-8.0 * RADIUS, 0.0, -5.0 * RADIUS],
                "upper": [8.0 * RADIUS, 10.0 * RADIUS, 5.0 * RADIUS],
            },
            "body": [
                {
                    "name": "sphere",
                    "type": "sphere",
                    "radius": RADIUS,
                    "density": STEEL,
                    "position": [-ratio * RADIUS, 2.0 * RADIUS, 0.0],
                    "velocity": [SPEED * ratio, -SPEED, 0.0],
                }
            ],
            "contact": contact | ({} if dry else {"roughness": surface.roughness}),
            "time": {"end": END, "step": float(f"{RADIUS / (12.0 * speed):.3g}")},
            "output": {"every": END},
            **({"fluid": {"backend": "dry"}} if dry else wet),
        }
    )


@dataclass(frozen=True)
class Impact:
    """Figures of a run at a gap of the law's range, before the impact and after it."""

    run: Run

    @cached_property
    def bodies(self) -> dict[str, np.ndarray]:
        """The table of bodies."""
        return self.run.history.bodies

    @cached_property
    def gap(self) -> np.ndarray:
        """Gaps between sphere and wall (s,) [cm]."""
        return self.bodies["y"] - RADIUS

    @cached_property
    def turn(self) -> int:
        """The row of the turn."""
        return int(np.argmax(self.bodies["vy"] > 0.0))

    def before(self, values: np.ndarray) -> float:
        """Values (s,) when range is reached."""
        return float(np.interp(-RANGE, -self.gap[: self.turn], values[: self.turn]))

    def after(self, values: np.ndarray) -> float:
        """Values (s,) when range is left."""
        return float(np.interp(RANGE, self.gap[self.turn :], values[self.turn :]))

    @cached_property
    def slip(self) -> np.ndarray:
        """Velocities along the wall of the sphere's point next to it (s,) [cm/s]."""
        return np.asarray(self.bodies["vx"] + RADIUS * self.bodies["wz"])

    @cached_property
    def speed(self) -> float:
        """Speed towards the wall before [cm/s]."""
        return -self.before(self.bodies["vy"])

    @property
    def angle_in(self) -> float:
        """Effective angle of incidence, the slip over the speed towards the wall."""
        return self.before(self.slip) / self.speed

    @property
    def angle_out(self) -> float:
        """Effective angle of rebound, the slip after over the speed towards the wall before."""
        return self.after(self.slip) / self.speed

    @property
    def restitution(self) -> float:
        """Speed away from the wall over that towards it."""
        return self.after(self.bodies["vy"]) / self.speed

    @property
    def stokes(self) -> float:
        """St = (ρ_s + ρ_f/2) D v/(9μ), v towards the wall."""
        return (STEEL + 0.5 * LIQUID["density"]) * 2.0 * RADIUS * self.speed / (9.0 * LIQUID["viscosity"])

    @property
    def coefficient(self) -> float:
        """Change of the velocity along the wall over that across it: the friction of an impact that slips."""
        velocity = self.bodies["vx"]
        return (self.before(velocity) - self.after(velocity)) / (self.speed * (1.0 + self.restitution))

    @property
    def created(self) -> float:
        """Energy created by contacts and scheme, of all that was put in [%]."""
        return 100.0 * float(self.run.summary["energy"]["created"])


def page(work: Work) -> Page:
    """Angles of rebound beside those of the same impacts without a liquid."""

    def thrown(name: str, angle: float, dry: str) -> Impact:
        label = f"{name}_{angle}{dry}"
        return Impact(work.run(label, scene(label)))

    found = {
        (name, dry): {angle: thrown(name, angle, dry) for angle in ANGLES} for name in SURFACES for dry in ("", "_dry")
    }
    wet = {name: found[name, ""] for name in SURFACES}
    dry = {name: found[name, "_dry"] for name in SURFACES}
    slipping = {
        name: [one for one, dry_one in zip(wet[name].values(), dry[name].values(), strict=True) if slips(name, dry_one)]
        for name in SURFACES
    }
    text = ABOUT.format(
        figures=table(HEAD, [_row(name, wet[name][angle], dry[name][angle]) for name in SURFACES for angle in ANGLES]),
        stokes=" to ".join(f"{end([one.stokes for row in wet.values() for one in row.values()]):.0f}" for end in (min, max)),
        smooth=_between([one.coefficient for one in slipping["smooth"]]),
        rough=_between([one.coefficient for one in slipping["rough"]]),
        off=f"{max(_off(wet[name][angle], dry[name][angle]) for name in SURFACES for angle in ANGLES):.2f}",
        created=f"{max(one.created for row in found.values() for one in row.values()):.2f}",
    )
    return Page("Oblique impacts in a liquid", text, {"": picture(wet, dry)})


def slipped(angle: float, restitution: float, friction: float) -> float:
    """Angle of rebound of a dry sphere that slips all the time: ψ - 7/2 (1 + e) μ."""
    return angle - 3.5 * (1.0 + restitution) * friction


def slips(name: str, impact: Impact) -> bool:
    """Whether the sphere slips all the time, by that formula."""
    return slipped(impact.angle_in, DRY, SURFACES[name].friction) > 0.0


HEAD = ("surfaces", "μ", "ψ in", "e", "ψ out", "without liquid", "ψ - 7/2 (1 + .97) μ", "change along over across")
HEAD += ("created [%]", "CPU time [s]")


def _row(name: str, one: Impact, dry: Impact) -> tuple[str, ...]:
    friction, slip = SURFACES[name].friction, slips(name, one)
    return (
        name,
        f"{friction:g}",
        f"{one.angle_in:.3f}",
        f"{one.restitution:.3f}",
        f"{one.angle_out:+.3f}",
        f"{dry.angle_out:+.3f}",
        f"{slipped(one.angle_in, DRY, friction):+.3f}" if slip else "sticks",
        f"{one.coefficient:.3f}",
        f"{one.created:.2f}",
        f"{one.run.cpu_seconds:.0f}",
    )


def _between(values: list[float]) -> str:
    """Smallest and largest."""
    return f"{min(values):.3f} to {max(values):.3f}"


def _off(wet: Impact, dry: Impact) -> float:
    """Change of the angle of rebound by the liquid, less that of incidence."""
    return abs(wet.angle_out - dry.angle_out - wet.angle_in + dry.angle_in)


def picture(wet: dict[str, dict[float, Impact]], dry: dict[str, dict[float, Impact]]) -> Figure:
    """Angle of rebound over that of incidence; all angles, and the steep ones enlarged."""
    figure = Figure(figsize=(9.0, 4.2), dpi=120, layout="constrained")
    for axes, ends, low in zip(figure.subplots(1, 2), (3.2, 0.8), (-0.4, -0.3), strict=True):
        for colour, (name, surface) in zip(("C0", "C3"), SURFACES.items(), strict=True):
            begin = 3.5 * (1.0 + DRY) * surface.friction
            line = [slipped(angle, DRY, surface.friction) for angle in (begin, ends)]
            axes.plot([begin, ends], line, color=colour, lw=1.0, label=f"{name}: slips, dry")
            for kind, found, fill in (("in liquid", wet, colour), ("without liquid", dry, "none")):
                row = found[name].values()
                angles = [one.angle_in for one in row], [one.angle_out for one in row]
                axes.plot(*angles, "o", color=colour, mfc=fill, ms=6.0, label=f"{name}: {kind}")
        axes.axhline(0.0, color="0.7", lw=0.8)
        axes.set(xlim=(0.0, ends), ylim=(low, ends), xlabel="ψ in", ylabel="ψ out")
    figure.axes[0].legend(fontsize=8)
    return figure
