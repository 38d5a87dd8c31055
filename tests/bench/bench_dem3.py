"""Blocks in space against MuJoCo and LMGC90: real-time factor and error of displacements; cost over size; two threads.

Rates are of processor time of one core, ours without settling, MuJoCo's without its 0.2 s under gravity, so that what else runs on
the machine counts little; threads are timed by the wall clock, and the load stands beside. The error is the greatest RMS distance of any block
from a refined solution over a smooth stretch (before impacts make any two codes part), over the greatest displacement there.

Few blocks are computed by rigid contacts, as MuJoCo has them too but for what its solver lets through. The refined solution is our own at
a small step, so that the error of rigid contacts is how far they are from where they converge to. Its worth shows in how near springs
of ten times the stiffness (at a third of the critical step) and MuJoCo at a fifth of its step come to it. For many blocks (springs
only) the refined solution has ten times the stiffness. Of few blocks every solver has three tries, of which the fastest counts.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import solid_peers
from peers import has

from extrados.core import dem3
from extrados.core.dem_run import STILL
from extrados.core.ground import Ground, as_motion_set
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.columns import drums
from extrados.model.geometry.solids.sections import drawn_out
from extrados.model.structures.arch import make_arch
from extrados.model.structures.brickwork import Bond
from extrados.model.structures.dome import make_dome
from extrados.model.structures.wall import make_wall
from extrados.schema.constants import GRAVITY
from extrados.views.solids.supports import supports_of

FRICTION = 0.7


def sine(amplitude: float, period: float) -> Ground:
    """One cycle of a sine [m/s^2, s]."""
    wave = np.array([[[[amplitude, 0.0, 2.0 * np.pi / period, 0.0]]]])
    return Ground(breaks=np.array([0.0, period]), linear=np.zeros((1, 1, 2)), harmonic=wave)


def solids_of(assembly: SolidAssembly, law: dem3.Law) -> dem3.Solids:
    """Blocks on their footings, with one law for all contacts."""
    below = supports_of(assembly).bodies
    n = len(below)
    middle = np.reshape([part.vertices.mean(axis=0) for part in below], (-1, 3))
    parts = [*assembly.parts, *below]
    return dem3.Solids(
        np.concatenate([assembly.centroid, middle]),
        np.concatenate([assembly.mass, np.zeros(n)]),
        np.concatenate([assembly.inertia, np.tile(np.eye(3), (n, 1, 1))]),
        [p.vertices for p in parts],
        [p.faces for p in parts],
        [*assembly.owner.tolist(), *range(len(assembly.mass), len(assembly.mass) + n)],
        [law],
    )


@dataclass(frozen=True)
class Case:
    """Structure, motion along x or (way = 1) y, seconds that are timed and compared, springs [Pa/m] and damping [s], step over the critical."""

    assembly: Callable[[], SolidAssembly]
    ground: Ground
    seconds: float
    stiffness: float
    beta: float
    refined: float
    fraction: float = 0.6
    peer_steps: tuple[float, ...] = (1e-3, 2e-4)
    way: int = 0
    rigid_steps: tuple[float, ...] = ()  # of rigid contacts [s]; the last for the refined solution

    @property
    def tries(self) -> int:
        """Of which the fastest counts."""
        return 3 if self.rigid_steps else 1


CASES = {
    "column of 12 drums": Case(
        lambda: drums(1.0, [0.5] * 12, None, 16), sine(0.35 * GRAVITY, 0.8), 0.6, 1e10, 1e-3, 1e11, rigid_steps=(32e-3, 16e-3, 4e-3, 5e-4)
    ),
    "arch of 30": Case(
        lambda: drawn_out(make_arch(10.0, 1.5, 157.5, 30)),
        sine(0.6 * GRAVITY, 0.6),
        0.4,
        2e10,
        1e-3,
        2e11,
        rigid_steps=(32e-3, 16e-3, 4e-3, 5e-4),
    ),
    # Out of its plane
    "wall of 500": Case(
        lambda: make_wall(Bond(0.4, 0.2), 0.2, 3.2, [(12.6, False, [])]),
        sine(0.3 * GRAVITY, 0.6),
        0.3,
        2e9,
        1e-3,
        2e10,
        way=1,
        peer_steps=(1e-3,),
    ),
    "dome of 600": Case(lambda: make_dome(5.0, 0.5, 180.0, 25, 24), sine(0.8 * GRAVITY, 0.6), 0.3, 2e9, 1e-3, 2e10, peer_steps=(1e-3,)),
}


def run_of(solids: dem3.Solids, case: Case, rigid: bool = False, **keys: float) -> tuple[float, dem3.Run]:
    """Processor time [s] of the motion alone, the model built before, the least of some; and the run.

    What springs take to settle is timed and taken off; rigid contacts begin at rest, where nothing presses yet."""
    way = (1.0 - case.way, float(case.way), 0.0)
    options = dem3.Options(case.seconds, settle_tolerance=1e-4, residual_limit=0.9, way=way, rigid=rigid, **keys)
    times = np.linspace(0.0, case.seconds, 101)
    asked = [(replace(options, end_time=1e-6), times[:1]), (options, times)]
    if rigid:
        asked = [(replace(options, settle_steps=0), times)]
    least = []
    for given, when in asked:
        with dem3.Model(solids, given) as model, as_motion_set([case.ground]) as motions:
            spent = []
            for _ in range(case.tries):
                begin = time.process_time()
                run = model.run(motions, times=when)
                spent.append(time.process_time() - begin)
        least.append(min(spent))
    return least[-1] - sum(least[:-1]), run


def error(time_axis: np.ndarray, moved: np.ndarray, exact: np.ndarray, times: np.ndarray) -> float:
    """Greatest RMS distance of a block (t, n, 3) from the refined one over the greatest displacement of any."""
    found = np.stack([[np.interp(times, time_axis, moved[:, b, i]) for i in range(3)] for b in range(moved.shape[1])]).transpose(2, 0, 1)
    rms = np.sqrt(((found - exact) ** 2).sum(axis=2).mean(axis=0))
    return float(rms.max() / np.linalg.norm(exact, axis=2).max())


def lmgc90(name: str, dt: float) -> tuple[solid_peers.Answer | None, str]:
    """Its answer in a process of its own, or why there is none."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "answer.npz"
        run = subprocess.run(
            [sys.executable, solid_peers.__file__, name, str(dt), str(out)], capture_output=True, text=True, errors="replace", check=False
        )
        if not out.exists():
            return None, " ".join(f"{run.stdout} {run.stderr}".split())[-200:] or f"ended with {run.returncode}"
        data = np.load(out)
        return solid_peers.Answer(float(data["seconds"]), float(data["seconds"]), data["time"], data["moved"]), ""


