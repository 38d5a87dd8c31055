"""Notched beams against the discrete cohesive crack: peak, tail and energy of elements, laws, sizes and meshes."""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from cohesive_beam import Beam, Path, cohesive_path

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck

YOUNG, NU, STRENGTH, ENERGY = 37e9, 0.2, 3.9e6, 143.0
LAWS = ("hordijk", "linear", "exponential")
DEPTHS = (0.05, 0.1, 0.2)
#: One of squares and two of random triangles
MESHES = (("structured", 1), ("random", 1), ("random", 2))
#: Parts of the peak load at which the tail is compared
TAIL = (0.75, 0.5, 0.25)


def beam_of(depth: float, slot: float) -> Beam:
    """The half-notched beams of Gregoire and others, of which all sizes are in proportion."""
    return Beam(depth, 3.5 * depth, 2.5 * depth, 0.5 * depth, slot, 0.4 * depth, 0.05)


def nine(shift: int) -> list[tuple[str, float, str, int]]:
    """Of the 27 beams of all laws, depths and meshes nine: every pair of two of these occurs once."""
    return [(law, depth, *MESHES[(i + shift * j) % 3]) for i, law in enumerate(LAWS) for j, depth in enumerate(DEPTHS)]


def reference(depth: float, slot: float, law: str, elements: int = 192) -> Path:
    return cohesive_path(beam_of(depth, slot), YOUNG, NU, STRENGTH, ENERGY, law, elements)


@dataclass(frozen=True)
class Errors:
    """Relative errors: of the peak, of the load where the reference has fallen to the parts TAIL, of the work of the load
    up to the last of these."""

    peak: float
    tail: tuple[float, ...]
    work: float


@cache
def errors(depth: float, law: str, elements: int, pattern: str = "structured", seed: int = 1, selective: bool = False, **options) -> Errors:
    """A run with `elements` over the ligament, all else by default; events enough to come down to the last of TAIL."""
    size = 0.5 * depth / elements
    slot = size  # as wide as one element: from the corner of a wider one a crack runs beside the load and the reference's
    found = reference(depth, slot, law)
    b, middle = beam_of(depth, slot), 1.75 * depth
    zone = 0.2 * depth + 0.5 * slot
    deck = {
        "structure": {
            "kind": "panel",
            "width": b.length,
            "height": depth,
            "thickness": b.thickness,
            "openings": [{"x": [middle - 0.5 * slot, middle + 0.5 * slot], "y": [0.0, b.notch]}],
            "regions": [{"x": [0.0, middle - zone], "linear": True}, {"x": [middle + zone, b.length], "linear": True}],
        },
        "material": {"young": YOUNG, "poisson": NU, "tensile_strength": STRENGTH, "fracture_energy": ENERGY, "softening": law},
        "supports": {"held": [{"x": middle - 0.5 * b.span, "y": 0.0, "fix": "xy"}, {"x": middle + 0.5 * b.span, "y": 0.0, "fix": "y"}]},
        "analysis": [
            {
                "kind": "sla",
                "reference": [{"kind": "point", "x": middle, "y": depth, "fy": -1000.0}],
                "control": [
                    {"x": middle + 0.5 * b.gauge, "y": 0.0, "direction": "x", "weight": 1},
                    {"x": middle - 0.5 * b.gauge, "y": 0.0, "direction": "x", "weight": -1},
                ],
                "target_displacement": 1.1 * found.opening_after_peak(TAIL[-1]),
                "events": 250_000,
                "mesh": {
                    "size": 0.1 * depth,
                    "pattern": pattern,
                    "seed": seed,
                    "selective": selective,
                    "element": "T3" if pattern == "random" else "Q4",
                    "refine": [{"x": [middle - zone, middle + zone], "size": size}, {"y": [0.0, depth], "size": size}],
                },
                **options,
            }
        ],
    }
    result = run_analyses(Context(make_deck(deck)))[0]
    assert result.status == "ok", result.reason
    assert result.results["stop"] in ("target displacement", "mechanism"), result.results["stop"]
    opening, load = result["envelope_displacement"], result["envelope_load"]
    peak = float(found.load[found.peak])
    tail = [float(np.interp(found.opening_after_peak(part), opening, load)) / (part * peak) - 1.0 for part in TAIL]
    upto = found.opening <= found.opening_after_peak(TAIL[-1])
    work = np.trapezoid(np.append(0.0, found.load[upto]), np.append(0.0, found.opening[upto]))
    grid = np.linspace(0.0, found.opening[upto][-1], 2000)
    return Errors(
        result.results["peak_load_N"] / peak - 1.0, tuple(tail), float(np.trapezoid(np.interp(grid, opening, load), grid) / work) - 1.0
    )


