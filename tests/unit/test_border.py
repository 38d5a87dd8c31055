"""The border to the core under abuse: every wrong use is an exception, and the interpreter lives on."""

import contextlib
import subprocess
import sys
import threading

import numpy as np
import pytest

from extrados import _core
from extrados.core import dem, dem_run, lists, rocking, sla
from extrados.core.errors import HandleError, status_list
from extrados.core.ground import Ground, MotionSet

SETUP = """
import copy, pickle, threading
import numpy as np
from extrados import _core
from extrados.core import arch, calls, dem, dem3, dem_run, errors, motion, rocking, sla
from extrados.core.ground import Ground, MotionSet

def plane(**change):
    values = dict(kind="Q4", connect=np.array([[0, 1, 2, 3]]), thickness=0.2, young=1e9, nu=0.2, band=0.5,
                  tension=sla.Softening(1e5, 50.0))
    return sla.Plane(**{**values, **change})

xy = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
held = [(0, 0), (0, 1), (1, 0), (1, 1)]
push = np.zeros((4, 2)); push[2, 0] = 1e3

def wall(*groups, freedoms=None):
    return sla.Model(xy, freedoms or sla.Freedoms.make(4, held), groups or [plane()])

def loaded():
    made = wall()
    made.loads(np.zeros((4, 2)), push)
    return made

def joint(kind, **change):
    values = dict(connect=np.array([[0, 1, 2, 3]]), normal=np.array([[0.0, 1.0]]), area=np.array([[0.5, 0.5]]), normal_stiffness=1e9,
                  shear_stiffness=1e9)
    return kind(**{**values, **change})
def in_space(*groups):
    xyz = np.column_stack([xy[:, 0], 0.0 * xy[:, 0], xy[:, 1]])
    return sla.Model(xyz, sla.Freedoms.make(4, held, of_node=6), list(groups))
watch = [sla.Monitor.of(2, 0)]
box = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
law = dem.Law(1e8, 1e8, 0.6, damping=1e-3)

def bodies(**change):
    values = dict(centroid=np.array([[0.5, 0.5], [0.5, -0.5]]), mass=np.array([2000.0, 0.0]),
                  inertia=np.array([300.0, 0.0]), parts=[box, box - [0.0, 1.0]], owner=[0, 1],
                  outer=[np.ones(4, bool)] * 2, depth=1.0, laws=[law])
    return dem.Bodies(**{**values, **change})

short = dem.Options(0.01)

def solid():
    cube = np.array([[x, y, z] for z in (0.0, 1.0) for x, y in ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))])
    faces = ((3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
    return dem3.Model(dem3.Solids(np.full((1, 3), 0.5), np.array([2000.0]), np.eye(3)[None] * 300.0, [cube], [faces], [0],
                                  [dem3.Law(1e8, 1e8, 0.6)]), dem3.Options(0.01, settle_steps=0))

def status_of(*answer):
    errors.check(answer[-1], "what was asked")
one = Ground(samples=np.zeros((1, 5)), step=0.01)
block = rocking.block_body(1000.0, 1500.0, 2.0, 0.5, 0.5, (0.9, 0.9))
"""

