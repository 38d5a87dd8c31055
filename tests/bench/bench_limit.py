"""Limit analysis: whole answers, long arches, walls, surveys, against SciPy's full programme in the same run."""

import itertools
import time
from collections.abc import Callable

import numpy as np
from scipy import sparse
from scipy.optimize import linprog
from timing import processor, seconds

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.limit.answer import assess
from extrados.limit.equilibrium import spanning_tree
from extrados.limit.loads import tilt_loads
from extrados.limit.programme import LimitAnalysis
from extrados.limit.systems import Sparse
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.structures.aisled_vault import Aisle, make_church
from extrados.model.structures.arch import make_arch
from extrados.model.structures.blocks import Polygon, make_blocks


def church() -> Assembly:
    aisle = Aisle(4.3, 0.45, 150.0, 14, 6.0, 1.8, 8.5)
    return make_church(4.8, 0.6, 150.0, 20, 12.5, 1.9, aisle, aisle)


def wall(rows: int, columns: int) -> Assembly:
    """Running bond."""
    blocks = []
    for r in range(rows):
        edges = [0.5 * c for c in range(columns + 1)]
        if r % 2:
            edges = [0.0, *(0.25 + 0.5 * c for c in range(columns)), 0.5 * columns]
        y = 0.25 * r
        blocks += [
            Polygon(f"{r}/{c}", np.array([[a, y], [b, y], [b, y + 0.25], [a, y + 0.25]]))
            for c, (a, b) in enumerate(itertools.pairwise(edges))
        ]
    return make_blocks(blocks, None)


def whole_answer(assembly: Assembly):
    """Everything a drawing needs: states, mechanism, thrust lines, force polygons."""
    answer = assess(assembly)
    answer.lines(answer.collapse_state)
    answer.polygons(answer.collapse_state)
    return answer


def scipy_full(a: Assembly, friction: float | None = None) -> float:
    """Three equations per block, sparse, assembled here."""
    loads, m = tilt_loads(a), len(a.a)
    unit = loads.scale * np.array([1.0, 1.0, a.size])
    row, column, value = [], [], []
    directions = np.stack([a.normal, a.normal, a.tangent], axis=1)
    points = np.stack([a.p, a.q, a.middle], axis=1) / a.size
    moment = points[..., 0] * directions[..., 1] - points[..., 1] * directions[..., 0]
    wrench = np.concatenate([directions, moment[..., None]], axis=2)  # joint, corner, equation
    for ends, sign in ((a.a, 1.0), (a.b, -1.0)):
        held = np.flatnonzero(ends != GROUND)
        row.append((3 * ends[held][:, None, None] + np.arange(3)).repeat(3, axis=1).ravel())
        column.append((3 * held[:, None, None] + np.arange(3)[:, None]).repeat(3, axis=2).ravel())
        value.append(sign * wrench[held].ravel())
    live = (loads.live / unit).ravel()
    entries = (
        np.concatenate([*value, live]),
        (np.concatenate([*row, np.arange(len(live))]), np.concatenate([*column, np.full(len(live), 3 * m)])),
    )
    matrix = sparse.csr_array(entries, shape=(3 * len(a.mass), 3 * m + 1))
    cost = np.zeros(3 * m + 1)
    cost[-1] = -1.0
    cone = None
    if friction is not None:
        j = np.arange(m)
        one = np.ones(m)
        cone = sparse.vstack(
            [
                sparse.csr_array(
                    (
                        np.concatenate([-friction * one, -friction * one, s * one]),
                        (np.tile(j, 3), np.concatenate([3 * j, 3 * j + 1, 3 * j + 2])),
                    ),
                    shape=(m, 3 * m + 1),
                )
                for s in (1.0, -1.0)
            ]
        )
    bounds = [(0, None), (0, None), (None, None)] * m + [(None, None)]
    found = linprog(
        cost,
        A_ub=cone,
        b_ub=None if cone is None else np.zeros(2 * m),
        A_eq=matrix,
        b_eq=-(loads.dead / unit).ravel(),
        bounds=bounds,
        method="highs",
    )
    return -found.fun


def warm_highs(a: Assembly) -> Callable[[], float]:
    """HiGHS on three equations per block, started from its own last basis: a solve with the load reversed and back."""
    import highspy

    system = Sparse(a, tilt_loads(a), spanning_tree(a))
    n, rows = system.unknowns, sparse.csr_array(system.matrix)
    solver = highspy.Highs()
    solver.setOptionValue("output_flag", False)
    solver.setOptionValue("threads", 1)
    lower = np.zeros(n)
    lower[2::3] = lower[-1] = -highspy.kHighsInf
    solver.passModel(
        n,
        rows.shape[0],
        rows.nnz,
        int(highspy.MatrixFormat.kRowwise),
        int(highspy.ObjSense.kMinimize),
        0.0,
        np.zeros(n),
        lower,
        np.full(n, highspy.kHighsInf),
        system.right,
        system.right,
        rows.indptr.astype(np.int32),
        rows.indices.astype(np.int32),
        rows.data,
        np.zeros(n, dtype=np.int32),
    )
    sense = [1.0]

    def solve() -> float:
        sense[0] = -sense[0]
        solver.changeColCost(n - 1, -sense[0])
        solver.run()
        return sense[0] * solver.getObjectiveValue()

    return solve


