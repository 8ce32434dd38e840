from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from touching import unstacked

from rigidfluid.core.contact.laws.film_loss import FilmLoss
from rigidfluid.core.contact.laws.friction import Friction, Rubbing
from rigidfluid.core.contact.laws.repulsion import Repulsion
from rigidfluid.core.contact.laws.restitution import Restitution
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.coulomb import TurningFriction
from rigidfluid.core.model.force_law import Between, ForceLaw, Overlap, Sign
from rigidfluid.core.model.interactions import Interaction, SumOfLaws
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Film
from rigidfluid.forces.barrier import BarrierLaw
from rigidfluid.forces.centre import CentreLaw
from rigidfluid.forces.contact import ContactPointLaw
from rigidfluid.forces.lubrication import LubricationLaw, LubricationOptions
from rigidfluid.forces.normal import NormalLaw
from rigidfluid.forces.spring_dashpot import SpringDashpotLaw, SpringDashpotOptions
from rigidfluid.forces.van_der_waals import VanDerWaalsLaw, VanDerWaalsOptions
from rigidfluid.testing import ForceLawContract

RANGE = 0.02
LOADS = unstacked(np.array([2.0, 3.0]), np.array([5.0, 0.0]), np.array([1.0, 4.0]), smallest_gap=0.3 * RANGE)
EPSILONS = {
    "one epsilon": {"epsilon": 5e-6},
    "wall epsilon": {"epsilon": 5e-6, "epsilon_wall": 2e-6},
    "auto": {"epsilon": "auto"},
    "auto at walls": {"epsilon": 5e-6, "epsilon_wall": "auto"},
}


class TestRepulsions(ForceLawContract):
    @pytest.fixture(params=[CentreLaw, ContactPointLaw, NormalLaw, BarrierLaw], ids=lambda part: part.name)
    def part(self, request: pytest.FixtureRequest) -> type[Repulsion]:
        return request.param

    @pytest.fixture(params=EPSILONS.values(), ids=EPSILONS)
    def law(self, part: type[Repulsion], request: pytest.FixtureRequest) -> ForceLaw:
        return part(part.Options(**request.param), RANGE, LOADS)


class TestRestitution(ForceLawContract):
    @pytest.fixture(params=[CentreLaw, ContactPointLaw, NormalLaw, BarrierLaw], ids=lambda part: part.name)
    def repulsion(self, request: pytest.FixtureRequest) -> ForceLaw:
        return request.param(request.param.Options(epsilon=5e-6), RANGE)

    @pytest.fixture(params=["of its own", "by the Stokes number"])
    def law(self, repulsion: ForceLaw, request: pytest.FixtureRequest) -> ForceLaw:
        film = Film(Newtonian(0.1), np.array([0.7, 0.4]), 0.01, True)
        return Restitution(repulsion, 0.5, None if request.param == "of its own" else FilmLoss(35.0, film, LOADS))


class TestFriction(ForceLawContract):
    @pytest.fixture(params=[CentreLaw, ContactPointLaw, NormalLaw, BarrierLaw], ids=lambda part: part.name)
    def repulsion(self, request: pytest.FixtureRequest) -> ForceLaw:
        return request.param(request.param.Options(epsilon=5e-6), RANGE)

    @pytest.fixture(params=[None, 3e3], ids=["stiffness of the law", "given stiffness"])
    def stiffness(self, request: pytest.FixtureRequest) -> float | None:
        return request.param

    @pytest.fixture(params=[0.0, 0.1], ids=["sliding", "rolling"])
    def law(self, repulsion: ForceLaw, stiffness: float | None, request: pytest.FixtureRequest) -> ForceLaw:
        turning = TurningFriction(request.param, 0.5 * request.param)
        return Friction(Restitution(repulsion, 0.5), Rubbing(0.4, stiffness, 1.0, 0.3 * RANGE, turning))