#: What is tried, and the exception that must come of it.
ABUSES = {
    # closed and copied objects
    "model closed: run": ("m = loaded(); m.close(); m.run(3, watch)", "HandleError"),
    "model closed: factorise": ("m = wall(); m.close(); m.factorise()", "HandleError"),
    "model closed: displacement": ("m = wall(); m.close(); m.displacement(1.0)", "HandleError"),
    "model closed: report": ("m = wall(); m.close(); m.report(1.0)", "HandleError"),
    "model closed: damage": ("m = wall(); m.close(); m.damage()", "HandleError"),
    "model closed: residual": ("m = wall(); m.close(); m.residual()", "HandleError"),
    "model closed: loads": ("m = wall(); m.close(); m.loads(push, push)", "HandleError"),
    "model copied": ("copy.copy(wall())", "TypeError"),
    "model copied deep": ("copy.deepcopy(wall())", "TypeError"),
    "model pickled": ("pickle.dumps(wall())", "TypeError"),
    "handle forged": ("m = wall(); m._handle = 12345; m.factorise()", "HandleError"),
    "handle negative": ("m = wall(); m._handle = -1; m.factorise()", "HandleError"),
    "handle of another kind": ("m, s = wall(), MotionSet([one]); m._handle = s.handle; m.factorise()", "HandleError"),
    "handle of a dead one": ("m = wall(); old = m.handle; m.close(); n = wall(); n._handle = old; n.factorise()", "HandleError"),
    "run before loads": ("wall().run(3, watch)", "HandleError"),
    "motions closed: ensemble": ("s = MotionSet([one]); s.close(); rocking.ensemble([block], s, [0], [0], 1.0, 1.0)", "HandleError"),
    "bodies closed: ensemble": ("b = rocking.BodyList([block]); b.close();rocking.ensemble(b, [one], [0], [0], 1.0, 1.0)", "HandleError"),
    "dem closed: run": ("m = dem.Model(bodies(), short); m.close(); m.run(MotionSet([one]))", "HandleError"),
    "dem state of a run that has ended": ("m = dem.Model(bodies(), short); m.run(MotionSet([one])); m.state()", "HandleError"),
    "dem state that is damaged": ("dem.Model(bodies(), short).run(MotionSet([one]), state=np.zeros(40))", "ValueError"),
    "dem state that is too short": (
        "w = np.zeros(20, int); dem.Model(bodies(), short).run(MotionSet([one]), state=np.r_[w, dem_run.state_digest(w)])",
        "ValueError",
    ),
    "dem read before a run": ("m = dem.Model(bodies(), short); m._last_run(False)", "HandleError"),
    "dem run before a start": (
        "status_of(*_core.api_dem_run.run(dem.Model(bodies(), short).handle, MotionSet([one]).handle, 1, 0, 1.0, 0))",
        "HandleError",
    ),
    "dem run after its end": (
        "m = dem.Model(bodies(), short); s = MotionSet([one]); m.run(s);"
        "status_of(*_core.api_dem_run.run(m.handle, s.handle, 1, 0, 1.0, 0))",
        "HandleError",
    ),
    "dem of solids asked for plane blocks": (
        "m = solid(); m.run(MotionSet([one])); status_of(*_core.api_dem.bodies(m.handle, 1))",
        "HandleError",
    ),
    "dem of solids built as plane blocks": (
        "status_of(_core.api_dem.surroundings(solid().handle, np.zeros(2), 0.0, 0, np.zeros(4)))",
        "HandleError",
    ),
    "dem of plane blocks asked for solids": (
        "m = dem.Model(bodies(), short); m.run(MotionSet([one])); status_of(*_core.api_dem3.bodies(m.handle, 2))",
        "HandleError",
    ),
    "dem state of plane blocks for solids": (
        "kept = []; m = dem.Model(bodies(), dem.Options(0.5)); w = MotionSet([one]);"
        "m.run(w, watch=lambda reached: kept.append(m.state())); solid().run(w, state=kept[0])",
        "ValueError",
    ),
    "dem history of rates that bodies have not": (
        "m = dem.Model(bodies(), short); m.run(MotionSet([one]));status_of(*_core.api_dem_run.history(m.handle, 2, 6, 1))",
        "CoreError",
    ),
    # indices
    "connectivity too high": ("wall(plane(connect=np.array([[0, 1, 2, 4]])))", "IndexError"),
    "connectivity negative": ("wall(plane(connect=np.array([[0, 1, 2, -1]])))", "IndexError"),
    "connectivity of another kind": ("wall(plane(connect=np.array([[0, 1, 2]])))", "ValueError"),
    "connectivity of fractions": ("wall(plane(connect=np.array([[0.0, 1.0, 2.0, 3.0]])))", "TypeError"),
    "joint of shells in the plane": ("wall(plane(), joint(sla.ShellJoints, row=np.zeros((1, 2, 3, 24))))", "CoreError"),
    "joint of the plane in space": ("in_space(joint(sla.Joints))", "CoreError"),
    "joint of shells without its vectors": ("in_space(joint(sla.ShellJoints))", "ValueError"),
    "joint of shells to nowhere": (
        "in_space(joint(sla.ShellJoints, row=np.zeros((1, 2, 3, 24)), connect=np.array([[0, 1, 2, 9]])))",
        "IndexError",
    ),
    "bar to nowhere": ("wall(plane(), sla.Bars(np.array([[0, 9]]), 0.1, 1e9))", "IndexError"),
    "spring to nowhere": ("wall(plane(), sla.Springs(np.array([[0, 7]]), np.array([[0, 0]]), np.array([1e6])))", "IndexError"),
    "spring below the ground": ("wall(plane(), sla.Springs(np.array([[0, -2]]), np.array([[0, 0]]), np.array([1e6])))", "IndexError"),
    "spring without direction": ("wall(plane(), sla.Springs(np.array([[2, -1]]), np.array([[2, 0]]), np.array([1e6])))", "IndexError"),
    "freedom held nowhere": ("sla.Freedoms.make(4, [(4, 0)])", "IndexError"),
    "freedom of direction -1": ("sla.Freedoms.make(4, [(0, -1)])", "IndexError"),
    "equation too high": ("f = sla.Freedoms.make(4, held); f.equation[3, 1] = 10**6; wall(freedoms=f)", "IndexError"),
    "equation below held": ("f = sla.Freedoms.make(4, held); f.equation[3, 1] = -7; wall(freedoms=f)", "IndexError"),
    "supports move that are not there": ("loaded().supports([1e-3], [0.0])", "ValueError"),
    "supports move by nothing known": (
        "f = sla.Freedoms.make(4, held); f.moved = 1; wall(freedoms=f).supports([np.nan], [0.0])",
        "ValueError",
    ),
    "more supports move than there are": ("f = sla.Freedoms.make(4, held); f.moved = 9; wall(freedoms=f)", "CoreError"),
    "fewer supports than none move": ("f = sla.Freedoms.make(4, held); f.moved = -1; wall(freedoms=f)", "CoreError"),
    "monitor node": ("loaded().run(3, [sla.Monitor.of(4, 0)])", "IndexError"),
    "monitor node negative": ("loaded().run(3, [sla.Monitor.of(-1, 0)])", "IndexError"),
    "monitor direction -1": ("loaded().run(3, [sla.Monitor.of(2, -1)])", "IndexError"),
    "monitor direction 2": ("loaded().run(3, [sla.Monitor.of(2, 2)])", "IndexError"),
    "no monitor": ("loaded().run(3, [])", "ValueError"),
    "room below zero": ("loaded().run(-5, watch)", "ValueError"),
    "room without end": ("loaded().run(2**31 - 1, watch)", "ValueError"),
    "loads of other nodes": ("wall().loads(np.zeros((3, 2)), np.zeros((3, 2)))", "ValueError"),
    "damage of other points": ("wall().set_damage(np.ones((11, 3)))", "ValueError"),
    "damage below the first tooth": ("m = wall(); m.set_damage(0.0 * m.damage())", "CoreError"),
    "damage of half a tooth": ("m = wall(); m.set_damage(m.damage() + 0.5)", "CoreError"),
    "damage beyond numbers": ("m = wall(); m.set_damage(m.damage() * 1e300)", "CoreError"),
    "damage not finite": ("m = wall(); m.set_damage(m.damage() * np.nan)", "ValueError"),
    "body force to nowhere": ("sla.body_force('Q4', (2, 2), xy, [[0, 1, 2, 9]], [[0.0, 1.0]])", "IndexError"),
    "ensemble of a body that is not there": ("rocking.ensemble([block], [one], [1], [0], 1.0, 1.0)", "IndexError"),
    "ensemble of a motion that is not there": ("rocking.ensemble([block], [one], [0], [-1], 1.0, 1.0)", "IndexError"),
    "ensemble of nothing": ("rocking.ensemble([block], [one], [], [], 1.0, 1.0)", "ValueError"),
    "start to no side": ("rocking.history(block, one, 1.0, 0.1, start_side=0)", "ValueError"),
    "start the wrong way": ("rocking.history(block, one, 1.0, 0.1, start_rotation=-0.1)", "ValueError"),
    "ensemble of unlike lengths": ("rocking.ensemble([block], [one], [0, 0], [0], 1.0, 1.0)", "ValueError"),
    "body without parameters": ("rocking.history(rocking.Body(2, np.ones(2)), one, 1.0, 0.1)", "CoreError"),
    "body of no kind": ("rocking.history(rocking.Body(77, np.ones(9)), one, 1.0, 0.1)", "CoreError"),
    "watched body of itself": ("rocking.history(rocking.Body(6, np.array([6.0, 2.0, 6.0, 0.0])), one, 1.0, 0.1)", "CoreError"),
    "watched body of too few numbers": (
        "rocking.history(rocking.Body(6, np.append([2.0, 9.0], [0, 1, 1, 2, 1, 1, 1, 1, 0, .01, 1, 1, 3, 16, .2, .2, .7, 1])), one, 1.0, 0.1)",
        "CoreError",
    ),
    "watched body of 1e300 joints": (
        "rocking.history(rocking.Body(6, np.append([2.0, 9.0], [0, 1, 1, 2, 1, 1, 1, 1, 0, .01, 1, 1, 1e300, 16, .2, .2])), one, 1.0, 0.1)",
        "CoreError",
    ),
    "watch of unlike sides": (
        "rocking.watched_body(rocking.block_body(1., 1., 1., .2, .2, (1., 1.)), (np.zeros((5, 1, 3, 3)), np.zeros((5, 2, 3, 3))), (.2, .2), "
        "np.ones(1), .01)",
        "ValueError",
    ),
    "history without end": ("rocking.history(block, one, 1e300, 1e-9)", "ValueError"),
    "history of room below zero": ("rocking.history(block, one, 1.0, 0.1, room=-1)", "ValueError"),
    "threads of the whole world": ("rocking.ensemble([block], [one], [0], [0], 1.0, 1.0, threads=10**9)", ""),
    "no threads": ("rocking.ensemble([block], [one], [0], [0], 1.0, 1.0, threads=0)", "ValueError"),
    "joint of bodies that are not there": ("dem.run(bodies(joints={(0, 5): 0}), short)", "IndexError"),
    "joint of a body with itself": ("dem.run(bodies(joints={(0, 0): 0}), short)", "CoreIndexError"),
    "joint of a law that is not there": ("dem.run(bodies(joints={(0, 1): 3}), short)", "ValueError"),
    "part of a body that is not there": ("dem.run(bodies(owner=[0, 2]), short)", "IndexError"),
    "part of two corners": ("dem.run(bodies(parts=[box[:2], box], outer=[np.ones(2, bool), np.ones(4, bool)]), short)", "CoreError"),
    "edges of another part": ("dem.run(bodies(outer=[np.ones(3, bool)] * 2), short)", "ValueError"),
    "move of a block": ("dem.run(bodies(), short, moves=(dem.SupportMove(0, (1, 0, 0), 0, 1),))", "CoreIndexError"),
    "move of nobody": ("dem.run(bodies(), short, moves=(dem.SupportMove(-1, (1, 0, 0), 0, 1),))", "IndexError"),
    "move in no time": ("dem.run(bodies(), short, moves=(dem.SupportMove(1, (1, 0, 0), 0, 0),))", "CoreError"),
    "times backwards": ("dem.run(bodies(), short, times=np.array([0.01, 0.0]))", "ValueError"),
    "motion that is not in the set": ("dem.Model(bodies(), short).run(MotionSet([one]), 1)", "IndexError"),
    "hinge in a joint that is not there": (
        "arch.restitution(np.ones(3), np.random.rand(3, 2), np.ones(3), np.array([0, 1, 2, 9]),"
        " np.random.rand(4, 2), np.random.rand(4, 2))",
        "CoreIndexError",
    ),
    # shapes
    "ground of three channels": ("rocking.history(block, Ground(samples=np.zeros((3, 5)), step=0.01), 1.0, 0.1)", "ValueError"),
    "ground of no channel": ("rocking.history(block, Ground(samples=np.zeros((0, 5)), step=0.01), 1.0, 0.1)", "ValueError"),
    "ground of three channels in pieces": (
        "MotionSet([Ground(breaks=[0.0, 1.0], linear=np.zeros((1, 3, 2)), harmonic=np.zeros((1, 3, 0, 4)))])",
        "ValueError",
    ),
    "ground of nothing": ("MotionSet([Ground()])", "ValueError"),
    "ground of one sample": ("MotionSet([Ground(samples=np.zeros((1, 1)), step=0.01)])", "ValueError"),
    "ground that is not finite": ("MotionSet([Ground(samples=np.full((1, 5), np.nan), step=0.01)])", "ValueError"),
    "ground of breaks that do not ascend": ("MotionSet([Ground(breaks=[0.0, 1.0, 1.0], linear=np.zeros((2, 1, 2)))])", "ValueError"),
    "no ground": ("MotionSet([])", "ValueError"),
    "too short a lattice": ("motion.line_spectrum([1.0], [1.0], [[1.0]], 5.0, [1.0])", "CoreError"),
    "transform of a great prime": ("motion.fourier(np.ones(3), 2**31 - 1)", "ValueError"),
    "envelope of more than memory": ("motion.envelope('trapezoid', [0.0, 1.0, 0.0, 0.0], 2**31 - 1, 0.01)", "ValueError"),
    "phases of more than memory": ("motion.phases(1, 0, 2**31 - 1)", "ValueError"),
    "back from a great prime": ("motion.fourier_inverse(np.ones(50002), 100003)", "ValueError"),
    "transform of more than memory": ("motion.fourier(np.ones(3), 2**30)", "ValueError"),
    "transform of another length": ("motion.fourier_inverse(np.ones(3), 100)", "ValueError"),
}


