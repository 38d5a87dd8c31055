"""Where keys of earlier versions stand now: an old deck is told the new place of each."""

_FOR_ONE = "for this analysis only, in [analysis.{}]"


def _joint(name: str) -> str:
    return f"[joints] {name} (or, {_FOR_ONE.format('joints')})"


def _material(name: str) -> str:
    return f"[material] {name} (or, {_FOR_ONE.format('material')})"


def _mesh(name: str) -> str:
    return f"{name} in [analysis.mesh], which gives the elements of an sla analysis"


#: (section, key) -> the new place in words
MOVED: dict[tuple[str, str], str] = {
    ("structure", "density"): "[material] density",
    ("structure", "material"): "the table [material]",
    ("structure", "materials"): "the tables [materials.NAME]",
    ("structure", "supports"): "[[supports.held]]",
    ("structure", "restitution"): "[joints] restitution",
    ("structure", "energy_ratio"): "[joints] energy_ratio",
    ("structure", "initial_rotation_ratio"): "[initial] rotation_ratio",
    ("structure", "form"): "form in the [[analysis]] table",
    ("structure", "mesh"): _mesh("pattern"),
    **{("structure", name): _mesh(name) for name in ("size", "element", "seed", "refine", "lines_x", "lines_y", "selective")},
    ("analysis", "friction"): _joint("friction"),
    ("analysis", "cohesion"): _joint("cohesion"),
    ("analysis", "tension"): _joint("tension"),
    ("analysis", "strength"): _material("compressive_strength"),
    ("analysis", "compressive_strength"): _material("compressive_strength"),
    ("analysis", "youngs_modulus"): _material("young"),
    ("analysis", "joint_stiffness"): _joint("normal_stiffness"),
    ("analysis", "support_stiffness"): "[supports] stiffness",
    ("analysis", "shear_ratio"): _joint("shear_ratio"),
    ("analysis", "convention"): _joint("stiffness_rule"),
    ("analysis", "joint_types"): "[[joints.types]]",
    ("analysis", "damping"): _joint("damping"),
    ("analysis", "damping_ratio"): _joint("damping_ratio"),
    ("analysis", "beta"): _joint("beta"),
    ("analysis", "worn_corners"): _joint("worn_corners"),
    ("analysis", "restitution"): _joint("restitution"),
    ("analysis", "support_movements"): "[[initial.movements]]",
    ("analysis", "initial_rotation_ratio"): f"[initial] rotation_ratio (or, {_FOR_ONE.format('initial')})",
}
