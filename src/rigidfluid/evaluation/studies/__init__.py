"""Error against run time: the same thing run with many settings."""

from rigidfluid.evaluation.studies.model import Study, load_study
from rigidfluid.evaluation.studies.run import run_study

__all__ = ["Study", "load_study", "run_study"]
