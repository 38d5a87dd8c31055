"""Charts of stored runs for the page, by the entry of the kind, from the available arrays."""

from typing import Any

import numpy as np

from extrados.kinds import ANALYSES, load
from extrados.results.store import Stored, StoreError
from extrados.results.verdict import SelfWeight
from extrados.schema.constants import GRAVITY

MOST_POINTS, MOST_PICTURES, MOST_STATES, MOST_MEMBERS = 4000, 600, 60, 4000
MOST_ROWS, MOST_COLUMNS = 200, 10
#: Values that stand in one cell
SINGLE = int | float | str | None
#: Arrays of supports that move: those of a film, or of the states that figures show, and how each calls its thrust lines
FILM, SHOWN = ("film", "line"), ("shown", "point")
#: Blocks in space: how the page calls their arrays, and how results do
SOLIDS = {
    "vertex": "solid_vertex",
    "face": "solid_face",
    "face_start": "solid_face_start",
    "face_body": "solid_face_block",
    "body_centre": "solid_centroid",
}
Arrays = dict[str, np.ndarray]
Chart = dict[str, Any]


def _axis(array: str, label: str, unit: str, factor: float = 1.0) -> dict[str, Any]:
    return {"array": array, "label": label, "unit": unit, "factor": factor}


def _series(array: str, label: str, **more: Any) -> dict[str, Any]:
    return {"array": array, "label": label, **more}


def _chart(title: str, x: dict[str, Any], y: dict[str, Any], series: list[dict[str, Any]], **more: Any) -> Chart:
    return {"title": title, "x": x, "y": {k: v for k, v in y.items() if k != "array"}, "series": series, **more}


def shown(run: Stored, name: str | None) -> tuple[dict[str, Any], Arrays]:
    """Words of a run and, where an analysis is named, its charts, its body and the arrays that these name."""
    rows = [
        {k: row.get(k) for k in ("name", "kind", "status", "reason", "answer", "warnings", "verdict", "seconds")} for row in run.analyses
    ]
    deck = run.summary["deck"]
    words: dict[str, Any] = {"title": deck.get("title") or deck["path"], "deck": deck["path"], "analyses": rows}
    if name is None:
        return words, {}
    if name not in run.arrays:
        raise StoreError(f"the run has no analysis {name[:60]!r} with stored arrays")
    kind = run.analysis(name)["kind"]
    arrays = {key: array.numbers for key, array in run.arrays[name].items()}
    made = Shown(run, name, arrays)
    draw = Shown.self_weight if isinstance(run[name], SelfWeight) else load(ANALYSES[kind].page)
    try:
        draw(made)
    except KeyError as error:
        raise StoreError(f"the results of {name} do not contain the array {error}") from None
    results = run.analysis(name)["results"]
    numbers = [[k, v] for k, v in results.items() if isinstance(v, SINGLE)]
    words |= {
        "analysis": name,
        "kind": kind,
        "charts": made.charts,
        "body": made.body,
        "numbers": numbers[:60],
        "tables": made.tables + [t for k, v in results.items() if (t := _rows(k, v)) is not None],
    }
    return words, made.out


def _rows(name: str, value: Any) -> dict[str, Any] | None:
    """Rows of a result as a table: those of a list, those of a mapping by their names, or the parts of one thing."""
    if isinstance(value, dict) and value and all(isinstance(v, SINGLE) for v in value.values()):
        value = [value]
    elif isinstance(value, dict) and all(isinstance(v, dict) for v in value.values()):
        value = [{"": key, **row} for key, row in value.items()]
    if not isinstance(value, list) or not value or not all(isinstance(row, dict) for row in value):
        return None
    columns = list(dict.fromkeys(k for row in value for k, v in row.items() if isinstance(v, SINGLE)))[:MOST_COLUMNS]
    columns = [k for k in columns if any(row.get(k) not in (None, "") for row in value)]
    rows = [[row.get(k) if isinstance(row.get(k), SINGLE) else None for k in columns] for row in value[:MOST_ROWS]]
    return {"title": name.replace("_", " "), "columns": columns, "rows": rows, "left_out": max(0, len(value) - MOST_ROWS)}


