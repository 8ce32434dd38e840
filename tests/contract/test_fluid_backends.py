from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
import pytest
from scipy.sparse import identity

from rigidfluid.backends.dolfinx import Dolfinx
from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Advance, FluidState, Mesh, Response, Step, Wrench
from rigidfluid.testing import FluidBackendContract


class TestScikitFem(FluidBackendContract):
    backend = ScikitFem
    options: ClassVar[Mapping[str, Any]] = {"tolerance": 1e-12}


@pytest.mark.long
class TestScikitFemByBlocks(FluidBackendContract):
    backend = ScikitFem
    options: ClassVar[Mapping[str, Any]] = {"tolerance": 1e-11, "solver": "schur"}
    solver_tolerance = 1e-7

    @pytest.mark.skip(reason="a steady step has no inertia, by which this preconditioner masters convection")
    def test_flow_past_a_cylinder(self) -> None: ...


class TestDolfinx(FluidBackendContract):
    backend = Dolfinx
    options: ClassVar[Mapping[str, Any]] = {"tolerance": 1e-12}


class TestDolfinxBySchurComplement(FluidBackendContract):
    backend = Dolfinx
    options: ClassVar[Mapping[str, Any]] = {"tolerance": 1e-12, "solver": "schur"}
    solver_tolerance = 1e-7

    @pytest.mark.skip(reason="a steady step has no inertia, by which this preconditioner masters convection")
    def test_flow_past_a_cylinder(self) -> None: ...

    @pytest.mark.skip(reason="a steady step, as above")
    def test_convection_makes_no_energy(self) -> None: ...


class Changed(ScikitFem):
    """A backend whose steps are changed on the way in and out."""

    def given(self, fluid: FluidState, mesh: Mesh, step: Step) -> tuple[FluidState, Mesh, Step]:
        return fluid, mesh, step

    def found(self, advance: Advance) -> Advance:
        return advance

    def advance(self, fluid, mesh, step):
        return self.found(super().advance(*self.given(fluid, mesh, step)))


class Answering(ScikitFem):
    """A backend whose impulse responses are changed on the way in and out."""

    def asked(self, fluid: FluidState, step: Step, impulses: FloatArray) -> tuple[FluidState, Step, FloatArray]:
        return fluid, step, impulses

    def altered(self, response: Response, step: Step, impulses: FloatArray) -> Response:
        return response

    def response(self, fluid, mesh, step, impulses):
        changed = self.asked(fluid, step, impulses)
        return self.altered(super().response(changed[0], mesh, *changed[1:]), step, impulses)


class Overrunning(Changed):
    """Writes over what it is given."""

    def given(self, fluid, mesh, step):
        fluid["velocity"][:] *= 1.0 + 1e-6
        return fluid, mesh, step


class SteadyTwist(Changed):
    """Takes no notice of the twists given."""

    def given(self, fluid, mesh, step):
        return fluid, mesh, replace(step, prescribed_twist=np.zeros_like(step.prescribed_twist))


class FirstOrder(Changed):
    """BDF1 where BDF2 is asked for, in steps of one length."""

    def given(self, fluid, mesh, step):
        newest = step.derivative[0] / (1.5 if step.derivative[2] else 1.0)
        return fluid, mesh, replace(step, derivative=newest * np.array([1.0, -1.0, 0.0]))


class StillMesh(Changed):
    """Has the mesh at its new place all the time."""

    def given(self, fluid, mesh, step):
        return fluid, replace(mesh, points=step.points), step


class Heavy(Changed):
    """Weights of the time derivative that do not add up to zero."""

    def given(self, fluid, mesh, step):
        return fluid, mesh, replace(step, derivative=step.derivative * np.array([1.001, 1.0, 1.0]))


class Coarse(Changed):
    """Advected by a velocity that is linear in each cell."""

    def given(self, fluid, mesh, step):
        vertices = fluid["velocity"][: len(mesh.points)]
        return {**fluid, "velocity": self.numbering_of(mesh).node_points(vertices)}, mesh, step


