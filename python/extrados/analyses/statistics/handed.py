"""Members of an ensemble in which joints slide or hinges form elsewhere: rigid contacts decide them, one by one."""

from dataclasses import dataclass, replace

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.rocking.hand_over import Fates, contacts_of
from extrados.analyses.statistics.tables import Fragility
from extrados.analyses.statistics.uncertain import Sample
from extrados.core.rocking import Body, Ground
from extrados.results.rocking import COLLAPSE, NO_HINGING, SLID
from extrados.views.rockers.rocker import Rocker


@dataclass(frozen=True)
class Handed:
    """fates: of the nominal building; sample: of buildings of uncertain values."""

    fates: Fates
    sample: Sample | None = None

    def by(self, body: Body) -> "Handed":
        """The nominal building by another body, of another rule of impact, until contacts follow it."""
        contacts = self.fates.contacts
        return Handed(replace(self.fates, contacts=replace(contacts, leaving=replace(contacts.leaving, body=body))))

    def settle(
        self, rows: dict[str, np.ndarray], members: np.ndarray, buildings: np.ndarray, grounds: list[Ground], settle: float, threads: int
    ) -> None:
        """Put the outcomes and greatest rotations by contacts into the rows of some members, and mark them as handed: half cycles 0, stop
        time NaN. buildings, grounds: of these members; settle: time after a motion [s]. The greatest rotation is that of any block, of a
        stack as in the core. A building that only slides does not rock."""
        for k, building, ground in zip(members, buildings, grounds, strict=True):
            fates = self.fates
            if self.sample is not None:
                rocker, varied = self.sample.rocker_and_building(int(building))
                contacts = contacts_of(rocker, varied)
                if contacts is None:
                    continue
                fates = fates.alike(contacts)
            found = fates.follow(ground, float(rows["scale"][k]), ground.end + settle, threads)
            if found.outcome < 0:
                continue
            rows["outcome"][k], rows["handed"][k] = NO_HINGING if found.outcome == SLID else found.outcome, 1
            rows["half_cycles"][k], rows["stop_time"][k] = 0, np.nan  # of the mechanism, which does not hold
            rows["peak"][k] = found.rotation
            rows["peak_ratio"][k] = max(1.0, found.ratio) if found.outcome == COLLAPSE else found.ratio


def handed_of(context: Context, options: Fragility, base: Rocker, sample: Sample | None) -> Handed | None:
    """How contacts decide members, where the deck wants it; Refused where they cannot."""
    if not options.hand_over:
        return None
    contacts = contacts_of(base, context.building, options.form == "linear")
    if contacts is None:
        raise Refused(
            "rigid contacts cannot continue runs of this building: a wall, an added hinge or a Winkler bed acts on it, "
            'or its joints are not checked (piers without blocks, or form = "linear"). Remove `hand_over`',
            ("analysis", "hand_over"),
        )
    return Handed(Fates.of(context, contacts), sample)
