/* A sparse LDL' factor that is made once and then only updated (sequentially linear analysis).
 *
 * CHOLMOD orders, analyses and factorises (supernodal LL'); the dense blocks of its factor are then
 * rescaled in place to unit-triangular LDL' and belong to this file: rank-1 changes walk up the tree of
 * supernodes (Gill, Golub, Murray, Saunders 1974, method C1) and carry sparse right-hand sides forward on their
 * way; the caller says through which supernodes the solution goes backward.
 *
 * The equations come in factor order: the caller renumbers them once by extrados_sparse_order.
 *
 * Why: an event by CHOLMOD's refactorisation takes 61 times as long at 4,800 equations, 113 times at 20,000
 * (`python tests/bench sla`).
 */
#include <cholmod.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "extrados.h"
#include "four.h"

enum { most_vectors = 4, most_changes = extrados_most_changes, most_ahead = 16384 /* bytes */, most_threads = 4,
  shared_from = 4000000 /* values of a factor */ };

struct extrados_sparse {
  cholmod_common common;
  cholmod_factor *factor;
  cholmod_sparse matrix; /* over the caller's pattern, with values given at each factorisation */
  int64_t n, blocks, longest;
  int64_t *block_of;         /* column -> its supernode */
  double *d, *column;        /* D; most_changes dense columns in factor order, zero between calls */
  double *buffer;            /* most_changes + most_vectors rows of one supernode */
  cholmod_dense *y, *e, *answer; /* workspace of the plain solves of the refactorising algorithm */
  cholmod_factor *definite, *simplicial; /* of other matrices on the pattern, made when first wanted: LL', supernodal, */
  cholmod_factor *latest;                /* and LDL' where that one fails; the one that was made last */
};

static int code_of(const cholmod_common *common) {
  if (common->status == CHOLMOD_OK) return EXTRADOS_ok;
  if (common->status == CHOLMOD_NOT_POSDEF) return EXTRADOS_not_positive_definite;
  if (common->status == CHOLMOD_OUT_OF_MEMORY || common->status == CHOLMOD_TOO_LARGE)
    return EXTRADOS_out_of_memory;
  return EXTRADOS_library_failed;
}

static void settle(cholmod_common *common) {
  cholmod_l_start(common);
  common->print = 0;
  common->supernodal = CHOLMOD_SUPERNODAL;
  common->final_ll = 1;
  common->quick_return_if_not_posdef = 1;
  common->nmethods = 1;
#if CHOLMOD_MAIN_VERSION >= 4 /* before, four it is */
  common->nthreads_max = most_threads;
#endif
}

static cholmod_sparse lower(int64_t n, const int64_t *start, const int64_t *row, const double *value) {
  cholmod_sparse k = {0};
  k.nrow = k.ncol = (size_t)n;
  k.nzmax = (size_t)start[n];
  k.p = (void *)(uintptr_t)start;
  k.i = (void *)(uintptr_t)row;
  k.x = (void *)(uintptr_t)value;
  k.stype = -1;
  k.itype = CHOLMOD_LONG;
  k.xtype = value ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  k.dtype = CHOLMOD_DOUBLE;
  k.sorted = k.packed = 1;
  return k;
}

int extrados_sparse_order(int64_t n, const int64_t *start, const int64_t *row, int ordering, int64_t *order) {
  cholmod_common common;
  settle(&common);
  common.method[0].ordering = ordering ? CHOLMOD_METIS : CHOLMOD_AMD;
  common.postorder = 1;
  cholmod_sparse k = lower(n, start, row, NULL);
  cholmod_factor *factor = cholmod_l_analyze(&k, &common);
  int code = factor ? EXTRADOS_ok : code_of(&common);
  if (factor) memcpy(order, factor->Perm, (size_t)n * sizeof *order);
  cholmod_l_free_factor(&factor, &common);
  cholmod_l_finish(&common);
  return code;
}

