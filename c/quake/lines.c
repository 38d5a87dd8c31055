/* Generated earthquakes (thesis Eqs 6.6 to 6.8): sine lines with random phases under an envelope. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_interp2d.h>
#include <math.h>
#include <stdlib.h>

#include "extrados_quake.h"

/* Fourier amplitude at each line for one intensity, from a table whose row m holds the amplitudes of intensity m:
 * straight lines in log amplitude over log frequency and intensity. Nothing is read beyond the table. */
int extrados_line_spectrum(int intensities, const double *intensity, int frequencies, const double *frequency,
                           const double *amplitude, double wanted, int lines, const double *line, double *value) {
  if (intensities < 2 || frequencies < 2 || lines < 1) return EXTRADOS_invalid_argument;
  const size_t size = (size_t)intensities * (size_t)frequencies;
  int status = EXTRADOS_invalid_argument;
  double *x = malloc(((size_t)frequencies + size) * sizeof *x), *z = x ? x + frequencies : 0;
  gsl_interp2d *surface = gsl_interp2d_alloc(gsl_interp2d_bilinear, (size_t)frequencies, (size_t)intensities);
  if (!x || !surface) {
    status = EXTRADOS_out_of_memory;
    goto leave;
  }
  for (int j = 0; j < frequencies; j++) {
    if (!(frequency[j] > (j ? frequency[j - 1] : 0.0))) goto leave;
    x[j] = log(frequency[j]);
  }
  for (int i = 1; i < intensities; i++)
    if (!(intensity[i] > intensity[i - 1])) goto leave;
  for (size_t k = 0; k < size; k++) {
    if (!(amplitude[k] > 0.0)) goto leave;
    z[k] = log(amplitude[k]);
  }
  if (gsl_interp2d_init(surface, x, intensity, z, (size_t)frequencies, (size_t)intensities)) goto leave;
  for (int k = 0; k < lines; k++) {
    /* The ends of the band may come from a rounded logspace. */
    double at = log(line[k]);
    if (fabs(at - x[0]) < 1e-9) at = x[0];
    if (fabs(at - x[frequencies - 1]) < 1e-9) at = x[frequencies - 1];
    if (gsl_interp2d_eval_e(surface, x, intensity, z, at, wanted, 0, 0, &value[k])) goto leave;
    value[k] = exp(value[k]);
  }
  status = EXTRADOS_ok;
leave:
  gsl_interp2d_free(surface);
  free(x);
  return status;
}

/* Share of the band that each line stands for [Hz]: bin edges at the geometric (log) or arithmetic (uniform) means
 * of neighbours, the outer edges by the same rule. */
int extrados_line_widths(int spacing, int lines, const double *line, double *width) {
  if (lines < 2 || (spacing != EXTRADOS_spacing_log && spacing != EXTRADOS_spacing_uniform))
    return EXTRADOS_invalid_argument;
  for (int k = 0; k < lines; k++)
    if (!(line[k] > (k ? line[k - 1] : 0.0))) return EXTRADOS_invalid_argument;
  for (int k = 0; k < lines; k++) {
    const double f = line[k], up = k + 1 < lines ? line[k + 1] : 0.0, down = k ? line[k - 1] : 0.0;
    if (spacing == EXTRADOS_spacing_log) {
      const double above = k + 1 < lines ? sqrt(f * up) : f * sqrt(f / down);
      const double below = k ? sqrt(f * down) : f * sqrt(f / up);
      width[k] = above - below;
    } else {
      const double above = k + 1 < lines ? 0.5 * (up - f) : 0.5 * (f - down);
      const double below = k ? 0.5 * (f - down) : 0.5 * (up - f);
      width[k] = above + below;
    }
  }
  return EXTRADOS_ok;
}

/* Amplitude of each sine from |X| and its width df. thesis: factor |X| df, Eq. 6.6 as printed (its unit of the
 * frequency step is not known); fourier: 2 |X| df, the exact inverse for fine lines; energy: the sum of lines keeps
 * the energy 2 sum |X|^2 df of the spectrum, `duration` being the integral of the squared envelope. */
int extrados_line_amplitudes(int scaling, double factor, double duration, int lines, const double *value,
                             const double *width, double *amplitude) {
  if (!(factor > 0.0) || !(duration > 0.0)) return EXTRADOS_invalid_argument;
  for (int k = 0; k < lines; k++) {
    switch (scaling) {
      case EXTRADOS_scaling_thesis:
        amplitude[k] = factor * value[k] * width[k];
        break;
      case EXTRADOS_scaling_fourier:
        amplitude[k] = factor * 2.0 * value[k] * width[k];
        break;
      case EXTRADOS_scaling_energy:
        amplitude[k] = factor * 2.0 * value[k] * sqrt(width[k] / duration);
        break;
      default:
        return EXTRADOS_invalid_argument;
    }
  }
  return EXTRADOS_ok;
}

/* P sin and P cos of every line at every time: table[(2 i) * points + k] and table[(2 i + 1) * points + k].
 * Every motion of a set is a sum of these rows, so no sine is evaluated per motion. */
int extrados_line_table(int lines, const double *line, int points, double step, const double *envelope,
                        double *table) {
  if (lines < 1 || points < 1 || !(step > 0.0)) return EXTRADOS_invalid_argument;
  for (int i = 0; i < lines; i++) {
    double *restrict sine = table + (size_t)(2 * i) * (size_t)points;
    double *restrict cosine = sine + points;
    for (int k = 0; k < points; k++) {
      const double angle = 2.0 * M_PI * line[i] * (k * step);
      sine[k] = envelope[k] * sin(angle);
      cosine[k] = envelope[k] * cos(angle);
    }
  }
  return EXTRADOS_ok;
}

/* Motion `index` of the set `seed`. The order of the sum is fixed: same bits in any batch and on any thread. */
EXTRADOS_ANY_WIDTH
int extrados_line_motion(int64_t seed, int64_t index, int lines, const double *amplitude, int points,
                         const double *table, double *restrict motion) {
  double phase[2];
  if (lines < 1 || points < 1) return EXTRADOS_invalid_argument;
  double *all = malloc((size_t)lines * sizeof *all);
  if (!all) return EXTRADOS_out_of_memory;
  const int status = extrados_motion_phases(seed, index, lines, all);
  for (int k = 0; k < points; k++) motion[k] = 0.0;
  for (int i = 0; status == EXTRADOS_ok && i < lines; i += 2) {
    const int second = i + 1 < lines;
    const double *restrict row = table + (size_t)(2 * i) * (size_t)points;
    const double *restrict next = second ? row + 2 * (size_t)points : row;
    phase[0] = all[i];
    phase[1] = second ? all[i + 1] : 0.0;
    const double c0 = amplitude[i] * cos(phase[0]), s0 = amplitude[i] * sin(phase[0]);
    const double c1 = second ? amplitude[i + 1] * cos(phase[1]) : 0.0;
    const double s1 = second ? amplitude[i + 1] * sin(phase[1]) : 0.0;
    for (int k = 0; k < points; k++)
      motion[k] += (c0 * row[k] + s0 * row[k + points]) + (c1 * next[k] + s1 * next[k + points]);
  }
  free(all);
  return status;
}
