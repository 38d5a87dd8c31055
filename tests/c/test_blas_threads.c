/* A factor has the same bits however many threads the environment offers to BLAS: the program calls itself with one and with
 * four (OpenBLAS reads the number when it is loaded, and takes no more than there are processors) and compares. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "extrados.h"

enum { n = 400, most = n * (n + 1) / 2 }; /* one dense block, wide enough to be shared among threads */

static int64_t start[n + 1], row[most];
static double value[most], x[n];

static void solve_dense_block(void) {
  int64_t count = 0, values, weakest;
  double ratio;
  void *handle;
  for (int64_t j = 0; j < n; j++) {
    start[j] = count;
    for (int64_t i = j; i < n; i++) {
      row[count] = i;
      value[count++] = i == j ? 2.0 * n : 1.0 + sin(1.7 * (double)(i + 3 * j));
    }
    x[j] = 1.0 + 0.01 * (double)(j % 7);
  }
  start[n] = count;
  assert(extrados_sparse_new(n, start, row, &handle, &values) == EXTRADOS_ok);
  assert(extrados_sparse_factor(handle, value, &ratio, &weakest) == EXTRADOS_ok);
  assert(extrados_sparse_solve(handle, 1, x) == EXTRADOS_ok);
  extrados_sparse_free(&handle);
}

/* The solution as it is found with so many threads, in words of eight bytes. */
static void ask(const char *program, const char *threads, char *answer, size_t size) {
  char command[4096];
  snprintf(command, sizeof command, "OPENBLAS_NUM_THREADS=%s '%s' print", threads, program);
  FILE *told = popen(command, "r");
  assert(told);
  const size_t length = fread(answer, 1, size - 1, told);
  answer[length] = 0;
  assert(pclose(told) == 0 && length == n * 17);
}

int main(int arguments, char **argument) {
  if (arguments > 1) {
    assert(extrados_blas_load() == EXTRADOS_ok);
    solve_dense_block();
    for (int i = 0; i < n; i++) {
      uint64_t bits;
      memcpy(&bits, x + i, sizeof bits);
      printf("%016llx\n", (unsigned long long)bits);
    }
    return 0;
  }
  static char one[n * 17 + 2], four[n * 17 + 2];
  ask(argument[0], "1", one, sizeof one);
  ask(argument[0], "4", four, sizeof four);
  assert(!strcmp(one, four));
  return 0;
}