def test_abuse_is_answered_with_an_exception() -> None:
    """All abuses one after the other in a process of their own; the one that kills it is named."""
    lines = [SETUP]
    for name, (code, _) in ABUSES.items():
        lines.append(f"print({name!r}, end=chr(9), flush=True)")
        lines.append(f"try:\n    exec({code!r})\nexcept Exception as e:\n    print(type(e).__name__, flush=True)")
        lines.append("else:\n    print('', flush=True)")
    child = subprocess.run([sys.executable, "-c", "\n".join(lines)], capture_output=True, text=True)
    seen = dict(line.split("\t") for line in child.stdout.splitlines() if line)
    last = list(seen)[-1] if seen else "the set-up"
    assert child.returncode == 0, f"'{last}' ended the process with {child.returncode}: {child.stderr[-2000:]}"
    assert seen == {name: expected for name, (_, expected) in ABUSES.items()}


def small_wall() -> sla.Model:
    xy = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    freedoms = sla.Freedoms.make(4, [(0, 0), (0, 1), (1, 0), (1, 1)])
    return sla.Model(xy, freedoms, [sla.Plane("Q4", np.array([[0, 1, 2, 3]]), 0.2, 1e9, 0.2)])


def test_handles_are_never_given_twice() -> None:
    seen = set()
    for _ in range(200):
        with MotionSet([Ground(samples=np.zeros((1, 2)), step=1.0)]) as motions:
            assert motions.handle not in seen
            seen.add(motions.handle)


