"""The hooks by which a plug-in offers its classes, and the marker for its functions.

A plug-in is a module that the entry-point group ``rigidfluid`` names::

    from rigidfluid.hookspecs import hookimpl

    @hookimpl
    def rigidfluid_force_laws():
        return [MyLaw]
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pluggy

if TYPE_CHECKING:
    from rigidfluid.core.joints.joint import Joint
    from rigidfluid.core.mesh.size.size_interface import SizeField
    from rigidfluid.core.model.body import Body
    from rigidfluid.core.model.detector import Detector
    from rigidfluid.core.model.domain import Domain
    from rigidfluid.core.model.fluid_backend import FluidBackend
    from rigidfluid.core.model.force_law import ForceLaw
    from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
    from rigidfluid.core.model.mechanism import Mechanism

hookspec = pluggy.HookspecMarker("rigidfluid")
hookimpl = pluggy.HookimplMarker("rigidfluid")


@hookspec
def rigidfluid_fluid_backends() -> list[type[FluidBackend]]:  # type: ignore[empty-body]
    """Classes that move fluid and bodies together."""


@hookspec
def rigidfluid_detectors() -> list[type[Detector]]:  # type: ignore[empty-body]
    """Classes that find which surfaces are near each other."""


@hookspec
def rigidfluid_force_laws() -> list[type[ForceLaw]]:  # type: ignore[empty-body]
    """Classes of short-range repulsion."""


@hookspec
def rigidfluid_bodies() -> list[type[Body]]:  # type: ignore[empty-body]
    """Classes of rigid shapes."""


@hookspec
def rigidfluid_domains() -> list[type[Domain]]:  # type: ignore[empty-body]
    """Classes of regions that fluid and bodies share."""


@hookspec
def rigidfluid_mechanisms() -> list[type[Mechanism]]:  # type: ignore[empty-body]
    """Classes of several rigid bodies that move as one."""


@hookspec
def rigidfluid_joints() -> list[type[Joint]]:  # type: ignore[empty-body]
    """Classes of joints between two bodies."""


@hookspec
def rigidfluid_size_fields() -> list[type[SizeField]]:  # type: ignore[empty-body]
    """Classes of edge lengths wanted in the fluid."""


@hookspec
def rigidfluid_materials() -> list[type[GeneralisedNewtonian]]:  # type: ignore[empty-body]
    """Classes of fluids whose viscosity varies with the shear rate."""
