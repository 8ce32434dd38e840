"""Curves among the statistics as tables, for spreadsheets."""

from __future__ import annotations

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.statistics.blocks import Mean
from rigidfluid.post.statistics.figures import Statistics


def curves(found: Statistics) -> dict[str, dict[str, FloatArray]]:
    """Columns (n,) of each table by the names in ``statistics.json``; standard errors beside their means."""
    axes, layers = "xyz"[: found.samples.dimension], found.profile
    velocities = {"": layers.velocity, "fluctuation_": layers.fluctuations}
    velocities |= {"fluid_": layers.fluid, "mixture_": layers.mixture} if layers.fluid and layers.mixture else {}
    profile = {"place": layers.place} | _columns("fraction", layers.fraction)
    for name, mean in velocities.items():
        for column, axis in enumerate(axes):
            profile |= _columns(f"{name}v{axis}", Mean(mean.value[:, column], mean.error[:, column]))
    spread = {f"square_displacement_{axis}": found.diffusion.displacement[:, n] for n, axis in enumerate(axes)}
    return {
        "pair_distribution": {"distance": found.pairs.distance} | _columns("g", found.pairs.value),
        "structure_factor": {"wavenumber": found.structure.wavenumber} | _columns("s", found.structure.value),
        "gap_distribution": {"share": found.gaps.share} | _columns("gap", found.gaps.gap),
        "diffusion": {"lag": found.diffusion.lag} | spread,
        "profile": profile,
    }


def table_text(columns: dict[str, FloatArray]) -> str:
    """Text of a table as comma-separated values, a row per number of its columns."""
    rows = (",".join(map(repr, row)) for row in zip(*(column.tolist() for column in columns.values()), strict=True))
    return "\n".join([",".join(columns), *rows]) + "\n"


def _columns(name: str, mean: Mean) -> dict[str, FloatArray]:
    return {name: mean.value, f"{name}_error": mean.error}
