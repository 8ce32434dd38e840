"""Text of a new scene, with a comment on each number."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from rigidfluid.start.wishes import Wishes

UNITS = {"cm": ("cm", "g", 1e-2, 1e-3), "m": ("m", "kg", 1.0, 1.0), "mm": ("mm", "mg", 1e-3, 1e-6)}
"""Units of length and mass, and what they are in m and kg."""

FLUIDS = {"water": (998.0, 1.00e-3), "oil": (910.0, 0.084), "glycerine": (1260.0, 1.41)}
"""Density [kg/m³] and viscosity [Pa·s] at 20 °C; the oil is that of olives."""

EARTH = 9.81
"""Its gravity [m/s²]."""

_OVER_FLUID = 1.25
"""Density of bodies over that of the fluid."""

_CELLS_ACROSS = {2: 12, 3: 6}
"""Cells across the box, far from the bodies."""


@dataclass(frozen=True, slots=True)
class Numbers:
    """Lengths and times that follow from what is asked for; ``None``: left to the program."""

    columns: int
    spacing: float
    radius: float
    height: float
    range: float
    end: float = 1.0
    step: float = 1e-3
    size_body: float | None = None
    refinements: int | None = None
    restitution_stokes: float | None = None

    @classmethod
    def in_box(cls, size: float, bodies: int, dimension: int) -> Self:
        """Lengths of so many bodies in a box that is ``size`` wide; they start in rows of ``columns``."""
        columns = ceil(bodies ** (1.0 / dimension) - 1e-9)
        rows = ceil(bodies / columns ** (dimension - 1))
        spacing = size / columns
        share, tall = {2: (16.0, 2.0), 3: (8.0, 1.5)}[dimension]
        radius = min(size / share, spacing / 4.0)
        size_body = None if dimension == 2 else radius / 3.0  # "auto" would be finer than a first look in 3D wants
        height = max(tall * size, (rows + 1) * spacing)
        return cls(columns, spacing, radius, height, 0.1 * radius, size_body=size_body)


def scene_text(wishes: Wishes, name: str, numbers: Numbers) -> str:
    """The scene as a TOML file."""
    length, mass, metre, kilogram = UNITS[wishes.units]
    wet = wishes.fluid in FLUIDS
    density, viscosity = FLUIDS.get(wishes.fluid, (1000.0, 0.0))
    per_volume = metre**3 / kilogram
    gravity = EARTH / metre if wishes.gravity is None else wishes.gravity
    upper = [wishes.width, numbers.height] if wishes.dimension == 2 else [wishes.width, wishes.width, numbers.height]
    down = [0.0] * (wishes.dimension - 1) + [-gravity]
    filled = f" of {wishes.fluid}" if wet else ", without a fluid"
    parts = [
        f"# {_bodies(wishes)} in a box{filled}. Units: {length}, {mass}, s.",
        f'[scene]\nname = "{name}"\ndimension = {wishes.dimension}\n'
        f'units = {{ length = "{length}", time = "s", mass = "{mass}" }}  # names alone: no number depends on them',
        "[fluid]\n"
        + (
            f"density = {density * per_volume:.4g}  # {mass}/{length}³, of {wishes.fluid}\n"
            f"viscosity = {viscosity * metre / kilogram:.4g}  # {mass}/({length}·s)\n"
            if wet
            else 'backend = "dry"  # no fluid\n'
        )
        + f"gravity = {_list(down)}  # {length}/s²",
        f'[domain]\ntype = "box"\nlower = {_list([0.0] * wishes.dimension)}  # {length}\nupper = {_list(upper)}',
        '[[boundary]]\non = "all"\ntype = "wall"',
        *_body_tables(wishes, numbers, _OVER_FLUID * density * per_volume),
        _contact(wishes, numbers),
        *([_mesh(wishes, numbers)] if wet else []),
        f"[time]\nend = {numbers.end:.3g}  # s\nstep = {numbers.step:.3g}",
        f"[output]\nevery = {numbers.end / 50.0:.3g}  # s, between two pictures of the flow",
    ]
    return "\n\n".join(parts) + "\n"


def _bodies(wishes: Wishes) -> str:
    return f"{wishes.bodies} bodies" if wishes.bodies > 1 else "A body"


def _body_tables(wishes: Wishes, numbers: Numbers, density: float) -> list[str]:
    """Bodies row by row from the top, rows a little aside of each other; without gravity they are thrown sideways."""
    across, radius = wishes.dimension - 1, numbers.radius
    tables = []
    for number in range(wishes.bodies):
        row, place = divmod(number, numbers.columns**across)
        aside = 0.1 * radius * (-1.0) ** row
        position = [
            (place // numbers.columns**axis % numbers.columns + 0.5) * numbers.spacing for axis in range(across)
        ]
        position[0] += aside
        height = numbers.height - (row + 1.0) * numbers.spacing if numbers.columns > 1 else 0.75 * numbers.height
        lines = ["[[body]]", f'name = "{wishes.shape}{number}"', *_shape(wishes, radius, number)]
        lines += [f"density = {density:.5g}", f"position = {_list([*position, height])}"]
        if wishes.gravity == 0.0:
            lines.append(f"velocity = {_list([(-1.0) ** number * wishes.width] + [0.0] * across)}")
        tables.append("\n".join(lines))
    return tables


def _shape(wishes: Wishes, radius: float, number: int) -> list[str]:
    """Type and size of a body; each is turned a little farther than the one before."""
    turned = f"angle = {0.3 * (number + 1):.3g}  # rad"
    if wishes.shape == "sphere":
        return ['type = "sphere"', f"radius = {radius:.4g}"]
    if wishes.shape == "polygon":
        corners = [[-radius, -0.6 * radius], [radius, -0.6 * radius], [radius, 0.6 * radius], [-radius, 0.6 * radius]]
        return ['type = "polygon"', f"points = [{', '.join(map(_list, corners))}]", turned]
    axes = [1.2 * radius] + [0.8 * radius] * (wishes.dimension - 1)
    half = 0.15 * (number + 1)
    tilted = f"orientation = {_list([1.0, 0.0, half, 0.0])}  # a quaternion"
    return ['type = "ellipsoid"', f"semi_axes = {_list(axes)}", turned if wishes.dimension == 2 else tilted]


def _contact(wishes: Wishes, numbers: Numbers) -> str:
    law = "centre" if wishes.shape == "sphere" else "contact"
    lines = [
        "[contact]",
        f'law = "{law}"',
        f"range = {numbers.range:.3g}  # gap below which bodies and walls repel",
        'epsilon = "auto"  # as strong as weights and impacts ask for',
    ]
    if numbers.restitution_stokes is not None:
        lines.append(f"restitution_stokes = {numbers.restitution_stokes:.3g}  # films take energy of impacts")
    return "\n".join(lines)


def _mesh(wishes: Wishes, numbers: Numbers) -> str:
    size_body = '"auto"' if numbers.size_body is None else f"{numbers.size_body:.3g}"
    lines = [
        "[mesh]",
        f"size = {wishes.width / _CELLS_ACROSS[wishes.dimension]:.3g}  # of cells far from the bodies",
        f"size_body = {size_body}  # on them",
    ]
    if numbers.refinements is not None:
        lines.append(f"refinements = {numbers.refinements}  # how often cells in gaps are halved")
    return "\n".join(lines)


def _list(values: list[float]) -> str:
    return f"[{', '.join(f'{value:.4g}' if value % 1 else f'{value:.1f}' for value in values)}]"
