"""Buildings as frames of macro-elements: statics of the whole building, order of strengths, the same plan seen otherwise."""

import math
from typing import Any

import numpy as np
from asking import Answer, Deck, ask, at_most, must, near
from buildings import changed, number
from hypothesis import strategies as st
from relations import GRAVITY, ok, relation

ONE = {"directions": [0.0], "senses": ["+"], "patterns": ["uniform"], "eccentricities": [0.0]}
#: What every element keeps of its elastic stiffness carries a few per cent of the strength at the drift limits
KEPT = 0.03


@st.composite
def plans(draw: st.DrawFn) -> Deck:
    """Oblong buildings of one to three storeys with openings in all walls, in weak or strong masonry, dry or in mortar; some with
    gables under a roof, and with inner walls that cross."""
    a, b = draw(number(4.0, 9.0, 10)), draw(number(4.0, 7.0, 6))
    storeys = draw(st.lists(number(2.6, 3.4, 8), min_size=1, max_size=3))
    corners = [[0.0, 0.0], [a, 0.0], [a, b], [0.0, b]]
    walls = []
    for k, name in enumerate(("south", "east", "north", "west")):
        wall: Deck = {"name": name, "start": corners[k], "end": corners[(k + 1) % 4], "thickness": draw(number(0.3, 0.6, 6))}
        from_ = draw(number(0.8, 1.4, 6))
        if draw(st.booleans()):
            wall["openings"] = [{"storey": s + 1, "x": [from_, round(from_ + 1.0, 6)], "z": [0.8, 2.0]} for s in range(len(storeys))]
        walls.append(wall)
    young, load = draw(st.sampled_from([30e6, 3e9])), draw(st.sampled_from([1000.0, 3000.0]))
    rooms: list[list[str]] = [["south", "east", "north", "west"]]
    if draw(st.booleans()):
        x, y = round(0.6 * a, 6), round(0.5 * b, 6)
        walls += [
            {"name": "across", "start": [x, 0.0], "end": [x, b], "thickness": 0.3},
            {"name": "along", "start": [0.0, y], "end": [a, y], "thickness": 0.3},
        ]
        sides = (("south", "west"), ("south", "east"), ("north", "west"), ("north", "east"))
        rooms = [[one, "across", "along", two] for one, two in sides]
    floors: list[Deck] = [
        {"storey": k + 1, "young": young, "thickness": 0.05, "load": load, "walls": room} for k in range(len(storeys)) for room in rooms
    ]
    if draw(st.booleans()):
        pitch, roof = draw(number(20.0, 50.0, 6)), draw(st.sampled_from(["rafters", "trusses"]))
        rise = round(0.5 * b * math.tan(math.radians(pitch)), 6)
        for wall in walls:
            if wall["name"] in ("east", "west"):
                wall["gable"] = {"rise": rise}
        floors = [floor for floor in floors if floor["storey"] < len(storeys)]
        above = {"storey": len(storeys), "young": young, "thickness": 0.05, "load": load, "walls": ["south", "east", "north", "west"]}
        floors.append(above | {"pitch": pitch, "roof": roof, "bears_on": ["south", "north"]})
    return {
        "structure": {"kind": "building", "storeys": storeys, "walls": walls, "floors": floors},
        "material": {"density": 1800.0, "young": 1.5e9, "compressive_strength": draw(st.sampled_from([2.5e6, 6e6]))},
        "joints": {"cohesion": draw(st.sampled_from([0.0, 2e4, 1e5]))},
    }


def push(deck: Deck, frame: dict[str, Any] | None = None, **keys: Any) -> Answer:
    """One push of the frame, with other keys."""
    return ask(deck, "frame-pushover", **{**ONE, "frame": frame or {}, "steps": 100, **keys})


@relation("frame-pushover", st.tuples(plans(), st.sampled_from([0.0, 90.0])), share=0.5)
def pushes_of_frames_end(deck: Deck, direction: float, within: float) -> None:
    """A pushover ends by its target or by a loss of strength, not by too many steps. It ends without equilibrium only if an element has reached its drift limit, and the place is stated."""
    answer = push(deck, directions=[direction], senses=["+", "-"], eccentricities=[0.05], steps=200)
    ok(answer)
    for run in answer.results.runs:
        beyond = (
            run.stop.startswith("no equilibrium beyond the drift limit of ") and run.lost_at and run.ultimate_displacement_m is not None
        )
        must(
            beyond or run.stop in ("target displacement", "loss of strength"),
            f"{run.name}: {run.stop} at {run.control_displacement_m[-1]} m",
        )


