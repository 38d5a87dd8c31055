"""tilt of solids: the horizontal acceleration in any direction at which blocks in space become a mechanism."""

from collections.abc import Sequence
from math import inf

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.limit.block_size import by_block_size, in_words, warning_of
from extrados.analyses.limit.common import named_places, spoken_ties
from extrados.analyses.limit.paths import doubt
from extrados.analyses.limit.solid_loads import solid_limit, strand_arrays, strand_rows, warn_of_mortar
from extrados.analyses.limit.solid_sliding import slide
from extrados.analyses.limit.tables import Tilt
from extrados.limit.crushing import CrushingLimit
from extrados.limit.errors import CannotStand, Immovable, NoAnswer
from extrados.limit.face_law import FaceLaw
from extrados.limit.solids import Falls, Programme, SolidLimit
from extrados.model.geometry.assembly import GROUND
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.results import solids as out
from extrados.results.fields import Keys, given
from extrados.results.limit import DILATANT, DUCTILE
from extrados.results.model import Array, Result
from extrados.results.solid_files import scene_files
from extrados.schema.constants import GRAVITY

MOST_BESIDE = 80  # contacts up to which sliding without dilatancy is followed beside an upper bound: some ten seconds
FEW = 300  # stones: of more the rose is drawn on request alone
DIRECTIONS = 16
SHOWN = 0.08  # of the size: how far the fastest point goes in pictures of a mechanism
STILL = 1e-3  # of the fastest: slower stones are said to stand
SAME = 1e-7  # g: capacities that differ less are equal
MOST_CONTACTS = 20
MOST_NAMED = 4
TWISTS = 0.03  # of the capacity: a face law that takes more is told
OPEN = 1e-6  # of the fastest: less is no opening
NEGLECTED = ("cohesion", "tension")  # by the certificates of dry joints


def run(context: Context, options: Tilt) -> Result:
    """Capacity along a direction and back, the mechanism, the rose of capacities, what certifies them."""
    building = context.building
    limit = solid_limit(building, options)
    assembly = limit.assembly
    word = building.structure.word  # type: ignore[union-attr]
    first, opposite = _ends(options)
    count = options.rose or (DIRECTIONS if len(assembly.mass) <= FEW else 0)
    angles = first + 360.0 * np.arange(count) / count if count else np.array([first, opposite])
    asked = np.unique(np.round(np.concatenate([[first, opposite], angles]), 9))
    pushed = limit.pushes(asked.tolist(), context.threads, lambda done: context.progress(done, len(asked), "directions"))
    found_at = dict(zip(asked.tolist(), pushed, strict=True))
    bare = () if options.mortar == "ductile" else NEGLECTED
    there, back = (standing(found_at[round(d, 9)], assembly, bare) for d in (first, opposite))
    refuse_falling(there, back, first, bare)
    rose = [found_at[round(d, 9)] for d in angles.tolist()]
    capacity = np.array([np.inf if one is None else standing(one, assembly).gamma for one in rose])
    result = Result("tilt")
    least = int(np.flatnonzero(capacity <= capacity.min() + SAME)[0])  # of equals the first
    slides = max(dilating_contacts(limit, one) for one in (there, back, rose[least] if rose else there) if isinstance(one, Programme))
    sliding: Keys = {}
    if slides:
        sought = asked.tolist() if options.friction_rule != "associated" else [first, opposite, float(angles[least])]
        sliding, states = _without_dilatancy(context, options, limit, [round(d, 9) for d in sought], found_at, result)
        if options.friction_rule != "associated":
            there, back = (states.get(round(d, 9), one) for d, one in ((first, there), (opposite, back)))
            capacity = np.array(
                [
                    c if (one := states.get(round(d, 9))) is None else one.gamma
                    for d, c in zip(angles.tolist(), capacity.tolist(), strict=True)
                ]
            )
            least = int(np.flatnonzero(capacity <= capacity.min() + SAME)[0])
    sliding |= _beside(context, options, limit, found_at, asked.tolist(), (first, opposite), there, slides, result)
    opens = _openings(assembly, there)
    speed = np.linalg.norm(there.motion[:, :3], axis=1)
    pose = pose_of(assembly, there.motion)
    found = out.SolidTilt(
        collapse_acceleration_g=there.gamma,
        collapse_acceleration_opposite_g=back.gamma,
        tilt_angle_deg=_degrees(there.gamma),
        tilt_angle_opposite_deg=_degrees(back.gamma),
        load_direction_deg=first,
        least_acceleration_g=float(capacity[least]),
        least_direction_deg=float(angles[least]),
        blocks=len(assembly.mass),
        contacts=len(assembly.a),
        moving_blocks=len(moving_blocks(assembly, there)),
        fastest_block=assembly.block_names[int(speed.argmax())],
        opening_contacts=opens[:MOST_CONTACTS],
        weight_N=float(limit.weight.sum() + GRAVITY * assembly.fill[:, 1].sum()),
        upper_bound_g=there.upper,
        duality_gap=max(there.gap, back.gap),
        equilibrium_residual=max(there.equilibrium, back.equilibrium),
        friction_residual=max(there.cone, back.cone),
        overlap_residual=max(there.overlap, back.overlap),
        dilating_contacts=slides,
        **sliding,
        **given(
            ties=strand_rows(building, limit, there.tension) if limit.strands else None,
            pyramids=None if options.pyramids is None else _pyramids(limit, first, options.pyramids),
        ),
    )
    result.results = found
    result.arrays |= _arrays(assembly, there, pose) | {
        "rose_direction": Array(angles, ("direction",), "deg", "directions of the rose"),
        "rose_capacity": Array(capacity, ("direction",), "g", "capacity along them"),
    }
    result.arrays |= strand_arrays(limit, there.tension)
    result.files |= scene_files(assembly.parts, assembly.owner, assembly.centroid, assembly.block_names, pose)
    result.answer = _words(word, found, count)
    return result


