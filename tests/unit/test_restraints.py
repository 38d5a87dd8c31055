"""Ties, dampers and added hinges of what rocks, beside SciPy and closed forms."""

import itertools
import tomllib

import numpy as np
import pytest
from restraint_oracle import GRAVITY, Spring, rock

import extrados
from extrados.core import mechanism as core_mechanism
from extrados.core.ground import Ground
from extrados.core.rocking import ensemble, history
from extrados.decks.reader import DeckError, read_text
from extrados.model.devices import AddedHinge, Damper
from extrados.model.properties import Initial, Joints, Supports
from extrados.model.structures.arch import Arch
from extrados.model.structures.block import Block
from extrados.model.ties import Tie
from extrados.views.building import Building
from extrados.views.rockers.block import block_model
from extrados.views.rockers.restraints import three_impacts

B, H = 0.5, 2.0  # half width and half height [m]
MASS = 2000.0 * 4.0 * B * H
R = float(np.hypot(B, H))
ALPHA = float(np.arctan2(B, H))
P = float(np.sqrt(0.75 * GRAVITY / R))
C_V = 1.0 - 1.5 * np.sin(ALPHA) ** 2
STEP = 0.05


def block(**tables) -> Building:
    """A block of 1 x 4 m."""
    return Building(Block(kind="block", width=2.0 * B, height=2.0 * H), **tables)


def line(start: tuple[float, float], ground: tuple[float, float]):
    """Length of a line from a point of the block to the ground, over that at rest, and its derivative by the rotation."""

    def path(side: int, q: float) -> tuple[float, float]:
        toe = np.array([side * B, 0.0])
        arm = np.array(start) - toe
        c, s = np.cos(q), -side * np.sin(q)
        turned = np.array([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]])
        moves = -side * np.array([-turned[1], turned[0]])
        now = toe + turned - np.array(ground)
        length = np.hypot(*now)
        return length - np.hypot(*(np.array(start) - ground)), float(now @ moves / length)

    return path


def of_block(side: int, q: float) -> tuple[float, float, float, float]:
    return (4.0 / 3.0 * MASS * R**2, 0.0, MASS * GRAVITY * R * np.sin(ALPHA - q), MASS * R * np.cos(ALPHA - q))


def samples(seed: int, count: int = 60) -> np.ndarray:
    """A rough motion of straight lines [m/s^2]."""
    noise = np.random.default_rng(seed).normal(size=count)
    return 5.0 * np.convolve(noise, np.hanning(7) / np.linalg.norm(np.hanning(7)), "same") * np.hanning(count)


