"""Plain columns in many layouts: each is read right or refused with what was seen; none is read wrong."""

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from extrados.motions.formats.recognise import read_records
from extrados.motions.formats.record import ACCELERATION, RecordError
from extrados.motions.records import Treatment, read_record, record_motion

LAYOUTS = 200


@dataclass
class Layout:
    """A file, what a deck says of it, and what it holds.

    components (k, points) [m/s^2] at `step` [s]; told: keys of read_record; treatment: keys of Treatment; made: how.
    """

    text: str
    components: np.ndarray
    step: float
    told: dict = field(default_factory=dict)
    treatment: dict = field(default_factory=dict)
    made: list[str] = field(default_factory=list)


def earthquake(rng: np.random.Generator, points: int, step: float) -> np.ndarray:
    """An accelerogram [m/s^2]: coloured noise under an envelope, peak 0.5 to 4 m/s^2."""
    noise = np.convolve(rng.standard_normal(points + 8), np.hanning(9), "valid")
    t = np.linspace(0.0, 1.0, points)
    a = noise * t**0.7 * np.exp(-4.0 * t)
    return a / np.abs(a).max() * rng.uniform(0.5, 4.0)


def layout(seed: int) -> Layout:
    """A random layout."""
    rng = np.random.default_rng(seed)

    def one(*choices):
        return choices[int(rng.integers(len(choices)))]

    def chance(p: float) -> bool:
        return bool(rng.random() < p)

    step, points, count = one(0.005, 0.01, 0.02), int(rng.integers(200, 900)), int(rng.integers(1, 4))
    made: list[str] = []
    unit = one("g", "m/s^2", "cm/s^2")
    spelt = {"g": one("g", "(g)"), "m/s^2": one("m/s2", "m/s/s"), "cm/s^2": one("cm/s2", "gal", "cm/sec^2")}[unit]
    true = np.stack([earthquake(rng, points, step) for _ in range(count)])
    velocity = chance(0.08)
    if velocity:
        made.append("velocity")
        true = np.cumsum(true, axis=1) * step
        unit, spelt = "m/s", "m/s"
    size = 1.0 if velocity else ACCELERATION[unit]
    raw = true / size
    decimals = one(3, 4) if unit == "cm/s^2" else one(5, 6)
    whole = unit == "cm/s^2" and chance(0.2)
    form = "{:.0f}" if whole else one(f"{{:.{decimals}f}}", f"{{:.{decimals}e}}", f"{{:.{decimals + 1}g}}")
    words = [[form.format(v) for v in row] for row in raw]
    seen = np.array([[float(w) for w in row] for row in words]) * size
    shape = one("one", "one", "rows", "timed", "timed", "timed", "components", "pairs", "interleaved", "numbered")
    made += [shape, unit, form]
    between = one(" ", "\t", ",", ";", ", ")
    time = [f"{k * step:.{one(4, 6)}f}" for k in range(points)]
    defect, per = one(*[""] * 12, "ms", "ms-named", "twice", "gap", "jitter"), 1.0
    if shape in ("timed", "pairs") and defect:
        made.append(defect)
        if defect.startswith("ms"):
            per = 1e3
            time = [f"{1e3 * k * step:g}" for k in range(points)]
        elif defect == "twice":
            time[points // 2] = time[points // 2 - 1]
        elif defect == "gap":
            time = time[: points // 2] + [f"{(k + 3) * step:.4f}" for k in range(points // 2, points)]
        elif defect == "jitter":
            time = [f"{(k + 0.3 * rng.random()) * step:.6f}" for k in range(points)]
    match shape:
        case "one":
            rows, count = [[w] for w in words[0]], 1
        case "rows":
            width, count = one(3, 5, 8), 1
            rows = [words[0][k : k + width] for k in range(0, points, width)]
        case "timed":
            rows = [list(row) for row in zip(time, *words, strict=True)]
        case "components":
            rows = [list(row) for row in zip(*words, strict=True)]
        case "pairs":
            count, flat = 1, [w for pair in zip(time, words[0], strict=True) for w in pair]
            rows = [flat[k : k + 8] for k in range(0, len(flat), 8)]
        case "interleaved":
            rows, count = [[w] for pair in zip(time, words[0], strict=True) for w in pair], 1
        case _:
            rows = [list(row) for row in zip(map(str, range(1, points + 1)), *words, strict=True)]
    stated = {"unit": chance(0.5), "step": chance(0.4), "names": chance(0.4), "columns": chance(0.4), "count": chance(0.2)}
    header: list[str] = []
    if chance(0.5):
        header.append(
            one(
                "Some Quake, Station G. Smith",
                "Record of a station, PGA = 0.21 g",
                "Vs30 = 320 m/s, shear wave velocity",
                "Event 12, 1980 11 23",
            )
        )
    quantity = "velocity" if velocity else "acceleration"
    names = [f"{'vel' if velocity else 'acc'}{k + 1} [{spelt.strip('()')}]".replace(" ", "_") for k in range(count)]
    if stated["unit"] or velocity:
        header.append(f"{quantity} in units of {spelt}")
    if chance(0.05):
        made.append("two units")
        header.append("converted from cm/s^2" if unit != "cm/s^2" else "converted from m/s^2")
    if chance(0.05):
        made.append("factor")
        header.append("scale factor 0.1")
        seen = seen * 0.1
    if stated["step"]:
        header.append(one(f"dt = {step:g} s", f"time step: {1e3 * step:g} ms", f"equal spacing of {step:g} sec"))
    if stated["count"]:
        header.append(f"{points} points")
    if stated["names"] and shape in ("timed", "components") and between.strip():
        first = [{"": "time", "ms": "time"}.get(defect, "time_ms" if per > 1 else "time")] if shape == "timed" else []
        header.append(between.join(first + names))
    elif defect == "ms-named" and shape == "timed":
        header.append(between.join(["time_ms", *names]) if between.strip() else " ".join(["time_ms", *names]))
    if chance(0.3):
        header = [f"# {line}" for line in header]
    whole_rows = []
    if chance(0.2):
        width = len(rows[0])
        kind = one("counts", "dates", "block", "one")
        made.append(f"header of numbers: {kind}")
        whole_rows = {
            "counts": [[str(points), f"{step:g}"]],
            "dates": [["1980", "11", "23"]],
            "block": [[str(v) for v in rng.integers(-999, 2500, width)] for _ in range(int(rng.integers(1, 8)))],
            "one": [[str(points)]],
        }[kind]
    damage = one(*[""] * 18, "nan", "stars", "comma")
    if damage:
        made.append(damage)
        if damage == "comma":
            rows = [[w.replace(".", ",") for w in row] for row in rows]
        else:
            rows[len(rows) // 7][-1] = {"nan": "NaN", "stars": "********"}[damage]
    if chance(0.15) and header and stated["count"]:
        made.append("cut")
        rows = rows[: len(rows) - 20]
        seen = np.full_like(seen, np.nan)
    text = "\n".join([*header, *(between.join(row) for row in [*whole_rows, *rows])]) + "\n"
    told: dict = {}
    if shape == "rows" and stated["columns"]:
        told["columns"] = "series"
    if count > 1 and (stated["names"] or stated["columns"]):
        told["channel"] = int(rng.integers(1, count + 1))
    if shape == "components" and count == 1 and stated["columns"]:
        told["columns"] = "components"
    treatment: dict = {}
    if not velocity and (not stated["unit"] or chance(0.3)):
        treatment["unit"] = unit
    if shape != "timed" and not stated["step"]:
        treatment["time_step"] = step
    return Layout(text, seen, step, told, treatment, made)


def test_none_of_many_layouts_is_read_wrong(tmp_path) -> None:
    wrong, right, refused = [], [], []
    path = tmp_path / "record.txt"
    for seed in range(LAYOUTS):
        made = layout(seed)
        path.write_text(made.text)
        try:
            motion = record_motion(read_record(path, **made.told), Treatment(**made.treatment))
        except RecordError as error:
            refused.append((seed, str(error), made.made))
            continue
        want = made.components[made.told.get("channel", 1) - 1]
        if "velocity" in made.made:
            want = np.gradient(want, made.step)
        got = motion.ground.samples[0]
        same = len(got) == len(want) and np.allclose(got, want, rtol=1e-6, atol=1e-9, equal_nan=False)
        if same and abs(motion.ground.step - made.step) <= 1e-6 * made.step:
            right.append(seed)
        else:
            wrong.append((seed, made.made, made.told, made.treatment, made.text[:200]))
    assert not wrong, wrong
    assert len(right) >= 60 and len(refused) >= 60, (len(right), len(refused))
    plain = {seed for seed in range(LAYOUTS) if layout(seed).made[0] in ("one", "timed") and len(layout(seed).made) == 3}
    over = [r for r in refused if r[0] in plain and "channels. Select one" not in r[1]]
    assert not over, over  # what has no defect is read


#: text, keys of read_record, words of the refusal
N = np.round(100.0 * np.sin(0.2 * np.arange(400)) * np.exp(-0.005 * np.arange(400)), 2)
COLUMN = "".join(f"{v:.2f}\n" for v in N)
THREE = "".join(f"{v:.2f} {0.5 * v:.2f} {0.2 * v:.2f}\n" for v in N)
TIMED = "".join(f"{0.01 * k:.2f} {v:.2f} {0.5 * v:.2f}\n" for k, v in enumerate(N))
REFUSED = {
    "three columns": (THREE, {}, ':1: the row has 3 columns.*number of one of them as `channel` (.1 to 3.).*columns = "series"'),
    "three and time that jumps": (TIMED.replace("2.00 ", "2.03 ", 1), {}, "time step is"),
    "channel of a time that jumps": (TIMED.replace("2.00 ", "2.03 ", 1), {"channel": 1}, "time step is"),
    "whole numbers": ("300\n12\n" + COLUMN, {}, ":1: '300' contains whole numbers.*put #"),
    "whole numbers below a title": ("Some quake\n300\n0\n" + COLUMN, {}, ":2: '300'"),
    "count": (f"{len(N)}.0\n{len(N)}\n" + COLUMN, {}, "count of the values that follow|exceeds twice"),
    "real numbers": ("-999.00\n-999.00\n" + COLUMN, {}, "exceeds twice the greatest value"),
    "counts in other columns": ("400 0.01\n" + COLUMN, {}, ":2: this line has 1 columns, but the lines above have 2; put #"),
    "pairs": ("".join(f"{0.01 * k:.2f} {v:.2f}\n" for k, v in enumerate(N)), {"columns": "series"}, "values that are 2 places apart"),
    "only times": ("".join(f"{0.01 * k:.2f}\n" for k in range(400)), {}, "increase like times"),
    "time last": ("".join(f"{v:.2f} {0.01 * k:.2f}\n" for k, v in enumerate(N)), {"channel": 2}, "put the times in the first column"),
    "fewer than stated": ("402 points in cm/s2\n" + COLUMN, {}, "the header states 402 values, but 400 follow"),
    "two steps": ("dt = 0.02 s\n" + TIMED, {}, "states a time step of 0.02 s, but the times have a step of 0.01 s"),
    "factor": ("scale factor: 0.01\n" + COLUMN, {}, "does not apply a factor from a header"),
    "two quantities": ("acceleration and velocity\n" + COLUMN, {}, "acceleration and velocity"),
    "sample numbers": ("".join(f"{k + 1} {v:.2f}\n" for k, v in enumerate(N)), {}, "column contains sample numbers"),
    "cut": (THREE.rstrip("\n").rpartition(" ")[0], {"columns": "components"}, "cut off"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused_with_what_was_seen(tmp_path, name) -> None:
    text, told, words = REFUSED[name]
    (tmp_path / "r.txt").write_text(text)
    with pytest.raises(RecordError, match=words):
        read_record(tmp_path / "r.txt", **told)


def test_columns_says_what_they_are(tmp_path) -> None:
    (tmp_path / "r.txt").write_text(THREE)
    np.testing.assert_allclose(read_record(tmp_path / "r.txt", 2).values, np.round(0.5 * N, 2), atol=0.011)
    assert len(read_record(tmp_path / "r.txt", columns="series").values) == 1200
    (tmp_path / "r.txt").write_text("NS EW UD\n" + THREE)
    with pytest.raises(RecordError, match=r"3 channels. Select one.*1 'NS', 2 'EW', 3 'UD'"):
        read_record(tmp_path / "r.txt")
    np.testing.assert_allclose(read_record(tmp_path / "r.txt", "UD").values, np.round(0.2 * N, 2), atol=0.011)


@pytest.mark.parametrize(
    ("header", "quantity", "unit"),
    [
        ("velocity in cm/s", "velocity", "cm/s"),
        ("disp (mm)", "displacement", "mm"),
        ("Acceleration (g), velocity elsewhere", "acceleration", "g"),
        ("acc (g); shear wave velocity 300 m/s", "acceleration", "g"),
        ("in cm/s2, from g", "acceleration", "cm/s^2"),
        ("cm/s2 and (g)", "acceleration", None),
        ("Station, G. Smith", "acceleration", None),
        ("PGA = 0.3 g", "acceleration", None),
        ("data in mg", "acceleration", "mg"),
        ("units: % of g", "acceleration", None),
        ("PGA 312 cm/s2, data in g", "acceleration", "g"),
    ],
)
def test_what_a_header_says(tmp_path, header, quantity, unit) -> None:
    (tmp_path / "r.txt").write_text(f"{header}\n{COLUMN}")
    record = read_record(tmp_path / "r.txt")
    assert (record.quantity, record.unit) == (quantity, unit)


@pytest.mark.parametrize(("size", "hint"), [(1e-5, "below 0.0001 g"), (0.981, "above 5 g.*; with the unit m/s.2")])
def test_a_peak_that_no_earthquake_has(tmp_path, size, hint) -> None:
    (tmp_path / "r.txt").write_text("".join(f"{size * v / 10.0:.8f}\n" for v in N))
    with pytest.raises(RecordError, match=hint):
        record_motion(read_record(tmp_path / "r.txt"), Treatment(time_step=0.01, unit="g"))


@pytest.mark.parametrize("step", ["1.0000", "0.00001", "2"])
def test_a_step_that_no_record_has(tmp_path, step) -> None:
    (tmp_path / "r.at2").write_text(f"PEER\nQ\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 3, DT= {step} SEC\n.1 .2 .3\n")
    with pytest.raises(RecordError, match="time step is"):
        read_record(tmp_path / "r.at2")


def test_a_suffix_against_its_header(tmp_path) -> None:
    text = "PEER\nQ\nVELOCITY TIME SERIES IN UNITS OF CM/S\nNPTS= 3, DT= .01 SEC\n.1 .2 .3\n"
    (tmp_path / "r.at2").write_text(text)
    with pytest.raises(RecordError, match="the header names velocity, but the suffix"):
        read_record(tmp_path / "r.at2")
    (tmp_path / "r.vt2").write_text(text.replace("TIME SERIES IN UNITS OF ", ""))
    assert read_record(tmp_path / "r.vt2").quantity == "velocity"


#: Headers of whole numbers as real formats have them: the count, a date, ten columns of eight characters
PREFIXES = (
    "{n}\n",
    "{n} 20\n",
    "1935 10 31\n",
    "300\n",
    "300\n0\n",
    "48\n1935\n10\n31\n",
    "".join("".join(f"{v:8d}" for v in range(k, k + 8)) + "\n" for k in (293, 0, 16)),
)


@pytest.mark.parametrize("prefix", PREFIXES)
def test_numbers_of_a_header_before_real_records(records: Path, tmp_path, prefix) -> None:
    """The issue's file: in cm/s^2 the number 300 was read as a peak of .306 g of a record of .163 g."""
    for name, scale in (("helena_1935_carroll_RSN1_A-HMC180.AT2", 980.665), ("ce291_helena.txt", 100.0)):
        values = read_record(records / name).values * scale
        for width in (1, 8):
            rows = [values[k : k + width] for k in range(0, len(values), width)]
            text = "".join("".join(f"{v:10.3f}" for v in row) + "\n" for row in rows)
            for told in ({}, {"columns": "series"}):
                (tmp_path / "r.txt").write_text(prefix.format(n=len(values)) + text)
                with pytest.raises(RecordError):
                    read_record(tmp_path / "r.txt", **told)
            (tmp_path / "r.txt").write_text("".join(f"# {line}\n" for line in prefix.format(n=len(values)).splitlines()) + text)
            back = read_record(tmp_path / "r.txt", columns="series").values
            np.testing.assert_allclose(back, values, atol=6e-4)


@pytest.mark.parametrize("layout", ["{t:.2f} {a:.6f}\n", "{a:.6f}\n", "{a:.6f} {a:.6f} {a:.6f}\n", "{t:.2f},{a:.6E}\n"])
def test_a_file_that_is_cut_inside_its_last_number_is_refused(layout: str, tmp_path: Path) -> None:
    text = "step 0.01 s, acceleration in g\n" * ("{t" not in layout)
    text += "".join(layout.format(t=0.01 * k, a=0.1 * math.sin(0.3 * k + 0.1)) for k in range(60))
    path = tmp_path / "motion.txt"
    columns = "components" if layout.count("{a") > 1 else None
    for whole in (text, text.rstrip("\n"), text.replace("\n", "\r\n")):
        path.write_text(whole, newline="")
        assert read_records(path, columns)[0].values.size == 60
    for lost in (2, 4):
        path.write_text(text[:-lost], newline="")
        with pytest.raises(RecordError, match="fewer decimals than the numbers above, so the file is cut off"):
            read_records(path, columns)


def test_a_whole_file_may_end_with_a_short_number(tmp_path: Path) -> None:
    """Records of PEER end with .0 where all other numbers have seven decimals."""
    rows = "".join(f"{0.01 * k:.2f} {0.1 * math.sin(0.3 * k + 0.1):.6f}\n" for k in range(60))
    path = tmp_path / "motion.txt"
    path.write_text(rows + "0.60 .0\n")
    assert read_records(path)[0].values.size == 61
