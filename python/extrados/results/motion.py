"""Results of studies of ground motions: motion, shake-table."""

from typing import Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.rocking import PrimaryImpulse
from extrados.results.verdict import Demand, KindResults, Verdict, judge


class Impulse(PrimaryImpulse):
    """One of the strongest impulses of a motion."""

    explained: float = fact("share of the squared acceleration of the whole motion that it explains")


class WaveletPulse(ResultModel):
    """The strongest velocity pulse of a motion (Baker 2007)."""

    indicator: float = fact("pulse indicator: above 0.85 pulse-like, below 0.15 not", source="Baker 2007")
    period_s: float = fact("period of the pulse", "s")
    peak_velocity_m_s: float = fact("its peak velocity", "m/s")
    pgv_ratio: float = fact("peak velocity of the motion less the pulse, over that of the motion")
    energy_ratio: float = fact("energy of the motion less the pulse, over that of the motion")
    early: bool = fact("whether it arrives early in the motion")
    pulse_like: bool = fact("whether all of Baker's conditions are met")
    fails: list[str] = fact("those that are not, in words")


class DirectedPulse(ResultModel):
    """A velocity pulse in its own direction (Shahi and Baker 2014)."""

    indicator: float = fact("pulse indicator: above 0 pulse-like", source="Shahi and Baker 2014")
    period_s: float = fact("period of the pulse", "s")
    angle_deg: float = fact("from the first component to the direction of the pulse, as `angle` of a record", "deg")
    pgv_m_s: float = fact("peak velocity of the motion in that direction", "m/s")
    pgv_ratio: float = fact("peak velocity of the motion less the pulse, over that of the motion")
    energy_ratio: float = fact("energy of the motion less the pulse, over that of the motion")
    energy_before: float = fact("share of the energy of the motion before the pulse begins; from 0.17 on the pulse is late")
    pulse_like: bool = fact("whether the indicator is above 0 and the pulse is not late")


class OneMotion(KindResults):
    """motion: one ground motion in depth."""

    title: str = maybe("of a record: the event, from its file")
    station: str = maybe("of a record: station and component, from its file")
    pga_g: float = fact("greatest horizontal acceleration", "g")
    pga_time_s: float = fact("when it comes", "s")
    pgv_m_s: float = fact("greatest velocity", "m/s")
    pgd_m: float = fact("greatest displacement", "m")
    pgv_over_pga_s: float | None = fact("greatest velocity over greatest acceleration", "s")
    arias_m_s: float = fact("Arias intensity", "m/s")
    cav_m_s: float = fact("cumulative absolute velocity", "m/s")
    duration_5_95_s: float = fact("time in which the Arias intensity grows from 5 to 95 %", "s")
    duration_5_75_s: float = fact("time in which it grows from 5 to 75 %", "s")
    housner_intensity_m: float = fact("integral of the 5 % PSV from 0.1 to 2.5 s", "m", source="Housner 1952")
    predominant_period_s: float = fact("period of the greatest 5 % PSA", "s")
    velocity_period_s: float = fact("period of the greatest 5 % PSV", "s")
    mean_period_s: float | None = fact("mean period of the Fourier spectrum", "s", source="Rathje et al. 1998")
    points: int = fact("number of samples")
    time_step_s: float = fact("time between them", "s")
    primary_impulse: Impulse | None = fact("the single sine that explains most of it", source="thesis 5.3.2")
    impulses: list[Impulse] = fact("the strongest impulses")
    wavelet_pulse: WaveletPulse = fact("the strongest velocity pulse", source="Baker 2007")
    directed_pulses: list[DirectedPulse] = maybe(
        "of a record with both horizontal components: up to five candidates over all directions, strongest first",
        source="Shahi and Baker 2014",
    )
    vertical_pga_g: float = maybe("greatest vertical acceleration", "g")
    rotd50_pga_g: float | None = maybe("median over all directions of the greatest acceleration", "g", source="Boore 2010")
    rotd100_pga_g: float | None = maybe("greatest over all directions", "g", source="Boore 2010")
    rotd_damping: float = maybe("damping ratio of the spectra over all directions")

    def judged(self, demand: Demand) -> Verdict:
        """The peak acceleration; no building is asked."""
        return judge(f"The motion peaks at {self.pga_g:.3g} g.", self.pga_g, None, "g")