def one(name: str, case: Case) -> None:
    assembly = case.assembly()
    n = len(assembly.mass)

    def solids(stiffness: float, beta: float) -> dem3.Solids:
        return solids_of(assembly, dem3.Law(stiffness, stiffness, FRICTION, damping=beta))

    def moved(run: dem3.Run) -> np.ndarray:
        return run.place[:, :n] - run.settled[:n]

    print(f"{name}: {n} blocks, {len(assembly.a)} contacts, {case.seconds:g} s of motion")
    springs = solids(case.stiffness, case.beta)
    fine = run_of(solids(case.refined, case.beta * case.stiffness / case.refined), case, fraction=0.3)[1]
    runs = [("springs", *run_of(springs, case, fraction=case.fraction))]
    if case.rigid_steps:
        runs += [("springs, stiffer", np.inf, fine)]
        runs += [("rigid contacts", *run_of(springs, case, rigid=True, step=step)) for step in case.rigid_steps]
        fine = runs.pop()[2]
    exact = moved(fine)
    print(f"  up to {np.abs(exact).max():.2g} m")
    aheads = {}
    for solver, spent, run in runs:
        off = error(run.time, moved(run), exact, fine.time)
        ahead = case.seconds / spent
        told = f"{ahead:9.2f} times real time" if ahead else 25 * " "
        print(f"  extrados  {told}  step {run.step:.1e} s  error {off:.1e}  energy residual {run.residual:.1e}  {solver}", flush=True)
        if ahead:
            aheads[f"{solver} at {run.step:.2g} s"] = ahead

    def beside(program: str, peer: solid_peers.Answer, dt: float) -> None:
        rate = peer.time[-1] / peer.processor
        off = f"- (stopped at {peer.time[-1]:.3f} s)"
        if peer.time[-1] > 0.99 * case.seconds:
            off = f"{error(peer.time, peer.moved, exact, fine.time):.1e}"
        faster = ", ".join(f"{solver} {ahead / rate:.1f}" for solver, ahead in aheads.items())
        print(f"  {program}    {rate:9.2g} times real time  step {dt:.0e} s  error {off}  times as fast: {faster}", flush=True)

    if not has("mujoco"):
        print("  MuJoCo    not installed")
    for dt in case.peer_steps if has("mujoco") else ():
        grounds = (STILL, case.ground) if case.way else (case.ground, STILL)
        runs_of_peer = [solid_peers.mujoco(solids(case.stiffness, 0.0), *grounds, case.seconds, dt) for _ in range(case.tries)]
        beside("MuJoCo", min(runs_of_peer, key=lambda run: run.processor), dt)
    if not has("compas_lmgc90"):
        print("  LMGC90    not installed")
        return
    peer, why = lmgc90(name, 1e-3)
    if peer is None:
        print(f"  LMGC90    no answer: {why}")
    else:
        beside("LMGC90", peer, 1e-3)


