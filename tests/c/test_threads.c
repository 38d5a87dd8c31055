/* Threads that may be asked for: all that are wanted where there is room, fewer where there is none. */
#include <assert.h>
#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

#include "extrados.h"

enum { MB = 1 << 20 };

/* Addresses in use. */
static rlim_t used(void) {
  long pages = 0;
  FILE *file = fopen("/proc/self/statm", "r");
  if (!file) return 0;
  if (fscanf(file, "%ld", &pages) != 1) pages = 0;
  fclose(file);
  return (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE);
}

int main(void) {
  assert(extrados_threads(-3) == 1 && extrados_threads(0) == 1 && extrados_threads(1) == 1);
  assert(extrados_threads(2) == 2 && extrados_threads(9) == 9);
  const rlim_t now = used();
  struct rlimit before, stack;
  if (now && !getrlimit(RLIMIT_AS, &before) && !getrlimit(RLIMIT_STACK, &stack) && stack.rlim_cur != RLIM_INFINITY) {
    struct rlimit less = {now + 30 * MB + 3 * stack.rlim_cur, before.rlim_max};
    assert(!setrlimit(RLIMIT_AS, &less));
    const int some = extrados_threads(500);
    assert(some > 1 && some < 500); /* the cache of stacks may hold some more than the three */
    less.rlim_cur = used();
    assert(!setrlimit(RLIMIT_AS, &less));
    assert(extrados_threads(500) == 1);
    assert(!setrlimit(RLIMIT_AS, &before));
  }
  assert(extrados_threads(9) == 9);
  return 0;
}
