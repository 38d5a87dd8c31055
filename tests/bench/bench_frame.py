"""Frames of macro-elements: the 24 pushovers of a code and a motion of 20 s, of a house of three storeys.

The farmhouse of cases/frame with a third storey and more windows. Processor time of one thread.
"""

import copy
import sys
import time
import tomllib
from pathlib import Path

import numpy as np

from extrados.analyses.frame.modes import modes_of, rest_of
from extrados.analyses.frame.pushover import MODES, pushes_of
from extrados.decks.reader import make_deck

STEP, STEPS = 0.005, 4000


def house() -> dict:
    """The deck of the house."""
    with open(Path(__file__).parents[2] / "cases" / "frame" / "farmhouse.toml", "rb") as file:
        data = tomllib.load(file)
    plan = data["structure"]
    plan["storeys"] = ["3.1 m", "2.9 m", "2.9 m"]
    for wall in plan["walls"]:
        openings = wall.setdefault("openings", [])
        if "thicknesses" in wall:
            wall["thicknesses"].append("45 cm")
        if wall["name"] == "west":
            openings += [{"storey": k, "x": [3.0, 4.0], "z": [0.9, 2.2]} for k in (1, 2)]
        openings += [{**o, "storey": 3} for o in openings if o["storey"] == 2]
        if wall["name"] == "north":
            openings += [{"storey": k, "x": [8.0, 9.0], "z": [0.9, 2.1]} for k in (1, 2, 3)]
    plan["floors"] += [{**copy.deepcopy(floor), "storey": 3} for floor in plan["floors"] if floor["storey"] == 2]
    data.pop("code")
    data["analysis"] = [{"kind": "frame-pushover", "frame": {"diagonal_strength": "45 kPa"}}]
    return data


def main() -> int:
    deck = make_deck(house())
    options = deck.analyses[0]
    frame = deck.building.frame(options.frame)
    level = len(frame.plan.storeys)
    with frame.core() as core:
        begin, states = time.process_time(), 0
        modes = modes_of(frame, rest_of(frame, core).tangent, MODES)
        pushes = pushes_of(frame, options, modes, level)
        for push in pushes:
            target = options.target_drift * float(frame.plan.levels[level])
            states += len(core.push(push.forces, push.control, target, options.steps, options.drop).control)
        spent = time.process_time() - begin
        print(f"frame of {frame.piers} piers, {frame.spandrels} spandrels: {len(pushes)} pushovers, {states} states: {spent:.2f} s")
        time_of, random = STEP * np.arange(STEPS), np.random.default_rng(1)
        ground = 2.0 * np.sin(4.0 * np.pi * time_of) * np.exp(-(((time_of - 8.0) / 4.0) ** 2)) + 0.5 * random.standard_normal(STEPS)
        begin = time.process_time()
        path = core.move(frame.unit(np.array([1.0, 0.0])), ground, STEP, (0.5, 0.001))
        spent = time.process_time() - begin
        print(f"motion of {STEP * STEPS:g} s in {len(path.drift) - 1} steps: {spent:.2f} s ({path.stop})")
    return 0


if __name__ == "__main__":
    sys.exit(main())
