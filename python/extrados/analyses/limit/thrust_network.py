"""thrust-network: networks of compression branches within a vault or dome, of least, greatest and most central thrust."""

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.diagrams import FORM, diagram_of, form_of, outside_of
from extrados.analyses.limit.solids import scene_arrays
from extrados.analyses.limit.tables import ThrustNetwork
from extrados.limit.errors import NoEquilibrium
from extrados.limit.network import Aim, Diagram, Extreme, Network, ThrustNetworks
from extrados.results import networks as out
from extrados.results.model import Array, Result, TableData

AIMS: tuple[Aim, ...] = ("central", "least", "greatest", "horizontal")
NOTHING = 1e-6  # load over the weight that is rounding
ABOVE = "1 to 7"  # by how much the load of 40 branches exceeds that of `tilt`: docs/solids.md
ABOUT = {
    "central": "the most central network",
    "least": "the network of least thrust",
    "greatest": "the network of greatest thrust",
    "horizontal": "the network of the greatest horizontal load",
}


def run(context: Context, options: ThrustNetwork) -> Result:
    """The networks of the form diagram: thrusts, vertical safety factor and horizontal load, each with its bound."""
    assembly = context.building.solids()
    form = form_of(context.building, options)
    diagram = diagram_of(assembly, form, options.lines, options.meridians)
    angle = np.radians(options.direction)
    networks = ThrustNetworks(diagram, np.array([np.cos(angle), np.sin(angle)]))
    found: dict[Aim, Extreme] = {}
    result = Result("thrust-network")
    for done, aim in enumerate(AIMS):
        context.progress(done, len(AIMS), "networks")
        if aim != "central" and (found["central"].value is None or found["central"].value > 1.0):
            break
        try:
            found[aim] = networks.extreme(aim)
        except NoEquilibrium as error:
            raise Refused(f"{error}. This does not prove collapse: another `form`, or more `lines`, may give a network", FORM) from None
    part = found["central"].value
    if part is None:
        raise Refused("no network was found on this form diagram. Another `form`, or more `lines`, may give one", FORM)
    states = {aim: one.network for aim, one in found.items() if one.network is not None}
    values = {aim: found[aim] if aim in found else Extreme(None, None, None) for aim in AIMS}
    outside = {aim: outside_of(diagram, assembly, one) for aim, one in states.items()}
    away: dict[Aim, float | None] = {aim: outside[aim][0] if aim in outside else None for aim in AIMS}
    friction = context.building.friction(assembly)
    result.results = r = out.ThrustNetwork(
        form=form,
        nodes=len(diagram.point),
        branches=len(diagram.branch),
        supports=len(diagram.support),
        least_thrust_N=values["least"].value,
        least_thrust_bound_N=values["least"].bound,
        greatest_thrust_N=values["greatest"].value,
        greatest_thrust_bound_N=values["greatest"].bound,
        central_thrust_N=states["central"].thrust,
        least_part_of_depth=part,
        least_part_bound=values["central"].bound,
        vertical_safety_factor=1.0 / part if part > 0.0 else None,
        load_direction_deg=options.direction,
        horizontal_load_g=values["horizontal"].value,
        horizontal_load_bound_g=values["horizontal"].bound,
        weight_N=float(diagram.weight.sum()),
        equilibrium_residual=max(one.residual for one in states.values()),
        thickness_m=outside["central"][1],
        central_outside_m=outside["central"][0],
        least_outside_m=away["least"],
        greatest_outside_m=away["greatest"],
        horizontal_outside_m=away["horizontal"],
        least_friction=None if friction is None else float(np.min(friction)),
    )
    result.arrays = scene_arrays(assembly) | _arrays(diagram, states)
    result.tables = {f"network_{aim}": _table(diagram, one) for aim, one in states.items()}
    result.answer = words_of(r)
    more = "`lines` and `meridians`" if form == "radial" else "`lines`"
    result.warnings += [
        (
            f"between the nodes, the branches of {ABOUT[aim]} pass outside the blocks by up to {1000.0 * by:.3g} mm "
            f"({100.0 * by / r.thickness_m:.2g} % of the thickness): give more {more}"
        )
        for aim, by in away.items()
        if by is not None and r.leaves(by)
    ]
    return result


