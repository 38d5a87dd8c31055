/* Every enumeration that crosses the border between languages: number, name, word.
 *
 * C takes its enums from here; fortran/lists_module.py writes the Fortran modules common_status (from the list
 * of codes) and common_lists (NAME_ENTRY, e.g. rocking_outcome_collapse); Python reads the compiled list at import
 * (extrados.core.lists) and knows no number of its own. The words are those of decks and results. */
#ifndef EXTRADOS_LISTS_H
#define EXTRADOS_LISTS_H

#include "extrados_status.h"

/* Kinds of object that live in the core behind a handle */
#define EXTRADOS_HANDLE_LIST(ENTRY) \
  ENTRY(1, motions, "set of ground motions") \
  ENTRY(2, rocking, "set of rocking bodies") \
  ENTRY(3, dem, "model of discrete elements") \
  ENTRY(4, sla, "model of sequentially linear analysis") \
  ENTRY(5, frame, "frame of macro-elements")

/* Kinds of rocking structure */
#define EXTRADOS_ROCKING_BODY_LIST(ENTRY) \
  ENTRY(1, arch, "arch") \
  ENTRY(2, block, "block") \
  ENTRY(3, table, "table") \
  ENTRY(4, restrained, "restrained") \
  ENTRY(5, soft_base, "soft-base") \
  ENTRY(6, watched, "watched") \
  ENTRY(7, stack, "stack")

#define EXTRADOS_ROCKING_OUTCOME_LIST(ENTRY) \
  ENTRY(0, no_hinging, "no-hinging") \
  ENTRY(1, recovery, "recovery") \
  ENTRY(2, collapse, "collapse")

#define EXTRADOS_ROCKING_EVENT_LIST(ENTRY) \
  ENTRY(1, uplift, "uplift") \
  ENTRY(2, impact, "impact") \
  ENTRY(3, peak, "peak") \
  ENTRY(4, rest, "rest") \
  ENTRY(5, collapse, "collapse")

/* Why a run of discrete elements ended */
#define EXTRADOS_DEM_STOP_LIST(ENTRY) \
  ENTRY(0, end, "end")             /* end time reached */ \
  ENTRY(1, collapse, "collapse")   /* a body moved farther than the collapse limit */ \
  ENTRY(2, rest, "rest")           /* nothing moves any more */ \
  ENTRY(3, left, "left")           /* a body left the domain */ \
  ENTRY(4, blow_up, "blow-up")     /* the energy ledger does not close */ \
  ENTRY(5, step, "step")           /* the step asked for is above the critical one */ \
  ENTRY(6, unsettled, "unsettled") /* a body falls under gravity */ \
  ENTRY(7, overlap, "overlap")     /* bodies overlap at the start */ \
  ENTRY(8, restless, "restless")   /* no rest under gravity in the steps given */

/* Rows of the energy ledger of discrete elements */
#define EXTRADOS_DEM_ENERGY_LIST(ENTRY) \
  ENTRY(1, kinetic, "kinetic") \
  ENTRY(2, potential, "potential") \
  ENTRY(3, elastic, "elastic") \
  ENTRY(4, friction, "friction") \
  ENTRY(5, damping, "damping") \
  ENTRY(6, mass_damping, "mass_damping") \
  ENTRY(7, work, "work") \
  ENTRY(8, residual, "residual") \
  ENTRY(9, leapfrog, "leapfrog")

/* Plane-stress elements; the number of a kind is that of its nodes */
#define EXTRADOS_SLA_ELEMENT_LIST(ENTRY) \
  ENTRY(3, t3, "T3") \
  ENTRY(4, q4, "Q4") \
  ENTRY(6, t6, "T6") \
  ENTRY(8, q8, "Q8")

/* Softening laws */
#define EXTRADOS_SLA_LAW_LIST(ENTRY) \
  ENTRY(1, linear, "linear") \
  ENTRY(2, exponential, "exponential") \
  ENTRY(3, hordijk, "hordijk") \
  ENTRY(4, yielding, "yielding")

/* How cracked material behaves: fixed orthogonal cracks, cracks that turn with the strain, one damage for all */
#define EXTRADOS_SLA_CRACKING_LIST(ENTRY) \
  ENTRY(1, orthotropic, "orthotropic") \
  ENTRY(2, rotating, "rotating") \
  ENTRY(3, isotropic, "isotropic")

/* What happens to a point in an event, by direction: n first crack's normal, s across it; last the steps of
 * sla_continuation */
#define EXTRADOS_SLA_EVENT_LIST(ENTRY) \
  ENTRY(1, tension, "tension n") \
  ENTRY(2, tension_s, "tension s") \
  ENTRY(3, compression, "compression n") \
  ENTRY(4, compression_s, "compression s") \
  ENTRY(5, close, "closing n") \
  ENTRY(6, close_s, "closing s") \
  ENTRY(7, open, "opening n") \
  ENTRY(8, open_s, "opening s") \
  ENTRY(9, wear, "cohesion") \
  ENTRY(10, slide, "sliding") \
  ENTRY(11, stick, "sticking") \
  ENTRY(12, newton, "Newton step") \
  ENTRY(13, staggered, "staggered step") \
  ENTRY(14, extrapolated, "implicit-explicit step") \
  ENTRY(15, unbalanced, "step out of balance") \
  ENTRY(16, dissipated, "arc-length step")

/* What happens after a tooth and where equilibrium is lost, see stop_rules in fortran/sla/state.f90 */
#define EXTRADOS_SLA_VARIANT_LIST(ENTRY) \
  ENTRY(0, load_unload, "load-unload") \
  ENTRY(1, proportional, "proportional") \
  ENTRY(2, force_release, "force-release")

