"""The falling disk as somebody who knows NGSolve would write it for this one scene, for comparison.

P2–P1, BDF2 with explicit convection, on a mesh that is stretched in y above and below the disk: so the matrix of a step
is symmetric, and sparsecholesky factorises it. The disk moves up and down alone, and its velocity U follows from two
solutions: with the disk at rest and with a unit velocity of it. Nothing else is here: no contact, turning, re-meshing,
other bodies, energies, output of fields.

    python benchmarks/ngsolve_falling_disk.py SIZE GROWTH SIZE_BODY STEP FILE      writes time, y and U of each step
"""

from __future__ import annotations

import sys

import netgen.occ as occ
import ngsolve as ngs
import numpy as np

WIDTH, HEIGHT, RADIUS, START, LOWEST = 2.0, 6.0, 0.125, 4.0, 0.5  # cm
DENSITY, VISCOSITY, DISK_DENSITY, GRAVITY = 1.0, 0.1, 1.25, 981.0
BAND = 0.25  # so far above and below its centre the mesh moves as the disk does


def fall(size: float, growth: float, size_body: float, step: float) -> np.ndarray:
    """Time, height and velocity of the disk at each step until it is below `LOWEST`, (steps, 3).

    ``size`` and ``size_body`` are lengths of edges far from the disk and on it, ``growth`` is Netgen's grading.
    """
    disk = occ.Circle((1.0, START), RADIUS).Face()
    disk.edges.name, disk.edges.maxh = "disk", size_body
    shape = occ.Rectangle(WIDTH, HEIGHT).Face() - disk
    mesh = ngs.Mesh(occ.OCCGeometry(shape, dim=2).GenerateMesh(maxh=size, grading=growth))
    mesh.Curve(2)
    points = mesh.ngmesh.Coordinates()  # a view: what is written there moves the mesh
    rest = points[:, 1].copy()
    knots = np.array([0.0, START - BAND, START + BAND, HEIGHT])
    space = ngs.VectorH1(mesh, order=2, dirichlet=".*") * ngs.H1(mesh, order=1)
    (u, p), (v, q) = space.TnT()
    state, unit, still = (ngs.GridFunction(space) for _ in range(3))
    history, flow = (ngs.GridFunction(space).components[0] for _ in range(2))
    mesh_velocity = ngs.GridFunction(ngs.H1(mesh, order=1))
    unit.components[0].Set((0, 1), definedon=mesh.Boundaries("disk"))
    on_disk = unit.vec.CreateVector(copy=True)
    rate = ngs.Parameter(DENSITY / step)
    stokes = rate * u * v + VISCOSITY * ngs.InnerProduct(ngs.Grad(u) + ngs.Grad(u).trans, ngs.Grad(v))
    stokes += -p * ngs.div(v) - q * ngs.div(u) - 1e-10 * p * q  # fixes the pressure's constant
    form = ngs.BilinearForm(space, symmetric=True, symmetric_storage=True)
    form += stokes.Compile() * ngs.dx
    past = DENSITY * (history - ngs.Grad(flow) * (flow - ngs.CF((0, mesh_velocity)))) * v
    load = ngs.LinearForm(space)
    load += past.Compile() * ngs.dx
    area = np.pi * RADIUS**2
    mass, weight = DISK_DENSITY * area, (DENSITY - DISK_DENSITY) * area * GRAVITY
    before = state.vec.CreateVector(copy=True)
    residual = state.vec.CreateVector()

    def solved(y: float, heights: list[float], speeds: list[float]) -> float:
        """Fluid and U at height ``y``, from the latest heights and velocities, the first the latest; BDF1 from one."""
        d = np.array([1.0, -1.0] if len(heights) == 1 else [1.5, -2.0, 0.5]) / step
        e = (1.0, 0.0) if len(heights) == 1 else (2.0, -1.0)
        placed = [np.interp(rest, knots, [0.0, at - BAND, at + BAND, HEIGHT]) for at in (y, *heights)]
        points[:, 1] = placed[0]
        mesh_velocity.vec.FV().NumPy()[:] = d @ placed
        n = len(history.vec)
        now, then = state.vec.FV().NumPy()[:n], before.FV().NumPy()[:n]
        history.vec.FV().NumPy()[:] = -d[1] * now - (d[2] * then if len(d) == 3 else 0.0)
        flow.vec.FV().NumPy()[:] = e[0] * now + e[1] * then
        rate.Set(DENSITY * d[0])
        form.Assemble()
        load.Assemble()
        inverse = form.mat.Inverse(space.FreeDofs(), inverse="sparsecholesky")
        still.vec.data = inverse * load.vec
        residual.data = form.mat * on_disk
        unit.vec.data = on_disk - inverse * residual
        residual.data = load.vec - form.mat * still.vec
        force = ngs.InnerProduct(on_disk, residual) + weight - mass * np.dot(d[1:], speeds)
        residual.data = form.mat * unit.vec
        return float(force / (mass * d[0] + ngs.InnerProduct(on_disk, residual)))

    # The first step twice, the second time where the mean of the velocities leads.
    speed = solved(START, [START], [0.0])
    y = START + 0.5 * step * speed
    speed = solved(y, [START], [0.0])
    rows = [(0.0, START, 0.0), (step, y, speed)]
    state.vec.data = still.vec + speed * unit.vec
    while y > LOWEST:
        (_, y1, u1), (_, y0, u0) = rows[-1], rows[-2]
        y = y1 + step * (1.5 * u1 - 0.5 * u0)
        speed = solved(y, [y1, y0], [u1, u0])
        before.data = state.vec
        state.vec.data = still.vec + speed * unit.vec
        rows.append((len(rows) * step, y, speed))
    return np.array(rows)


if __name__ == "__main__":
    np.savetxt(sys.argv[-1], fall(*map(float, sys.argv[1:-1])))
