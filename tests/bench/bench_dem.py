"""Discrete elements against MuJoCo and LMGC90: real-time factor and error against a refined solution; cost over size.

The error is the RMS distance of a followed block from the refined solution over a smooth stretch (before impacts make
any two codes part), over its greatest displacement there; for the single block it is Housner's solution over 5 s, over
alpha. The refined solution of the others is our own at 2e12 Pa/m (the wall's 2e11) and 0.3 of the critical step;
MuJoCo at a tenth of its step agrees with it.
"""

import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import dem_peers
import numpy as np
from peers import has

from extrados.core import dem
from extrados.core.ground import Ground
from extrados.model.geometry.assembly import Assembly
from extrados.model.structures.arch import make_arch
from extrados.model.structures.brickwork import Bond, make_brickwork
from extrados.model.structures.masonry import make_column
from extrados.views.rigid import rigid_bodies

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "unit"))
from dem_models import G, cosine, housner, pieces


@dataclass(frozen=True)
class Case:
    """A structure, its ground motion, the block followed, simulated times [s]: for speed, for error, for LMGC90."""

    assembly: Assembly
    ground: Ground
    follow: int
    speed: float
    window: float
    slow: float
    stiffness: float
    beta: float
    peer_steps: tuple[float, ...] = (1e-3, 1e-4)
    rigid_steps: tuple[float, ...] = ()  # of rigid contacts [s]
    fraction: float = 0.8

    @property
    def refined(self) -> float:
        """Stiffness of the refined solution [Pa/m]."""
        return 2e11 if len(self.assembly.mass) > 100 else 2e12

    def bodies(self, stiffness: float, beta: float) -> dem.Bodies:
        r = rigid_bodies(self.assembly)
        law = dem.Law(stiffness, stiffness, dem_peers.FRICTION, damping=beta)
        return dem.Bodies(r.centroid, r.mass, r.inertia, r.parts, r.owner, r.outer, r.depth, [law])


#: Seconds that LMGC90 may take.
PATIENCE = 120
SHAKE = cosine(0.5 * G, 10.88)
PULSE = pieces([0.0, 0.2, 0.6], [-G, 0.5 * G])
RIGID = (8e-3, 2e-3)
# Damped above critical: rigid blocks that strike without rebound, as the peers model them. The implicit dashpots
# make that free of cost.
CASES = {
    "block": Case(make_column(1.0, [4.0]), SHAKE, 0, 5.0, 5.0, 5.0, 1e10, 6e-3),
    "column of 10": Case(make_column(1.0, [0.4] * 10), SHAKE, 9, 3.0, 1.0, 1.0, 5e10, 3e-3, rigid_steps=RIGID),
    "arch of 7": Case(make_arch(10.0, 1.5, 157.5, 7), PULSE, 3, 3.0, 0.4, 0.5, 1.5e11, 3e-3, rigid_steps=RIGID),
    "arch of 60": Case(make_arch(10.0, 1.5, 157.5, 60), PULSE, 30, 0.6, 0.4, 0.1, 1e10, 3e-3, rigid_steps=RIGID),
    # At 1e-3 s MuJoCo's wall falls apart; half of that is its largest step that does not.
    "wall of 420": Case(make_brickwork(Bond(0.5, 0.25), 5.0, 10.0, (), 2000.0, 1.0), PULSE, 409, 0.3, 0.3, 0.01, 6e10, 3e-3, (5e-4,)),
}


def ours(case: Case, end: float, stiffness: float, beta: float, fraction: float, rigid_step: float = 0.0) -> tuple[float, dem.Run]:
    """Wall time of the motion alone (settling is timed by a run of one step and taken off), and the run."""
    bodies = case.bodies(stiffness, beta)
    times = np.linspace(0.0, end, 401)

    def go(length: float) -> tuple[float, dem.Run]:
        options = dem.Options(length, fraction=fraction, settle_tolerance=1e-4, residual_limit=0.5, rigid=rigid_step > 0.0, step=rigid_step)
        begin = time.perf_counter()
        run = dem.run(bodies, options, case.ground, times=times[times <= length])
        return time.perf_counter() - begin, run

    before = min(go(1e-6)[0] for _ in range(3))
    found = [go(end) for _ in range(3)]
    return max(min(seconds for seconds, _ in found) - before, 1e-9), found[0][1]


def displacement(run: dem.Run, follow: int) -> np.ndarray:
    return run.place[:, follow, :2] - run.settled[follow, :2]


def error(time_axis: np.ndarray, moved: np.ndarray, reference: tuple[np.ndarray, np.ndarray], window: float) -> float:
    """RMS distance from the reference over its greatest displacement, in the window."""
    t, exact = reference
    use = t <= window
    apart = np.stack([np.interp(t[use], time_axis, moved[:, i]) - exact[use, i] for i in (0, 1)], axis=1)
    return float(np.sqrt((apart**2).sum(axis=1).mean()) / np.hypot(*exact[use].T).max())


def _lmgc90(name: str, end: float, dt: float) -> dem_peers.Answer | None:
    with tempfile.TemporaryDirectory() as folder:
        out = f"{folder}/answer.npz"
        command = [sys.executable, dem_peers.__file__, name, str(end), str(dt), out]
        try:
            run = subprocess.run(command, capture_output=True, timeout=PATIENCE, check=False)
        except subprocess.TimeoutExpired:
            return None
        if run.returncode or not os.path.exists(out):
            return None
        data = np.load(out)
        return dem_peers.Answer(float(data["seconds"]), data["time"], data["moved"])


