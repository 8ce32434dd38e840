"""Flows along, into and out of curved walls and oblique ends, against exact Stokes flows."""

from __future__ import annotations

import numpy as np
import pytest
from curved_channels import (
    INNER,
    OUTER,
    VISCOSITY,
    error_in_bend,
    flow_from_within,
    flow_in_bend,
    flux_of,
    flux_through_bend,
    from_within,
)

pytestmark = pytest.mark.long


def test_flux_and_velocity_converge() -> None:
    errors = []
    for layers in (2, 4, 8, 16):
        flow = flow_in_bend(layers)
        errors.append([abs(flux_of(flow) / flux_through_bend() - 1.0), error_in_bend(flow)])
        assert flow.advance.boundary_power == pytest.approx(flow.advance.dissipation, rel=1e-10)
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all(orders > [3.5, 2.7]), (orders, errors)


@pytest.mark.parametrize("outside", ["pressure", "velocity"])
def test_flow_into_and_out_of_curved_faces_converges(outside: str) -> None:
    """From a circle to one around it, where either no stress acts across, or the velocity is given."""
    share = np.random.default_rng(0).uniform(size=(200, 2))
    radius, turn = INNER + (OUTER - INNER) * share[:, 0], 2.0 * np.pi * share[:, 1]
    points = radius[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    level = -2.0 * VISCOSITY / OUTER**2 if outside == "pressure" else 0.0
    errors = []
    for layers in (2, 4, 8):
        flow = flow_from_within(layers, outside)
        velocity, pressure = flow.probe(points)
        off = velocity - from_within(0.0, points), pressure - level
        errors.append([np.sqrt(np.mean(each**2)) for each in off])
        assert flow.advance.boundary_power == pytest.approx(flow.advance.dissipation, rel=1e-8)
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all(orders[-1] > [2.7, 1.7]), (orders, errors)