def test_forgotten_and_failed_objects_are_given_back() -> None:
    before = _core.api_support.handle_count()
    for _ in range(20):
        small_wall()
        with pytest.raises(ValueError):
            MotionSet([Ground()])
    model = small_wall()
    assert _core.api_support.handle_count() == before + 1
    model.close()
    model.close()
    assert model.closed and _core.api_support.handle_count() == before


def until_busy(handle: int, thread: threading.Thread) -> None:
    """Wait until the run of another thread has taken its model."""
    while status_list()[_core.api_dem_run.summary(handle)[2]][0] != "busy":
        assert thread.is_alive(), "the run ended before it was seen"


def shake(model: int, motions: int) -> None:
    """Run a model until that is stopped; again where who looks whether it runs had it at that moment."""
    while status_list()[_core.api_dem_run.run(model, motions, 1, 0, 1.0, 0)[2]][0] == "busy":
        pass


def long_run() -> tuple[dem.Model, MotionSet]:
    """A model that shakes for an hour."""
    box = np.array([[-0.5, 0.0], [0.5, 0.0], [0.5, 4.0], [-0.5, 4.0]])
    floor = np.array([[-20.0, -1.0], [20.0, -1.0], [20.0, 0.0], [-20.0, 0.0]])
    bodies = dem.Bodies(
        np.array([[0.0, 2.0], [0.0, -0.5]]),
        np.array([8000.0, 0.0]),
        np.array([11333.0, 0.0]),
        [box, floor],
        [0, 1],
        [np.ones(4, bool)] * 2,
        1.0,
        [dem.Law(1e12, 1e12, 2.0, damping=1e-4)],
    )
    ground = Ground(breaks=np.array([0.0, 3600.0]), linear=np.zeros((1, 1, 2)), harmonic=np.array([[[[5.0, 0.0, 10.88, 0.0]]]]))
    return dem.Model(bodies, dem.Options(3600.0, 0.5)), MotionSet([ground])


