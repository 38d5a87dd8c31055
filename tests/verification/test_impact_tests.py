"""Impact rules of the arch beside chapter 5 of the dissertation: Table 5.3, Eq. 5.5, Fig. 5-15 and the harmonic tests.

The measured points stand in figures that are not available; what the text says of the tests is measured all the same:
at 8 and 10 Hz Arch1 never failed by rocking, at 6 Hz it bore clearly more than a single sine, at 2 and 4 Hz about as much.
The tables of docs/theory.md, "Impact rules beside the tests of chapter 5", are printed here.
"""

import numpy as np
import pytest

import extrados
from extrados.analyses.rocking import criterion
from extrados.model.structures.arch import make_arch
from extrados.views.rockers.arch import ArchModel

RULES = criterion.RULES
#: Table 5.3 as printed, C1, C2, T_min by t/R and embrace; the cell of .12 and 180 degrees is blank
PRINTED = {
    0.12: ((0.040, -0.69, 0.20), (0.030, -0.80, 0.17), (0.018, -0.92, 0.14), (0.008, -1.20, 0.11), None),
    0.15: ((0.061, -0.54, 0.28), (0.048, -0.59, 0.26), (0.032, -0.76, 0.21), (0.018, -1.00, 0.16), (0.008, -1.31, 0.11)),
    0.18: ((0.082, -0.41, 0.39), (0.063, -0.51, 0.33), (0.050, -0.57, 0.30), (0.032, -0.79, 0.23), (0.018, -1.04, 0.17)),
    0.21: ((0.101, -0.41, 0.48), (0.080, -0.42, 0.41), (0.063, -0.50, 0.35), (0.047, -0.64, 0.28), (0.028, -0.89, 0.22)),
}
ARCHES = {"Arch1": (162.0, 16, (0.00252, -1.51, 0.044, 0.20)), "Arch2": (152.0, 15, (0.00674, -1.18, 0.060, 0.31))}
PERIODS = np.array([0.08, 0.10, 0.12, 0.15, 0.20, 0.30, 0.40])
FREQUENCIES = (2.0, 4.0, 6.0, 8.0, 10.0)
PEAK, LENGTH = 1.6, 60.0  # of the growing harmonic motion [g], [s]


def shift(ours: criterion.Fit, theirs: criterion.Fit) -> float:
    """Failing period over that of the print, mean over amplitudes of 1.2 to 2 gamma."""
    above = np.linspace(0.2, 1.0, 30) * ours.gamma
    periods = [f.t_min + (above / f.c1) ** (1.0 / f.c2) for f in (ours, theirs)]
    return float(np.exp(np.log(periods[0] / periods[1]).mean()))


@pytest.mark.verify
def test_table_5_3_by_each_rule() -> None:
    """The print is of the thesis' rule; the blow at all joints is within 11 % of it, the projection is not."""
    rms = {}
    for rule in RULES:
        rows = criterion.regenerate(rule, threads=2, say=lambda text: None)
        ratios = []
        for row in rows:
            cell = PRINTED[row["thickness_ratio"]][criterion.EMBRACES.index(row["embrace_deg"])]
            fit = criterion.Fit(row["c1"], row["c2"], row["t_min_s"], row["gamma"])
            ratios.append(np.nan if cell is None else shift(fit, criterion.Fit(*cell, row["gamma"])))
        table = np.array(ratios).reshape(len(PRINTED), -1)
        rms[rule] = float(np.sqrt(np.nanmean(np.log(table) ** 2)))
        print(f"{rule}: failing period over the printed one, root mean square {rms[rule]:.3f}")
        for ratio, line in zip(PRINTED, table, strict=True):
            print(f"  t/R {ratio:.2f}  " + "  ".join(f"{x:5.2f}" for x in line))
    assert rms["thesis"] < 0.03 < rms["inelastic"] < 0.06
    assert rms["energy-safe"] > 0.15


