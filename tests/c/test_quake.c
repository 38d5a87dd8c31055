/* Envelopes, lines, phases and Fourier transforms against closed forms. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "extrados_quake.h"

static void near(double value, double expected, double tolerance, const char *what) {
  if (fabs(value - expected) <= tolerance) return;
  printf("%s: %.17g, expected %.17g\n", what, value, expected);
  exit(1);
}

static void envelopes(void) {
  double value[201];
  const double trapezoid[4] = {1.0, 8.0, 2.0, 4.0}, jennings[4] = {0.0, 5.0, 2.0, 0.3};
  const double boore[4] = {0.0, 10.0, 0.2, 0.05}, thesis[4] = {2.0, 6.0, 0.1, 0.0};
  const double bad[4] = {0.0, 3.0, 2.0, 2.0};
  assert(extrados_envelope(EXTRADOS_envelope_trapezoid, trapezoid, 101, 0.1, value) == EXTRADOS_ok);
  near(value[5], 0.0, 0.0, "trapezoid before its start");
  near(value[20], 0.5, 1e-12, "trapezoid half risen");
  near(value[40], 1.0, 1e-12, "trapezoid on its level");
  near(value[80], 0.25, 1e-12, "trapezoid in decay");
  near(value[95], 0.0, 0.0, "trapezoid over");
  assert(extrados_envelope(EXTRADOS_envelope_jennings, jennings, 101, 0.1, value) == EXTRADOS_ok);
  near(value[10], 0.25, 1e-12, "Jennings' parabola");
  near(value[70], exp(-0.6), 1e-12, "Jennings' decay");
  assert(extrados_envelope(EXTRADOS_envelope_saragoni_hart, boore, 101, 0.1, value) == EXTRADOS_ok);
  near(value[20], 1.0, 1e-12, "Saragoni and Hart's peak");
  near(value[100], 0.05, 1e-12, "Saragoni and Hart's end");
  assert(extrados_envelope(EXTRADOS_envelope_arctangent, thesis, 101, 0.1, value) == EXTRADOS_ok);
  near(value[50], 2.0 * atan(30.0) / M_PI, 1e-12, "thesis Eq. 6.7 in the middle");
  assert(extrados_envelope(EXTRADOS_envelope_trapezoid, bad, 101, 0.1, value) == EXTRADOS_invalid_argument);
  assert(extrados_envelope(99, thesis, 101, 0.1, value) == EXTRADOS_invalid_argument);
}

static void lines(void) {
  const double line[4] = {1.0, 2.0, 3.0, 4.0}, octave[3] = {1.0, 2.0, 4.0}, back[3] = {1.0, 3.0, 2.0};
  const double one[2] = {1.0, 1.0}, width[2] = {0.25, 0.25};
  double out[4], amplitude[2];
  assert(extrados_line_widths(EXTRADOS_spacing_uniform, 4, line, out) == EXTRADOS_ok);
  for (int k = 0; k < 4; k++) near(out[k], 1.0, 1e-14, "uniform width");
  assert(extrados_line_widths(EXTRADOS_spacing_log, 3, octave, out) == EXTRADOS_ok);
  near(out[0] + out[1] + out[2], 4.0 * sqrt(2.0) - sqrt(0.5), 1e-13, "log widths fill the band");
  assert(extrados_line_widths(EXTRADOS_spacing_log, 3, back, out) == EXTRADOS_invalid_argument);
  assert(extrados_line_amplitudes(EXTRADOS_scaling_fourier, 1.0, 4.0, 2, one, width, amplitude) == EXTRADOS_ok);
  near(amplitude[1], 0.5, 1e-15, "2 |X| df");
  assert(extrados_line_amplitudes(EXTRADOS_scaling_energy, 1.0, 4.0, 2, one, width, amplitude) == EXTRADOS_ok);
  near(amplitude[0], 2.0 * sqrt(0.0625), 1e-15, "energy of a line");
  assert(extrados_line_amplitudes(7, 1.0, 4.0, 2, one, width, amplitude) == EXTRADOS_invalid_argument);
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void phases(void) {
  enum { motions = 20000 };
  static double first[motions], again[4], once[4];
  double mean = 0.0;
  for (int k = 0; k < motions; k++) {
    assert(extrados_motion_phases(7, k, 1, &first[k]) == EXTRADOS_ok);
    assert(first[k] >= 0.0 && first[k] < 2.0 * M_PI);
    mean += first[k] / motions;
  }
  near(mean, M_PI, 4.0 * 2.0 * M_PI / sqrt(12.0 * motions), "mean phase within four deviations");
  qsort(first, motions, sizeof *first, ascending);
  int equal = 0;
  for (int k = 1; k < motions; k++) equal += first[k] == first[k - 1];
  assert(equal < 3); /* of 2^32 values; two motions with one seed would show here */
  assert(extrados_motion_phases(-3, 12, 4, once) == EXTRADOS_ok);
  assert(extrados_motion_phases(-3, 12, 4, again) == EXTRADOS_ok);
  for (int k = 0; k < 4; k++) near(again[k], once[k], 0.0, "phases again");
  assert(extrados_motion_phases(1, -1, 4, once) == EXTRADOS_invalid_argument);
}

static void transforms(void) {
  enum { length = 60, points = 50 };
  double series[points], back[length], re[length / 2 + 1], im[length / 2 + 1], energy = 0.0, sum = 0.0;
  for (int k = 0; k < points; k++) {
    series[k] = sin(0.3 * k) + 0.01 * k;
    energy += series[k] * series[k];
  }
  assert(extrados_fourier(points, series, length, re, im) == EXTRADOS_ok);
  for (int k = 0; k <= length / 2; k++)
    sum += (k == 0 || k == length / 2 ? 1.0 : 2.0) * (re[k] * re[k] + im[k] * im[k]) / length;
  near(sum, energy, 1e-11 * energy, "Parseval");
  assert(extrados_fourier_inverse(length, re, im, back) == EXTRADOS_ok);
  for (int k = 0; k < length; k++) near(back[k], k < points ? series[k] : 0.0, 1e-13, "there and back");
}

int main(void) {
  extrados_library_init();
  envelopes();
  lines();
  phases();
  transforms();
  puts("quake: all right");
  return 0;
}