def test_an_object_in_use_is_neither_used_nor_closed_by_another_thread() -> None:
    model, motions = long_run()
    runs: list[dem.Run] = []

    def run() -> None:
        while not runs:
            with contextlib.suppress(HandleError):  # who looks whether it runs has it at that moment
                runs.append(model.run(motions))

    thread = threading.Thread(target=run)
    thread.start()
    try:
        until_busy(model.handle, thread)
        with pytest.raises(HandleError, match="another call is using it"):
            model.close()
        with pytest.raises(HandleError, match="another call is using it"):
            motions.close()
        with pytest.raises(HandleError, match="another call is using it"):
            model.run(motions)
        # Motions are shared by any number of calls.
        block = rocking.block_body(1000.0, 1500.0, 2.0, 0.5, 0.5, (0.9, 0.9))
        assert len(rocking.ensemble([block], motions, [0], [0], 1.0, 0.1).peak) == 1
    finally:
        while thread.is_alive():
            _core.api_support.set_cancel(1)
            thread.join(0.05)
        _core.api_support.set_cancel(0)
    assert runs and runs[0].interrupted
    model.close()
    motions.close()


def test_an_owner_that_is_gone_does_not_pull_the_object_from_under_a_call() -> None:
    """The core destroys what was forgotten in use when the call that uses it ends."""
    model, motions = long_run()
    before = _core.api_support.handle_count()
    assert _core.api_dem_run.start(model.handle, np.zeros(1)) == 0
    thread = threading.Thread(target=shake, args=(model.handle, motions.handle))
    handle = model.handle
    thread.start()
    until_busy(handle, thread)
    del model
    assert status_list()[_core.api_dem_run.summary(handle)[2]][0] == "closed_handle"
    assert _core.api_support.handle_count() == before
    while thread.is_alive():
        _core.api_support.set_cancel(1)
        thread.join(0.05)
    _core.api_support.set_cancel(0)
    assert _core.api_support.handle_count() == before - 1


