"""Results of `tilt` on solid blocks; of a plane section they are those of results.limit."""

from math import inf

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.limit import LoadPath, TieForce, judge_design, judge_dilatant, judge_ductile
from extrados.results.limit import Thrust as PlaneThrust
from extrados.results.limit import Tilt as SectionTilt
from extrados.results.verdict import Demand, KindResults, Verdict, judge, judge_acceleration


class OpenContact(ResultModel):
    """A contact that opens or slides in a mechanism."""

    joint: int = fact("number of the contact")
    name: str = fact("name of the contact")
    opening: float = fact(
        "opening rate at the fastest corner of the contact, divided by the velocity of the fastest point of the mechanism"
    )
    sliding: float = fact(
        "sliding rate at the fastest corner of the contact, divided by the velocity of the fastest point of the mechanism"
    )
    x_m: float = fact("x of the middle of the contact", "m")
    y_m: float = fact("y of the middle of the contact", "m")
    z_m: float = fact("z of the middle of the contact (upwards)", "m")


class Pyramids(ResultModel):
    """Bounds by friction pyramids, from a linear programme."""

    sides: int = fact("number of sides of the pyramids")
    lower_g: float | None = fact(
        "lower bound of the collapse acceleration, with pyramids inscribed in the friction cones; null if the structure then cannot stand",
        "g",
    )
    upper_g: float | None = fact(
        "upper bound of the collapse acceleration, with pyramids circumscribed about the friction cones; null without a collapse mechanism",
        "g",
    )


class BlockSize(ResultModel):
    """The capacity of the same structure in blocks of another size or bond."""

    change: str = fact("key of the structure that is changed, with the new value")
    blocks: int | None = fact("number of blocks after this change; null if the change is not possible")
    collapse_acceleration_g: float | None = fact("upper bound of the collapse acceleration along the direction; null without a result", "g")
    relative_change: float | None = fact("relative difference of this upper bound from the upper bound with the blocks of the deck")
    reason: str | None = fact("reason why there is no value")


class SolidNonDilatant(ResultModel):
    """Collapse along one direction by sliding that does not dilate: an interval of certified states.

    A certificate proves that collapse is possible at its load, not that less is safe.
    """

    direction_deg: float = fact("direction of the load in plan", "deg")
    associated_g: float | None = fact(
        "upper bound of the collapse acceleration, with dilatant sliding; null without a collapse mechanism", "g"
    )
    load_path_g: float | None = fact("design value: lowest collapse acceleration of the certified load paths; null without one", "g")
    load_paths: list[LoadPath] = fact("load paths of elastic joints, one for each stiffness ratio")
    least_g: float | None = fact(
        "lowest collapse acceleration of a certified state, from any initial state of stress (serves as a warning); null without one", "g"
    )
    starts_g: list[float] = fact(
        "collapse acceleration of the certified state found from each starting point of the search; the lowest is used", "g"
    )
    spread_g: float | None = fact("difference between the highest and the lowest collapse acceleration in `starts_g`", "g")
    zero_gap_g: float | None = fact(
        "for the lowest state found: collapse acceleration minus (work of friction minus work of the weight), per unit of work of the load",
        "g",
    )
    equilibrium_residual: float | None = fact(
        "for the lowest state found: greatest unbalanced force on a block (or moment divided by the size), divided by the weight"
    )
    friction_residual: float | None = fact("greatest excess of shear over friction, or greatest tension, divided by the weight")
    overlap_residual: float | None = fact("greatest rate of overlap in the mechanism, divided by the rate of the fastest contact")


