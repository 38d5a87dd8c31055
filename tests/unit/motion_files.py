"""Synthetic files in the layouts of the networks: each writer follows the published description of its format."""

import numpy as np

STEP = 0.005


def series(points: int = 403, step: float = STEP, seed: int = 5) -> np.ndarray:
    """A short accelerogram [cm/s^2] with values of many sizes and signs."""
    t = step * np.arange(points)
    noise = np.random.default_rng(seed).standard_normal(points)
    return np.round(180.0 * np.sin(2 * np.pi * 3.1 * t) * np.exp(-t) + 20.0 * noise, 3)


def fixed(values: np.ndarray, columns: int, form: str) -> list[str]:
    """Values in columns of fixed width."""
    words = [format(v, form) for v in values]
    return ["".join(words[k : k + columns]) for k in range(0, len(words), columns)]


def at2(a: np.ndarray, step: float = STEP, *, old: bool = False) -> str:
    """PEER; `old` puts the numbers before the words."""
    npts = f"{len(a):5d}    {step:6.4f}    NPTS, DT" if old else f"NPTS= {len(a):6d}, DT= {step:7.4f} SEC,"
    head = ["PEER NGA STRONG MOTION DATABASE RECORD", "Quake, 1/1/2000, Station, 000", "ACCELERATION TIME SERIES IN UNITS OF G", npts]
    return "\n".join([*head, *fixed(a / 980.665, 5, "15.7E")]) + "\n"


def vt2(v: np.ndarray, step: float = STEP) -> str:
    head = ["PEER NGA STRONG MOTION DATABASE RECORD", "Quake, 1/1/2000, Station, 000", "VELOCITY TIME SERIES IN UNITS OF CM/S"]
    return "\n".join([*head, f"NPTS= {len(v):6d}, DT= {step:7.4f} SEC", *fixed(v, 5, "15.7E")]) + "\n"


def cosmos(channels: list[list[tuple[str, str, np.ndarray]]], step: float = STEP) -> str:
    """COSMOS 1.20: for each channel its blocks (quantity, unit with code, values)."""
    lines = []
    for number, blocks in enumerate(channels, start=1):
        lines.append("Corrected acceleration    (Format v01.20 with 13 text lines)")
        text = [
            "Record of Test Earthquake",
            "Hypocenter: 39.5 -123.7",
            "Origin: 2019/05/05",
            "Statn No: 02-001795 Code:NP-1795",
            "Coords: 37.7 -122.4",
            "Recorder: x",
            "Rcrd start time: 2019/05/05",
            f"Sta Chan   {number}: {90 * number} Deg (Rcrdr Chan  1) Location:Ground",
            "Raw record length",
            "Processed: 2019/05/05",
            "Filtered",
            "Values used when parameter is unknown:  -999, -999.000",
        ]
        lines += text
        integers, reals = np.full(100, -999), np.full(100, -999.0)
        reals[61] = 1000.0 * step
        lines.append(" 100 Integer-header values follow on  10 lines, Format = (10I8)")
        lines += fixed(integers, 10, "8d")
        lines.append(" 100 Real-header values follow on  17 lines, Format = (6F13.6)")
        lines += fixed(reals, 6, "13.6f")
        lines += ["   2 Comment line(s) follow, each starting with a |", "| one", "| two"]
        for quantity, unit, values in blocks:
            lines.append(f"  {len(values):6d} {quantity} pts, approx  2 secs, units={unit},Format=(8F10.5)")
            lines += fixed(values, 8, "10.5f")
        lines.append(f"End-of-data for Chan  {number} acceleration")
    return "\n".join(lines) + "\n"


def csmip_v2(a: np.ndarray, step: float = STEP, channels: int = 1, width: int = 10) -> str:
    """CSMIP volume 2: acceleration, velocity, displacement of each channel, columns that may touch."""
    lines = []
    for number in range(1, channels + 1):
        lines += [
            f"Corrected accelerogram   58667-L2866-14236.52       Chan  {number}:  {90 * number} Deg         from   ",
            "Uncorrected Accelerogram Data             Processed: 08/24/14, CGS",
            "Rcrd of Sun Aug 24, 2014",
        ]
        lines += [f"header line {k}" for k in range(4, 26)]
        lines += fixed(np.zeros(100, dtype=int), 16, "5d") + fixed(np.zeros(100), 8, f"{width}.{width - 4}f")
        for what, unit in (("accel", "cm/sec2"), ("veloc", "cm/sec"), ("displ", "cm")):
            lines.append(f"  {len(a)} points of {what} data equally spaced at  {step:.3f} sec, in {unit}. (8f{width}.3)")
            lines += fixed(a * number, 8, f"{width}.3f")
        lines.append("/&  ----------  End of data for channel  1  ----------")
    return "\n".join(lines) + "\n"


