/* Seeded random numbers for generated earthquakes (thesis section 6.3.1: random phases). */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_rng.h>
#include <math.h>

#include "extrados.h"

/* GSL's default handler aborts the process; called once when the module loads. */
void extrados_library_init(void) { gsl_set_error_handler_off(); }

/* Mersenne twister. GSL takes an unsigned long seed and maps 0 to its own default (4357), so that
 * seeds 0 and 4357 would give one motion: the seed is mixed first (splitmix64, Steele et al. 2014). */
static unsigned long mix(uint64_t z) {
  z += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (unsigned long)((z ^ (z >> 31)) & 0xffffffffu);
}

int extrados_random_phases(int64_t seed, int64_t count, double *phase) {
  if (count < 0 || (count > 0 && !phase)) return EXTRADOS_invalid_argument;
  gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
  if (!rng) return EXTRADOS_out_of_memory;
  gsl_rng_set(rng, mix((uint64_t)seed));
  for (int64_t i = 0; i < count; i++) phase[i] = 2.0 * M_PI * gsl_rng_uniform(rng);
  gsl_rng_free(rng);
  return EXTRADOS_ok;
}
