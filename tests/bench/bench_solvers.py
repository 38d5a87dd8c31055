"""Solvers of our own against the libraries that could take their place, on the same systems in the same run.

Processor time (user) of one thread, the median of five; ratio: of the library over ours. A solver of our own without a row
here, or whose ratio is below one, goes. Factors of the sequentially linear analysis: bench_sla; those of rigid contacts are
compared in the core, `meson test --benchmark -C build/cp311 --verbose`.
"""

import resource
import statistics
from collections.abc import Callable

import clarabel
import numpy as np
from bench_limit import church, wall
from scipy import sparse
from scipy.linalg import cho_solve_banded, cholesky_banded

from extrados.core.limit import BandFactor
from extrados.limit.programme import LimitAnalysis
from extrados.model.geometry.assembly import Assembly
from extrados.model.structures.arch import make_arch

RUNS = 5
SOLUTIONS = 4  # with one factor, as of a step of the interior-point method


def user(call: Callable[[], object], times: int = 1) -> float:
    """Median user time of a call, made so many times in each of five runs after one warm-up [s]."""
    call()
    found = []
    for _ in range(RUNS):
        begin = resource.getrusage(resource.RUSAGE_SELF).ru_utime
        for _ in range(times):
            call()
        found.append((resource.getrusage(resource.RUSAGE_SELF).ru_utime - begin) / times)
    return statistics.median(found)


def bands() -> None:
    """c/sparse/band.c against LAPACK's dpbtrf and dpbtrs (SciPy's OpenBLAS): a factor and four solutions."""
    for n, width in ((306, 30), (900, 75), (3060, 80), (3060, 290)):
        rng = np.random.default_rng(0)
        lower = rng.normal(size=(width + 1, n))
        lower[0] = 4.0 * width
        right = rng.normal(size=n)

        def ours(lower=lower, right=right) -> np.ndarray:
            factor = BandFactor(np.ascontiguousarray(lower.T))
            x = factor.solve(right)
            for _ in range(SOLUTIONS - 1):
                x = factor.solve(right)
            return x

        def lapack(lower=lower, right=right) -> np.ndarray:
            factor = cholesky_banded(lower, lower=True, check_finite=False)
            x = cho_solve_banded((factor, True), right, check_finite=False)
            for _ in range(SOLUTIONS - 1):
                x = cho_solve_banded((factor, True), right, check_finite=False)
            return x

        times = max(1, int(2e8 / (n * width**2)))
        own, peer = user(ours, times), user(lapack, times)
        print(
            f"  band.c, {n} equations, {width} beside the diagonal: {1e3 * own:.2f} ms; LAPACK {1e3 * peer:.2f} ms, ratio "
            f"{peer / own:.2f}; difference {np.abs(ours() / lapack() - 1.0).max():.0e}",
            flush=True,
        )


def collapse(assembly: Assembly, small: bool) -> Callable[[], float]:
    """Capacity to one side and the other in turn, warm, from vertex to vertex or by HiGHS from its last basis."""
    limit, sense = LimitAnalysis(assembly), [1]
    limit._own_programme()._small = small

    def solve() -> float:
        sense[0] = -sense[0]
        return sense[0] * limit.collapse(sense[0])[0].gamma

    return solve


def vertices() -> None:
    """fortran/limit/vertex.f90 against HiGHS on the same small programme."""
    for name, assembly in (("arch of 36 voussoirs", make_arch(10.0, 1.5, 157.5, 36)), ("three-aisle section", church())):
        ours, highs = collapse(assembly, True), collapse(assembly, False)
        own, peer = user(ours, 100), user(highs, 100)
        print(
            f"  vertex.f90, {name}: {1e3 * own:.2f} ms; HiGHS, warm, {1e3 * peer:.2f} ms, ratio {peer / own:.1f}; "
            f"difference {abs(ours() - highs()):.0e}",
            flush=True,
        )


def with_clarabel(limit: LimitAnalysis) -> float:
    """Capacity by Clarabel's interior-point method, on the whole programme."""
    system, rows = limit.equations, limit._whole()
    matrix, constant = system.express(rows)
    n = system.unknowns
    cost = np.zeros(n)
    cost[-1] = -1.0
    whole = sparse.vstack([system.matrix, -sparse.csr_array(matrix)], format="csc")
    right = np.concatenate([system.right, constant - rows.lower])
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    cones = [clarabel.ZeroConeT(system.equations), clarabel.NonnegativeConeT(len(rows.lower))]
    found = clarabel.DefaultSolver(sparse.csc_array((n, n)), cost, whole, right, cones, settings).solve()
    return found.x[-1] if str(found.status) in ("Solved", "AlmostSolved") else float("nan")


def walls() -> None:
    """limit/interior.py against HiGHS (its interior-point method and crossover) and Clarabel, on walls with friction."""
    for rows, columns in ((12, 8), (20, 12)):
        section = wall(rows, columns)

        def ours(section=section) -> float:
            return LimitAnalysis(section, 0.6).collapse()[0].gamma

        def highs(section=section) -> float:
            return LimitAnalysis(section, 0.6)._by_programme(1)[0].gamma

        def cones(section=section) -> float:
            return with_clarabel(LimitAnalysis(section, 0.6))

        spent = [user(call) for call in (ours, highs, cones)]
        values = [call() for call in (ours, highs, cones)]
        print(
            f"  interior.py, wall of {len(section.mass)} stones, friction 0.6: {1e3 * spent[0]:.0f} ms; HiGHS {1e3 * spent[1]:.0f} "
            f"ms, ratio {spent[1] / spent[0]:.1f}; Clarabel {1e3 * spent[2]:.0f} ms without the mechanism, ratio "
            f"{spent[2] / spent[0]:.1f}; {values[0]:.6f}, {values[1]:.6f}, {values[2]:.6f} g",
            flush=True,
        )


def main() -> None:
    print("solvers of our own against libraries, user time of one thread")
    bands()
    vertices()
    walls()


if __name__ == "__main__":
    main()
