/* The one list of status codes. C uses the enum; the build writes Fortran's
 * common_status from the same lines; Python reads them back through api_status.
 * Codes below 100 are errors (the outputs must not be used); 130 is a cancelled
 * run, whose outputs are valid up to the point that was reached. */
#ifndef EXTRADOS_STATUS_H
#define EXTRADOS_STATUS_H

#define EXTRADOS_STATUS_LIST(ENTRY) \
  ENTRY(0, ok, "done") \
  ENTRY(1, invalid_argument, "an argument is outside its range") \
  ENTRY(2, not_finite, "a number is not finite") \
  ENTRY(3, out_of_memory, "not enough memory") \
  ENTRY(4, not_positive_definite, "the stiffness matrix is not positive definite: a mechanism") \
  ENTRY(5, singular, "a small system of equations is singular") \
  ENTRY(6, too_many_steps, "the integrator needed too many steps") \
  ENTRY(7, step_too_small, "the integrator cannot reach its tolerance: the step vanished") \
  ENTRY(8, bad_geometry, "the geometry is impossible") \
  ENTRY(9, library_failed, "a numerical library reported a failure") \
  ENTRY(10, snap_back, "the crack band is wider than the fracture energy allows: the law snaps back") \
  ENTRY(11, too_large, "the factor would not fit into the memory allowed") \
  ENTRY(12, beyond_strength, "the constant loads alone exceed the strength") \
  ENTRY(13, closed_handle, "it was closed, or never made by this process") \
  ENTRY(14, wrong_handle, "the handle is that of another kind of object") \
  ENTRY(15, busy, "another call is using it") \
  ENTRY(16, not_ready, "it is not built far enough for this call") \
  ENTRY(17, bad_index, "an index points to nothing") \
  ENTRY(20, energy_lost, "the tables of a mechanism do not keep the energy of its motion") \
  ENTRY(22, no_pattern, "no set of pressing joints fits the impact") \
  ENTRY(130, cancelled, "cancelled")

#define EXTRADOS_ENUM_ENTRY(code, name, text) EXTRADOS_##name = code,
enum extrados_status { EXTRADOS_STATUS_LIST(EXTRADOS_ENUM_ENTRY) };
#undef EXTRADOS_ENUM_ENTRY

#endif
