"""The arch: rocking under a record against SciPy's RK45 at the same error, a failure-domain map, tilt."""

import itertools
import math
import time

import numpy as np
from timing import processor, seconds

from extrados.analyses.rocking.failure_domain import Mapper, failure_curves, settling_time, unit_pulse
from extrados.core import rocking
from extrados.limit.programme import LimitAnalysis
from extrados.model.structures.arch import make_arch
from extrados.model.structures.block import make_block
from extrados.motions.records import locate, read_record, record_motion
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.block import BlockModel


def four_bar(model: ArchModel):
    """M, M'/2, V', H at q in plain Python floats, for SciPy: closed form, differences for M'."""
    m = model.four_hinge
    a, b, c, d = (complex(*p) for p in m.hinge)
    centroid = [complex(*p) for p in m.centroid]
    bc, cd = abs(c - b), abs(d - c)
    side = 1.0 if ((d - b).conjugate() * (c - b)).imag > 0 else -1.0
    mass, inertia = m.mass.tolist(), m.inertia.tolist()

    def motion(q: float):
        turn = complex(math.cos(q), -math.sin(q))
        at_b = a + turn * (b - a)
        db = -1j * (at_b - a)
        r = d - at_b
        along = 0.5 * (bc**2 - cd**2 + abs(r) ** 2) / abs(r) ** 2
        at_c = at_b + r * complex(along, side * math.sqrt(bc**2 / abs(r) ** 2 - along**2))
        x, p = at_c - at_b, at_c - d
        w3 = (db.real * x.real + db.imag * x.imag) / (-p.imag * x.real + p.real * x.imag)
        w2 = -(db.real * p.real + db.imag * p.imag) / (-x.imag * p.real + x.real * p.imag)
        v1 = -1j * turn * (centroid[0] - a)
        v2 = db + 1j * w2 * (x / (c - b)) * (centroid[1] - b)
        v3 = 1j * w3 * (p / (c - d)) * (centroid[2] - d)
        spins = (-1.0, w2, w3)
        velocities = (v1, v2, v3)
        total = sum(k * (v.real**2 + v.imag**2) + i * w * w for k, i, v, w in zip(mass, inertia, velocities, spins, strict=True))
        gravity = GRAVITY * sum(k * v.imag for k, v in zip(mass, velocities, strict=True))
        return total, gravity, sum(k * v.real for k, v in zip(mass, velocities, strict=True))

    def coefficients(q: float):
        e = 1e-5
        total, gravity, drive = motion(q)
        return total, (motion(q + e)[0] - motion(q - e)[0]) / (4 * e), gravity, drive

    return coefficients


def scipy_run(model: ArchModel, axis: np.ndarray, values: np.ndarray, rtol: float, end: float) -> float:
    """The whole record by solve_ivp RK45 with events and an explicit rest state; the greatest rotation."""
    from scipy.integrate import solve_ivp

    coefficients = four_bar(model)
    gamma = model.collapse[0].gamma * GRAVITY
    record = values.tolist()
    step = float(axis[1])
    t, side, y, top = 0.0, 0, np.zeros(2), 0.0
    m0, _, dv0, _ = coefficients(0.0)
    rest = 1e-3 * math.sqrt(dv0 * model.limits.critical / m0)
    while t < end:
        if side == 0:
            k = int(t / step) + 1
            over = np.flatnonzero(np.abs(values[k:]) > gamma)
            if not len(over):
                break
            k += int(over[0])
            a0, a1 = values[k - 1], values[k]
            cross = (np.sign(a1) * gamma - a0) / (a1 - a0) if abs(a0) < gamma else 0.0
            t = max(t, axis[k - 1] + cross * step) + 1e-12
            side, y = -int(np.sign(a1)), np.zeros(2)

        def rhs(t, y, side=side):
            m, half_dm, dv, dh = coefficients(max(y[0], 0.0))
            j = min(int(t / step), len(record) - 2)
            a = record[j] + (t / step - j) * (record[j + 1] - record[j])
            return (y[1], -(half_dm * y[1] ** 2 + dv + side * a * dh) / m)

        def hit(t, y):
            return y[0]

        def turned(t, y):
            return y[1]

        hit.terminal, hit.direction, turned.direction = True, -1, -1
        s = solve_ivp(rhs, (t, end), y, rtol=rtol, atol=rtol * 1e-5, events=[hit, turned], max_step=step)
        top = max([top, *(float(state[0]) for state in s.y_events[1])])
        t = s.t[-1]
        if not len(s.t_events[0]):
            break
        v = model.restitution * abs(s.y_events[0][-1][1])
        side, y = (-side, np.array([0.0, v])) if v > rest else (0, np.zeros(2))
    return top


