"""The discrete-element model of a deck: bodies, and joints by the rules and exceptions of [joints]."""

import itertools
from dataclasses import replace

import numpy as np

from extrados.analyses.dem import impact_rules
from extrados.analyses.dem.calibration import beta_for_restitution
from extrados.analyses.dem.model import JointValues, Model
from extrados.analyses.dem.tables import Dem, DemTable, SpatialDem
from extrados.analyses.dem.ties import element_ties, section_strands
from extrados.model.geometry.assembly import GROUND
from extrados.model.geometry.water import water_pressure
from extrados.model.structures.arch import ArchAssembly
from extrados.views.building import Building
from extrados.views.rockers.arch import ArchModel


def joint_values(building: Building, rigid: bool = False) -> JointValues:
    """Properties of all joints by the rules and exceptions of [joints]; Refused where the deck names an unknown joint. rigid: for
    contacts without springs, whose damping is not calibrated."""
    assembly, joints = building.blocks(), building.joints
    length = impact_rules.joint_lengths(assembly)
    elastic = impact_rules.joint_stiffness(building.material.young, length, assembly.length, joints.stiffness_rule)
    given = building.joint_property("normal_stiffness")
    stiffness = np.where(np.isnan(given), elastic, given)
    if building.supports.stiffness is not None:
        grounded = (assembly.a == GROUND) | (assembly.b == GROUND)
        series = 1.0 / (1.0 / stiffness + 1.0 / building.supports.stiffness)
        stiffness = np.where(grounded, series, stiffness)
    impact = impact_rules.joint_impact(assembly, stiffness)
    # The highest frequency of its kind: the smallest block sets the least damping (thesis 7.4.4).
    beta = joints.beta
    wanted = joints.beta is None and joints.damping == "restitution"
    if beta is None:
        rule = "edge" if wanted else joints.damping
        beta = impact_rules.damping_constant(float(impact.of(rule).max()), joints.damping_ratio)
    shear = np.full_like(stiffness, joints.shear_stiffness) if joints.shear_stiffness else stiffness * joints.shear_ratio
    values = JointValues(
        stiffness,
        shear,
        building.joint_property("friction"),
        building.joint_property("cohesion"),
        building.joint_property("tension"),
        beta,
        impact,
        length,
    )
    if wanted and not rigid:
        return replace(values, beta=beta_for_restitution(building, values))
    return values


def make_model(building: Building, options: DemTable) -> Model:
    """The model of a section; Refused where a block has no area or crosses itself."""
    assembly = building.blocks()
    groups: tuple[tuple[int, ...], ...] = ()
    if options.merge == "three-bars":
        assert isinstance(assembly, ArchAssembly)
        joint = ArchModel(assembly).four_hinge.joint
        groups = tuple(tuple(range(a, b)) for a, b in itertools.pairwise(joint))
    rigid = building.rigid(groups, options.floor)
    ties = element_ties(building, section_strands(building), rigid.body_of_block, options.has_rates)
    crushes = isinstance(options, SpatialDem) and options.crushing
    strength = building.material.compressive_strength if crushes else None
    asked = options.water if isinstance(options, Dem) else None
    water = None if asked is None else water_pressure(assembly, asked.level, asked.side, asked.uplift, asked.density)
    return Model(assembly, rigid, joint_values(building), ties, strength or 0.0, water)