def sizes() -> None:
    """Cost per block and step over the size of a wall, as it shakes."""
    print("cost over size: walls of units in running bond, one thread, processor time")
    for length, height in ((2.4, 1.0), (4.8, 2.0), (9.6, 4.0), (19.2, 8.0), (32.0, 12.0)):
        assembly = make_wall(Bond(0.4, 0.2), 0.2, height, [(length, False, [])])
        solids = solids_of(assembly, dem3.Law(5e9, 5e9, FRICTION, damping=1e-3))
        n = len(assembly.mass)
        spent, steps = {}, {}
        for seconds in (1e-6, max(0.008, 8.0 / n)):  # the first search takes as long as many steps
            options = dem3.Options(seconds, fraction=0.6, residual_limit=1e9, settle_steps=0)
            with dem3.Model(solids, options) as model, as_motion_set([sine(0.3 * GRAVITY, 0.6)]) as motions:
                for _ in range(2):
                    begin = time.process_time()
                    run = model.run(motions)
                    spent[seconds] = min(spent.get(seconds, np.inf), time.process_time() - begin)
                    steps[seconds] = run.steps
        (start, whole), (few, many) = spent.values(), steps.values()
        each = (whole - start) / (n * (many - few))
        print(f"  {n:5d} blocks  {1e9 * each:7.1f} ns per block and step ({many} steps)", flush=True)


BUSY = "import time\nwhile True: pass"
WITHIN = 1.2  # the default may take so many times as long as one thread on a busy machine


@contextmanager
def busy(processes: int) -> Iterator[None]:
    """So many processes that do nothing but take a core."""
    others = [subprocess.Popen([sys.executable, "-c", BUSY]) for _ in range(processes)]
    try:
        yield
    finally:
        for other in others:
            other.kill()
            other.wait()


def threads() -> None:
    """Wall time with all threads of the machine, of which as many are used as are fastest, over that of one thread; the same
    bits; the middle of three. Alone, and while twice as many processes as cores run beside it."""
    cores = os.cpu_count() or 1
    print(f"all threads against one, wall clock; load {os.getloadavg()[0]:.1f} on {cores} cores")
    for length, height in ((2.8, 1.4), (3.6, 1.6), (5.2, 3.2), (12.6, 3.2), (19.2, 8.0)):
        assembly = make_wall(Bond(0.4, 0.2), 0.2, height, [(length, False, [])])
        solids = solids_of(assembly, dem3.Law(5e9, 5e9, FRICTION, damping=1e-3))
        n = len(assembly.mass)
        for others in (0, 2 * cores):
            took: dict[int, list[float]] = {1: [], cores: []}
            with busy(others):
                for count in (1, cores) * 3:
                    options = dem3.Options(30.0 / n, fraction=0.6, residual_limit=1e9, settle_steps=0, threads=count)
                    with dem3.Model(solids, options) as model, as_motion_set([sine(0.3 * GRAVITY, 0.6)]) as motions:
                        begin = time.perf_counter()
                        model.run(motions)
                        took[count].append(time.perf_counter() - begin)
            ratio = statistics.median(took[cores]) / statistics.median(took[1])
            held = "" if not others else f" (goal {WITHIN}: {'met' if ratio <= WITHIN else 'missed'})"
            print(f"  {n:5d} blocks, {others} processes beside it: {ratio:.2f} times the time of one thread{held}", flush=True)


def main() -> None:
    for name, case in CASES.items():
        one(name, case)
    sizes()
    threads()


if __name__ == "__main__":
    main()
