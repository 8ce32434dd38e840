"""GMRES of PETSc behind a preconditioner that is kept from step to step."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, ClassVar, final

from petsc4py import PETSc

from rigidfluid.backends.dolfinx.linear_functions import linear_functions
from rigidfluid.backends.dolfinx.products import projected
from rigidfluid.backends.dolfinx.reduced import Reduced
from rigidfluid.backends.dolfinx.schur import CahouetChabard
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.ranks import Ranks
from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.linear_solver.lagged_factors import LaggedFactors
from rigidfluid.taylor_hood.linear_solver.lagged_solver import LaggedSolver

Settings = Mapping[str, str | float | int | bool]
_PREFIX = "rigidfluid_"


class Krylov(LaggedSolver[Reduced]):
    """Krylov solver with its preconditioner on the right, so that the norm that stops it is the true residual's.

    ``settings`` are PETSc options from the scene, which have the last word over ``defaults``.
    """

    defaults: ClassVar[Settings]
    """PETSc options of the solver."""
    keeps_pattern: ClassVar[bool]
    """Tell whether the analysis of a matrix' pattern serves for the next one."""

    def __init__(self, ranks: Ranks, dimension: int, settings: Settings) -> None:
        super().__init__(ranks, dimension)
        self._settings = dict(settings)
        self._ksp: Any = None
        self._assembled: Any = None
        self._operator = _Operator(ranks)

    @final
    def make(self, matrix: Reduced) -> None:
        try:
            with _causes_told():
                self._make(matrix)
        except PETSc.Error as error:
            raise StepRejected(
                "fluid.backend",
                f"a preconditioner that PETSc cannot make ({error})",
                "one that it can",
                "Shorten time.step, or look at the keys of fluid.petsc.",
            ) from error

    def _make(self, matrix: Reduced) -> None:
        self._assembled = matrix.to_petsc(self._assembled)
        if self._ksp is not None:
            self._ksp.setOperators(*self._ksp.getOperators())  # the same ones, with new entries
            self._ksp.setUp()
            return
        assembled = self._assembled
        shell = PETSc.Mat().createPython(assembled.getSizes(), self._operator, comm=assembled.comm)
        shell.setUp()
        self._ksp = PETSc.KSP().create(assembled.comm)
        self._ksp.setOptionsPrefix(_PREFIX)
        self._ksp.setOperators(shell, assembled)
        self._ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
        self._ksp.setPCSide(PETSc.PC.Side.RIGHT)
        self.prepare(self._ksp, matrix, shell)
        with self._options(self.defaults):
            self._ksp.setFromOptions()
            self._ksp.setUp()
            self.finish(self._ksp, matrix)

    @final
    def make_room(self) -> None:
        if not self.keeps_pattern:
            self.drop()

    @final
    def drop(self) -> None:
        for held in (self._ksp, self._assembled):
            if held is not None:
                held.destroy()
        self._ksp = self._assembled = None

    @final
    def iterate(
        self, apply: Callable[[FloatArray], FloatArray], residual: FloatArray, tolerance: float, most: int
    ) -> tuple[FloatArray, int, bool]:
        self._operator.apply = apply
        self._ksp.setTolerances(rtol=0.0, atol=tolerance, max_it=most)
        _, pmat = self._ksp.getOperators()
        correction, right_side = pmat.createVecs()
        right_side.array[:] = residual
        with _causes_told():
            self._ksp.solve(right_side, correction)
        self._operator.apply = None  # it holds the step's matrices
        found: FloatArray = correction.array.copy()
        return found, self._ksp.getIterationNumber(), self._ksp.getConvergedReason() > 0

    @abstractmethod
    def prepare(self, ksp: Any, matrix: Reduced, shell: Any) -> None:
        """Set up whatever PETSc needs before the options are read."""

    @abstractmethod
    def finish(self, ksp: Any, matrix: Reduced) -> None:
        """Set up whatever PETSc can take only after the options are read."""

    @contextmanager
    def _options(self, defaults: Settings) -> Iterator[None]:
        """Settings in PETSc's database while the solver is set up; the scene's stay, so that PETSc tells the unread."""
        database = PETSc.Options(_PREFIX)
        for key, value in (dict(defaults) | self._settings).items():
            database[key] = None if value is True else value  # of a flag PETSc wants the name alone
        try:
            yield
        finally:
            for key in set(defaults) - set(self._settings):
                database.delValue(key)


@final
class LaggedLU(Krylov):
    """LU factors of the whole matrix, by MUMPS.

    The matrix is analysed, and the pattern of its product found, once for each topology.
    """

    keeps_pattern: ClassVar[bool] = True
    rebuild_cost: ClassVar[Mapping[int, int]] = {2: 10, 3: 60}
    fresh_iterations: ClassVar[int] = LaggedFactors.fresh_iterations
    most: ClassVar[int] = LaggedFactors.most
    defaults: ClassVar[Settings] = {
        "ksp_type": "fgmres",  # keeps what the factors gave: one back-substitution less than gmres
        "ksp_gmres_restart": 60,
        "pc_type": "lu",
        "pc_factor_mat_solver_type": "mumps",
        "mat_mumps_icntl_6": 0,  # analysed by the pattern alone, so that a run that is resumed finds the same factors
        "mat_mumps_icntl_14": 60,  # per cent of memory for pivots beyond the estimate
    }

    def prepare(self, ksp: Any, matrix: Reduced, shell: Any) -> None:
        """Set up nothing: factors need the matrix alone."""

    def finish(self, ksp: Any, matrix: Reduced) -> None:
        """Set up nothing."""


