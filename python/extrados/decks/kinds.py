"""The one table of kinds: what may stand in [structure], [motion] and [[analysis]]."""

from extrados.decks import (
    analyses,
    block,
    dem,
    limit,
    masonry,
    motion_analyses,
    motions,
    sla,
    statistics,
    structures,
    vaults,
    walls,
)
from extrados.decks.table import Analysis, Motion, Structure, Table

STRUCTURES: tuple[type[Structure], ...] = (
    structures.Arch,
    block.Block,
    vaults.Vault,
    vaults.AisledVault,
    vaults.PointedArch,
    vaults.EllipticalArch,
    vaults.Blocks,
    walls.Panel,
    walls.Mesh,
    masonry.Column,
    masonry.BrickWall,
)
MOTIONS: tuple[type[Motion], ...] = (
    motions.Constant,
    motions.StepPulse,
    motions.SinePulse,
    motions.Harmonic,
    motions.Pulse,
    motions.VelocityPulse,
    motions.Record,
    motions.Suite,
    motions.Generated,
    motions.Compatible,
)
ANALYSES: tuple[type[Analysis], ...] = (
    limit.Tilt,
    limit.Thrust,
    limit.Sweep,
    limit.Survey,
    limit.Supports,
    limit.MovingLoad,
    analyses.Rocking,
    analyses.FailureDomain,
    analyses.Assessment,
    sla.Sla,
    motion_analyses.MotionStudy,
    motion_analyses.ShakeTable,
    statistics.Fragility,
    statistics.Resonance,
    statistics.RockingSpectrum,
    statistics.HarmonicMap,
    statistics.CodeChecks,
    dem.Dem,
    dem.DemDomain,
    dem.DemParameters,
)


def kind_of(model: type[Table]) -> str:
    """The word that selects a model."""
    return model.model_fields["kind"].annotation.__args__[0]


SECTIONS: dict[str, dict[str, type[Table]]] = {
    "structure": {kind_of(m): m for m in STRUCTURES},
    "motion": {kind_of(m): m for m in MOTIONS},
    "analysis": {kind_of(m): m for m in ANALYSES},
}
