/* Cholesky's factor of a symmetric positive matrix whose entries lie near its diagonal, in one thread.
 *
 * Column j of the lower triangle stands in band[j (width + 1)], from its diagonal down. LAPACK's dpbtrf does the same, but
 * OpenBLAS shares blocks of thirty equations among threads, which costs more than it gains where others compute. Eight
 * columns are factored at a time and taken off all columns they reach (Golub and Van Loan 2013, section 4.3.5).
 *
 * In one thread each, LAPACK takes 1.8 times as long at a width of 30, 1.1 to 1.2 times at 80, 0.8 times at 290
 * (`python tests/bench solvers`).
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "extrados.h"
#include "four.h"

enum { PANEL = 8 };

/* Of its diagonal entry: a pivot that is less has been lost in rounding. */
static const double lost = 1e-15;

static int64_t least(int64_t a, int64_t b) { return a < b ? a : b; }

/* `columns` of a panel, of which earlier panels have been taken off; the diagonal becomes the inverse of the pivot. 0 where
 * a pivot is lost. */
static int factor_panel(int64_t n, int64_t width, int64_t first, int64_t columns, const double *diagonal, double *band) {
  const int64_t stride = width + 1;
  for (int64_t j = first; j < first + columns; j++) {
    double *column = band + j * stride;
    const int64_t end = least(n - 1, j + width) - j;
    for (int64_t k = first; k < j; k++) {
      if (j - k > width) continue;
      const double *before = band + k * stride + (j - k), factor = before[0];
      const int64_t rows = least(end, width - (j - k));
      for (int64_t i = 0; i <= rows; i++) column[i] -= factor * before[i];
    }
    if (!(column[0] > lost * diagonal[j])) return 0;
    const double inverse = 1.0 / sqrt(column[0]);
    column[0] = inverse;
    for (int64_t i = 1; i <= end; i++) column[i] *= inverse;
  }
  return 1;
}

/* column[i] -= sum over the panel of rows[p][i] factor[p] */
FOR_EACH_PROCESSOR
static void take_off(int64_t count, int64_t stride, const double *rows, const double *factor, double *column) {
  four f[PANEL];
  for (int p = 0; p < PANEL; p++) f[p] = (four){factor[p], factor[p], factor[p], factor[p]};
  int64_t i = 0;
  for (; i + 4 <= count; i += 4) {
    four sum = *(const four *)(rows + i) * f[0];
    for (int p = 1; p < PANEL; p++) sum += *(const four *)(rows + p * stride + i) * f[p];
    *(four *)(column + i) -= sum;
  }
  for (; i < count; i++) {
    double sum = rows[i] * factor[0];
    for (int p = 1; p < PANEL; p++) sum += rows[p * stride + i] * factor[p];
    column[i] -= sum;
  }
}

int extrados_band_factor(int64_t n, int64_t width, double *band) {
  const int64_t stride = width + 1, room = width + PANEL;
  double *diagonal = malloc((size_t)n * sizeof *diagonal), *rows = malloc((size_t)(PANEL * room) * sizeof *rows);
  if (!diagonal || !rows) {
    free(diagonal);
    free(rows);
    return EXTRADOS_out_of_memory;
  }
  int status = EXTRADOS_ok;
  for (int64_t j = 0; j < n; j++) diagonal[j] = fabs(band[j * stride]);
  for (int64_t first = 0; status == EXTRADOS_ok && first < n; first += PANEL) {
    const int64_t columns = least(PANEL, n - first), next = first + columns;
    if (!factor_panel(n, width, first, columns, diagonal, band)) status = EXTRADOS_not_positive_definite;
    /* what the panel has below itself, padded by zeros to one length */
    const int64_t below = least(n, next + width) - next;
    memset(rows, 0, (size_t)(PANEL * room) * sizeof *rows);
    for (int64_t p = 0; p < columns; p++) {
      const int64_t reach = least(n - 1, first + p + width) - next + 1, from = next - first - p;
      if (reach > 0) memcpy(rows + p * room, band + (first + p) * stride + from, (size_t)reach * sizeof *rows);
    }
    for (int64_t j = 0; j < below; j++) {
      double factor[PANEL];
      for (int p = 0; p < PANEL; p++) factor[p] = rows[p * room + j];
      take_off(below - j, room, rows + j, factor, band + (next + j) * stride);
    }
  }
  free(diagonal);
  free(rows);
  return status;
}

FOR_EACH_PROCESSOR
void extrados_band_solve(int64_t n, int64_t width, const double *restrict band, double *restrict x) {
  const int64_t stride = width + 1;
  for (int64_t j = 0; j < n; j++) {
    const double *column = band + j * stride, value = x[j] * column[0];
    const int64_t end = least(n - 1, j + width) - j;
    const four value4 = {value, value, value, value};
    int64_t i = 1;
    x[j] = value;
    for (; i + 3 <= end; i += 4) *(four *)(x + j + i) -= value4 * *(const four *)(column + i);
    for (; i <= end; i++) x[j + i] -= value * column[i];
  }
  for (int64_t j = n - 1; j >= 0; j--) {
    const double *column = band + j * stride;
    const int64_t end = least(n - 1, j + width) - j;
    four sum = {0.0, 0.0, 0.0, 0.0};
    double rest = 0.0;
    int64_t i = 1;
    for (; i + 3 <= end; i += 4) sum += *(const four *)(column + i) * *(const four *)(x + j + i);
    for (; i <= end; i++) rest += column[i] * x[j + i];
    x[j] = (x[j] - (sum[0] + sum[1] + sum[2] + sum[3] + rest)) * column[0];
  }
}
