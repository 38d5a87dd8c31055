"""The collapse of a structure that cannot stand, or that is tilted beyond its capacity, calculated in time with rigid contacts.

The ground is tilted by theta = atan(gamma), so that gravity is g (sin theta, -cos theta) in the axes of the building. Beyond
the capacity the blocks start with the velocities of the collapse mechanism, scaled to a small speed; a structure that cannot
stand starts from rest. A level floor at the foot of the lowest support stops falling blocks. The run pauses between pieces,
so that the page shows the first piece while the next is calculated.
"""

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import measures
from extrados.analyses.dem.from_deck import make_model
from extrados.analyses.dem.model import Model
from extrados.analyses.dem.tables import Dem
from extrados.analyses.needs import complaints
from extrados.analyses.rocking.hand_over import level_of
from extrados.core import dem
from extrados.core.dem_run import STILL
from extrados.core.ground import as_motion_set
from extrados.explore.statics import Picture
from extrados.model.geometry.assembly import GROUND
from extrados.model.geometry.polygons import signed_area
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building

#: Duration of the fall [s], pictures a second, and duration of a piece [s]
DURATION, RATE, PIECE = 3.0, 30, 0.2
#: Greatest velocity of the mechanism at the start over sqrt(g size)
START = 0.01
#: Time of computing after which a fall is left incomplete [s]
PATIENCE = 20.0
#: Steps in which the smallest block falls by its own size; friction above which contacts would wedge [-]
STEPS, FRICTION = 120, 1.0
#: Blocks may go so many sizes of the structure away from it
REACH = 20.0


@dataclass(frozen=True)
class Piece:
    """A part of the fall: pose (pictures, blocks, 3) of the blocks at `time` (pictures) [s]; `stopped`: why the last ends early."""

    time: np.ndarray
    pose: np.ndarray
    last: bool
    stopped: str = ""


def begin_fall(context: Context, building: Building, made: Picture) -> Iterator[Piece]:
    """The collapse of the structure of a picture, piece by piece; Refused if rigid contacts do not accept the building."""
    assembly = made.assembly
    grounded = (assembly.a == GROUND) | (assembly.b == GROUND)
    level = level_of(assembly)
    floor = float(np.minimum(assembly.p[grounded, 1], assembly.q[grounded, 1]).min()) if level is None else level
    options = Dem(kind="dem", solver="nonsmooth", floor=floor, perturbed=False)
    if wrong := complaints(context, options, building):
        raise Refused(wrong[0])
    model = make_model(context.building, options)
    return _pieces(model, made.words["gamma"], _start(made, len(model.rigid.mass)))


def _start(made: Picture, bodies: int) -> np.ndarray:
    """Velocities (bodies, 3) at the start [m/s, rad/s]."""
    rate = np.zeros((bodies, 3))
    mechanism = (made.mechanisms or {}).get(made.words.get("falls", ""))
    if mechanism is not None:
        velocity = mechanism.velocity
        fastest = float(np.hypot(velocity[:, 0], velocity[:, 1]).max())
        rate[: len(velocity)] = velocity * (START * np.sqrt(GRAVITY * made.assembly.size) / fastest)
    return rate


def _pieces(model: Model, gamma: float, rate: np.ndarray) -> Iterator[Piece]:
    theta = float(np.arctan(gamma))
    outline = np.concatenate(model.assembly.outlines)
    low, high = outline.min(axis=0) - REACH * model.size, outline.max(axis=0) + REACH * model.size
    smallest = float(np.sqrt(min(abs(signed_area(outline)) for outline in model.assembly.outlines)))
    step = float(np.sqrt(2.0 * smallest / GRAVITY)) / STEPS
    options = dem.Options(
        end_time=DURATION,
        step=step,
        rigid=True,
        domain=(low[0], high[0], low[1], high[1]),
        residual_limit=np.inf,
        gravity=(GRAVITY * np.sin(theta), -GRAVITY * np.cos(theta)),
    )
    nothing = np.zeros_like(model.values.cohesion)  # the pictures of limit analysis have no mortar either
    values = replace(model.values, friction=np.minimum(model.values.friction, FRICTION), cohesion=nothing, tension=nothing)
    begin, shown = time.monotonic(), 0
    with dem.Model(model.bodies(values), options, shift=np.zeros_like(rate), rate=rate) as bodies, as_motion_set([STILL]) as motions:
        times = np.arange(round(DURATION * RATE) + 1) / RATE
        for run, whole in bodies.run_pieces(motions, times, round(PIECE / step)):
            late = not whole and time.monotonic() - begin > PATIENCE
            stopped = "time limit" if late else "" if run.reason == "end" or not whole else run.reason
            pose = measures.block_places(model, run.place[shown:])
            yield Piece(run.time[shown:], pose, whole or late, stopped)
            if late:
                return
            shown = len(run.time)
