"""The P2–P1 step as NGSolve's own examples write it: assemble, factorise by UMFPACK, solve; for comparison."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from rigidfluid.core.model.types import FluidProblem, Mesh


def as_ngsolve(mesh: Mesh, bodies: int) -> Any:
    """The same triangles as an NGSolve mesh with boundaries ``body`` and ``wall``."""
    import netgen.meshing as netgen
    import ngsolve

    made = netgen.Mesh(dim=2)
    made.Add(netgen.FaceDescriptor(surfnr=1, domin=1, bc=1))
    points = [made.Add(netgen.MeshPoint(netgen.Pnt(x, y, 0.0))) for x, y in mesh.points]
    for cell in mesh.cells:
        made.Add(netgen.Element2D(1, [points[i] for i in cell]))
    for facet, marker in zip(mesh.facets, mesh.markers, strict=True):
        made.Add(netgen.Element1D([points[i] for i in facet], index=1 if marker < bodies else 2))
    made.SetBCName(0, "body")
    made.SetBCName(1, "wall")
    return ngsolve.Mesh(made)


def time_ngsolve(mesh: Mesh, problem: FluidProblem, step: float, steps: int) -> tuple[dict[str, float], int]:
    """Seconds per step of each stage, and the number of unknowns; the wind is a given swirl."""
    import ngsolve as ngs

    domain = as_ngsolve(mesh, problem.bodies)
    space = ngs.VectorH1(domain, order=2, dirichlet="body|wall") * ngs.H1(domain, order=1)
    (u, p), (v, q) = space.TnT()
    state = ngs.GridFunction(space)
    wind = state.components[0]
    wind.Set(ngs.CF((ngs.y, -ngs.x)))
    rate = problem.density / step
    strain = ngs.Grad(u) + ngs.Grad(u).trans
    form = ngs.BilinearForm(space)
    form += (rate * u * v + problem.density * (ngs.Grad(u) * wind) * v) * ngs.dx
    form += problem.dynamic_viscosity * ngs.InnerProduct(strain, ngs.Grad(v)) * ngs.dx
    form += (-p * ngs.div(v) - q * ngs.div(u) - 1e-10 * p * q) * ngs.dx  # the last term fixes the pressure's constant
    load = ngs.LinearForm(rate * wind * v * ngs.dx)

    stages = dict.fromkeys(("assemble", "factorise", "solve"), 0.0)
    for _ in range(steps):
        marks = [time.perf_counter()]
        with ngs.TaskManager():
            form.Assemble()
            load.Assemble()
        marks.append(time.perf_counter())
        inverse = form.mat.Inverse(space.FreeDofs(), inverse="umfpack")
        marks.append(time.perf_counter())
        state.vec.data = inverse * load.vec
        marks.append(time.perf_counter())
        wind.Set(ngs.CF((ngs.y, -ngs.x)))
        for stage, seconds in zip(stages, np.diff(marks), strict=True):
            stages[stage] += float(seconds) / steps
    return stages, sum(space.FreeDofs())