@final
class LaggedSchur(Krylov):
    """Upper block triangle [[A, Bᵀ], [0, S]]: A, with the bodies' rows, by two levels, S by Cahouet–Chabard.

    The levels of A are ILU(0), multigrid on the linear functions on the same cells, and ILU(0) again. With a narrow
    gap, where viscosity dominates in some cells and mass in most, ILU(0) alone takes twice the iterations, Jacobi five
    times.
    """

    keeps_pattern: ClassVar[bool] = False  # its parts are set up for one matrix
    rebuild_cost: ClassVar[Mapping[int, int]] = {2: 12, 3: 12}
    fresh_iterations: ClassVar[int] = 20
    most: ClassVar[int] = 200
    sharper: ClassVar[float] = 1e-2  # factors leave far less than they are asked for, this leaves a slow error
    defaults: ClassVar[Settings] = {
        "ksp_type": "fgmres",
        "ksp_gmres_restart": 200,
        "pc_type": "fieldsplit",
        "pc_fieldsplit_type": "schur",
        "pc_fieldsplit_schur_fact_type": "upper",
        "pc_fieldsplit_schur_precondition": "a11",
        "fieldsplit_velocity_ksp_type": "preonly",
        "fieldsplit_velocity_pc_type": "mg",
        "fieldsplit_velocity_pc_mg_levels": 2,
        "fieldsplit_velocity_mg_levels_ksp_type": "richardson",
        "fieldsplit_velocity_mg_levels_ksp_max_it": 1,
        "fieldsplit_velocity_mg_levels_pc_type": "bjacobi",  # ILU(0) of each process' part
        "fieldsplit_velocity_mg_coarse_ksp_type": "preonly",
        "fieldsplit_velocity_mg_coarse_pc_type": "hypre",
        "fieldsplit_pressure_ksp_type": "preonly",
        "fieldsplit_pressure_pc_type": "python",
    }

    def prepare(self, ksp: Any, matrix: Reduced, shell: Any) -> None:
        constraint = matrix.constraint
        moving, first = constraint.velocities + constraint.twists, constraint.first_column
        comm = ksp.comm
        velocity = PETSc.IS().createStride(moving, first=first, step=1, comm=comm)
        pressure = PETSc.IS().createStride(constraint.pressures, first=first + moving, step=1, comm=comm)
        ksp.getPC().setType("fieldsplit")
        ksp.getPC().setFieldSplitIS(("velocity", velocity), ("pressure", pressure))
        if matrix.schur().enclosed:
            shell.setNullSpace(_constant_pressure(shell, moving))

    def finish(self, ksp: Any, matrix: Reduced) -> None:
        velocity, pressure = ksp.getPC().getFieldSplitSchurGetSubKSP()
        pressure.getPC().setPythonContext(CahouetChabard(matrix.schur()))
        if velocity.getPC().getType() == "mg":  # the scene may have chosen another
            _two_levels(velocity, linear_functions(matrix.constraint, matrix.constraint_matrix))
        self._drop_whole(ksp)

    def _drop_whole(self, ksp: Any) -> None:
        """Free the matrix: the blocks are copies of it."""
        shell, _ = ksp.getOperators()
        ksp.getPC().setReusePreconditioner(True)
        ksp.setOperators(shell, shell)
        self._assembled.destroy()
        self._assembled = None


def _two_levels(velocity: Any, basis: Any) -> None:
    levels, (fine, _) = velocity.getPC(), velocity.getOperators()
    levels.setMGInterpolation(1, basis)
    coarse = projected(fine, basis)
    levels.getMGCoarseSolve().setOperators(coarse, coarse)
    velocity.setUp()


class _Operator:
    """Shell matrix by which PETSc computes A x, on all processes together."""

    def __init__(self, ranks: Ranks) -> None:
        self._ranks = ranks
        self.apply: Callable[[FloatArray], FloatArray] | None = None

    def mult(self, _matrix: Any, x: Any, y: Any) -> None:
        assert self.apply is not None
        self._ranks.heed_interrupts()
        y.array[:] = self.apply(x.array_r)


@contextmanager
def _causes_told() -> Iterator[None]:
    """Raise the exception of Python code that PETSc called, such as Ctrl-C, in the place of PETSc's own error."""
    try:
        yield
    except PETSc.Error as error:
        cause = error.__cause__
        while isinstance(cause, PETSc.Error):
            cause = cause.__cause__
        if cause is not None:
            raise cause from None
        raise


def _constant_pressure(matrix: Any, moving: int) -> Any:
    vector = matrix.createVecRight()
    vector.array[moving:] = 1.0
    vector.normalize()
    return PETSc.NullSpace().create(vectors=[vector], comm=matrix.comm)
