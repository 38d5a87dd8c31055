"""The conditions under which the results of rocking hold, checked along the motion: no sliding, and no hinge elsewhere.

Of one run with place and time; of many runs by the share of them in which a condition does not hold.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.core.ground import Ground
from extrados.core.rocking import FAILED, Ensemble, JointDemand, Response, ensemble
from extrados.model.properties import NO_SLIDING_COEFFICIENT
from extrados.results import fields
from extrados.results.rocking import Conditions, JointTime
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.rocker import Rocker
from extrados.views.rockers.soft_base import SoftBaseModel
from extrados.views.rockers.stack import StackModel
from extrados.views.rockers.watch import LOST, Watch

#: How a violated condition begins if hinges form at other joints; `code-checks` chooses by it
ELSEWHERE = "Hinges form at other joints"
#: What a member of an ensemble keeps of the demand on its joints, see `rows_of`
ROWS = ("friction", "slips", "strays")


def rows_of(joints: JointDemand, half_cycles: np.ndarray, astray: float) -> dict[str, np.ndarray]:
    """Of every run: greatest friction needed while it rocks, whether joints slide, whether hinges form elsewhere.

    half_cycles (runs); astray: see `astray_of`.
    """
    struck = (half_cycles > 1) & (astray > LOST)
    return {
        "friction": np.asarray(joints.friction, dtype=float),
        "slips": (joints.slips_at >= 0.0).astype(np.int8),
        "strays": ((joints.leaves_at >= 0.0) | struck).astype(np.int8),
    }


def astray_of(rocker: Rocker) -> float:
    """Greatest share of the kinetic energy after an impact that the mechanism of the other side does not hold."""
    return max(rocker.watch.astray) if rocker.watch is not None else 0.0


def not_checked(rocker: Rocker) -> str:
    """Why the joints are not checked, or not all; "" where they are."""
    watch = rocker.watch
    if isinstance(rocker.model, StackModel | SoftBaseModel):
        return ""
    if watch is None or not len(watch.joints):
        return "Sliding and the thrust line are not checked, because the forces at the hinges are statically indeterminate."
    if watch.unknown:
        return (
            f"Sliding and the thrust line are checked at {len(watch.joints)} of {len(watch.assembly.a)} "
            "joints only, because the forces at the other joints are statically indeterminate."
        )
    return ""


def demand_of(rocker: Rocker, ground: Ground, end_time: float, tolerance: float) -> Ensemble:
    """One run of two stacked blocks, or of a block on a compliant base, with the demand on its joints by the steps of the core."""
    one = np.zeros(1, dtype=int)
    return ensemble(
        [rocker.body],
        [ground],
        one,
        one,
        [1.0],
        end_time,
        start_rotation=rocker.start_rotation,
        tolerance=tolerance,
        stop_when_safe=False,
        threads=1,
    )


def friction_of(watch: Watch | Rocker) -> float:
    """The least coefficient of friction of its joints; of two stacked blocks and on a compliant base, which the core checks, that of
    the body."""
    if isinstance(watch, Rocker):
        return float(min(contact_friction(watch)))
    return float(watch.friction.min())


def contact_friction(rocker: Rocker) -> tuple[float, ...]:
    """Friction of the contacts of two stacked blocks, or of a compliant base, as their bodies end."""
    return tuple(rocker.body.parameters[-2:] if isinstance(rocker.model, StackModel) else rocker.body.parameters[-1:])


@dataclass(frozen=True)
class Counted:
    """How many of the runs with a result violate a condition."""

    runs: int
    sliding: int
    elsewhere: int
    friction: float

    @classmethod
    def of(cls, rows: "list[dict[str, np.ndarray]]") -> "Counted":
        """From pieces of rows: `outcome` and ROWS."""
        runs = sliding = elsewhere = 0
        friction = 0.0
        for piece in rows:
            good = piece["outcome"] != FAILED
            runs += int(good.sum())
            sliding += int(piece["slips"][good].sum())
            elsewhere += int(piece["strays"][good].sum())
            friction = max(friction, float(np.max(piece["friction"], where=good, initial=0.0)))
        return cls(runs, sliding, elsewhere, friction)


def of_many(rocker: Rocker, counted: Counted, runs: str) -> dict[str, Any]:
    """Results of the conditions over many runs; `runs` calls them, "motions"."""
    if rocker.watch is None and not isinstance(rocker.model, StackModel | SoftBaseModel):
        return {"conditions": Conditions(not_checked=not_checked(rocker), violated=[])}
    total = max(counted.runs, 1)
    given = friction_of(rocker.watch or rocker)
    return {
        "conditions": Conditions(
            friction=given if given < NO_SLIDING_COEFFICIENT else None,
            required_friction=counted.friction,
            sliding=counted.sliding,
            sliding_share=counted.sliding / total,
            hinges_elsewhere=counted.elsewhere,
            hinges_elsewhere_share=counted.elsewhere / total,
            energy_astray=astray_of(rocker),
            not_checked=not_checked(rocker),
            violated=violated(rocker, counted, runs),
        )
    }


def violated(rocker: Rocker, counted: Counted, runs: str) -> list[str]:
    """A sentence for each condition that does not hold in some of the runs."""
    watch = rocker.watch
    if watch is None:
        return _of_stack(rocker, counted, runs)
    found = []
    if counted.sliding:
        share = _share(counted.sliding, counted.runs, runs)
        given = friction_of(watch)
        if np.isinf(min(watch.capacity)) and np.isinf(counted.friction):
            found.append(f"A joint is in tension or slides {share}. Use dem.")
        else:
            reason = _rests(rocker, watch) if np.isfinite(min(watch.capacity)) else f"rocking requires up to {counted.friction:.2f}"
            found.append(f"Friction {given:.2f} is too low {share}: {reason}. Blocks slide first. Use dem, or check the friction.")
    if counted.elsewhere:
        share = _share(counted.elsewhere, counted.runs, runs)
        found.append(
            f"{ELSEWHERE} {share}: {_elsewhere(rocker)}. Use dem."
            if len(watch.joints) > 1
            else f"The whole base lifts off {share}, but rocking assumes contact with the ground. Use dem."
        )
    return found


def _of_stack(rocker: Rocker, counted: Counted, runs: str) -> list[str]:
    """The same of two stacked blocks, and on a compliant base."""
    found = []
    soft = isinstance(rocker.model, SoftBaseModel)
    if counted.sliding:
        share = _share(counted.sliding, counted.runs, runs)
        requires = f": rocking requires up to {counted.friction:.2f}" if np.isfinite(counted.friction) else ""
        found.append(
            f"Friction {friction_of(rocker):.2f} is too low {share}{requires}. Blocks slide first. Use dem, or check the friction."
            if requires or soft
            else f"A joint slides or opens over its whole length {share}. Use dem."
        )
    if counted.elsewhere:
        what = "The whole base lifts off" if soft else "A joint opens over its whole length"
        found.append(f"{what} {_share(counted.elsewhere, counted.runs, runs)}, but rocking assumes contact. Use dem.")
    return found


def slides_at_rest(rocker: Rocker, rows: "list[dict[str, np.ndarray]]", runs: str) -> list[str]:
    """A sentence where peaks of the ground slide the resting nominal building before it rocks; rows: `outcome` and `pga`."""
    watch = rocker.watch
    assert watch is not None
    limit = min(watch.capacity)
    good = [piece["outcome"] != FAILED for piece in rows]
    sliding = sum(int((piece["pga"][g] > limit * GRAVITY).sum()) for piece, g in zip(rows, good, strict=True))
    if not sliding:
        return []
    share = _share(sliding, sum(int(g.sum()) for g in good), runs)
    return [
        f"Friction {friction_of(watch):.2f} is too low {share}: {_rests(rocker, watch)}. Blocks slide first. Use dem, or check the "
        "friction."
    ]


def _rests(rocker: Rocker, watch: Watch) -> str:
    return f"the resting {rocker.word} slides from {min(watch.capacity):.3g} g upwards, and rocking starts at {rocker.uplift:.3g} g"


def told(conditions: Conditions) -> list[str]:
    """What is said of the conditions beside an answer."""
    return [*conditions.violated, *(text for text in [conditions.not_checked] if text)]


def _elsewhere(rocker: Rocker) -> str:
    astray = astray_of(rocker)
    if astray > LOST:
        return (
            f"after an impact {100.0 * astray:.0f} % of the kinetic energy does not belong to the assumed mechanism, or the "
            "thrust line passes outside a joint"
        )
    return "the thrust line passes outside a joint"


def _share(part: int, whole: int, runs: str) -> str:
    """In how many of the runs."""
    if whole == 1:
        return "under the motion"
    share = 100.0 * part / whole
    return f"in {share:.0f} % of the {runs}" if 1.0 <= share <= 99.0 or part == whole else f"in {share:.2g} % of the {runs}"


def of_one(rocker: Rocker, response: Response, handed: bool = False) -> Conditions:
    """Conditions of one run; `violated` in the order in which they fail. handed: rigid contacts go on, so that nothing is left to do."""
    watch, joints = rocker.watch, response.joints
    if watch is None or joints is None:
        return Conditions(not_checked=not_checked(rocker), violated=[])
    found: list[tuple[float, str]] = []
    use, check = ("", "") if handed else (" Use dem.", " Use dem, or check the friction.")
    given, needed, outside = friction_of(watch), float(joints.friction), float(joints.outside)
    slides = leaves = None
    if joints.slips_at >= 0.0:
        at_rest = joints.slips < 0
        slides = JointTime(joint="" if at_rest else watch.name(int(joints.slips)), time_s=float(joints.slips_at))
        if at_rest:
            text = (
                f"The resting {rocker.word} slides at {slides.time_s:.3f} s: friction {given:.2f} is exceeded at {min(watch.capacity):.3g} g, before "
                f"rocking starts at {rocker.uplift:.3g} g.{check}"
            )
        elif np.isfinite(needed):
            text = (
                f"Friction {given:.2f} is below the {needed:.2f} that rocking requires, first at {slides.joint} at "
                f"{slides.time_s:.3f} s: blocks slide.{check}"
            )
        else:
            text = f"{_upper(slides.joint)} is in tension or slides, first at {slides.time_s:.3f} s.{use}"
        found.append((slides.time_s, text))
    if joints.leaves_at >= 0.0:
        at_rest = joints.leaves < 0
        leaves = JointTime(joint="" if at_rest else watch.name(int(joints.leaves)), time_s=float(joints.leaves_at))
        far = f", by up to {100.0 * outside:.0f} % of the joint length" if np.isfinite(outside) else ", and a joint is in tension"
        if at_rest:
            text = (
                f"{ELSEWHERE} of the resting {rocker.word} at {leaves.time_s:.3f} s: with its prestressed ties another mechanism opens at "
                f"{min(watch.opening):.3g} g, before the assumed mechanism at {rocker.uplift:.3g} g.{use}"
            )
        elif len(watch.joints) > 1:
            text = f"{ELSEWHERE}: the thrust line passes outside {leaves.joint} at {leaves.time_s:.3f} s{far}.{use}"
        else:
            text = f"The whole base lifts off at {leaves.time_s:.3f} s, but rocking assumes contact with the ground.{use}"
        found.append((leaves.time_s, text))
    astray = astray_of(rocker)
    if response.half_cycles > 1 and astray > LOST:
        impacts = [t for kind, t, _ in response.events if kind == "impact"]
        found.append(
            (
                impacts[0] if impacts else response.stop_time,
                (
                    f"{ELSEWHERE}: after an impact {100.0 * astray:.0f} % of the kinetic energy does not belong to "
                    f"the assumed mechanism.{use}"
                ),
            )
        )
    return Conditions(
        friction=given if np.isfinite(given) else None,
        required_friction=needed,
        **fields.given(slides_first=slides, leaves_first=leaves),
        thrust_line_outside=outside,
        energy_astray=astray,
        not_checked=not_checked(rocker),
        violated=[text for _, text in sorted(found)],
    )


def of_pair(rocker: Rocker, joints: JointDemand, handed: bool = False) -> Conditions:
    """Conditions of one run of two stacked blocks, or of a block on a compliant base, whose demand comes from an ensemble of one; see
    `of_one`."""
    model = rocker.model
    assert isinstance(model, StackModel | SoftBaseModel)
    soft = isinstance(model, SoftBaseModel)
    names = [model.assembly.joint_names[j] for j in model.joints] if isinstance(model, StackModel) else [model.block.joint_names[0]]
    given, needed = friction_of(rocker), float(joints.friction[0])
    slips_at, leaves_at = float(joints.slips_at[0]), float(joints.leaves_at[0])
    use = "" if handed else " Use dem."
    slides = leaves = None
    found: list[tuple[float, str]] = []
    if leaves_at >= 0.0:
        leaves = JointTime(joint=names[int(joints.leaves[0])], time_s=leaves_at)
        text = (
            f"The whole base lifts off at {leaves_at:.3f} s, but rocking assumes contact with the ground.{use}"
            if soft
            else f"{_upper(leaves.joint)} opens over its whole length at {leaves_at:.3f} s, but rocking assumes contact.{use}"
        )
        found.append((leaves_at, text))
    if slips_at >= 0.0:
        first = int(joints.slips[0])
        slides = JointTime(joint=names[first], time_s=slips_at)
        found.append(
            (
                slips_at,
                f"Friction {contact_friction(rocker)[first]:.2f} is too low, first at {slides.joint} at {slips_at:.3f} s: blocks slide."
                f"{'' if handed else ' Use dem, or check the friction.'}",
            )
        )
    return Conditions(
        friction=given if given < NO_SLIDING_COEFFICIENT else None,
        required_friction=needed,
        **fields.given(slides_first=slides, leaves_first=leaves),
        not_checked="",
        violated=[text for _, text in sorted(found)],
    )


def _upper(text: str) -> str:
    return text[:1].upper() + text[1:]
