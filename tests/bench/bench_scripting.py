"""A sweep of arches with `tilt` and `rocking` from Python, by one and by two processes."""

import resource
import time

import numpy as np

import extrados

COUNT = 1000
ARCH = extrados.Arch(radius=10.0, thickness=1.5, embrace=157.5, voussoirs=7)
PULSE = extrados.StepPulse(amplitude="1.0 g", duration=0.2)
DECK = extrados.deck(ARCH, [extrados.Tilt(), extrados.Rocking(end_time=6.0)], motion=PULSE)


def processor() -> float:
    """Processor time of this process and those that it has waited for [s]."""
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)


def main() -> None:
    print(f"extrados.sweep: {COUNT} arches, tilt and rocking (asked: 20 s on two cores)")
    for workers in (1, 2):
        wall, spent = time.perf_counter(), processor()
        over = {"structure.thickness": np.linspace(1.2, 2.2, COUNT)}
        extrados.sweep(DECK, over=over, workers=workers, progress=False)
        print(
            f"  {workers} process(es): {processor() - spent:.1f} s of processor, start included; "
            f"{time.perf_counter() - wall:.1f} s of the clock"
        )


if __name__ == "__main__":
    main()