@pytest.mark.verify
def test_one_cell_of_table_5_3_by_each_rule() -> None:
    """t/R .15, 180 degrees, where the rules differ most: thesis 0.98 of the printed period, then 1.11 and 1.54."""
    found = {}
    for rule in RULES:
        fit, _, _ = criterion.fit_arch(ArchModel(make_arch(1.0, 0.15, 180.0, 36), rule), threads=2)
        found[rule] = shift(fit, criterion.Fit(*PRINTED[0.15][4], fit.gamma))
    assert found == {
        "thesis": pytest.approx(0.98, abs=0.02),
        "inelastic": pytest.approx(1.11, abs=0.02),
        "energy-safe": pytest.approx(1.54, abs=0.04),
    }


@pytest.mark.parametrize("name", ARCHES)
def test_single_sines_by_each_rule(name: str) -> None:
    """Failing amplitudes over Eq. 5.5: from 0.2 s on no rule is farther than 14 % away; below 0.1 s only the thesis' is near."""
    embrace, voussoirs, printed = ARCHES[name]
    wanted = criterion.Fit(*printed).amplitude(PERIODS)
    found = {}
    for rule in RULES:
        model = ArchModel(make_arch(0.2, 0.024, embrace, voussoirs), rule)
        own = criterion.mode_i_curve(model.body, model.collapse[0].gamma, 0.2, PERIODS, cap=5.0, threads=2)
        found[rule] = own / wanted
        print(f"{name} {rule}: " + "  ".join(f"{x:5.2f}" for x in found[rule]))
        assert np.abs(found[rule][PERIODS >= 0.2] - 1.0).max() < 0.14
    short = PERIODS <= 0.1
    assert np.abs(found["thesis"][short] - 1.0).max() < 0.08
    assert np.nanmin(found["inelastic"][short]) > 1.25 and np.isnan(found["energy-safe"][short]).all()


def test_fig_5_15_by_each_rule() -> None:
    """Failing amplitude [g] of single sines on the arch of t/R .144 and 170 degrees, R 1 m; R 5 m has the same at sqrt(5) T."""
    periods = np.array([0.3, 0.5, 0.8])
    found = {}
    for rule in RULES:
        model = ArchModel(make_arch(1.0, 0.144, 170.0, 34), rule)
        found[rule] = criterion.mode_i_curve(model.body, model.collapse[0].gamma, 1.0, periods, cap=8.0, threads=2)
        print(f"{rule}: " + "  ".join(f"{x:.3f}" for x in found[rule]))
        large = ArchModel(make_arch(5.0, 0.72, 170.0, 34), rule)
        same = criterion.mode_i_curve(large.body, large.collapse[0].gamma, 5.0, np.sqrt(5.0) * periods, cap=8.0, threads=2)
        assert same == pytest.approx(found[rule], rel=2e-3)
    assert (found["thesis"] < found["inelastic"]).all() and (found["inelastic"] < found["energy-safe"]).all()


def reached(time: float) -> float:
    """Amplitude [g] of the growing harmonic motion."""
    return PEAK * float(np.sin(np.pi * time / LENGTH))


def growing(frequency: float) -> dict:
    """A deck of Arch1 under the growing harmonic motion, without analysis."""
    arch = {"radius": 0.2, "thickness": 0.03, "thickness_factor": 0.8, "embrace": 162.0, "voussoirs": 16}
    motion = {"amplitude": f"{PEAK} g", "frequency": frequency, "carrier": 0.5 / LENGTH, "duration": LENGTH}
    return {"structure": {"kind": "arch", **arch}, "motion": {"kind": "harmonic", **motion}}


def amplitude_at_collapse(rule: str, frequency: float) -> float:
    """Amplitude [g] that the motion has reached when Arch1 falls by an impact rule; NaN where it stays up."""
    analysis = {"kind": "rocking", "output_step": 0.02, "hand_over": False}
    run = extrados.run({**growing(frequency), "joints": {"restitution": rule}, "analysis": [analysis]}, threads=2)
    time = run["rocking"].collapse_time_s
    return np.nan if time is None else reached(time)