@pytest.mark.verify
def test_the_reference_converges() -> None:
    """Twice as many elements change the peak by a thousandth and the tail by two at most, also where only the last hundredth
    of the ligament is whole; an outside program found 1174 N."""
    coarse, fine = (reference(0.05, 0.002, "hordijk", n) for n in (96, 192))
    assert fine.load[fine.peak] == pytest.approx(1174.0, rel=1e-3)
    assert coarse.load[coarse.peak] == pytest.approx(fine.load[fine.peak], rel=1e-3)
    for part in TAIL[:2]:
        assert coarse.opening_after_peak(part) == pytest.approx(fine.opening_after_peak(part), rel=1e-3)
    assert coarse.opening_after_peak(TAIL[2]) == pytest.approx(fine.opening_after_peak(TAIL[2]), rel=5e-3)
    with pytest.raises(ValueError, match=r"above 0\.25"):
        reference(0.05, 0.002, "hordijk", 24).opening_after_peak(0.25)


@pytest.mark.verify
def test_few_elements_do_not_carry_a_discrete_crack_down_its_tail_either() -> None:
    """Twelve pairs of nodes end above half of the peak, 24 above a quarter: with the last of them the crack is through."""
    for elements, part in ((12, 0.5), (24, 0.25)):
        few = reference(0.05, 0.025 / 24, "hordijk", elements)
        assert few.load.max() == pytest.approx(reference(0.05, 0.025 / 24, "hordijk").load.max(), rel=0.01)
        with pytest.raises(ValueError, match="the crack ends at"):
            few.opening_after_peak(part)


@pytest.mark.verify
def test_a_small_beam_is_rigid_and_plastic() -> None:
    """Where the crack is long before it opens, all of the ligament carries its strength: P l/4 = ft t a^2/2."""
    path = cohesive_path(beam_of(1e-4, 4e-6), YOUNG, NU, STRENGTH, ENERGY, "linear", 200)
    plastic = 4.0 / (2.5 * 1e-4) * STRENGTH * 0.05 * (0.5e-4) ** 2 / 2.0
    assert 0.97 < path.load.max() / plastic < 1.0


@pytest.mark.verify
def test_a_beam_of_default_elements_meets_the_cohesive_crack() -> None:
    """Hordijk, 50 mm, twelve elements over the ligament."""
    found = errors(0.05, "hordijk", 12)
    assert abs(found.peak) < 0.05
    assert max(abs(e) for e in found.tail) < 0.05
    assert abs(found.work) < 0.05


def strip(mesh: dict) -> float:
    """Energy of the teeth passed when a strip of 100 mm x 50 mm has come apart, over Gf times the notched section."""
    deck = {
        "structure": {
            "kind": "panel",
            "width": 0.1,
            "height": 0.05,
            "thickness": 0.03,
            "openings": [{"x": [0.049, 0.051], "y": [0.0, 0.01]}, {"x": [0.049, 0.051], "y": [0.04, 0.05]}],
        },
        "material": {"young": YOUNG, "poisson": NU, "tensile_strength": STRENGTH, "fracture_energy": ENERGY, "softening": "linear"},
        "supports": {"held": [{"edge": "left", "fix": "x"}, {"x": 0.0, "y": 0.0, "fix": "y"}]},
        "analysis": [
            {
                "kind": "sla",
                "mesh": mesh,
                "events": 9000,
                "reference": [{"kind": "displacement", "direction": "x", "parts": [{"edge": "right"}]}],
            }
        ],
    }
    result = run_analyses(Context(make_deck(deck)))[0]
    assert result.results["stop"] == "mechanism"
    return result.results["crack_energy_J"] / (ENERGY * 0.03 * 0.03)


@pytest.mark.verify
def test_a_crack_along_the_mesh_takes_its_fracture_energy() -> None:
    """Squares, one row of which cracks through."""
    lines = [0.001 * k for k in range(29, 72, 2)]
    assert strip({"size": 0.002, "lines_x": lines}) == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.verify), pytest.param(3, marks=pytest.mark.verify)])