int extrados_sparse_new(int64_t n, const int64_t *start, const int64_t *row, void **handle, int64_t *values) {
  *handle = NULL;
  *values = 0;
  if (n < 1) return EXTRADOS_invalid_argument;
  struct extrados_sparse *self = calloc(1, sizeof *self);
  if (!self) return EXTRADOS_out_of_memory;
  *handle = self;
  settle(&self->common);
  self->common.method[0].ordering = CHOLMOD_NATURAL;
  self->common.postorder = 0;
  self->matrix = lower(n, start, row, NULL);
  self->factor = cholmod_l_analyze(&self->matrix, &self->common);
  if (!self->factor) return code_of(&self->common);
  self->n = n;
  self->blocks = (int64_t)self->factor->nsuper;
  *values = (int64_t)self->factor->xsize;

  const int64_t *super = self->factor->super, *pi = self->factor->pi;
  for (int64_t s = 0; s < self->blocks; s++)
    if (pi[s + 1] - pi[s] > self->longest) self->longest = pi[s + 1] - pi[s];
  self->block_of = malloc((size_t)n * sizeof *self->block_of);
  self->d = malloc((size_t)n * sizeof *self->d);
  self->column = calloc((size_t)(most_changes * n), sizeof *self->column);
  self->buffer = malloc((size_t)((most_changes + most_vectors) * self->longest) * sizeof *self->buffer);
  if (!self->block_of || !self->d || !self->column || !self->buffer) return EXTRADOS_out_of_memory;
  for (int64_t s = 0; s < self->blocks; s++)
    for (int64_t j = super[s]; j < super[s + 1]; j++) self->block_of[j] = s;
  return EXTRADOS_ok;
}

void extrados_sparse_free(void **handle) {
  struct extrados_sparse *self = *handle;
  *handle = NULL;
  if (!self) return;
  free(self->block_of);
  free(self->d);
  free(self->column);
  free(self->buffer);
  cholmod_l_free_dense(&self->y, &self->common);
  cholmod_l_free_dense(&self->e, &self->common);
  cholmod_l_free_dense(&self->answer, &self->common);
  cholmod_l_free_factor(&self->factor, &self->common);
  cholmod_l_free_factor(&self->definite, &self->common);
  cholmod_l_free_factor(&self->simplicial, &self->common);
  cholmod_l_finish(&self->common);
  free(self);
}

static int all_finite(int64_t count, const double *x) {
  for (int64_t i = 0; i < count; i++)
    if (!isfinite(x[i])) return 0;
  return 1;
}

/* CHOLMOD's loops are shared among up to four threads, whoever asks. It goes alone where there is no room for them, and
 * where the factor is small: threads then wait for each other longer than they work, on a busy machine by far. */
static int factor_values(struct extrados_sparse *self, cholmod_factor *factor) {
  const int room = extrados_blas_enter();
  if (room != EXTRADOS_ok) return room;
  const int levels = omp_get_max_active_levels();
  if (factor->xsize < shared_from || extrados_threads(most_threads) < most_threads) omp_set_max_active_levels(0);
  cholmod_l_factorize(&self->matrix, factor, &self->common);
  omp_set_max_active_levels(levels);
  extrados_blas_leave();
  return EXTRADOS_ok;
}

/* LL' of new values; the smallest pivot over the largest in `ratio`, its equation in `weakest`. */
static int factorise(struct extrados_sparse *self, const double *value, double *ratio, int64_t *weakest) {
  *ratio = 0.0;
  *weakest = -1;
  if (!all_finite((int64_t)self->matrix.nzmax, value)) return EXTRADOS_not_finite;
  self->matrix.x = (void *)(uintptr_t)value;
  self->matrix.xtype = CHOLMOD_REAL;
  const int room = factor_values(self, self->factor);
  if (room != EXTRADOS_ok) return room;
  if (self->common.status != CHOLMOD_OK) {
    int code = code_of(&self->common);
    *weakest = (int64_t)self->factor->minor;
    return code;
  }
  if (self->factor->minor < self->factor->n) {
    *weakest = (int64_t)self->factor->minor;
    return EXTRADOS_not_positive_definite;
  }
  const int64_t *super = self->factor->super, *pi = self->factor->pi, *px = self->factor->px;
  double least = INFINITY, most = 0.0;
  for (int64_t s = 0; s < self->blocks; s++) {
    const double *x = (const double *)self->factor->x + px[s];
    int64_t rows = pi[s + 1] - pi[s];
    for (int64_t j = super[s]; j < super[s + 1]; j++) {
      double diagonal = x[(j - super[s]) * (rows + 1)], pivot = diagonal * diagonal;
      self->d[j] = pivot;
      if (pivot < least) least = pivot, *weakest = j;
      if (pivot > most) most = pivot;
    }
  }
  *ratio = least / most;
  return EXTRADOS_ok;
}

