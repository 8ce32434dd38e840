"""The domains that come with rigidfluid."""

from __future__ import annotations

from rigidfluid.core.model.domain import Domain
from rigidfluid.domains.box import Box
from rigidfluid.domains.cad import Cad
from rigidfluid.domains.channel import Channel
from rigidfluid.domains.mesh import MeshDomain
from rigidfluid.domains.stenosis import Stenosis
from rigidfluid.hookspecs import hookimpl


@hookimpl
def rigidfluid_domains() -> list[type[Domain]]:
    """The built-in domains."""
    return [Box, Channel, Stenosis, Cad, MeshDomain]
