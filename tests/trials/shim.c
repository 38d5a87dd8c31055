/* Lets one call fail: the k-th write to a file, or the k-th allocation that the core or its libraries ask for.
 *
 *   LD_PRELOAD=shim.so SHIM_WRITE=k SHIM_COUNT=FILE   open for writing, write, fsync, rename and mkdir count alike
 *   shim_allocations(first, last, k) from within      allocations called from addresses of the core */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

static atomic_long writes, fail_write = -1;

__attribute__((constructor)) static void begin(void) {
  const char *k = getenv("SHIM_WRITE");
  fail_write = k ? atol(k) : -1;
}

__attribute__((destructor)) static void end(void) {
  const char *path = getenv("SHIM_COUNT");
  if (!path) return;
  fail_write = -1;
  FILE *file = fopen(path, "w");
  if (file) fprintf(file, "%ld\n", (long)writes), fclose(file);
}

static int fails(void) { return atomic_fetch_add(&writes, 1) == fail_write ? (errno = ENOSPC, 1) : 0; }

static int is_file(int fd) {
  struct stat found;
  return fd > 2 && fstat(fd, &found) == 0 && S_ISREG(found.st_mode);
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int fd, const void *data, size_t size) { return is_file(fd) && fails() ? -1 : REAL(write)(fd, data, size); }
ssize_t pwrite64(int fd, const void *data, size_t size, off64_t at) {
  return is_file(fd) && fails() ? -1 : REAL(pwrite64)(fd, data, size, at);
}
int fsync(int fd) { return fails() ? -1 : REAL(fsync)(fd); }
int rename(const char *from, const char *to) { return fails() ? -1 : REAL(rename)(from, to); }
int mkdir(const char *path, mode_t mode) { return fails() ? -1 : REAL(mkdir)(path, mode); }
int open64(const char *path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(more, mode_t) : 0;
  va_end(more);
  if (flags & (O_WRONLY | O_RDWR) && strncmp(path, "/dev/", 5) && strncmp(path, "/proc/", 6) && fails()) return -1;
  return REAL(open64)(path, flags, mode);
}

/* Allocations */
enum { MOST = 16 };
static struct { uintptr_t from, to; } ours[MOST];
static atomic_int ranges;
static atomic_long allocations, fail_allocation = -1;

static int add(struct dl_phdr_info *info, size_t size, void *data) {
  (void)size;
  if (ranges == MOST || !strstr(info->dlpi_name, data)) return 0;
  for (int k = 0; k < info->dlpi_phnum; k++) {
    const ElfW(Phdr) *part = &info->dlpi_phdr[k];
    if (part->p_type == PT_LOAD && part->p_flags & PF_X && ranges < MOST) {
      ours[ranges].from = info->dlpi_addr + part->p_vaddr;
      ours[ranges].to = ours[ranges].from + part->p_memsz;
      ranges++;
    }
  }
  return 0;
}

/* From now on the k-th allocation asked for by the core, CHOLMOD or GSL fails; -1 none. How many there were before. */
long shim_allocations(long k) {
  if (!ranges)
    for (const char **name = (const char *[]){"/_core", "libcholmod", "libsuitesparseconfig", "libgsl.", "libamd", NULL}; *name; name++)
      dl_iterate_phdr(add, (void *)*name);
  fail_allocation = k;
  return atomic_exchange(&allocations, 0);
}

static int refused(void *caller) {
  if (!ranges) return 0;
  for (int k = 0; k < ranges; k++)
    if ((uintptr_t)caller >= ours[k].from && (uintptr_t)caller < ours[k].to)
      return atomic_fetch_add(&allocations, 1) == fail_allocation ? (errno = ENOMEM, 1) : 0;
  return 0;
}

extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
void *malloc(size_t size) { return refused(__builtin_return_address(0)) ? NULL : __libc_malloc(size); }
void *calloc(size_t count, size_t size) { return refused(__builtin_return_address(0)) ? NULL : __libc_calloc(count, size); }
void *realloc(void *old, size_t size) { return refused(__builtin_return_address(0)) ? NULL : __libc_realloc(old, size); }