int extrados_sparse_factor(void *handle, const double *value, double *ratio, int64_t *weakest) {
  struct extrados_sparse *self = handle;
  int code = factorise(self, value, ratio, weakest);
  if (code != EXTRADOS_ok) return code;
  const int64_t *super = self->factor->super, *pi = self->factor->pi, *px = self->factor->px;
  for (int64_t s = 0; s < self->blocks; s++) {
    double *x = (double *)self->factor->x + px[s];
    int64_t rows = pi[s + 1] - pi[s], columns = super[s + 1] - super[s];
    for (int64_t c = 0; c < columns; c++) {
      double *l = x + c * rows, scale = 1.0 / l[c];
      for (int64_t i = c; i < rows; i++) l[i] *= scale;
    }
  }
  return EXTRADOS_ok;
}

/* t[i] -= a l[i] */
static inline void subtract(int64_t count, double a, const double *restrict l, double *restrict t) {
  int64_t i = 0;
  for (; i + 4 <= count; i += 4) *(four *)(t + i) -= a * *(const four *)(l + i);
  for (; i < count; i++) t[i] -= a * l[i];
}

/* Forward through supernode s for `vectors` right-hand sides, each n long in z. */
static inline void forward_block(const struct extrados_sparse *self, int64_t s, int vectors, double *z) {
  const int64_t *super = self->factor->super, *pi = self->factor->pi;
  const int64_t *row = (const int64_t *)self->factor->s + pi[s];
  const double *x = (const double *)self->factor->x + ((const int64_t *)self->factor->px)[s];
  int64_t rows = pi[s + 1] - pi[s], columns = super[s + 1] - super[s];
  for (int v = 0; v < vectors; v++) {
    double *zv = z + v * self->n, *t = self->buffer;
    for (int64_t i = 0; i < rows; i++) t[i] = zv[row[i]];
    for (int64_t c = 0; c < columns; c++)
      if (t[c] != 0.0) subtract(rows - c - 1, t[c], x + c * rows + c + 1, t + c + 1);
    for (int64_t i = 0; i < rows; i++) zv[row[i]] = t[i];
  }
}

/* Sums l[i] t[i] from `from` on, of two columns and `vectors` right-hand sides at once: what is loaded is used
 * twice. `columns` and `vectors` are constants at each call, so that the loops over them unroll. */
__attribute__((always_inline)) static inline void products(int64_t from, int64_t rows, const double *const l[2], const double *t,
                            const int columns, const int vectors, double total[2][most_vectors]) {
  four sum[2][most_vectors] = {{{0.0}}};
  int64_t i = from;
  for (; i + 4 <= rows; i += 4)
    for (int v = 0; v < vectors; v++) {
      const four part = *(const four *)(t + v * rows + i);
      for (int k = 0; k < columns; k++) sum[k][v] += *(const four *)(l[k] + i) * part;
    }
  for (int k = 0; k < columns; k++)
    for (int v = 0; v < vectors; v++) {
      total[k][v] = (sum[k][v][0] + sum[k][v][1]) + (sum[k][v][2] + sum[k][v][3]);
      for (int64_t j = i; j < rows; j++) total[k][v] += l[k][j] * t[v * rows + j];
    }
}

