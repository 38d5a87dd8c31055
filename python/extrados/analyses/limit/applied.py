"""Where the loads of a deck act, and whose thrust it asks for: names and places on the stones."""

import itertools

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.limit.tables import AppliedLoad
from extrados.model.errors import WHOLE, BadGeometry
from extrados.model.geometry.anchors import stones_at
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.strands import solid_at


def chain_of(assembly: Assembly, name: str | None) -> str | None:
    """The chain of a name, the first where none is given, None where the assembly has no chain."""
    if name is not None and name not in assembly.chains:
        known = f"the names are {', '.join(assembly.chains)}" if assembly.chains else "no blocks form an arch or column here"
        raise Refused(f"chain: '{name}' does not exist; {known}", ("analysis", "chain"))
    return name or next(iter(assembly.chains), None)


def block_under(assembly: Assembly, x: float) -> tuple[int, float]:
    """The block with the highest surface at x, and that height [m]."""
    best, height = -1, -np.inf
    for i, outline in enumerate(assembly.outlines):
        x0, y0 = outline.T
        x1, y1 = np.roll(x0, -1), np.roll(y0, -1)
        met = (np.minimum(x0, x1) <= x) & (x <= np.maximum(x0, x1)) & (x0 != x1)
        if met.any():
            top = float((y0[met] + (x - x0[met]) / (x1[met] - x0[met]) * (y1[met] - y0[met])).max())
            if top > height:
                best, height = i, top
    if best < 0:
        low = min(float(o[:, 0].min()) for o in assembly.outlines)
        high = max(float(o[:, 0].max()) for o in assembly.outlines)
        raise Refused(f"the load at x = {x:.4g} m lies outside the structure, which extends from {low:.4g} to {high:.4g} m", WHOLE)
    return best, height


def _block_at(assembly: Assembly, x: float, y: float) -> int:
    """The block that holds a point, or has it on its face."""
    if found := stones_at(assembly, np.array([x, y])):
        return found[0]
    raise Refused(f"the load at x = {x:.4g}, y = {y:.4g} m acts on no block: give a point in or on a block", WHOLE)


def pieces(assembly: Assembly, load: AppliedLoad, number: int) -> list[tuple[int, np.ndarray, float]]:
    """Blocks, points and shares of a load: one, or of a spread load a piece for each block it rests on.

    A spread load is cut where the outlines below have their vertices; on each piece it acts at the middle. number: of
    the load in the deck, for a refusal.
    """

    def place(x: float) -> tuple[int, float]:
        try:
            return block_under(assembly, x) if load.y is None else (_block_at(assembly, x, load.y), load.y)
        except Refused as error:
            raise Refused(str(error), ("analysis", "load", number)) from None

    if load.x_end is None:
        block, y = place(load.x)
        return [(block, np.array([load.x, y]), 1.0)]
    vertices = np.concatenate(assembly.outlines)[:, 0]
    cuts = np.unique(np.concatenate([[load.x, load.x_end], vertices[(vertices > load.x) & (vertices < load.x_end)]]))
    cuts = cuts[np.append(True, np.diff(cuts) > 1e-9 * assembly.size)]
    cuts[-1] = load.x_end
    found = []
    for left, right in itertools.pairwise(cuts.tolist()):
        x = 0.5 * (left + right)
        block, y = place(x)
        found.append((block, np.array([x, y]), (right - left) / (load.x_end - load.x)))
    return found


def place_of(assembly: SolidAssembly, load: AppliedLoad, number: int) -> tuple[int, np.ndarray]:
    """Block and point (3) [m] of a load: at its height, or on the highest surface below."""
    key = ("analysis", "load", number)
    if load.x_end is not None or load.y is None:
        raise Refused(
            "a load on blocks in space acts at a point: give `x` and `y` in plan. If the load does not act on the top, also give `z`", key
        )
    if load.z is not None:
        point = np.array([load.x, load.y, load.z])
        try:
            return solid_at(assembly, point, None, f"load {number + 1}", key, "z", ("Move the load", "move the load to one of them")), point
        except BadGeometry as error:
            raise Refused(str(error), key) from None
    best, top = -1, -np.inf
    for part, block in zip(assembly.parts, assembly.owner.tolist(), strict=True):
        first = part.vertices[[face[0] for face in part.faces]]
        away = ((np.array([load.x, load.y, 0.0]) - first) * part.normals).sum(axis=1)
        up = part.normals[:, 2]
        above, below = up > 1e-9, up < -1e-9
        if (away[~above & ~below] > 1e-9 * assembly.size).any():
            continue
        high, low = (-away[above] / up[above]).min(), (-away[below] / up[below]).max()
        if high >= low and high > top:
            best, top = block, float(high)
    if best < 0:
        raise Refused(f"the load at x = {load.x:.4g}, y = {load.y:.4g} m meets no block in plan: move the load", key)
    return best, np.array([load.x, load.y, top])