class SolidTilt(KindResults):
    """tilt of solids: the constant horizontal acceleration, in a direction in plan, at which they become a mechanism."""

    collapse_acceleration_g: float = fact("collapse acceleration (horizontal, constant) along the direction", "g")
    collapse_acceleration_opposite_g: float = fact("collapse acceleration (horizontal, constant) opposite to the load direction", "g")
    tilt_angle_deg: float = fact(
        "tilt of the ground with the same effect as the collapse acceleration along the load direction", "deg", source="thesis Eq. 3.1"
    )
    tilt_angle_opposite_deg: float = fact(
        "tilt of the ground with the same effect as the collapse acceleration in the opposite direction", "deg"
    )
    load_direction_deg: float = fact("direction of the load in plan, as an angle from +x towards +y", "deg")
    least_acceleration_g: float = fact("lowest collapse acceleration of all directions that were searched", "g")
    least_direction_deg: float = fact("direction of the load with the lowest collapse acceleration", "deg")
    blocks: int = fact("number of blocks")
    contacts: int = fact("number of contacts (polygons along which blocks touch)")
    moving_blocks: int = fact("number of blocks that move in the mechanism, at more than 1/1000 of the speed of the fastest block")
    fastest_block: str = fact("block whose centroid moves fastest")
    opening_contacts: list[OpenContact] = fact("contacts that open or slide; the 20 fastest are listed")
    weight_N: float = fact("weight of the structure and of the weights placed on it", "N")
    upper_bound_g: float = fact("upper bound of the collapse acceleration, from the virtual work of the mechanism", "g")
    duality_gap: float = fact("greatest difference between the lower bound (from equilibrium) and the upper bound (from a mechanism)", "g")
    equilibrium_residual: float = fact("greatest unbalanced force on a block (or moment divided by the size), divided by the weight")
    friction_residual: float = fact(
        "greatest violation at a corner of a contact (shear above friction, or tension), divided by the weight of the structure"
    )
    overlap_residual: float = fact("greatest rate of overlap in the mechanism, divided by the rate of the fastest contact")
    dilating_contacts: int = fact(
        "greatest number of contacts in compression that slide in one of the three mechanisms (along the load direction, "
        "opposite, lowest capacity). If it is not zero, the capacity is an upper bound (dilatant friction)"
    )
    collapse_acceleration_load_path_g: float = maybe(
        "design value of the collapse acceleration along the load direction, if contacts slide: the "
        "lowest of the load paths with elastic joints",
        "g",
    )
    collapse_acceleration_load_path_opposite_g: float = maybe(
        "design value of the collapse acceleration opposite to the load direction, if contacts slide: the lowest of the load paths with "
        "elastic joints",
        "g",
    )
    collapse_acceleration_non_associated_g: float = maybe(
        "collapse acceleration along the load direction for sliding without dilatancy: the lowest of the certified states that were found",
        "g",
    )
    collapse_acceleration_non_associated_opposite_g: float = maybe(
        "collapse acceleration opposite to the load direction for sliding without dilatancy", "g"
    )
    non_dilatant: list[SolidNonDilatant] = maybe(
        "sliding without dilatancy, for each direction: along the load direction, opposite, and lowest "
        'capacity; with `friction_rule` = "non-associated", for all directions'
    )
    non_associated_reason: str = maybe("reason for the missing collapse state without dilatancy, if only the upper bound is given")
    collapse_acceleration_face_law_g: float = maybe(
        "upper bound along the load direction by the face law (friction and torsion of whole faces under uniform pressure). "
        "`collapse_acceleration_g` follows the corner law, which allows the pressure to concentrate",
        "g",
        source="after Orduna and Lourenco 2005",
    )
    collapse_acceleration_face_law_opposite_g: float = maybe("upper bound opposite to the load direction by the face law", "g")
    face_law_spread_g: float = maybe(
        "scatter of the last iterations of the face law: greatest minus least value (fixed-point iteration)", "g"
    )
    face_law_reason: str = maybe("reason why the face law gives no value")
    ties: list[TieForce] = maybe("force of each tie, chain and hoop at the collapse acceleration; if bonded, of each of its segments")
    crushing_contacts: int = maybe("number of contacts that crush in the mechanism; only given with a compressive strength")
    collapse_acceleration_dry_g: float = maybe(
        'collapse acceleration along the load direction without mortar, given if `mortar` = "ductile"; 0 if the blocks then cannot stand',
        "g",
    )
    collapse_acceleration_dry_opposite_g: float = maybe("collapse acceleration opposite to the load direction without mortar", "g")
    least_acceleration_dry_g: float = maybe("lowest collapse acceleration without mortar of all directions that were searched", "g")
    block_sizes: list[BlockSize] = maybe("upper bounds with blocks of half the length in each direction, and with the other bond")
    pyramids: Pyramids = maybe("bounds of the collapse acceleration by another method and another solver")

    def judged(self, demand: Demand) -> Verdict:
        """The least capacity of all directions sought against the peak ground acceleration of the motion [g]; where contacts slide
        the least design value."""
        least = min(self.collapse_acceleration_g, self.collapse_acceleration_opposite_g, self.least_acceleration_g)
        if self.least_acceleration_dry_g is not None:
            return judge_ductile(least, self.least_acceleration_dry_g, demand)
        if not self.dilating_contacts:
            return judge_acceleration(least, demand)
        rows = self.non_dilatant or []
        designs = [row.load_path_g for row in rows if row.load_path_g is not None]
        if not rows or len(designs) < len(rows):
            associated = min([inf if row.associated_g is None else row.associated_g for row in rows], default=least)
            return judge_dilatant(associated, demand, self.non_associated_reason)
        most = min(inf if row.associated_g is None else row.associated_g for row in rows)
        found = min((row.least_g for row in rows if row.least_g is not None), default=None)
        return judge_design(min(designs), found, most, demand)