/* Backward through supernode s; `vectors` is a constant at each call. */
__attribute__((always_inline)) static inline void backward_block(const struct extrados_sparse *self, int64_t s, const int vectors, double *z) {
  const int64_t *super = self->factor->super, *pi = self->factor->pi;
  const int64_t *row = (const int64_t *)self->factor->s + pi[s];
  const double *x = (const double *)self->factor->x + ((const int64_t *)self->factor->px)[s];
  int64_t rows = pi[s + 1] - pi[s], columns = super[s + 1] - super[s], n = self->n;
  double *t = self->buffer, total[2][most_vectors];
  /* The factor is walked from its end, which the processor does not foresee: the next block is asked for now. */
  if (s > 0) {
    const char *next = (const char *)((const double *)self->factor->x + ((const int64_t *)self->factor->px)[s - 1]);
    for (const char *line = next; line < (const char *)x && line < next + most_ahead; line += 64)
      __builtin_prefetch(line);
  }
  for (int v = 0; v < vectors; v++)
    for (int64_t i = 0; i < rows; i++) t[v * rows + i] = z[v * n + row[i]];
  int64_t c = columns - 1;
  for (; c > 0; c -= 2) {
    const double *l[2] = {x + c * rows, x + (c - 1) * rows};
    products(c + 1, rows, l, t, 2, vectors, total);
    for (int v = 0; v < vectors; v++) {
      t[v * rows + c] -= total[0][v];
      t[v * rows + c - 1] -= total[1][v] + l[1][c] * t[v * rows + c];
    }
  }
  if (c == 0) {
    const double *l[2] = {x, x};
    products(1, rows, l, t, 1, vectors, total);
    for (int v = 0; v < vectors; v++) t[v * rows] -= total[0][v];
  }
  for (int v = 0; v < vectors; v++)
    memcpy(z + v * n + super[s], t + v * rows, (size_t)columns * sizeof *t);
}

FOR_EACH_PROCESSOR
static void backward(const struct extrados_sparse *self, int64_t first, int64_t last, int vectors, double *z) {
  for (int64_t s = last; s >= first; s--) switch (vectors) {
      case 1: backward_block(self, s, 1, z); break;
      case 2: backward_block(self, s, 2, z); break;
      case 3: backward_block(self, s, 3, z); break;
      default: backward_block(self, s, 4, z);
    }
}

/* The supernode above s in the tree, or -1. */
static int64_t parent(const struct extrados_sparse *self, int64_t s) {
  const int64_t *super = self->factor->super, *pi = self->factor->pi;
  int64_t below = pi[s] + super[s + 1] - super[s];
  return below < pi[s + 1] ? self->block_of[((const int64_t *)self->factor->s)[below]] : -1;
}

static int64_t first_block(const struct extrados_sparse *self, int count, const int *index) {
  int first = index[0];
  for (int i = 1; i < count; i++)
    if (index[i] < first) first = index[i];
  return self->block_of[first];
}

int extrados_sparse_solve(void *handle, int vectors, double *z) {
  const struct extrados_sparse *self = handle;
  if (vectors < 1 || vectors > most_vectors) return EXTRADOS_invalid_argument;
  if (!all_finite(self->n * vectors, z)) return EXTRADOS_not_finite;
  for (int64_t s = 0; s < self->blocks; s++) forward_block(self, s, vectors, z);
  for (int v = 0; v < vectors; v++)
    for (int64_t i = 0; i < self->n; i++) z[v * self->n + i] /= self->d[i];
  backward(self, 0, self->blocks - 1, vectors, z);
  return EXTRADOS_ok;
}

int extrados_sparse_backward(void *handle, int64_t first, int64_t last, int vectors, double *z) {
  const struct extrados_sparse *self = handle;
  if (vectors < 1 || vectors > most_vectors || first < 0 || last >= self->blocks) return EXTRADOS_invalid_argument;
  backward(self, first, last, vectors, z);
  return EXTRADOS_ok;
}

void extrados_sparse_tree(void *handle, int64_t *blocks, const int64_t **column, const int64_t **start,
                          const int64_t **row) {
  const struct extrados_sparse *self = handle;
  *blocks = self->blocks;
  *column = self->factor->super;
  *start = self->factor->pi;
  *row = self->factor->s;
}

/* One column: for each change w -= wj l, then l += g w; then right-hand sides t -= tj l with the new l.
 * `changes` and `vectors` are constants at each call; the rows of w and t lie `stride` apart. */
__attribute__((always_inline)) static inline void change_column(int64_t count, int64_t stride, const int changes, const int vectors,
                                 const double *wj, const double *g, const double *tj, double *restrict l,
                                 double *restrict w, double *restrict t) {
  int64_t i = 0;
  for (; i + 4 <= count; i += 4) {
    four column = *(four *)(l + i);
    for (int k = 0; k < changes; k++) {
      four part = *(four *)(w + k * stride + i) - wj[k] * column;
      *(four *)(w + k * stride + i) = part;
      column += g[k] * part;
    }
    *(four *)(l + i) = column;
    for (int v = 0; v < vectors; v++) *(four *)(t + v * stride + i) -= tj[v] * column;
  }
  for (; i < count; i++) {
    for (int k = 0; k < changes; k++) {
      w[k * stride + i] -= wj[k] * l[i];
      l[i] += g[k] * w[k * stride + i];
    }
    for (int v = 0; v < vectors; v++) t[v * stride + i] -= tj[v] * l[i];
  }
}

