"""Ensembles of rocking blocks: runs per second and error against SciPy's solve_ivp and numba's RK4, memory of many runs.

10 s motions of fifteen sines sampled at 5 ms. Errors are those of the peak rotation over alpha against DOP853 at rtol
1e-10 restarted at every sample; motions on the edge of collapse, where outcomes differ, are left out and counted.
"""

import os
import resource
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from peers import has
from scipy.integrate import solve_ivp

from extrados.core import rocking
from extrados.core.rocking import BodyList, Ground, MotionSet
from extrados.model.structures.block import make_block
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.block import BlockModel

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "verification"))
from rocking_oracle import reference

STEP, END, THREADS = 0.005, 10.0, 2


def motions(count: int, peak: float) -> np.ndarray:
    rng = np.random.default_rng(9)
    t = STEP * np.arange(round(END / STEP) + 1)
    window = (np.arctan((t - 0.5) / 0.1) - np.arctan((t - 8.5) / 0.1)) / np.pi
    waves = 2 * np.pi * np.outer(t, np.geomspace(0.3, 10.0, 15))
    raw = np.array([np.sin(waves + rng.uniform(0, 2 * np.pi, 15)).sum(axis=1) * window for _ in range(count)])
    return raw / np.abs(raw).max(axis=1, keepdims=True) * peak * GRAVITY


def scipy_rate(p: float, alpha: float, c_v: float, samples: np.ndarray, start: float, count: int) -> float:
    """Runs per second of solve_ivp RK45 at rtol 1e-8 with impact events, the plain way: interpolated record."""
    t_axis = STEP * np.arange(samples.shape[1])
    begin = time.perf_counter()
    for row in samples[:count]:
        t, q, v, s = 0.0, start, 0.0, 1.0
        while t < END:

            def rhs(x, y, s=s, row=row):
                a = np.interp(x, t_axis, row) / GRAVITY
                return (y[1], -p * p * (np.sin(alpha - y[0]) + s * a * np.cos(alpha - y[0])))

            def down(x, y):
                return y[0]

            def over(x, y):
                return y[0] - 2 * alpha

            down.terminal, down.direction, over.terminal = True, -1, True
            answer = solve_ivp(rhs, (t, END), (q, v), rtol=1e-8, atol=1e-10, events=(down, over))
            t = answer.t[-1]
            if answer.status == 0 or len(answer.t_events[1]):
                break
            q, v, s = 0.0, -c_v * answer.y[1, -1], -s
            if v <= 1e-3 * p * alpha:  # rest until the ground lifts it again
                later = np.flatnonzero((t_axis > t) & (np.abs(row) > GRAVITY * np.tan(alpha)))
                if not len(later):
                    break
                t, v, s = t_axis[later[0]], 0.0, -np.sign(row[later[0]])
    return count / (time.perf_counter() - begin)


def least(calls: dict[str, Callable[[], object]], rounds: int = 5) -> dict[str, tuple[float, float]]:
    """Least wall and CPU time of each call [s], one after the other in each round: the machine may be shared."""
    found = {name: (np.inf, np.inf) for name in calls}
    for _ in range(rounds):
        for name, call in calls.items():
            wall, cpu = time.perf_counter(), time.process_time()
            call()
            taken = time.perf_counter() - wall, time.process_time() - cpu
            found[name] = tuple(map(min, found[name], taken))
    return found


