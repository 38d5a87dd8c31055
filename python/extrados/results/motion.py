"""Results of studies of ground motions: motion, shake-table."""

from typing import Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.rocking import PrimaryImpulse
from extrados.results.verdict import Demand, KindResults, Verdict, judge


class Impulse(PrimaryImpulse):
    """One of the strongest impulses of a motion."""

    explained: float = fact("share of the integral of the squared acceleration of the motion that this impulse explains")


class WaveletPulse(ResultModel):
    """The strongest velocity pulse of a motion (Baker 2007)."""

    indicator: float = fact("pulse indicator: above 0.85 the motion is pulse-like, below 0.15 it is not", source="Baker 2007")
    period_s: float = fact("period of the pulse", "s")
    peak_velocity_m_s: float = fact("peak velocity of the pulse", "m/s")
    pgv_ratio: float = fact("peak velocity of the motion without the pulse, divided by that of the whole motion")
    energy_ratio: float = fact("energy of the motion without the pulse, divided by that of the whole motion")
    early: bool = fact("whether the pulse arrives early in the motion")
    pulse_like: bool = fact("whether all conditions of Baker for a pulse-like motion are satisfied")
    fails: list[str] = fact("conditions of Baker that are not satisfied, in words")


class DirectedPulse(ResultModel):
    """A velocity pulse in its own direction (Shahi and Baker 2014)."""

    indicator: float = fact("pulse indicator: above 0, the motion is pulse-like", source="Shahi and Baker 2014")
    period_s: float = fact("period of the pulse", "s")
    angle_deg: float = fact(
        "angle from the first component to the direction of the pulse (measured like the key `angle` of a record)", "deg"
    )
    pgv_m_s: float = fact("peak velocity of the motion in the direction of the pulse", "m/s")
    pgv_ratio: float = fact("peak velocity of the motion without the pulse, divided by that of the whole motion")
    energy_ratio: float = fact("energy of the motion without the pulse, divided by that of the whole motion")
    energy_before: float = fact("share of the energy of the motion before the pulse begins; if it is 0.17 or more, the pulse is late")
    pulse_like: bool = fact("whether the indicator is above 0 and the pulse is not late")


class OneMotion(KindResults):
    """motion: one ground motion in depth."""

    title: str = maybe("for a record: name of the event, from the file")
    station: str = maybe("for a record: station and component, from the file")
    pga_g: float = fact("greatest horizontal acceleration", "g")
    pga_time_s: float = fact("time of the greatest horizontal acceleration", "s")
    pgv_m_s: float = fact("greatest velocity", "m/s")
    pgd_m: float = fact("greatest displacement", "m")
    pgv_over_pga_s: float | None = fact("greatest velocity over greatest acceleration", "s")
    arias_m_s: float = fact("Arias intensity", "m/s")
    cav_m_s: float = fact("cumulative absolute velocity", "m/s")
    duration_5_95_s: float = fact("duration in which the Arias intensity grows from 5 to 95 %", "s")
    duration_5_75_s: float = fact("duration in which the Arias intensity grows from 5 to 75 %", "s")
    housner_intensity_m: float = fact(
        "Housner intensity: integral of the pseudo-velocity spectrum (5 % damping) from 0.1 to 2.5 s", "m", source="Housner 1952"
    )
    predominant_period_s: float = fact("period at which the pseudo-acceleration spectrum (5 % damping) has its maximum", "s")
    velocity_period_s: float = fact("period at which the pseudo-velocity spectrum (5 % damping) has its maximum", "s")
    mean_period_s: float | None = fact("mean period of the Fourier spectrum", "s", source="Rathje et al. 1998")
    points: int = fact("number of samples")
    time_step_s: float = fact("time step between samples", "s")
    primary_impulse: Impulse | None = fact("the single sine that explains the greatest share of the motion", source="thesis 5.3.2")
    impulses: list[Impulse] = fact("the strongest impulses")
    wavelet_pulse: WaveletPulse = fact("the strongest velocity pulse", source="Baker 2007")
    directed_pulses: list[DirectedPulse] = maybe(
        "for a record with both horizontal components: up to five candidate pulses over all directions, the strongest first",
        source="Shahi and Baker 2014",
    )
    vertical_pga_g: float = maybe("greatest vertical acceleration", "g")
    rotd50_pga_g: float | None = maybe("median, over all directions, of the peak acceleration", "g", source="Boore 2010")
    rotd100_pga_g: float | None = maybe("greatest peak acceleration over all directions", "g", source="Boore 2010")
    rotd_damping: float = maybe("damping ratio of the spectra for all directions")

    def judged(self, demand: Demand) -> Verdict:
        """The peak acceleration; no building is asked."""
        return judge(f"The peak acceleration of the motion is {self.pga_g:.3g} g.", self.pga_g, None, "g")