class SectionThrust(ResultModel):
    """Horizontal thrust of a section of blocks in space: the sum over its contacts."""

    name: str = fact("name of the section")
    direction: str = fact("direction of the thrust at each contact: a direction in plan, or outward from the middle of the structure")
    contacts: int = fact("contacts of the section")
    least_N: float | None = fact("minimum thrust, summed over the contacts; null if the thrust has no minimum", "N")
    central_N: float | None = fact("thrust in the most central state; null without such a state", "N")
    greatest_N: float | None = fact(
        "maximum thrust, summed over the contacts; null if the thrust has no maximum, as between rigid supports", "N"
    )


class SolidThrust(KindResults):
    """thrust of solids: admissible states of stress at a given horizontal acceleration."""

    gamma_g: float = fact("horizontal acceleration along the direction", "g")
    load_direction_deg: float = fact("direction of the load in plan, as an angle from +x towards +y", "deg")
    admissible_interval_g: list[float] = fact("accelerations along the load direction between which an admissible state exists", "g")
    sections: list[SectionThrust] = fact("thrust of each section")
    geometric_safety_factor: float | None = fact(
        "geometric safety factor: 1 divided by the smallest central part of the contacts in which an equilibrium state exists; null if "
        "this part is below 1 % (no horizontal demand), or if it was not found"
    )
    least_part_of_joints: float | None = fact(
        "smallest central part of the contacts in which an equilibrium state exists (the most central state)"
    )
    required_friction: float | None = fact("greatest coefficient of friction that the most central state needs")
    required_friction_contact: str | None = fact("contact with the greatest required friction")
    blocks: int = fact("number of blocks")
    contacts: int = fact("number of contacts (polygons along which blocks touch)")
    weight_N: float = fact("weight of the structure and of the weights placed on it", "N")
    dilating: bool = fact(
        "whether contacts slide in the mechanisms at the ends of `admissible_interval_g`. These ends are then upper bounds (dilatant "
        "friction), and an admissible state does not exclude sliding without dilatancy"
    )
    ties: list[TieForce] = maybe("forces of ties, chains and hoops in the most central state")
    duality_gap: float = fact("greatest difference between the bounds of the thrusts, divided by the weight")
    equilibrium_residual: float = fact("greatest unbalanced force on a block (or moment divided by the size), divided by the weight")
    friction_residual: float = fact(
        "greatest violation at a corner of a contact (shear above friction, or tension), divided by the weight of the structure"
    )

    def judged(self, demand: Demand) -> Verdict:
        """The part of the contacts that the most central state needs against the whole; the ratio is the safety factor."""
        part = self.least_part_of_joints
        if part is None:
            return judge("The most central equilibrium state was not found.", None, None)
        if self.geometric_safety_factor is None:
            return judge(
                f"At {self.gamma_g:g} g, the resultants of an equilibrium state pass through the middle 1 % of all contacts.", 0.0, 1.0
            )
        return judge(
            f"At {self.gamma_g:g} g, the resultants of an equilibrium state stay within the middle {100.0 * part:.3g} % of the contacts.",
            part,
            1.0,
        )


#: What `tilt` and `thrust` give: of a plane section, or of solids
Tilt = SectionTilt | SolidTilt
Thrust = PlaneThrust | SolidThrust
