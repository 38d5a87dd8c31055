"""The answer of a push in words, and its warnings."""

from typing import Any

from extrados.analyses.shell.model import ShellModel
from extrados.analyses.shell.tables import Pushover
from extrados.analyses.sla.events import Curve
from extrados.analyses.sla.measures import out_of_reach
from extrados.schema.quantities import engineering
from extrados.views.building import Building

#: Forces below this part of the weight are rounding
ROUNDING = 1e-9
#: What elements of a mesh file are called that are of no group
NO_GROUP = "shell"


def answer_of_push(building: Building, options: Pushover, numbers: dict[str, Any]) -> str:
    """Stages, curves, variants, formulas of codes and assumed values, in sentences."""
    word = "building" if building.structure is None else building.structure.word
    grouped = building.structure is not None and building.structure.kind == "mesh"
    parts = []
    if "stages" in numbers:
        ends = [_stage_told(stage) for stage in numbers["stages"]]
        parts.append(f"Stages, each starting with the damage of the stages before: {'; '.join(ends)}.")
    for curve in [numbers, *([numbers["minus"]] if "minus" in numbers else [])]:
        parts.append(_curve_told(options, numbers, curve, word, grouped))
    if numbers.get("band_N"):
        low, high = numbers["band_N"]
        parts.append(
            f"The base shear of {len(numbers['variants'])} variants with other assumptions is {low / 1000.0:.4g} to {high / 1000.0:.4g} kN."
        )
    if "frame" in numbers:
        words = [f"{row['base_shear_N'] / 1e3:.4g} kN by {row['code']} (storey {row['storey']})" for row in numbers["frame"]]
        parts.append(f"The capacity of the piers by code formulas is {' and '.join(words)}.")
    assumed = getattr(building.structure, "assumed", [])
    if assumed:
        parts.append("Assumed values, not given by the sources of this building: " + "; ".join(assumed) + ".")
    return " ".join(part for part in parts if part)


def _stage_told(stage: dict[str, Any]) -> str:
    end = stage["end_load_N"]
    if end is None:
        return f"{stage['name']}, no equilibrium state found"
    if stage["of"] == "settlement":
        return f"{stage['name']}, settlement of the ground: {stage['damaged_points']} integration points crack"
    return f"{stage['name']}, load towards {stage['sense']}, ends at {end / 1e3:.4g} kN ({stage['stop']})"


def pressing(row: dict[str, Any], weight: float) -> str:
    """Forces of a springing on the ground in words; rounding errors beside the weight are omitted."""
    parts = []
    for force, ways in ((row["thrust_N"], ("outward", "inward")), (row["vertical_N"], ("down", "up"))):
        if abs(force) > ROUNDING * weight:
            parts.append(f"{ways[force < 0.0]} with {abs(force) / 1e3:.4g} kN")
    return f"presses {' and '.join(parts)}" if parts else "carries nothing"


