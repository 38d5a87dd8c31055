"""imperfections: random surveys of the same stones give a band on the capacity."""

from dataclasses import dataclass

import numpy as np

from extrados.analyses.batches import Job, stacked, sweep
from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.asked import deviation_of
from extrados.analyses.limit.common import answer_of, geometry_arrays, loads_of
from extrados.analyses.limit.tables import Imperfections
from extrados.analyses.needs import in_space
from extrados.limit.answer import cannot_stand
from extrados.limit.errors import CannotStand
from extrados.limit.programme import Immovable, LimitAnalysis, NoAnswer, NoEquilibrium
from extrados.model.errors import WHOLE
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.deviation import resurveyed
from extrados.results import sweeps as out
from extrados.results.limit import DILATANT
from extrados.results.model import Array, Result, TableData
from extrados.views.building import Building

BAND = (5.0, 95.0)  # percentiles that are told


@dataclass(frozen=True)
class Surveys:
    """Member k is the k-th random survey; its rows are the capacities to +x and -x [g], NaN where it cannot stand, and
    whether the programmes had an answer."""

    assembly: Assembly
    friction: float | np.ndarray | None
    strength: float | None
    options: Imperfections
    deviation: float
    building: Building

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        return stacked(self._member, first, count)

    def _member(self, k: int) -> dict[str, np.ndarray]:
        survey = resurveyed(self.assembly, self.deviation, np.random.default_rng([self.options.seed, k]))
        limit = LimitAnalysis(
            survey,
            self.friction,
            strength=self.strength,
            associated=self.options.friction_rule == "associated",
            loads=loads_of(survey, self.options, self.building),
        )
        gamma, answered, dilates = np.full(2, np.nan), True, False
        try:
            ends = [limit.collapse(sense) for sense in (1, -1)]
            found = np.array([ends[0][0].gamma, -ends[1][0].gamma])
            if (found > 0.0).all():
                gamma, dilates = found, any(limit.dilating(mechanism) for _, mechanism in ends)
            else:
                raise NoEquilibrium
        except Immovable:
            answered = False
        except NoEquilibrium:
            try:
                cannot_stand(limit)
            except (NoEquilibrium, NoAnswer):
                answered = False  # nothing proves that it cannot stand
        except NoAnswer:
            answered = False
        return {"gamma": gamma, "answered": np.array(answered), "dilates": np.array(dilates)}


def _of_section(building: Building, options: Imperfections, deviation: float) -> tuple[Job, float, dict[str, Array]]:
    """The job of a plane section, the lesser capacity of the section as given [g], and the arrays of its picture."""
    assembly = building.blocks()
    nominal = answer_of(building, options)
    job = Surveys(assembly, building.friction(), building.material.compressive_strength, options, deviation, building)
    return job, min(nominal.gamma, -nominal.back_state.gamma), geometry_arrays(assembly)


def _of_solids(building: Building, options: Imperfections, deviation: float) -> tuple[Job, float, dict[str, Array]]:
    """The same of solids; CannotStand where no programme of the given ones has a capacity."""
    from extrados.analyses.limit import solid_variation, solids  # with a solver that takes a while to load

    assembly = building.solids()
    nominal = solid_variation.capacities(building, options, assembly)
    if not nominal["answered"]:
        raise Refused("no capacity is found for the blocks of the deck: `tilt` gives the reason", WHOLE)
    given = float(nominal["gamma"].min())
    if not np.isfinite(given):
        raise CannotStand("certificate: a motion that no contact hinders and by which the weights do work; `tilt` shows it")
    return solid_variation.SolidSurveys(building, options, deviation), given, solids.scene_arrays(assembly)


def run(context: Context, options: Imperfections) -> Result:
    """Capacities of all surveys, their median and the band that holds nine tenths."""
    building = context.building
    deviation = deviation_of(building, options)
    job, given, pictured = (
        _of_solids(building, options, deviation) if in_space(building, options) else _of_section(building, options, deviation)
    )
    swept = sweep(context, "imperfections", job, options.count, "random geometries", slow=True).whole()
    gamma = swept["gamma"]
    lesser = gamma.min(axis=1)
    answered = swept["answered"].astype(bool)
    stand = np.isfinite(lesser)
    fallen = int((answered & ~stand).sum())
    if not answered.any():
        raise Refused(f"none of the {options.count} random geometries within {1e3 * deviation:.3g} mm of the survey has a result", WHOLE)
    # A survey that cannot stand carries nothing: it belongs to the lower end of the band.
    borne = np.where(stand, lesser, 0.0)[answered]
    low, median, high = np.percentile(borne, [BAND[0], 50.0, BAND[1]]).tolist()
    result = Result("imperfections")
    r = out.Imperfections(
        count=options.count,
        deviation_m=deviation,
        given_collapse_acceleration_g=given,
        median_collapse_acceleration_g=median,
        low_collapse_acceleration_g=low,
        high_collapse_acceleration_g=high,
        least_collapse_acceleration_g=float(borne.min()),
        greatest_collapse_acceleration_g=float(borne.max()),
        cannot_stand=fallen,
        without_answer=int((~answered).sum()),
        upper_bounds=int(swept["dilates"].sum()),
    )
    result.results = r
    result.arrays = {
        **pictured,
        "gamma": Array(
            gamma,
            ("survey", "sense"),
            "g",
            "capacity in both senses: first towards +x or along `direction`, second opposite; NaN if a geometry cannot stand",
        ),
    }
    senses = ("along", "opposite") if in_space(building, options) else ("to_right", "to_left")
    columns = dict(zip(senses, gamma.T, strict=True))
    result.tables = {"imperfections": TableData({"survey": list(range(1, options.count + 1)), **columns}, dict.fromkeys(columns, "g"))}
    result.answer = (
        f"The points of {options.count} random geometries lie within {1e3 * deviation:.3g} mm of the given geometry. Of these geometries, "
        f"90 % have a capacity of {low:.4f} to {high:.4f} g (median {median:.4f} g, least {borne.min():.4f} g). The capacity of the "
        f"given geometry is {given:.4f} g."
    )
    if fallen:
        result.answer += f" {fallen} of them cannot stand."
    if r.upper_bounds:
        result.answer += f" In {r.upper_bounds} geometries, joints slide; the capacity is then an {DILATANT}."
    if given < low:
        result.warnings.append(
            f"The capacity of the given geometry, {given:.4f} g, is below the range of the random geometries. In a bond, several "
            "corners can meet at one hinge, and the hinge forms at the outermost one. Random deviations of the corners move the hinge "
            "outward and raise the capacity. The verdict uses the capacity of the given geometry"
        )
    if r.without_answer:
        result.warnings.append(
            f"{r.without_answer} random geometries are not counted, because they gave no result (no solution of the linear programmes)"
        )
    return result
