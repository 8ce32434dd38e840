"""Memory of a backend: all of it is in the state, none in its arguments or in itself."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

import h5py
import numpy as np

from rigidfluid.core.model.types import Advance, FluidState
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import copied
from rigidfluid.testing.fluid.exact import problem
from rigidfluid.testing.fluid.flow import figures


class MemoryContract(FluidContract):
    """State in, candidate out; a checkpoint holds the state, and going on from it is as if nothing had happened."""

    def test_the_state_is_a_flat_mapping_of_float_arrays(self, dimension: int) -> None:
        """The names are the same at the start and after a step."""
        flow = self.stirred(dimension, steps=0)
        for state in (flow.fluid, self.stir(flow).fluid):
            assert state.keys() == flow.fluid.keys()
            for name, array in state.items():
                assert isinstance(name, str)
                assert "/" not in name
                assert isinstance(array, np.ndarray)
                assert array.dtype == np.float64
            shapes = flow.backend.state_shapes(flow.mesh, flow.pose)
            assert shapes is None or shapes == {name: array.shape for name, array in state.items()}

    def test_a_step_changes_nothing_that_it_is_given(self, dimension: int) -> None:
        """Neither the state, nor mesh and step; and a second step does not change what the first one returned."""
        flow = self.stirred(dimension, steps=2)
        step = self.stirring(flow)
        given = [flow.fluid, _arrays(flow.mesh), _arrays(step), _arrays(step.pose)]
        before = _copies(given)
        first = flow.backend.advance(flow.fluid, flow.mesh, step)
        _assert_same(given, before)
        returned = [first.fluid, figures(first)]
        kept = _copies(returned)
        flow.backend.advance(first.fluid, flow.mesh, step)
        flow.backend.advance(flow.fluid, flow.mesh, replace(step, load=step.load + 1.0))
        _assert_same(given, before)
        _assert_same(returned, kept)

    def test_evaluating_responses_changes_nothing(self, dimension: int) -> None:
        """Neither what is given, nor what was returned, nor, to the solver's tolerance, the step."""
        flow = self.stirred(dimension, steps=2)
        step = self.stirring(flow)
        first = flow.backend.advance(flow.fluid, flow.mesh, step)
        impulses = np.random.default_rng(6).normal(size=(3, *step.load.shape))
        given = [flow.fluid, first.fluid, _arrays(flow.mesh), _arrays(step), _arrays(step.pose), {"impulses": impulses}]
        before = _copies(given)
        flow.backend.response(flow.fluid, flow.mesh, step, impulses)
        _assert_same(given, before)
        self._assert_close_figures(flow.backend.advance(flow.fluid, flow.mesh, step), first)

    def test_one_step_from_another_state_is_another_one(self, dimension: int) -> None:
        """It equals that of a new backend, which has not seen the step before."""
        flow = self.stirred(dimension, steps=2)
        step, other = self.stirring(flow), self.stir(flow).fluid
        flow.backend.advance(flow.fluid, flow.mesh, step)
        fresh = self.make_backend(problem(dimension, bodies=2))
        expected = fresh.advance(other, flow.mesh, step)
        self._assert_close_figures(flow.backend.advance(other, flow.mesh, step), expected)

    def test_a_rejected_step_leaves_no_trace(self, dimension: int) -> None:
        """A step repeated after another one that was not accepted is the same to the solver's tolerance."""
        flow = self.stirred(dimension, steps=2)
        first = self.stir(flow)
        flow.after(0.5, points=flow.mesh.points, push=np.ones_like(first.step.load))
        self._assert_close_figures(self.stir(flow).advance, first.advance)

    def test_a_rejected_step_that_went_far_off_misleads_no_shorter_one(self, dimension: int) -> None:
        """A force of another order has thrown the bodies away: where they were is no guess for the next try."""
        flow = self.stirred(dimension, steps=2)
        first = self.stir(flow)
        flow.after(0.5, points=flow.mesh.points, push=np.full_like(first.step.load, 1e12))
        self._assert_close_figures(self.stir(flow).advance, first.advance)

    def test_going_on_from_a_checkpoint_is_bit_identical(self, dimension: int) -> None:
        """After ``forget``, a new backend with the state from a file takes the same two steps as the old one."""
        flow = self.stirred(dimension, steps=3)
        flow.backend.forget()
        resumed = replace(
            flow,
            backend=self.make_backend(problem(dimension, bodies=2)),
            mesh=copied(flow.mesh),
            fluid=_through_a_file(flow.fluid),
        )
        for _ in range(2):
            flow, resumed = self.stir(flow), self.stir(resumed)
            _assert_same([resumed.fluid, figures(resumed.advance)], [flow.fluid, figures(flow.advance)])

    def test_going_on_from_a_checkpoint_with_a_memory_is_bit_identical(self, dimension: int) -> None:
        """A new backend with state and ``memory`` from files takes the same steps as the old one."""
        flow = self.stirred(dimension, steps=3)
        memory = _through_a_file(flow.backend.memory())
        backend, mesh = self.make_backend(problem(dimension, bodies=2)), copied(flow.mesh)
        backend.recall(memory, mesh)
        resumed = replace(flow, backend=backend, mesh=mesh, fluid=_through_a_file(flow.fluid))
        for _ in range(4):
            flow, resumed = self.stir(flow), self.stir(resumed)
            _assert_same([resumed.fluid, figures(resumed.advance)], [flow.fluid, figures(flow.advance)])

    def _assert_close_figures(self, found: Advance, expected: Advance) -> None:
        for name, wanted in figures(expected).items():
            self.assert_close(figures(found)[name], wanted, scale=float(np.abs(wanted).max()))


def _through_a_file(state: FluidState) -> FluidState:
    image = io.BytesIO()
    with h5py.File(image, "w") as file:
        for name, array in state.items():
            file[name] = array
    with h5py.File(image, "r") as file:
        return {name: np.asarray(stored[()]) for name, stored in file.items()}


def _arrays(record: Any) -> dict[str, Any]:
    """The arrays of a record of the interface, by name."""
    values = {item.name: getattr(record, item.name) for item in fields(record)}
    return {name: value for name, value in values.items() if isinstance(value, np.ndarray)}


def _copies(mappings: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    return [{name: array.copy() for name, array in mapping.items()} for mapping in mappings]


def _assert_same(found: Sequence[Mapping[str, Any]], expected: Sequence[Mapping[str, Any]]) -> None:
    for one, other in zip(found, expected, strict=True):
        assert one.keys() == other.keys()
        for name in one:
            np.testing.assert_array_equal(one[name], other[name], err_msg=name)
