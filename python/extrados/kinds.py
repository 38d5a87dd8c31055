"""The one list of kinds: what may stand in [structure], [motion] and [[analysis]], and where its parts live.

Only names stand here: a command loads no more than the kinds that its deck asks for.
"""

import importlib
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

from extrados import room
from extrados.schema.constants import IN_SPACE


@dataclass(frozen=True)
class Lacks:
    """Why a kind of structure has no such view, in words."""

    reason: str


#: Where the maker of a view lives, "module:name" within the package; or why there is none
View = str | Lacks


@dataclass(frozen=True)
class StructureKind:
    """Where the parts of a structure live, each "module:name" within the package.

    table: its deck table. The makers of its views take the building: blocks, piers and solids give its stones; rigid
    (building, groups, floor) rigid bodies; rocker (building, linear) the mechanism by which it rocks; mesh (building, options,
    seed) finite elements; shell (building, options) flat shells; frame (building, options) macro-elements. handles: those of its
    drawing on the page; None where it has none.
    """

    table: str
    blocks: View
    piers: View
    solids: View
    rigid: View
    rocker: View
    mesh: View
    shell: View
    frame: View
    handles: str | None

    @property
    def lacks(self) -> dict[str, str]:
        """The views that analyses may look at and this kind has not, each with the reason."""
        views = {"blocks": self.blocks, "solids": self.solids, "rocker": self.rocker, "mesh": self.mesh}
        return {name: view.reason for name, view in views.items() if isinstance(view, Lacks)}


@dataclass(frozen=True)
class AnalysisKind:
    """Where the parts of an analysis live, each "module:name" within the package.

    table: its deck table. needs: (context, options) -> steps that refuse what it cannot begin with. driver:
    run(context, options) -> Result. results: the typed model of what it gives, or a union of models. validity: what it
    assumes, and its limits. figures: draws a stored analysis, (run, name, folder) -> [(figure, caption)]. page: its charts on the
    page, of show.charts.Shown. example: a deck with known answers, below cases/. strategies: those of `assess` that ask it.
    """

    table: str
    needs: str
    driver: str
    results: str
    validity: str
    figures: str
    page: str
    example: str
    strategies: tuple[str, ...]


#: Makers that several kinds share, and reasons
BLOCKS, PIERS, RIGID = "views.blocks:make_blocks", "views.blocks:make_piers", "views.rigid:make_rigid"
ROCKER = "views.rockers.rocker:make_rocker"
SECTION, SPATIAL = "views.solids.sections:solids_of_section", "views.solids.sections:solids_of_spatial"
MESH_OF_STONES, RODS = "views.mesh.stones:make_stones", "views.mesh.rods:add_rods"
STRANDS = "views.solids.strands:strands_of"
FRAME_OPTIONS = "views.frame.options:FrameOptions"
MESH_OPTIONS, SHELL_OPTIONS = "views.mesh.options:MeshOptions", "views.shell.options:ShellOptions"
NO_SECTION = Lacks(f"this structure has no plane section; {IN_SPACE}")
NO_STONES = Lacks("a mesh file contains elements, not blocks: describe the wall as `panel` or `blocks`")
NO_PIERS = Lacks("only walls of the kinds panel and brickwork have piers")
NO_FRAME = Lacks("only a building in plan (kind building) has a frame of piers and spandrels")
NO_SHELL = Lacks("this kind of structure has no shells; `extrados explain pushover` lists the kinds that have shells")


def _stones(
    table: str,
    *,
    piers: View = NO_PIERS,
    solids: View = SECTION,
    mesh: View = MESH_OF_STONES,
    shell: View = NO_SHELL,
    handles: str | None = None,
) -> StructureKind:
    """A plane structure of blocks and joints."""
    return StructureKind(
        f"model.structures.{table}",
        BLOCKS,
        piers,
        solids,
        RIGID,
        ROCKER,
        mesh,
        shell,
        NO_FRAME,
        None if handles is None else f"explore.handles:{handles}",
    )


def _solids(table: str, shell: View = NO_SHELL) -> StructureKind:
    """Blocks in space, no plane section."""
    return StructureKind(
        f"model.structures.{table}", NO_SECTION, NO_PIERS, SPATIAL, NO_SECTION, NO_SECTION, NO_SECTION, shell, NO_FRAME, None
    )


