"""Shells of five layers beside plane elements: what an event takes per equation, and the memory of each.

The same wall with an opening, weight and a push at the top; that of the shell goes a little out of its plane. Processor
time of one thread each: a busy machine then disturbs neither.
"""

import sys
import time

import numpy as np
from bench_sla import Wall

from extrados.core import sla as core
from extrados.core.shell import node_frames
from extrados.views.shell.mesh import nodal_areas, spread

#: Elements a side of the plane wall and of the shell, of about as many equations; events
SIZES = ((100, 64, 600), (224, 148, 600))
LAYERS = 5


def shell(n: int, events: int) -> tuple[float, int, int]:
    """Seconds of an event, equations, doubles of the factor."""
    wall = Wall(n)
    xyz = np.column_stack([wall.xy[:, 0], 0.0 * wall.xy[:, 0], wall.xy[:, 1]])
    connect = wall.group.connect
    frames, flat = node_frames(xyz, [connect])
    shells = core.Shells("Q4", connect, 0.2, 6.9e9, 0.25, wall.group.band, wall.group.tension, frames=frames, flat=flat, layers=LAYERS)
    constant = spread(len(xyz), connect, nodal_areas(xyz, connect), np.tile([0.0, 0.0, -1.92e4 * 0.2], (len(connect), 1)))
    constant[:, 2] += (wall.constant - core.body_force("Q4", (2, 2), wall.xy, connect, np.tile([0.0, -1.92e4 * 0.2], (len(connect), 1))))[
        :, 1
    ]
    reference = np.zeros_like(constant)
    reference[:, 0], reference[:, 1] = wall.reference[:, 0], 0.02 * wall.reference[:, 0]
    base = np.flatnonzero(wall.xy[:, 1] < 1e-9)
    held = {(int(k), d) for k in base for d in range(6)} | {(k, 5) for k in range(len(xyz))}
    with core.Model(xyz, core.Freedoms.make(len(xyz), sorted(held), of_node=6), [shells]) as model:
        model.loads(constant, reference)
        watch = [core.Monitor.of(wall.corner, 0)]
        model.run(3, watch)
        begin = time.process_time()
        found = model.run(events, watch)
        return (time.process_time() - begin) / len(found), model.equations, model.factor_values


def main() -> None:
    print(f"\nshell: shells of {LAYERS} layers beside plane elements, per event and equation, one thread")
    print(f"{'plane eq.':>10} {'ns':>7} {'factor B':>9} {'shell eq.':>10} {'ns':>7} {'factor B':>9} {'ratio of ns':>12}")
    for n, m, events in SIZES:
        _, plane, of_plane, values = Wall(n).run(events)
        each, equations, doubles = shell(m, events)
        one, two = 1e9 * plane / of_plane, 1e9 * each / equations
        print(
            f"{of_plane:10d} {one:7.1f} {8 * values / of_plane:9.0f} {equations:10d} {two:7.1f} "
            f"{8 * doubles / equations:9.0f} {two / one:12.2f}"
        )
        sys.stdout.flush()


if __name__ == "__main__":
    main()
