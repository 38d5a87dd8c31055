"""What a strengthening needs of a deck: stones for limit analysis, places of ties, keys that are there, motions."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from extrados import kinds
from extrados.analyses.context import Context, Refused
from extrados.analyses.needs import Need
from extrados.analyses.strengthen.alternatives import change_alternatives, is_spatial, tie_alternatives
from extrados.analyses.strengthen.space import refuse_in_space
from extrados.analyses.strengthen.tables import Strengthen
from extrados.motions.from_deck import is_set
from extrados.views.building import Building

#: What limit analysis takes into account; beside a wall it pushes away from it
STATICS = ("[[ties]]", "[supports] abutting_wall")


def needs(context: Context, options: Strengthen) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    building, motion = context.building, context.deck.motion
    if options.by == "tilt":
        for what, key in building.special_keys.items():
            if what not in STATICS:
                yield partial(_refuse, f'by = "tilt" neglects {what}: use by = "fragility", or remove it', key)
        if is_spatial(building):
            if "[supports] abutting_wall" in building.special_keys:
                yield partial(
                    _refuse, "limit analysis in space neglects an abutting wall: remove `abutting_wall`", ("supports", "abutting_wall")
                )
            yield partial(refuse_in_space, context, options)
            yield lambda: building.refuse_weightless(building.solids())
            yield lambda: building.friction(building.solids())
            yield building.strands
        else:
            yield partial(_refuse_directions, options)
            yield building.blocks
            yield building.refuse_weightless
            yield building.friction
            yield building.anchored
        if options.safety_factor is not None:
            yield partial(_refuse_without_peak, context)
    else:
        yield partial(_refuse_options, options)
        yield partial(_refuse_unlimited, options)
    if kinds.load(kinds.ANALYSES[options.by].table).needs_motion or options.fragility or options.assess:
        yield partial(_refuse_still, context)
    if (options.fragility or options.by == "fragility") and motion is not None and not is_set(motion):
        yield partial(_refuse, "a fragility requires many motions: give a [motion] of kind suite, generated or compatible", ("motion",))
    if building.structure is not None or options.ties:
        yield lambda: tie_alternatives(building, options)
    yield lambda: _refuse_idle(context, options)


def _refuse(text: str, key: tuple[str | int, ...]) -> None:
    raise Refused(text, key)


def _refuse_directions(options: Strengthen) -> None:
    if options.directions:
        raise Refused("the key `directions` is only for blocks in space: for a plane section, give `direction`", ("analysis", "directions"))


def _refuse_without_peak(context: Context) -> None:
    if context.deck.motion is None or is_set(context.deck.motion):
        raise Refused(
            '`safety_factor` with by = "tilt" refers to the peak of one motion: give a single [motion], or an `acceleration`',
            ("analysis", "safety_factor"),
        )
    context.refuse_motion()


def _refuse_options(options: Strengthen) -> None:
    """Refused where the options are no table of the analysis that measures."""
    table = kinds.load(kinds.ANALYSES[options.by].table)
    wrong = [name for name in options.options if name not in table.model_fields or name == "kind"]
    if wrong:
        raise Refused(f"options: {options.by} has no key '{wrong[0]}'", ("analysis", "options"))


def _refuse_unlimited(options: Strengthen) -> None:
    """Refused where ties are sought by runs without a range of forces, or over a range of places."""
    for k, tie in enumerate(options.ties):
        if tie.beam_weight is not None:
            raise Refused('`beam_weight`, the weight of a ring beam, requires by = "tilt": remove `beam_weight`', ("analysis", "ties", k))
        if not np.isfinite(tie.greatest):
            raise Refused(
                f'by = "{options.by}" finds the force by repeated runs: give `yield_force`, the greatest force considered',
                ("analysis", "ties", k),
            )
        if tie.start_to is not None or tie.far_to is not None:
            raise Refused('a range of places requires by = "tilt": give one place, or one table for each place', ("analysis", "ties", k))


def _refuse_still(context: Context) -> None:
    if context.deck.motion is None:
        raise Refused("the deck has no [motion]", ("analysis",))
    context.refuse_motion()


def _refuse_idle(context: Context, options: Strengthen) -> None:
    """Refused where the deck names no intervention and the kind of structure suggests none."""
    building: Building = context.building
    changes = change_alternatives(context, options)
    if options.ties or options.changes:
        return
    if options.by != "tilt":
        raise Refused(f'by = "{options.by}" requires `ties` or `changes`: give the interventions to compare', ("analysis",))
    if not changes and not tie_alternatives(building, options):
        raise Refused("this structure has no default interventions: give `ties` or `changes`", ("analysis",))
