/* The inner loop of response spectra: eight linear oscillators side by side through one motion. */
#include <math.h>

#include "extrados_quake.h"

enum { L = EXTRADOS_LANES };

struct step {
  double uu[L], uv[L], u0[L], u1[L], vu[L], vv[L], v0[L], v1[L], stiff[L], viscous[L];
};

/* Advances displacement u and velocity v through samples motion[0] .. motion[points - 1], each interval cut into
 * `parts`, and keeps the greatest |u|, |v| and |stiff u + viscous v|. */
EXTRADOS_ANY_WIDTH
void extrados_oscillator_lanes(int points, const double *motion, int parts, const double *coefficients, double *state,
                               double *most) {
  const struct step k = *(const struct step *)coefficients;
  double u[L], v[L], most_u[L], most_v[L], most_a[L];
  for (int l = 0; l < L; l++) {
    u[l] = state[l];
    v[l] = state[L + l];
    most_u[l] = most[l];
    most_v[l] = most[L + l];
    most_a[l] = most[2 * L + l];
  }
  for (int i = 0; i + 1 < points; i++) {
    const double rise = (motion[i + 1] - motion[i]) / parts;
    for (int j = 0; j < parts; j++) {
      const double p0 = motion[i] + j * rise, p1 = motion[i] + (j + 1) * rise;
#pragma omp simd
      for (int l = 0; l < L; l++) {
        const double x = (k.uu[l] * u[l] + k.uv[l] * v[l]) + (k.u0[l] * p0 + k.u1[l] * p1);
        const double y = (k.vu[l] * u[l] + k.vv[l] * v[l]) + (k.v0[l] * p0 + k.v1[l] * p1);
        const double size_u = fabs(x), size_v = fabs(y), size_a = fabs(k.stiff[l] * x + k.viscous[l] * y);
        u[l] = x;
        v[l] = y;
        most_u[l] = size_u > most_u[l] ? size_u : most_u[l];
        most_v[l] = size_v > most_v[l] ? size_v : most_v[l];
        most_a[l] = size_a > most_a[l] ? size_a : most_a[l];
      }
    }
  }
  for (int l = 0; l < L; l++) {
    state[l] = u[l];
    state[L + l] = v[l];
    most[l] = most_u[l];
    most[L + l] = most_v[l];
    most[2 * L + l] = most_a[l];
  }
}