class MotionSet(KindResults):
    """motion: the statistics of a set of motions."""

    count: int = fact("number of motions")
    damping: float = fact("damping ratio of the spectra")
    median_pga_g: float = fact("median peak acceleration", "g")
    median_pgv_m_s: float = fact("median peak velocity", "m/s")
    median_pgd_m: float = fact("median peak displacement", "m")
    median_arias_m_s: float = fact("median Arias intensity", "m/s")
    median_cav_m_s: float = fact("median cumulative absolute velocity", "m/s")
    median_duration_5_95_s: float = fact("median duration in which the Arias intensity grows from 5 to 95 %", "s")
    largest_pga_g: float = fact("greatest peak acceleration", "g")
    largest_pgv_m_s: float = fact("greatest peak velocity", "m/s")
    median_impulse_amplitude_g: float | None = fact("median amplitude of the primary impulses", "g")
    median_impulse_period_s: float | None = fact("median period of the primary impulses", "s")
    time_step_s: float = fact("time step of the first motion", "s")
    mmi: float = maybe("for generated motions: macroseismic intensity")
    seed: int = maybe("for generated and compatible motions: the seed of the random numbers")
    expected_pga_g: float = maybe(
        "for generated motions: median peak acceleration observed in earthquakes of this intensity", "g", source="Worden et al. 2012"
    )
    expected_pgv_m_s: float = maybe("median peak velocity observed", "m/s", source="Worden et al. 2012")
    expected_arias_m_s: float = maybe("Arias intensity of the target spectrum", "m/s")
    pga_over_expected: float = maybe("median peak acceleration of the motions, divided by the expected value")
    pgv_over_expected: float = maybe("median peak velocity of the motions, divided by the expected value")
    arias_over_expected: float = maybe("median Arias intensity of the motions, divided by the expected value")
    largest_deviation: float = maybe("for compatible motions: greatest relative deviation from the target spectrum")
    mean_over_target_least: float = maybe("least ratio, over the periods, of the mean spectrum to the target spectrum")
    shortest_s: float = maybe("shortest period of the band in which the spectrum is matched", "s")
    longest_s: float = maybe("longest period of the band in which the spectrum is matched", "s")

    def judged(self, demand: Demand) -> Verdict:
        """The median peak acceleration; no building is asked."""
        text = f"The {self.count} motions have a median peak acceleration of {self.median_pga_g:.3g} g."
        return judge(text, self.median_pga_g, None, "g")


MotionStudy = OneMotion | MotionSet


class UseOfLimits(ResultModel):
    """How much of a shake table's limits a motion needs; 1 is all of it."""

    mass_kg: float = fact("moving mass", "kg")
    stroke: float = fact("displacement of the motion, divided by the stroke of the table")
    flow: float = fact("velocity of the motion, divided by the greatest velocity of the table")
    force: float = fact("force that the motion requires, divided by the greatest force of the table")
    governing: Literal["stroke", "flow", "force"] = fact(
        "limit of the table that governs: the motion comes nearest to this limit, or exceeds it most"
    )


class ShakeTable(KindResults):
    """shake-table: what a table can play, and whether a motion fits."""

    max_velocity_m_s: float = fact("greatest velocity of the table", "m/s")
    masses_kg: list[float] = fact("moving masses, table included", "kg")
    stroke_to_flow_Hz: float = fact(
        "frequency above which the limit of flow governs instead of the limit of stroke", "Hz", source="thesis Fig. C-1"
    )
    flow_to_force_Hz: list[float] = fact(
        "frequency above which the limit of force governs instead of the limit of flow, for each mass", "Hz"
    )
    fits: bool = maybe("whether the table can play the motion with each of the masses")
    low_cut_Hz: float = maybe("corner frequency of the high-pass filter of the drive", "Hz")
    peak_displacement_m: float = maybe("greatest displacement of the drive", "m")
    peak_velocity_m_s: float = maybe("greatest velocity of the drive", "m/s")
    peak_acceleration_g: float = maybe("greatest acceleration of the drive", "g")
    motion_peak_acceleration_g: float = maybe("greatest acceleration of the motion as given", "g")
    rms_taken_out_ratio: float = maybe("part of the motion that the high-pass filter removes, divided by the motion (root mean squares)")
    use_of_limits: list[UseOfLimits] = maybe("demand of the motion divided by each limit of the table; one row for each mass")
    time_scale: float = maybe("factor on time with which the motion fits the table best")
    amplitude_factor: float = maybe("factor on acceleration with which the motion fits the table best")
    played_displacement_m: float = maybe("greatest displacement of the scaled motion", "m")
    played_velocity_m_s: float = maybe("greatest velocity of the scaled motion", "m/s")
    played_acceleration_g: float = maybe("greatest acceleration of the scaled motion", "g")
    rest_error_m: float = maybe(
        "greatest displacement of the drive signal at its start and its end; 0 for a table that starts and ends in its zero position", "m"
    )

    def judged(self, demand: Demand) -> Verdict:
        """The share of its limits that the motion needs; about the table, not a building."""
        if self.use_of_limits is None:
            return judge("The deck gives no motion that the table could play.")
        most = max(max(u.stroke, u.flow, u.force) for u in self.use_of_limits)
        text = "fits the table" if self.fits else "does not fit the table"
        return judge(
            f"The motion {text}: it needs {100.0 * most:.3g} % of the governing limit.", most, 1.0, "of the limit", "not-applicable"
        )
