"""The scikit-fem fluid backend; heavy imports wait until a backend is made."""

from rigidfluid.backends.scikit_fem.backend import ScikitFem

__all__ = ["ScikitFem"]
