/* Room for OpenBLAS: one call at a time always has its buffer, a further one only where there is room for it. */
#include <assert.h>
#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

#include "extrados.h"

enum { MB = 1 << 20, MORE = 100 * MB };

/* Bytes in use: of addresses, and of what the process can write to alone. */
static int used(rlim_t *addresses, rlim_t *data) {
  long pages[6];
  FILE *file = fopen("/proc/self/statm", "r");
  if (!file) return 0;
  for (int k = 0; k < 6; k++) assert(fscanf(file, "%ld", &pages[k]) == 1);
  fclose(file);
  *addresses = (rlim_t)pages[0] * (rlim_t)sysconf(_SC_PAGESIZE);
  *data = (rlim_t)pages[5] * (rlim_t)sysconf(_SC_PAGESIZE);
  return 1;
}

int main(void) {
  assert(extrados_blas_load() == EXTRADOS_ok);
  assert(extrados_blas_enter() == EXTRADOS_ok);
  extrados_blas_leave();
  rlim_t addresses, data;
  if (!used(&addresses, &data)) return 0;
  struct rlimit before, before_data;
  assert(!getrlimit(RLIMIT_AS, &before) && !getrlimit(RLIMIT_DATA, &before_data));
  struct rlimit less = {addresses + MORE, before.rlim_max}, less_data = {data + MORE, before_data.rlim_max};
  assert(!setrlimit(RLIMIT_AS, &less));
  for (int k = 0; k < 3; k++) {
    assert(extrados_blas_enter() == EXTRADOS_ok);
    assert(extrados_blas_enter() == EXTRADOS_out_of_memory);
    extrados_blas_leave();
  }
  assert(!setrlimit(RLIMIT_AS, &before));
  assert(!setrlimit(RLIMIT_DATA, &less_data));
  assert(extrados_blas_enter() == EXTRADOS_ok);
  assert(extrados_blas_enter() == EXTRADOS_out_of_memory);
  extrados_blas_leave();
  assert(!setrlimit(RLIMIT_DATA, &before_data));
  assert(extrados_blas_enter() == EXTRADOS_ok && extrados_blas_enter() == EXTRADOS_ok);
  extrados_blas_leave();
  extrados_blas_leave();
  assert(!setrlimit(RLIMIT_AS, &less)); /* two have their buffers now */
  assert(extrados_blas_enter() == EXTRADOS_ok && extrados_blas_enter() == EXTRADOS_ok);
  assert(extrados_blas_enter() == EXTRADOS_out_of_memory);
  return 0;
}
