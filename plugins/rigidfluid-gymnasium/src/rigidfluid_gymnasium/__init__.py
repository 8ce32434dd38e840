"""Bodies in a fluid as environments of Gymnasium: actions, observations, reward, branching, processes."""

from __future__ import annotations

from rigidfluid_gymnasium.actions import Action, AppliedWrench, PrescribedTwist
from rigidfluid_gymnasium.boundary_factor import BoundaryFactor
from rigidfluid_gymnasium.course import Course
from rigidfluid_gymnasium.env import EnvState, FluidEnv
from rigidfluid_gymnasium.joint_drive import JointDrive
from rigidfluid_gymnasium.observations import BodyValue, JointValue, Observation, ProbeValue
from rigidfluid_gymnasium.processes import SingleThreaded, parallel_envs
from rigidfluid_gymnasium.task import Moment, Task

__all__ = [
    "Action",
    "AppliedWrench",
    "BodyValue",
    "BoundaryFactor",
    "Course",
    "EnvState",
    "FluidEnv",
    "JointDrive",
    "JointValue",
    "Moment",
    "Observation",
    "PrescribedTwist",
    "ProbeValue",
    "SingleThreaded",
    "Task",
    "parallel_envs",
]
