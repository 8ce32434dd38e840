"""Residuals of each cell: how far a step's solution is from the solution of the equations themselves."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from rigidfluid.core.fluid.material import Material
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.facets import area_vectors
from rigidfluid.core.geometry.quadratic_cells import mean_products, node_gradients
from rigidfluid.core.mesh.mesh_quality import cell_volumes, edge_lengths
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.stepping.nodal_stress import nodal_stress

_SHARPNESS = 2.0 * np.pi
"""Over lengths in the weights: the degree of the velocity (Melenk and Wohlmuth), and π of Poincaré's inequality in
convex cells (Payne and Weinberger)."""


@dataclass(frozen=True, eq=False)
class DiscreteFlow:
    """A step's solution on the nodes of a ``numbering``: ``points`` (nodes, d) [length], ``velocity`` (nodes, d)
    [length/time] and ``pressure`` (vertices,) [force/length^(d-1)].

    ``momentum`` (nodes, d): mass flux ρ(u* - w) through the mesh [mass/(length^(d-1)·time)]; ``rate`` (nodes, d): ρ
    ∂u/∂t - f, the body force f with it [force/length^d].
    """

    numbering: Numbering
    points: FloatArray
    velocity: FloatArray
    pressure: FloatArray
    momentum: FloatArray
    rate: FloatArray


def cell_errors(flow: DiscreteFlow, material: Material) -> FloatArray:
    r"""Squared error of each cell in the norm of dissipation, (M,) [energy/time], with s = 2π:

    η_K² = h_K²/(s²μ) ‖f - ρ(∂u/∂t + (u* - w)·∇u) + ∇·σ‖² + ½ Σ h_E/(2sμ) ‖[σ·n]‖² + μ ‖∇·u‖²

    with the sum over the facets E inside the fluid, h_K the longest edge and h_E the size of a facet. Σ η_K² follows μ
    ‖∇e‖² + ‖e_p‖²/μ of the errors e in velocity and e_p in pressure, and with convection the dual norm of ρ(∂e/∂t +
    u·∇e) over μ too, within constants that depend on the cells' shapes and on neither Reynolds number nor step.

    Parameters
    ----------
    flow : DiscreteFlow
        Solution of the step, on the mesh at its end.
    material : Material
        Gives the viscosity μ, of which a cell's mean counts in the weights.

    Notes
    -----
    R. Verfürth, A Posteriori Error Estimation Techniques for Finite Element Methods, Oxford 2013, and SIAM J. Numer.
    Anal. 43, 1766 (2005); weights by the degree: J. M. Melenk and B. I. Wohlmuth, Adv. Comput. Math. 15, 311 (2001).
    Gradients are those of the cells, curved ones too; volumes and facets are taken as straight. Facets on the boundary
    have no part.
    """
    nodes, d = flow.numbering.cell_nodes, flow.numbering.dimension
    points, pressure = flow.points[nodes], flow.numbering.interpolate_to_nodes(flow.pressure)[nodes]
    gradient, viscosity, stress = nodal_stress(points, flow.velocity[nodes], pressure, material)
    divergence = np.einsum("mbii->mb", gradient)
    forces = node_gradients(points, stress.reshape(*divergence.shape, d * d)).reshape(*stress.shape, d)
    residual = np.einsum("mbijj->mbi", forces) - flow.rate[nodes]
    residual -= (gradient @ flow.momentum[nodes][..., None])[..., 0]
    mean, vertices = viscosity.mean(axis=1), flow.points[: flow.numbering.vertices]
    cells = flow.numbering.cells
    volume, longest = np.abs(cell_volumes(vertices, cells)), edge_lengths(vertices, cells).max(axis=1)
    inside = (longest / _SHARPNESS) ** 2 / mean * _square(residual, volume)
    between = _jumps(vertices, cells, stress[:, : d + 1]) / (2.0 * _SHARPNESS * mean)
    return np.asarray(inside + 0.5 * between + mean * _square(divergence[..., None], volume))


def _square(values: FloatArray, volume: FloatArray) -> FloatArray:
    """∫ |v|² over each cell (M,) of quadratic ``values`` (M, b, c)."""
    products = mean_products(3 if values.shape[1] == 6 else 4)
    return np.asarray(volume * np.sum(values * (products @ values), axis=(1, 2)))


def _jumps(points: FloatArray, cells: IntArray, stress: FloatArray) -> FloatArray:
    """Σ h_E ∫ |[σ·n]|² over the facets E of each cell inside the fluid (M,), ``stress`` (M, d+1, d, d) at its
    vertices and linear between them."""
    d = cells.shape[1] - 1
    picks = np.array(list(combinations(range(d + 1), d)))
    order = np.argsort(cells[:, picks], axis=2)  # both cells of a facet then have its vertices in one order
    corner = np.take_along_axis(np.broadcast_to(picks, order.shape), order, axis=2).reshape(-1, d)
    owner = np.repeat(np.arange(len(cells)), d + 1)
    facets = cells[owner[:, None], corner]
    keys = np.ravel_multi_index(tuple(facets.T), d * (len(points),))
    ordered = np.argsort(keys, kind="stable")
    pair = np.flatnonzero(keys[ordered[1:]] == keys[ordered[:-1]])
    first, second = ordered[pair], ordered[pair + 1]
    areas = area_vectors(points, facets[first])
    area = np.linalg.norm(areas, axis=1)
    jump = stress[owner[first, None], corner[first]] - stress[owner[second, None], corner[second]]
    traction = np.einsum("fvij,fj->fvi", jump, areas / area[:, None])
    squares = np.sum(traction * (traction + traction.sum(axis=1, keepdims=True)), axis=(1, 2)) / (d * (d + 1))
    weighted = area ** (1.0 / (d - 1)) * area * squares
    found = np.zeros(len(cells))
    for cell in (owner[first], owner[second]):
        found += np.bincount(cell, weighted, minlength=len(cells))
    return found
