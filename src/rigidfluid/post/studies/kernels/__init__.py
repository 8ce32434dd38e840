"""Small calculations with an exact answer, for studies; one file each."""

from __future__ import annotations

from rigidfluid.post.studies.kernels.detector_gaps import DetectorGaps
from rigidfluid.post.studies.kernels.kernel import Kernel
from rigidfluid.post.studies.kernels.ring_distance import RingDistance

KERNELS: dict[str, type[Kernel]] = {"distance-field": RingDistance, "detector": DetectorGaps}
"""Kernel by its name in a study."""