class Unloaded(Changed):
    """Does not let anything push the bodies."""

    def given(self, fluid, mesh, step):
        return fluid, mesh, replace(step, load=np.zeros_like(step.load))


class Unmoved(Changed):
    """Takes no notice of the bodies' relative motion."""

    def given(self, fluid, mesh, step):
        at_rest = np.zeros((2, step.load.shape[1]))
        return fluid, mesh, replace(step, kinematics=replace(step.kinematics, relative_twist=at_rest))


class TurnedRound(Changed):
    """Torques of the wrong sign."""

    def found(self, advance):
        wrench = advance.hydrodynamic_wrench
        return replace(advance, hydrodynamic_wrench=Wrench(wrench.force, -wrench.torque))


class Overstated(Changed):
    """Forces that are too large by a thousandth."""

    def found(self, advance):
        wrench = advance.hydrodynamic_wrench
        return replace(advance, hydrodynamic_wrench=Wrench(1.001 * wrench.force, wrench.torque))


class Stingy(ScikitFem):
    """Fluxes that are too small by a millionth."""

    def __init__(self, options, problem):
        super().__init__(options, replace(problem, conditions=tuple(map(self.spared, problem.conditions))))

    def spared(self, condition):
        flux = condition.held_flux
        return condition if flux is None else replace(condition, held_flux=lambda time: (1.0 - 1e-6) * flux(time))


class Slackened(Changed):
    """Stresslets that are too small by a thousandth."""

    def found(self, advance):
        return advance if advance.stresslet is None else replace(advance, stresslet=0.999 * advance.stresslet)


class Pressing(Changed):
    """Forces on the boundary that are too large by a thousandth."""

    def found(self, advance):
        found = advance.boundary_forces
        return advance if found is None else replace(advance, boundary_forces=replace(found, force=1.001 * found.force))


class HalfDissipated(Changed):
    """|∇u|² in place of ½ |∇u + ∇uᵀ|² would be that in a channel."""

    def found(self, advance):
        return replace(advance, dissipation=0.5 * advance.dissipation)


class Hasty(Changed):
    """Tells of the end alone what is dissipated."""

    def found(self, advance):
        return replace(advance, dissipation_midway=advance.dissipation)


class Halved(Changed):
    """Tells of a first step what the mean velocity dissipates, not what the end's stress does in it."""

    def found(self, advance):
        return replace(advance, stress_power=advance.dissipation_midway)


class Closed(Changed):
    """Sees no power at the faces."""

    def found(self, advance):
        return replace(advance, boundary_power=0.0)


class Counting(Changed):
    """Remembers something outside the state."""

    steps = 0

    def found(self, advance):
        self.steps += 1
        return replace(advance, kinetic_energy=advance.kinetic_energy * (1.0 + 1e-15 * self.steps))


class Wordy(Changed):
    """Keeps something else than floats in the state."""

    def found(self, advance):
        return replace(advance, fluid={**advance.fluid, "position": advance.fluid["position"].astype(np.float32)})


class Hoarding(ScikitFem):
    """Keeps its caches."""

    def forget(self):
        pass


class Silent(ScikitFem):
    """Does not tell what energy a transfer loses."""

    def transfer(self, fluid, old, new):
        return super().transfer(fluid, old, new)[0], 0.0


class Confident(ScikitFem):
    """Extrapolates twice as far as is asked."""

    def prediction_error(self, before, after, mesh, extrapolation):
        return super().prediction_error(before, after, mesh, 2.0 * extrapolation)


class Late(ScikitFem):
    """Transfers the newer level alone."""

    def transfer(self, fluid, old, new):
        state, lost = super().transfer(fluid, old, new)
        return {**state, "velocity_previous": state["velocity"]}, lost


class Sluggish(ScikitFem):
    """Starts from rest whatever the bodies do."""

    def initial(self, mesh, pose, twist):
        return super().initial(mesh, pose, replace(twist, velocity=np.zeros_like(twist.velocity)))


