"""The outcome of one section among many: its capacity with its mechanism, or the reason for none, and the row that is kept."""

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from extrados.analyses.batches import Swept
from extrados.limit.programme import Mechanism
from extrados.model.geometry.assembly import Assembly
from extrados.results.sweeps import SectionStatus

if TYPE_CHECKING:
    from extrados.limit.solids import Programme
    from extrados.model.geometry.solids.assembly import SolidAssembly

Signature = tuple[tuple[str, str], ...]
#: Stands for a structure that no load of the kind brings down
LOCKED: Signature = (("all", "locked"),)
#: Stands for a structure without geometry, or whose capacity is not found; one that cannot stand has no marks
UNKNOWN: Signature = (("all", "unknown"),)
#: Marks the blocks that move in a mechanism of solids, in words
MOVES = "m"


@dataclass(frozen=True)
class Outcome:
    """What one section gives: its collapse acceleration gamma [g], 0 with the proof as reason where it cannot stand, None
    with a reason where there is no answer."""

    gamma: float | None = None
    fractured: float | None = None
    signature: Signature = ()
    gap: float = 0.0
    reason: str = ""
    assembly: "Assembly | SolidAssembly | None" = None
    mechanism: "Mechanism | Programme | None" = None
    notes: list[str] = field(default_factory=list)
    locked: bool = False  # no load of the kind brings it down: it stands, but has no capacity to give
    dilating: bool = False  # pressed joints slide in its mechanism: gamma is an upper bound by dilatant friction
    measures: dict[str, float] = field(default_factory=dict)  # derived lengths of the section [m]
    alone: float | None = None  # of the leeward buttress by itself

    @property
    def status(self) -> SectionStatus:
        """Whether it has a capacity, cannot stand, is locked, or has no answer."""
        if self.locked:
            return "locked"
        return "no-answer" if self.gamma is None else "cannot-stand" if self.reason else "ok"

    def row(self) -> dict[str, np.ndarray]:
        """What a sweep keeps of it: all but the assembly and its mechanism."""
        words = [self.signature, self.reason, self.notes, self.measures]
        numbers = [
            np.nan if self.gamma is None else self.gamma,
            np.nan if self.fractured is None else self.fractured,
            self.gap,
            np.nan if self.alone is None else self.alone,
        ]
        marks = np.array([self.locked, self.dilating])
        return {"numbers": np.array(numbers), "marks": marks, "words": np.array(json.dumps(words))}


def outcome_of(row: dict[str, np.ndarray]) -> Outcome:
    """The outcome of a kept row."""
    gamma, fractured, gap, alone = (None if np.isnan(x) else float(x) for x in row["numbers"])
    marks, reason, notes, measures = json.loads(str(row["words"]))
    return Outcome(
        gamma,
        fractured,
        tuple((name, mark) for name, mark in marks),
        gap or 0.0,
        reason,
        notes=notes,
        locked=bool(row["marks"][0]),
        dilating=bool(row["marks"][1]),
        measures=measures,
        alone=alone,
    )


def outcomes_of(swept: Swept) -> list[Outcome]:
    """The outcomes of all members."""
    return [outcome_of({name: rows[k] for name, rows in swept.arrays.items()}) for k in range(len(swept.members))]


def measures_of(assembly: "Assembly | SolidAssembly") -> dict[str, float]:
    """Derived lengths of a section."""
    return {k: float(v) for k, v in assembly.measures.items()}