def _beside(
    context: Context,
    options: Tilt,
    limit: SolidLimit,
    found_at: dict[float, Programme | Falls | None],
    asked: list[float],
    ends: tuple[float, float],
    there: Programme,
    slides: int,
    result: Result,
) -> Keys:
    """Keys beside the capacity: contacts that crush, friction of whole faces, other sizes of blocks, joints without mortar."""
    found: Keys = {}
    if isinstance(limit, CrushingLimit):
        found["crushing_contacts"] = _crushing(limit.assembly, there)
        if options.face_law:
            found["face_law_reason"] = "the capacity by the face law is not calculated, because that law neglects crushing"
    elif options.face_law or (options.face_law is None and slides and len(limit.assembly.a) <= MOST_BESIDE):
        found |= _by_faces(limit, [found_at[round(d, 9)] for d in ends], ends, result)
    if options.block_size and isinstance(sound := found_at[round(ends[0], 9)], Programme):
        found["block_sizes"] = sizes = by_block_size(context, options, ends[0], sound.gamma)
        if told := warning_of(sizes):
            result.warnings.append(told)
    if options.mortar == "ductile":
        found |= _dry(context, options, asked, ends)
        if told := warn_of_mortar(context.building, limit):
            result.warnings.append(told)
    return found


def refuse_falling(there: Programme, back: Programme, first: float, neglects: tuple[str, ...] = NEGLECTED) -> None:
    """CannotStand if the structure requires a horizontal load; first: direction [deg]."""
    if there.gamma < 0.0 or back.gamma < 0.0:
        low, high = sorted((there.gamma, -back.gamma))
        raise CannotStand(
            f"the structure can stand only under a horizontal load between {low:.4f} and {high:.4f} g along {first:g} "
            "degrees; certificate: the mechanism at the smaller of these loads, in which the weights do positive work",
            neglects=neglects,
        )


def _dry(context: Context, options: Tilt, directions: list[float], ends: tuple[float, float]) -> Keys:
    """Keys of the results without mortar: the capacities of dry joints, 0 where they cannot stand."""
    limit = solid_limit(context.building, options.model_copy(update={"mortar": "neglected"}))
    pushed = limit.pushes(directions, context.threads)
    gammas = [inf if one is None else 0.0 if isinstance(one, Falls) else max(one.gamma, 0.0) for one in pushed]
    along = dict(zip(directions, gammas, strict=True))
    there, back = (along[round(d, 9)] for d in ends)
    found = {"collapse_acceleration_dry_g": there, "collapse_acceleration_dry_opposite_g": back, "least_acceleration_dry_g": min(gammas)}
    return {name: None if value == inf else value for name, value in found.items()}