class TestSpringDashpot(ForceLawContract):
    @pytest.fixture(
        params=[
            {"restitution": 0.6, "friction": 0.4},
            {"damping": 30.0, "friction": 0.1, "tangential_damping": 0.5},
            {"damping": 30.0, "friction": 0.1, "tangential_stiffness": 7e3},
            {"damping": 30.0, "friction": 0.1, "tangential_stiffness": 7e3, "rolling_friction": 0.1},
            {"damping": 30.0, "friction": 0.1, "tangential_stiffness": 7e3, "rolling_friction": 0.1}
            | {"twisting_friction": 0.2},
        ],
        ids=["restitution", "damping", "sticking", "rolling", "twisting"],
    )
    def law(self, request: pytest.FixtureRequest) -> ForceLaw:
        return SpringDashpotLaw(SpringDashpotOptions(stiffness=1e4, **request.param), RANGE)


class TestSum(ForceLawContract):
    """Laws for all contacts, walls, pairs and one pair, side by side, of different ranges."""

    @pytest.fixture(params=["repulsions", "beside dampers"])
    def law(self, request: pytest.FixtureRequest) -> ForceLaw:
        normal = NormalLaw(NormalLaw.Options(epsilon=5e-6), RANGE)
        if request.param == "repulsions":
            laws = (normal, "all", ()), (CentreLaw(CentreLaw.Options(epsilon=2e-6), 0.63 * RANGE), "walls", ())
        else:
            options = LubricationOptions(viscosity=0.1, cutoff=0.1 * RANGE, sliding=True)
            film = LubricationLaw(options, 0.63 * RANGE)
            spring = SpringDashpotLaw(SpringDashpotOptions(stiffness=1e4, restitution=0.6, friction=0.4), RANGE)
            laws = (normal, "all", ()), (film, "pairs", ()), (spring, "all", (0, 1))
        return SumOfLaws([Interaction("interaction", *law) for law in laws])


class TestLubrication(ForceLawContract):
    @pytest.fixture(params=[True, False], ids=["sliding", "squeezing"])
    def law(self, request: pytest.FixtureRequest) -> ForceLaw:
        return LubricationLaw(LubricationOptions(viscosity=0.1, cutoff=0.1 * RANGE, sliding=request.param), RANGE)


class TestLubricationOfEllipsoids(ForceLawContract):
    """Beside balls, by curvature tensors."""

    @pytest.fixture
    def law(self) -> ForceLaw:
        return LubricationLaw(LubricationOptions(viscosity=0.1, cutoff=0.1 * RANGE, sliding=True), RANGE)

    def make_contacts(self, gap: FloatArray, dimension: int) -> Contacts:
        contacts = super().make_contacts(gap, dimension)
        across = np.eye(dimension) - contacts.normal[:, :, None] * contacts.normal[:, None, :]
        radii = np.column_stack([contacts.radius_a, contacts.radius_b])
        tensors = across[:, None] / radii[:, :, None, None]
        shape = np.random.default_rng(1).normal(size=tensors.shape)
        tensors[::2] += (across[:, None] @ shape @ np.swapaxes(shape, 2, 3) @ across[:, None])[::2]
        lost = np.where(np.arange(len(gap) * 2) % 2 == 0, np.nan, contacts.radius_a)
        whole = tensors.sum(axis=1)
        trace = np.trace(whole, axis1=1, axis2=2)
        square = 0.5 * (trace**2 - np.sum(whole**2, axis=(1, 2)))
        radius = 1.0 / trace if dimension == 2 else np.sqrt(2.0 / (trace * np.sqrt(square)))
        return replace(contacts, radius_a=lost, effective_radius=radius, curvatures=tensors)


class Declared(ForceLaw):
    """F = w n, a formula to derive others from."""

    name: ClassVar[str] = "declared"

    def along(self, contacts: Contacts) -> FloatArray:
        return self.range - contacts.gap

    def force(self, contacts: Contacts) -> FloatArray:
        return np.where(contacts.gap < self.range, self.along(contacts), 0.0)[:, None] * contacts.normal

    def energy(self, contacts: Contacts) -> FloatArray:
        return 0.5 * np.maximum(self.range - contacts.gap, 0.0) ** 2

    def stiffness(self, contacts: Contacts) -> FloatArray:
        return np.where(contacts.gap < self.range, 1.0, 0.0)