/* One supernode of the changes w and the right-hand sides t, both gathered to its rows; a: product of the pivots'
 * ratios so far, by change. False where a pivot would not stay positive. */
__attribute__((always_inline)) static inline int change_block(struct extrados_sparse *self, int64_t s, const int changes, const int *sign,
                               const int vectors, double *w, double *t, double *a) {
  const int64_t *super = self->factor->super, *pi = self->factor->pi;
  double *x = (double *)self->factor->x + ((const int64_t *)self->factor->px)[s];
  int64_t rows = pi[s + 1] - pi[s], columns = super[s + 1] - super[s];
  for (int64_t c = 0; c < columns; c++) {
    double wj[most_changes], g[most_changes], tj[most_vectors], d = self->d[super[s] + c];
    int some = 0;
    for (int v = 0; v < vectors; v++) some |= (tj[v] = t[v * rows + c]) != 0.0;
    /* A change sees the entry that the changes before it left to it: w of this column is final by now. */
    for (int k = 0; k < changes; k++) {
      some |= (wj[k] = w[k * rows + c]) != 0.0;
      double next = a[k] + sign[k] * wj[k] * wj[k] / d;
      if (!(next > 0.0)) return 0;
      g[k] = sign[k] * wj[k] / (d * next);
      d *= next / a[k];
      a[k] = next;
    }
    self->d[super[s] + c] = d;
    if (some)
      change_column(rows - c - 1, rows, changes, vectors, wj, g, tj, x + c * rows + c + 1, w + c + 1, t + c + 1);
  }
  return 1;
}

FOR_EACH_PROCESSOR
static int change_any_block(struct extrados_sparse *self, int64_t s, int changes, const int *sign, int vectors,
                            double *w, double *t, double *a) {
  if (vectors == 2) switch (changes) {
      case 1: return change_block(self, s, 1, sign, 2, w, t, a);
      case 2: return change_block(self, s, 2, sign, 2, w, t, a);
      case 3: return change_block(self, s, 3, sign, 2, w, t, a);
    }
  return change_block(self, s, changes, sign, vectors, w, t, a);
}

int extrados_sparse_change(void *handle, int changes, const int *sign, int count, const int *index, const double *w,
                           int vectors, const double *b, double *z, double *least) {
  struct extrados_sparse *self = handle;
  if (count < 1 || changes < 1 || changes > most_changes || vectors < 0 || vectors > most_vectors)
    return EXTRADOS_invalid_argument;
  for (int k = 0; k < changes; k++)
    if (sign[k] != 1 && sign[k] != -1) return EXTRADOS_invalid_argument;
  const int64_t *super = self->factor->super, *pi = self->factor->pi;
  double a[most_changes];
  for (int k = 0; k < most_changes; k++) a[k] = 1.0;
  int code = EXTRADOS_ok;
  int64_t n = self->n, first = first_block(self, count, index);
  for (int64_t s = first; s >= 0; s = parent(self, s))
    for (int v = 0; v < vectors; v++)
      memset(z + v * n + super[s], 0, (size_t)(super[s + 1] - super[s]) * sizeof *z);
  for (int i = 0; i < count; i++) {
    for (int k = 0; k < changes; k++) self->column[k * n + index[i]] = w[k * count + i];
    for (int v = 0; v < vectors; v++) z[v * n + index[i]] = b[v * count + i];
  }
  for (int64_t s = first; s >= 0; s = parent(self, s)) {
    const int64_t *row = (const int64_t *)self->factor->s + pi[s];
    int64_t rows = pi[s + 1] - pi[s], columns = super[s + 1] - super[s];
    double *wt = self->buffer, *t = self->buffer + changes * rows;
    for (int k = 0; k < changes; k++)
      for (int64_t i = 0; i < rows; i++) {
        wt[k * rows + i] = self->column[k * n + row[i]];
        self->column[k * n + row[i]] = 0.0;
      }
    if (code != EXTRADOS_ok) continue; /* what is left is only cleared */
    for (int v = 0; v < vectors; v++)
      for (int64_t i = 0; i < rows; i++) t[v * rows + i] = z[v * n + row[i]];
    if (!change_any_block(self, s, changes, sign, vectors, wt, t, a)) {
      code = EXTRADOS_not_positive_definite;
      continue;
    }
    for (int k = 0; k < changes; k++)
      for (int64_t i = columns; i < rows; i++) self->column[k * n + row[i]] = wt[k * rows + i];
    for (int v = 0; v < vectors; v++) {
      for (int64_t i = 0; i < columns; i++) t[v * rows + i] /= self->d[super[s] + i];
      for (int64_t i = 0; i < rows; i++) z[v * n + row[i]] = t[v * rows + i];
    }
  }
  *least = 1.0;
  for (int k = 0; k < changes; k++)
    if (a[k] < *least) *least = a[k];
  return code;
}

