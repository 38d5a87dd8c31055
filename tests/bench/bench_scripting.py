"""A thousand arches with `tilt` and `rocking` as a script asks for them, by one and by two processes: all that its user waits for."""

import os
import resource
import subprocess
import sys
import time

COUNT = 1000
ASKED = 20.0  # [s] of the clock, on two cores
SCRIPT = f"""
import time
begin = time.perf_counter()
import numpy as np
import extrados

arch = extrados.Arch(radius=10.0, thickness=1.5, embrace=157.5, voussoirs=7)
pulse = extrados.StepPulse(amplitude="1.0 g", duration=0.2)
deck = extrados.deck(arch, [extrados.Tilt(), extrados.Rocking(end_time=6.0)], motion=pulse)
ready = time.perf_counter()
if __name__ == "__main__":
    over = {{"structure.thickness": np.linspace(1.2, 2.2, {COUNT})}}
    swept = extrados.sweep(deck, over=over, workers=WORKERS, progress=False)
    done = time.perf_counter()
    table = swept.frame()
    assert table.shape[0] == {COUNT} and (table["tilt.status"] == "ok").all() and (table["rocking.status"] == "ok").all()
    print(ready - begin, done - ready, time.perf_counter() - done)
"""


def main() -> None:
    print(
        f"{COUNT} arches, tilt and rocking, from the start of Python to a table of pandas (asked: at most {ASKED:g} seconds on two cores)"
    )
    for workers, called in ((1, "one process"), (2, "two processes")):
        wall, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
        made = subprocess.run([sys.executable, "-c", SCRIPT.replace("WORKERS", str(workers))], check=True, capture_output=True, text=True)
        wall, after = time.perf_counter() - wall, resource.getrusage(resource.RUSAGE_CHILDREN)
        spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        start, sweep, table = map(float, made.stdout.split())
        print(f"  {called}: {wall:.1f} s in all, {spent:.1f} s of processor")
        print(f"  {called}, of these: import and deck {start:.1f} s, sweep {sweep:.1f} s, table {table:.1f} s")
    if (load := os.getloadavg()[0]) > 1.5:
        print(f"  the machine was not quiet: load {load:.1f}")


if __name__ == "__main__":
    main()