class Restless(ScikitFem):
    """Starts with a little velocity."""

    def initial(self, mesh, pose, twist):
        state, energy = super().initial(mesh, pose, twist)
        return {**state, "velocity": state["velocity"] + 1e-12}, energy


class Blind(ScikitFem):
    """Sees nothing outside the box."""

    def probe(self, fluid, mesh, points):
        velocity, pressure = super().probe(fluid, mesh, points)
        return np.where(np.any(points > 1.0, axis=1)[:, None], 0.0, velocity), pressure


class Straight(ScikitFem):
    """Probes a velocity that is linear in each cell."""

    def probe(self, fluid, mesh, points):
        vertices = fluid["velocity"][: len(mesh.points)]
        return super().probe({**fluid, "velocity": self.numbering_of(mesh).node_points(vertices)}, mesh, points)


class Delayed(ScikitFem):
    """Shows the velocity of the step before."""

    def fields(self, fluid, mesh):
        return replace(super().fields(fluid, mesh), velocity=fluid["velocity_previous"])


class Disordered(ScikitFem):
    """Cells whose middle nodes come in another order."""

    def fields(self, fluid, mesh):
        fields = super().fields(fluid, mesh)
        order = [*range(mesh.cells.shape[1]), *reversed(range(mesh.cells.shape[1], fields.cells.shape[1]))]
        return replace(fields, cells=fields.cells[:, order])


class Stiffer(ScikitFem):
    """Extends with another matrix than the one given."""

    def extension(self, mesh, stiffness, held):
        return super().extension(mesh, stiffness + 0.01 * identity(len(held), format="csc"), held)


class Miscounting(ScikitFem):
    """Counts the unknowns without the bodies'."""

    def unknowns(self, mesh, prescribed):
        return super().unknowns(mesh, np.ones_like(prescribed))


class Weightless(Answering):
    """Answers at once with the bodies' own masses."""

    def altered(self, response, step, impulses):
        own = np.linalg.solve(step.mass_matrix / step.derivative[0], impulses[..., None])[..., 0]
        return replace(response, inviscid=np.where(step.prescribed[:, None], 0.0, own))


class Inviscid(Answering):
    """Answers in a step as at once."""

    def altered(self, response, step, impulses):
        return replace(response, viscous=response.inviscid)


class Forceful(Answering):
    """Takes the impulses for forces."""

    def altered(self, response, step, impulses):
        return replace(response, viscous=response.viscous / step.derivative[0])


class Recoiling(Answering):
    """Takes the forces on the bodies for those on the fluid."""

    def altered(self, response, step, impulses):
        return Response(-response.inviscid, -response.viscous)


class Twisted(Answering):
    """Turns the wrong way."""

    def altered(self, response, step, impulses):
        d = step.pose.position.shape[1]
        return Response(*(_turned_round(twists, d) for twists in (response.inviscid, response.viscous)))


class Saturated(Answering):
    """Answers less than twice to twice the impulse."""

    def altered(self, response, step, impulses):
        return Response(np.tanh(response.inviscid), np.tanh(response.viscous))


class Behind(Answering):
    """Answers on the mesh at the start of the step."""

    def response(self, fluid, mesh, step, impulses):
        return super().response(fluid, mesh, replace(step, points=mesh.points), impulses)


class Enlarged(Answering):
    """Sees the present mesh through a lens."""

    def asked(self, fluid, step, impulses):
        if step.points is not None:
            return fluid, step, impulses
        return fluid, replace(step, points=1.1 * fluid["points_previous"]), impulses


class Calm(Answering):
    """Answers without convection."""

    def asked(self, fluid, step, impulses):
        still = {name: np.zeros_like(fluid[name]) for name in ("velocity", "velocity_previous")}
        return {**fluid, **still}, step, impulses


class Released(Answering):
    """Lets go of the bodies that are driven."""

    def asked(self, fluid, step, impulses):
        return fluid, replace(step, prescribed=np.zeros_like(step.prescribed)), impulses


class Deaf(Answering):
    """Hears of impulses on the first body alone."""

    def asked(self, fluid, step, impulses):
        return fluid, step, impulses * (np.arange(impulses.shape[1]) == 0)[:, None]


