/* Fourier transforms of real series on GSL's mixed-radix routines. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_fft_halfcomplex.h>
#include <gsl/gsl_fft_real.h>
#include <stdlib.h>
#include <string.h>

#include "extrados_quake.h"

int extrados_fourier(int points, const double *series, int length, double *re, double *im) {
  if (points < 1 || length < points || length < 2) return EXTRADOS_invalid_argument;
  const size_t n = (size_t)length;
  int status = EXTRADOS_out_of_memory;
  double *data = calloc(n, sizeof *data);
  gsl_fft_real_wavetable *table = gsl_fft_real_wavetable_alloc(n);
  gsl_fft_real_workspace *work = gsl_fft_real_workspace_alloc(n);
  if (!data || !table || !work) goto leave;
  memcpy(data, series, (size_t)points * sizeof *data);
  status = EXTRADOS_library_failed;
  if (gsl_fft_real_transform(data, 1, n, table, work)) goto leave;
  /* half-complex order: z0, re z1, im z1, ..., and the last real one where the length is even */
  re[0] = data[0];
  im[0] = 0.0;
  for (size_t k = 1; k <= n / 2; k++) {
    re[k] = data[2 * k - 1];
    im[k] = 2 * k < n ? data[2 * k] : 0.0;
  }
  status = EXTRADOS_ok;
leave:
  gsl_fft_real_workspace_free(work);
  gsl_fft_real_wavetable_free(table);
  free(data);
  return status;
}

int extrados_fourier_inverse(int length, const double *re, const double *im, double *series) {
  if (length < 2) return EXTRADOS_invalid_argument;
  const size_t n = (size_t)length;
  int status = EXTRADOS_out_of_memory;
  gsl_fft_halfcomplex_wavetable *table = gsl_fft_halfcomplex_wavetable_alloc(n);
  gsl_fft_real_workspace *work = gsl_fft_real_workspace_alloc(n);
  if (!table || !work) goto leave;
  series[0] = re[0];
  for (size_t k = 1; k <= n / 2; k++) {
    series[2 * k - 1] = re[k];
    if (2 * k < n) series[2 * k] = im[k];
  }
  status = gsl_fft_halfcomplex_inverse(series, 1, n, table, work) ? EXTRADOS_library_failed : EXTRADOS_ok;
leave:
  gsl_fft_real_workspace_free(work);
  gsl_fft_halfcomplex_wavetable_free(table);
  return status;
}
