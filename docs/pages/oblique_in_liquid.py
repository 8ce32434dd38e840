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
ANGLES = {"smooth": (0.1, 0.7, 3.0), "rough": (0.3, 0.7, 3.0)}
"""By surface: speed along the wall over that towards it, at the start."""


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
    """Figures of a run before the impact and after it, in the steps next to those within range; ``name`` is
    of the surfaces."""

    name: str
    run: Run

    @property
    def surface(self) -> Surface:
        """Roughness and friction."""
        return SURFACES[self.name]

    @cached_property
    def bodies(self) -> dict[str, np.ndarray]:
        """The table of bodies."""
        return self.run.history.bodies

    @cached_property
    def gap(self) -> np.ndarray:
        """Gaps between sphere and wall (s,) [cm]."""
        return self.bodies["y"] - RADIUS

    @cached_property
    def first(self) -> int:
        """The last row before range is reached."""
        return int(np.argmax(self.gap < RANGE)) - 1

    @cached_property
    def last(self) -> int:
        """The first row after it is left."""
        return self.first + 1 + int(np.argmax(self.gap[self.first + 1 :] > RANGE))

    @cached_property
    def slip(self) -> np.ndarray:
        """Velocities along the wall of the sphere's point next to it (s,) [cm/s]."""
        return np.asarray(self.bodies["vx"] + RADIUS * self.bodies["wz"])

    @cached_property
    def speed(self) -> float:
        """Speed towards the wall before [cm/s]."""
        return -float(self.bodies["vy"][self.first])

    @property
    def angle_in(self) -> float:
        """Effective angle of incidence, the slip over the speed towards the wall."""
        return float(self.slip[self.first]) / self.speed

    @property
    def angle_out(self) -> float:
        """Effective angle of rebound, the slip after over the speed towards the wall before."""
        return float(self.slip[self.last]) / self.speed

    @property
    def restitution(self) -> float:
        """Speed away from the wall over that towards it."""
        return float(self.bodies["vy"][self.last]) / self.speed

    @property
    def stokes(self) -> float:
        """St = (ρ_s + ρ_f/2) D v/(9μ), v towards the wall."""
        return (STEEL + 0.5 * LIQUID["density"]) * 2.0 * RADIUS * self.speed / (9.0 * LIQUID["viscosity"])

    @property
    def coefficient(self) -> float:
        """Friction with which a sphere without a liquid would lose as much slip, all the time slipping."""
        return (self.angle_in - self.angle_out) / (3.5 * (1.0 + self.restitution))

    @property
    def slipped(self) -> float:
        """Angle of rebound of a dry sphere that slips all the time: ψ - 7/2 (1 + e₀) μ."""
        return self.angle_in - slip_lost(self.surface)

    @property
    def slips(self) -> bool:
        """Whether the sphere slips all the time, by that formula."""
        return self.slipped > 0.0

    @property
    def created(self) -> float:
        """Energy created by contacts and scheme, of all that was put in [%]."""
        return 100.0 * float(self.run.summary["energy"]["created"])


def slip_lost(surface: Surface) -> float:
    """7/2 (1 + e₀) μ."""
    return 3.5 * (1.0 + DRY) * surface.friction


def page(work: Work) -> Page:
    """Angles of rebound beside those of the same impacts without a liquid."""

    def thrown(name: str, dry: str) -> list[Impact]:
        labels = [f"{name}_{angle}{dry}" for angle in ANGLES[name]]
        return [Impact(name, work.run(label, scene(label))) for label in labels]

    wet = {name: thrown(name, "") for name in SURFACES}
    dry = {name: thrown(name, "_dry") for name in SURFACES}
    pairs = [pair for name in SURFACES for pair in zip(wet[name], dry[name], strict=True)]
    text = ABOUT.format(
        figures=table(HEAD, [_row(*pair) for pair in pairs]),
        stokes=_between([one.stokes for one, _ in pairs], "{:.0f}"),
        **{name: _between([one.coefficient for one in wet[name] if one.slips], "{:.3f}") for name in SURFACES},
        restitution=_between([one.restitution for one, _ in pairs], "{:.2f}"),
        more=_between([_more(*pair) for pair in pairs if pair[0].slips], "{:.0%}"),
        created=f"{max(one.created for pair in pairs for one in pair):.2f}",
    )
    return Page("Oblique impacts in a liquid", text, {"": picture(wet, dry)})


HEAD = ("surfaces", "μ", "ψ in", "e", "ψ out", "ψ in, out without liquid", "ψ - 7/2 (1 + e₀) μ")
HEAD += ("effective μ", "created [%]", "CPU time [s]")


def _row(one: Impact, dry: Impact) -> tuple[str, ...]:
    return (
        one.name,
        f"{one.surface.friction:g}",
        f"{one.angle_in:.3f}",
        f"{one.restitution:.3f}",
        f"{one.angle_out:+.3f}",
        f"{dry.angle_in:.3f}, {dry.angle_out:+.3f}",
        f"{one.slipped:+.3f}" if one.slips else "sticks",
        f"{one.coefficient:.3f}",
        f"{one.created:.2f}",
        f"{one.run.cpu_seconds:.0f}",
    )


