"""Pressure on the oblique ends of a bent channel with curved walls, against the exact Stokes flow."""

from __future__ import annotations

import numpy as np
import pytest
from curved_channels import ANGLE, DROP, INNER, OUTER, flow_in_bend, flux_of, flux_through_bend, speed_in_bend


def test_flux_velocity_and_pressure_converge() -> None:
    share = np.random.default_rng(0).uniform(size=(200, 2))
    radius, turn = INNER + (OUTER - INNER) * share[:, 0], ANGLE * share[:, 1]
    points = radius[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    exact = speed_in_bend(radius)[:, None] * np.column_stack([-np.sin(turn), np.cos(turn)])
    errors = []
    for layers in (2, 4, 8, 16):
        flow = flow_in_bend(layers)
        velocity, pressure = flow.probe(points)
        errors.append(
            [
                abs(flux_of(flow) / flux_through_bend() - 1.0),
                np.sqrt(np.mean((velocity - exact) ** 2)),
                np.sqrt(np.mean((pressure - DROP * (1.0 - turn / ANGLE)) ** 2)),
            ]
        )
        assert flow.advance.boundary_power == pytest.approx(flow.advance.dissipation, rel=1e-10)
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all(orders[:, 0] > 3.5), (orders, errors)
    assert np.all(orders[:, 1] > 2.7), (orders, errors)
    assert np.all(orders[:, 2] > 1.7), (orders, errors)
