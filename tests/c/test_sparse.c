/* The sparse factor on a grid of springs: solutions and changes against the matrix itself. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "extrados.h"

enum { side = 9, n = side * side, most = 3 * n };

static double dense[n][n]; /* in the order of the factor */
static int64_t start[n + 1], row[most], place[n];
static double value[most];

/* Five-point Laplacian with a varying diagonal, columns in the given order. */
static void assemble(const int64_t *order) {
  double plain[n][n];
  int64_t count = 0;
  memset(plain, 0, sizeof plain);
  for (int i = 0; i < n; i++) {
    plain[i][i] = 4.1 + 0.01 * (i % 7);
    if (i % side) plain[i][i - 1] = plain[i - 1][i] = -1.0;
    if (i >= side) plain[i][i - side] = plain[i - side][i] = -1.0;
  }
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) dense[i][j] = plain[order[i]][order[j]];
  for (int j = 0; j < n; j++) {
    start[j] = count;
    for (int i = j; i < n; i++)
      if (dense[i][j] != 0.0) {
        row[count] = i;
        value[count++] = dense[i][j];
      }
  }
  start[n] = count;
}

/* Greatest entry of K x - b. */
static double residual(const double *x, const double *b) {
  double worst = 0.0;
  for (int i = 0; i < n; i++) {
    double sum = -b[i];
    for (int j = 0; j < n; j++) sum += dense[i][j] * x[j];
    worst = fmax(worst, fabs(sum));
  }
  return worst;
}

static void change(int sign, int count, const int *index, const double *w) {
  for (int i = 0; i < count; i++)
    for (int j = 0; j < count; j++) dense[index[i]][index[j]] += sign * w[i] * w[j];
}

/* The band factor against the same matrix, for widths on both sides of a panel's, and a pivot that is lost. */
static void band(void) {
  enum { width = side + 3 };
  for (int w = 1; w <= width; w += 1) {
    static double entries[n * (width + 1)];
    double full[n][n], x[n], b[n];
    memset(entries, 0, sizeof entries);
    memset(full, 0, sizeof full);
    for (int j = 0; j < n; j++)
      for (int i = j; i < n && i <= j + w; i++)
        full[i][j] = full[j][i] = entries[j * (w + 1) + i - j] = i == j ? 2.0 * w + 1.0 : sin(7.0 * i + j);
    for (int i = 0; i < n; i++) {
      x[i] = cos(3.0 * i);
      b[i] = 0.0;
    }
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n; j++) b[i] += full[i][j] * x[j];
    assert(extrados_band_factor(n, w, entries) == EXTRADOS_ok);
    extrados_band_solve(n, w, entries, b);
    for (int i = 0; i < n; i++) assert(fabs(b[i] - x[i]) < 1e-12);
  }
  double lost[6] = {1.0, 1.0, 1.0, 0.0, 1.0, 0.0}; /* [[1, 1], [1, 1]] and more */
  assert(extrados_band_factor(3, 1, lost) == EXTRADOS_not_positive_definite);
}

