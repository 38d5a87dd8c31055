"""Calls of ground motions: made motions and their measures."""

from typing import Any

import numpy as np

from core_calls.given import Calls
from extrados.core import motion


def motions(
    kind,
    parameters,
    points,
    step,
    intensity,
    frequency,
    amplitude,
    wanted,
    lines,
    spacing,
    scaling,
    factor,
    duration,
    seed,
    first,
    count,
    window,
    periods,
    dampings,
    series,
    length,
    period,
    threads,
) -> Any:
    """Everything that is computed of motions."""
    strength = motion.line_spectrum(intensity, frequency, amplitude, wanted, lines)
    width = motion.line_widths(lines, spacing)
    size = motion.line_amplitudes(strength, width, scaling, factor, duration)
    made = motion.generate(lines, size, window, step, seed, first, count, threads)
    spectra = motion.response_spectra(series, step, periods, dampings, threads=threads)
    back = motion.fourier_inverse(motion.fourier(series, length), length)
    return (
        motion.envelope(kind, parameters, points, step),
        motion.phases(seed, first, points),
        made,
        spectra.sd,
        back,
        motion.oscillator(series, step, period, 0.05),
        motion.measures(series, step, threads).arias,
        motion.kinematics(series, step),
    )


def calls(rng: np.random.Generator) -> Calls:
    return [
        (
            motions,
            dict(
                kind="arctangent",
                parameters=np.array([0.5, 1.0, 0.1, 0.0]),
                points=20,
                step=0.05,
                intensity=[5.0, 6.0],
                frequency=[0.5, 1.0, 5.0],
                amplitude=np.ones((2, 3)),
                wanted=5.5,
                lines=[0.6, 1.2, 3.0],
                spacing="log",
                scaling="energy",
                factor=1.0,
                duration=1.0,
                seed=7,
                first=0,
                count=3,
                window=np.ones(30),
                periods=[0.3, 1.0],
                dampings=[0.05],
                series=rng.normal(size=40),
                length=64,
                period=0.7,
                threads=2,
            ),
        )
    ]
