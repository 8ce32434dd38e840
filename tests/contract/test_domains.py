"""Every built-in domain, and the one of the page on plug-ins, satisfy the contract."""

import numpy as np
import pytest
from annulus import annulus
from dish import dish
from drawn import bent_tube, drawn, plate
from facet_domain import room
from mesh_files import meshed, write_by_meshio, write_gmsh41
from mesh_tools import nobody
from wedge import wedge

from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.nested.bodies import NestedBodyTable
from rigidfluid.domains.box import Box, BoxOptions
from rigidfluid.domains.channel import Channel, ChannelOptions
from rigidfluid.domains.stenosis import Stenosis, StenosisOptions
from rigidfluid.testing import DomainContract


class TestBox(DomainContract):
    @pytest.fixture(params=[2, 3])
    def domain(self, request):
        corners = {"lower": (-1.0, 0.5, 2.0)[: request.param], "upper": (1.0, 1.5, 2.7)[: request.param]}
        return Box(BoxOptions(**corners), request.param)


DISK = {"type": "sphere", "radius": 0.2, "position": (0.4, 1.0)}
EGG = {"name": "egg", "type": "ellipsoid", "semi_axes": (0.3, 0.15), "angle": 0.5, "position": (-0.4, 0.9)}
TURNED = {
    "type": "ellipsoid",
    "semi_axes": (0.3, 0.25, 0.25),
    "orientation": (0.9, 0.1, 0.2, 0.4),
    "position": (-0.4, 1.0, 2.5),
}


def channel(*obstacles):
    d = len(obstacles[0]["position"])
    corners = {"lower": (-1.0, 0.5, 2.0)[:d], "upper": (1.0 if d == 2 else 0.2, 1.5, 3.0)[:d]}
    return Channel(ChannelOptions(**corners, obstacle=tuple(NestedBodyTable(**one) for one in obstacles)), d)


class TestChannel(DomainContract):
    coarse = 0.02

    @pytest.fixture
    def domain(self):
        return channel(DISK, EGG)


class TestChannelInSpace(DomainContract):
    coarse = 0.09

    @pytest.fixture
    def domain(self):
        return channel(TURNED)


class TestStenosis(DomainContract):
    coarse = 0.02

    @pytest.fixture(params=[{}, {"throat": 0.6}, {"throat": 0.2}], ids=["half disks", "flatter", "rounder"])
    def domain(self, request):
        return Stenosis(StenosisOptions(length=4.0, width=1.0, radius=0.3, **request.param), 2)


class TestBentTubeFromStep(DomainContract):
    coarse = 0.07

    @pytest.fixture(scope="class")
    @classmethod
    def domain(cls, tmp_path_factory):
        folder = tmp_path_factory.mktemp("domain")
        return drawn(bent_tube(), folder)


class TestPlateFromStep(DomainContract):
    coarse = 0.03

    @pytest.fixture(scope="class")
    @classmethod
    def domain(cls, tmp_path_factory):
        folder = tmp_path_factory.mktemp("domain")
        return drawn(plate(), folder, 2)


class TestBentTubeFromMesh(DomainContract):
    coarse = 0.1

    @pytest.fixture(scope="class")
    @classmethod
    def domain(cls, tmp_path_factory):
        folder = tmp_path_factory.mktemp("domain")
        tube = drawn(bent_tube(), folder)
        mesh = generate_mesh(FluidDomain([], nobody(3), tube, ()), Sizes(1.0, 1.0, 0.3))
        write_gmsh41(folder / "tube.msh", mesh, tube.names)
        return meshed(folder / "tube.msh")


class TestPlateFromMesh(DomainContract):
    coarse = 0.1

    @pytest.fixture(scope="class")
    @classmethod
    def domain(cls, tmp_path_factory):
        folder = tmp_path_factory.mktemp("domain")
        sheet = drawn(plate(), folder, 2)
        mesh = generate_mesh(FluidDomain([], nobody(2), sheet, ()), Sizes(0.4, 0.4, 0.3))
        write_by_meshio(folder / "plate.med", mesh, sheet.names)
        return meshed(folder / "plate.med", 2)


class TestDish(DomainContract):
    @pytest.fixture(params=[2, 3])
    def domain(self, request):
        return dish(1.0, request.param)


class TestWedge(DomainContract):
    @pytest.fixture
    def domain(self):
        return wedge()


class TestAnnulus(DomainContract):
    """Netgen makes edges on the hub as short as its radius asks for, however coarse a mesh is asked for."""

    @pytest.fixture(params=[(2, 0.3), (2, 0.05), (3, 0.3)], ids=["2D", "thin hub", "3D"])
    def domain(self, request):
        return annulus(*request.param)


ROOMS = {
    "trapezoid": [(0.0, 0.0), (1.3, 0.0), (2.0, 1.0), (-0.4, 1.0)],
    "L": [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)],
}


class TestRoomsOfFacets(DomainContract):
    """Pieces by `FacetSurface.piece`: flat ones, some of whose planes go on inside; the options are all alike."""

    @pytest.fixture(params=ROOMS)
    def domain(self, request):
        return room(ROOMS[request.param])


class _Lying(Box):
    """A box of which one thing is not true."""

    def __init__(self, what):
        super().__init__(BoxOptions(lower=(0.0, 0.0), upper=(1.0, 1.0)), 2)
        self.what = what

    @property
    def pieces(self):
        first, *others = super().pieces
        if self.what == "normal":
            first = Piece(first.name, Plane(first.shape.point, -first.shape.unit_normal), first.area)
        if self.what in ("area", "one per cent of area"):
            first = Piece(first.name, first.shape, 2.0 if self.what == "area" else 1.01)
        if self.what == "name":
            first = Piece(others[0].name, first.shape, first.area)
        return (first, *others)

    @property
    def volume(self):
        return 1.0 if self.what != "volume" else 1.1

    def contains(self, points):
        return super().contains(points if self.what != "contains" else points - 0.1)


@pytest.mark.parametrize(
    ("what", "test"),
    [
        ("normal", "test_the_fluid_is_where_normals_point"),
        ("area", "test_volume_and_areas_are_those_of_fine_meshes"),
        ("one per cent of area", "test_volume_and_areas_are_those_of_fine_meshes"),
        ("volume", "test_volume_and_areas_are_those_of_fine_meshes"),
        ("contains", "test_the_fluid_is_where_normals_point"),
        ("name", "test_names_are_names"),
    ],
)
def test_the_contract_sees_what_is_not_true(what, test):
    domain, contract = _Lying(what), DomainContract()
    arguments = [domain]
    if test != "test_names_are_names":
        arguments.append(DomainContract.meshes.__wrapped__(contract, Box(domain.options, 2)))
    with pytest.raises(AssertionError):
        getattr(contract, test)(*arguments)


def test_a_piece_has_the_distance_of_its_plane():
    bottom = Box(BoxOptions(lower=(0.0, -1.0), upper=(1.0, 1.0)), 2).pieces[2]
    np.testing.assert_array_equal(bottom.shape.signed_distance(np.array([[7.0, 1.5]])), [2.5])