def _crushing(assembly: SolidAssembly, found: Programme) -> int:
    """Contacts that crush in a mechanism: those of which a corner approaches."""
    return len(np.unique(assembly.corner_joint[_corner_rates(assembly, found)[0] < -OPEN]))


def _arrays(assembly: SolidAssembly, there: Programme, pose: np.ndarray) -> dict[str, Array]:
    """Contacts with their forces at collapse, and the mechanism."""
    force, centre = _resultants(assembly, there)
    return scene_arrays(assembly) | {
        "contact_point": Array(assembly.corner, ("contact_corner", "axis3"), "m", "corners of the contact polygons"),
        "contact_of": Array(assembly.corner_joint, ("contact_corner",), "", "contact of each corner"),
        "contact_normal": Array(
            assembly.normal, ("contact", "axis3"), "", "normals of the contacts, pointing into the first block of each contact"
        ),
        "collapse_force": Array(
            there.force,
            ("contact_corner", "component"),
            "N",
            "compression (tension of mortar negative) and both shear forces at the corners at collapse",
        ),
        "contact_force": Array(force, ("contact", "axis3"), "N", "force on the first block of each contact at collapse"),
        "contact_centre": Array(centre, ("contact", "axis3"), "m", "point of application of the force: centre of the compression"),
        "velocity": Array(
            there.motion,
            ("block", "motion"),
            "m, m, m, rad, rad, rad",
            "mechanism: velocity of the centroid and angular velocity of each block",
        ),
        "mechanism_pose": Array(
            pose,
            ("block", "pose"),
            "m, m, m, rad, rad, rad",
            "mechanism at a finite displacement: translation and rotation vector of each block",
        ),
    }


def _without_dilatancy(
    context: Context,
    options: Tilt,
    limit: SolidLimit,
    directions: list[float],
    found_at: dict[float, Programme | Falls | None],
    result: Result,
) -> tuple[Keys, dict[float, Programme]]:
    """Keys of the results on sliding without dilatancy, and the least states by direction: along the push, opposite, and further
    directions [deg]."""
    contacts = len(limit.assembly.a)
    if isinstance(limit, CrushingLimit) or options.mortar == "ductile":
        return {"non_associated_reason": "with crushing, or with mortar, only the upper bound is calculated"}, {}
    if options.friction_rule == "associated" and contacts > MOST_BESIDE:
        why = (
            f"the structure has more than {MOST_BESIDE} contacts, so collapse without dilatancy is calculated only with "
            'friction_rule = "non-associated"'
        )
        return {"non_associated_reason": why}, {}
    rows, states = [], {}
    sought = list(dict.fromkeys(directions))
    for done, direction in enumerate(sought):
        context.progress(done, len(sought), "directions without dilatancy")
        associated = found_at[direction]
        if not isinstance(associated, Programme):
            continue
        row, state = slide(limit, direction, associated.gamma, options.starts, patient=options.friction_rule == "non-associated")
        rows.append(row)
        if state is not None:
            states[direction] = state
        if doubtful := doubt(row.load_paths, f"along {direction:g} degrees"):
            result.warnings.append(doubtful)
    told: Keys = {"non_dilatant": rows}
    by_direction = {row.direction_deg: row for row in rows}
    for direction, end in zip(_ends(options), ("", "_opposite"), strict=True):
        least = by_direction.get(round(direction, 9))
        if least is not None and least.load_path_g is not None:
            told[f"collapse_acceleration_load_path{end}_g"] = least.load_path_g
        if least is not None and least.least_g is not None:
            told[f"collapse_acceleration_non_associated{end}_g"] = least.least_g
    return told, states


