"""All statistics of a run, and their names in a file."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rigidfluid.post.reports.units import Units
from rigidfluid.post.statistics.blocks import Mean, known
from rigidfluid.post.statistics.contact_network import ContactNetwork
from rigidfluid.post.statistics.diffusion import Diffusion
from rigidfluid.post.statistics.gap_distribution import GapDistribution
from rigidfluid.post.statistics.pair_distribution import PairDistribution
from rigidfluid.post.statistics.presence import Presence
from rigidfluid.post.statistics.profiles import Profile
from rigidfluid.post.statistics.samples import Samples
from rigidfluid.post.statistics.structure_factor import StructureFactor
from rigidfluid.post.statistics.suspension_stress import SuspensionStress
from rigidfluid.post.statistics.wall_stresses import WallStresses


class Statistics(NamedTuple):
    """Statistics of the bodies that move: of their ``gap`` to the nearest surface the mean over bodies [length], and
    all that the other modules of this folder measure; ``wet`` tells whether there is a fluid around them."""

    units: Units
    samples: Samples
    presence: Presence
    gap: Mean
    gaps: GapDistribution
    velocity: Mean
    fluctuations: Mean
    pairs: PairDistribution
    structure: StructureFactor
    diffusion: Diffusion
    profile: Profile
    contacts: ContactNetwork
    suspension: SuspensionStress | None
    walls: WallStresses | None
    wet: bool

    def to_dict(self) -> dict[str, Any]:
        """Names, numbers and lists; each mean as its value and its standard error, None for what is unknown."""
        samples, contacts, layers = self.samples, self.contacts, self.profile
        return {
            "bodies": len(samples.name),
            "present": self.presence.to_dict(),
            "states": len(samples.time),
            "from": float(samples.time[0]),
            "to": float(samples.time[-1]),
            "volume_fraction": self.presence.fraction.to_list(),
            "gap": self.gap.to_list(),
            "gap_distribution": {"share": self.gaps.share.tolist(), "gap": self.gaps.gap.to_list()},
            "velocity": self.velocity.to_list(),
            "velocity_fluctuations": self.fluctuations.to_list(),
            "diffusion": {
                "coefficient": known(self.diffusion.coefficient),
                "lag": self.diffusion.lag.tolist(),
                "mean_square_displacement": known(self.diffusion.displacement),
            },
            "pair_distribution": {"distance": self.pairs.distance.tolist(), "g": self.pairs.value.to_list()},
            "structure_factor": {"wavenumber": self.structure.wavenumber.tolist(), "s": self.structure.value.to_list()},
            "profile": {
                "across": "xyz"[layers.axis],
                "place": layers.place.tolist(),
                "fraction": layers.fraction.to_list(),
                "velocity": layers.velocity.to_list(),
                "velocity_fluctuations": layers.fluctuations.to_list(),
                "fluid_velocity": None if layers.fluid is None else layers.fluid.to_list(),
                "mixture_velocity": None if layers.mixture is None else layers.mixture.to_list(),
            },
            "contacts": {
                "coordination": contacts.coordination.to_list(),
                "touching": contacts.touching.to_list(),
                "largest_group": contacts.largest.to_list(),
                "stress": contacts.stress.to_list(),
                "force_on": {name: force.to_list() for name, force in contacts.on_walls.items()},
            },
            "suspension_stress": None if self.suspension is None else self.suspension.to_dict(),
            "walls": None if self.walls is None else self.walls.to_dict(),
        }

    @property
    def lines(self) -> list[str]:
        """Figures that are no curves, in words."""
        samples, contacts = self.samples, self.contacts
        lines = [
            f"{self.presence.words(len(samples.name))}, {float(self.presence.fraction.value):.3g} of the volume",
            f"{len(samples.time)} states from {samples.time[0]:.4g} to {samples.time[-1]:.4g} [time]",
            f"gap to the nearest surface: {told(self.gap)} [length]",
            f"velocity: {told(self.velocity)} [length/time]",
            f"fluctuations of velocity: {told(self.fluctuations)} [length/time]",
            f"bodies that touch a body: {told(contacts.coordination)}",
            f"share with a contact: {told(contacts.touching)}",
            f"share in the largest group: {told(contacts.largest)}",
        ]
        lines += [f"force on {name}: {told(force)} [force]" for name, force in contacts.on_walls.items()]
        if self.walls is not None and self.walls.relative_viscosity is not None:
            lines.append(f"viscosity at the walls over that of the fluid: {told(self.walls.relative_viscosity)}")
        if self.suspension is None and self.wet:
            lines.append(
                "stress of the suspension: none without stresslets; set output.stresslets = true and run again"
            )
        if self.suspension is not None:
            total, viscosity = self.suspension.by_cause["total"], self.suspension.relative_viscosity
            unit = self.units.pressure
            lines.append(f"pressure of the bodies: {told(total.pressure)} [{unit}]")
            if viscosity is not None:
                lines.append(f"viscosity over that of the fluid: {told(viscosity)}")
            if total.differences is not None:
                lines.append(f"normal stress differences: {told(total.differences)} [{unit}]")
        return [self.units.put_into(line) for line in lines]


def told(values: Mean) -> str:
    """Value and error in words."""
    value, error = np.atleast_1d(values.value), np.atleast_1d(values.error)
    told = [f"{v:.3g}" + (f" ± {e:.1g}" if np.isfinite(e) else "") for v, e in zip(value, error, strict=True)]
    return told[0] if len(told) == 1 else f"({', '.join(told)})"
