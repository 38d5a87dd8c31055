"""Dry friction without dilatancy: states, their residuals and bounds; certificates."""

import numpy as np
import pytest

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.limit.answer import CannotStand, assess
from extrados.limit.coulomb import CoulombProblem
from extrados.limit.equilibrium import spanning_tree
from extrados.limit.interior import RESIDUAL, CollapseProblem
from extrados.limit.loads import Loads, forces_at, tilt_loads
from extrados.limit.programme import LimitAnalysis, NoAnswer, NoEquilibrium
from extrados.limit.states import State
from extrados.limit.systems import Sparse
from extrados.model.geometry.assembly import Assembly
from extrados.model.structures.arch import make_arch
from extrados.model.structures.brickwork import Bond, make_brickwork
from extrados.model.structures.masonry import make_column

UNIT = (0.4, 0.175)  # Ferris and Tin-Loi (2001)


def bond(units: int, courses: int, begins: str = "half", holes=()) -> Assembly:
    return make_brickwork(Bond(*UNIT, begins, False), units * UNIT[0], courses * UNIT[1], holes)


def system_of(assembly: Assembly) -> Sparse:
    return Sparse(assembly, tilt_loads(assembly), spanning_tree(assembly))


#: associated (printed, and by an outside linear programme), non-associated (printed)
FERRIS_TIN_LOI = {
    1: (lambda: bond(5, 6), 0.64285, 0.63982),
    2: (lambda: bond(5, 10), 0.58000, 0.56262),
    3: (lambda: bond(4, 11, "whole", [(0.6, 1.0, 0.525, 1.4)]), 0.40369, 0.35582),
    4: (lambda: bond(5, 11, "half", [(0.4, 0.8, 0.525, 1.4), (1.2, 1.6, 0.525, 1.4)]), 0.33195, 0.29650),
}


@pytest.mark.parametrize("wall", FERRIS_TIN_LOI)
def test_printed_walls(wall: int) -> None:
    """Within 1e-4 of print where sliding dilates; within 1 % of print or below it where it does not."""
    make, associated, printed = FERRIS_TIN_LOI[wall]
    assembly = make()
    assert LimitAnalysis(assembly, 0.65).collapse()[0].gamma == pytest.approx(associated, abs=1e-4)
    limit = LimitAnalysis(assembly, 0.65, associated=False)
    state, mechanism = limit.collapse()
    found = limit.coulomb[1]
    assert found.residuals.worst < 1e-12
    assert state.gamma == pytest.approx(mechanism.upper_bound, abs=1e-12)
    assert 0.88 * printed < state.gamma < 1.01 * printed
    assert state.gamma == min(found.starts) and max(found.starts) < associated


def test_residuals_see_what_is_wrong() -> None:
    """Each residual answers to its own law."""
    assembly = bond(5, 6)
    problem = CoulombProblem(system_of(assembly), np.full(len(assembly.a), 0.65), 1)
    found = problem.least(2, 0.0)
    gamma, corners, twist, none = found.gamma, found.corners, found.twist.ravel(), np.empty(0)
    assert problem.residuals(gamma, corners, none, twist).worst < 1e-12
    assert problem.residuals(gamma + 1e-3, corners, none, twist).equilibrium > 1e-5
    assert problem.residuals(gamma + 1e-3, corners, none, twist).work > 1e-4
    pulled, sheared = corners.copy(), corners.copy()
    pulled[0, 0] -= 1.0
    sheared[0, 2] += 1.0
    assert problem.residuals(gamma, pulled, none, twist).tension > 0.1
    assert problem.residuals(gamma, sheared, none, twist).friction > 0.1
    assert problem.residuals(gamma, corners, none, -twist).overlap > 0.1
    dilatant = LimitAnalysis(assembly, 0.65, form="sparse")
    _, mechanism = dilatant.collapse()
    size = assembly.size
    x, y = assembly.centroid.T
    v = mechanism.velocity
    other = np.column_stack([(v[:, 0] + v[:, 2] * y) / size, (v[:, 1] - v[:, 2] * x) / size, v[:, 2]])
    assert problem.residuals(gamma, corners, none, other.ravel()).complementarity > 1e-3