def capacities_alone() -> None:
    """The capacity of one arch, warm: to one side and the other in turn, with its mechanism."""
    arch = make_arch(10.0, 1.5, 157.5, 36)
    limit, sense = LimitAnalysis(arch), [1]

    def mine() -> float:
        sense[0] = -sense[0]
        return limit.collapse(sense[0])[0].gamma

    peer = warm_highs(arch)
    own, highs, cold = (processor(call, 100) for call in (mine, peer, lambda: scipy_full(arch)))
    print(
        f"  capacity alone, warm, 36 voussoirs: {1e3 * own:.2f} ms of processor with the mechanism (goal 0.3 ms); HiGHS on "
        f"the full programme, warm, {1e3 * highs:.2f} ms, ratio {highs / own:.1f}; SciPy {1e3 * cold:.2f} ms, ratio "
        f"{cold / own:.0f}; difference {abs(abs(mine()) - scipy_full(arch)):.1e}"
    )


def walls_without_dilatancy() -> None:
    """One start of the search for states without dilatancy, and the residual it ends with."""
    for rows, columns in ((6, 4), (12, 8)):
        section = wall(rows, columns)
        limit = LimitAnalysis(section, 0.6, associated=False, starts=1)
        spent = processor(lambda limit=limit: limit.collapse(), 1)
        found = limit.coulomb[1]
        print(
            f"  wall of {len(section.mass)} stones without dilatancy: {1e3 * spent:.0f} ms of processor a start; {found.gamma:.4f} "
            f"g against {limit.without_dilatancy_between(1)[1]:.4f} g with it, worst residual {found.residuals.worst:.1e}",
            flush=True,
        )


def main() -> None:
    print("limit analysis (whole answer: capacity both ways, mechanism, thrust range, most central line, polygons)")
    for name, make, goal in (("arch of 36 voussoirs", lambda: make_arch(10.0, 1.5, 157.5, 36), 2.0), ("three-aisle section", church, 15.0)):
        answer = whole_answer(make())
        mine, alone = (seconds(lambda make=make: whole_answer(make())), processor(lambda make=make: whole_answer(make()), 15))
        peer = seconds(lambda make=make: scipy_full(make()))
        print(
            f"  {name}: {1e3 * mine:.2f} ms for all of it with geometry, {1e3 * alone:.2f} ms of processor (goal {goal:g} "
            f"ms); SciPy's full programme for the capacity alone {1e3 * peer:.2f} ms; gap {answer.gap:.1e}, difference "
            f"{abs(answer.gamma - scipy_full(make())):.1e}"
        )
    capacities_alone()
    walls_without_dilatancy()
    # SciPy needs minutes for the last: it is asked for a smaller wall instead.
    for name, assembly, friction, with_peer in (
        ("arch of 1000 voussoirs", make_arch(10.0, 1.5, 157.5, 1000), None, True),
        ("wall of 1020 stones, no sliding", wall(40, 25), None, True),
        ("wall of 102 stones, friction 0.6", wall(12, 8), 0.6, True),
        ("wall of 1020 stones, friction 0.6", wall(40, 25), 0.6, False),
    ):
        limit = LimitAnalysis(assembly, friction)
        state, mechanism = limit.collapse()
        mine = seconds(lambda a=assembly, f=friction: LimitAnalysis(a, f).collapse(), 1)
        alone = processor(lambda a=assembly, f=friction: LimitAnalysis(a, f).collapse(), 1)
        text = (
            f"  {name} ({type(limit.system).__name__.lower()}): {1e3 * mine:.1f} ms, {1e3 * alone:.1f} ms of processor "
            f"(goal 500 ms); gap {abs(state.gamma - mechanism.upper_bound):.1e}"
        )
        if with_peer:
            peer_value = scipy_full(assembly, friction)
            peer = seconds(lambda a=assembly, f=friction: scipy_full(a, f), 1)
            text += f"; SciPy {1e3 * peer:.1f} ms, ratio {peer / mine:.1f}, difference {abs(state.gamma - peer_value):.1e}"
        print(text, flush=True)
    for name, structure, span in (
        ("vaults", {"kind": "vault", "preset": "dejong-a"}, (4.0, 8.0)),
        ("three-aisle sections", {"kind": "aisled-vault", "preset": "vezelay-like"}, (1.2, 3.0)),
    ):
        analysis = {"kind": "sweep", "vary": "buttress_width", "start": span[0], "stop": span[1], "count": 200, "locate": False}
        deck = make_deck({"structure": structure, "analysis": analysis})
        begin = time.process_time()
        result = run_analyses(Context(deck, threads=1))[0]
        spent = time.process_time() - begin
        print(
            f"  {name} varied: {200.0 / result.seconds:.0f} sections a second, {200.0 / spent:.0f} a second of processor "
            f"(goal 500 on one core); largest gap {result['duality_gap']:.1e}"
        )


if __name__ == "__main__":
    main()
