"""Steps of NGSolve on the meshes of a run, for comparison: P2–P1, backward Euler, in three ways that its users know.

* `umfpack`: convection by the latest velocity, the matrix factorised by UMFPACK at each step, as the first examples do.
* `imex`: convection explicit, so that the matrix is symmetric; integrands compiled to machine code; sparsecholesky at
  each step, since the mesh has moved.
* `reuse`: as `imex`, with the factors of an earlier step as preconditioner of GMRES; they are regenerated every 20
steps.
"""

from __future__ import annotations

import os
import sysconfig
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import netgen.meshing as netgen
import ngsolve as ngs
import numpy as np
from ngsolve.krylovspace import GMRESSolver

from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Mesh

WAYS = ("umfpack", "imex", "reuse")
RENEWED_EVERY = 20  # steps
TOLERANCE = 1e-9  # relative residual of `reuse`, as of rigidfluid


@dataclass(frozen=True)
class Frame:
    """One step of a run: vertices (N, 2) and the velocity (2,) of the body at its end."""

    points: FloatArray
    velocity: FloatArray


def as_ngsolve(mesh: Mesh, bodies: int) -> Any:
    """The same triangles as an NGSolve mesh with boundaries ``body`` and ``wall``."""
    made = netgen.Mesh(dim=2)
    made.Add(netgen.FaceDescriptor(surfnr=1, domin=1, bc=1))
    points = [made.Add(netgen.MeshPoint(netgen.Pnt(x, y, 0.0))) for x, y in mesh.points]
    for cell in mesh.cells:
        made.Add(netgen.Element2D(1, [points[i] for i in cell]))
    for facet, marker in zip(mesh.facets, mesh.markers, strict=True):
        made.Add(netgen.Element1D([points[i] for i in facet], index=1 if marker < bodies else 2))
    made.SetBCName(0, "body")
    made.SetBCName(1, "wall")
    return ngs.Mesh(made)


class Flow:
    """The flow around a body that moves as given, on meshes that are given too."""

    def __init__(self, mesh: Mesh, problem: FluidProblem, step: float, way: str) -> None:
        self._way, self._step, self._mesh = way, step, as_ngsolve(mesh, problem.bodies)
        self._coordinates = self._mesh.ngmesh.Coordinates()  # a view: what is written there moves the mesh
        space = ngs.VectorH1(self._mesh, order=2, dirichlet="body|wall") * ngs.H1(self._mesh, order=1)
        self.free, self._factors = space.FreeDofs(), None
        (u, p), (v, q) = space.TnT()
        self.state, self._mesh_velocity = ngs.GridFunction(space), ngs.GridFunction(ngs.VectorH1(self._mesh, order=1))
        wind, density, viscosity = self.state.components[0], problem.density, problem.material.dynamic_viscosity
        advection = density * (wind - self._mesh_velocity)
        inertia, divergence = density / step * u * v, -p * ngs.div(v) - q * ngs.div(u)
        pin = -1e-10 * p * q  # fixes the pressure's constant
        if way == "umfpack":
            strain = ngs.Grad(u) + ngs.Grad(u).trans
            self._form = ngs.BilinearForm(space)
            self._form += (inertia + viscosity * ngs.InnerProduct(strain, ngs.Grad(v)) + divergence + pin) * ngs.dx
            self._form += (ngs.Grad(u) * advection) * v * ngs.dx
            self._load = ngs.LinearForm(density / step * wind * v * ngs.dx)
        else:  # where all velocities on boundaries are given, ∇u is as good as ∇u + ∇uᵀ
            stokes = inertia + viscosity * ngs.InnerProduct(ngs.Grad(u), ngs.Grad(v)) + divergence + pin
            history = density / step * wind * v - (ngs.Grad(wind) * advection) * v
            self._form = ngs.BilinearForm(space, symmetric=True, symmetric_storage=True)
            _let_ngscxx_be_found()
            self._form += stokes.Compile(realcompile=True, wait=True) * ngs.dx
            self._load = ngs.LinearForm(space)
            self._load += history.Compile(realcompile=True, wait=True) * ngs.dx
        self._before = self.state.vec.CreateVector(copy=True)
        self.seconds: Counter[str] = Counter()

    def advance(self, frame: Frame, number: int) -> None:
        """Move the mesh, and take a step there; the seconds of each stage are added up."""
        speed = (frame.points - self._coordinates) / self._step
        self._coordinates[:] = frame.points
        self._mesh_velocity.vec.FV().NumPy()[:] = speed.T.ravel()
        marks = [time.perf_counter()]
        self._form.Assemble()
        self._load.Assemble()
        marks.append(time.perf_counter())
        if self._way != "reuse" or number % RENEWED_EVERY == 0:
            kind = "umfpack" if self._way == "umfpack" else "sparsecholesky"
            self._factors = self._form.mat.Inverse(self.free, inverse=kind)
        marks.append(time.perf_counter())
        self._guess(frame.velocity)
        self._solve()
        marks.append(time.perf_counter())
        for stage, seconds in zip(("assemble", "factorise", "solve"), np.diff(marks), strict=True):
            self.seconds[stage] += float(seconds)

    def _guess(self, velocity: FloatArray) -> None:
        """The state extrapolated, with the body's velocity on it."""
        latest = self.state.vec.CreateVector(copy=True)
        self.state.vec.data = 2.0 * latest - self._before
        self._before.data = latest
        self.state.components[0].Set(ngs.CF(tuple(velocity)), definedon=self._mesh.Boundaries("body"))

    def _solve(self) -> None:
        """Correct the guess."""
        x, b, r = self.state.vec, self._load.vec, self.state.vec.CreateVector()
        r.data = b - self._form.mat * x
        if self._way != "reuse":
            x.data += self._factors * r
            return
        free, scale = ngs.Projector(self.free, True), r.CreateVector()
        scale.data = free * b
        r.data = free * r
        wanted = TOLERANCE * max(ngs.Norm(scale), ngs.Norm(r)) / ngs.Norm(r)
        x.data += GMRESSolver(self._form.mat, self._factors, maxiter=100, tol=wanted) * r


def _let_ngscxx_be_found() -> None:
    """NGSolve calls its compiler script by name, which lies with the scripts of this environment, activated or not."""
    scripts, path = sysconfig.get_path("scripts"), os.environ.get("PATH", os.defpath)
    if scripts not in path.split(os.pathsep):
        os.environ["PATH"] = os.pathsep.join([scripts, path])


def time_ngsolve(
    mesh: Mesh, problem: FluidProblem, step: float, way: str, frames: Sequence[Frame]
) -> tuple[dict[str, float], int]:
    """Mean seconds of each stage of a step, and the number of unknowns; a first step lays out the matrix, untimed."""
    flow = Flow(mesh, problem, step, way)
    flow.advance(frames[0], 0)
    flow.seconds.clear()
    for number, frame in enumerate(frames):
        flow.advance(frame, number)
    return {stage: seconds / len(frames) for stage, seconds in flow.seconds.items()}, sum(flow.free)