def _by_faces(limit: SolidLimit, corners: Sequence[Programme | Falls | None], directions: Sequence[float], result: Result) -> Keys:
    """Keys of the results on the friction of whole faces; a warning where it is much less than that of corners."""
    law, spread = FaceLaw(limit), 0.0
    told: Keys = {}
    for end, direction, one in zip(("", "_opposite"), directions, corners, strict=True):
        if not isinstance(one, Programme):
            continue
        try:
            found = law.push(direction)
        except NoAnswer as error:
            told["face_law_reason"] = f"along {direction:g} degrees {error}"
            continue
        told[f"collapse_acceleration_face_law{end}_g"] = found.gamma
        spread = max(spread, found.spread)
        if found.gamma < (1.0 - TWISTS) * one.gamma:
            result.warnings.append(
                f"In the mechanism along {direction:g} degrees, contact faces twist. The upper bound is {one.gamma:.4f} "
                f"g if the pressure concentrates at corners (default), but {found.gamma:.3f} g under uniform "
                f"pressure (face law, scatter of its iteration {found.spread:.3f} g). Do not rely on the difference"
            )
    return told | {"face_law_spread_g": spread}


def _ends(options: Tilt) -> tuple[float, float]:
    """The direction of the push and the opposite one [deg]."""
    first = 0.0 if options.direction is None else options.direction
    return first, first + 180.0


def scene_arrays(assembly: SolidAssembly) -> dict[str, Array]:
    """What pictures need of the solids: vertices, faces as numbers of them one after the other, and whose they are."""
    start = np.cumsum([0, *(len(p.vertices) for p in assembly.parts)])
    faces = [np.array(f) + k for p, k in zip(assembly.parts, start[:-1].tolist(), strict=True) for f in p.faces]
    owner = np.repeat(assembly.owner, [len(p.faces) for p in assembly.parts])
    return {
        "solid_vertex": Array(np.concatenate([p.vertices for p in assembly.parts]), ("vertex", "axis3"), "m", "vertices of the solids"),
        "solid_face": Array(np.concatenate(faces), ("face_vertex",), "", "vertices of each face, counter-clockwise as seen from outside"),
        "solid_face_start": Array(
            np.cumsum([0, *map(len, faces)]),
            ("face_edge",),
            "",
            "index of the first vertex of each face; the last value is the number of all vertices",
        ),
        "solid_face_block": Array(owner, ("face",), "", "stone of each face"),
        "solid_centroid": Array(assembly.centroid, ("block", "axis3"), "m", "centroids of the blocks"),
        **named_places("block", assembly.block_names, assembly.centroid, "centroids of the blocks"),
    }


def standing(found: Programme | Falls | None, assembly: SolidAssembly, neglects: tuple[str, ...] = NEGLECTED) -> Programme:
    """The programme of blocks that stand; CannotStand with the certificate, Immovable where no load causes collapse."""
    if found is None:
        raise Immovable("no horizontal load causes collapse: the contacts restrain the blocks on all sides")
    if isinstance(found, Falls):
        name = assembly.block_names[int(np.linalg.norm(found.motion[:, :3], axis=1).argmax())]
        text = f"certificate: a mechanism, fastest at {name}, in which no contact resists and the weights do positive work"
        raise CannotStand(text, neglects=neglects)
    return found


def _pyramids(limit: SolidLimit, direction: float, sides: int) -> out.Pyramids:
    low, high = (None if not np.isfinite(g) else g for g in limit.pyramids(direction, sides))
    return out.Pyramids(sides=sides, lower_g=low, upper_g=high)


def _degrees(gamma: float) -> float:
    """Tilt of the ground at which gravity has a part along it of gamma (thesis Eq. 3.1)."""
    return float(np.degrees(np.arctan(gamma)))


def _rates(assembly: SolidAssembly, motion: np.ndarray, points: np.ndarray, block: np.ndarray) -> np.ndarray:
    """Velocities (n, 3) of points of stones, nought of those of the ground."""
    found = np.zeros((len(points), 3))
    on = block != GROUND
    arm = points[on] - assembly.centroid[block[on]]
    found[on] = motion[block[on], :3] + np.cross(motion[block[on], 3:], arm)
    return found