def test_single_chains_show_no_difference() -> None:
    """Gilbert's semicircle of 27 blocks and Oppenheim's arch: dilatant and not, above and below where sliding begins."""
    for arch, frictions in ((make_arch(10.0, 1.5, 157.5, 7), (0.34, 0.42, 0.6)), (make_arch(1.0, 0.16, 180.0, 27), (0.36, 0.4, 0.7))):
        for friction in frictions:
            both = [LimitAnalysis(arch, friction, associated=a, starts=2).collapse()[0].gamma for a in (True, False)]
            assert both[1] == pytest.approx(both[0], abs=1e-7)


@pytest.mark.parametrize(("friction", "thickness"), [(0.5, 0.1068), (0.38, 0.1206), (0.34, 0.1612)])
def test_gilberts_arch(friction: float, thickness: float) -> None:
    """Least thickness over radius of the semicircle of 27 blocks by friction; it stands above and not below."""

    def stands(ratio: float) -> bool:
        try:
            answer = assess(make_arch(1.0, ratio, 180.0, 27), friction, associated=False)
        except CannotStand:
            return False
        return answer.gamma >= 0.0

    assert stands(thickness + 2e-4) and not stands(thickness - 2e-4)


@pytest.mark.parametrize("strength", [2e7, 2e6, 5e5])
def test_crushing_walls(strength: float) -> None:
    """A wall whose joints crush is answered by both rules, the rule without dilatancy below the other."""
    assembly = bond(5, 6)
    state, mechanism = LimitAnalysis(assembly, 0.65, strength=strength).collapse()
    assert state.gamma == pytest.approx(mechanism.upper_bound, abs=1e-8)
    without = LimitAnalysis(assembly, 0.65, strength=strength, associated=False, starts=3)
    least, _ = without.collapse()
    assert without.coulomb[1].residuals.worst < 1e-6
    assert 0.9 * state.gamma < least.gamma <= state.gamma + 1e-8
    pressed = state.normal * (1.0 - np.abs(2.0 * state.position - 1.0))
    assert (pressed <= strength * assembly.depth * assembly.length * (1.0 + 1e-6)).all()


def test_a_wall_of_many_bricks_that_crush() -> None:
    """240 bricks, which neither tangent planes nor the interior-point method settle: bounds meet, order and limit hold."""
    assembly = bond(12, 20)
    free = LimitAnalysis(assembly, 0.65).collapse()[0].gamma
    found = []
    for strength in (2e5, 1e6, 1e12):
        limit = LimitAnalysis(assembly, 0.65, strength=strength)
        state, mechanism = limit.collapse()
        assert state.gamma == pytest.approx(mechanism.upper_bound, abs=1e-8)
        pressed = state.normal * (1.0 - np.abs(2.0 * state.position - 1.0))
        assert (pressed <= strength * assembly.depth * assembly.length * (1.0 + 1e-6)).all()
        found.append(state.gamma)
    assert found[0] < found[1] < found[2] == pytest.approx(free, abs=1e-7)


def test_one_interior_point_method() -> None:
    """Dilatant friction by the interior-point method equals the linear programme, with crushing too."""
    arch = make_arch(10.0, 1.5, 157.5, 16)
    for strength in (None, 2e6):
        limit = LimitAnalysis(arch, 0.4, strength=strength)
        system = system_of(arch)
        crush = None if strength is None else system.loads.scale / (2.0 * strength * arch.depth * arch.length)
        problem = CollapseProblem(system, np.full(len(arch.a), 0.4), 1, crush, dilates=True)
        point, misfit = problem.state()
        assert misfit < RESIDUAL
        assert point.gamma == pytest.approx(limit.collapse()[0].gamma, abs=1e-8)


@pytest.mark.parametrize("units, courses, friction", [(4, 3, 0.65), (6, 8, 0.4), (3, 9, 0.8)])
def test_the_interior_point_method_settles_by_itself(units: int, courses: int, friction: float) -> None:
    """What is charged for its steps leaves no trace in the answer, which is that of a linear programme."""
    assembly = make_brickwork(Bond(0.5, 0.25, "whole", False), 0.5 * units, 0.25 * courses, ())
    limit = LimitAnalysis(assembly, friction, form="sparse")
    for direction in (1, -1):
        point, misfit = CollapseProblem(limit.system, limit._mu, direction, dilates=True).state()
        assert misfit < RESIDUAL
        exact = limit._by_programme(direction)[0].gamma
        assert direction * point.gamma == pytest.approx(exact, abs=1e-9)


