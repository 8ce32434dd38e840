"""How many threads the linear algebra may use."""

from __future__ import annotations

from contextlib import AbstractContextManager


def one_openblas_thread() -> AbstractContextManager[object]:
    """Keep OpenBLAS, which serves NumPy's short dot products, to one thread while a run lasts.

    Its idle threads spin, and take the cores from MKL and from everything else: with them a step of 16,000 unknowns
    took five times as long on two busy cores. One thread also makes sums repeatable to the last bit.
    """
    from threadpoolctl import ThreadpoolController

    limit: AbstractContextManager[object] = (
        ThreadpoolController().select(internal_api="openblas").limit(limits=1, user_api="blas")
    )
    return limit