def _arrays(diagram: Diagram, states: dict[Aim, Network]) -> dict[str, Array]:
    """The diagram with its surfaces, and heights and densities of each network."""
    n = len(diagram.point)
    arrays = {
        "network_point": Array(diagram.point, ("node", "axis"), "m", "nodes of the form diagram in plan"),
        "network_branch": Array(diagram.branch, ("branch", "end"), "", "nodes at the ends of each branch"),
        "network_low": Array(diagram.low[:n], ("node",), "m", "lowest point of the blocks at each node"),
        "network_high": Array(diagram.high[:n], ("node",), "m", "highest point of the blocks at each node"),
        "network_weight": Array(diagram.weight, ("node",), "N", "weight of each node"),
        "network_support": Array(diagram.support, ("support",), "", "nodes on the ground"),
    }
    for aim, one in states.items():
        arrays[f"{aim}_density"] = Array(one.density, ("branch",), "N/m", f"force density of each branch in {ABOUT[aim]}")
        arrays[f"{aim}_height"] = Array(one.height, ("node",), "m", f"height of each node in {ABOUT[aim]}")
    return arrays


def _table(diagram: Diagram, network: Network) -> TableData:
    """Branch by branch: ends, horizontal thrust and force."""
    first, second = diagram.branch.T
    run = np.linalg.norm(diagram.point[second] - diagram.point[first], axis=1)
    rise = network.height[second] - network.height[first]
    columns = {
        "start": first,
        "end": second,
        **{f"x{k}": diagram.point[at, 0] for k, at in ((1, first), (2, second))},
        **{f"y{k}": diagram.point[at, 1] for k, at in ((1, first), (2, second))},
        **{f"z{k}": network.height[at] for k, at in ((1, first), (2, second))},
        "thrust": 1e-3 * network.density * run,
        "force": 1e-3 * network.density * np.hypot(run, rise),
    }
    return TableData(columns, {**dict.fromkeys(("x1", "x2", "y1", "y2", "z1", "z2"), "m"), "thrust": "kN", "force": "kN"})


def _between(value: float | None, bound: float | None, unit: float) -> str:
    """A value found with its bound; only one where both agree."""
    if value is None:
        return "not found" if bound is None else f"not found (bound for this form diagram: {bound / unit:.4g})"
    if bound is None or abs(value - bound) <= out.AGREE * abs(value):
        return f"{value / unit:.4g}"
    return f"{value / unit:.4g} (bound for this form diagram: {bound / unit:.4g})"


def words_of(r: out.ThrustNetwork) -> str:
    """The results as an answer in words."""
    text = f"Networks on the {r.form} diagram of {r.branches} branches: "
    if r.least_part_of_depth > 1.0:
        return (
            f"{text}no network found lies within the structure. The best network requires {r.least_part_of_depth:.2f} "
            f"times the depth (bound for this form diagram: {r.least_part_bound or 0.0:.2f} times). This does not prove "
            "collapse, because another form diagram can give a network."
        )
    text += (
        f"the sum of the outward thrusts at the {r.supports} supports lies between {_between(r.least_thrust_N, r.least_thrust_bound_N, 1000.0)} "
        f"and {_between(r.greatest_thrust_N, r.greatest_thrust_bound_N, 1000.0)} kN. The most central "
        f"network found stays within the middle {100.0 * r.least_part_of_depth:.1f} % of the vertical depth, "
        f"which gives a safety factor of {1.0 / max(r.least_part_of_depth, 0.001):.2f}. Where surfaces are "
        "steep, this factor exceeds the geometric safety factor. "
    )
    return text + _load_words(r)


def _load_words(r: out.ThrustNetwork) -> str:
    """The horizontal load: none by the bound, none found, or a value with its condition."""
    load, bound = r.horizontal_load_g, r.horizontal_load_bound_g
    along = f"Along {r.load_direction_deg:g} degrees "
    if bound is None:
        return "No upper limit of the horizontal load was found on this form diagram."
    if bound <= NOTHING:
        return (
            f"{along}networks on this form diagram carry no horizontal load: a straight free edge, or a span "
            "without supports, would require tension."
        )
    if load is None or load <= NOTHING:
        return (
            f"{along}no network was found that carries a horizontal load. This does not prove a limit: the upper bound "
            f"for this form diagram is {bound:.4g} times the weight."
        )
    return (
        f"{along}networks carry a horizontal load of {_between(load, bound, 1.0)} times the weight, if the load acts at the nodes. The "
        "real load acts at the centroids of the blocks, so the collapse load can be less. In comparisons of barrel "
        f"vaults, this value was {ABOVE} % above the collapse acceleration by `tilt`."
    )
