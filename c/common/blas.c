/* Room for OpenBLAS. Its routines take a buffer of up to 128 MB of addresses for each call that runs at a time and never
 * give it back; where the system has none left they try again for ever, or crash, depending on the version. So one is
 * taken when the core is loaded, and a further one only after it has been seen that there is room for it. OpenBLAS' own
 * threads take one each as they begin, which may be later: they are waited for, or they would take that one.
 *
 * From then on it works in the thread that calls it. Shared among threads a product is summed in another order, and the
 * last bits of a factor would follow OMP_NUM_THREADS and the number of processors. */
#define _GNU_SOURCE /* RTLD_DEFAULT */
#include <dlfcn.h>
#include <pthread.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/mman.h>

#include "extrados.h"

enum { BUFFER = 192 << 20, WIDE = 256 };

extern void dpotrf_(const char *uplo, const int *n, double *a, const int *lda, int *info, size_t uplo_length);

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int calls, buffers;

/* Nothing is touched. Pages that cannot be written would count to no limit but that of addresses. */
static int has_room(void) {
  void *place = mmap(NULL, BUFFER, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (place == MAP_FAILED) return 0;
  munmap(place, BUFFER);
  return 1;
}

int extrados_blas_enter(void) {
  pthread_mutex_lock(&lock);
  int status = EXTRADOS_ok;
  if (calls == buffers) {
    if (has_room()) {
      buffers++;
    } else {
      status = EXTRADOS_out_of_memory;
    }
  }
  if (status == EXTRADOS_ok) calls++;
  pthread_mutex_unlock(&lock);
  return status;
}

void extrados_blas_leave(void) {
  pthread_mutex_lock(&lock);
  calls--;
  pthread_mutex_unlock(&lock);
}

/* Looked up where the calls of BLAS are: another BLAS has no such routine. */
static void keep_to_one_thread(void) {
  void *symbol = dlsym(RTLD_DEFAULT, "openblas_set_num_threads");
  void (*set_threads)(int);
  *(void **)&set_threads = symbol; /* as POSIX has it: ISO C knows no such cast */
  if (symbol) set_threads(1);
}

int extrados_blas_load(void) {
  const int status = extrados_blas_enter();
  if (status != EXTRADOS_ok) return status;
  const int rows = WIDE; /* large enough to be shared among all its threads */
  int info;
  double *a = calloc(WIDE * WIDE, sizeof *a);
  if (a) {
    for (int k = 0; k < WIDE; k++) a[k * (WIDE + 1)] = 2.385;
    dpotrf_("L", &rows, a, &rows, &info, 1);
  }
  keep_to_one_thread();
  const int found = a ? EXTRADOS_ok : EXTRADOS_out_of_memory;
  free(a);
  extrados_blas_leave();
  return found;
}
