"""Figure of the forces of a run of discrete elements, in the plane or in space."""

from pathlib import Path

from extrados.results.dem import BlocksRun
from extrados.results.store import Stored
from extrados.show import style

SHOWN = 6


def draw_forces(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    """Reactions of the ground over time, and the energy lost by friction in the pairs that lost most."""
    r, time, reaction = run[name], run.array(name, "time"), run.array(name, "reaction")
    assert isinstance(r, BlocksRun)
    worked = [row for row in r.joint_work if row.friction_J > 0.0][:SHOWN]
    lost, names = run.array(name, "pair_friction_work"), run.array(name, "pair_name").astype(str).tolist()
    with style.figure(8.0, 6.0, rows=2, sharex=True) as (fig, (above, below)):
        for values, axis in zip(reaction.T, "xyz", strict=False):
            above.plot(time, values / 1e3, label=axis)
        above.set_ylabel("reaction of the ground [kN]")
        style.legend_above(above)
        for row in worked:
            below.plot(time, lost[:, names.index(row.name)], label=row.name)
        below.set_ylabel("lost by friction [J]")
        if worked:
            below.legend(loc="upper left", fontsize=7)
        below.set_xlabel("time [s]")
        below.set_xlim(0.0, float(time.max(initial=0.0)) or 1.0)
        saved = style.save(fig, folder, f"{name}-forces")
    return saved, "Force of the ground on the blocks, and the energy that pairs of blocks lost by friction: those that lost most."