def test_a_crack_across_random_triangles_takes_its_fracture_energy(seed: int) -> None:
    """Each of three meshes, though no crack is as straight as the section."""
    mesh = {"size": 0.002, "element": "T3", "pattern": "random", "seed": seed}
    assert strip(mesh) == pytest.approx(1.0, abs=0.05)


def test_fixed_cracks_do_not_meet_it() -> None:
    """The dissertation's elements on the same mesh: what the default was chosen to avoid."""
    found = errors(0.05, "hordijk", 12, cracking="orthotropic", crack_band_rule="area")
    assert found.peak > 0.05
    assert found.tail[1] > 0.2


@pytest.mark.verify
@pytest.mark.parametrize(("law", "depth", "pattern", "seed"), nine(1))
def test_fine_teeth_meet_the_tail(law, depth, pattern, seed) -> None:
    """Teeth a quarter as wide, 24 elements over the ligament: within 5 % at the peak and all along the tail. What is off there
    at the default p is the width of the teeth, which near a quarter of the peak is a large part of what is left. The other 18
    beams met the same bounds until they were left out for their time."""
    found = errors(depth, law, 24, pattern, seed, ripple=0.0125)
    assert max(abs(e) for e in (found.peak, *found.tail, found.work)) < 0.05


@pytest.mark.verify
@pytest.mark.parametrize(("law", "depth", "pattern", "seed"), nine(2))
def test_fine_teeth_and_36_elements(law, depth, pattern, seed) -> None:
    """Within 5 % to half of the peak, and in squares all along; at a quarter one mesh of triangles is 5.7 % too low. Other nine
    beams than with 24 elements; the rest of the 27 met the same bounds until they were left out for their time."""
    found = errors(depth, law, 36, pattern, seed, ripple=0.0125)
    assert max(abs(e) for e in (found.peak, *found.tail[:2], found.work)) < 0.03
    assert abs(found.tail[2]) < (0.05 if pattern == "structured" else 0.06)


@pytest.mark.verify
@pytest.mark.parametrize("depth", DEPTHS)
@pytest.mark.parametrize("law", LAWS)
def test_twelve_squares_without_shear_locking(law, depth) -> None:
    """`selective` and teeth a quarter as wide: within 5 % to half of the peak, at a quarter in eight of nine beams."""
    found = errors(depth, law, 12, selective=True, ripple=0.0125)
    assert max(abs(e) for e in (found.peak, *found.tail[:2], found.work)) < 0.05
    assert abs(found.tail[2]) < (0.07 if (law, depth) == ("linear", 0.05) else 0.05)


#: What default elements are held to, by elements over the ligament: peak, tail at 75 and at 50 % of the peak, at 25 %, work.
#: Near a quarter of the peak one or two elements carry the load, and a tooth of p ft is a large part of it.
HELD = {
    "structured": {6: (0.05, 0.07, 0.09, 0.16, 0.05), 12: (0.04, 0.05, 0.06, 0.13, 0.03), 24: (0.03, 0.03, 0.04, 0.12, 0.02)},
    "random": {6: (0.12, 0.13, 0.20, 0.25, 0.09), 12: (0.07, 0.06, 0.09, 0.22, 0.04), 24: (0.06, 0.06, 0.13, 0.13, 0.03)},
}


@pytest.mark.verify
@pytest.mark.parametrize("elements", [6, 12, 24])
@pytest.mark.parametrize("pattern", ["structured", "random"])
def test_laws_sizes_and_meshes(pattern, elements) -> None:
    """Three laws and three sizes of beam; squares by one mesh, random triangles by two."""
    rows = {
        (law, depth, seed): errors(depth, law, elements, pattern, seed)
        for law in LAWS
        for depth in DEPTHS
        for seed in ((1,) if pattern == "structured" else (1, 2))
    }
    held, wrong = HELD[pattern][elements], []
    for case, found in rows.items():
        values = [found.peak, *found.tail, found.work]
        print(pattern, elements, *case, " ".join(f"{100 * v:+.1f}" for v in values))
        wrong += [(case, v, most) for v, most in zip(values, held, strict=True) if not abs(v) < most]
    assert not wrong