class Shown:
    """Collects the data of one analysis for the page."""

    def __init__(self, run: Stored, name: str, arrays: Arrays):
        self.run, self.name, self.arrays = run, name, arrays
        self._results: Any = run[name]  # of the kind whose charts are made
        self.out: Arrays = {}
        self.charts: list[Chart] = []
        self.tables: list[dict[str, Any]] = []
        self.body: dict[str, Any] | None = None

    def send(self, *names: str, keep: slice | np.ndarray = slice(None)) -> None:
        """Send arrays as they are, or some of their rows."""
        for name in names:
            if name in self.arrays:
                self.out[name] = self.arrays[name][keep]

    def _draw(self, title: str, x: dict[str, Any], y: dict[str, Any], series: list[dict[str, Any]], **more: Any) -> None:
        self.charts.append(_chart(title, x, y, series, **more))

    def _pulses(self, title: str, x: dict[str, Any], series: list[dict[str, Any]], **more: Any) -> None:
        """A chart of amplitudes [g] over the lengths of pulses."""
        self._draw(title, x, _axis("", "amplitude", "g"), series, least=0.0, **more)

    def _over_time(self, count: int) -> slice:
        return slice(None, None, max(1, -(-count // MOST_POINTS)))

    def _stones(self) -> None:
        for name in ("outline", "outline_start", "centroid"):
            if name not in self.arrays:
                raise KeyError(name)
            self.out[name] = self.arrays[name]

    def self_weight(self) -> None:
        """The collapse motion of a certificate, up to a tenth of the structure's size."""
        velocity, centroid = self.arrays["collapse_velocity"], self.arrays["centroid"]
        size = float(np.ptp(self.arrays["outline"], axis=0).max())
        share = np.linspace(0.0, 1.0, MOST_STATES)
        step = 0.1 * size / max(float(np.hypot(velocity[:, 0], velocity[:, 1]).max()), 1e-300)
        pose = np.concatenate([centroid, np.zeros((len(centroid), 1))], axis=1) + step * share[:, None, None] * velocity
        self._moving(share, pose, "", "displayed part of the motion")

    def _moving(self, time: np.ndarray, pose: np.ndarray, unit: str, label: str, **lines: np.ndarray) -> None:
        """A body of stones that moves along `time`."""
        self._stones()
        self.out |= {"body_time": time, "body_pose": pose, **{f"body_{k}": v for k, v in lines.items()}}
        self.body = {"sort": "stones", "unit": unit, "label": label, "line": "line" in lines}

    def _mechanism(self, pose: str, label: str) -> None:
        """A body of stones that moves from rest to the stored pose (blocks, 3)."""
        rest = np.column_stack([self.arrays["centroid"], np.zeros(len(self.arrays["centroid"]))])
        share = np.linspace(0.0, 1.0, 24)
        self._moving(share, rest + share[:, None, None] * (self.arrays[pose] - rest), "", label)

    def _blocks(self, time: np.ndarray, pose: np.ndarray, **body: Any) -> None:
        """Blocks in space that move along `time` by poses (times, blocks, 6)."""
        self.out |= {name: self.arrays[source] for name, source in SOLIDS.items()} | {"body_time": time, "pose": pose}
        self.body = {"sort": "space", **body}

    def _lines(self, *names: str) -> list[dict[str, str]]:
        """Stored lines of thrust, of states that are named."""
        words = {"collapse": "at collapse, load to +x", "least": "least thrust", "most": "greatest thrust", "central": "most central"}
        found = []
        for name in names:
            if f"{name}_line" in self.arrays:
                self.out[f"{name}_line"], self.out[f"{name}_start"] = (self.arrays[f"{name}_line"], self.arrays[f"{name}_line_start"])
                found.append({"name": name, "label": words[name]})
        return found

    # Kinds

    def _solids(self) -> None:
        """Blocks in space that move along a mechanism, and their capacity over the direction."""
        share, pose = np.linspace(0.0, 1.0, 24), self.arrays["mechanism_pose"]
        self._blocks(share, pose, unit="", label="mechanism", swings=True, push=self._results.load_direction_deg)
        if len(self.arrays["rose_direction"]) > 2:
            self.send("rose_direction", "rose_capacity")
            self._draw(
                "Capacity, plotted over the direction of the acceleration",
                _axis("rose_direction", "direction in plan", "deg"),
                _axis("", "collapse acceleration", "g"),
                [_series("rose_capacity", "capacity", sort="both")],
                least=0.0,
            )

    def pushover(self) -> None:
        """Base shear over displacement of every sense or stage, and the building as it cracks under the first of them."""
        r = self._results
        if r.stages:
            curves = [(stage.prefix, stage.name) for stage in r.stages]
        else:
            curves = [("", f"push to {r.sense}"), *([("minus_", f"push to {r.minus.sense}")] if r.minus else [])]
        series = []
        for k, (prefix, label) in enumerate(curves):
            if f"{prefix}envelope_load" in self.arrays:
                x = f"{prefix}envelope_displacement"
                self.send(f"{prefix}envelope_load", x)
                series.append(_series(f"{prefix}envelope_load", label, x=x, factor=1e-3, dashed=k % 2 == 1))
        axis = _axis("envelope_displacement", "displacement", "mm", 1e3)
        self._draw("Base shear and displacement", axis, _axis("", "base shear", "kN"), series, trace="state")
        if "state_event" not in self.arrays:
            return
        events = self.arrays["state_event"]
        pick = np.unique(np.linspace(0, len(events) - 1, min(len(events), MOST_STATES)).round().astype(int))
        parts = [a.numbers for a in self.run.series(self.name, "elements")]
        bends = [bool(a.numbers[0]) for a in self.run.series(self.name, "bends")]
        faces = [row for part in parts for row in part]
        self.out |= {
            "vertex": self.arrays["node"],
            "face": np.concatenate(faces),
            "face_start": np.cumsum([0, *map(len, faces)]),
            "body_time": events[pick],
            "state_load": self.arrays["state_load"][pick],
            "state_held": self._held(events[pick]),
            "state_moved": self.arrays["state_displacement"][pick],
            "state_tone": self._cracked(parts, bends, self.arrays["state_width"][pick]),
            "state_width": self.arrays["state_width"][pick].max(axis=1),
        }
        self.body = {"sort": "space", "unit": "", "label": "event", "walls": True}

    def _cracked(self, parts: list[np.ndarray], bends: list[bool], width: np.ndarray) -> np.ndarray:
        """Tones (states, faces) of elements: of floors 1, of walls and vaults, which bend, 0, or 2 to 5 by quarters of the widest crack."""
        from extrados.show.shell import LEAST_WIDTH

        counts = [len(part) for part in parts]
        wall = np.repeat(np.array(bends, dtype=bool), counts)
        tone = np.zeros((len(width), len(wall)), dtype=np.uint8)
        tone[:, ~wall] = 1
        element, most = self.arrays["place_element"], max(float(width.max(initial=0.0)), 1e-12)
        for k, row in enumerate(width):
            widest = np.zeros(int(wall.sum()))
            np.maximum.at(widest, element, row)
            level = np.minimum(3, (4.0 * widest / most).astype(int)) + 2
            tone[k, wall] = np.where(widest > LEAST_WIDTH * most, level, 0)
        return tone

    def tilt(self) -> None:
        """The section at collapse, its mechanism, and the thrust on the way there."""
        if "solid_vertex" in self.arrays:
            self._solids()
            return
        self._stones()
        lines = self._lines("collapse", "least", "most")
        if "mechanism_pose" in self.arrays:
            self._mechanism("mechanism_pose", "mechanism")
        self.body = {"sort": "stones", "unit": "", "label": "mechanism", "lines": lines, "swings": True}
        if "collapse_friction" in self.arrays:
            self.out["joint"] = np.arange(len(self.arrays["collapse_friction"]))
            self.send("collapse_friction", "collapse_normal")
            self._draw(
                "Required friction at collapse",
                _axis("joint", "joint", ""),
                _axis("", "coefficient of friction", ""),
                [_series("collapse_friction", "needed", sort="points")],
            )

    def thrust(self) -> None:
        """The lines of least and greatest thrust; of solids the blocks and the thrusts of their sections."""
        if "solid_vertex" in self.arrays:
            rest = np.zeros((len(self.arrays["solid_centroid"]), 6))
            self._blocks(np.linspace(0.0, 1.0, 24), rest, unit="", label="", swings=True, push=self._results.load_direction_deg)
            columns = ["section", "direction", "least [kN]", "central [kN]", "greatest [kN]"]
            rows = [
                [one.name, one.direction, *(None if n is None else 1e-3 * n for n in (one.least_N, one.central_N, one.greatest_N))]
                for one in self._results.sections
            ]
            self.tables.append({"title": "thrust", "columns": columns, "rows": rows, "left_out": 0})
            return
        self._stones()
        self.body = {"sort": "stones", "unit": "", "label": "", "lines": self._lines("least", "most", "central")}

    def rocking(self) -> None:
        """Rotation, ground and energies over time, and the structure as it moves."""
        keep = self._over_time(len(self.arrays["time"]))
        self.send("time", "rotation", "ground", "kinetic", "potential", "ledger", keep=keep)
        self.send("impact_time")
        time = _axis("time", "time", "s")
        turns = [_series("rotation", "rotation", factor=1e3)]
        if "rotation_upper" in self.arrays:  # of two stacked blocks
            self.send("rotation_upper", keep=keep)
            turns = [_series("rotation", "lower block", factor=1e3), _series("rotation_upper", "upper block", factor=1e3, dashed=True)]
        self.charts += [
            _chart("Rotation", time, _axis("", "rotation", "mrad"), turns, marks="impact_time", cursor=True),
            _chart("Ground", time, _axis("", "acceleration", "g"), [_series("ground", "ground", factor=1 / GRAVITY)], cursor=True),
            _chart(
                "Energy",
                time,
                _axis("", "energy", "J"),
                [_series("kinetic", "kinetic"), _series("potential", "potential"), _series("ledger", "supplied less lost", dashed=True)],
                cursor=True,
            ),
        ]
        if "film_time" in self.arrays:
            lines = {"line": self.arrays["film_line"]} if "film_line" in self.arrays else {}
            self._moving(self.arrays["film_time"], self.arrays["film_pose"], "s", "time", **lines)
        elif "snapshot_time" in self.arrays and len(self.arrays["snapshot_time"]):
            lines = {"line": self.arrays["snapshot_thrust"]} if "snapshot_thrust" in self.arrays else {}
            self._moving(self.arrays["snapshot_time"], self.arrays["snapshot_pose"], "s", "time", **lines)

    def dem(self) -> None:
        """Displacements, rotations and energies over time, and the blocks as they move."""
        time = self.arrays["time"]
        keep = slice(None, None, max(1, -(-len(time) // MOST_PICTURES)))
        if "place" in self.arrays:
            self._moving(time[keep], self.arrays["place"][keep], "s", "time")
            if "support_outline" in self.arrays:
                self.send("support_outline", "support_start")
        elif "solid_vertex" in self.arrays:
            self._blocks(time[keep], self.arrays["pose"][keep], unit="s", label="time", over_time=True)
        fine = self._over_time(len(time))
        self.out["time"] = time[fine]
        axis = _axis("time", "time", "s")
        rows = []
        if "turn" in self.arrays:  # of blocks in space: by how much, whatever the axis
            for i in self.arrays["tracked"][:6].tolist():
                self.out[f"turn_{i}"] = np.linalg.norm(self.arrays["turn"][fine, i], axis=1)
                rows.append(_series(f"turn_{i}", f"stone {i + 1}", factor=1e3))
        elif "rotation" in self.arrays:
            for i, label in zip(self.arrays["tracked"][:6].tolist(), self._results.peak_rotation_rad, strict=False):
                self.out[f"rotation_{i}"] = self.arrays["rotation"][fine, i]
                rows.append(_series(f"rotation_{i}", label, factor=1e3))
        if rows:
            self._draw("Rotation", axis, _axis("", "rotation", "mrad"), rows, cursor=True)
        if "ground" in self.arrays:
            self.out["ground"] = self.arrays["ground"][fine]
            self._draw("Ground", axis, _axis("", "acceleration", "g"), [_series("ground", "ground", factor=1 / GRAVITY)], cursor=True)
        energies = [k for k in ("work", "kinetic", "potential", "elastic", "damping", "friction") if f"{k}_energy" in self.arrays]
        for kind in energies:
            self.out[f"{kind}_energy"] = self.arrays[f"{kind}_energy"][fine]
        if energies:
            self._draw("Energy", axis, _axis("", "energy", "kJ"), [_series(f"{k}_energy", k, factor=1e-3) for k in energies], cursor=True)

    def supports(self) -> None:
        """What opens as supports move, or the thrust on the way to collapse."""
        if "movement" in self.arrays and "force" in self.arrays:
            self.send("movement")
            self.out["force_x"], self.out["force_y"] = self.arrays["force"].T
            rows = [_series("force_x", "horizontal", factor=1e-3), _series("force_y", "vertical", factor=1e-3)]
            self._draw(
                "Force on the support", _axis("movement", "movement of the support", "mm", 1e3), _axis("", "force", "kN"), rows, cursor=True
            )
        film = next((f for f in (FILM, SHOWN) if f"{f[0]}_movement" in self.arrays), None)
        if film is not None:
            which, line = film
            movement, pose = self.arrays[f"{which}_movement"], self.arrays[f"{which}_pose"]
            self._moving(1e3 * movement, pose, "mm", "movement", line=self.arrays[f"{which}_{line}"])
        elif "settled_pose" in self.arrays:
            self._mechanism("settled_pose", "share of the movement")

    def sla(self) -> None:
        """The load curve, and the wall as it cracks."""
        from extrados.show.cracked import CORNERS

        self._curve()
        if "state_event" not in self.arrays:
            return
        events = self.arrays["state_event"]
        pick = np.unique(np.linspace(0, len(events) - 1, min(len(events), MOST_STATES)).round().astype(int))
        polygons = [a.numbers[:, : CORNERS[a.numbers.shape[1]]] for a in self.run.series(self.name, "elements")]
        self.out["node"] = self.arrays["node"]
        self.out["element"] = np.concatenate([p.ravel() for p in polygons])
        self.out["element_start"] = np.cumsum([0, *(n for p in polygons for n in [p.shape[1]] * len(p))])
        self.out["body_time"] = events[pick]
        self.out["state_load"] = self.arrays["state_load"][pick]
        self.out["state_held"] = self._held(events[pick])
        self.out["state_moved"] = self.arrays["state_displacement"][pick]
        for field in ("width_n", "width_s", "angle"):
            if f"state_{field}" in self.arrays:
                self.out[f"state_{field}"] = self.arrays[f"state_{field}"][pick]
        self.send("point_xy", "point_element", "point_reach", "point_band")
        self.body = {"sort": "mesh", "unit": "", "label": "event"}

    def _held(self, events: np.ndarray) -> np.ndarray:
        """Which states, by their events, are in equilibrium and no farther than the envelope: beyond it a mechanism moves."""
        held = np.ones(len(events), dtype=bool)
        if "event_state" in self.arrays:
            held = self.arrays["event_state"][events - 1] > 0
        if "envelope_displacement" in self.arrays:
            reach = 1.05 * np.abs(self.arrays["envelope_displacement"]).max(initial=0.0)
            held &= np.abs(self.arrays["event_displacement"][events - 1]) <= reach
        return held.astype(np.uint8)

    def _curve(self) -> None:
        series, axis = [], _axis("event_displacement", "displacement", "mm", 1e3)
        if "event_displacement" not in self.arrays:
            return
        fine = self.arrays["event_state"] > 0 if "event_state" in self.arrays else slice(None)
        for kind, label, more in (
            ("event", "every event", {"faint": True, "aside": "envelope_load" in self.arrays}),
            ("envelope", "envelope", {}),
        ):
            if f"{kind}_load" in self.arrays:
                part = fine if kind == "event" else slice(None)
                x, y = self.arrays[f"{kind}_displacement"][part], self.arrays[f"{kind}_load"][part]
                thin = slice(None, None, max(1, -(-len(x) // MOST_POINTS)))
                self.out[f"{kind}_displacement"], self.out[f"{kind}_load"] = x[thin], y[thin]
                series.append(_series(f"{kind}_load", label, x=f"{kind}_displacement", factor=1e-3, **more))
        if "measured_displacement" in self.arrays:
            self.send("measured_displacement", "measured_least", "measured_greatest")
            series.append(
                _series("measured_greatest", "measured", x="measured_displacement", lower="measured_least", factor=1e-3, sort="band")
            )
        self._draw("Load and displacement", axis, _axis("", "load", "kN"), series, trace="state")

    def fragility(self) -> None:
        """Probabilities over the intensity, or the peaks of the members."""
        a = self.arrays
        if "grid" in a:
            unit = self.run.arrays[self.name]["grid"].unit
            about = self.run.arrays[self.name]["grid"].about
            rows = []
            for colour, stage in enumerate(("", "first_collapse_", "uplift_", "overturning_given_uplift_", "two_stage_")):
                words = stage.strip("_").replace("_", " ") or "collapse"
                low = f"{stage}lower" if stage else "curve_lower"
                high = low.replace("lower", "upper")
                if low in a and high in a:
                    self.send(low, high)
                    rows.append(_series(high, f"band of {words}", lower=low, sort="band", colour=colour))
                if f"{stage}curve" in a:
                    self.send(f"{stage}curve")
                    rows.append(_series(f"{stage}curve", words, dashed=stage not in ("", "first_collapse_"), colour=colour))
            self.send("grid", "stripe_level", "stripe_collapse_probability")
            if "stripe_level" in a:
                rows.append(_series("stripe_collapse_probability", "share that collapsed", x="stripe_level", sort="points"))
            self._draw("Fragility", _axis("grid", about or "intensity", unit), _axis("", "probability", ""), rows, least=0.0, most=1.0)
        if "duration" in a and "lower" in a:
            self.send("duration", "lower", "upper")
            rows = [_series("upper", "95 % interval", lower="lower", sort="band")]
            for key in a:
                if key not in ("duration", "lower", "upper") and np.shape(a[key]) == np.shape(a["duration"]):
                    self.send(key)
                    rows.append(_series(key, key.replace("_", " "), sort="both"))
            self._draw("Over durations", _axis("duration", "duration", "s"), _axis("", "share", ""), rows, least=0.0, most=1.0)
        if "bin_edge" in a and "bin_count" in a:
            self.out["bin_middle"] = 0.5 * (a["bin_edge"][1:] + a["bin_edge"][:-1])
            self.send("bin_count")
            self._draw(
                "Greatest rotations",
                _axis("bin_middle", "greatest rotation / critical rotation", ""),
                _axis("", "runs", ""),
                [_series("bin_count", "runs", sort="bars")],
                least=0.0,
            )
        if "pga" in a and "peak_ratio" in a:
            keep = self._over_time(len(a["pga"]))
            self.send("pga", "peak_ratio", keep=keep)
            self._draw(
                "Members",
                _axis("pga", "peak ground acceleration", "g"),
                _axis("", "rotation over critical", ""),
                [_series("peak_ratio", "members", sort="points")],
            )

    def failure_domain(self) -> None:
        """The lowest amplitudes that cause collapse over the lengths of pulses."""
        self.send("duration", "mode_I", "mode_II")
        rows = [_series(k, k.replace("_", " ")) for k in ("mode_I", "mode_II") if k in self.arrays]
        heat = None
        if "outcome" in self.arrays:
            self.out["codes"] = self.arrays["outcome"].astype(np.uint8)
            self.send("amplitude")
            heat = {"codes": "codes", "x": "duration", "y": "amplitude"}
        self._pulses("Failure domain", _axis("duration", "duration of the pulse", "s"), rows, heat=heat)

    def dem_domain(self) -> None:
        """The shortest pulses that cause collapse."""
        rows = []
        for k, label in enumerate(np.asarray(self.arrays["curve"]).astype(str).tolist()):
            self.out[f"shortest_{k}"] = self.arrays["shortest"][k]
            rows.append(_series("amplitude", label, x=f"shortest_{k}", sort="both"))
        for mode in ("mode_I", "mode_II"):
            if mode in self.arrays:
                self.send(mode)
                rows.append(_series("amplitude", f"four hinges, {mode.replace('_', ' ')}", x=mode, dashed=True))
        self.send("amplitude")
        self._pulses("Shortest failing pulses", _axis("shortest_0", "duration", "s"), rows)

    def sweep(self) -> None:
        """The capacity over the values of the key."""
        self.send("value", "gamma", "fractured", "buttress_alone")
        words = {"gamma": "monolithic", "fractured": "leeward buttress cracked", "buttress_alone": "buttress alone"}
        rows = [_series(k, w) for k, w in words.items() if k in self.arrays]
        about = self._results.vary.replace("_", " ")
        self._draw("Capacity", _axis("value", about, self._results.unit), _axis("", "collapse acceleration", "g"), rows)

    def strengthen(self) -> None:
        """The value over the size of each alternative, and the building with the mechanism of the cheapest one."""
        rows = {one["name"]: one for one in self.run.analysis(self.name)["results"]["interventions"]}
        start = self.arrays["curve_start"]
        for k, name in enumerate(self.arrays["curve_of"].astype(str)):
            size, value, _ = self.arrays["curve"][start[k] : start[k + 1]].T
            self.out |= {f"size_{k}": size, f"value_{k}": value}
            unit = rows[name]["unit"]
            factor, shown = {"N": (1e-3, "kN"), "Pa": (1e-6, "MPa")}.get(unit, (1.0, unit))
            self._draw(
                name, _axis(f"size_{k}", "size", shown, factor), _axis("", "value", self._results.unit), [_series(f"value_{k}", name)]
            )
        self.charts = self.charts[:12]

    def moving_load(self) -> None:
        """The live-load factor over the place of the load."""
        self.send("place", "capacity")
        self._draw(
            "Collapse load",
            _axis("place", "position of the first axle" if len(self.arrays["axle"]) else "position of the train", "m"),
            _axis("", "load", "kN"),
            [_series("capacity", "capacity", factor=1e-3)],
        )
        if "mechanism_pose" in self.arrays and "outline" in self.arrays:
            self._mechanism("mechanism_pose", "mechanism")

    def assessment(self) -> None:
        """The motion, and its primary impulses beside the pulses that bring the structure down."""
        self.out |= {"time": self.arrays["time"], "ground": self.arrays["ground"] / GRAVITY}
        self._draw("Ground", _axis("time", "time", "s"), _axis("", "acceleration", "g"), [_series("ground", "ground")])
        self.send("period", "failing_amplitude", "failing_amplitude_own", "computed_period", "computed_amplitude", "impulse_period")
        self.out["impulse_amplitude"] = np.abs(self.arrays["impulse_amplitude"]) / GRAVITY
        known = [
            _series("failing_amplitude", "fails (Eq. 5.8)"),
            _series("failing_amplitude_own", "collapse, fitted to this structure", dashed=True),
            _series("computed_amplitude", "fails, computed", x="computed_period"),
            _series("impulse_amplitude", "impulses of the motion", x="impulse_period", sort="points"),
        ]
        rows = [r for r in known if np.isfinite(np.asarray(self.out.get(r["array"], np.nan), dtype=float)).any()]
        self._pulses("Pulses that cause collapse", _axis("period", "period", "s"), rows)

    def failure_curves(self) -> None:
        """The lowest failing amplitude of each structure, and the primary impulses of the motions."""
        r = self._results
        rows = []
        for k, curve in enumerate(r.curves):
            self.out[f"duration_{k}"], self.out[f"amplitude_{k}"] = (self.arrays["duration"][k], self.arrays["amplitude"][k])
            rows.append(_series(f"amplitude_{k}", curve.label, x=f"duration_{k}", dashed=k % 2 == 1))
        if r.impulses:
            self.out["impulse_period"] = np.array([i.period_s for i in r.impulses])
            self.out["impulse_amplitude"] = np.array([abs(i.amplitude_g) for i in r.impulses])
            rows.append(_series("impulse_amplitude", "impulses of motions", x="impulse_period", sort="points"))
        self._pulses(f"Lowest amplitude that causes collapse ({r.pulse} pulse)", _axis("duration_0", "duration", "s"), rows)

    def local_mechanism(self) -> None:
        """The capacity curve of the mechanism."""
        if "displacement" not in self.arrays:
            return
        self.send("displacement", "acceleration")
        self._draw(
            "Capacity of the mechanism, plotted over its displacement",
            _axis("displacement", "displacement", "m"),
            _axis("", "acceleration", "g"),
            [_series("acceleration", "capacity")],
            least=0.0,
        )

    def survey(self) -> None:
        """The capacity of each section, the weakest first."""
        names, gamma = self.arrays["section_name"].astype(str), self.arrays["gamma"]
        order = np.argsort(np.where(np.isfinite(gamma), gamma, np.inf), kind="stable")
        self.out |= {"rank": np.arange(1, len(order) + 1), "capacity": gamma[order]}
        self._draw(
            "Capacity of the sections, in ascending order",
            _axis("rank", "rank", ""),
            _axis("", "collapse acceleration", "g"),
            [_series("capacity", "capacity", sort="points")],
            least=0.0,
        )
        rows = [[str(names[k]), float(gamma[k]) if np.isfinite(gamma[k]) else None] for k in order.tolist()]
        self.tables.append(
            {
                "title": "sections",
                "columns": ["section", "capacity [g]"],
                "rows": rows[:MOST_ROWS],
                "left_out": max(0, len(rows) - MOST_ROWS),
            }
        )

    def others(self) -> None:
        """Any other kind: arrays over their axis, if it has numbers of its own."""
        found = self.run.arrays[self.name]
        axes = {n: a for n, a in found.items() if a.dims == (n,) and np.size(a.numbers) > 1 and np.asarray(a.numbers).dtype.kind in "fiu"}
        for axis, about in axes.items():
            rows = [n for n, a in found.items() if a.dims == (axis,) and n != axis and np.asarray(a.numbers).dtype.kind in "fiu"]
            keep = self._over_time(np.size(about.numbers))
            for unit in dict.fromkeys(found[n].unit for n in rows):
                some = [n for n in rows if found[n].unit == unit][:6]
                self.send(axis, *some, keep=keep)
                self._draw(
                    ", ".join(n.replace("_", " ") for n in some),
                    _axis(axis, axis.replace("_", " "), about.unit),
                    _axis("", some[0].replace("_", " ") if len(some) == 1 else "", unit),
                    [_series(n, n.replace("_", " ")) for n in some],
                )
        self.charts = self.charts[:12]
