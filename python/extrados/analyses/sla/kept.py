"""A curve under way as arrays: what the batch layer keeps of a long event loop, every so many events."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from extrados.core import sla as core
from extrados.core.sla_parts import ONCE

ONE_PER_EVENT = [name for name in core.Events.__dataclass_fields__ if name not in ONCE]


@dataclass
class State:
    """The wall at one event: event number (0-based, of stage B), multiplier, displacements (nodes, 2) [m], and the
    report of all points, and the damage before the event's own."""

    event: int
    load: float
    displacement: np.ndarray
    report: dict[str, np.ndarray]
    damage: np.ndarray


@dataclass
class UnderWay:
    """The events so far and the states kept of them; `best` is the greatest load in equilibrium, `before_best` the
    damage from which its event can be run again, and the first event of such a run."""

    before_best: tuple[np.ndarray, int]
    parts: list[core.Events] = field(default_factory=list)
    states: list[State] = field(default_factory=list)
    best: float = -np.inf
    seconds: float = 0.0

    @property
    def done(self) -> int:
        """Events so far."""
        return sum(map(len, self.parts))

    def arrays(self, damage: np.ndarray, standing: np.ndarray) -> dict[str, np.ndarray]:
        """All of it, with the damage and where the loop stands."""
        events = core.Events.join(self.parts)
        found = {
            **{f"event_{name}": getattr(events, name) for name in ONE_PER_EVENT},
            "guard": np.array(events.guard),
            "crack_total": np.array(events.crack_total),
            "best": np.array(self.best),
            "best_damage": self.before_best[0],
            "best_first": np.array(self.before_best[1]),
            "seconds": np.array(self.seconds),
            "damage": damage,
            "standing": standing,
        }
        for k, state in enumerate(self.states):
            found[f"state_{k}"] = np.array([state.event, state.load])
            found[f"state_{k}_displacement"] = state.displacement
            found[f"state_{k}_report"] = np.stack([state.report[name] for name in core.REPORT])
            found[f"state_{k}_damage"] = state.damage
        return found

    @staticmethod
    def of(found: dict[str, np.ndarray]) -> "UnderWay":
        """From its arrays."""
        columns: dict[str, Any] = {name: found[f"event_{name}"] for name in ONE_PER_EVENT}
        checks, solutions, factors = (int(n) for n in found["guard"])
        events = core.Events(**columns, guard=(checks, solutions, factors), crack_total=float(found["crack_total"]))
        states, k = [], 0
        while f"state_{k}" in found:
            event, load = found[f"state_{k}"]
            report = dict(zip(core.REPORT, found[f"state_{k}_report"], strict=True))
            displacement, damage = found[f"state_{k}_displacement"], found[f"state_{k}_damage"]
            states.append(State(int(event), float(load), displacement, report, damage))
            k += 1
        best = (found["best_damage"], int(found["best_first"]))
        return UnderWay(best, [events], states, float(found["best"]), float(found["seconds"]))
