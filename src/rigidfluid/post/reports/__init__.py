"""Plots and a page made from the folder that a run has written."""

from rigidfluid.post.reports.report import report

__all__ = ["report"]