def _fastest(assembly: SolidAssembly, motion: np.ndarray) -> np.ndarray:
    """Speed of the fastest vertex of each stone, over that of all."""
    points = np.concatenate([p.vertices for p in assembly.parts])
    owner = np.repeat(assembly.owner, [len(p.vertices) for p in assembly.parts])
    speed = np.linalg.norm(_rates(assembly, motion, points, owner), axis=1)
    found = np.zeros(len(assembly.mass))
    np.maximum.at(found, owner, speed)
    return found / found.max()


def pose_of(assembly: SolidAssembly, motion: np.ndarray) -> np.ndarray:
    """The mechanism carried on until the fastest vertex has gone SHOWN of the size: shifts of the centroids and rotation
    vectors (nb, 6)."""
    points = np.concatenate([p.vertices for p in assembly.parts])
    owner = np.repeat(assembly.owner, [len(p.vertices) for p in assembly.parts])
    speed = np.linalg.norm(_rates(assembly, motion, points, owner), axis=1).max()
    return motion * (SHOWN * assembly.size / speed)


def moving_blocks(assembly: SolidAssembly, found: Programme) -> list[int]:
    """Blocks that move in a mechanism."""
    return np.flatnonzero(_fastest(assembly, found.motion) > STILL).tolist()


def mechanism_told(assembly: SolidAssembly, found: Programme) -> str:
    """A mechanism in words: blocks that move, the fastest, and the contacts that open most."""
    count, blocks = len(moving_blocks(assembly, found)), len(assembly.mass)
    fastest = assembly.block_names[int(np.linalg.norm(found.motion[:, :3], axis=1).argmax())]
    moving = "all blocks move" if count == blocks else f"{count} of {blocks} blocks move"
    names = [c.name for c in _openings(assembly, found)[:MOST_NAMED]]
    opens = f"; most open: {', '.join(names)}" if names else ""
    return f"{moving}, {fastest} fastest{opens}"


def _resultants(assembly: SolidAssembly, found: Programme) -> tuple[np.ndarray, np.ndarray]:
    """Force on the first stone of each contact (nj, 3) [N], and the centre of its compression (nj, 3) [m], the middle of a
    contact without any."""
    joint, count = assembly.corner_joint, len(assembly.a)
    frames = np.stack([assembly.normal, *assembly.tangents], axis=1)
    at_corner = np.einsum("vk,vkx->vx", found.force, frames[joint])
    pressure = np.maximum(found.force[:, 0], 0.0) + 1e-12 * max(float(found.force[:, 0].max()), 1e-300)
    total = np.bincount(joint, pressure, count)
    force, centre = (
        np.stack([np.bincount(joint, values[:, k], count) for k in range(3)], axis=1)
        for values in (at_corner, pressure[:, None] * assembly.corner)
    )
    if assembly.keys is not None:
        np.add.at(force, assembly.keys.joint, np.einsum("vk,vkx->vx", found.key_force, frames[assembly.keys.joint, 1:]))
    return force, centre / total[:, None]


def _corner_rates(assembly: SolidAssembly, found: Programme) -> tuple[np.ndarray, np.ndarray]:
    """Rates at which corners of contacts open and slide, over the fastest vertex."""
    joint = assembly.corner_joint
    rate = _rates(assembly, found.motion, assembly.corner, assembly.a[joint]) - _rates(
        assembly, found.motion, assembly.corner, assembly.b[joint]
    )
    opening = (rate * assembly.normal[joint]).sum(axis=1)
    sliding = np.linalg.norm(rate - opening[:, None] * assembly.normal[joint], axis=1)
    points = np.concatenate([p.vertices for p in assembly.parts])
    owner = np.repeat(assembly.owner, [len(p.vertices) for p in assembly.parts])
    fastest = np.linalg.norm(_rates(assembly, found.motion, points, owner), axis=1).max()
    return opening / fastest, sliding / fastest


def _openings(assembly: SolidAssembly, found: Programme) -> list[out.OpenContact]:
    """Contacts that open or slide, the fastest first."""
    joint = assembly.corner_joint
    most = np.zeros((2, len(assembly.a)))
    for row, values in zip(most, _corner_rates(assembly, found), strict=True):
        np.maximum.at(row, joint, values)
    order = np.argsort(-most.max(axis=0), kind="stable")
    rows = []
    for j in order[most.max(axis=0)[order] > OPEN][:MOST_CONTACTS].tolist():
        x, y, z = assembly.polygon[j].mean(axis=0)
        rows.append(out.OpenContact(joint=j, name=assembly.joint_names[j], opening=most[0, j], sliding=most[1, j], x_m=x, y_m=y, z_m=z))
    return rows


