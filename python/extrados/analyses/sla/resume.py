"""Going on from the stored events of an earlier run: the damage at one of them, and what had been counted by then.

A damage counts teeth: it says something of the laws, bands and stiffnesses alone that it was found with.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.sla.events import Curve, damage_before
from extrados.analyses.sla.model import SlaModel
from extrados.analyses.sla.tables import Sla
from extrados.core import sla as core
from extrados.results.checkpoint import fingerprint
from extrados.results.sla import Makeup
from extrados.results.store import Stored, StoreError, read
from extrados.schema.files import BadFile, locate

RESUME = ("analysis", "resume_from")  # the key of the deck
LEDGER = ("external", "lost", "crack")


@dataclass(frozen=True)
class Earlier:
    """The event of an earlier run at which a resumed one begins: its sense, the events before it, its load [N] and
    point, and the ledger [J] at it."""

    sense: str
    events: int
    load: float
    point: int
    totals: list[float]


def makeup(model: SlaModel) -> Makeup:
    """Fingerprints of what the damage of this wall rests on."""
    stiffness: list = []
    laws: dict[str, list] = {"tension": [], "compression": []}
    fixed: list = []
    for group in model.groups:
        if isinstance(group, core.Springs):
            continue
        if isinstance(group, core.Joints):
            stiffness.append(["Joints", group.area, group.normal_stiffness, group.shear_stiffness])
            for name, found in laws.items():
                found.append(_law(getattr(group, name)))
            laws["tension"].append(_law(group.cohesion))  # the teeth of sliding go with those of parting
            fixed.append(["Joints", group.normal, group.friction, group.dry, group.small, group.ripple])
            continue
        size = (
            [group.area, group.length, group.bears]
            if isinstance(group, core.Bars)
            else [group.thickness, group.nu, group.kind, group.points]
        )
        stiffness.append([type(group).__name__, size, group.young])
        for sense, found in laws.items():
            found.append([*_law(getattr(group, sense)), group.band])
        if isinstance(group, core.Plane):
            laws["tension"] += [group.reach, group.bedding]
            laws["compression"] += [group.confinement, group.hill]
            fixed.append([group.axis, group.joint, group.lateral, group.selective])
    return Makeup(
        stiffness=fingerprint(stiffness)[:16],
        tension=fingerprint(laws["tension"])[:16],
        compression=fingerprint(laws["compression"])[:16],
        cracking=fingerprint([model.behaviour, fixed])[:16],
    )


def _law(law: core.Softening | Sequence[core.Softening | None] | None) -> list:
    """The kinds of laws, and which of them each element has: a wall of a hundred thousand elements has a few."""
    each = list(law) if isinstance(law, list | tuple) else [law]
    kinds = list(dict.fromkeys(each))
    number = {kind: k for k, kind in enumerate(kinds)}
    return [kinds, np.array([number[kind] for kind in each])]


def _refuse_other(there: Makeup | None, here: Makeup) -> None:
    if there is None:
        raise Refused("resume_from: the earlier run does not state its materials; run it again with this version", RESUME)
    words = {
        "stiffness": "stiffness or thickness",
        "tension": "tensile laws, teeth or crack bands",
        "compression": "crushing laws",
        "cracking": "ways of cracking",
    }
    other = [words[name] for name in words if getattr(there, name) != getattr(here, name)]
    if other:
        raise Refused(
            f"resume_from: the earlier wall has different {' and different '.join(other)}, so its damage does not apply to this wall",
            RESUME,
        )


def read_earlier(context: Context, options: Sla) -> Stored:
    """The run that the deck names; Refused where there is none."""
    try:
        return read(locate(str(options.resume_from), context.deck.folder))
    except (StoreError, BadFile) as error:
        raise Refused(f"resume_from: {error}", RESUME) from None


def start_of(context: Context, options: Sla, model: SlaModel) -> tuple[np.ndarray | None, Earlier | None]:
    """The damage stored by an earlier run before the event asked for, and what had been counted at that event."""
    if options.resume_from is None:
        return None, None
    stored = read_earlier(context, options)
    try:
        get = {name: array.numbers for name, array in stored.arrays["sla"].items()}
        there, here = get["point_xy"], model.point_xy
        if len(there) != len(here):
            raise Refused(
                f"resume_from: the earlier wall has {len(there)} integration points, and this wall has {len(here)}; the mesh must "
                "be the same",
                RESUME,
            )
        apart = float(np.abs(there - here).max())
        if apart > 1e-6 * model.mesh.size:
            raise Refused(
                f"resume_from: the integration points of the earlier wall are up to {apart:.3g} m away from those of "
                "this wall; the mesh must be the same",
                RESUME,
            )
        if len(get["event_point"]) and get["event_point"].max() < 0:
            raise Refused("resume_from: the earlier run was incremental and has no events from which to continue", RESUME)
        if stored["sla"].get("stages"):
            raise Refused(
                "resume_from: the earlier run was in stages, whose supports and loads are not saved: add a stage to that run instead",
                RESUME,
            )
        _refuse_other(stored["sla"].get("makeup"), makeup(model))
        event = len(get["event_point"]) if options.resume_event is None else options.resume_event
        if event > len(get["event_point"]):
            raise Refused(
                f"`resume_event` is {event}, but the earlier run has {len(get['event_point'])} events", ("analysis", "resume_event")
            )
        if event >= 1 and "event_step" in get and get["event_step"][event - 1]:
            first = int(np.argmax(get["event_step"])) + 1
            raise Refused(
                f"resume_from: event {event} is a step of equilibrium iterations, whose damage has no teeth. Give at most "
                f"event {first - 1}, the last event before these steps",
                ("analysis", "resume_event"),
            )
        earlier = None
        if event >= 1:
            totals = [float(get[f"event_{name}"][event - 1]) for name in LEDGER]
            numbers = stored["sla"]
            before = numbers.get("events_before_resume", 0) + event - 1
            earlier = Earlier(numbers["sense"], before, float(get["event_load"][event - 1]), int(get["event_point"][event - 1]), totals)
        lost = "joints that slide" if model.slides else "cracks that rotate"
        by_events = not model.slides and stored["sla"].get("cracking") != "rotating"
        return _damage_at(event, get, None if by_events else lost), earlier
    except KeyError as error:
        raise Refused(f"resume_from: {error}", RESUME) from None


def _damage_at(event: int, get: dict[str, np.ndarray], traceless: str | None) -> np.ndarray:
    """The damage before an event: kept at the last one and at those of a state, else found by the events that were.

    traceless: what changes without a trace in the events, if anything does.
    """
    kept = get["state_event"].tolist() if "state_event" in get else []
    if event in kept:
        return get["state_damage"][kept.index(event)].T
    if event == len(get["event_point"]):
        return get["damage_end"].T
    if traceless is not None:
        raise Refused(
            f"resume_event: the damage before event {event} was not saved and cannot be reconstructed, because of {traceless}. Saved "
            f"events: {', '.join(str(e) for e in kept)}. To save other events, name them in `states` of the earlier run",
            ("analysis", "resume_event"),
        )
    return damage_before(get["damage_start"].T, get["damage_end"].T, get["event_point"][: event - 1], get["event_code"][: event - 1])


def carry_on(curve: Curve, earlier: Earlier | None, unit: float) -> None:
    """Let the counts of a resumed curve go on, where its first event is the stored one: other loads or another sense
    begin anew."""
    events = curve.events
    if earlier is None or not len(events) or curve.sense != earlier.sense or events.point[0] != earlier.point:
        return
    if abs(events.load[0] * unit - earlier.load) > 1e-6 * abs(earlier.load):
        return
    curve.events_before = earlier.events
    for name, total in zip(LEDGER, earlier.totals, strict=True):
        shift = total - float(getattr(events, name)[0])
        getattr(events, name)[:] += shift
        if name == "crack":
            events.crack_total += shift
