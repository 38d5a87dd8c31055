/* Room for OpenBLAS: one call at a time always has its buffer, a further one only where there is room for it. */
#include <assert.h>
#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

#include "extrados.h"

enum { MB = 1 << 20 };

int main(void) {
  assert(extrados_blas_load() == EXTRADOS_ok);
  assert(extrados_blas_enter() == EXTRADOS_ok);
  extrados_blas_leave();
  long pages = 0;
  FILE *file = fopen("/proc/self/statm", "r");
  if (!file) return 0;
  assert(fscanf(file, "%ld", &pages) == 1);
  fclose(file);
  struct rlimit before;
  assert(!getrlimit(RLIMIT_AS, &before));
  struct rlimit less = {(rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + 100 * MB, before.rlim_max};
  assert(!setrlimit(RLIMIT_AS, &less));
  for (int k = 0; k < 3; k++) {
    assert(extrados_blas_enter() == EXTRADOS_ok);
    assert(extrados_blas_enter() == EXTRADOS_out_of_memory);
    extrados_blas_leave();
  }
  assert(!setrlimit(RLIMIT_AS, &before));
  assert(extrados_blas_enter() == EXTRADOS_ok && extrados_blas_enter() == EXTRADOS_ok);
  extrados_blas_leave();
  extrados_blas_leave();
  assert(!setrlimit(RLIMIT_AS, &less)); /* two have their buffers now */
  assert(extrados_blas_enter() == EXTRADOS_ok && extrados_blas_enter() == EXTRADOS_ok);
  assert(extrados_blas_enter() == EXTRADOS_out_of_memory);
  return 0;
}