/* Why a run of events ended */
#define EXTRADOS_SLA_STOP_LIST(ENTRY) \
  ENTRY(0, none, "") \
  ENTRY(1, mechanism, "mechanism") \
  ENTRY(2, unbounded, "no point limits the load") \
  ENTRY(3, all_empty, "all intervals are empty") \
  ENTRY(4, displacement, "target displacement") \
  ENTRY(5, load, "target load") \
  ENTRY(6, fraction, "load fell below the fraction of its peak") \
  ENTRY(7, lost, "no equilibrium is found any more") \
  ENTRY(8, far, "the displacement exceeds a tenth of the structure's size") \
  ENTRY(9, axial, "axial capacity lost")

/* Where the layers of a shell lie: Gauss's points, or Lobatto's with one on each face */
#define EXTRADOS_SHELL_THROUGH_LIST(ENTRY) \
  ENTRY(1, gauss, "gauss") \
  ENTRY(2, lobatto, "lobatto")

/* Envelopes of generated motions (c/quake/envelope.c) */
#define EXTRADOS_ENVELOPE_LIST(ENTRY) \
  ENTRY(1, arctangent, "arctangent") \
  ENTRY(2, trapezoid, "trapezoid") \
  ENTRY(3, jennings, "jennings") \
  ENTRY(4, saragoni_hart, "saragoni-hart")

/* How the lines of a generated motion share the band */
#define EXTRADOS_SPACING_LIST(ENTRY) \
  ENTRY(1, log, "log") \
  ENTRY(2, uniform, "uniform")

/* How Fourier amplitudes become amplitudes of lines */
#define EXTRADOS_SCALING_LIST(ENTRY) \
  ENTRY(1, thesis, "thesis") \
  ENTRY(2, fourier, "fourier") \
  ENTRY(3, energy, "energy")

/* Shear strength of a macro-element */
#define EXTRADOS_FRAME_SHEAR_LIST(ENTRY) \
  ENTRY(0, none, "none") \
  ENTRY(1, friction, "mohr-coulomb") \
  ENTRY(2, diagonal, "turnsek-cacovic") \
  ENTRY(3, least, "least") \
  ENTRY(4, damage, "damage") \
  ENTRY(5, reversed, "reversed")

/* How far a macro-element has come; the greater number counts */
#define EXTRADOS_FRAME_STATE_LIST(ENTRY) \
  ENTRY(0, sound, "elastic") \
  ENTRY(1, cracked, "cracked") \
  ENTRY(2, flexure, "at flexural strength") \
  ENTRY(3, shear, "at shear strength") \
  ENTRY(4, failed_flexure, "drift limit in flexure") \
  ENTRY(5, failed_shear, "drift limit in shear")

/* Why a push of a frame ended */
#define EXTRADOS_FRAME_STOP_LIST(ENTRY) \
  ENTRY(0, target, "target displacement") \
  ENTRY(1, drop, "loss of strength") \
  ENTRY(2, weight, "no equilibrium under the weight") \
  ENTRY(3, step, "no equilibrium at the least step") \
  ENTRY(4, steps, "number of steps") \
  ENTRY(5, cancelled, "interrupted")

/* The list of lists */
#define EXTRADOS_LISTS(LIST) \
  LIST(status, EXTRADOS_STATUS_LIST) \
  LIST(handle, EXTRADOS_HANDLE_LIST) \
  LIST(rocking_body, EXTRADOS_ROCKING_BODY_LIST) \
  LIST(rocking_outcome, EXTRADOS_ROCKING_OUTCOME_LIST) \
  LIST(rocking_event, EXTRADOS_ROCKING_EVENT_LIST) \
  LIST(dem_stop, EXTRADOS_DEM_STOP_LIST) \
  LIST(dem_energy, EXTRADOS_DEM_ENERGY_LIST) \
  LIST(sla_element, EXTRADOS_SLA_ELEMENT_LIST) \
  LIST(sla_law, EXTRADOS_SLA_LAW_LIST) \
  LIST(sla_cracking, EXTRADOS_SLA_CRACKING_LIST) \
  LIST(sla_event, EXTRADOS_SLA_EVENT_LIST) \
  LIST(sla_variant, EXTRADOS_SLA_VARIANT_LIST) \
  LIST(sla_stop, EXTRADOS_SLA_STOP_LIST) \
  LIST(frame_shear, EXTRADOS_FRAME_SHEAR_LIST) \
  LIST(frame_state, EXTRADOS_FRAME_STATE_LIST) \
  LIST(frame_stop, EXTRADOS_FRAME_STOP_LIST) \
  LIST(shell_through, EXTRADOS_SHELL_THROUGH_LIST) \
  LIST(envelope, EXTRADOS_ENVELOPE_LIST) \
  LIST(spacing, EXTRADOS_SPACING_LIST) \
  LIST(scaling, EXTRADOS_SCALING_LIST)

#define EXTRADOS_HANDLE_ENUM(code, name, word) EXTRADOS_handle_##name = code,
enum extrados_handle { EXTRADOS_HANDLE_LIST(EXTRADOS_HANDLE_ENUM) };
#define EXTRADOS_ENVELOPE_ENUM(code, name, word) EXTRADOS_envelope_##name = code,
enum extrados_envelope { EXTRADOS_ENVELOPE_LIST(EXTRADOS_ENVELOPE_ENUM) };
#define EXTRADOS_SPACING_ENUM(code, name, word) EXTRADOS_spacing_##name = code,
enum extrados_spacing { EXTRADOS_SPACING_LIST(EXTRADOS_SPACING_ENUM) };
#define EXTRADOS_SCALING_ENUM(code, name, word) EXTRADOS_scaling_##name = code,
enum extrados_scaling { EXTRADOS_SCALING_LIST(EXTRADOS_SCALING_ENUM) };

#endif
