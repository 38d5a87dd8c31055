/* How strong a generated motion is over time, between 0 and 1. */
#include <math.h>

#include "extrados_quake.h"

/* Thesis Eq. 6.7. parameter: start, duration, width (0.1 s in the thesis). */
static double arctangent(const double *p, double t) {
  return (atan((t - p[0]) / p[2]) - atan((t - p[0] - p[1]) / p[2])) / M_PI;
}

/* Hou (1968): straight rise, level, straight decay. parameter: start, duration, rise, decay. */
static double trapezoid(const double *p, double t) {
  const double s = t - p[0], left = p[1] - s;
  if (s < 0.0 || left < 0.0) return 0.0;
  return fmin(1.0, fmin(p[2] > 0.0 ? s / p[2] : 1.0, p[3] > 0.0 ? left / p[3] : 1.0));
}

/* Jennings, Housner and Tsai (1968): parabola, level, exponential decay.
 * parameter: start, duration (end of the level), rise, rate of decay [1/s]. */
static double jennings(const double *p, double t) {
  const double s = t - p[0];
  if (s < 0.0) return 0.0;
  if (s < p[2]) return (s / p[2]) * (s / p[2]);
  return s <= p[1] ? 1.0 : exp(-p[3] * (s - p[1]));
}

/* Saragoni and Hart (1974) as parametrised by Boore (2003): 1 at the fraction p[2] of the duration, falling to
 * p[3] at its end. parameter: start, duration, position of the peak, level at the end. */
static double saragoni_hart(const double *p, double t) {
  const double s = (t - p[0]) / p[1], peak = p[2];
  if (s <= 0.0) return 0.0;
  const double b = -peak * log(p[3]) / (1.0 + peak * (log(peak) - 1.0));
  return pow(s / peak, b) * exp(b * (1.0 - s / peak));
}

int extrados_envelope(int kind, const double p[4], int points, double step, double *value) {
  double (*shape)(const double *, double) = 0;
  if (!value || points < 1 || !(step > 0.0) || !(p[1] > 0.0)) return EXTRADOS_invalid_argument;
  switch (kind) {
    case EXTRADOS_envelope_arctangent:
      if (p[2] > 0.0) shape = arctangent;
      break;
    case EXTRADOS_envelope_trapezoid:
      if (p[2] >= 0.0 && p[3] >= 0.0 && p[2] + p[3] <= p[1] * (1.0 + 1e-12)) shape = trapezoid;
      break;
    case EXTRADOS_envelope_jennings:
      if (p[2] > 0.0 && p[2] <= p[1] && p[3] > 0.0) shape = jennings;
      break;
    case EXTRADOS_envelope_saragoni_hart:
      if (p[2] > 0.0 && p[2] < 1.0 && p[3] > 0.0 && p[3] < 1.0) shape = saragoni_hart;
      break;
    default:
      break;
  }
  if (!shape) return EXTRADOS_invalid_argument;
  for (int k = 0; k < points; k++) value[k] = shape(p, k * step);
  return EXTRADOS_ok;
}
