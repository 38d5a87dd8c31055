"""Runs of discrete elements in the plane and in space: laws, energies and outcomes computed again from their histories."""

import itertools

import numpy as np
from asking import Deck, ask, must, near
from buildings import changed, decks, number, pulses
from conservation import building
from elements import in_space
from hypothesis import reject
from hypothesis import strategies as st
from relations import GRAVITY, RIGID, ok, relation

RUNS = st.tuples(
    decks("block", "column", "brickwork", friction=number(0.15, 0.8, 13)), pulses(0.1, 1.2), st.booleans(), number(0.02, 0.6, 20)
)


@relation("dem", RUNS, 1e-6, share=1.0)
def runs_of_elements_by_hand(deck: Deck, motion: Deck, rigid: bool, limit: float, within: float) -> None:
    """Openings, slips, hinges, peaks, energies, losses, outcome and criterion of a run are those of its places and rates."""
    keys = {"end_time": 0.8, "output_step": 0.01, "collapse_displacement": limit, "floor": 0.0}
    how: Deck = {"time_step": 1e-3, **RIGID} if rigid else {}
    deck = changed(deck, joints={} if rigid else {"normal_stiffness": 2e8})
    answer = ask(changed(deck, motion=motion), "dem", **keys, **how)
    ok(answer)
    r, a = answer.results, {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    place, names = a["place"], list(a["block_name"])
    step = 0.002 if len(names) == 1 else 0.01  # impacts of a single block need a fine history
    if len(a["time"]) > 10:
        near("output step", np.diff(a["time"][:-1]).mean(), step, 0.1)
    shift = place - place[0]
    rotation = -shift[..., 2]
    near("rotation", a["rotation"], rotation, within, 1e-3)
    away, turn, drop = np.hypot(shift[..., 0], shift[..., 1]), np.abs(shift[..., 2]), -shift[..., 1]
    peak = max(away.max(), limit) if r.stopped == "collapse" else away.max()
    near("peak displacement", r.peak_displacement_m, peak, within, 1e-3)
    near("limit", r.collapse_displacement_m, limit, within)
    must(bool(r.stopped_by) == (r.stopped in ("collapse", "left")), f"{r.stopped}, stopped by {r.stopped_by}")
    must(len(set(r.stopped_by)) == len(r.stopped_by), f"stopped by {r.stopped_by}")
    for name in r.stopped_by:
        must(away[-1, names.index(name)] > 0.5 * limit, f"stopped by {name}, which moved {away[-1, names.index(name)]} m")
    for name, most in r.peak_rotation_rad.items():
        near(f"peak rotation of {name}", most, rotation[np.abs(rotation[:, names.index(name)]).argmax(), names.index(name)], within, 1e-3)
    most = np.abs(rotation).max(axis=0)
    must(
        set(r.peak_rotation_rad) >= {names[i] for i in np.argsort(-most)[:1] if most[i] > 1e-6}, f"{sorted(r.peak_rotation_rad)} of {names}"
    )
    # joints
    p, q, blocks = a["joint_p"], a["joint_q"], a["joint_block"]
    length = np.hypot(*(q - p).T)
    tangent = (q - p) / length[:, None]
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    into = [a["centroid"][i] - p[j] if i >= 0 else p[j] - a["centroid"][k] for j, (i, k) in enumerate(blocks)]
    normal *= np.sign((normal * into).sum(axis=1))[:, None]
    state = np.zeros((len(place), len(p)), int)
    slip = np.zeros(state.shape)
    for j, (i, k) in enumerate(blocks):
        ends, turned = [], []
        for body in (i, k):
            if body < 0:
                ground = np.array([p[j], q[j]])
                ends.append(np.broadcast_to(ground, (len(place), 2, 2)))
                turned.append(np.zeros(len(place)))
                continue
            angle = shift[:, body, 2]
            spin = np.stack([np.cos(angle) + 0 * angle, np.sin(angle)], axis=1)
            arm = np.array([p[j], q[j]]) - place[0, body, :2]
            moved = np.stack([spin[:, :1] * arm[:, 0] - spin[:, 1:] * arm[:, 1], spin[:, 1:] * arm[:, 0] + spin[:, :1] * arm[:, 1]], axis=2)
            ends.append(place[:, body, None, :2] + moved)
            turned.append(angle)
        apart = ends[0] - ends[1]

        def across(v: np.ndarray, turn: np.ndarray, apart: np.ndarray = apart) -> np.ndarray:
            c, s = np.cos(turn)[:, None], np.sin(turn)[:, None]
            return (apart * np.concatenate([c * v[0] - s * v[1], s * v[0] + c * v[1]], axis=1)[:, None]).sum(axis=2)

        over, under = (across(normal[j], turn) for turn in turned)
        gap = np.where(np.abs(over) < np.abs(under), over, under)  # a block that slid along either face has not left it
        along = across(tangent[j], 0.5 * (turned[0] + turned[1]))
        near(f"openings of joint {j}", [a["opening_p"][:, j], a["opening_q"][:, j]], gap.T, 1e-5, 0.1)
        slip[:, j] = np.where(gap[:, 0] < gap[:, 1], along[:, 0], along[:, 1])
        near(f"slip of joint {j}", np.abs(a["slip"][:, j]), np.abs(slip[:, j]), 1e-4, 1e-2)
        wide = np.array([a["opening_p"][:, j], a["opening_q"][:, j]]) > 5e-4 * length[j]
        off = (min(i, k) >= 0) & (np.abs(a["slip"][:, j]) > length[j])
        state[:, j] = np.where(wide.all(axis=0) | off, 2, np.where(wide[0], 1, np.where(wide[1], -1, 0)))
    must(bool((a["hinge"] == state).all()), f"hinges {np.argwhere(a['hinge'] != state)[:3].tolist()} are told otherwise")
    touching = np.where(a["hinge"] == 2, 0.0, np.abs(a["slip"]))
    near("slip", r.peak_slip_m, touching.max(), within, 1e-6)
    near("slip left", r.residual_slip_m, touching[-1].max(), within, 1e-6)
    ratio = touching.max(axis=0) / length
    near("slip ratio", r.slip_ratio, ratio.max(), within, 1e-6)
    joints = list(a["joint_name"])
    must(r.slipped_joint == (joints[int(ratio.argmax())] if ratio.max() > 0.01 else None), f"{r.slipped_joint}: {ratio}")
    # energies
    masses, inertia = masses_of_blocks(a, building(deck).blocks().depth)
    rate = a["rate"]
    kinetic = 0.5 * (rate[..., :2] ** 2).sum(axis=2) @ masses + 0.5 * rate[..., 2] ** 2 @ inertia
    near("kinetic energy", a["kinetic_energy"], kinetic, 0.03, float(kinetic.max()) + 1e-3)
    rise = shift[..., 1] @ masses * GRAVITY
    near("potential energy", a["potential_energy"] - a["potential_energy"][0], rise, 1e-6, float(np.abs(rise).max()) + 1e-2)
    near("greatest kinetic energy", r.peak_kinetic_energy_J, a["kinetic_energy"].max(), within)
    near("losses", [r.friction_loss_J, r.damping_loss_J], [a["friction_energy"][-1], a["damping_energy"][-1]], within, 1e-6)
    columns = answer.result.tables["dem"].columns
    for name, values in columns.items():
        if name.endswith("_energy"):
            near(name, values, a[name], within, 1e-6)
    sums = (
        a["work_energy"]
        - (a["kinetic_energy"] + a["potential_energy"] + a["elastic_energy"])
        - a["friction_energy"]
        - a["damping_energy"]
        - a["mass_damping_energy"]
    )
    went = np.abs(a["work_energy"]).max() + a["kinetic_energy"].max() + 10.0
    near("ledger", np.abs(sums - sums[0]), np.abs(a["residual_energy"] - a["residual_energy"][0]), 0.01, went)
    # how it ends
    size = float(np.ptp(a["outline"], axis=0).max())
    gone = (away > limit) & ((turn > 0.5 * limit / size) | (drop > 0.25 * limit))
    if gone.any() or r.stopped in ("collapse", "left"):
        must(r.outcome == "collapse" and r.collapse_criterion is not None, f"{r.outcome}, but a block has collapsed")
        when = float(a["time"][gone.any(axis=1).argmax()]) if gone.any() else r.stop_time_s
        near("time of collapse", r.collapse_time_s, when, within)
        if gone.any():
            at = int(gone.any(axis=1).argmax())
            block = int(gone[at].argmax())
            must(r.governing_block == names[block], f"{r.governing_block} of {names[block]}")
            by = "rotation" if turn[at, block] / (0.5 * limit / size) >= drop[at, block] / (0.25 * limit) else "loss of height"
            must(r.collapse_criterion == by, f"{r.collapse_criterion} of {by}")
    else:
        want = "rocked" if (a["hinge"] != 0).any() else "slid" if r.slip_ratio > 0.01 else "at-rest"
        must(r.outcome == want and r.collapse_criterion is None and r.collapse_time_s is None, f"{r.outcome}, not {want}")
        must(r.governing_block == names[int(away.max(axis=0).argmax())], f"{r.governing_block} of {away.max(axis=0)}")
        if r.stopped == "end":
            noise = 1e-6 * masses.sum() * GRAVITY * size
            moves = a["kinetic_energy"]
            last, all_ = moves[-max(1, len(moves) // 20) :].max(), moves.max()  # a swing may reverse at the very end
            must(r.still_moving == bool(last > max(1e-3 * all_, noise)), f"still moving: {r.still_moving}")
    changes = [(t, j) for j in range(len(p)) for t in range(1, len(place)) if a["hinge"][t, j] != a["hinge"][t - 1, j]]
    told = answer.result.tables["dem_hinges"].columns
    must(len(told["time"]) in (len(changes), len(changes) + len(p)), f"{len(told['time'])} changes of hinges, {len(changes)}")
    if len(names) == 1 and r.restitution_housner is not None:
        s = deck["structure"]
        near("Housner", r.restitution_housner, max(0.0, 1.0 - 1.5 * s["width"] ** 2 / (s["width"] ** 2 + s["height"] ** 2)), 1e-6)


def masses_of_blocks(a: dict[str, np.ndarray], depth: float) -> tuple[np.ndarray, np.ndarray]:
    """Masses [kg] and inertias [kg m^2] of the outlines, of density 2000 kg/m^3 and a depth, by triangles about their middles."""
    found = []
    for start, stop in itertools.pairwise(a["outline_start"].astype(int)):
        points = a["outline"][start:stop]
        centre = points.mean(axis=0)
        mass, first, second = 0.0, np.zeros(2), 0.0
        for one, two in zip(points - centre, np.roll(points, -1, axis=0) - centre, strict=True):
            piece = 0.5 * (one[0] * two[1] - one[1] * two[0]) * 2000.0 * depth
            mass, first = mass + piece, first + piece * (one + two) / 3.0
            second += piece * (one @ one + two @ two + one @ two) / 6.0
        found.append((abs(mass), abs(second) - (first @ first) / abs(mass)))
    return np.array(found).T[0], np.array(found).T[1]


@relation("dem", RUNS, 1e-6, share=1.0)
def runs_of_solids_by_hand(deck: Deck, motion: Deck, rigid: bool, limit: float, within: float) -> None:
    """For blocks in space peaks, slips, openings, energies and the outcome follow from the histories."""
    keys = {"end_time": 0.6, "output_step": 0.01, "collapse_displacement": limit, "floor": 0.0}
    how: Deck = {"time_step": 1e-3, **RIGID} if rigid else {}
    deck = changed(deck, joints={} if rigid else {"normal_stiffness": 2e8})
    if deck["structure"]["kind"] == "brickwork":
        reject()
    answer = in_space(changed(deck, motion=motion), "dem", **keys, **how)
    ok(answer)
    r, a = answer.results, {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    names = list(a["block_name"])
    shift = a["pose"][..., :3] - a["pose"][0, :, :3]
    away = np.linalg.norm(shift, axis=2)
    near("shift", a["shift"], shift, within, 1e-3)
    peak = max(away.max(), limit) if r.stopped == "collapse" else away.max()
    near("peak displacement", r.peak_displacement_m, peak, within, 1e-3)
    must(bool(r.stopped_by) == (r.stopped in ("collapse", "left")), f"{r.stopped}, stopped by {r.stopped_by}")
    must(len(set(r.stopped_by)) == len(r.stopped_by), f"stopped by {r.stopped_by}")
    for name in r.stopped_by:
        must(away[-1, names.index(name)] > 0.5 * limit, f"stopped by {name}, which moved {away[-1, names.index(name)]} m")
    near("last displacement", r.final_displacement_m, away[-1].max(), within, 1e-3)
    turned = np.linalg.norm(a["turn"], axis=2)
    for name, most in r.peak_rotation_rad.items():
        near(f"peak rotation of {name}", most, turned[:, names.index(name)].max(), 1e-5, 1e-3)
    touching = a["state"] != 2
    near("opening", r.peak_opening_m, np.where(touching, a["opening"], 0.0).max(), within, 1e-6)
    slips = np.where(touching, np.abs(a["slip"]), 0.0)
    near("slip", [r.peak_slip_m, r.residual_slip_m], [slips.max(), slips[-1].max()], within, 1e-6)
    masses = np.array([m for m in masses_of_solids(a)])
    rate = a["rate"]
    kinetic = 0.5 * (rate[..., :3] ** 2).sum(axis=2) @ masses
    must(
        bool((a["kinetic_energy"] >= kinetic * 0.97 - 0.03 * kinetic.max() - 1e-3).all()), "less kinetic energy than that of the centroids"
    )
    rise = shift[..., 2] @ masses * GRAVITY
    near("potential energy", a["potential_energy"] - a["potential_energy"][0], rise, 1e-5, np.abs(rise).max() + 1e-2)
    near("greatest kinetic energy", r.peak_kinetic_energy_J, a["kinetic_energy"].max(), within)
    near("losses", [r.friction_loss_J, r.damping_loss_J], [a["friction_energy"][-1], a["damping_energy"][-1]], within, 1e-6)
    must((r.blocks, r.contacts) == (len(names), a["state"].shape[1]), f"{r.blocks} stones, {r.contacts} contacts")
    size = float(np.ptp(a["solid_vertex"], axis=0).max())
    gone = (away > limit) & ((turned > 0.5 * limit / size) | (-shift[..., 2] > 0.25 * limit))
    if gone.any() or r.stopped in ("collapse", "left"):
        must(r.outcome == "collapse", f"{r.outcome}, but a block has collapsed")
    else:
        want = "rocked" if (a["state"] != 0).any() else "slid" if r.slip_ratio > 0.01 else "at-rest"
        must(r.outcome == want, f"{r.outcome}, not {want}")
        must(r.governing_block == names[int(away.max(axis=0).argmax())], f"{r.governing_block}")


def masses_of_solids(a: dict[str, np.ndarray]) -> list[float]:
    """Masses of the solids by their faces, density 2000 kg/m^3 [kg]."""
    found = np.zeros(len(a["block_name"]))
    for k, (start, stop) in enumerate(itertools.pairwise(a["solid_face_start"].astype(int))):
        face = a["solid_vertex"][a["solid_face"][start:stop].astype(int)]
        for one, two in itertools.pairwise(face[1:]):
            found[int(a["solid_face_block"][k])] += 2000.0 * np.linalg.det([face[0], one, two]) / 6.0
    return found.tolist()