STRUCTURES: dict[str, StructureKind] = {
    "arch": _stones("arch:Arch", solids="views.solids.arch:solids_of_arch", shell="views.shell.vaults:shell_of_arch", handles="ARCH"),
    "block": _stones("block:Block", handles="BLOCK"),
    "vault": _stones("vault:Vault", shell="views.shell.vaults:shell_of_vault", handles="VAULT"),
    "aisled-vault": _stones("aisled_vault:AisledVault", handles="AISLED_VAULT"),
    "pointed-arch": _stones("arches:PointedArch", handles="POINTED"),
    "elliptical-arch": _stones("arches:EllipticalArch", handles="ELLIPTICAL"),
    "bridge": _stones("bridge:Bridge", handles="BRIDGE"),
    "blocks": _stones("blocks:Blocks", solids="views.solids.blocks:solids_of_blocks", handles="BLOCKS"),
    "panel": _stones("walls:Panel", piers=PIERS, mesh="views.mesh.panel:mesh_panel", handles="PANEL"),
    "mesh": StructureKind(
        "model.structures.walls:MeshFile",
        NO_STONES,
        NO_PIERS,
        SECTION,
        RIGID,
        NO_STONES,
        "views.mesh.file:mesh_file",
        "views.shell.file:shell_of_file",
        NO_FRAME,
        None,
    ),
    "column": _stones("masonry:Column", solids="views.solids.column:solids_of_column", handles="COLUMN"),
    "brickwork": _stones("brickwork:Brickwork", piers=PIERS, handles="BRICKWORK"),
    "frame": _stones("frame:Frame", handles="FRAME"),
    "stack": _stones("stack:Stack", handles="STACK"),
    "building": StructureKind(
        "model.structures.plan:Plan",
        Lacks(
            "a building in plan has walls, not blocks in a plane: draw one of its walls as `panel` or `blocks`. For the whole building, "
            "use `pushover` (with [analysis.frame] for its piers by codes), and `local-mechanism` for its walls out of plane"
        ),
        NO_PIERS,
        SECTION,
        RIGID,
        Lacks("a building in plan does not rock as one body: draw one of its walls"),
        Lacks("the walls of a building form a structure in space. Analyse it by `pushover`, or draw one of the walls as `panel`"),
        "views.shell.plan:shell_of_plan",
        "views.frame.plan:frame_of_plan",
        None,
    ),
    "wall": _solids("wall:Wall"),
    "dome": _solids("dome:Dome", shell="views.shell.vaults:shell_of_dome"),
    "chimney": _solids("chimney:Chimney", shell="views.shell.chimney:shell_of_chimney"),
    "cross-vault": _solids("cross_vault:CrossVault", shell="views.shell.vaults:shell_of_cross_vault"),
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


def _analysis(
    package: str,
    table: str,
    driver: str,
    figures: str,
    page: str,
    example: str,
    strategies: tuple[str, ...] = (),
    results: str | None = None,
) -> AnalysisKind:
    """The results of a kind are called as its table is and so is its validity."""
    return AnalysisKind(
        f"analyses.{package}.tables:{table}",
        f"analyses.{package}.needs:needs",
        f"analyses.{package}.{driver}:run",
        f"results.{results or f'{package}:{table}'}",
        f"results.validity:{table}",
        f"show.{figures}",
        f"show.charts:Shown.{page}",
        f"{example}.toml",
        strategies,
    )


ANALYSES: dict[str, AnalysisKind] = {
    "tilt": _analysis("limit", "Tilt", "tilt", "solids:draw_tilt", "tilt", "limit/oppenheim", ("tilt",), results="solids:Tilt"),
    "thrust": _analysis("limit", "Thrust", "thrust", "limit.thrust:draw", "thrust", "vault/dejong-a", results="solids:Thrust"),
    "thrust-network": _analysis(
        "limit", "ThrustNetwork", "thrust_network", "limit.network:draw", "others", "vault/thrust-network", results="networks:ThrustNetwork"
    ),
    "sweep": _analysis("limit", "Sweep", "sweep", "limit.sweep:draw_sweep", "sweep", "vault/vezelay-sweep", results="sweeps:Sweep"),
    "survey": _analysis("limit", "Survey", "survey", "limit.sweep:draw_survey", "survey", "limit/survey", results="sweeps:Survey"),
    "imperfections": _analysis(
        "limit",
        "Imperfections",
        "imperfections",
        "limit.sweep:draw_imperfections",
        "others",
        "limit/church",
        results="sweeps:Imperfections",
    ),
    "supports": _analysis("limit", "MovingSupports", "supports", "limit.supports:draw", "supports", "limit/oppenheim"),
    "moving-load": _analysis("limit", "MovingLoad", "moving_load", "limit.moving_load:draw", "moving_load", "limit/oppenheim"),
    "rocking": _analysis("rocking", "Rocking", "driver", "arch:draw_rocking", "rocking", "arch/oppenheim", ("rocking",)),
    "failure-domain": _analysis(
        "rocking", "FailureDomain", "failure_domain", "arch:draw_failure_domain", "failure_domain", "arch/oppenheim-domain"
    ),
    "failure-curves": _analysis(
        "rocking", "FailureCurves", "failure_curves", "curves:draw_failure_curves", "failure_curves", "arch/figure-5-4"
    ),
    "assessment": _analysis("rocking", "Assessment", "assessment", "arch:draw_assessment", "assessment", "arch/readme", ("assessment",)),
    "fragility": _analysis(
        "statistics", "Fragility", "fragility", "statistics:draw_fragility", "fragility", "fragility/pga-curve", ("probability",)
    ),
    "resonance": _analysis("statistics", "Resonance", "resonance", "statistics:draw_resonance", "others", "rocking/resonance"),
    "rocking-spectrum": _analysis(
        "statistics", "RockingSpectrum", "rocking_spectrum", "statistics:draw_rocking_spectrum", "others", "rocking/el-centro-block"
    ),
    "harmonic-map": _analysis(
        "statistics", "HarmonicMap", "harmonic_map", "statistics:draw_harmonic_map", "others", "rocking/el-centro-block"
    ),
    "code-checks": _analysis(
        "codes", "CodeChecks", "code_checks", "statistics:draw_code_checks", "others", "rocking/el-centro-block", ("code-checks",)
    ),
    "local-mechanism": _analysis(
        "codes",
        "LocalMechanism",
        "local_mechanism",
        "codes:draw_local_mechanism",
        "local_mechanism",
        "codes/facade",
        results="codes:LocalMechanisms",
    ),
    "motion": _analysis("motion", "MotionStudy", "motion_study", "motion:draw_motion", "others", "motion/el-centro"),
    "shake-table": _analysis("motion", "ShakeTable", "shake_table", "motion:draw_shake_table", "others", "motion/appendix-c"),
    "sla": _analysis("sla", "Sla", "driver", "sla:draw_sla", "sla", "sla/beam", ("sla",)),
    "pushover": _analysis("shell", "Pushover", "pushover", "shell:draw_pushover", "pushover", "building/two-rooms", ("push-x", "push-y")),
    "dem": _analysis("dem", "Dem", "driver", "dem:draw_dem", "dem", "dem/oppenheim", ("dem",)),
    "dem-domain": _analysis("dem", "DemDomain", "dem_domain", "dem:draw_domain", "dem_domain", "dem/domain"),
    "dem-fragility": _analysis(
        "dem", "DemFragility", "fragility", "statistics:draw_fragility", "fragility", "dem/fragility", results="statistics:DemFragility"
    ),
    "modes": _analysis("frame", "Modes", "block_modes", "frame:draw_modes", "others", "arch/modes"),
    "frame-modes": _analysis("frame", "FrameModes", "modes", "frame:draw_modes", "others", "frame/two-rooms"),
    "frame-pushover": _analysis("frame", "FramePushover", "pushover", "frame:draw_pushover", "others", "frame/two-rooms", ("frame",)),
    "frame-history": _analysis("frame", "FrameHistory", "history", "frame:draw_history", "others", "frame/history"),
    "frame-fragility": _analysis("frame", "FrameFragility", "fragility", "frame:draw_fragility", "others", "frame/fragility"),
    "assess": _analysis("assess", "Assess", "driver", "assess:draw_assess", "others", "assess/readme-arch"),
    "strengthen": _analysis("strengthen", "Strengthen", "driver", "strengthen:draw_strengthen", "strengthen", "strengthen/nave"),
    "dem-parameters": _analysis("dem", "DemParameters", "dem_parameters", "dem:draw_parameters", "others", "dem/rocking-block"),
}

#: Section of a deck -> its kinds, each with the place of its table
TABLES: dict[str, dict[str, str]] = {
    "structure": {kind: parts.table for kind, parts in STRUCTURES.items()},
    "motion": MOTIONS,
    "analysis": {kind: parts.table for kind, parts in ANALYSES.items()},
}


def load(place: str) -> Any:
    """What stands at "module:name" within the package; MemoryError where there is no room to load it."""
    module, name = place.split(":")
    try:
        return attrgetter(name)(importlib.import_module(f"extrados.{module}"))
    except Exception as error:
        if room.lacked(error):
            raise MemoryError(f"not enough memory: {type(error).__name__}: {error}") from error
        raise


def table(section: str, kind: str) -> Any:
    """The deck table of a kind; KeyError where there is none."""
    return load(TABLES[section][kind])