def test_an_error_is_not_hidden_by_an_object_in_use() -> None:
    before = _core.api_support.handle_count()
    model, motions = long_run()
    assert _core.api_dem_run.start(model.handle, np.zeros(1)) == 0
    thread = threading.Thread(target=shake, args=(model.handle, motions.handle))
    thread.start()
    until_busy(model.handle, thread)
    with pytest.raises(KeyboardInterrupt), model, motions:
        raise KeyboardInterrupt
    assert model.closed and motions.closed
    while thread.is_alive():
        _core.api_support.set_cancel(1)
        thread.join(0.05)
    _core.api_support.set_cancel(0)
    assert _core.api_support.handle_count() == before


def test_runs_of_one_model_do_not_know_of_each_other() -> None:
    box = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    bodies = dem.Bodies(
        np.array([[0.5, 0.5], [0.5, -0.5]]),
        np.array([2000.0, 0.0]),
        np.array([300.0, 0.0]),
        [box, box - [0.0, 1.0]],
        [0, 1],
        [np.ones(4, bool)] * 2,
        1.0,
        [dem.Law(1e8, 1e8, 0.6, damping=1e-3)],
    )
    shake = Ground(samples=5.0 * np.sin(np.arange(50.0))[None], step=0.02)
    options = dem.Options(0.5, 0.05)
    with dem.Model(bodies, options) as model, MotionSet([shake]) as motions:
        first, second = model.run(motions), model.run(motions)
    alone = dem.run(bodies, options, shake)
    assert np.array_equal(first.place, second.place) and np.array_equal(first.place, alone.place)
    assert np.array_equal(first.contacts.force, alone.contacts.force)