class Scribbling(Answering):
    """Writes over the load."""

    def asked(self, fluid, step, impulses):
        step.load[:] += 1.0
        return fluid, step, impulses


class Leaking(ScikitFem):
    """Convects as if its velocities had no divergence anywhere."""

    def _matrix(self, discretisation, fluid, mesh, step):
        matrix = super()._matrix(discretisation, fluid, mesh, step)
        return replace(matrix, flow=np.zeros_like(matrix.flow))


class Absolute(ScikitFem):
    """Convects in the frame of whoever looks on."""

    def _matrix(self, discretisation, fluid, mesh, step):
        matrix = super()._matrix(discretisation, fluid, mesh, step)
        flow = matrix.flow + self.problem.inert_density * matrix.frame
        return replace(matrix, flow=flow, frame=np.zeros_like(matrix.frame))


class Silenced(ScikitFem):
    """Says nothing of what stabilisation takes."""

    def advance(self, fluid, mesh, step):
        return replace(super().advance(fluid, mesh, step), grad_div=0.0)


class Single(ScikitFem):
    """Knows a step by its time."""

    matrix = None

    def _matrix(self, discretisation, fluid, mesh, step):
        if self.matrix is None or self.matrix[0] != step.time:
            self.matrix = step.time, super()._matrix(discretisation, fluid, mesh, step)
        return self.matrix[1]


def _turned_round(twists: FloatArray, dimension: int) -> FloatArray:
    return np.concatenate([twists[..., :dimension], -twists[..., dimension:]], axis=-1)