def one(name: str, case: Case) -> None:
    n = len(case.assembly.mass)
    seconds, run = ours(case, case.speed, case.stiffness, case.beta, case.fraction)
    ahead = case.speed / seconds
    if name == "block":
        t = np.linspace(0.0, 5.0, 401)
        alpha = np.arctan(0.25)
        exact = housner(1.0, 4.0, 0.5 * G, 10.88, t)

        def wrong(axis: np.ndarray, moved: np.ndarray) -> float:
            # The centre of a block that rocks by theta: sideways H/2 sin + the toe's share; invert by interpolation.
            turn = np.linspace(-0.2, 0.2, 4001)
            side = 2.0 * np.sin(turn) + np.sign(turn) * 0.5 * (1.0 - np.cos(turn))
            found = np.interp(np.interp(t, axis, moved[:, 0]), side, turn)
            return float(np.sqrt(np.mean((found - exact) ** 2)) / alpha)
    else:
        fine = ours(case, case.window, case.refined, 1e-4, 0.3)[1]
        reference = (fine.time, displacement(fine, case.follow))

        def wrong(axis: np.ndarray, moved: np.ndarray) -> float:
            return error(axis, moved, reference, case.window)

    def told(answer: dem_peers.Answer) -> str:
        return f"{wrong(answer.time, answer.moved):.1e}" if answer.time[-1] > 0.99 * case.window else "- (too slow to run that far)"

    mine = wrong(run.time, displacement(run, case.follow))
    print(f"{name}: {n} blocks")
    print(
        f"  extrados  step {run.step:.1e} s  {ahead:9.2f} x real time  {n * run.steps / seconds:9.2e} block-steps/s  error {mine:.1e}  "
        f"energy residual {run.residual:.1e}"
    )
    aheads = {"springs": ahead}
    for step in case.rigid_steps:
        seconds, rigid = ours(case, case.speed, case.stiffness, case.beta, case.fraction, step)
        aheads[f"rigid contacts at {step:g} s"] = case.speed / seconds
        print(
            f"  rigid     step {step:.1e} s  {case.speed / seconds:9.2f} x real time  error "
            f"{wrong(rigid.time, displacement(rigid, case.follow)):.1e}  energy residual {rigid.residual:.1e}"
        )

    def faster(rate: float) -> str:
        return "times as fast: " + ", ".join(f"{solver} {found / rate:.1f}" for solver, found in aheads.items())

    for dt in case.peer_steps if has("mujoco") else ():
        length = max(case.window, case.speed if dt > 5e-4 else 0.0)
        peer = dem_peers.mujoco(case.bodies(1e11, 1e-3), case.ground, length, dt, case.follow)
        rate = peer.time[-1] / peer.seconds
        print(f"  MuJoCo    step {dt:.0e} s    {rate:9.2f} x real time  error {told(peer)}  {faster(rate)}")
    if not has("mujoco"):
        print("  MuJoCo    not installed")
    if not has("compas_lmgc90"):
        print("  LMGC90    not installed")
        return
    slow = _lmgc90(name, case.slow, 1e-3)
    if slow is None:
        print(f"  LMGC90    no answer within {PATIENCE} s for {case.slow} s of motion")
        return
    rate = slow.time[-1] / slow.seconds
    print(f"  LMGC90    step 1e-03 s    {rate:9.3f} x real time  error {told(slow)}  {faster(rate)}")


def sizes() -> None:
    """Cost per block and step over the size of a wall, as it settles and shakes."""
    print("cost over size: walls of units in running bond, 1 thread")
    for rows in (5, 10, 20, 44):
        case = Case(make_brickwork(Bond(0.5, 0.25), 0.5 * rows, 0.25 * rows, (), 2000.0, 1.0), SHAKE, 0, 0.1, 0.1, 0.0, 5e9, 1e-3)
        bodies = case.bodies(5e9, 1e-3)
        n = len(case.assembly.mass)
        end = 40.0 / n
        found = []
        for _ in range(5):
            begin = time.perf_counter()
            run = dem.run(bodies, dem.Options(end, fraction=0.6, settle_steps=0, residual_limit=1e9), SHAKE)
            found.append((time.perf_counter() - begin) / (n * run.steps))
        print(f"  {n:5d} blocks  {1e9 * min(found):7.1f} ns per block and step ({run.steps} steps)")


def bricks() -> None:
    """How far behind real time a wall of a thousand bricks is, by processor time of one core."""
    assembly = make_brickwork(Bond(0.5, 0.25), 12.0, 10.0, (), 2000.0, 1.0)
    for stiffness in (1e10, 6e10):
        bodies = Case(assembly, PULSE, 0, 0.1, 0.1, 0.0, stiffness, 3e-3).bodies(stiffness, 3e-3)
        spent = []
        for end in (1e-6, 0.1):
            begin = time.process_time()
            run = dem.run(bodies, dem.Options(end, fraction=0.8, settle_tolerance=1e-4, residual_limit=0.5), PULSE)
            spent.append(time.process_time() - begin)
        print(
            f"wall of {len(assembly.mass)} bricks at {stiffness:.0e} Pa/m  {0.1 / (spent[1] - spent[0]):.2f} times real time  step {run.step:.1e} s  "
            f"energy residual {run.residual:.1e}"
        )


def main() -> None:
    for name, case in CASES.items():
        one(name, case)
    bricks()
    sizes()


if __name__ == "__main__":
    main()
