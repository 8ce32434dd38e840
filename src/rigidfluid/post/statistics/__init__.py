"""Statistics of many bodies: structure, motion and contacts, as means over a run with their errors."""

from rigidfluid.post.statistics.measure import statistics
from rigidfluid.post.statistics.report_section import section

__all__ = ["section", "statistics"]