@pytest.mark.parametrize(
    ("fault", "test", "arguments"),
    [
        (Overrunning, "test_a_step_changes_nothing_that_it_is_given", (2,)),
        (SteadyTwist, "test_newton_euler_holds_for_free_bodies", (2,)),
        (SteadyTwist, "test_the_power_that_drives_bodies_is_dissipated", (2, 0)),
        (FirstOrder, "test_order_in_time", (True,)),
        (StillMesh, "test_a_shear_flow_is_exact_on_a_mesh_in_motion", (2,)),
        (Heavy, "test_uniform_flow_stays_uniform_on_a_mesh_in_motion", (2,)),
        (Straight, "test_orders_in_space", (2,)),
        (Coarse, "test_flow_past_a_cylinder", ()),
        (Unloaded, "test_newton_euler_holds_for_free_bodies", (2,)),
        (TurnedRound, "test_the_power_that_drives_bodies_is_dissipated", (2, 1)),
        (TurnedRound, "test_fluid_and_bodies_accelerate_as_one", (3, False)),
        (Unmoved, "test_balls_of_one_motion_move_as_it_does_but_for_what_is_given", (2,)),
        (TurnedRound, "test_newton_euler_holds_for_the_whole", (2,)),
        (Overstated, "test_newton_euler_holds_for_the_whole", (3,)),
        (Unloaded, "test_newton_euler_holds_for_the_whole", (3,)),
        (Overstated, "test_force_balances_the_pressures", (2,)),
        (Stingy, "test_a_flux_that_is_held_is_driven_by_the_drop_of_poiseuille_flow", (2,)),
        (Stingy, "test_a_flux_that_changes_is_met_in_every_step", (2,)),
        (Slackened, "test_a_strain_works_on_stresslets", (2,)),
        (Pressing, "test_a_linear_flow_has_known_forces_on_faces", (2,)),
        (Pressing, "test_fluid_without_inertia_passes_on_all_forces", (2,)),
        (Overstated, "test_fluid_and_bodies_accelerate_as_one", (2, True)),
        (HalfDissipated, "test_flow_between_a_plane_of_symmetry_and_a_wall", (2, False)),
        (Hasty, "test_flow_between_a_plane_of_symmetry_and_a_wall", (2, False)),
        (Halved, "test_flow_between_a_plane_of_symmetry_and_a_wall", (2, True)),
        (HalfDissipated, "test_the_power_that_drives_bodies_is_dissipated", (2, 1)),
        (Closed, "test_energy_carried_through_the_faces", (2,)),
        (Leaking, "test_convection_makes_no_energy", (2,)),
        (Silenced, "test_convection_makes_no_energy", (2,)),
        (Absolute, "test_a_container_in_translation_changes_no_wrench", (2,)),
        (Counting, "test_going_on_from_a_checkpoint_is_bit_identical", (2,)),
        (Wordy, "test_the_state_is_a_flat_mapping_of_float_arrays", (2,)),
        (Hoarding, "test_going_on_from_a_checkpoint_is_bit_identical", (2,)),
        (Silent, "test_the_energy_lost_is_told", (2,)),
        (Confident, "test_a_prediction_error_is_kinetic_energy", (2,)),
        (Late, "test_a_linear_flow_is_kept", (2,)),
        (Late, "test_another_numbering_changes_nothing", (2,)),
        (Sluggish, "test_bodies_set_in_motion_take_fluid_along", (2,)),
        (Restless, "test_bodies_at_rest_leave_the_fluid_at_rest", (2,)),
        (Disordered, "test_cells_of_the_fields_fill_the_mesh", (3,)),
        (Stiffer, "test_an_extension_is_harmonic", (2,)),
        (Overrunning, "test_a_rejected_step_leaves_no_trace", (2,)),
        (Blind, "test_probes_outside_give_what_is_near", (2,)),
        (Delayed, "test_fields_are_what_probes_find", (2,)),
        (Miscounting, "test_a_free_body_has_its_twist_as_unknowns", (2,)),
        (Weightless, "test_a_disk_takes_its_own_volume_of_fluid_along", ()),
        (Twisted, "test_a_disk_takes_its_own_volume_of_fluid_along", ()),
        (Weightless, "test_an_ellipse_takes_more_along_across_than_along", ()),
        (Twisted, "test_an_ellipse_takes_more_along_across_than_along", ()),
        (Weightless, "test_two_disks_near_each_other", ()),
        (Weightless, "test_a_ball_takes_half_its_volume_of_fluid_along", ()),
        (Weightless, "test_in_a_short_step_masses_alone_count", ()),
        (Inviscid, "test_in_a_short_step_masses_alone_count", ()),
        (Forceful, "test_in_a_short_step_masses_alone_count", ()),
        (Recoiling, "test_responses_are_reciprocal", (2,)),
        (Twisted, "test_responses_are_reciprocal", (2,)),
        (Deaf, "test_responses_are_reciprocal", (2,)),
        (Saturated, "test_responses_add_up", (2,)),
        (Forceful, "test_a_step_responds_as_was_told", (2,)),
        (Inviscid, "test_a_step_responds_as_was_told", (2,)),
        (Recoiling, "test_a_step_responds_as_was_told", (2,)),
        (Behind, "test_a_step_responds_as_was_told", (2,)),
        (Calm, "test_a_step_responds_as_was_told", (2,)),
        (Inviscid, "test_without_inertia_of_the_fluid_it_only_drags", (2,)),
        (Forceful, "test_without_inertia_of_the_fluid_it_only_drags", (2,)),
        (Enlarged, "test_without_new_points_the_present_mesh_responds", (2,)),
        (Released, "test_prescribed_bodies_do_not_respond", (2,)),
        (Scribbling, "test_evaluating_responses_changes_nothing", (2,)),
        (Single, "test_one_step_from_another_state_is_another_one", (2,)),
    ],
)
def test_the_contract_refuses(fault: type[ScikitFem], test: str, arguments: tuple[Any, ...]) -> None:
    class Faulty(TestScikitFem):
        backend = fault

    with pytest.raises(AssertionError):
        getattr(Faulty(), test)(*arguments)


def test_a_backend_without_its_packages_is_skipped() -> None:
    class Absent(ScikitFem):
        requires: ClassVar = {"a_package_that_is_not_there": "that-package"}

    class Contract(FluidBackendContract):
        backend = Absent

    with pytest.raises(pytest.skip.Exception, match="install that-package"):
        Contract().skip_without_packages()
