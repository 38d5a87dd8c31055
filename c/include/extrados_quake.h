/* Generated earthquakes and Fourier transforms (c/quake). Same rules as extrados.h. */
#ifndef EXTRADOS_QUAKE_H
#define EXTRADOS_QUAKE_H

#include "extrados.h"

/* The same source for wide and narrow registers, chosen when the program loads. No fused multiply-add is allowed
 * anywhere (-ffp-contract=off), so both give the same bits. */
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define EXTRADOS_ANY_WIDTH __attribute__((target_clones("avx2", "default")))
#else
#define EXTRADOS_ANY_WIDTH
#endif

/* random.c: phases of motion `index` of the set `seed`, uniform in [0, 2 pi). */
EXTRADOS_API int extrados_motion_phases(int64_t seed, int64_t index, int count, double *phase);

/* envelope.c: values at times k * step, k = 0 .. points - 1. */
EXTRADOS_API int extrados_envelope(int kind, const double parameter[4], int points, double step, double *value);

/* lines.c */
EXTRADOS_API int extrados_line_spectrum(int intensities, const double *intensity, int frequencies,
                                        const double *frequency, const double *amplitude, double wanted,
                                        int lines, const double *line, double *value);
EXTRADOS_API int extrados_line_widths(int spacing, int lines, const double *line, double *width);
EXTRADOS_API int extrados_line_amplitudes(int scaling, double factor, double duration, int lines,
                                          const double *value, const double *width, double *amplitude);
EXTRADOS_API int extrados_line_table(int lines, const double *line, int points, double step,
                                     const double *envelope, double *table);
EXTRADOS_API int extrados_line_motion(int64_t seed, int64_t index, int lines, const double *amplitude,
                                      int points, const double *table, double *motion);

/* fourier.c: transform of a real series padded with zeros to `length`; re, im hold length / 2 + 1 values.
 * The inverse takes them back to `length` values. Neither is scaled, the inverse divides by `length`. */
EXTRADOS_API int extrados_fourier(int points, const double *series, int length, double *re, double *im);
EXTRADOS_API int extrados_fourier_inverse(int length, const double *re, const double *im, double *series);

/* oscillator.c: coefficients[10][EXTRADOS_LANES] of the exact step, state[2][...], most[3][...]; see
 * motion_oscillator in fortran/motion. */
#define EXTRADOS_LANES 8
EXTRADOS_API void extrados_oscillator_lanes(int points, const double *motion, int parts, const double *coefficients,
                                            double *state, double *most);

#endif
