"""Results of thrust-network: compression networks on a form diagram within a vault or dome."""

from extrados.results.fields import fact
from extrados.results.verdict import Demand, KindResults, Verdict, judge

#: Relative difference of a value and its bound that is rounding
AGREE = 1e-4
#: Part of the thickness by which branches may leave the blocks
LEAVES = 0.01


class ThrustNetwork(KindResults):
    """thrust-network: thrusts, safety and horizontal load of the networks on one form diagram.

    Each bound encloses all networks on the diagram; a value belongs to a network that was found.
    """

    form: str = fact("form diagram: radial, grid or crossed")
    nodes: int = fact("nodes of the diagram")
    branches: int = fact("branches of the diagram")
    supports: int = fact("nodes on the ground")
    least_thrust_N: float | None = fact("least sum of the outward thrusts at all supports; null if no network was found", "N")
    least_thrust_bound_N: float | None = fact(
        "lower bound of `least_thrust_N` for all networks on this form diagram; null without a bound", "N"
    )
    greatest_thrust_N: float | None = fact(
        "greatest sum of the outward thrusts at all supports; null if no network was found, or if the thrust has no limit", "N"
    )
    greatest_thrust_bound_N: float | None = fact(
        "upper bound of `greatest_thrust_N` for all networks on this form diagram; null if the thrust has no limit", "N"
    )
    central_thrust_N: float = fact("sum of the outward thrusts at all supports in the most central network", "N")
    least_part_of_depth: float = fact("smallest central part of the vertical depth within which a network was found")
    least_part_bound: float | None = fact(
        "central part of the vertical depth within which no network on this form diagram exists; null without a bound"
    )
    vertical_safety_factor: float | None = fact(
        "1 divided by the part of the vertical depth that the most central network needs; null without a demand. Where surfaces are "
        "steep (near the springing of a dome), this value exceeds the geometric safety factor, which refers to the thickness"
    )
    load_direction_deg: float = fact("direction of the horizontal load in plan", "deg")
    horizontal_load_g: float | None = fact(
        "greatest horizontal load that a network carries, divided by the weight; null if no network was found, or if the load has no "
        "limit. The load acts at the nodes. Inertia forces act at the centroids of the blocks, so the collapse load can be less",
        "g",
    )
    horizontal_load_bound_g: float | None = fact(
        "upper bound of `horizontal_load_g` for all networks on this form diagram; null if the load has no limit", "g"
    )
    weight_N: float = fact("weight of the structure", "N")
    equilibrium_residual: float = fact("greatest unbalanced force at a node, divided by the weight")
    thickness_m: float = fact("median thickness of the blocks, measured perpendicular to the branches of the most central network", "m")
    central_outside_m: float = fact(
        "greatest distance by which branches with a force pass outside the blocks between two nodes, in the most central network", "m"
    )
    least_outside_m: float | None = fact(
        "greatest distance by which branches pass outside the blocks, in the network of least thrust; null without this network", "m"
    )
    greatest_outside_m: float | None = fact(
        "greatest distance by which branches pass outside the blocks, in the network of greatest thrust; null without this network", "m"
    )
    horizontal_outside_m: float | None = fact(
        "greatest distance by which branches pass outside the blocks, in the network of greatest horizontal load; "
        "null without this network",
        "m",
    )
    least_friction: float | None = fact(
        "least coefficient of friction of the joints, for information only (sliding is not checked); null if sliding is excluded"
    )

    def leaves(self, outside: float | None) -> bool:
        """Whether branches leave the blocks by a distance [m] that counts; None: no network."""
        return outside is not None and outside > LEAVES * self.thickness_m

    def judged(self, demand: Demand) -> Verdict:
        """The part of the depth that the most central network needs against the whole; open where joints may slide, and where
        branches of this network leave the blocks."""
        part = self.least_part_of_depth
        if part > 1.0:
            return judge(
                f"No network found on this form diagram lies within the structure: the best network requires {part:.2f} times the depth.",
                outcome="open",
            )
        violated = []
        if self.least_friction is not None:
            violated.append(f"Sliding of the joints is not checked (coefficient of friction {self.least_friction:.3g}).")
        if self.leaves(self.central_outside_m):
            violated.append(
                f"Branches of the most central network pass outside the blocks by up to {1000.0 * self.central_outside_m:.3g} mm."
            )
        text = (
            f"A network on this form diagram stays within the middle {100.0 * part:.3g} % of the vertical depth. "
            "Where surfaces are steep, the network needs a greater part of the thickness."
        )
        return judge(text, part, 1.0, violated=violated)