@relation("frame-pushover", plans(), KEPT, share=0.5)
def frames_are_held_by_their_weight(deck: Deck, within: float) -> None:
    """The ground exerts no tension on a wall: the base shear times the height of the forces is at most the weight times its distance to the edge. Without cohesion
    it is at most friction times the weight."""
    mu = 0.4
    answer = push(changed(deck, joints={"cohesion": 0.0}), {"shear": "mohr-coulomb", "friction": mu})
    ok(answer)
    (run,) = answer.results.runs
    levels = np.cumsum(deck["structure"]["storeys"])
    masses = np.array(run.level_mass_kg)
    height = float(masses @ levels / masses.sum())
    walls = deck["structure"]["walls"]
    thick = max(wall["thickness"] for wall in walls)
    width = max(wall["end"][0] for wall in walls) + thick
    at_most("friction", run.peak_base_shear_N, mu * answer.results.weight_N, within)
    at_most("overturning", run.peak_base_shear_N * height, answer.results.weight_N * 0.75 * width, within)


@relation("frame-pushover", plans(), 0.02, share=0.5)
def walls_deflect_within_their_rigid_mechanism(deck: Deck, within: float) -> None:
    """A wall out of its plane carries with its deflection more than zero, and at most the load of its weakest part as a rigid body."""
    answer = push(deck, drop=0.95)
    ok(answer)
    rows = answer.results.walls_out_of_plane
    must(len(rows) == len(deck["structure"]["walls"]), f"{len(rows)} walls")
    for row in rows:
        at_most(f"wall '{row.wall}'", row.acceleration_g, max(row.rigid_acceleration_g, 0.0), within)
        must(
            row.reached and (row.acceleration_g > 0.0 or row.rigid_acceleration_g < 0.02),
            f"wall '{row.wall}': {row.acceleration_g} g, {row.deflection_m} m",
        )


@relation("frame-pushover", st.tuples(plans(), number(5.0, 85.0, 8)), 1e-4, share=0.3)
def frames_on_a_turned_plan(deck: Deck, angle: float, within: float) -> None:
    """Plan and load direction rotated together, and the walls in another order, give the same curve."""
    turn = math.radians(angle)
    made = [[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]]
    walls = [
        {**wall, **{key: np.round(np.array(wall[key]) @ made, 9).tolist() for key in ("start", "end")}}
        for wall in reversed(deck["structure"]["walls"])
    ]
    one, other = push(deck), push(changed(deck, structure={"walls": walls}), directions=[angle])
    ok(one, other)
    near("weight", one.results.weight_N, other.results.weight_N, 1e-9)
    a, b = one.results.runs[0], other.results.runs[0]
    near("stiffness", a.stiffness_N_m, b.stiffness_N_m, within)
    near("base shear", a.peak_base_shear_N, b.peak_base_shear_N, within)


@relation("frame-pushover", plans(), 1e-4, share=0.3)
def frames_in_a_mirror(deck: Deck, within: float) -> None:
    """The mirrored plan under the opposite load gives the same curve."""
    walls = []
    for wall in deck["structure"]["walls"]:
        seen = {**wall, "start": [-wall["end"][0], wall["end"][1]], "end": [-wall["start"][0], wall["start"][1]]}
        if "openings" in wall:
            length = math.dist(wall["start"], wall["end"])
            seen["openings"] = [{**o, "x": [round(length - o["x"][1], 9), round(length - o["x"][0], 9)]} for o in wall["openings"]]
        walls.append(seen)
    one, other = push(deck), push(changed(deck, structure={"walls": walls}), senses=["-"])
    ok(one, other)
    a, b = one.results.runs[0], other.results.runs[0]
    near("stiffness", a.stiffness_N_m, b.stiffness_N_m, within)
    near("base shear", a.peak_base_shear_N, b.peak_base_shear_N, 20.0 * within)  # of steps between limits


@relation("frame-pushover", st.tuples(plans(), st.sampled_from(["cohesion", "compressive_strength"])), 0.02, share=0.3)
def stronger_frames(deck: Deck, key: str, within: float) -> None:
    """More cohesion or a greater compressive strength never lowers the greatest base shear, as long as no pier reaches its drift limit."""
    table = "joints" if key == "cohesion" else "material"
    other = changed(deck, **{table: {key: 1.5 * deck[table][key] + (2e4 if table == "joints" else 0.0)}})
    ductile = {"drift_flexure": 0.1, "drift_shear": 0.1}
    weak, strong = push(deck, ductile), push(other, ductile)
    ok(weak, strong)
    at_most(f"base shear with more {key}", weak.results.base_shear_N, strong.results.base_shear_N, within)


