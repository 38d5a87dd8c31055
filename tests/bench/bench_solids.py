"""Blocks in space: contacts and capacity of walls and domes up to 2,000 stones, with the error beside each time.

The peer is the same push by pyramids in SciPy's HiGHS, which bounds it from below; it is asked of the small ones alone.
"""

import time

from timing import processor

from extrados.limit.solids import Falls, SolidLimit
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.structures.brickwork import Bond
from extrados.model.structures.dome import make_dome
from extrados.model.structures.wall import make_wall

FEW = 160  # stones: pyramids of more take minutes
SIDES = 8


def corner(length: float, height: float) -> SolidAssembly:
    return make_wall(Bond(0.4, 0.2), 0.2, height, [(length, True, []), (length, True, [])])


CASES = {
    "corner, 2 x 2 m": lambda: corner(2.0, 2.0),
    "dome of 12 x 12": lambda: make_dome(5.0, 0.5, 180.0, 12, 12),
    "corner, 5 x 4 m": lambda: corner(5.0, 4.0),
    "dome of 25 x 24": lambda: make_dome(5.0, 0.5, 180.0, 25, 24),
    "corner, 10 x 8 m": lambda: corner(10.0, 8.0),
}


def main() -> None:
    print("processor time of one core [s]; gap and residual certify the capacity")
    print(f"{'case':<18}{'stones':>7}{'contacts':>9}{'geometry':>9}{'one push':>9}{'gap [g]':>10}{'residual':>10}{'pyramids':>9}")
    for name, make in CASES.items():
        geometry = processor(make, runs=1)
        limit = SolidLimit(make(), 0.7)
        begin = time.process_time()
        found = limit.push(0.0)
        spent = time.process_time() - begin
        if isinstance(found, Falls):
            print(f"{name:<18} cannot stand")
            continue
        peer = ""
        if len(limit.weight) <= FEW:
            begin = time.process_time()
            low, high = limit.pyramids(0.0, SIDES)
            peer = f"{time.process_time() - begin:9.2f}  {low:.4f} <= {found.gamma:.4f} <= {high:.4f} g"
        worst = max(found.equilibrium, found.cone, found.overlap)
        print(
            f"{name:<18}{len(limit.weight):>7}{len(limit.assembly.a):>9}{geometry:>9.2f}{spent:>9.2f}{found.gap:>10.1e}{worst:>10.1e}{peer}",
            flush=True,
        )


if __name__ == "__main__":
    main()