@pytest.mark.verify
def test_harmonic_tests_of_arch_1_in_discrete_elements() -> None:
    """As one sine at 2 and 4 Hz, more at 6 Hz as measured; the impacts of fixed hinges lose too much from there on."""
    joints = {"friction": 2.0, "normal_stiffness": 1e10}
    analysis = {"kind": "dem", "end_time": LENGTH, "output_step": 0.02}
    found = []
    for frequency in FREQUENCIES:
        run = extrados.run({**growing(frequency), "joints": joints, "analysis": [analysis]}, threads=2)
        assert run["dem"].outcome == "collapse"
        found.append(reached(float(run.array("dem", "time")[-1])))
    print(f"elements: {np.round(found, 2)} g")
    assert found[:2] == pytest.approx([0.27, 0.28], abs=0.02)
    # chaotic from 6 Hz on: peaks that differ by 1e-5 give .35 to .49, .61 to .70 and .77 to .97 g
    assert 0.3 < found[2] < 0.55 < found[3] < 0.75 < found[4] < 1.1


@pytest.mark.verify
def test_harmonic_tests_of_arch_1_by_each_rule() -> None:
    """Impacts that lose energy give what was measured; the thesis' balance lets the arch fall at 6 Hz as by one sine."""
    found = {}
    for rule in RULES:
        found[rule] = np.array([amplitude_at_collapse(rule, f) for f in FREQUENCIES])
        model = ArchModel(make_arch(0.2, 0.024, 162.0, 16), rule)
        single = criterion.mode_i_curve(model.body, model.collapse[0].gamma, 0.2, 1.0 / np.array(FREQUENCIES), cap=8.0, threads=2)
        print(f"{rule}: growing {np.round(found[rule], 2)} g, single sine {np.round(single, 2)} g")
        # 2 and 4 Hz: about the single sine
        assert np.abs(found[rule][:2] / single[:2] - 1.0).max() < 0.35
        if rule != "thesis":
            assert found[rule][2] > 2.0 * single[2] and np.isnan(found[rule][3:]).all()
    assert found["thesis"][2] < 1.2 * 0.27 and np.isfinite(found["thesis"]).all() and found["thesis"].max() < 0.7


#: Factors on Eq. 5.5 between which discrete elements begin to fall, by arch and period [s]; of Arch2 at .08 s outcomes alternate between
ELEMENTS = {
    "Arch1": {0.08: (1.2, 1.35), 0.10: (1.2, 1.35), 0.12: (1.2, 1.35), 0.15: (1.0, 1.1), 0.20: (1.0, 1.1), 0.30: (1.0, 1.1)},
    "Arch2": {0.08: (1.4, 1.8), 0.10: (1.0, 1.1), 0.12: (1.1, 1.2), 0.15: (0.9, 1.0), 0.20: (0.9, 1.0), 0.30: (1.0, 1.1)},
}


@pytest.mark.verify
@pytest.mark.parametrize("name", ARCHES)
def test_single_sines_in_discrete_elements(name: str) -> None:
    """They stand at the lower and fall at the upper factor: above the printed curve for short pulses, as the tests did."""
    embrace, voussoirs, printed = ARCHES[name]
    arch = {"radius": 0.2, "thickness": 0.03, "thickness_factor": 0.8, "embrace": embrace, "voussoirs": voussoirs}
    for period, factors in ELEMENTS[name].items():
        outcomes = []
        for factor in factors:
            amplitude = factor * float(criterion.Fit(*printed).amplitude(period))
            run = extrados.run(
                {
                    "structure": {"kind": "arch", **arch},
                    "joints": {"friction": 2.0, "normal_stiffness": 1e10},
                    "motion": {"kind": "sine-pulse", "amplitude": f"{amplitude} g", "period": period},
                    "analysis": [{"kind": "dem", "end_time": period + 1.5, "output_step": 0.02}],
                },
                threads=2,
            )
            outcomes.append(run["dem"].outcome == "collapse")
        assert outcomes == [False, True], f"{name}, {period} s"
