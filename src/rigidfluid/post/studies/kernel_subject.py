"""Subject of a study that runs a kernel."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from typing import Any

from rigidfluid.core.scene.overrides import assign
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.scene.validation import read_table
from rigidfluid.errors import RigidfluidError, SceneError
from rigidfluid.post.studies.kernels import KERNELS
from rigidfluid.post.studies.kernels.kernel import Kernel
from rigidfluid.post.studies.model import Study
from rigidfluid.post.studies.strict_table import Settings
from rigidfluid.post.studies.subject import Outcome, Target


class KernelSubject:
    """Runs of the study's kernel.

    Raises SceneError if there is no such kernel or no run reads a knob, and the first error if no setting is valid.
    """

    def __init__(self, study: Study) -> None:
        self._name = str(study.tables.study.kernel)
        self._kernel = _kernel(self._name)
        self._fixed = study.tables.set
        kernels, errors = self._tried(study.settings())
        for knob in [*study.tables.set, *study.knobs]:
            if not any(kernel.reads(knob) for kernel in kernels):
                # of the settings that are not valid, one may have been meant to read it
                errors.append(SceneError(knob, "a knob that no run reads", "one that a run reads", "Remove it."))
                raise errors[0]
        of = study.tables.study.label or self._kernel.figure
        self.target = Target(f"error of {self._kernel.figure}", 0.0, of, self._kernel.against, relative=False)

    def read(self, settings: Settings) -> Settings:
        """The knobs that the kernel reads with these settings; all, if it refuses them."""
        try:
            kernel = self._made(settings)
        except RigidfluidError:
            return settings
        return {knob: value for knob, value in settings.items() if kernel.reads(knob)}

    def identity(self, settings: Settings) -> str:
        """The kernel's name and the knobs that it reads."""
        return json.dumps([self._name, self.read(self._fixed | settings)], sort_keys=True, default=str)

    def run(self, settings: Settings, progress: Callable[[float], None]) -> Outcome:
        """Run the kernel once; it decides what its seconds measure."""
        return self._made(settings).run(progress)

    def _tried(self, all_settings: Iterable[Settings]) -> tuple[list[Kernel], list[RigidfluidError]]:
        """Kernels with the valid ones of these settings, at least one, and the errors of the others."""
        kernels: list[Kernel] = []
        errors: list[RigidfluidError] = []
        for settings in all_settings:
            try:
                kernels.append(self._made(settings))
            except RigidfluidError as error:
                errors.append(error)
        if not kernels:
            raise errors[0]
        return kernels, errors

    def _made(self, settings: Settings) -> Kernel:
        tables: dict[str, Any] = {}
        for key, value in (self._fixed | settings).items():
            assign(tables, key, value)
        return read_table(self._kernel, tables)


def _kernel(name: str) -> type[Kernel]:
    if name not in KERNELS:
        remedy = suggestion(name, KERNELS) or "Choose one of them."
        raise SceneError("study.kernel", repr(name), "one of " + ", ".join(KERNELS), remedy)
    return KERNELS[name]
