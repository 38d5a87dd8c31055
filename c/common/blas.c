/* Room for OpenBLAS. Its routines take a buffer of up to 128 MB of addresses for each call that runs at a time and never
 * give it back; where the system has none left they try again for ever, or crash, depending on the version. So one is
 * taken when the core is loaded, and a further one only after it has been seen that there is room for it. */
#include <pthread.h>
#include <stddef.h>
#include <sys/mman.h>

#include "extrados.h"

enum { BUFFER = 192 << 20 };

extern void dpotrf_(const char *uplo, const int *n, double *a, const int *lda, int *info, size_t uplo_length);

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int calls, buffers;

static int has_room(void) {
  void *place = mmap(NULL, BUFFER, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
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

int extrados_blas_load(void) {
  const int status = extrados_blas_enter();
  if (status != EXTRADOS_ok) return status;
  const int one = 1;
  double a = 2.385;
  int info;
  dpotrf_("L", &one, &a, &one, &info, 1);
  extrados_blas_leave();
  return EXTRADOS_ok;
}
