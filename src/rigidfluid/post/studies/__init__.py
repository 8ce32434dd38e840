"""Error against run time: the same thing run with many settings."""

from rigidfluid.post.studies.load import load_study
from rigidfluid.post.studies.model import Study
from rigidfluid.post.studies.run import run_study

__all__ = ["Study", "load_study", "run_study"]