def case(width: float, height: float, peak: float, count: int = 2000, checked: int = 24) -> None:
    m = BlockModel(make_block(width, height))
    p, alpha, c_v = float(m.frequency[0]), float(m.alpha[0]), float(m.restitution[0])
    samples, start = motions(count, peak), alpha / 32.0
    # handed over before, as the peers' arrays are
    grounds = MotionSet([Ground(samples=row[None, :], step=STEP) for row in samples])
    bodies = BodyList([m.body])
    zero, each = np.zeros(count, int), np.arange(count)
    truth = np.array([reference(p, alpha, c_v, row, STEP, start, END) for row in samples[:checked]])

    def ours(tolerance: float):
        return rocking.ensemble(
            bodies, grounds, zero, each, 1.0, END, start_rotation=start, tolerance=tolerance, stop_when_safe=False, threads=THREADS
        )

    def error(peaks: np.ndarray) -> str:
        e = np.abs(np.minimum(peaks[:checked], 2.0) - truth[:, 0])
        agree = (peaks[:checked] >= 2.0) == (truth[:, 1] == 2)
        up = agree & (truth[:, 1] != 2)
        return f"median {np.median(e[up]):.0e}, greatest {e[up].max():.0e} of {up.sum()} that stay up; {(~agree).sum()} of {checked} other outcome"

    print(f"block {width} x {height} m, {count} motions of {END:g} s, peak {peak:g} g, {THREADS} threads")
    peers = {}
    if has("numba"):
        import numba
        from rocking_peers import rk4_many

        numba.set_num_threads(THREADS)
        peers = {"numba RK4 at 1 ms": 5, "numba RK4 at 0.25 ms": 20}
    for parts in peers.values():
        rk4_many(p, alpha, c_v, samples[:2], STEP, start, END, parts)  # compiles
    calls = {"extrados": lambda: ours(1e-8)}
    for name, parts in peers.items():
        calls[name] = lambda parts=parts: rk4_many(p, alpha, c_v, samples, STEP, start, END, parts)
    times = least(calls)
    e = ours(1e-8)
    rate = count / times["extrados"][0]
    print(
        f"  extrados, tolerance 1e-8  {rate:9.0f} runs/s   error {error(e.peak_ratio)}; "
        f"{100 * (e.outcome == 2).mean():.0f} % collapse, {e.impacts.mean():.0f} impacts a run"
    )
    slow = scipy_rate(p, alpha, c_v, samples, start, 4)
    print(f"  SciPy RK45, rtol 1e-8     {slow:9.2f} runs/s   extrados is {rate / slow:.0f} times as fast")
    if not peers:
        print(f"  {'numba RK4':25s} not installed")
    for name, parts in peers.items():
        wall, cpu = (b / a for a, b in zip(times["extrados"], times[name], strict=True))
        peaks, _ = rk4_many(p, alpha, c_v, samples, STEP, start, END, parts)
        print(
            f"  {name:25s} {count / times[name][0]:9.0f} runs/s   extrados is {wall:.1f} times as fast "
            f"({cpu:.1f} by CPU time); error {error(peaks)}"
        )


def many(checked: int = 500) -> None:
    """Cost and memory over the number of runs, as fragility streams them (generated motions, 10 s at 10 ms); error: the first
    ones against a tolerance of 1e-13, by which the few near the edge of collapse differ most."""
    from extrados.analyses.motion_source import GeneratedSource
    from extrados.analyses.statistics.fragility import EnsembleJob
    from extrados.motions.generated import generated

    m = BlockModel(make_block(0.1, 0.4))
    made = generated(7.7, 7.5, seed=1)  # a third of the blocks fall, half of those that stand turn by a third of alpha
    job = EnsembleJob(GeneratedSource(made), [m.body], np.array([m.alpha[0] / 32]), "pga", 1.0, None, None, 0.5, 1e-8)
    most = int(os.environ.get("BENCH_RUNS", "20000"))
    for count in (most // 4, most // 2, most):
        begin, used = time.perf_counter(), time.process_time()
        for first in range(0, count, 2500):
            job.run(first, min(2500, count - first), THREADS)
        seconds, used = time.perf_counter() - begin, time.process_time() - used
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(
            f"  {count:8d} generated motions of {made.end_time:g} s: {count / seconds:7.0f} runs/s with their generation "
            f"({count / used:.0f} a second of processor: {1e6 / count * used:.0f} s for a million), {memory:.0f} MB at most"
        )
    rows, truth = job.run(0, checked, THREADS), replace(job, tolerance=1e-13).run(0, checked, THREADS)
    same = rows["outcome"] == truth["outcome"]
    rose = truth["peak_ratio"] > (1.0 + 1e-9) / 32.0
    e = np.abs(rows["peak_ratio"] - truth["peak_ratio"])[same & rose & (truth["outcome"] != 2)]
    print(
        f"  {100 * (rows['outcome'] == 2).mean():.0f} % collapse; error: median {np.median(e):.0e}, greatest {e.max():.0e} of {len(e)} that rise and stay up; {(~same).sum()} of {checked} other outcome"
    )


def main() -> None:
    for width, height, peak in ((0.1, 0.4, 0.35), (1.0, 4.0, 0.5)):
        case(width, height, peak)
    many()


if __name__ == "__main__":
    main()
