"""The one list of kinds: what may stand in [structure], [motion] and [[analysis]], and where its parts live.

Only names stand here: a command loads no more than the kinds that its deck asks for.
"""

import importlib
from dataclasses import dataclass
from typing import Any

from extrados import room  # which also looks at the room for SciPy before it is loaded


@dataclass(frozen=True)
class AnalysisKind:
    """Where the parts of an analysis live, each "module:name" within the package.

    table: its deck table. driver: run(context, options) -> Result. results: the typed model of what it gives, or a
    union of models. figures: draws a stored analysis, (run, name, folder) -> [(figure, caption)]. example: a deck with
    known answers, below cases/.
    """

    table: str
    driver: str
    results: str
    figures: str
    example: str


STRUCTURES: dict[str, str] = {
    "arch": "model.structures.arch:Arch",
    "block": "model.structures.block:Block",
    "vault": "model.structures.vault:Vault",
    "aisled-vault": "model.structures.aisled_vault:AisledVault",
    "pointed-arch": "model.structures.arches:PointedArch",
    "elliptical-arch": "model.structures.arches:EllipticalArch",
    "bridge": "model.structures.bridge:Bridge",
    "blocks": "model.structures.blocks:Blocks",
    "panel": "model.structures.walls:Panel",
    "mesh": "model.structures.walls:MeshFile",
    "column": "model.structures.masonry:Column",
    "brickwork": "model.structures.brickwork:Brickwork",
    "frame": "model.structures.frame:Frame",
    "stack": "model.structures.stack:Stack",
    "building": "model.structures.plan:Plan",
    "wall": "model.structures.wall:Wall",
    "dome": "model.structures.dome:Dome",
    "cross-vault": "model.structures.cross_vault:CrossVault",
}
MOTIONS: dict[str, str] = {
    "constant": "motions.tables:Constant",
    "step-pulse": "motions.tables:StepPulse",
    "sine-pulse": "motions.tables:SinePulse",
    "harmonic": "motions.tables:Harmonic",
    "pulse": "motions.tables:Pulse",
    "velocity-pulse": "motions.tables:VelocityPulse",
    "record": "motions.tables:Record",
    "suite": "motions.tables:Suite",
    "generated": "motions.tables:Generated",
    "compatible": "motions.tables:Compatible",
}


def _analysis(place: str, table: str, driver: str, figures: str, example: str) -> AnalysisKind:
    """The results of a kind are called as its table is."""
    return AnalysisKind(
        f"analyses.{place}.tables:{table}", f"analyses.{place}.{driver}:run", f"results.{place}:{table}", f"show.{figures}",
        f"{example}.toml",
    )  # fmt: skip


ANALYSES: dict[str, AnalysisKind] = {
    "tilt": AnalysisKind(
        "analyses.limit.tables:Tilt", "analyses.limit.tilt:run", "results.solids:Tilt", "show.solids:draw_tilt", "limit/oppenheim.toml"
    ),
    "thrust": _analysis("limit", "Thrust", "thrust", "limit.thrust:draw", "vault/dejong-a"),
    "sweep": _analysis("limit", "Sweep", "sweep", "limit.sweep:draw_sweep", "vault/vezelay-sweep"),
    "survey": _analysis("limit", "Survey", "survey", "limit.sweep:draw_survey", "limit/survey"),
    "imperfections": _analysis(
        "limit", "Imperfections", "imperfections", "limit.sweep:draw_imperfections", "limit/church"
    ),
    "supports": _analysis("limit", "MovingSupports", "supports", "limit.supports:draw", "limit/oppenheim"),
    "moving-load": _analysis("limit", "MovingLoad", "moving_load", "limit.moving_load:draw", "limit/oppenheim"),
    "rocking": _analysis("rocking", "Rocking", "driver", "arch:draw_rocking", "arch/oppenheim"),
    "failure-domain": _analysis(
        "rocking", "FailureDomain", "failure_domain", "arch:draw_failure_domain", "arch/oppenheim-domain"
    ),
    "failure-curves": _analysis(
        "rocking", "FailureCurves", "failure_curves", "curves:draw_failure_curves", "arch/figure-5-4"
    ),
    "assessment": _analysis("rocking", "Assessment", "assessment", "arch:draw_assessment", "arch/readme"),
    "fragility": _analysis(
        "statistics", "Fragility", "fragility", "statistics:draw_fragility", "fragility/pga-curve"
    ),
    "resonance": _analysis("statistics", "Resonance", "resonance", "statistics:draw_resonance", "rocking/resonance"),
    "rocking-spectrum": _analysis(
        "statistics", "RockingSpectrum", "rocking_spectrum", "statistics:draw_rocking_spectrum", "rocking/el-centro-block"
    ),
    "harmonic-map": _analysis(
        "statistics", "HarmonicMap", "harmonic_map", "statistics:draw_harmonic_map", "rocking/el-centro-block"
    ),
    "code-checks": _analysis("codes", "CodeChecks", "code_checks", "statistics:draw_code_checks", "rocking/el-centro-block"),
    "local-mechanism": _analysis(
        "codes", "LocalMechanism", "local_mechanism", "codes:draw_local_mechanism", "codes/facade"
    ),
    "motion": _analysis("motion", "MotionStudy", "motion_study", "motion:draw_motion", "motion/el-centro"),
    "shake-table": _analysis("motion", "ShakeTable", "shake_table", "motion:draw_shake_table", "motion/appendix-c"),
    "sla": _analysis("sla", "Sla", "driver", "sla:draw_sla", "sla/beam"),
    "pushover": _analysis("shell", "Pushover", "pushover", "shell:draw_pushover", "building/two-rooms"),
    "dem": _analysis("dem", "Dem", "driver", "dem:draw_dem", "dem/oppenheim"),
    "dem-domain": _analysis("dem", "DemDomain", "dem_domain", "dem:draw_domain", "dem/domain"),
    "assess": _analysis("assess", "Assess", "driver", "assess:draw_assess", "assess/readme-arch"),
    "dem-parameters": _analysis("dem", "DemParameters", "dem_parameters", "dem:draw_parameters", "dem/rocking-block"),
}  # fmt: skip

#: Section of a deck -> its kinds, each with the place of its table
TABLES: dict[str, dict[str, str]] = {
    "structure": STRUCTURES,
    "motion": MOTIONS,
    "analysis": {kind: parts.table for kind, parts in ANALYSES.items()},
}


def load(place: str) -> Any:
    """What stands at "module:name" within the package; MemoryError where there is no room to load it."""
    module, name = place.split(":")
    try:
        return getattr(importlib.import_module(f"extrados.{module}"), name)
    except Exception as error:
        if room.lacked(error):
            raise MemoryError(f"not enough memory: {type(error).__name__}: {error}") from error
        raise


def table(section: str, kind: str) -> Any:
    """The deck table of a kind; KeyError where there is none."""
    return load(TABLES[section][kind])