def _between(values: list[float], form: str) -> str:
    """Smallest and largest, or the one."""
    return " to ".join(dict.fromkeys(form.format(end(values)) for end in (min, max)))


def _more(wet: Impact, dry: Impact) -> float:
    """Share by which the slip changes more in the liquid than without it."""
    return (wet.angle_in - wet.angle_out) / (dry.angle_in - dry.angle_out) - 1.0


def picture(wet: dict[str, list[Impact]], dry: dict[str, list[Impact]]) -> Figure:
    """Angle of rebound over that of incidence; all angles, and the steep ones enlarged."""
    figure = Figure(figsize=(9.0, 4.2), dpi=120, layout="constrained")
    for axes, most, least in zip(figure.subplots(1, 2), (3.2, 0.9), (-0.4, -0.4), strict=True):
        for colour, (name, surface) in zip(("C0", "C3"), SURFACES.items(), strict=True):
            begin = slip_lost(surface)
            axes.plot([begin, most], [0.0, most - begin], color=colour, lw=1.0, label=f"{name}: slips, dry")
            for kind, found, fill in (("in liquid", wet, colour), ("without liquid", dry, "none")):
                angles = zip(*((one.angle_in, one.angle_out) for one in found[name]), strict=True)
                axes.plot(*angles, "o", color=colour, mfc=fill, ms=6.0, label=f"{name}: {kind}")
        axes.axhline(0.0, color="0.7", lw=0.8)
        axes.set(xlim=(0.0, most), ylim=(least, most), xlabel="ψ in", ylabel="ψ out")
    figure.axes[0].legend(fontsize=8)
    return figure


ABOUT = """A steel sphere of 12.7 mm (density 7.78) hits a wall at an angle in water with 37 % of glycerol (density
1.091, viscosity .03 g/(cm s)), as in the measurements of Joseph and Hunt, J. Fluid Mech. 510 (2004) 71,
doi:10.1017/S002211200400919X. Here spheres are thrown from a gap of one radius R in liquid at rest, at 20 cm/s
towards the wall, and turn freely. There is no gravity. The Stokes number (ρ_s + ρ_f/2) D v/(9μ), v towards the wall
before the impact, is {stokes}.

Sphere, liquid and the friction of .02 of smooth steel in it are those with which Rettinger and Rüde repeated the
measurements (arXiv:2003.01490; as in the inputs of waLBerla, `inputObliqueWetCollision.dat`). The two pairs of
surfaces:

* smooth: `roughness` 24 nm and `friction` .02;
* rough: `roughness` 272 nm and `friction` .11, as between dry ones.

The roughnesses and .11 are assumptions, of the size that bearings' balls and beads of steel have. The coefficients
are put in, so a run shows only whether film, restitution and friction in one contact give what they should. All runs
have one setting: law `normal`, range R/10, `epsilon = "auto"`, restitution e₀ = .97, cells of .4 R at the sphere that
grow by .4, and steps in which it moves R/12. `auto` counts the whole speed, so the law is stiffer in impacts that
slant more.

ψ is the velocity along the wall of the sphere's point next to it, over the speed of the centre towards the wall
before the impact. Both are read in the last step before range is reached, and the first after it is left.

{figures}

`e` is the speed away from the wall over that towards it, {restitution}. The effective μ is (ψ in - ψ out)/[7/2 (1 +
e)]: the friction of a dry sphere that loses as much slip while it slips all the time. Where a sphere sticks it is no
coefficient.

* **Smooth surfaces** hardly turn the sphere. Where they slip the effective μ is {smooth}. Joseph and Hunt found that
  liquid between smooth surfaces reduces friction drastically.
* **Rough surfaces** come near the line of dry ones, with an effective μ of {rough}; they found a friction comparable
  to that of dry impacts.
* **In the liquid** the slip changes by {more} more than without it, where spheres slip. The liquid drags along the
  wall during an impact, which lasts some milliseconds with this range. And the normal impulse turns the liquid that
  moves with the sphere too, by the added mass 7 % more than the sphere alone far from walls; friction and spin grow
  with it.
* **Spheres that stick** turn their slip back, ψ out < 0. Springs of 2/7 of the law's stiffness swing as fast along
  the wall as across it, and give back nearly all of ψ where the sphere does not slip at all, as at ψ in = .3. Elastic
  spheres are stiffer along their surfaces, by 2 (1 - ν)/(2 - ν) of the stiffness across (Mindlin, J. Appl. Mech. 16
  (1949) 259), and give back less; `tangential_stiffness` can be set.

Of the measured points no numbers were at hand, so nothing is compared with them one by one. The worst run creates
{created} % of the energy that was put in. Other cells, steps and liquids were not run. The warning that boundary
layers have less than two cells across holds for these runs."""
