/* Seeded random numbers for generated earthquakes (thesis section 6.3.1: random phases). */
#include <gsl/gsl_rng.h>
#include <math.h>

#include "extrados_quake.h"

/* Mersenne twister. Its seed has 32 bits, so seeds drawn at random would make two of 10,000 motions equal in one
 * set out of a hundred: within a set the map from motion to seed is one to one instead. */
static uint32_t hash_set(uint64_t z) { /* splitmix64, Steele et al. 2014 */
  z += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (uint32_t)((z ^ (z >> 31)) >> 32);
}

static uint32_t permute(uint32_t z) { /* invertible on 32 bits: odd factors and shifted sums */
  z = (z ^ (z >> 16)) * 0x85ebca6bu;
  z = (z ^ (z >> 13)) * 0xc2b2ae35u;
  return z ^ (z >> 16);
}

int extrados_motion_phases(int64_t seed, int64_t index, int count, double *phase) {
  if (count < 0 || (count > 0 && !phase) || index < 0 || index > UINT32_MAX) return EXTRADOS_invalid_argument;
  gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
  if (!rng) return EXTRADOS_out_of_memory;
  const uint32_t own = permute((uint32_t)index ^ hash_set((uint64_t)seed));
  gsl_rng_set(rng, own);
  /* GSL reads seed 0 as its default, 4357: that motion takes a later part of the same stream. */
  for (int i = 0; own == 0 && i < 100000; i++) gsl_rng_get(rng);
  for (int i = 0; i < count; i++) phase[i] = 2.0 * M_PI * gsl_rng_uniform(rng);
  gsl_rng_free(rng);
  return EXTRADOS_ok;
}