int main(void) {
  band();
  int64_t order[n], values, weakest;
  double ratio, b[2 * n], x[2 * n], both_z[2 * n], full[n];
  void *handle;
  for (int i = 0; i < n; i++) order[i] = i;
  assemble(order);
  for (int ordering = 0; ordering < 2; ordering++) {
    assert(extrados_sparse_order(n, start, row, ordering, order) == EXTRADOS_ok);
    memset(place, 0, sizeof place);
    for (int i = 0; i < n; i++) place[order[i]]++;
    for (int i = 0; i < n; i++) assert(place[i] == 1);
  }
  assemble(order);
  assert(extrados_sparse_new(n, start, row, &handle, &values) == EXTRADOS_ok && values >= start[n]);
  assert(extrados_sparse_factor(handle, value, &ratio, &weakest) == EXTRADOS_ok);
  assert(ratio > 0.1 && ratio <= 1.0 && weakest >= 0 && weakest < n);

  for (int i = 0; i < 2 * n; i++) x[i] = b[i] = sin(1.0 + i);
  assert(extrados_sparse_solve(handle, 2, x) == EXTRADOS_ok);
  assert(residual(x, b) < 1e-13 && residual(x + n, b + n) < 1e-13);
  memcpy(x, b, sizeof x);
  assert(extrados_sparse_plain(handle, value, 2, x) == EXTRADOS_ok);
  assert(residual(x, b) < 1e-13 && residual(x + n, b + n) < 1e-13);
  /* A negative pivot: the diagonal of one equation with the other sign. */
  const double turned = -value[start[n / 2]];
  value[start[n / 2]] = dense[n / 2][n / 2] = turned;
  memcpy(x, b, sizeof x);
  assert(extrados_sparse_plain(handle, value, 2, x) == EXTRADOS_not_positive_definite);
  memcpy(x, b, sizeof x);
  assert(extrados_sparse_indefinite(handle, value, 2, x) == EXTRADOS_ok);
  assert(residual(x, b) < 1e-12 && residual(x + n, b + n) < 1e-12);
  value[start[n / 2]] = dense[n / 2][n / 2] = -turned;
  memcpy(x, b, sizeof x);
  assert(extrados_sparse_indefinite(handle, value, 2, x) == EXTRADOS_ok);
  assert(residual(x, b) < 1e-13 && residual(x + n, b + n) < 1e-13);
  assert(extrados_sparse_factor(handle, value, &ratio, &weakest) == EXTRADOS_ok);

  /* A spring between two neighbours of the grid is added, then taken away again. */
  int pair[2] = {-1, -1};
  for (int64_t k = start[n / 2] + 1; k < start[n / 2 + 1]; k++) {
    pair[0] = n / 2;
    pair[1] = (int)row[k];
  }
  assert(pair[0] >= 0);
  const double w[2] = {0.7, -0.7};
  const int stiffer[1] = {1}, softer[1] = {-1};
  double least, part[2 * n];
  assert(extrados_sparse_change(handle, 1, stiffer, 2, pair, w, 0, NULL, NULL, &least) == EXTRADOS_ok);
  assert(least == 1.0);
  change(1, 2, pair, w);
  memcpy(x, b, sizeof x);
  assert(extrados_sparse_solve(handle, 1, x) == EXTRADOS_ok && residual(x, b) < 1e-13);
  /* Two changes at once, one each way, and two right-hand sides that go forward on the way and backward after. */
  const int both[2] = {1, -1};
  const double two[4] = {0.2, 0.5, 0.3, -0.4}, load[4] = {1.0, 2.0, -1.0, 0.5};
  for (int i = 0; i < 2 * n; i++) part[i] = 1e3; /* what lies off the path is not read */
  assert(extrados_sparse_change(handle, 2, both, 2, pair, two, 2, load, part, &least) == EXTRADOS_ok);
  assert(least > 0.5 && least < 1.0);
  change(1, 2, pair, two);
  change(-1, 2, pair, two + 2);
  int64_t blocks;
  const int64_t *column, *begin, *rows;
  extrados_sparse_tree(handle, &blocks, &column, &begin, &rows);
  assert(column[0] == 0 && column[blocks] == n && begin[0] == 0);
  for (int64_t s = blocks - 1; s >= 0; s--) {
    assert(rows[begin[s]] == column[s]);
    /* A block is on the path where it holds one of the pair, or a block below it hands over to it. */
    int on = 0;
    for (int i = 0; i < 2; i++)
      for (int64_t at = pair[i]; at >= 0 && !on;) {
        int64_t t = 0;
        while (column[t + 1] <= at) t++;
        on = t == s;
        int64_t next = begin[t] + column[t + 1] - column[t];
        at = next < begin[t + 1] ? rows[next] : -1;
      }
    for (int v = 0; v < 2; v++)
      for (int64_t j = column[s]; j < column[s + 1]; j++) both_z[v * n + j] = on ? part[v * n + j] : 0.0;
    assert(extrados_sparse_backward(handle, s, s, 2, both_z) == EXTRADOS_ok);
  }
  for (int v = 0; v < 2; v++) {
    memset(full, 0, sizeof full);
    for (int i = 0; i < 2; i++) full[pair[i]] = load[2 * v + i];
    assert(residual(both_z + v * n, full) < 1e-14);
  }
  assert(extrados_sparse_change(handle, 1, softer, 2, pair, w, 0, NULL, NULL, &least) == EXTRADOS_ok);
  change(-1, 2, pair, w);
  memcpy(x, b, sizeof x);
  assert(extrados_sparse_solve(handle, 1, x) == EXTRADOS_ok && residual(x, b) < 1e-13);

  /* What is not definite, and what is no number, is refused. */
  const double strong[1] = {3.0};
  const int one[1] = {n / 2};
  assert(extrados_sparse_change(handle, 1, softer, 1, one, strong, 0, NULL, NULL, &least) == EXTRADOS_not_positive_definite);
  value[start[n - 1]] = -1.0;
  assert(extrados_sparse_factor(handle, value, &ratio, &weakest) == EXTRADOS_not_positive_definite);
  value[start[n - 1]] = NAN;
  assert(extrados_sparse_factor(handle, value, &ratio, &weakest) == EXTRADOS_not_finite);
  value[start[n - 1]] = 4.2;
  assert(extrados_sparse_factor(handle, value, &ratio, &weakest) == EXTRADOS_ok);
  x[3] = INFINITY;
  assert(extrados_sparse_solve(handle, 1, x) == EXTRADOS_not_finite);
  const int wrong[1] = {2};
  assert(extrados_sparse_change(handle, 1, wrong, 1, one, strong, 0, NULL, NULL, &least) == EXTRADOS_invalid_argument);
  assert(extrados_sparse_backward(handle, 0, blocks, 1, x) == EXTRADOS_invalid_argument);
  extrados_sparse_free(&handle);
  extrados_sparse_free(&handle);
  assert(!handle);
  puts("sparse: all right");
  return 0;
}
