/* How many threads the system has room for. OpenMP ends the process where it cannot start one that it was asked for. */
#include <pthread.h>
#include <stddef.h>
#include <sys/mman.h>

#include "extrados.h"

enum { MOST = 1024, SPARE = 8 << 20 }; /* bytes that are left for what the threads themselves take */

static void *wait_for(void *gate) {
  pthread_mutex_lock(gate);
  pthread_mutex_unlock(gate);
  return NULL;
}

/* They are started and ended again; their stacks stay in the cache of the C library, from which OpenMP's come. */
int extrados_threads(int wanted) {
  if (wanted < 2) return 1;
  /* writable, or it would count to no limit but that of addresses; it is not touched */
  void *spare = mmap(NULL, SPARE, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (spare == MAP_FAILED) return 1;
  pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
  pthread_t thread[MOST];
  int count = 0;
  pthread_mutex_lock(&gate);
  while (count < wanted - 1 && count < MOST && pthread_create(&thread[count], NULL, wait_for, &gate) == 0) count++;
  pthread_mutex_unlock(&gate);
  for (int k = 0; k < count; k++) pthread_join(thread[k], NULL);
  munmap(spare, SPARE);
  return count + 1;
}
