"""The materials that come with rigidfluid, besides Newtonian ones."""

from __future__ import annotations

from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.hookspecs import hookimpl
from rigidfluid.materials.bingham import Bingham
from rigidfluid.materials.carreau import Carreau
from rigidfluid.materials.cross import Cross
from rigidfluid.materials.expression import ExpressionMaterial
from rigidfluid.materials.herschel_bulkley import HerschelBulkley
from rigidfluid.materials.power_law import PowerLaw


@hookimpl
def rigidfluid_materials() -> list[type[GeneralisedNewtonian]]:
    """The built-in materials."""
    return [Carreau, Cross, PowerLaw, Bingham, HerschelBulkley, ExpressionMaterial]
