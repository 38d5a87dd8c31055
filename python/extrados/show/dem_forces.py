"""Figure of the forces of a run of discrete elements, in the plane or in space."""

from pathlib import Path

from extrados.results.dem import BlocksRun
from extrados.results.store import Stored
from extrados.show import style

SHOWN = 6


def draw_forces(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    """Reactions of the ground over time, and the energy lost by friction in the pairs that lost most, if any."""
    r, time, reaction = run[name], run.array(name, "time"), run.array(name, "reaction")
    assert isinstance(r, BlocksRun)
    worked = [row for row in r.joint_work if row.friction_J > 0.0][:SHOWN]
    lost, names = run.array(name, "pair_friction_work"), run.array(name, "pair_name").astype(str).tolist()
    with style.figure(8.0, 6.0 if worked else 3.4, rows=1 + bool(worked), sharex=True) as (fig, axes):
        for values, axis in zip(reaction.T, "xyz", strict=False):
            axes[0].plot(time, values / 1e3, label=axis)
        axes[0].set_ylabel("reaction of the ground [kN]")
        style.legend_above(axes[0])
        for row in worked:
            axes[-1].plot(time, lost[:, names.index(row.name)], label=row.name)
        if worked:
            axes[-1].set_ylabel("lost by friction [J]")
            axes[-1].legend(loc="upper left", fontsize=7)
        axes[-1].set_xlabel("time [s]")
        axes[-1].set_xlim(0.0, float(time.max(initial=0.0)) or 1.0)
        saved = style.save(fig, folder, f"{name}-forces")
    return saved, "Force of the ground on the blocks" + (
        ", and energy lost by friction, for the pairs of blocks that lost most."
        if worked
        else ". No pair of blocks loses energy by friction."
    )
