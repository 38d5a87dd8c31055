"""Ground motions: response spectra against pyRotd, eqsig and SciPy on the same record; generated motions per second."""

import os
import resource
import time

import numpy as np
from scipy import signal
from timing import seconds

from extrados.core import motion as core
from extrados.motions.generated import Window, generated

POINTS, STEP = 5000, 0.01
PERIODS, DAMPINGS = np.geomspace(0.05, 10.0, 400), [0.02, 0.05, 0.10]
THREADS = min(2, os.cpu_count() or 1)


def _record() -> np.ndarray:
    """A generated motion of intensity 8 with as many points as the bench asks for."""
    return generated(8, 30.0, lines=200, step=STEP, window=Window("saragoni-hart", tail=19.49)).motion(0)[:POINTS]


def _lsim(a: np.ndarray, periods: np.ndarray) -> np.ndarray:
    """PSA by scipy.signal.lsim (first-order hold), 5 % damping."""
    time_axis = STEP * np.arange(len(a))
    found = []
    for period in periods:
        w = 2 * np.pi / period
        system = signal.StateSpace([[0, 1], [-(w**2), -0.1 * w]], [[0], [-1]], [[w**2, 0]], [[0]])
        found.append(np.abs(signal.lsim(system, a, time_axis)[1]).max())
    return np.array(found)


def _lfilter(a: np.ndarray, periods: np.ndarray) -> np.ndarray:
    """PSA by scipy.signal.lfilter on the discrete oscillator: the fastest way SciPy has."""
    found = []
    for period in periods:
        w = 2 * np.pi / period
        b, c, _ = signal.cont2discrete(([-(w**2)], [1, 0.1 * w, w**2]), STEP, "foh")
        found.append(np.abs(signal.lfilter(b.ravel(), c, a)).max())
    return np.array(found)


def _pyrotd(a: np.ndarray, periods: np.ndarray, damping: float) -> np.ndarray:
    import pyrotd

    pyrotd.processes = 1
    return pyrotd.calc_spec_accels(STEP, a, 1.0 / periods, damping).spec_accel


def _eqsig(a: np.ndarray, periods: np.ndarray, damping: float) -> np.ndarray:
    import eqsig

    return eqsig.sdof.pseudo_response_spectra(a, STEP, periods, damping)[2]


def _spectra() -> None:
    a = _record()
    ours = [seconds(lambda n=n: core.response_spectra(a, STEP, PERIODS, DAMPINGS, threads=n), 7) for n in (1, THREADS)]
    psa = core.response_spectra(a, STEP, PERIODS, DAMPINGS).psa[1]
    print(f"response spectra: {POINTS} points, {len(PERIODS)} periods x {len(DAMPINGS)} dampings (2, 5, 10 %), one run")
    print(f"  {'extrados, 1 thread':32} {1e3 * ours[0]:9.1f} ms")
    print(f"  {f'extrados, {THREADS} threads':32} {1e3 * ours[1]:9.1f} ms")
    fine = PERIODS >= 2.0 * core.POINTS_PER_CYCLE * STEP / 2
    peers = {"pyRotd": lambda: [_pyrotd(a, PERIODS, d) for d in DAMPINGS], "eqsig": lambda: [_eqsig(a, PERIODS, d) for d in DAMPINGS]}
    for name, run in peers.items():
        try:
            took, other = seconds(run, 3), run()[1]
        except ImportError:
            print(f"  {name:32} not installed")
            continue
        _line(name, took, ours, other, psa, fine)
    # SciPy for one damping and some of the periods, times their number
    for name, run, every in (("scipy.signal.lsim", _lsim, 20), ("scipy.signal.lfilter", _lfilter, 5)):
        some = slice(None, None, every)
        took = len(DAMPINGS) * every * seconds(lambda run=run, some=some: run(a, PERIODS[some]), 1)
        _line(f"{name} (1 in {every})", took, ours, run(a, PERIODS[some]), psa[some], fine[some])


def _line(name: str, took: float, ours: list[float], other: np.ndarray, psa: np.ndarray, fine: np.ndarray) -> None:
    off = np.abs(other / psa - 1.0)
    print(
        f"  {name:32} {1e3 * took:9.1f} ms: {took / ours[0]:6.1f} times ours on one thread, {took / ours[1]:6.1f} on {THREADS}; "
        f"PSA differs by {off[fine].max():.1e} (T >= 0.20 s), {off.max():.1e} (all)"
    )


def _generated() -> None:
    made = generated(7, 7.5, seed=1)
    print(f"generated motions: {made.end_time:g} s at {made.step:g} s, {len(made.lines)} lines, 10,000 streamed in batches")
    for threads in (1, THREADS):
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        begin = time.perf_counter()
        total = 0
        for _, batch in made.batches(10_000, threads=threads):
            total += len(batch)
        took = time.perf_counter() - begin
        grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
        print(f"  {threads} thread(s): {total / took:9.0f} motions/s; peak memory grew by {grown:.0f} MB")
    t, phases = made.step * np.arange(made.points), core.phases(1, 123, len(made.lines))
    begin = time.perf_counter()
    for _ in range(200):
        one = made.window * (made.amplitude[:, None] * np.sin(2 * np.pi * made.lines[:, None] * t + phases[:, None])).sum(axis=0)
    plain = 200 / (time.perf_counter() - begin)
    error = np.abs(one - made.motion(123)).max() / np.abs(one).max()
    print(f"  plain numpy: {plain:9.0f} motions/s; differs by {error:.1e} of the peak")


def main() -> None:
    """Print the rates."""
    _spectra()
    _generated()


if __name__ == "__main__":
    main()
