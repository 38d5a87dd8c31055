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
    """Every strategy that applies to the building under the hazard of [motion], compared, with the reasons why they differ.

    The hazard is the deck's [motion]: a record, a suite, motions `compatible` with the spectrum of a code, earthquakes
    `generated` for an intensity, or a pulse.
    """

    kind: Literal["assess"]
    view: ClassVar = "blocks"
    solid: ClassVar = True
    shells: ClassVar = ("building",)
    needs_motion: ClassVar = True
    starter_motion: ClassVar = "record"
    bears: ClassVar = ("[[ties]]", "[[dampers]]", "[[hinges]]", "[supports] abutting_wall")
    starter: ClassVar = {"budget": "20"}
    budget: float = key(
        60.0,
        "time limit, in s: sizes of the costly strategies follow from counted work on one core of 2024. Steps that still run "
        "after this time are stopped and reported",
        ge=5,
        le=1e6,
    )
    strategies: list[Strategy] = key(
        list(STRATEGIES),
        "strategies that are run if they apply; `probability` is `fragility` with uncertain sizes, or with the motions of a set; `push-x` and `push-y` are `pushover`, `frame` is `frame-pushover` of a building on a plan",
        min_length=1,
        max_length=len(STRATEGIES),
    )
    thin: float = key(1.5, "a margin below this, or above its inverse, is thin: further runs follow", gt=1, le=10)
    apart: float = key(1.5, "margins that differ by more than this factor are reported as different, with the reasons", gt=1, le=10)
    acceptable_probability: float = key(
        0.05, "probability of collapse up to which `probability` says stands; above a half it says collapses", gt=0, lt=0.5
    )
    uncertain: dict[str, float] | None = key(
        None,
        "coefficients of variation for `probability`, as in `fragility`; default 0.05 of the sizes and of restitution that "
        "the kind of structure",
    )
    motions: Annotated[int, Field(ge=2, le=10000)] | None = key(
        None, "motions of a set; default the whole suite, 40 generated or 10 compatible ones"
    )
    spectrum: CodeSpectrum | None = key(
        None, "elastic spectrum for `code-checks`; default that of a `compatible` motion, without one the peak of the motion"
    )
    sensitivity: bool = key(
        False,
        "also move thickness, corners, friction, restitution and density one by one: margins of limit analysis and rocking "
        "anew, and the value at which each verdict changes; on discrete elements the stiffness of joints and a support that moves; "
        "25 % of the budget are kept for it",
    )
    vary: dict[str, Annotated[float, Field(gt=0, lt=1)]] | None = key(
        None, 'keys that are moved in place of these, with the shares by which they are: { "structure.thickness" = 0.1 }'
    )
    advise: bool = key(
        True,
        "also seek the least tie and the least thickness with which the building carries the peak of the hazard as a sustained "
        "load, if the building does not stand under all strategies",
    )
    options: dict[Strategy, dict[str, Any]] = key(
        {}, "keys of a strategy's own table, such as `dem = { joints.normal_stiffness = 2e10 }`; they go before the rules"
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
            raise ValueError("strategies: one stands twice")
        return self