class Attractive(Declared):
    sign: Sign = "attracts"
    overlap: Overlap = "attracts"

    def along(self, contacts: Contacts) -> FloatArray:
        return contacts.gap - self.range

    def energy(self, contacts: Contacts) -> FloatArray:
        return -super().energy(contacts)

    def stiffness(self, contacts: Contacts) -> FloatArray:
        return -super().stiffness(contacts)


class SoftWall(Declared):
    """An energy of finite height, flat in overlap."""

    overlap: Overlap = "either"

    def force(self, contacts: Contacts) -> FloatArray:
        return (contacts.gap > 0.0)[:, None] * super().force(contacts)

    def energy(self, contacts: Contacts) -> FloatArray:
        return np.minimum(super().energy(contacts), 0.5 * self.range**2)

    def stiffness(self, contacts: Contacts) -> FloatArray:
        return (contacts.gap > 0.0) * super().stiffness(contacts)


class PairsOnly(Declared):
    acts_in: Between = "pairs"

    def force(self, contacts: Contacts) -> FloatArray:
        return ~contacts.at_wall[:, None] * super().force(contacts)

    def energy(self, contacts: Contacts) -> FloatArray:
        return ~contacts.at_wall * super().energy(contacts)

    def stiffness(self, contacts: Contacts) -> FloatArray:
        return ~contacts.at_wall * super().stiffness(contacts)


class WallsOnly(PairsOnly):
    acts_in: Between = "walls"

    def force(self, contacts: Contacts) -> FloatArray:
        return contacts.at_wall[:, None] * Declared.force(self, contacts)

    def energy(self, contacts: Contacts) -> FloatArray:
        return contacts.at_wall * Declared.energy(self, contacts)

    def stiffness(self, contacts: Contacts) -> FloatArray:
        return contacts.at_wall * Declared.stiffness(self, contacts)


class Constant(Declared):
    """A force that begins at once."""

    vanishes_at_range: bool = False

    def along(self, contacts: Contacts) -> FloatArray:
        return np.full(len(contacts), self.range)

    def energy(self, contacts: Contacts) -> FloatArray:
        return self.range * np.maximum(self.range - contacts.gap, 0.0)

    def stiffness(self, contacts: Contacts) -> FloatArray:
        return np.zeros(len(contacts))


class TestDeclared(ForceLawContract):
    @pytest.fixture(
        params=[Declared, Attractive, SoftWall, PairsOnly, WallsOnly, Constant], ids=lambda law: law.__name__
    )
    def law(self, request: pytest.FixtureRequest) -> ForceLaw:
        return request.param(PartOptions(), RANGE)


@pytest.mark.parametrize(
    ("law", "key", "wrong"),
    [
        (Attractive, "sign", "repels"),
        (Declared, "sign", "attracts"),
        (SoftWall, "overlap", "repels"),
        (Declared, "overlap", "attracts"),
        (PairsOnly, "acts_in", "all"),
        (WallsOnly, "acts_in", "pairs"),
        (Constant, "vanishes_at_range", True),
        (Declared, "vanishes_at_range", False),
    ],
)
def test_a_wrong_declaration_fails(law: type[ForceLaw], key: str, wrong: object) -> None:
    one, contract = law(PartOptions(), RANGE), ForceLawContract()
    tests = (
        contract.test_continuous_at_range,
        contract.test_acts_along_the_normal_as_it_declares,
        contract.test_does_in_overlap_what_it_declares,
        contract.test_has_the_kinds_of_force_that_it_declares,
    )
    for test in tests:
        test(one, 2)
    setattr(one, key, wrong)
    failed = 0
    for test in tests:
        try:
            test(one, 2)
        except AssertionError:
            failed += 1
    assert failed


class TestVanDerWaals(ForceLawContract):
    @pytest.fixture
    def law(self) -> ForceLaw:
        return VanDerWaalsLaw(VanDerWaalsOptions(hamaker=1.0, cutoff=0.1 * RANGE), RANGE)
