/* Functions of the C part, called from Fortran through bind(c) interfaces only.
 * Every function that can fail returns a code of extrados_status.h; none prints,
 * stops the process or keeps state, apart from the cancel flag. */
#ifndef EXTRADOS_H
#define EXTRADOS_H

#include <stdint.h>

#include "extrados_status.h"

#define EXTRADOS_API __attribute__((visibility("hidden")))

/* status.c: entry `index` (0-based) of the list; returns 0 past its end. */
EXTRADOS_API int extrados_status_entry(int index, int *code, int name_size, char *name,
                                       int text_size, char *text);

/* cancel.c: the flag behind Ctrl-C, shared by all threads. */
EXTRADOS_API void extrados_cancel_set(int value);
EXTRADOS_API int extrados_cancel_get(void);

/* random.c: `count` independent uniform phases in [0, 2 pi) from one seed. */
EXTRADOS_API int extrados_random_phases(int64_t seed, int64_t count, double *phase);
EXTRADOS_API void extrados_library_init(void);

/* version.c: the linked CHOLMOD as major*10000 + minor*100 + patch. */
EXTRADOS_API int extrados_cholmod_version(void);

#endif
