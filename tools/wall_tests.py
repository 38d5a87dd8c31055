"""Predicted and measured strength of tested walls: every wall of a table by one fixed rule, no parameter set from a result.

    tools/wall_tests.py FILE [--method NAME ...] [--wall N ...] [--out FOLDER] [--processes 2]

FILE is a table with one wall a row: sizes, strengths, axial stress, ratio of shear span, failure mode, peaks; its columns
are those of `read_walls`. Each wall becomes one deck per method, as a user would write it:

    limit     bricks in running bond, joints without cohesion that crush; the load acts at the shear span
    codes     `code-checks` of a panel, by NTC 2018, the code of decks that name none; its least lateral strength
    membrane  `sla` of a panel without bricks, pushed sideways under its axial load to a drift of 1 %
    units     `sla` of its units and joints, likewise, to 75 % of the peak, on a bed joint at the foot. Walls of more than 200 units
              have units twice as long and as high, if five of them or more remain in a course. Head joints of blocks in thin beds
              are unfilled and carry no stress (Mann and Mueller 1982). Blocks are units of 190 mm and higher; a bed is thin up to 3 mm (height of a course less that of a
              unit). Walls with the same deck share one run. The failure mode is that of the state at the peak: does more than half
              of the displacement of the top come from the rotation of horizontal sections (F), or from the slip of beds and the
              shear of units (S)?
    frame     one macro-element of `frame-pushover`: sections without tension, shear by the lesser of Mohr-Coulomb on the compressed
              part and Turnsek-Cacovic; to 2 % drift, without drift limits but for the drift at the loss of 20 %

Empty cells are filled by these rules: friction 0.4; cohesion of the joints as tested, and without it (stone masonry) shear by
diagonal cracking alone; tensile strength of the diagonal test, else the cohesion; modulus 600 times the compressive strength.
Crushing in limit analysis at 0.85 of the strength.
Written: predictions.csv, one row per wall and method. Printed: bias (geometric mean of predicted over measured) and scatter
(standard deviation of its logarithm), in all and by failure mode, the count of right failure modes and of missing results.
"""

import argparse
import csv
import itertools
import math
import sys
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import extrados
from extrados.core.frame import STATE, UNLIMITED, Frame, MacroElement
from extrados.core.frame import Path as PushPath

FRICTION = 0.4
CRUSHES_AT = 0.85  # of the compressive strength: the rectangular stress block of codes
MODULUS = 600.0  # of the compressive strength
MASONRY = 1800.0  # kg/m^3
BEAM = 20000.0  # kg/m^3, at most, of the loading beam, whose weight is the axial load
GRAVITY = 9.80665


@dataclass(frozen=True)
class Wall:
    """A tested wall; lengths in m, stresses in Pa, peaks in N (mean of both senses)."""

    name: str
    height: float
    length: float
    thickness: float
    unit_length: float
    unit_height: float
    compressive: float
    tensile: float
    young: float
    cohesion: float
    friction: float
    span: float
    pressure: float
    failure: str
    peak: float
    drift: float  # at the peak, mean of both senses; nan if not reported
    ultimate: float = math.nan  # ultimate drift, the lower of both senses; nan if not reported

    @property
    def axial(self) -> float:
        """The axial load [N]."""
        return self.pressure * self.length * self.thickness

    @property
    def flexural(self) -> float:
        """Shear [N] of the section that crushes at its toe, by the stress block of codes."""
        ratio = self.pressure / (CRUSHES_AT * self.compressive)
        return 0.5 * self.axial * self.length * (1.0 - ratio) / (self.span * self.height)

    @property
    def mode(self) -> str:
        """The measured failure: "F" flexure, "S" shear, "SL" sliding, "H" hybrid."""
        return "H" if self.failure.startswith("H") else self.failure


