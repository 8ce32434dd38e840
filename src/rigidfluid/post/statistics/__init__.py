"""Statistics of many bodies: structure, motion and contacts, as means over a run with their errors."""

from rigidfluid.post.statistics.measure import measure_statistics, statistics
from rigidfluid.post.statistics.report_section import section

__all__ = ["measure_statistics", "section", "statistics"]