def _curve_told(options: Pushover, numbers: dict[str, Any], curve: dict[str, Any], word: str, grouped: bool) -> str:
    """Conclusion of a pushover of a building or a vault; on a compliant base with the forces of the springings. grouped: its parts are groups of
    a mesh file."""
    main = next((stage for stage in numbers.get("stages", []) if not stage["prefix"]), None)
    feet = "; ".join(f"its foot {row['foot']} {pressing(row, numbers['weight_N'])}" for row in curve.get("feet", []))
    if main is not None and main["of"] == "settlement":
        return f"After stage {main['name']} {feet}." if feet else ""
    load = curve["greatest_load_N"]
    sense = (
        f"Under the load towards {curve['sense']} ({options.direction:g} degrees in plan)" if main is None else f"In stage {main['name']}"
    )
    if load is None:
        if curve["stop"] == "no point limits the load":
            return f"{sense} the load has no limit, because the deck gives no strength at which the masonry cracks, crushes or slides."
        return f"{sense}: no equilibrium state was found."
    carries = "carries" if curve["peak_load_N"] is not None else "carries at least"
    part = f"{curve['base_shear_coefficient']:.3g} of its weight of {numbers['weight_N'] / 1e3:.4g} kN"
    slides = curve["capacity_N"] < load
    if slides:
        text = (
            f"{sense}, the {word} carries a base shear of at most {curve['capacity_N'] / 1e3:.4g} kN ({part}), and then slides "
            f"at {curve['sliding_level']} by Coulomb's law. Without this sliding the model {carries} {load / 1e3:.4g} kN"
        )
    else:
        text = f"{sense}, the {word} {carries} a base shear of {load / 1e3:.4g} kN, {part}"
    if curve["roof_drift"] is not None:
        text += f", at a drift of {100 * curve['roof_drift']:.2g} %"
    if "first_crack" in curve:
        crack = curve["first_crack"]
        if "along_m" in crack:
            text += (
                f"; the first crack forms in wall {crack['wall']}, storey {crack['storey']}, {crack['along_m']:.3g} m along the "
                f"wall and {crack['height_m']:.3g} m above the ground, under {crack['base_shear_N'] / 1e3:.3g} kN"
            )
        else:
            x, y, z = crack["place_m"]
            part = crack["wall"]
            where = f"group {part}" if grouped and part != NO_GROUP else f"the {part}"
            text += f"; the first crack forms in {where} at x {x:.3g}, y {y:.3g}, z {z:.3g} m, under {crack['base_shear_N'] / 1e3:.3g} kN"
    if any(r["share"] > 0.02 for r in curve["walls"]):
        most = sorted(curve["walls"], key=lambda row: -row["share"])[:4]
        text += "; " + ", ".join(f"wall {r['wall']} carries {100 * r['share']:.0f} %" for r in most if r["share"] > 0.02)
    if "flanges" in curve:
        flanges = curve["flanges"]
        text += (
            f"; transverse walls {'act as flanges' if flanges['working'] else 'hardly act as flanges'} "
            f"({flanges['uplift_N'] / 1e3:.3g} kN up and {flanges['pressure_N'] / 1e3:.3g} kN down at their feet)"
        )
    moved = [row for row in curve.get("joints", []) if row["broken_share"] > 0.0]
    for row in sorted(moved, key=lambda row: -max(row["last_slip_m"], row["last_opening_m"]))[:3]:
        text += (
            f"; joint {row['joint']} in wall {row['wall']}{_gave_way(row)} has slid by {1e3 * row['last_slip_m']:.2g} mm and opened by "
            f"{1e3 * row['last_opening_m']:.2g} mm at the end"
        )
    for row in (row for row in curve.get("seats", []) if row["slid_off"]):
        text += (
            f"; {row['floor']} slides off wall {row['wall']} at a displacement of {1e3 * row['slid_off_displacement_m']:.3g} mm, because its "
            f"seat is only {1e3 * row['length_m']:.3g} mm long; its friction on this wall is {row['friction_N'] / 1e3:.3g} kN"
        )
    return f"{text}{'; ' if feet else ''}{feet}."


def _gave_way(row: dict[str, Any]) -> str:
    """When a joint gave way: under the constant loads, where no event of the push did it."""
    load = row["first_base_shear_N"]
    return "" if load is None else f" fails under {load / 1e3:.3g} kN and"


def remarks_of_curve(model: ShellModel, curve: Curve) -> list[str]:
    """Warnings of a curve that leaves the reach of the theory, or has no peak."""
    events, sense = curve.events, f" (stage {curve.name})" if curve.name else f" (push to {curve.sense})"
    said = [far] if (far := out_of_reach(curve)) else []
    if model.driven or (curve.name and events.reason == "target load"):
        return said  # a stage that ends at its target
    if curve.peak >= 0 and not events.interrupted and not curve.passed(model.unit):
        said.append(
            f"the run{sense} ended before the base shear decreased ({events.reason or 'number of events'}). The greatest value, "
            f"{engineering(curve.force(model.unit)[curve.peak], 'N')}, is therefore not a capacity"
        )
    return said


def warn_unequal_drives(options: Pushover, numbers: dict[str, Any]) -> list[str]:
    """A warning where drives of unequal ratios make the load another quantity than the base shear."""
    if len({drive.ratio for drive in options.drives}) < 2 or not numbers["walls"]:
        return []
    carried, load = sum(row["shear_N"] for row in numbers["walls"]), numbers["greatest_load_N"]
    return [
        (
            "The `drives` move their storeys by different ratios. The load of the curve is therefore the work of all drives divided by "
            f"the control displacement, not the base shear. At the greatest load of {engineering(load, 'N')}, the base shear "
            f"of the walls in the direction of the load is {engineering(carried, 'N')}. Compare measured base shears with this base shear."
        )
    ]