def test_bounds_of_drucker() -> None:
    """Without friction a bonded wall carries nothing sideways; with dilatancy it bears most."""
    limit = LimitAnalysis(bond(4, 5), 0.6, associated=False, starts=3)
    lower, upper = limit.without_dilatancy_between(1)
    assert lower == pytest.approx(0.0, abs=1e-6)
    assert lower <= limit.collapse()[0].gamma <= upper + 1e-9


def test_a_joint_that_carries_nothing_needs_no_friction() -> None:
    """What rounding leaves on a head joint that parts is no force: two courses that slide at 0.65 need 0.65."""
    state = State(0.65, np.array([0.0, 1000.0]), np.array([2e-7, 650.0]), np.array([0.5, 0.5]), np.zeros(0))
    assert state.friction == pytest.approx([0.0, 0.65])
    few = State(0.65, np.array([1e-5, 1000.0]), np.array([1e-3, 650.0]), np.array([0.5, 0.5]), np.zeros(0))
    assert few.friction == pytest.approx([100.0, 0.65])


def test_the_bound_without_friction_is_reported_without_a_sign() -> None:
    data = {
        "structure": {"kind": "brickwork", "units": 4, "courses": 3, "unit_length": 0.5, "unit_height": 0.25},
        "joints": {"friction": 0.65},
        "analysis": [{"kind": "tilt", "friction_rule": "non-associated", "starts": 1}],
    }
    (result,) = run_analyses(Context(make_deck(data)))
    assert "without friction is 0.0000 g, and the upper bound with dilatancy is 0.6500 g" in result.answer


def test_certificate_obeys_virtual_work() -> None:
    """Where nothing can stand a motion proves it; where something stands there is none."""
    leaning = make_arch(1.0, 0.10, 180.0, 27)
    limit = LimitAnalysis(leaning, 0.7)
    twist = limit.certificate()
    system = system_of(leaning)
    unit = limit.loads.scale * np.array([1.0, 1.0, leaning.size])
    assert float((limit.loads.dead / unit * twist).sum()) > 1e-4
    motion = (system.matrix[:, :-1].T @ twist.ravel()).reshape(-1, 3)
    assert (motion[:, :2].min(axis=1) >= 0.7 * np.abs(motion[:, 2]) - 1e-9).all()
    assert LimitAnalysis(make_arch(1.0, 0.12, 180.0, 27), 0.7).certificate() is None
    with pytest.raises(CannotStand, match="certificate: a mechanism"):
        assess(leaning, 0.7)


def test_no_verdict_without_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    """A solver that finds nothing proves nothing."""
    column = make_column(1.0, [1.0, 1.0])
    limit = LimitAnalysis(column, 0.7)

    def fails(direction: int = 1):
        raise NoEquilibrium

    monkeypatch.setattr(limit, "collapse", fails)
    with pytest.raises(NoAnswer, match="neither an equilibrium state nor a collapse mechanism was found"):
        assess(column, limit=limit)


def test_a_load_may_pull_down_what_stands() -> None:
    """Point loads are loads of the certificate too."""
    column = make_column(1.0, [1.0, 1.0])
    loads = tilt_loads(column)
    pushed = Loads(loads.dead + forces_at(2, 1, np.array([0.0, 2.0]), (loads.scale, 0.0)), loads.live)
    assert LimitAnalysis(column, 0.7).certificate() is None
    assert LimitAnalysis(column, 0.7, loads=pushed).certificate() is not None


def test_a_stone_held_by_friction_alone_carries_nothing() -> None:
    """A stone between two piers, with nothing below it: it stands with dilatancy, which wedges it, and slides out without."""
    names = {"left": (0.0, 0.0, 1.0, 1.0), "right": (1.5, 0.0, 1.0, 1.0), "held": (1.0, 0.5, 0.5, 0.4)}
    stones = [{"name": name, "points": [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]} for name, (x, y, w, h) in names.items()]
    deck = {
        "structure": {"kind": "blocks", "block": stones},
        "joints": {"friction": 0.6},
        "analysis": [{"kind": "tilt"}, {"kind": "tilt", "friction_rule": "non-associated"}],
    }
    dilating, sliding = run_analyses(Context(make_deck(deck), threads=1))
    assert dilating.results.collapse_acceleration_g > 0.1
    assert sliding.status == "ok" and sliding.results.collapse_acceleration_g == 0.0
    assert sliding.results.non_dilatant.complementarity_residual < 1e-12
    assert sliding.results.non_dilatant.work_residual < 1e-9
    assert any("held is carried only by friction between its neighbours" in w for w in sliding.warnings)
