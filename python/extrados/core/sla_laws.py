"""Saw-tooth laws: the teeth of one law, and the tooth tables of the elements of a group."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from extrados import _core
from extrados.core.calls import real, real_each
from extrados.core.errors import check
from extrados.core.sla_parts import LAWS, Bars, Bedding, Joints, Plane, Softening

MOST_TEETH = 4096
#: Ratio of neighbouring bands where the band follows from the crack: the energy is right to a percent
BAND_STEP = 1.02


def teeth(softening: Softening, young: float, band: float) -> tuple[np.ndarray, np.ndarray]:
    """Secant moduli (teeth) [Pa] and peak stresses (teeth) [Pa] of a crack band `band` [m] wide; young [Pa]."""
    s = softening
    n, modulus, strength, status = _core.api_sla_laws.teeth(
        LAWS[s.law], young, s.strength, s.energy, band, s.ripple, int(s.exact), int(s.overshoot), MOST_TEETH
    )
    check(status, f"teeth of a {s.law} law: the crack band is {band:g} m (largest possible: {largest_band(s, young):g} m)")
    return np.array(modulus[:n]), np.array(strength[:n])


def largest_band(softening: Softening, young: float) -> float:
    """The crack band width beyond which the law snaps back [m]."""
    return float(_core.api_sla_laws.band(LAWS[softening.law], young, softening.strength, softening.energy))


def intervals(alpha: float, beta: float, a: npt.ArrayLike, b: npt.ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Multipliers lo, hi (n) that keep r <= alpha - beta m under stresses a + lambda b, both (n, 3)."""
    a = real("a", np.transpose(a), (3, None))
    lo, hi = _core.api_sla_laws.intervals(alpha, beta, a, real("b", np.transpose(b), (3, a.shape[1])))
    return lo, hi


def add_tables(handle: int, count: int, group: Plane | Joints | Bars) -> tuple[list[np.ndarray], np.ndarray]:
    """Hand over the tooth tables of a group; for tension, compression and of joints cohesion, the table of each
    element (1-based, 0 none), and (2, elements) those of its narrowest and widest tension band."""
    young, band = real_each("young", group.young, count), real_each("band", group.band, count)
    reach = group.reach if isinstance(group, Plane) else None
    rows: list[tuple[float, ...]] = []
    tension = softenings_of(group.tension, count)
    bedded = [law is not None and bed is not None for law, bed in zip(tension, beddings_of(group, count), strict=True)]
    plain = [None if b else law for b, law in zip(bedded, tension, strict=True)]
    if reach is None:
        number, ladder = _one_band(plain, young, band, rows), np.zeros((2, count), dtype=np.int32)
    else:
        number, ladder = _many_bands(plain, young, band, real("reach", reach, (count, 2)), rows)
    if any(bedded):
        ends = np.column_stack([band, band]) if reach is None else np.asarray(reach)
        stretch = np.array([(1.0, 1.0) if bed is None else bed.stretch() for bed in beddings_of(group, count)])
        other = [law if b else None for b, law in zip(bedded, tension, strict=True)]
        more, rungs = _many_bands(other, young, band, ends * stretch, rows)
        number, ladder = np.where(bedded, more, number), np.where(bedded, rungs, ladder)
    numbers = [number]
    numbers.append(_one_band(softenings_of(group.compression, count), young, band, rows))
    if isinstance(group, Joints):
        slip = real_each("shear stiffness", group.shear_stiffness, count)
        numbers.append(_one_band(softenings_of(group.cohesion, count), slip, band, rows))
    if rows:
        table = real("softening", np.transpose(rows), (8, None))
        bad, status = _core.api_sla_model.tables(handle, table)
        if bad:
            kind, modulus, strength, energy, width = table[:5, bad - 1]
            name = next(word for word, number in LAWS.items() if number == int(kind))
            largest = largest_band(Softening(strength, energy, name), modulus)
            check(
                status,
                f"teeth of a {name} law with E {modulus:g} Pa, strength {strength:g} Pa, energy {energy:g} N/m: the crack band is "
                f"{width:g} m, and the largest possible is {largest:g} m",
            )
        check(status, "softening laws")
    return numbers, ladder


def softenings_of(law: Softening | Sequence[Softening | None] | None, count: int) -> list[Softening | None]:
    """The law of each element."""
    each = [law] * count if law is None or isinstance(law, Softening) else list(law)
    if len(each) != count:
        raise ValueError(f"there are {len(each)} softening laws for {count} elements; expected one for each element")
    return each


def beddings_of(group: Plane | Bars | Joints, count: int) -> list[Bedding | None]:
    """The bed joints of each element."""
    bedding = group.bedding if isinstance(group, Plane) else None
    each = [bedding] * count if bedding is None or isinstance(bedding, Bedding) else list(bedding)
    if len(each) != count:
        raise ValueError(f"there are {len(each)} laws of bed joints for {count} elements; expected one for each element")
    return each


def _one_band(laws: list[Softening | None], young: np.ndarray, band: np.ndarray, rows: list) -> np.ndarray:
    """The table of each element (1-based, 0 none), one for each law and band; the tables go to `rows`."""
    found = {row: k + 1 for k, row in enumerate(rows)}
    number = np.zeros(len(laws), dtype=np.int32)
    for k, law in enumerate(laws):
        if law is not None:
            row = tuple(law.row(float(young[k]), float(band[k])))
            if row not in found:
                rows.append(row)
                found[row] = len(rows)
            number[k] = found[row]
    return number


def _many_bands(
    laws: list[Softening | None], young: np.ndarray, band: np.ndarray, reach: np.ndarray, rows: list
) -> tuple[np.ndarray, np.ndarray]:
    """As `_one_band`, for bands between the two of `reach` (elements, 2): every law has tables for bands that grow by
    BAND_STEP. The table of each element at its `band`, and (2, elements) those at both ends of its reach."""
    members: dict[tuple[Softening, float], list[int]] = {}
    for k, law in enumerate(laws):
        if law is not None:
            members.setdefault((law, float(young[k])), []).append(k)
    number = np.zeros(len(laws), dtype=np.int32)
    ladder = np.zeros((2, len(laws)), dtype=np.int32)
    for (law, modulus), mine in members.items():
        low, high = float(reach[mine, 0].min()), float(reach[mine, 1].max())
        steps = max(1, int(np.ceil(np.log(high / low) / np.log(BAND_STEP))))
        step = np.log(high / low) / steps
        first = len(rows) + 1
        rows += [tuple(law.row(modulus, low * float(np.exp(i * step)))) for i in range(steps + 1)]
        for target, wanted in ((number, band), (ladder[0], reach[:, 0]), (ladder[1], reach[:, 1])):
            at = np.rint(np.log(wanted[mine] / low) / step) if step > 0.0 else np.zeros(len(mine))
            target[mine] = first + np.clip(at, 0, steps).astype(np.int32)
    return number, ladder
