/* Rows of Cholesky's factor within an envelope (fortran/nonsmooth/skyline.f90): row i of the lower triangle stands from column first[i]
 * on, entry (i, j) at a[start[i] + j]; rows, columns and entries are counted from 1.
 *
 * Rows of one body begin at the same column, so that all of them meet each row above together: that row is read once, and their sums
 * do not wait for each other. Each sum is that of one row alone, in four parts, to the last bit.
 */
#include "extrados.h"
#include "four.h"

enum { MOST = 6 };

/* The entries of `rows` rows from row i on, in the columns before i */
static inline __attribute__((always_inline)) void meet_rows(const int rows, int32_t i, const int32_t *first, const int32_t *start,
                                                            double *a) {
  for (int32_t j = first[i]; j < i; j++) {
    const int32_t from = first[i] > first[j] ? first[i] : first[j], count = j - from;
    const double *with = a + start[j] + from;
    const double *row[MOST];
    four sum[MOST];
    for (int r = 0; r < rows; r++) {
      row[r] = a + start[i + r] + from;
      sum[r] = (four){0.0, 0.0, 0.0, 0.0};
    }
    int32_t k = 0;
    for (; k + 4 <= count; k += 4) {
      const four w = *(const four *)(with + k);
      for (int r = 0; r < rows; r++) sum[r] += *(const four *)(row[r] + k) * w;
    }
    for (; k < count; k++) {
      for (int r = 0; r < rows; r++) sum[r][0] += row[r][k] * with[k];
    }
    for (int r = 0; r < rows; r++) {
      double *entry = a + start[i + r] + j;
      *entry = (*entry - ((sum[r][0] + sum[r][1]) + (sum[r][2] + sum[r][3]))) / with[count];
    }
  }
}

FOR_EACH_PROCESSOR
static void meet_three(int32_t i, const int32_t *first, const int32_t *start, double *a) { meet_rows(3, i, first, start, a); }

FOR_EACH_PROCESSOR
static void meet_six(int32_t i, const int32_t *first, const int32_t *start, double *a) { meet_rows(6, i, first, start, a); }

void extrados_envelope_rows(int32_t rows, int32_t i, const int32_t *first, const int32_t *start, double *a, int32_t *status) {
  *status = rows == 3 || rows == 6 ? EXTRADOS_ok : EXTRADOS_invalid_argument;
  if (rows == 3) meet_three(i, first - 1, start - 1, a - 1);
  if (rows == 6) meet_six(i, first - 1, start - 1, a - 1);
}
