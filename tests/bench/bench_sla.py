"""Sequentially linear analysis: what an event takes against supernodal refactorisation at each event.

Both run in compiled code with the same criteria; ours changes the factor and looks at the regions that the event
concerns, the peer factorises and solves by CHOLMOD (supernodal, with BLAS) and looks at all points. Wall of n x n Q4
elements with an opening, weight and a push at the top. Processor time of one thread each: a busy machine then
disturbs neither.
"""

import os
import sys
import time

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.sla.model import build
from extrados.core.sla import EVENT, Freedoms, Model, Monitor, Plane, Softening, body_force
from extrados.decks.reader import make_deck
from extrados.model.structures.walls import Panel
from extrados.views.building import Building
from extrados.views.mesh.options import MeshOptions

WHOLE = {
    "structure": {
        "kind": "panel",
        "width": 3.0,
        "height": 3.0,
        "thickness": 0.2,
        "openings": [{"x": [1.0, 2.0], "y": [1.0, 2.0]}],
        "regions": [{"y": [2.9, 3.0], "linear": True}],
    },
    "material": {"young": 6.9e9, "poisson": 0.25, "density": 1950.0, "tensile_strength": 2e5, "fracture_energy": 50.0},
}
UNITS = {
    "structure": {"kind": "panel", "width": 3.0, "height": 3.0, "thickness": 0.2, "unit_length": 0.5, "unit_height": 0.25},
    "material": {"young": 6.9e9, "poisson": 0.25, "density": 1950.0},
    "mesh": {"joints": "interfaces"},
}
TORN = {"tension": 1e5, "fracture_energy": 20.0, "normal_stiffness": 8e10, "shear_stiffness": 3.6e10, "friction": "no-sliding"}
PUSH = {
    "kind": "sla",
    "ripple": 0.2,
    "constant": [{"kind": "gravity"}, {"kind": "pressure", "edge": "top", "value": "0.1 MPa"}],
    "reference": [{"kind": "spread", "edge": "top", "fx": "1 kN"}],
}
#: elements a side -> events by update, by refactorisation
SIZES = {52: (400, 40), 106: (200, 20), 212: (60, 8), 336: (30, 4)}