TOP_LEFT, TOP = (-B, 2.0 * H), (0.0, 2.0 * H)
KINDS = {
    "elastic tendon": ([Tie(start=[*TOP], ground=[0.0, 0.0], stiffness=2e5)], [Spring(line(TOP, (0, 0)), 2e5, least=0.0, slack=True)]),
    "prestressed tendon": (
        [Tie(start=[*TOP], ground=[0.0, 0.0], stiffness=2e5, prestress=2e4)],
        [Spring(line(TOP, (0, 0)), 2e5, 2e4, least=0.0, slack=True)],
    ),
    "yielding tie of a facade": (
        [Tie(start=[*TOP_LEFT], ground=[-4.0, 4.0], stiffness=3e5, yield_force=8e3, prestress=2e3)],
        [Spring(line(TOP_LEFT, (-4, 4)), 3e5, 2e3, 8e3, 0.0, True)],
    ),
    "yielding spring both ways": (
        [Tie(start=[*TOP_LEFT], ground=[-4.0, 4.0], stiffness=3e5, yield_force=6e3, works_in="both")],
        [Spring(line(TOP_LEFT, (-4, 4)), 3e5, 0.0, 6e3, -6e3)],
    ),
    "viscous damper": ([Damper(start=[*TOP_LEFT], ground=[-3.0, 1.0], damping=4e3)], [Spring(line(TOP_LEFT, (-3, 1)), c=4e3)]),
    "viscous damper of the power 0.5": (
        [Damper(start=[*TOP_LEFT], ground=[-3.0, 1.0], damping=2e3, power=0.5)],
        [Spring(line(TOP_LEFT, (-3, 1)), c=2e3, n=0.5)],
    ),
    "friction damper": (
        [Damper(start=[*TOP_LEFT], ground=[-3.0, 1.0], slip_force=5e3, stiffness=1e6)],
        [Spring(line(TOP_LEFT, (-3, 1)), 1e6, 0.0, 5e3, -5e3)],
    ),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", [1, 2])
def test_a_restrained_block_rocks_as_scipy_says(kind: str, seed: int) -> None:
    tables, springs = KINDS[kind]
    tables = [one.model_copy(update={"name": "it", "start_stone": "block"}) for one in tables]
    ties = tuple(t for t in tables if isinstance(t, Tie))
    building = block(ties=ties, dampers=tuple(t for t in tables if isinstance(t, Damper)), initial=Initial(rotation_ratio=0.4))
    rocker = building.rocker()
    shaking = samples(seed)
    times = STEP * np.arange(len(shaking))
    got = history(rocker.body, Ground(samples=shaking[None], step=STEP), 4.0, 0.002, tolerance=1e-11, start_rotation=0.1)
    for s in springs:
        s.mode, s.set = "elastic", 0.0
        u, _ = s.path(1, 0.1)
        if not s.slack or s.trial(u) > s.most:
            s.set = u - np.clip(s.trial(u), s.least, s.most) / s.k + s.prestress / s.k if s.k else 0.0
        elif s.trial(u) < 0.0:
            s.mode = "slack"
    peaks, impacts, outcome = rock(
        of_block,
        springs,
        lambda t: np.interp(t, times, shaking, right=0.0),
        4.0,
        side=1,
        q=0.1,
        v=0.0,
        restitution=C_V,
        limit=2.0 * ALPHA,
        rest_rate=1e-3 * P * ALPHA,
        breaks=times,
        rtol=1e-10,
    )
    found = [t for k, t, _ in got.events if k == "impact"]
    n = min(len(found), len(impacts), 6)
    assert n >= 2 or outcome == "collapse"
    assert found[:n] == pytest.approx(impacts[:n], abs=2e-7)
    for first, last in itertools.pairwise(impacts[:n]):
        turned = [abs(x) for k, t, x in got.events if k == "peak" and first < t < last]
        assert max(turned) == pytest.approx(max(abs(x) for t, x in peaks if first < t < last), abs=1e-7)
    energy = got.kinetic + got.potential + got.stored
    loose = 1e-4 if "power" in kind else 1e-7
    assert np.abs(energy - energy[0] - got.ledger).max() < loose * energy.max()


def named(*tables):
    """Ties and dampers with the names that a reader of decks gives them, anchored in the block."""
    return tuple(one.model_copy(update={"name": f"it {k}", "start_stone": "block"}) for k, one in enumerate(tables))


def test_a_prestressed_tendon_raises_uplift_by_its_share_of_the_weight() -> None:
    """Down the middle: tan(alpha) (1 + prestress / weight) (Vassiliou and Makris 2015)."""
    rocker = block(ties=named(Tie(start=[0.0, 4.0], ground=[0.0, 0.0], stiffness=2e6, prestress=6e4))).rocker()
    assert rocker.uplift == pytest.approx(np.tan(ALPHA) * (1.0 + 6e4 / (MASS * GRAVITY)), rel=1e-12)


def test_a_stiff_tendon_has_no_rotation_of_no_return() -> None:
    """Above m g R / b of stiffness weight and tendon push back at every rotation up to collapse; a soft one falls short."""
    stiff, soft = (block(ties=named(Tie(start=[0.0, 4.0], ground=[0.0, 0.0], stiffness=k))).rocker().critical[0] for k in (2e6, 2e4))
    assert stiff == pytest.approx(2.0 * ALPHA)
    k, dl = 2e4, line(TOP, (0, 0))
    moment = MASS * GRAVITY * R * np.sin(ALPHA - soft) + k * np.prod(dl(1, soft))
    assert ALPHA < soft < 2.0 * ALPHA
    assert moment == pytest.approx(0.0, abs=1e-6 * MASS * GRAVITY * B)


def test_a_run_that_stops_when_safe_ends_as_the_whole_run() -> None:
    """Yielding ties, sliding dampers and a wall: 120 random motions."""
    ties = named(Tie(start=[*TOP_LEFT], ground=[-4.0, 4.0], stiffness=3e5, yield_force=8e3, prestress=2e3))
    dampers = named(Damper(start=[*TOP_LEFT], ground=[-3.0, 1.0], slip_force=2e3, stiffness=1e6))
    for supports in (Supports(), Supports(abutting_wall="left", rebound=0.5)):
        body = block(ties=ties, dampers=dampers, supports=supports).rocker().body
        grounds = [Ground(samples=3.0 * samples(seed)[None], step=STEP) for seed in range(60)]
        early, whole = (
            ensemble([body], grounds, np.zeros(60, int), np.arange(60), 1.0, 40.0, stop_when_safe=soon) for soon in (True, False)
        )
        assert (early.outcome == whole.outcome).all()
        assert len(set(early.outcome)) > 1
        assert early.peak == pytest.approx(whole.peak, abs=1e-12)
        assert early.settled.mean() > 0.8
        assert (early.stop_time <= whole.stop_time).all()


def test_added_hinges_of_an_arch_rock_as_scipy_says() -> None:
    """Equations of the mechanism from its kinematics, turns of the joints from the places of its parts."""
    arch = Arch(kind="arch", radius=10.0, thickness=1.5, embrace=157.5, voussoirs=7)
    hinge = AddedHinge(name="hinge", joints=["all"], damping=3e5, stiffness=1e6, yield_moment=4e4)
    rocker = Building(arch, hinges=(hinge,), joints=Joints(restitution=0.75)).rocker()
    model, held = rocker.model, rocker.restraints
    assert [m.name for m in held.members if m.points[0, 0] > 9.0] == ["hinge, joint 7"]

    def coefficients(side: int, q: float):
        c = model.coefficients(side, q)
        return c.mass[0], c.half_mass_slope[0], c.gravity_moment[0], c.drive[0]

    def turn(k: int):
        def path(side: int, q: float):
            u, du = held.paths(0 if side > 0 else 1, [max(q, 0.0)])
            return u[0, k], du[0, k]

        return path

    springs = [Spring(turn(k), 1e6, 0.0, 4e4, -4e4, c=3e5) for k in range(len(held.members))]
    shaking = np.array([[0.0, 6.0, -6.0, 0.0, 0.0]])
    got = history(rocker.body, Ground(samples=shaking, step=0.2), 2.0, 0.01, tolerance=1e-10)
    lift = next(t for kind, t, _ in got.events if kind == "uplift")
    side = int(next(x for kind, _, x in got.events if kind == "uplift"))
    times = 0.2 * np.arange(5)
    peaks, impacts, _ = rock(
        coefficients,
        springs,
        lambda t: np.interp(t + lift, times, shaking[0], right=0.0),
        0.9,
        side=side,
        q=0.0,
        v=1e-12,
        restitution=0.75,
        limit=0.1,
        rest_rate=1e-6,
        breaks=times - lift,
        rtol=1e-9,
    )
    found = [t - lift for kind, t, _ in got.events if kind == "impact"]
    assert found[: len(impacts)] == pytest.approx(impacts, abs=1e-6)
    assert impacts
    turned = max(abs(x) for kind, t, x in got.events if kind == "peak" and t < lift + impacts[0])
    assert turned == pytest.approx(max(abs(x) for t, x in peaks if t < impacts[0]), rel=1e-6)


def told(deck: str) -> list[tuple[str, str]]:
    return [(a["status"], a["reason"]) for a in extrados.run(tomllib.loads(deck)).analyses]


DECK = """
[structure]
kind = "block"
width = 0.6
height = 6.0
[supports]
abutting_wall = "left"
[motion]
kind = "sine-pulse"
amplitude = "0.3 g"
period = 0.6
[[analysis]]
kind = "rocking"
"""


def test_the_answer_names_the_rebound_that_it_rests_on() -> None:
    """Before a wall the impact rule of the joints plays no part."""
    for given, said in ((None, "rebound three impacts (method)"), (0.4, "rebound 0.4 (deck)")):
        deck = tomllib.loads(DECK)
        if given is not None:
            deck["supports"]["rebound"] = given
        (one,) = extrados.run(deck).results
        assert said in one.answer and "restitution" not in one.answer


def test_what_a_strategy_cannot_honour_is_refused_by_name() -> None:
    damper = "[[dampers]]\nstart = [-0.3, 5.0]\nstart_stone = 'block'\nground = [-3.0, 5.0]\ndamping = 100.0\n"
    for kind in ("tilt", "dem", "assessment", "rocking-spectrum"):
        ((status, reason),) = told(DECK.replace("rocking", kind))
        assert status == "refused" and f"supports.abutting_wall: {kind} cannot include [supports] abutting_wall" in reason, reason
        if kind == "dem":  # elements take dampers
            continue
        ((status, reason),) = told(damper + DECK.replace('[supports]\nabutting_wall = "left"\n', "").replace("rocking", kind))
        assert status == "refused" and "[[dampers]]" in reason and "rocking" in reason
    ((status, reason),) = told("[[ties]]\nstart = [-0.3, 5.0]\nstart_stone = 'block'\nground = [-3.0, 5.0]\nyield_force = 10.0\n" + DECK)
    assert status == "refused" and "requires a stiffness" in reason


def test_wrong_dampers_and_hinges_are_reported_with_their_line() -> None:
    for text, said in (
        ("[[dampers]]\nstart = [0.0, 5.0]\nground = [1.0, 5.0]", "expected either the key `damping`"),
        ("[[dampers]]\nstart = [0.0, 5.0]\nground = [1.0, 5.0]\nslip_force = 2.0", "require each other"),
        ("[[hinges]]\njoints = ['base']", "expected stiffness or damping"),
        ("[[hinges]]\njoints = ['base']\ndamping = 1.0\nyield_moment = 1.0", "yield_moment needs stiffness"),
    ):
        with pytest.raises(DeckError) as error:
            read_text((text + DECK).encode())
        assert said in str(error.value)
    ((_, reason),) = told("[[hinges]]\njoints = ['sole']\ndamping = 1.0\n" + DECK)
    assert "hinges.joints: hinge 1: joint 'sole' does not exist" in reason


def test_impacts_at_one_corner_after_the_other_end_at_the_wall() -> None:
    """A blow without rebound at each corner that approaches, in turn: the far toe, the top at the wall, the near toe, again and
    again, until nothing moves. The default rebound takes the first two as they are, then Housner's back to the near toe, which
    leaves more than all of them."""
    structure = Block(kind="block", mass=5000.0, inertia=9000.0, centre_height=2.0, toe_right=0.4, toe_left=0.25)
    model = block_model(Building(structure))
    b = model.block
    for side in (0, 1):
        way = 1.0 if side == 0 else -1.0  # it falls back from +x to a wall at -x, or the other way round
        near, far = (b.toe_right, b.toe_left) if side == 0 else (b.toe_left, b.toe_right)
        away, up = np.array([way, 0.0]), np.array([0.0, 1.0])
        corners = [(-far * away, up), (-far * away + 2.0 * b.centre_height * up, away), (near * away, up)]
        centre = b.centre_height * up

        def at(place: np.ndarray, velocity: np.ndarray, centre: np.ndarray = centre) -> np.ndarray:
            arm = place - centre
            return velocity[:2] + velocity[2] * np.array([-arm[1], arm[0]])

        velocity = np.array([-way * centre[1], way * (centre[0] - near * way), way])  # about the near toe
        assert at(corners[2][0], velocity) == pytest.approx(0.0, abs=1e-12)
        before, struck, rates = abs(velocity[2]), [], []
        for _ in range(60):
            approach = [k for k, (place, normal) in enumerate(corners) if normal @ at(place, velocity) < -1e-9]
            if not approach:
                break
            struck.append(approach[0])
            place, normal = corners[approach[0]]
            velocity = core_mechanism.inelastic_blow(
                b.mass,
                b.inertia,
                centre[None],
                [[0, -1]],
                np.array([[place, place]]),
                np.array([[normal, [normal[1], -normal[0]]]]),
                velocity[None],
            )[0]
            assert at(place, velocity) == pytest.approx(0.0, abs=1e-8)
            rates.append(way * velocity[2] / before)
        assert rates[0] == pytest.approx(model.restitution[1 - side], rel=1e-9)
        assert three_impacts(model, side) == pytest.approx(-rates[1] * model.restitution[side], rel=1e-9)
        assert struck[:3] == [0, 1, 2]
        assert abs(velocity[2]) < 1e-3 * before
        assert three_impacts(model, side) > 0.3


def test_a_block_before_a_wall_rocks_away_from_it_only() -> None:
    """Free rocking: at each return the rate is turned and multiplied by the default rebound."""
    building = Building(
        Block(kind="block", width=0.6, height=6.0), supports=Supports(abutting_wall="left"), initial=Initial(rotation_ratio=0.8)
    )
    rocker = building.rocker()
    a = np.arctan2(0.3, 3.0)
    rebound = (1.0 - 1.5 * np.sin(a) ** 2) ** 2 * abs(1.0 - 1.5 * np.cos(a) ** 2)
    assert rocker.restraints.rebound[0] == pytest.approx(rebound, rel=1e-12)
    still = Ground(samples=np.zeros((1, 2)), step=0.1)
    got = history(rocker.body, still, 20.0, 0.01, tolerance=1e-10, start_rotation=rocker.start_rotation)
    assert got.rotation.min() >= -1e-9
    assert got.settled and got.outcome == "recovery"
    # the energy of every half cycle is that before it times the square of the rebound
    peaks = np.array([0.8 * a, *(x for kind, _, x in got.events if kind == "peak")])
    r = np.hypot(0.3, 3.0)
    height = r * (np.cos(a - peaks) - np.cos(a))
    assert height[1:] / height[:-1] == pytest.approx(rebound**2, rel=1e-6)
    # pushed to the wall it stays
    push = Ground(samples=np.array([[0.0, 4.0, 4.0, 0.0]]), step=0.5)
    assert history(rocker.body, push, 3.0, 0.01).outcome == "no-hinging"
    assert history(rocker.body, push, 3.0, 0.01, scale=-1.0).outcome != "no-hinging"
