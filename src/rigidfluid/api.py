"""The public face: all that a program, a plug-in or an example imports, besides `rigidfluid.testing` for its tests.

Scenes and runs, the interfaces of parts and the records that go through them, the marker by which a plug-in offers its
parts, and the errors. Names elsewhere may move without notice, but for `rigidfluid.taylor_hood`, which backends of
elements P2–P1 may build on.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from rigidfluid.backends.dolfinx import Dolfinx
from rigidfluid.backends.dolfinx.options import DolfinxOptions
from rigidfluid.backends.dry import Dry
from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.bodies.ellipsoid import Ellipsoid, EllipsoidOptions
from rigidfluid.bodies.polygon import Polygon, PolygonOptions
from rigidfluid.bodies.polyhedron import Polyhedron, PolyhedronOptions
from rigidfluid.bodies.sphere import Sphere, SphereOptions
from rigidfluid.core.case.load import load_scene, scene_from_dict
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.case.system import build_system
from rigidfluid.core.contact.laws.repulsion import Repulsion, RepulsionOptions
from rigidfluid.core.fluid.conditions import (
    BoundaryCondition,
    NoSlip,
    Periodic,
    PrescribedPressure,
    PrescribedVelocity,
    Slip,
)
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.fluid.material import Material, Newtonian
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.geometry.mesher_unit import in_unit
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.surface import Plane, Surface
from rigidfluid.core.geometry.wall import Wall, require_plane
from rigidfluid.core.joints.along_coordinate import CoordinateDamper, CoordinateSpring, DrivenCoordinate
from rigidfluid.core.joints.constraints import (
    Constraint,
    OnAxis,
    RotationDamper,
    SameAxis,
    SameOrientation,
    SamePoint,
)
from rigidfluid.core.joints.coordinates import Angle, Coordinate, Displacement, Drive
from rigidfluid.core.joints.joint import Joint
from rigidfluid.core.joints.markers import MarkerPair, PlacedPair, axes_along
from rigidfluid.core.joints.springs import Spring
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.mechanics.strokes import Stroke
from rigidfluid.core.mesh.flow import AtRest, Flow
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.size_interface import SizeField
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.kinematics import Kinematics
from rigidfluid.core.model.mechanism import Component, Mechanism
from rigidfluid.core.model.pair_formula import PairFormula, PairSprings
from rigidfluid.core.model.part import Part, PartOptions
from rigidfluid.core.model.pose_law import PairPoses, PoseLaw
from rigidfluid.core.model.selected import Selected
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import (
    Advance,
    Contacts,
    Fields,
    FluidState,
    InsideFields,
    Loads,
    Mesh,
    Motion,
    Pose,
    Response,
    SolverCost,
    Step,
    Twist,
    Wrench,
)
from rigidfluid.core.nested.bodies import NestedBodyTable, build_shape, check_length, tables_by_name
from rigidfluid.core.nested.placing import initial_pose
from rigidfluid.core.nested.strokes import build_stroke
from rigidfluid.core.scene.body_tables import PrescribedTable
from rigidfluid.core.scene.domain_table import WindowTable
from rigidfluid.core.scene.joint_tables import SpringTable
from rigidfluid.core.scene.mesh_tables import MeshTable, RefineTable, WakeTable
from rigidfluid.core.scene.rows_over_time import StrokeTable, TimeFileTable
from rigidfluid.core.scene.run_tables import OutputTable, TimeTable
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.scene.table import Positive
from rigidfluid.core.scene.vectors import Vector
from rigidfluid.core.setup.contact_laws import ContactLaw
from rigidfluid.core.setup.fluid import Fluid, NoFluid
from rigidfluid.core.setup.model import ConditionMaker, ContactStepping, Model
from rigidfluid.core.setup.pair_forces import PairForce
from rigidfluid.core.setup.rigid_body import JoinedBodies, PlacedMechanism, RigidBody
from rigidfluid.core.setup.scalar import Scalar, ScalarOnSurface
from rigidfluid.detectors.brute_force import BruteForceDetector, BruteForceOptions
from rigidfluid.detectors.ellipsoid import EllipsoidDetector
from rigidfluid.detectors.facets import FacetDetector
from rigidfluid.detectors.fast_marching import FastMarchingDetector
from rigidfluid.detectors.narrow_band import NarrowBandDetector, NarrowBandOptions
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.domains.box import Box, BoxOptions
from rigidfluid.domains.cad import Cad, CadOptions
from rigidfluid.domains.channel import Channel, ChannelOptions
from rigidfluid.domains.mesh import MeshDomain, MeshOptions
from rigidfluid.domains.obstacles import Obstacles
from rigidfluid.domains.stenosis import Stenosis, StenosisOptions
from rigidfluid.errors import (
    ArgumentError,
    MeshError,
    OutputError,
    PluginError,
    RigidfluidError,
    RunWarning,
    SceneError,
    SceneErrors,
    StepError,
    StepRejected,
)
from rigidfluid.forces.barrier import BarrierLaw, BarrierOptions
from rigidfluid.forces.centre import CentreLaw, CentreOptions
from rigidfluid.forces.contact import ContactPointLaw, ContactPointOptions
from rigidfluid.forces.dipole import DipoleLaw, DipoleOptions
from rigidfluid.forces.lubrication import LubricationLaw, LubricationOptions
from rigidfluid.forces.normal import NormalLaw, NormalOptions
from rigidfluid.forces.spring_dashpot import SpringDashpotLaw, SpringDashpotOptions
from rigidfluid.forces.van_der_waals import VanDerWaalsLaw, VanDerWaalsOptions
from rigidfluid.hookspecs import hookimpl
from rigidfluid.joints.ball import Ball, BallOptions
from rigidfluid.joints.hinge import Hinge, HingeOptions
from rigidfluid.joints.rod import Rod
from rigidfluid.joints.slider import Slider, SliderOptions
from rigidfluid.marching.options import MarchingOptions
from rigidfluid.materials.bingham import Bingham, BinghamOptions
from rigidfluid.materials.carreau import Carreau, CarreauOptions
from rigidfluid.materials.cross import Cross, CrossOptions
from rigidfluid.materials.expression import ExpressionMaterial, ExpressionOptions
from rigidfluid.materials.herschel_bulkley import HerschelBulkley, HerschelBulkleyOptions
from rigidfluid.materials.power_law import PowerLaw, PowerLawOptions
from rigidfluid.mechanisms.articulated import Articulated, ArticulatedOptions, RelativeStrokeTable
from rigidfluid.mechanisms.components import ComponentTable, build_components
from rigidfluid.mechanisms.strokes import (
    MovingComponents,
    RigidDisplacement,
    Rotation,
    StrokedMechanism,
    Translation,
)
from rigidfluid.mechanisms.three_sphere_swimmer import ThreeSphereSwimmer, ThreeSphereSwimmerOptions
from rigidfluid.registry import (
    BODY,
    DETECTOR,
    DOMAIN,
    FLUID_BACKEND,
    FORCE_LAW,
    JOINT,
    MATERIAL,
    MECHANISM,
    SIZE_FIELD,
    Registry,
    missing_packages,
)
from rigidfluid.size_fields.vorticity import Vorticity, VorticityOptions
from rigidfluid.taylor_hood.sparse_backend import SparseOptions

if TYPE_CHECKING:
    from rigidfluid.core.output.fluid_fields import FluidFields
    from rigidfluid.core.output.history import History
    from rigidfluid.core.run.body_now import BodyNow
    from rigidfluid.core.run.run import Progress, run
    from rigidfluid.core.run.saved_run import SavedRun
    from rigidfluid.core.run.simulation import Simulation
    from rigidfluid.post.notebook import NotebookProgress
    from rigidfluid.post.run_results import RunResults, load_results
    from rigidfluid.post.statistics.measure import measure_statistics

__all__ = [
    "BODY",
    "DETECTOR",
    "DOMAIN",
    "FLUID_BACKEND",
    "FORCE_LAW",
    "JOINT",
    "MATERIAL",
    "MECHANISM",
    "SIZE_FIELD",
    "Advance",
    "Angle",
    "ArgumentError",
    "Articulated",
    "ArticulatedOptions",
    "AtRest",
    "Ball",
    "BallOptions",
    "BarrierLaw",
    "BarrierOptions",
    "Bingham",
    "BinghamOptions",
    "Body",
    "BodyNow",
    "BoolArray",
    "BoundaryCondition",
    "Box",
    "BoxOptions",
    "BruteForceDetector",
    "BruteForceOptions",
    "Cad",
    "CadOptions",
    "Carreau",
    "CarreauOptions",
    "CentreLaw",
    "CentreOptions",
    "Channel",
    "ChannelOptions",
    "Component",
    "ComponentTable",
    "ConditionMaker",
    "Constraint",
    "ContactLaw",
    "ContactPointLaw",
    "ContactPointOptions",
    "ContactStepping",
    "Contacts",
    "Coordinate",
    "CoordinateDamper",
    "CoordinateSpring",
    "Cross",
    "CrossOptions",
    "Detector",
    "DipoleLaw",
    "DipoleOptions",
    "Displacement",
    "Dolfinx",
    "DolfinxOptions",
    "Domain",
    "Drive",
    "DrivenCoordinate",
    "Dry",
    "Ellipsoid",
    "EllipsoidDetector",
    "EllipsoidOptions",
    "ExpressionMaterial",
    "ExpressionOptions",
    "FacetDetector",
    "FacetSurface",
    "Facets",
    "FastMarchingDetector",
    "Fields",
    "FloatArray",
    "Flow",
    "Fluid",
    "FluidBackend",
    "FluidDomain",
    "FluidFields",
    "FluidProblem",
    "FluidState",
    "ForceLaw",
    "GeneralisedNewtonian",
    "HerschelBulkley",
    "HerschelBulkleyOptions",
    "Hinge",
    "HingeOptions",
    "History",
    "InsideFields",
    "IntArray",
    "JoinedBodies",
    "Joint",
    "Kinematics",
    "Loads",
    "LubricationLaw",
    "LubricationOptions",
    "MarchingOptions",
    "MarkerPair",
    "Material",
    "Mechanism",
    "Mesh",
    "MeshDomain",
    "MeshError",
    "MeshOptions",
    "MeshTable",
    "Model",
    "Motion",
    "MovingComponents",
    "NarrowBandDetector",
    "NarrowBandOptions",
    "NestedBodyTable",
    "Newtonian",
    "NoFluid",
    "NoSlip",
    "NormalLaw",
    "NormalOptions",
    "NotebookProgress",
    "Obstacles",
    "OnAxis",
    "OutputError",
    "OutputTable",
    "PairForce",
    "PairFormula",
    "PairPoses",
    "PairSprings",
    "Part",
    "PartOptions",
    "Periodic",
    "Piece",
    "PlacedMechanism",
    "PlacedPair",
    "Plane",
    "PluginError",
    "Polygon",
    "PolygonOptions",
    "Polyhedron",
    "PolyhedronOptions",
    "Pose",
    "PoseLaw",
    "Positive",
    "PowerLaw",
    "PowerLawOptions",
    "PrescribedPressure",
    "PrescribedTable",
    "PrescribedVelocity",
    "Progress",
    "RefineTable",
    "Registry",
    "RelativeStrokeTable",
    "Repulsion",
    "RepulsionOptions",
    "Response",
    "RigidBody",
    "RigidDisplacement",
    "RigidfluidError",
    "Rod",
    "Rotation",
    "RotationDamper",
    "RunResults",
    "RunWarning",
    "SameAxis",
    "SameOrientation",
    "SamePoint",
    "SavedRun",
    "Scalar",
    "ScalarOnSurface",
    "Scene",
    "SceneError",
    "SceneErrors",
    "ScikitFem",
    "Selected",
    "Simulation",
    "SizeField",
    "Slider",
    "SliderOptions",
    "Slip",
    "SolverCost",
    "SparseOptions",
    "Sphere",
    "SphereDetector",
    "SphereOptions",
    "Spring",
    "SpringDashpotLaw",
    "SpringDashpotOptions",
    "SpringTable",
    "Stenosis",
    "StenosisOptions",
    "Step",
    "StepError",
    "StepRejected",
    "Stroke",
    "StrokeTable",
    "StrokedMechanism",
    "Surface",
    "System",
    "ThreeSphereSwimmer",
    "ThreeSphereSwimmerOptions",
    "TimeFileTable",
    "TimeTable",
    "Translation",
    "Twist",
    "VanDerWaalsLaw",
    "VanDerWaalsOptions",
    "Vector",
    "Vorticity",
    "VorticityOptions",
    "WakeTable",
    "Wall",
    "WindowTable",
    "Wrench",
    "axes_along",
    "build_components",
    "build_shape",
    "build_stroke",
    "build_system",
    "check_length",
    "hookimpl",
    "in_unit",
    "initial_pose",
    "load_results",
    "load_scene",
    "measure_statistics",
    "missing_packages",
    "model_of",
    "require_plane",
    "rotation_matrices",
    "run",
    "scene_from_dict",
    "suggestion",
    "tables_by_name",
]


def __dir__() -> list[str]:
    """Names of the module, with those that are imported on first use."""
    return sorted({*globals(), *__all__})


def __getattr__(name: str) -> object:
    """Import runs and their results on first use: plug-ins are imported at every start and need no loop."""
    if name not in _LOOP:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_LOOP[name]), name)


_LOOP = {
    "BodyNow": "rigidfluid.core.run.body_now",
    "FluidFields": "rigidfluid.core.output.fluid_fields",
    "History": "rigidfluid.core.output.history",
    "NotebookProgress": "rigidfluid.post.notebook",
    "Progress": "rigidfluid.core.run.run",
    "RunResults": "rigidfluid.post.run_results",
    "SavedRun": "rigidfluid.core.run.saved_run",
    "Simulation": "rigidfluid.core.run.simulation",
    "load_results": "rigidfluid.post.run_results",
    "measure_statistics": "rigidfluid.post.statistics.measure",
    "run": "rigidfluid.core.run.run",
}