def dilating_contacts(limit: SolidLimit, found: Programme) -> int:
    """Contacts with a corner that slides in a mechanism and opens by no more than its friction times the slip: there
    associated friction dilates, and the multiplier is an upper bound."""
    assembly = limit.assembly
    joint = assembly.corner_joint
    opening, sliding = _corner_rates(assembly, found)
    with np.errstate(invalid="ignore"):
        slides = np.isfinite(limit.mu) & (sliding > OPEN) & (opening <= limit.mu * sliding + OPEN)
    return len(np.unique(joint[slides]))


def _told(r: out.SolidTilt) -> str:
    """The interval without dilatancy in words."""
    text = ""
    for row in (r.non_dilatant or [])[:MOST_NAMED]:
        design = "not certified" if row.load_path_g is None else f"{row.load_path_g:.4f} g"
        least = "none" if row.least_g is None else f"{row.least_g:.4f} g"
        most = "none" if row.associated_g is None else f"{row.associated_g:.4f} g"
        text += (
            f"Without dilatancy, along {row.direction_deg % 360.0:g} degrees in plan: the design value is {design} (the lowest of "
            f"{len(row.load_paths)} load paths with elastic joints), the lowest value found is {least}, and the upper bound is {most}. "
        )
    if r.non_associated_reason:
        text += f"Collapse without dilatancy is not given: {r.non_associated_reason}. "
    return text


def _or_none(gamma: float | None) -> str:
    return "unlimited" if gamma is None else f"{gamma:.4f} g"


def _words(word: str, r: out.SolidTilt, count: int) -> str:
    along = f"along {r.load_direction_deg:g} degrees in plan"
    text = (
        f"The {word} becomes a mechanism at a constant horizontal acceleration of {r.collapse_acceleration_g:.4f} g "
        f"{along}, or when its base is tilted by {r.tilt_angle_deg:.2f} degrees. In the opposite direction the collapse acceleration is "
        f"{r.collapse_acceleration_opposite_g:.4f} g. "
    )
    moving = "all of its blocks move" if r.moving_blocks == r.blocks else f"{r.moving_blocks} of its {r.blocks} blocks move"
    names = [c.name for c in r.opening_contacts[:MOST_NAMED]]
    opens = f"; most open: {', '.join(names)}" if names else ""
    text += f"In the mechanism {moving}, and {r.fastest_block} moves fastest{opens}. "
    if count:
        text += (
            f"The lowest collapse acceleration of {count} directions is {r.least_acceleration_g:.4f} g, along {r.least_direction_deg % 360.0:g} "
            "degrees. "
        )
    if r.dilating_contacts:
        text += f"Contacts slide, so the capacity is an {DILATANT}. " + _told(r)
    if r.crushing_contacts is not None:
        text += f"In this mechanism, {r.crushing_contacts} contacts crush at their compressive strength. "
    if r.least_acceleration_dry_g is not None:
        text += (
            f"The joints keep their cohesion and tensile strength until collapse: {DUCTILE}. Without mortar, "
            f"the collapse acceleration is {_or_none(r.collapse_acceleration_dry_g)} along {r.load_direction_deg:g} "
            f"degrees, and {_or_none(r.collapse_acceleration_dry_opposite_g)} in the opposite direction. "
        )
    text += f"The lower bound (from equilibrium) and the upper bound (from a mechanism) differ by {r.duality_gap:.1e} g."
    text += in_words(r.block_sizes) + spoken_ties(r.ties)
    if r.pyramids is not None:
        low, high = ("none" if g is None else f"{g:.4f} g" for g in (r.pyramids.lower_g, r.pyramids.upper_g))
        text += f" Friction pyramids with {r.pyramids.sides} sides give a lower bound of {low} and an upper bound of {high}."
    return text
