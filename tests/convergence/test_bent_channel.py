"""Pressure on the oblique ends of a bent channel with curved walls, against the exact Stokes flow."""

from __future__ import annotations

import numpy as np
import pytest
from curved_channels import error_in_bend, flow_in_bend, flux_of, flux_through_bend


def test_flux_and_velocity_converge() -> None:
    errors = []
    for layers in (2, 4, 8, 16):
        flow = flow_in_bend(layers)
        errors.append([abs(flux_of(flow) / flux_through_bend() - 1.0), error_in_bend(flow)])
        assert flow.advance.boundary_power == pytest.approx(flow.advance.dissipation, rel=1e-10)
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all(orders > [3.5, 2.7]), (orders, errors)
