"""The fluid that a scene asks for, with its backend and mesh, or none."""

from __future__ import annotations

from functools import partial

from rigidfluid.core.fluid.material import Material, Newtonian
from rigidfluid.core.mesh.size.size_interface import SizeField
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.model.selected import Selected
from rigidfluid.core.nested.expressions import VectorExpression
from rigidfluid.core.nested.part_options import build_part, read_part
from rigidfluid.core.scene.all_errors import raise_all
from rigidfluid.core.scene.fluid_table import FluidTable
from rigidfluid.core.scene.mesh_tables import MeshTable
from rigidfluid.core.setup.fluid import Fluid, NoFluid
from rigidfluid.errors import SceneError
from rigidfluid.registry import FLUID_BACKEND, MATERIAL, SIZE_FIELD, Registry


def scene_fluid(table: FluidTable, mesh: MeshTable | None, registry: Registry, dimension: int) -> Fluid | NoFluid:
    """The fluid of a scene, or none where its backend has no mesh.

    Raises PluginError for a backend that is missing, SceneError for an option that is not allowed, and where density,
    viscosity or mesh are missing.
    """
    backend = _backend(table, registry)
    source = None if table.force is None else VectorExpression.parse(table.force, "fluid.force")
    if not backend.part.wet:
        _refuse_flow(table, backend.part)
        return NoFluid(table.density or 0.0, backend, mesh, _size_fields(mesh, registry, dimension))
    condition = f"with backend {backend.part.name!r}"
    given = {"density": table.density, "viscosity": table.viscosity or table.material}
    raise_all(
        SceneError(f"fluid.{key}", "nothing", f"a number above 0 {condition}", f"Add {key!r}.")
        for key, value in given.items()
        if value is None
    )
    if mesh is None:
        raise SceneError("mesh", "nothing", f"a table {condition}", "Add [mesh] with size and size_body.")
    initial = table.initial
    assert table.density is not None
    return Fluid(
        density=table.density,
        material=_material(table, registry, dimension),
        mesh=mesh,
        inertia=table.model == "navier-stokes",
        source=source,
        initial=initial if isinstance(initial, str) else VectorExpression.parse(initial, "fluid.initial"),
        size_fields=_size_fields(mesh, registry, dimension),
        backend=backend,
    )


def _material(table: FluidTable, registry: Registry, dimension: int) -> Material:
    """The fluid's material; raises SceneError for a viscosity beside the table of one."""
    if table.material is None:
        assert table.viscosity is not None
        return Newtonian(table.viscosity)
    if table.viscosity is not None:
        remedy = "Leave out one of them; the material's own viscosity is a key of [fluid.material]."
        raise SceneError("fluid.viscosity", f"{table.viscosity:g} and a material", "one of both", remedy)
    return build_part(MATERIAL, table.material, "fluid.material", registry, dimension)


def _size_fields(mesh: MeshTable | None, registry: Registry, dimension: int) -> tuple[SizeField, ...]:
    """Size fields that a table of a mesh names."""
    tables = enumerate(mesh.field if mesh else ())
    return tuple(build_part(SIZE_FIELD, table, f"mesh.field.{n}", registry, dimension) for n, table in tables)


def _backend(table: FluidTable, registry: Registry) -> Selected[FluidBackend]:
    """Class of the backend that a scene names, and its options."""
    look_up = partial(registry.find, FLUID_BACKEND, table.backend)  # whoever reads results needs no more than its class
    return Selected(*read_part(look_up, FLUID_BACKEND, table.options, type(table), "fluid", registry))


def _refuse_flow(table: FluidTable, backend: type[FluidBackend]) -> None:
    """Raise SceneError for a force, a material or a flow at the start that there is no fluid for."""
    if table.material is not None:
        found, remedy = (
            f"{table.material.type!r} with backend {backend.name!r}",
            "Leave it out, or choose backend = 'scikit-fem'.",
        )
        raise SceneError("fluid.material", found, "a backend with a fluid", remedy)
    if table.force is not None:
        found = f"{list(table.force)} with backend {backend.name!r}"
        remedy = "Leave it out, or choose backend = 'scikit-fem'."
        raise SceneError("fluid.force", found, "a backend with a fluid", remedy)
    if table.initial != "rest":
        allowed = f"'rest' with backend {backend.name!r}"
        remedy = "Leave it out, or choose backend = 'scikit-fem'."
        raise SceneError("fluid.initial", table.initial, allowed, remedy)