def domains(size: int = 100) -> None:
    """Failure domains with both curves and the pockets to 1e-4 g; error: the curves against a tolerance of 1e-12 at some durations."""
    arch = ArchModel(make_arch(10.0, 1.5, 157.5, 7), "thesis")
    block = BlockModel(make_block(1.0, 4.0))
    unit = 2.5 / float(block.frequency[0])
    amplitudes = np.linspace(0.0, 1.5, size + 1)[1:] * GRAVITY
    cases = {
        "arch": (arch.body, np.linspace(0.1, 1.0, size), settling_time(arch)),
        "block": (block.body, np.linspace(0.3, 3.0, size), 40.0 * unit),
    }
    for (name, (body, durations, settle)), pulse in itertools.product(cases.items(), ("step", "sine")):
        for threads in (1, 2):
            wall, cpu, found = np.inf, np.inf, None
            for _ in range(3):
                begin = time.perf_counter(), time.process_time()
                mapper = Mapper(body, pulse, durations.tolist(), settle, threads)
                found = failure_curves(mapper, durations, amplitudes, 1e-4 * GRAVITY)
                wall, cpu = min(wall, time.perf_counter() - begin[0]), min(cpu, time.process_time() - begin[1])
            print(
                f"failure domain {size} x {size} with both curves, {pulse} pulses, {name}, {threads} thread(s): {wall:.2f} s ({cpu:.2f} s of processor)"
            )
        some = slice(5, None, size // 8)
        wrong = 0
        edges = found.mode_i[some]
        for side, below in ((1.0, False), (1.0 - 1.1e-4 * GRAVITY / edges, True)):
            e = rocking.ensemble(
                [body],
                [unit_pulse(pulse, float(t)).ground for t in durations[some]],
                0 * np.arange(len(edges)),
                np.arange(len(edges)),
                np.nan_to_num(edges * side, nan=1.0),
                durations[some] * 3.0 + settle,
                tolerance=1e-12,
            )
            wrong += int(((e.outcome == 2) == below)[np.isfinite(edges)].sum())
        print(f"  of {np.isfinite(edges).sum()} edges {wrong} half sides have another outcome at a tolerance of 1e-12")


def main() -> None:
    """Print the rates."""
    motion = record_motion(read_record(locate("extrados:el-centro-1940", None)))
    axis, values = motion.series()
    model = ArchModel(make_arch(1.0, 0.144, 170.0, 34), "energy-safe")
    end = motion.end
    exact = abs(rocking.history(model.body, motion.ground, end, 1.0, tolerance=1e-12).peak)

    print("rocking arch under El Centro 1940, 31.2 s, one thread; error: peak rotation against tolerance 1e-12")
    n = 50
    index = np.zeros(n, dtype=int)
    ours = []
    for tolerance in (1e-3, 1e-5, 1e-8):

        def run(tol: float = tolerance):
            return rocking.ensemble([model.body], [motion.ground], index, index, 1.0, end, tolerance=tol, stop_when_safe=False)

        rate, used = n / seconds(run), processor(run)
        error = abs(abs(run().peak[0]) / exact - 1)
        ours.append((error, rate))
        print(f"  extrados, tolerance {tolerance:g}: {rate:9.1f} runs/s ({n / used:.0f} a second of processor)  error {error:.1e}")
    for rtol in (1e-5, 1e-8, 1e-10):
        begin = time.perf_counter()
        top = scipy_run(model, axis, values, rtol, end)
        took = time.perf_counter() - begin
        error = abs(top / exact - 1)
        no_worse = max(rate for e, rate in ours if e <= error)
        print(
            f"  SciPy RK45, rtol {rtol:g}: {1 / took:9.2f} runs/s  error {error:.1e}; "
            f"extrados at no greater error: {no_worse * took:.0f} times faster"
        )

    domains()

    arch = make_arch(10.0, 1.5, 157.5, 36)
    took = seconds(lambda: LimitAnalysis(make_arch(10.0, 1.5, 157.5, 36)).collapse(), 21)
    state, mechanism = LimitAnalysis(arch).collapse()
    from scipy.optimize import linprog

    def full() -> float:
        """The programme with 3 n equilibrium rows, assembled and solved by SciPy."""
        n, m = len(arch.mass), len(arch.a)
        a = np.zeros((3 * n, 3 * m + 1))
        b = np.zeros(3 * n)
        normal, tangent, w = arch.normal, arch.tangent, arch.mass / arch.mass.sum()
        for j in range(m):
            for block, sign in ((arch.a[j], 1.0), (arch.b[j], -1.0)):
                if block < 0:
                    continue
                c = arch.centroid[block]
                for k, (point, e) in enumerate(
                    ((arch.p[j], normal[j]), (arch.q[j], normal[j]), (0.5 * (arch.p[j] + arch.q[j]), tangent[j]))
                ):
                    r = point - c
                    a[3 * block : 3 * block + 3, 3 * j + k] += sign * np.array([*e, (r[0] * e[1] - r[1] * e[0])])
        a[0::3, -1] = w
        b[1::3] = w
        bounds = [(0, None), (0, None), (None, None)] * m + [(None, None)]
        return -linprog(np.append(np.zeros(3 * m), -1.0), A_eq=a, b_eq=b, bounds=bounds, method="highs").fun

    theirs = seconds(full, 5)
    print(
        f"tilt, 36 voussoirs: {1e3 * took:.2f} ms with assembly and mechanism, SciPy's full programme {1e3 * theirs:.2f} ms, ratio {theirs / took:.1f}"
    )
    print(f"  duality gap {abs(state.gamma - mechanism.upper_bound):.1e}, difference from SciPy {abs(state.gamma - full()):.1e}")


if __name__ == "__main__":
    main()