def cdmg_v1(a_g: np.ndarray, step: float = STEP) -> str:
    """CDMG volume 1: uncorrected acceleration in g, eight columns of nine."""
    lines = ["UNCORRECTED ACCELEROGRAM DATA              PROCESSED: 06/16/98, CDMG 23583", "TEST EARTHQUAKE"]
    lines += ["header"] * 4 + ["CHAN  1:  90 DEG"] + ["header"] * 6
    lines += fixed(np.zeros(100, dtype=int), 16, "5d") + fixed(np.zeros(50), 8, "10.3f")
    lines.append(f"{len(a_g):5d} POINTS OF ACCEL DATA EQUALLY SPACED AT {step:.3f} SEC.  (UNITS: G)")
    return "\n".join(lines + fixed(a_g, 8, "9.6f")) + "\n"


def smc(a: np.ndarray, step: float = STEP, rate: float | None = None) -> str:
    """USGS SMC: values such as 1.2345E+1 in columns of ten."""
    text = [
        "2 CORRECTED ACCELEROGRAM",
        "*",
        "DVD0A",
        "     1989  10  18    0004 Test",
        "Moment Mag=      7.1",
        "station = Test Dam, crest               component=     65",
        "epicentral dist =     66.0       pk acc =    -80.2",
        "inst type=SMA-1      data source = USGS",
        "*",
        "*",
        "*",
    ]
    whole = np.full(48, -32768)
    whole[15], whole[16] = 3, len(a)
    real = np.full(50, 1.7e38)
    real[1] = 1.0 / step if rate is None else rate
    lines = text + fixed(whole, 8, "10d") + fixed(real, 5, "15.7E") + ["|", "|reference", "|"]
    words = [_short(v) for v in a]
    return "\n".join(lines + ["".join(words[k : k + 8]) for k in range(0, len(words), 8)]) + "\n"


def _short(value: float) -> str:
    mantissa, exponent = f"{value:.4E}".split("E")
    return f"{mantissa}E{int(exponent):+d}".rjust(10)


def knet(counts: np.ndarray, rate: float = 100.0, scale: str = "3920(gal)/6182761") -> str:
    """K-NET: the header's 17 lines have their value from column 19 on."""
    pairs = [
        ("Origin Time", "2011/03/11 14:46:00"),
        ("Lat.", "38.103"),
        ("Long.", "142.861"),
        ("Depth. (km)", "24"),
        ("Mag.", "9.0"),
        ("Station Code", "MYG004"),
        ("Station Lat.", "38.7292"),
        ("Station Long.", "141.0217"),
        ("Station Height(m)", "40"),
        ("Record Time", "2011/03/11 14:46:36"),
        ("Sampling Freq(Hz)", f"{rate:g}Hz"),
        ("Duration Time(s)", f"{len(counts) / rate:g}"),
        ("Dir.", "N-S"),
        ("Scale Factor", scale),
        ("Max. Acc. (gal)", "2699.885"),
        ("Last Correction", "2011/03/11 14:46:21"),
        ("Memo.", ""),
    ]
    lines = [f"{key:18s}{value}" for key, value in pairs]
    words = [f"{int(c):8d} " for c in counts]
    return "\n".join(lines + ["".join(words[k : k + 8]) for k in range(0, len(words), 8)]) + "\n"


def esm(a: np.ndarray, step: float = STEP) -> str:
    """ESM: 64 lines KEY: value, then one column."""
    known = {
        "EVENT_NAME": "TEST",
        "EVENT_ID": "IT-0001",
        "STREAM": "HGE",
        "UNITS": "cm/s^2",
        "SAMPLING_INTERVAL_S": f"{step:.6f}",
        "NDATA": str(len(a)),
        "DATA_TYPE": "ACCELERATION",
        "PGA_CM/S^2": "-180.0",
    }
    keys = [*known.items(), *((f"USER{k}", "") for k in range(64 - len(known)))]
    return "\n".join([*(f"{k}: {v}" for k, v in keys), *(f"{v:.6f}" for v in a)]) + "\n"
