"""The first sense of a push again, of a building with other assumptions."""

from dataclasses import replace
from typing import Any

from extrados.analyses.context import Context
from extrados.analyses.shell.curves import push_curves
from extrados.analyses.shell.model import build
from extrados.analyses.shell.tables import Pushover, Variant
from extrados.analyses.sla.measures import numbers_of
from extrados.model.properties import Material
from extrados.model.structures.plan import Plan
from extrados.results.model import Array, Result
from extrados.views.building import Building


def run_variants(context: Context, options: Pushover, result: Result, numbers: dict[str, Any]) -> dict[str, Any]:
    """The first sense again with other assumptions."""
    rows, greatest = [], [numbers["greatest_load_N"]]
    once = options.model_copy(update={"directions": options.directions[:1], "variants": [], "states": []})
    for k, variant in enumerate(options.variants, 1):
        mesh = _varied(context.building, variant).shell(options.mesh)
        if not mesh.walls:  # a vault, or a mesh of shells: as it stands, but thicker
            parts = [replace(p, thickness=variant.thickness * p.thickness) if p.bends else p for p in mesh.parts]
            mesh = replace(mesh, parts=parts)
        model = build(mesh, once)
        curve = push_curves(context, model, once)[0]
        d, p = curve.envelope(model.unit)
        found = numbers_of(model, once, curve)["greatest_load_N"]
        result.arrays[f"variant_{k}_displacement"] = Array(
            d, (f"variant_{k}",), "m", f"control displacement, {variant.name}", "variant_displacement"
        )
        result.arrays[f"variant_{k}_load"] = Array(p, (f"variant_{k}",), "N", f"base shear, {variant.name}", "variant_load")
        factors = {name: value for name, value in variant.model_dump().items() if name != "name" and value != 1.0}
        rows.append(
            {
                "name": variant.name,
                "factors": factors,
                "greatest_base_shear_N": found,
                "passed": curve.passed(model.unit),
                "base_shear_coefficient": None if found is None else found / model.weight,
            }
        )
        greatest.append(found)
        if curve.events.interrupted:
            break
    known = [value for value in greatest if value is not None]
    return {"variants": rows} | ({"band_N": [min(known), max(known)]} if known else {})


def _varied(building: Building, variant: Variant) -> Building:
    """The building with other material, and of walls on a plan with other thicknesses, floors and forces."""

    def material(of: Material) -> Material:
        scaled = {
            name: getattr(of, name) * factor
            for names, factor in (
                (("tensile_strength", "tensile_strength_parallel", "shear_strength"), variant.strength),
                (("fracture_energy", "fracture_energy_parallel"), variant.energy),
                (("young",), variant.young),
                (("density",), variant.density),
            )
            for name in names
            if getattr(of, name) is not None
        }
        return of.model_copy(update=scaled)

    plan = building.structure
    changed = replace(
        building, material=material(building.material), materials={name: material(of) for name, of in building.materials.items()}, views={}
    )
    if not isinstance(plan, Plan):
        return changed
    walls = [
        wall.model_copy(
            update={
                "thickness": None if wall.thickness is None else variant.thickness * wall.thickness,
                "thicknesses": [variant.thickness * t for t in wall.thicknesses],
            }
        )
        for wall in plan.walls
    ]
    floors = [f if f.young is None else f.model_copy(update={"young": f.young * variant.floors}) for f in plan.floors]
    prestress = [p.model_copy(update={"force": p.force * variant.prestress}) for p in plan.prestress if variant.prestress > 0.0]
    return changed.having(structure=plan.model_copy(update={"walls": walls, "floors": floors, "prestress": prestress}))
