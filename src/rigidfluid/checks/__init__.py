"""Questions that `rigidfluid check` asks of a scene before anything runs."""

from rigidfluid.checks.finding import Finding
from rigidfluid.checks.report import Report, check

__all__ = ["Finding", "Report", "check"]
