"""Analysis kind of the whole: assess."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from extrados.analyses.table import Analysis
from extrados.schema.spectrum import CodeSpectrum
from extrados.schema.table import key

#: Strategies in the order in which they are asked: cheap first
STRATEGIES = ("tilt", "rocking", "assessment", "code-checks", "probability", "sla", "push-x", "push-y", "frame", "dem")
Strategy = Literal["tilt", "rocking", "assessment", "code-checks", "probability", "sla", "push-x", "push-y", "frame", "dem"]


#: Share of the budget that is kept for the sensitivity if the deck requests it
KEPT = 0.25


class Assess(Analysis):
    """Assessment of the building by every strategy that applies, and the reasons why their results differ.

    The hazard is the [motion] of the deck: a record, a suite, motions `compatible` with the spectrum of a code, earthquakes `generated`
    for an intensity, or a pulse.
    """

    kind: Literal["assess"]
    view: ClassVar = "blocks"
    solid: ClassVar = True
    shells: ClassVar = ("building",)
    needs_motion: ClassVar = True
    starter_motion: ClassVar = "record"
    considers: ClassVar = ("[[ties]]", "[[dampers]]", "[[hinges]]", "[supports] abutting_wall")
    starter: ClassVar = {"budget": "20"}
    budget: float = key(
        60.0,
        "time limit in s. The program chooses the sizes of the expensive strategies so that their estimated time (one core of a "
        "computer of 2024) fits into this limit. Steps that exceed the limit are stopped and reported",
        ge=5,
        le=1e6,
    )
    strategies: list[Strategy] = key(
        list(STRATEGIES),
        "strategies that are run if they apply. `probability`: `fragility` with uncertain sizes, or with the motions of a set; "
        "`push-x`, `push-y`: `pushover` in x or y; `frame`: `frame-pushover` of a building in plan",
        min_length=1,
        max_length=len(STRATEGIES),
    )
    thin: float = key(
        1.5,
        "limit of the range from 1/`thin` to `thin`: a critical scale factor in this range counts as close to 1 and causes additional runs",
        gt=1,
        le=10,
    )
    apart: float = key(1.5, "least ratio of two critical scale factors that is reported as a difference, with the reasons", gt=1, le=10)
    acceptable_probability: float = key(
        0.05,
        'probability of collapse up to which `probability` gives the verdict "stands"; above 0.5 the verdict is "collapses"',
        gt=0,
        lt=0.5,
    )
    uncertain: dict[str, float] | None = key(
        None,
        "coefficients of variation for `probability`, as in `fragility`; default: 0.05 for restitution and for the sizes of the structure",
    )
    motions: Annotated[int, Field(ge=2, le=10000)] | None = key(
        None, "number of motions of a set; default: the whole suite, 40 generated motions or 10 compatible motions"
    )
    spectrum: CodeSpectrum | None = key(
        None,
        "elastic spectrum for `code-checks`; default: the spectrum of a `compatible` motion; for other motions, the peak acceleration "
        "of the motion",
    )
    sensitivity: bool = key(
        False,
        "also vary thickness, corners, friction, restitution and density one by one. Limit analysis and rocking give the safety factor "
        "for each value, and the value at which their verdict changes. Discrete elements vary the joint stiffness and move a support. "
        "This takes 25 % of the time budget",
    )
    vary: dict[str, Annotated[float, Field(gt=0, lt=1)]] | None = key(
        None, 'keys that are varied instead of the default keys, each with its relative change: { "structure.thickness" = 0.1 }'
    )
    advise: bool = key(
        True,
        "also find the least tie force and the least thickness with which the building carries the peak acceleration of the hazard as "
        'a sustained load. Only if at least one strategy does not give the verdict "stands"',
    )
    options: dict[Strategy, dict[str, Any]] = key(
        {},
        "keys for the analysis of a strategy, such as `dem = { joints.normal_stiffness = 2e10 }`; they "
        "replace the values that the program would choose",
    )

    @property
    def moves(self) -> bool:
        """Whether values are moved one by one."""
        return bool(self.sensitivity or self.vary)

    @property
    def for_strategies(self) -> float:
        """Seconds of the budget for strategies and further runs; the rest is for the sensitivity."""
        return self.budget * (1.0 - KEPT if self.moves else 1.0)

    @model_validator(mode="after")
    def _once(self) -> "Assess":
        if len(set(self.strategies)) < len(self.strategies):
            raise ValueError("the list `strategies` contains a strategy twice: remove one")
        return self
