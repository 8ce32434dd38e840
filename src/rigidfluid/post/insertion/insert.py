"""Meshes a scene and writes the mesh, its pictures, and a report of the quality of the insertion."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

from rigidfluid.core.case.scene_model import Case, model_of
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.fluid_domain import fluid_domain_at
from rigidfluid.core.mesh.size.size_interface import with_fields_at_rest
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Mesh
from rigidfluid.core.output.disk import replace_text, writing
from rigidfluid.core.output.mesh_files import write_mesh_vtu, write_msh
from rigidfluid.core.output.results_folder import Product, take_folder
from rigidfluid.core.run.mesh_keys import inserter_of, sizes_of
from rigidfluid.core.setup.assemble import assemble
from rigidfluid.errors import SceneError
from rigidfluid.post.insertion.figures import Figures, measured
from rigidfluid.post.insertion.page import write_page

INSERTION = Product("insertion", r"mesh\.(vtu|msh|png)|quality\.png|insertion\.(json(\.part)?|html)")

_WAYS = {
    "cad": "meshing the domain less the bodies",
    "fill": "filling between the facets of domain and bodies",
    "level_set": "cutting the bodies out of a mesh of the domain",
}


def insert(
    case: Case, out: Path | None = None, progress: Callable[[str], None] = lambda _: None
) -> tuple[Figures, list[Path]]:
    """Make the first mesh of a scene or a model that has one; return the insertion's figures and the files written.

    They go to ``out``, else to ``out/<scene name>_mesh``; ``progress`` is called with the name of each phase as it
    begins. Raises SceneError or PluginError if the scene cannot be built or has no mesh, MeshError if none can be made,
    OutputError if the disk refuses.
    """
    model = model_of(case)
    table = model.fluid.insertion
    if table is None:
        raise SceneError(
            "mesh", "no such table", "a scene with [mesh] size and size_body", "Add the table; dry runs need none."
        )
    seconds: dict[str, float] = {}
    with _timed(seconds, "scene"):
        progress("checking the scene")
        system, inserter = assemble(model), inserter_of(table)
        around = fluid_domain_at(system, system.pose)
        sizes = with_fields_at_rest(sizes_of(table, system.domain), model.fluid.size_fields, around)
        way = inserter.chosen(around.bodies, around.domain)
    out = Path("out") / f"{model.name}_mesh" if out is None else Path(out)
    with take_folder(out, INSERTION, new=True):
        phases = {"insertion": _WAYS[way], "grading": "grading the cells"}

        def watch(phase: str) -> AbstractContextManager[None]:
            progress(phases[phase])
            return _timed(seconds, phase)

        mesh = initial_mesh(around, sizes, inserter, watch)
        figures = measured(model.name, way, mesh, system, seconds)
        progress("writing mesh and report")
        return figures, _written(figures, mesh, system, out)


def _written(figures: Figures, mesh: Mesh, system: System, out: Path) -> list[Path]:
    """Files of the mesh, its figures and its page, once they are written."""
    with writing(out):
        files = [out / name for name in ("mesh.vtu", "mesh.msh", "insertion.json")]
        write_mesh_vtu(files[0], mesh, system.surfaces)
        write_msh(files[1], mesh, system.surfaces)
        text = json.dumps(figures.to_dict(), indent=2, allow_nan=False, ensure_ascii=False)
        replace_text(files[2], text + "\n")
        return [*files, *write_page(figures, mesh, system, out)]


@contextmanager
def _timed(seconds: dict[str, float], phase: str) -> Iterator[None]:
    start = time.perf_counter()
    yield
    seconds[phase] = seconds.get(phase, 0.0) + time.perf_counter() - start