def test_a_member_does_not_depend_on_the_motions_beside_it() -> None:
    """A pulse among sines is integrated as it is alone, bit for bit."""
    pulse = Ground(breaks=np.array([0.0, 0.3]), linear=np.array([[[4.0, 0.0]]]), harmonic=np.zeros((1, 1, 0, 4)))
    sine = Ground(breaks=np.array([0.0, 1.0]), linear=np.zeros((1, 1, 2)), harmonic=np.array([[[[3.0, 0.0, 6.0, 0.0]]]]))
    block = rocking.block_body(1000.0, 1500.0, 2.0, 0.5, 0.5, (0.9, 0.9))
    alone = rocking.ensemble([block], [pulse], [0], [0], 1.0, 3.0)
    among = rocking.ensemble([block], [sine, pulse], [0], [1], 1.0, 3.0)
    assert alone.peak[0] == among.peak[0] != 0.0


def test_no_call_takes_more_than_sixteen_arguments() -> None:
    """Lengths that f2py finds by itself, given in brackets, do not count."""
    for room in dir(_core):
        for name in dir(getattr(_core, room)) if room.startswith("api_") else ():
            text = (getattr(getattr(_core, room), name).__doc__ or "").splitlines()
            if not text or "(" not in text[0]:
                continue
            given = text[0].split("(")[1].split(")")[0].split("[")[0]
            answers = text[0].split(" = ")[0] if " = " in text[0] else ""
            count = sum(len([word for word in part.split(",") if word]) for part in (given, answers))
            assert count <= 16, f"{room}.{name} takes {count}"


def test_lists_are_whole() -> None:
    """Every list gives each number and each name once."""
    for title in ("status", "handle", "rocking_outcome", "rocking_event", "dem_stop", "dem_energy", "sla_event"):
        entries = lists.entries(title)
        assert len({e.number for e in entries}) == len({e.name for e in entries}) == len(entries) > 2
    assert rocking.OUTCOMES == ("no-hinging", "recovery", "collapse")
    assert sla.ELEMENTS == {"T3": 3, "Q4": 4, "T6": 6, "Q8": 8}
    assert dem_run.REASONS.index("blow-up") == lists.number("dem_stop", "blow_up") == 4
