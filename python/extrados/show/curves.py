"""Figures of failure curves beside each other (Figs 5-4, 5-5, 5-14 and 5-15)."""

from pathlib import Path

import numpy as np

from extrados.results.rocking import FailureCurves
from extrados.results.store import Stored
from extrados.show import style

LINES = ("-", "--", "-.", ":")
#: Places of a legend outside of which curves would be hidden
MOST_IN_AXES = 8
#: Arrays of fitted curves, their names and lines
FITS = (("fit", "Eq. 5.5 fitted", "-"), ("criterion", "Eq. 5.8, Table 5.3", ":"))


def draw_failure_curves(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """The curves with the primary impulses of the motions, and the same over natural time and uplift."""
    import matplotlib

    r = run.results_of(name, FailureCurves)
    duration, amplitude = run.array(name, "duration"), run.array(name, "amplitude")
    natural, slender = run.array(name, "natural_time"), bool(run.array(name, "slender").all())
    first = {"step": "duration t_p of the first part of the pulse [s]", "rectangular": "duration t_p [s]"}.get(r.pulse, "period T_p [s]")
    # beyond 0.6 of the map a line has less than three times the contrast to paper
    shades = matplotlib.colormaps["cividis"](np.linspace(0.0, 0.6, len(r.curves)))
    fits = [(text, run.array(name, key), line) for key, text, line in FITS if key in run.arrays[name]]
    top = 1.1 * max([np.nanmax(amplitude, initial=0.0), *(abs(i.amplitude_g) for i in r.impulses)])
    with style.figure(9.0, 4.6, columns=2, width_ratios=[1.25, 1]) as (fig, (plain, scaled)):
        for k, curve in enumerate(r.curves):
            look = {"color": shades[k], "linestyle": LINES[k % len(LINES)]}
            if fits:
                plain.plot(duration[k], amplitude[k], "o", markersize=4, color=shades[k], label=curve.label)
                for text, values, line in fits:
                    plain.plot(duration[k], values[k], line, color=shades[k], label=f"{curve.label}: {text}")
            else:
                plain.plot(duration[k], amplitude[k], label=curve.label, **look)
            plain.axhline(curve.uplift_acceleration_g, color=shades[k], linewidth=0.6, linestyle=":")
            ratio = amplitude[k] / curve.uplift_acceleration_g
            scaled.plot(2.0 * np.pi * natural[k] / duration[k] if slender else duration[k] / natural[k], ratio, **look)
        places = np.array([(i.period_s, abs(i.amplitude_g)) for i in r.impulses]).reshape(-1, 2)
        if len(places):
            falls = [sum(c.run_outcomes[k] == "collapse" for c in r.curves) for k in range(len(places))]
            for marker, colour, text, some in (
                ("o", style.THRUST, "causes collapse of all structures", [k for k, n in enumerate(falls) if n == len(r.curves)]),
                ("^", style.MODES[2], "causes collapse of some structures", [k for k, n in enumerate(falls) if 0 < n < len(r.curves)]),
                ("s", style.SAFE, "causes no collapse", [k for k, n in enumerate(falls) if n == 0]),
            ):
                if some:
                    plain.plot(
                        *places[some].T,
                        marker,
                        color=colour,
                        markeredgecolor=style.EDGE,
                        markersize=5,
                        label=f"impulse of a motion that {text}",
                    )
            style.letters(plain, places, [str(k + 1) for k in range(len(places))], style.EDGE)
        plain.set_ylim(0.0, top)
        plain.set_xlim(0.0, None)
        plain.set_xlabel(first)
        plain.set_ylabel("amplitude [g]")
        plain.set_title(
            f"Lowest amplitude that causes collapse, {'train of sines' if max(c.cycles for c in r.curves) > 1 else r.pulse + ' pulse'}"
        )
        scaled.set_ylim(0.0, None)
        if slender:
            scaled.set_xlabel("frequency of the pulse / p (omega/p)")
            scaled.set_ylabel("amplitude / (g tan(alpha))")
        else:
            scaled.set_xlabel(first.replace("[s]", "/ sqrt(R/g)"))
            scaled.set_ylabel("amplitude / uplift acceleration")
        scaled.set_title("Normalised by natural time and uplift acceleration")
        if len(r.curves) <= MOST_IN_AXES:
            plain.legend(loc="upper right", frameon=True)
        else:
            style.legend_below(fig, plain)
        caption = (
            "Left: lowest amplitude that causes collapse of each structure (dotted: start of rocking). Right: the same curves, with "
            "durations divided by the natural time and amplitudes by the uplift acceleration."
        )
        if len(places):
            named = ", ".join(f"{k + 1} {i.name}" for k, i in enumerate(r.impulses))
            caption += f" Points: primary impulses of {named}."
        return [(style.save(fig, folder, name), caption)]
