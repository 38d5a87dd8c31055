/* Lets one call fail: the k-th write to a file, or the k-th allocation that the core or its libraries ask for.
 *
 *   shim_writes(k)        open for writing, write, fsync, rename and mkdir count alike
 *   shim_allocations(k)   allocations called from addresses of the core; the place of the one that fails goes to stderr
 *
 * Both are called from within a process that has it preloaded, and return how many calls there were before. */
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

/* From now on the k-th call that changes files fails; -1 none. How many there were before. */
long shim_writes(long k) {
  fail_write = k;
  return atomic_exchange(&writes, 0);
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
int renameat2(int from_place, const char *from, int to_place, const char *to, unsigned flags) {
  return fails() ? -1 : REAL(renameat2)(from_place, from, to_place, to, flags);
}
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
    for (const char **name = (const char *[]){"/_core.", "libcholmod", "libsuitesparseconfig", "libgsl.", "libamd", NULL}; *name; name++)
      dl_iterate_phdr(add, (void *)*name);
  fail_allocation = k;
  return atomic_exchange(&allocations, 0);
}

/* Where the k-th allocation since the last call of shim_allocations was asked for. */
enum { SITES = 1 << 20 };
static uintptr_t site[SITES];
unsigned long shim_site(long k) { return k < SITES ? site[k] : 0; }

static int refused(void *caller) {
  if (!ranges) return 0;
  for (int k = 0; k < ranges; k++)
    if ((uintptr_t)caller >= ours[k].from && (uintptr_t)caller < ours[k].to) {
      const long number = atomic_fetch_add(&allocations, 1);
      if (number < SITES) site[number] = (uintptr_t)caller;
      if (number != fail_allocation) return 0;
      Dl_info where;
      if (dladdr(caller, &where)) dprintf(2, "%s+0x%lx\n", where.dli_fname, (long)((char *)caller - (char *)where.dli_fbase) - 1);
      errno = ENOMEM;
      return 1;
    }
  return 0;
}

extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
void *malloc(size_t size) { return refused(__builtin_return_address(0)) ? NULL : __libc_malloc(size); }
void *calloc(size_t count, size_t size) { return refused(__builtin_return_address(0)) ? NULL : __libc_calloc(count, size); }
void *realloc(void *old, size_t size) { return refused(__builtin_return_address(0)) ? NULL : __libc_realloc(old, size); }
