"""Figures of local mechanisms: the capacity curve, and the checks."""

from pathlib import Path

from extrados.results.codes import LocalMechanism
from extrados.results.store import Stored
from extrados.show import style
from extrados.show.statistics import draw_code_checks


def draw_local_mechanism(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """a* over d* with what the checks ask, and demand over capacity of each."""
    r = run.results_of(name, LocalMechanism)
    with style.figure(6.2, 3.6) as (fig, (ax,)):
        ax.plot(run.array(name, "displacement"), run.array(name, "acceleration"), color=style.EDGE, label="capacity at finite rotations")
        if r.zero_displacement_m is not None and r.jurisdiction == "NTC":
            ax.plot(
                [0.0, r.zero_displacement_m],
                [r.activation_acceleration_g, 0.0],
                color=style.HINGE,
                linestyle="--",
                label="straight, to d_0*",
            )
            ax.axvline(r.ultimate_displacement_m, color=style.THRUST, linewidth=1.0, linestyle=":", label="d_SLV = 0.4 d_0*")
        check = r.checks.get("NTC nonlinear")
        if check is not None and check.demand is not None:
            ax.axvline(check.demand, color="#d98200", linewidth=1.2, label="demand S_D(T_SLV)")
        ax.set_xlim(0.0, None)
        ax.set_ylim(0.0, None)
        ax.set_xlabel("displacement d* [m]")
        ax.set_ylabel("acceleration a* [g]")
        ax.set_title("Capacity of the mechanism" if r.mechanism == "building" else f"Capacity: {r.mechanism.replace('-', ' ')}")
        style.legend_below(fig, ax)
        saved = style.save(fig, folder, f"{name}-capacity")
    straight = "; the straight line is the rule of the code" if r.jurisdiction == "NTC" else ""
    caption = f"Capacity curve of the equivalent oscillator, with the confidence factor{straight}."
    return [(saved, caption), *draw_code_checks(run, name, folder)]