@dataclass(frozen=True)
class Predicted:
    """Strength [N] by a method and the failure that goes with it, "F", "S" or ""; or why there is none. drift: at the peak,
    drop: at a load of 80 %; note: how the state at the peak moves, and how a run ended before its target."""

    strength: float = math.nan
    failure: str = ""
    why_not: str = ""
    drift: float = math.nan
    drop: float = math.nan
    note: str = ""


def read_walls(file: Path) -> list[Wall]:
    """The walls of a table, empty cells filled by the rules above."""
    lines = [line for line in file.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    walls = []
    for row in csv.DictReader(lines):
        number = {key: float(value) for key, value in row.items() if value and key not in _TEXTS}
        peaks = [number[key] for key in ("peak_pos_kN", "peak_neg_kN") if key in number]
        ends = [number[key] for key in ("ultimate_drift_pos_pct", "ultimate_drift_neg_pct") if key in number]
        drifts = [number[key] for key in ("drift_at_peak_pos_pct", "drift_at_peak_neg_pct") if key in number]
        compressive = 1e6 * number["masonry_compressive_MPa"]
        cohesion = 1e6 * number.get("shear_strength_initial_MPa", math.nan)
        walls.append(
            Wall(
                name=f"{row['n']} {row['name']}",
                height=number["height_m"],
                length=number["length_m"],
                thickness=number["thickness_m"],
                unit_length=1e-3 * number.get("unit_length_mm", math.nan),
                unit_height=1e-3 * number.get("unit_height_mm", math.nan),
                compressive=compressive,
                tensile=1e6 * number["masonry_tensile_diagonal_MPa"] if "masonry_tensile_diagonal_MPa" in number else cohesion,
                young=1e6 * number.get("young_MPa", 1e-6 * MODULUS * compressive),
                cohesion=cohesion,
                friction=number.get("friction", FRICTION),
                span=number["shear_span_over_height"],
                pressure=1e6 * number["vertical_stress_MPa"],
                failure=row.get("failure", ""),
                peak=1e3 * sum(peaks) / len(peaks) if peaks else math.nan,
                drift=1e-2 * sum(drifts) / len(drifts) if drifts else math.nan,
                ultimate=1e-2 * min(ends, default=math.nan),
            )
        )
    return walls


def read_recorded(file: Path) -> dict[str, Predicted]:
    """Recorded predictions by units, by number of the wall."""
    lines = [line for line in file.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return {
        row["n"]: Predicted(1e3 * float(row["units_kN"] or "nan"), row["units_failure"], note=row["note"]) for row in csv.DictReader(lines)
    }


_TEXTS = {"reference", "name", "units", "failure"}


def by_limit_analysis(wall: Wall) -> dict[str, Predicted]:
    """Bricks in running bond under a rigid beam whose weight is the axial load and whose centre lies at the shear span."""
    deck = {
        "structure": {
            "kind": "blocks",
            "depth": wall.thickness,
            "ground": [[0.0, 0.0, wall.length, 0.0]],
            "block": [*_bricks(wall), _beam(wall)],
        },
        "material": {"density": 1.0, "compressive_strength": CRUSHES_AT * wall.compressive},
        "joints": {"friction": wall.friction},
        "analysis": [{"kind": "tilt"}],
    }
    answer = _answer(deck)
    if isinstance(answer, Predicted):
        return {"limit": answer}
    return {"limit": Predicted(answer["collapse_acceleration_g"] * wall.axial, "S" if answer.get("dilating_joints") else "F")}


def _bricks(wall: Wall) -> list[dict[str, Any]]:
    """Whole and half bricks, course by course; sizes are rounded so that they fill the wall."""
    courses, count = round(wall.height / wall.unit_height), max(1, round(wall.length / wall.unit_length))
    high, long = wall.height / courses, wall.length / count
    bricks = []
    for k in range(courses):
        shift = 0.0 if k % 2 == 0 else 0.5
        inner = [long * (j + shift) for j in range(count + 1) if 0.0 < j + shift < count]
        cuts = [0.0, *inner, wall.length]
        for left, right in itertools.pairwise(cuts):
            corners = [[left, k * high], [right, k * high], [right, (k + 1) * high], [left, (k + 1) * high]]
            bricks.append({"name": f"brick {len(bricks) + 1}", "points": corners})
    return bricks


def _beam(wall: Wall) -> dict[str, Any]:
    """A portal over the wall whose legs hang beside it, so long that its centre lies at the shear span above the foot."""
    gap, width = 0.1, 1.0
    outer = wall.length + 2.0 * (gap + width)
    weight = wall.axial / (GRAVITY * wall.thickness)  # kg per m of thickness
    area = max(weight / BEAM, 3.0 * wall.length * wall.height)

    def centre(leg: float) -> float:
        deep = (area - 2.0 * width * leg) / outer
        return (outer * deep * (wall.height + 0.5 * deep) + 2.0 * width * leg * (wall.height - 0.5 * leg)) / area

    low, high = 0.0, 0.49 * area / width
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if centre(middle) > wall.span * wall.height else (low, middle)
    leg, top = low, wall.height + (area - 2.0 * width * low) / outer
    if abs(centre(leg) - wall.span * wall.height) > 1e-6:
        raise ValueError(f"wall {wall.name}: no portal has its centre at the shear span")
    left, right, foot = -gap, wall.length + gap, wall.height - leg
    points = [
        [left - width, foot],
        [left, foot],
        [left, wall.height],
        [right, wall.height],
        [right, foot],
        [right + width, foot],
        [right + width, top],
        [left - width, top],
    ]
    return {"name": "beam", "points": points, "density": weight / area}


def by_codes(wall: Wall) -> dict[str, Predicted]:
    """The least strength that each code gives the wall as a pier, all partial and confidence factors at 1."""
    high = wall.height * max(wall.span, 1.0)
    deck = {
        "structure": {"kind": "panel", "width": wall.length, "height": high, "thickness": wall.thickness},
        "material": {"density": MASONRY, "compressive_strength": wall.compressive},
        **({} if math.isnan(wall.cohesion) else {"joints": {"cohesion": wall.cohesion}}),
        "analysis": [
            {
                "kind": "code-checks",
                "axial_load": wall.axial,
                "fixity": "double" if wall.span < 0.75 else "cantilever",
                "diagonal_strength": wall.tensile / 1.5,  # f_t = 1.5 tau_0
                "sliding_friction": wall.friction,
                "confidence_factor": 1.0,
            }
        ],
    }
    answer = _answer(deck)
    if isinstance(answer, Predicted):
        return {"codes": answer}
    found: dict[str, Predicted] = {}
    for rule, check in answer["checks"].items():
        code = next((name for name in CODES if rule.startswith(name)), None)
        if code is None or check["capacity"] is None or check["quantity"] != "lateral strength":
            continue
        flexure = any(word in rule for word in ("rocking", "flexure", "toe crushing"))
        if not check["capacity"] >= found.get(code, Predicted(math.inf)).strength:
            found[code] = Predicted(check["capacity"], "F" if flexure else "S")
    return found


#: Beginnings of the names of rules
CODES = ("ASCE 41", "EN 1998-3", "Magenes-Calvi", "NTC")


def by_membrane(wall: Wall) -> dict[str, Predicted]:
    """The wall as a membrane that cracks and crushes, its foot held, its top moved sideways under the constant axial load."""
    strengths = {
        "tensile_strength": wall.tensile,
        "fracture_energy": CRACK_DUCTILITY * wall.tensile,
        "compressive_strength": wall.compressive,
        "crushing_energy": CRUSHING_DUCTILITY * wall.compressive,
    }
    return {"membrane": _followed(wall, _panel(wall, {}, strengths, {}, {"size": wall.length / 15.0}))}


def by_units(wall: Wall) -> dict[str, Predicted]:
    """The same of units that crack, in running bond, with joints that open, slide and crush."""
    return {"units": _followed(wall, units_deck(wall))}


def has_unfilled_heads(wall: Wall) -> bool:
    """Are these blocks in thin beds? EN 1996-1-1 halves the initial shear strength where head joints are unfilled (3.6.2); here they
    carry no stress."""
    bed = wall.height / math.floor(wall.height / wall.unit_height + 1e-6) - wall.unit_height
    return wall.unit_height >= BLOCK and bed <= THIN_BED


def units_deck(wall: Wall) -> dict[str, Any]:
    """The deck of a wall of units."""
    courses, count = round(wall.height / wall.unit_height), max(1, round(wall.length / wall.unit_length))
    fewer = round(0.5 * wall.length / wall.unit_length)
    if courses * count > MOST_UNITS and fewer >= LEAST_UNITS:
        courses, count = round(0.5 * wall.height / wall.unit_height), fewer
    bond = {"unit_length": wall.length / count, "unit_height": wall.height / courses}
    tension, cracks = BOND_TENSION * wall.cohesion, UNIT_TENSION * wall.compressive
    joints = {
        "friction": wall.friction,
        "cohesion": wall.cohesion,
        "shear_energy": SLIP_DUCTILITY * wall.cohesion,
        "tension": tension,
        "fracture_energy": CRACK_DUCTILITY * tension,
        "compressive_strength": wall.compressive,
        "crushing_energy": CRUSHING_DUCTILITY * wall.compressive,
    }
    if has_unfilled_heads(wall):
        joints["types"] = [{"joints": ["heads"], **UNFILLED}]
    units = {"tensile_strength": cracks, "fracture_energy": CRACK_DUCTILITY * cracks}
    deck = _panel(wall, bond, units, joints, {"size": 0.5 * bond["unit_length"], "joints": "interfaces"})
    deck["analysis"][0]["stop_fraction"] = ENOUGH
    del deck["supports"]  # a bed joint at the foot
    return deck


def _panel(wall: Wall, bond: dict[str, Any], strengths: dict[str, Any], joints: dict[str, Any], mesh: dict[str, Any]) -> dict[str, Any]:
    """The deck of a wall whose foot is held and whose top is moved sideways to a drift of 1 % under the constant axial load."""
    panel: dict[str, Any] = {"kind": "panel", "width": wall.length, "height": wall.height, "thickness": wall.thickness}
    if wall.span < 0.75:
        panel["ties"] = [{"edge": "top", "direction": "y"}]  # the top moves without turning
    return {
        "structure": panel | bond,
        "material": {"density": MASONRY, "young": wall.young, "poisson": 0.2, **strengths},
        **({"joints": joints} if joints else {}),
        "supports": {"held": [{"edge": "bottom"}]},
        "analysis": [
            {
                "kind": "sla",
                "directions": ["+"],
                "constant": [{"kind": "gravity"}, {"kind": "pressure", "edge": "top", "value": wall.pressure}],
                "reference": [{"kind": "displacement", "direction": "x", "parts": [{"edge": "top"}]}],
                "target_displacement": 0.01 * wall.height,
                "events": 30000,
                "budget": BUDGET,
                "mesh": mesh,
            }
        ],
    }


def _followed(wall: Wall, deck: dict[str, Any]) -> Predicted:
    """The peak of a wall that `sla` follows under displacements. With joints the failure is read off the state at the peak; without,
    it is flexure if the peak is within 5 % of the flexural strength."""
    try:
        run = extrados.run(deck, threads=1)
    except Exception as error:  # one wall does not end the others
        return Predicted(why_not=f"{type(error).__name__}: {error}")
    analysis = run.analyses[0]
    answer = analysis["results"]
    if not answer or answer.get("greatest_load_N") is None:
        return Predicted(why_not=analysis["reason"])
    peak, drift, drop = (answer["greatest_load_N"], answer["greatest_load_displacement_m"] / wall.height, answer.get("drop_drift"))
    failure = "F" if peak >= 0.95 * wall.flexural else "S"
    note = "" if answer["stop"] == "target displacement" else answer["stop"]
    if "joints" in deck:
        failure, shares = failure_of_state(wall, answer, {key: array.data for key, array in next(iter(run.arrays.values())).items()})
        note = f"{shares} {note}".strip()
    return Predicted(peak, failure, "", drift, math.nan if drop is None else drop, note)


def failure_of_state(wall: Wall, answer: dict[str, Any], arrays: dict[str, Any]) -> tuple[str, str]:
    """ "F" or "S" of the state at the peak, and the shares of the displacement of its top in words.

    Horizontal sections of mean rotation r (the slope of their vertical displacement along the wall) move the top by the integral of
    -r over the height: beds that open and crush, and bending. Beds of mean slip s move it by their sum. The rest is shear of units:
    their cracks, and their elastic strain.
    """
    at = int(np.flatnonzero(arrays["state_event"] == answer["greatest_load_event"])[0])
    node, moved = arrays["node"], arrays["state_displacement"][at]
    levels = np.round(node[:, 1], 6)
    heights = np.array([z for z in np.unique(levels) if np.ptp(node[levels == z, 0]) > 0.5 * wall.length])
    turns = np.array([np.polyfit(node[levels == z, 0], moved[levels == z, 1], 1)[0] for z in heights])
    rotation = -float(0.5 * (turns[1:] + turns[:-1]) @ np.diff(heights))
    slips: dict[float, list[float]] = {}
    for corners in (row for name, rows in arrays.items() if name.startswith("elements_") for row in rows if len(row) == 4):
        first, second, _, fourth = node[corners]
        if np.abs(fourth - first).max() < 1e-9 and abs(second[1] - first[1]) < 1e-9:
            jumps = moved[corners[[3, 2]], 0] - moved[corners[:2], 0]
            slips.setdefault(round(float(first[1]), 6), []).append(float(jumps.mean()))
    slip = sum(float(np.mean(rows)) for rows in slips.values())
    top = float(moved[np.abs(node[:, 1] - wall.height) < 1e-6, 0].mean())
    shares = [part / top + 0.0 for part in (rotation, slip, top - rotation - slip)]
    return "F" if shares[0] > 0.5 else "S", "rotation {:.0%}, slip {:.0%}, shear of units {:.0%}".format(*shares)


#: Units of a wall beyond which they are twice as long and as high, which keeps the slope of stair-step cracks; units that then remain
#: in a course at least: an element is half a unit, so that the middle of the compressed toe lies within a twentieth of the length.
#: Processor time of a run [s]
MOST_UNITS, LEAST_UNITS, BUDGET = 200, 5, 180.0
#: Share of the peak below which a wall of units is followed no further: the load at 80 % is passed
ENOUGH = 0.75
#: Least height of blocks; greatest thickness of beds of thin layer mortar [m]
BLOCK, THIN_BED = 0.19, 3e-3
#: Unfilled head joints: 1 kPa for each mm [Pa/m], and a crushing energy that this stress never reaches [N/m]
UNFILLED = {"cohesion": 0.0, "tension": 0.0, "normal_stiffness": 1e6, "crushing_energy": 1e10}
#: Energies over strengths of cracks, slip and crushing [m], assumed for all walls
CRACK_DUCTILITY, SLIP_DUCTILITY, CRUSHING_DUCTILITY = 50e-6, 200e-6, 1.6e-3
#: Tension of joints over their cohesion, and of units over the compressive strength of masonry, assumed for all walls
BOND_TENSION, UNIT_TENSION = 0.7, 0.1


def by_macro_element(wall: Wall) -> dict[str, Predicted]:
    """One pier under its axial load by two laws; its top does not rotate where the shear span is half its height, and a cantilever is
    as high as its shear span."""
    return {name: _pier(wall, law) for name, law in (("frame", "least"), ("frame-reversed", "reversed"))}


def _pier(wall: Wall, law: str) -> Predicted:
    """Strength without drift limits, and drifts at which 99 % of it is reached and at which it drops below 80 %, at the latest at a drift
    limit. Without an initial shear strength a pier fails diagonally, whatever the law."""
    path, limited = (_pushed(wall, law, limits) for limits in ((UNLIMITED, UNLIMITED), LIMITS))
    peak = int(path.multiple.argmax())
    sheared = bool((path.state[: peak + 1, 0] == STATE["shear"]).any())
    reached = int((path.multiple >= 0.99 * path.multiple[peak]).argmax())
    last = int(limited.multiple.argmax())
    lost = np.flatnonzero(limited.multiple[last:] < 0.8 * limited.multiple[last])
    drop = float(limited.control[last + lost[0]]) / wall.height if len(lost) else math.nan
    return Predicted(float(path.multiple[peak]), "S" if sheared else "F", "", float(path.control[reached]) / wall.height, drop)


def _pushed(wall: Wall, law: str, limits: tuple[float, float]) -> PushPath:
    """Push of one pier to a drift of 2 %."""
    double, diagonal = wall.span < 0.75, math.isnan(wall.cohesion)
    height = wall.height * max(wall.span, 1.0)
    pier = MacroElement(
        (-1, -1, -1, 0, 1, -1 if double else 2),
        height,
        wall.length,
        wall.thickness,
        wall.young,
        0.4 * wall.young * wall.length * wall.thickness / (1.2 * height),
        CRUSHES_AT * wall.compressive,
        shear="turnsek-cacovic" if diagonal else law,
        cohesion=0.0 if diagonal else wall.cohesion,
        friction=wall.friction,
        tension=wall.tensile,
        slenderness=min(max(wall.height / wall.length, 1.0), 1.5),
        second_order=False,
        drifts=limits,
    )
    n = 2 if double else 3
    weight, along = np.zeros(n), np.zeros(n)
    weight[1], along[0] = -wall.axial, 1.0
    with Frame([pier], [], np.zeros((n, n)), weight, np.zeros((n, n))) as frame:
        return frame.push(along, along, 0.02 * wall.height, 800, 0.0)


#: Drift limits in flexure and in shear, of NTC 2018 7.8.2.2.1 and 7.8.2.2.2
LIMITS = (0.010, 0.005)


METHODS: dict[str, Callable[[Wall], dict[str, Predicted]]] = {
    "limit": by_limit_analysis,
    "codes": by_codes,
    "membrane": by_membrane,
    "units": by_units,
    "frame": by_macro_element,
}


def _answer(deck: dict[str, Any]) -> dict[str, Any] | Predicted:
    """The results of the deck's one analysis, or why there are none."""
    try:
        analysis = extrados.run(deck, threads=1).analyses[0]
    except Exception as error:  # one wall does not end the others
        return Predicted(why_not=f"{type(error).__name__}: {error}")
    return analysis["results"] if analysis["status"] == "ok" else Predicted(why_not=analysis["reason"])


def predict(wall: Wall, methods: Iterable[str]) -> dict[str, Predicted]:
    """The predictions of the methods for a wall, by name."""
    return {name: found for method in methods for name, found in METHODS[method](wall).items()}


def predict_all(walls: list[Wall], methods: Iterable[str], processes: int) -> list[dict[str, Predicted]]:
    """The predictions for all walls. Walls whose units make the same deck share one run."""
    keys = [[(method, repr(units_deck(wall)) if method == "units" else wall.name) for method in methods] for wall in walls]
    runs = {key: wall for wall, row in zip(walls, keys, strict=True) for key in row}
    with ProcessPoolExecutor(processes) as pool:
        answers = dict(zip(runs, pool.map(predict, runs.values(), [[method] for method, _ in runs]), strict=True))
    return [{name: one for key in row for name, one in answers[key].items()} for row in keys]


def statistics(pairs: list[tuple[Wall, Predicted]]) -> tuple[float, float, int]:
    """Bias (geometric mean of predicted over measured), scatter (standard deviation of its logarithm), and how many."""
    logarithms = [math.log(found.strength / wall.peak) for wall, found in pairs if found.strength > 0.0]
    count = len(logarithms)
    if count < 2:
        return math.nan, math.nan, count
    mean = sum(logarithms) / count
    return math.exp(mean), math.sqrt(sum((x - mean) ** 2 for x in logarithms) / (count - 1)), count


def count_right_modes(pairs: list[tuple[Wall, Predicted]]) -> tuple[int, int]:
    """Of the walls that failed in flexure, shear or sliding alone, how many failures are predicted, and all."""
    pure = [(wall.mode, found.failure) for wall, found in pairs if wall.mode not in ("", "H") and found.failure]
    return sum(mode[0] == failure for mode, failure in pure), len(pure)


def print_drifts(walls: list[Wall], found: list[dict[str, Predicted]]) -> None:
    """Drifts at which a method predicts the loss of 20 %, beside the lower measured ultimate drift, by measured failure."""
    for method in sorted({name for by in found for name, one in by.items() if one.drop > 0.0}):
        for mode in ("S", "H", "F"):
            pairs = [
                (by[method].drop, wall.ultimate)
                for wall, by in zip(walls, found, strict=True)
                if wall.mode == mode and method in by and by[method].drop > 0.0 and wall.ultimate > 0.0
            ]
            if len(pairs) > 1:
                ratios = np.log([predicted / measured for predicted, measured in pairs])
                print(
                    f"{method}, failure {mode}: ultimate drift predicted/measured {math.exp(ratios.mean()):.2f}, scatter "
                    f"{ratios.std(ddof=1):.2f}; unsafe {sum(r > 0.0 for r in ratios)} of {len(pairs)}"
                )


def main() -> None:
    """Reads the table, predicts, writes predictions.csv and prints the table of methods."""
    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ask.add_argument("file", type=Path)
    ask.add_argument("--method", nargs="+", choices=METHODS, default=list(METHODS))
    ask.add_argument("--wall", nargs="+", help="numbers of rows; default all")
    ask.add_argument("--out", type=Path, default=Path("results/wall-tests"))
    ask.add_argument("--processes", type=int, default=2)
    asked = ask.parse_args()
    walls = [wall for wall in read_walls(asked.file) if not asked.wall or wall.name.split()[0] in asked.wall]
    asked.out.mkdir(parents=True, exist_ok=True)
    found = predict_all(walls, asked.method, asked.processes)
    with (asked.out / "predictions.csv").open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(
            [
                "wall",
                "failure",
                "measured_kN",
                "method",
                "predicted_kN",
                "predicted_failure",
                "why_not",
                "measured_drift",
                "predicted_drift",
                "predicted_drop_drift",
                "note",
            ]
        )
        for wall, by in zip(walls, found, strict=True):
            for method, one in by.items():
                table.writerow(
                    [
                        wall.name,
                        wall.failure,
                        f"{wall.peak / 1e3:.2f}",
                        method,
                        f"{one.strength / 1e3:.2f}",
                        one.failure,
                        one.why_not,
                        f"{wall.drift:.5f}",
                        f"{one.drift:.5f}",
                        f"{one.drop:.5f}",
                        one.note,
                    ]
                )
    print_drifts(walls, found)
    print(f"{'method':16}{'all':>18}{'shear':>18}{'hybrid':>18}{'flexure':>18}{'right mode':>12}{'none':>6}")
    for method in sorted({name for by in found for name in by}):
        pairs = [(wall, by.get(method, Predicted(why_not="not predicted"))) for wall, by in zip(walls, found, strict=True)]
        cells = []
        for mode in ("", "S", "H", "F"):
            bias, scatter, count = statistics([(w, p) for w, p in pairs if mode in ("", w.mode)])
            cells.append(f"{bias:.2f} / {scatter:.2f} ({count})")
        right, pure = count_right_modes(pairs)
        missing = sum(not p.strength > 0.0 for _, p in pairs)
        print(f"{method:16}" + "".join(f"{cell:>18}" for cell in cells) + f"{f'{right} of {pure}':>12}{missing:>6}")


if __name__ == "__main__":
    sys.exit(main())