@relation("frame-pushover", plans(), 0.02, share=0.3)
def halved_steps_of_frames(deck: Deck, within: float) -> None:
    """Twice as many steps give the same greatest base shear and the same ultimate displacement."""
    one, other = push(deck), push(deck, steps=200)
    ok(one, other)
    near("base shear", one.results.base_shear_N, other.results.base_shear_N, within)
    if one.results.ultimate_displacement_m and other.results.ultimate_displacement_m:
        near("ultimate displacement", one.results.ultimate_displacement_m, other.results.ultimate_displacement_m, within)


@relation("frame-modes frame-pushover", plans(), 1e-6, share=0.3)
def weights_and_periods_of_frames(deck: Deck, within: float) -> None:
    """The weight by hand from the plan; with four times the stiffness of masonry and floors the periods are halved."""
    structure = deck["structure"]
    volume = 0.0
    for wall in structure["walls"]:
        area = math.dist(wall["start"], wall["end"]) * sum(structure["storeys"])
        area -= sum((o["x"][1] - o["x"][0]) * (o["z"][1] - o["z"][0]) for o in wall.get("openings", ()))
        area += 0.5 * math.dist(wall["start"], wall["end"]) * wall.get("gable", {}).get("rise", 0.0)
        volume += area * wall["thickness"]
    walls = structure["walls"]
    plan, floors = walls[0]["end"][0] * walls[1]["end"][1], 0.0
    for storey in range(1, len(structure["storeys"]) + 1):  # the load is the same in all rooms
        floor = next(floor for floor in structure["floors"] if floor["storey"] == storey)
        floors += plan * floor["load"] / math.cos(math.radians(floor.get("pitch", 0.0)))
    stiff = changed(deck, material={"young": 4.0 * deck["material"]["young"]})
    stiff["structure"]["floors"] = [{**floor, "young": 4.0 * floor["young"]} for floor in structure["floors"]]
    pushed, soft, hard = push(deck), ask(deck, "frame-modes"), ask(stiff, "frame-modes")
    ok(pushed, soft, hard)
    near("weight", pushed.results.weight_N, volume * deck["material"]["density"] * GRAVITY + floors, within)
    near("periods", *(factor * np.array([m.period_s for m in one.results.modes]) for factor, one in ((1.0, soft), (2.0, hard))), 0.01)


@relation("frame-pushover", plans(), 0.01, share=0.3)
def openings_through_storeys(deck: Deck, within: float) -> None:
    """An opening through two storeys has the curve of two openings that a millimetre of masonry divides."""
    storeys, wall = deck["structure"]["storeys"], deck["structure"]["walls"][0]
    if len(storeys) == 1:
        return
    x, tall = [1.5, 2.5], storeys[0]
    through = [{"storey": 1, "x": x, "z": [0.8, round(tall + 1.9, 9)], "through": True}]
    divided = [{"storey": 1, "x": x, "z": [0.8, round(tall - 1e-3, 9)]}, {"storey": 2, "x": x, "z": [0.0, 1.9]}]
    walls = deck["structure"]["walls"][1:]
    one, other = (push(changed(deck, structure={"walls": [{**wall, "openings": openings}, *walls]})) for openings in (through, divided))
    ok(one, other)
    near("weight", one.results.weight_N, other.results.weight_N, 1e-3)
    a, b = one.results.runs[0], other.results.runs[0]
    near("stiffness", a.stiffness_N_m, b.stiffness_N_m, within)
    near("base shear", a.peak_base_shear_N, b.peak_base_shear_N, within)


@relation("local-mechanism", st.tuples(number(2.0, 8.0, 9), number(0.8, 4.0, 9), number(0.2, 0.6, 9), number(2.0, 8.0, 6)), 1e-9)
def gables_of_plans(length: float, rise: float, thickness: float, strength: float, within: float) -> None:
    """The gable of a wall on a plan is the gable that is given by its size."""
    wall = {"name": "end", "start": [0.0, 0.0], "end": [0.0, length], "thickness": thickness, "gable": {"rise": rise}}
    plan = {
        "structure": {"kind": "building", "storeys": [3.0], "walls": [wall]},
        "material": {"density": 1800.0, "compressive_strength": 1e6 * strength},
    }
    alone = {**plan, "structure": {"kind": "block", "width": 1.0, "height": 2.0}}
    here = ask(plan, "local-mechanism", mechanism="building")
    there = ask(alone, "local-mechanism", mechanism="gable", width=length, height=rise, thickness=thickness)
    ok(here, there)
    (gable,) = (row for row in here.results.walls if row.gable)
    near("multiplier", gable.multiplier, there.results.multiplier, within)
    near("activation", gable.activation_acceleration_g, there.results.activation_acceleration_g, within)