class Wall:
    """3 m x 3 m wall with a central opening of 1 m: the model and its loads."""

    def __init__(self, n: int):
        size = 3.0 / n
        building = Building(Panel(kind="panel", width=3.0, height=3.0, thickness=0.2, openings=[{"x": [1.0, 2.0], "y": [1.0, 2.0]}]))
        mesh = building.mesh(MeshOptions(size=size))
        block = mesh.groups[0]
        high = mesh.xy[block.connect].mean(axis=1)[:, 1] > 3.0 - (n // 30 + 1) * size
        law = Softening(0.2e6, 50.0, ripple=0.2, exact=False)
        self.xy = mesh.xy
        self.group = Plane("Q4", block.connect, 0.2, 6.9e9, 0.25, np.sqrt(2.0) * size, [None if top else law for top in high])
        self.constant = body_force("Q4", (2, 2), mesh.xy, block.connect, np.tile([0.0, -1.92e4 * 0.2], (len(block.connect), 1)))
        top = np.flatnonzero(mesh.xy[:, 1] > 3.0 - 1e-9)
        self.corner = int(top[mesh.xy[top, 0].argmax()])
        share = np.ones(len(top))
        share[[mesh.xy[top, 0].argmin(), mesh.xy[top, 0].argmax()]] = 0.5
        share /= share.sum()
        self.reference = np.zeros_like(self.constant)
        self.reference[top, 0] = 1e3 * share
        self.constant[top, 1] -= 0.1e6 * 0.2 * 3.0 * share
        base = np.flatnonzero(mesh.xy[:, 1] < 1e-9)
        self.freedoms = Freedoms.make(len(mesh.xy), [(int(k), d) for k in base for d in (0, 1)])

    def run(self, events: int, algorithm: str = "update", threads: int = 1):
        """Events, the seconds each took, equations, doubles of the factor."""
        with Model(self.xy, self.freedoms, [self.group], algorithm=algorithm, threads=threads) as model:
            model.loads(self.constant, self.reference)
            model.run(3, [Monitor.of(self.corner, 0)])
            begin = time.process_time()
            found = model.run(events, [Monitor.of(self.corner, 0)])
            return found, (time.process_time() - begin) / len(found), model.equations, model.factor_values


def against_refactorisation() -> None:
    """Time per event of both at four sizes, the largest difference of the loads, the growth with the size."""
    print("\nsla: per event, one thread; update against supernodal refactorisation")
    print(f"{'equations':>10} {'update ms':>10} {'refactor ms':>12} {'ratio':>7} {'factor MB':>10} {'load difference':>16}")
    rows = []
    for n, (many, few) in SIZES.items():
        wall = Wall(n)
        ours = [wall.run(many // 2) for _ in range(2)]
        peer = wall.run(few, "refactor")
        ours.append(wall.run(many // 2))
        fast, equations, values = float(np.median([o[1] for o in ours])), ours[0][2], ours[0][3]
        same = min(len(peer[0]), len(ours[0][0]))
        gap = float(np.abs(ours[0][0].load[:same] / peer[0].load[:same] - 1.0).max())
        rows.append((equations, fast, values))
        print(f"{equations:10d} {1e3 * fast:10.3f} {1e3 * peer[1]:12.2f} {peer[1] / fast:7.1f} {values * 8 / 1e6:10.1f} {gap:16.1e}")
        sys.stdout.flush()
    size, cost, memory = (np.log([row[k] for row in rows]) for k in range(3))
    print(
        f"growth with the number of equations: time per event ~ N^{np.polyfit(size, cost, 1)[0]:.2f}, "
        f"factor ~ N^{np.polyfit(size, memory, 1)[0]:.2f}"
    )


def rates() -> None:
    """Time per event and equation of walls of quadratic elements, and of units with joints, beside bilinear elements."""
    print("\nsla: time per event and equation; joints of no thickness, without sliding and until and as they slide")
    for size in (0.058, 0.028):
        for name, deck in {
            "Q4": WHOLE,
            "Q8": WHOLE | {"mesh": {"element": "Q8"}, "coarser": 1.6},
            "units, no sliding": UNITS | {"joints": TORN},
            "units, friction 0.7": UNITS | {"joints": TORN | {"friction": 0.7, "cohesion": 1.5e5, "shear_energy": 100.0}},
        }.items():
            deck = dict(deck)
            mesh = {"size": size * deck.pop("coarser", 1.0)} | deck.pop("mesh", {})
            context = Context(make_deck(deck | {"analysis": PUSH | {"mesh": mesh}}))
            options = context.deck.analyses[0]
            wall = build(context.building.mesh(options.mesh), options)
            with wall.open(options, 1) as model:
                model.loads(wall.constant, wall.reference)
                model.run(3, [wall.control])
                begin = time.process_time()
                found = model.run(200, [wall.control])
                each = (time.process_time() - begin) / len(found)
                slid = int((found.code >= EVENT["wear"]).sum())
            print(
                f"{name:>20} {model.equations:8d} equations {1e3 * each:8.3f} ms {1e9 * each / model.equations:7.1f} ns an "
                f"equation, {len(found)} events, {slid} of friction"
            )


def long_run() -> None:
    """4,000 events on 6.6 thousand equations, and what is left of the equations after 20,000."""
    wall = Wall(60)
    found, each, equations, _ = wall.run(4000)
    print(f"sla: 4000 events on {equations} equations: {4000 * each:.2f} s; energy imbalance {found.ledger_error:.1e}")
    found, each, _, _ = wall.run(20_000)
    print(
        f"sla: 20000 events: {20000 * each:.1f} s; relative residual {found.residual[-1]:.1e} without a new factor "
        f"(guard: {found.guard[0]} checks, {found.guard[1]} re-solutions, {found.guard[2]} new factors)"
    )


def main() -> None:
    against_refactorisation()
    rates()
    long_run()


if __name__ == "__main__":
    if os.environ.get("OPENBLAS_NUM_THREADS") != "1":  # BLAS reads it when it is loaded
        os.environ["OPENBLAS_NUM_THREADS"] = "1"
        os.execv(sys.executable, [sys.executable, "-u", *sys.argv])
    main()