class MotionSet(KindResults):
    """motion: the statistics of a set of motions."""

    count: int = fact("number of motions")
    damping: float = fact("damping ratio of the spectra")
    median_pga_g: float = fact("median peak acceleration", "g")
    median_pgv_m_s: float = fact("median peak velocity", "m/s")
    median_pgd_m: float = fact("median peak displacement", "m")
    median_arias_m_s: float = fact("median Arias intensity", "m/s")
    median_cav_m_s: float = fact("median cumulative absolute velocity", "m/s")
    median_duration_5_95_s: float = fact("median time in which the Arias intensity grows from 5 to 95 %", "s")
    largest_pga_g: float = fact("greatest peak acceleration", "g")
    largest_pgv_m_s: float = fact("greatest peak velocity", "m/s")
    median_impulse_amplitude_g: float | None = fact("median amplitude of the primary impulses", "g")
    median_impulse_period_s: float | None = fact("median period of the primary impulses", "s")
    time_step_s: float = fact("time between samples of the first motion", "s")
    mmi: float = maybe("of generated motions: their intensity")
    seed: int = maybe("of generated and compatible motions: the seed")
    expected_pga_g: float = maybe("median peak acceleration observed at that intensity", "g", source="Worden et al. 2012")
    expected_pgv_m_s: float = maybe("median peak velocity observed", "m/s", source="Worden et al. 2012")
    expected_arias_m_s: float = maybe("Arias intensity of the target spectrum", "m/s")
    pga_over_expected: float = maybe("median peak acceleration over the expected one")
    pgv_over_expected: float = maybe("median peak velocity over the expected one")
    arias_over_expected: float = maybe("median Arias intensity over the expected one")
    largest_deviation: float = maybe("of compatible motions: greatest deviation from the target spectrum, as a share")
    mean_over_target_least: float = maybe("least ratio of the mean spectrum to the target")
    shortest_s: float = maybe("shortest period of the band that is matched", "s")
    longest_s: float = maybe("longest period of the band that is matched", "s")

    def judged(self, demand: Demand) -> Verdict:
        """The median peak acceleration; no building is asked."""
        text = f"The {self.count} motions have a median peak acceleration of {self.median_pga_g:.3g} g."
        return judge(text, self.median_pga_g, None, "g")


MotionStudy = OneMotion | MotionSet


class UseOfLimits(ResultModel):
    """How much of a shake table's limits a motion needs; 1 is all of it."""

    mass_kg: float = fact("moving mass", "kg")
    stroke: float = fact("displacement over the stroke")
    flow: float = fact("velocity over the greatest one")
    force: float = fact("force over the greatest one")
    governing: Literal["stroke", "flow", "force"] = fact("the limit that is nearest, or exceeded most")


class ShakeTable(KindResults):
    """shake-table: what a table can play, and whether a motion fits."""

    max_velocity_m_s: float = fact("greatest velocity of the table", "m/s")
    masses_kg: list[float] = fact("moving masses, table included", "kg")
    stroke_to_flow_Hz: float = fact("frequency at which the flow takes over from the stroke", "Hz", source="thesis Fig. C-1")
    flow_to_force_Hz: list[float] = fact("frequency at which the force takes over, for each mass", "Hz")
    fits: bool = maybe("whether the motion fits with every mass")
    low_cut_Hz: float = maybe("corner of the high-pass of the drive", "Hz")
    peak_displacement_m: float = maybe("greatest displacement of the drive", "m")
    peak_velocity_m_s: float = maybe("greatest velocity of the drive", "m/s")
    peak_acceleration_g: float = maybe("greatest acceleration of the drive", "g")
    motion_peak_acceleration_g: float = maybe("greatest acceleration of the motion as given", "g")
    rms_taken_out_ratio: float = maybe("removed by the high-pass, over the motion, root mean squares")
    use_of_limits: list[UseOfLimits] = maybe("share of the limits that the motion needs, for each mass")
    time_scale: float = maybe("factor on time that gives the best fit")
    amplitude_factor: float = maybe("factor on the acceleration that gives the best fit")
    played_displacement_m: float = maybe("greatest displacement of the scaled motion", "m")
    played_velocity_m_s: float = maybe("greatest velocity so scaled", "m/s")
    played_acceleration_g: float = maybe("greatest acceleration so scaled", "g")
    rest_error_m: float = maybe("displacement left at the ends of the drive", "m")

    def judged(self, demand: Demand) -> Verdict:
        """The share of its limits that the motion needs; about the table, not a building."""
        if self.use_of_limits is None:
            return judge("The deck holds no motion for the table to play.")
        most = max(max(u.stroke, u.flow, u.force) for u in self.use_of_limits)
        text = "fits the table" if self.fits else "does not fit the table"
        return judge(f"The motion {text}: it needs {most:.3g} of a limit.", most, 1.0, "", "not-applicable")