/* Solutions for `vectors` right-hand sides by the present factor `of`, in place of these. */
static int solve_by(struct extrados_sparse *self, cholmod_factor *of, int vectors, double *z) {
  cholmod_dense b = {0};
  b.nrow = b.d = (size_t)self->n;
  b.ncol = (size_t)vectors;
  b.nzmax = b.nrow * b.ncol;
  b.x = z;
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  const int room = extrados_blas_enter();
  if (room != EXTRADOS_ok) return room;
  cholmod_l_solve2(CHOLMOD_A, of, &b, NULL, &self->answer, NULL, &self->y, &self->e, &self->common);
  extrados_blas_leave();
  if (self->common.status != CHOLMOD_OK) return code_of(&self->common);
  memcpy(z, self->answer->x, b.nzmax * sizeof *z);
  return EXTRADOS_ok;
}

int extrados_sparse_plain(void *handle, const double *value, int vectors, double *z) {
  struct extrados_sparse *self = handle;
  double ratio;
  int64_t weakest;
  int code = factorise(self, value, &ratio, &weakest);
  return code == EXTRADOS_ok ? solve_by(self, self->factor, vectors, z) : code;
}

/* As extrados_sparse_plain, by factors of its own: tangent matrices past a peak have negative pivots. LL' by supernodes;
 * where that fails without square roots, and without exchanges of rows, as the pattern is fixed: the caller measures the
 * residual. not_positive_definite: a zero pivot. */
int extrados_sparse_indefinite(void *handle, const double *value, int vectors, double *z) {
  struct extrados_sparse *self = handle;
  if (!all_finite((int64_t)self->matrix.nzmax, value)) return EXTRADOS_not_finite;
  self->matrix.x = (void *)(uintptr_t)value;
  self->matrix.xtype = CHOLMOD_REAL;
  if (!self->definite) self->definite = cholmod_l_analyze(&self->matrix, &self->common);
  if (!self->definite) return code_of(&self->common);
  const int room = factor_values(self, self->definite);
  if (room != EXTRADOS_ok) return room;
  self->latest = self->definite;
  if (self->common.status == CHOLMOD_OK && self->definite->minor == self->definite->n)
    return solve_by(self, self->latest, vectors, z);
  self->common.supernodal = CHOLMOD_SIMPLICIAL;
  self->common.final_ll = 0;
  if (!self->simplicial) self->simplicial = cholmod_l_analyze(&self->matrix, &self->common);
  if (self->simplicial) cholmod_l_factorize(&self->matrix, self->simplicial, &self->common);
  self->common.supernodal = CHOLMOD_SUPERNODAL;
  self->common.final_ll = 1;
  if (!self->simplicial || self->common.status != CHOLMOD_OK) return code_of(&self->common);
  self->latest = self->simplicial;
  if (self->simplicial->minor < self->simplicial->n) return EXTRADOS_not_positive_definite;
  return solve_by(self, self->latest, vectors, z);
}

/* Solutions by the factor that extrados_sparse_indefinite made last. */
int extrados_sparse_again(void *handle, int vectors, double *z) {
  struct extrados_sparse *self = handle;
  return self->latest ? solve_by(self, self->latest, vectors, z) : EXTRADOS_invalid_argument;
}
