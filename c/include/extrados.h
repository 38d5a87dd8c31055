/* Functions of the C part, called from Fortran through bind(c) interfaces only.
 * Every function that can fail returns a code of extrados_status.h; none prints,
 * stops the process or keeps state, apart from the cancel flag, the
 * signals that set it and the registry of handles. */
#ifndef EXTRADOS_H
#define EXTRADOS_H

#include <stdint.h>

#include "extrados_lists.h"

#define EXTRADOS_API __attribute__((visibility("hidden")))

/* lists.c: entry `index` (0-based) of all lists of extrados_lists.h, one behind the other: its list and its name
 * in `name` as "LIST.NAME", its word in `text`; returns 0 past the end. */
EXTRADOS_API int extrados_list_entry(int index, int *code, int name_size, char *name, int text_size, char *text);

/* handles.c: objects that live between calls, behind numbers that are never given twice. Every function but the
 * first answers closed_handle for a number that is not in use. The registry is the core's only state beside the
 * cancel flag; a lock guards it. */
typedef void (*extrados_destroy)(void *object);
EXTRADOS_API int extrados_handle_new(int kind, void *object, extrados_destroy destroy, int64_t *handle);
/* The object behind a handle for the length of a call: `alone` 1 where the call changes it, 0 where calls may share
 * it. wrong_handle for another kind, busy where another call stands in the way. Each take needs its leave. */
EXTRADOS_API int extrados_handle_take(int64_t handle, int kind, int alone, void **object);
EXTRADOS_API void extrados_handle_leave(int64_t handle);
/* Destroy the object. While a call uses it: busy, or, with `later`, destroyed as that call leaves. */
EXTRADOS_API int extrados_handle_close(int64_t handle, int later);
/* Handles in use. */
EXTRADOS_API int extrados_handle_count(void);

/* cancel.c: the flag behind Ctrl-C, shared by all threads. */
EXTRADOS_API void extrados_cancel_set(int value);
EXTRADOS_API int extrados_cancel_get(void);
/* 1 where the flag is set and nothing has looked at it since: what ended meanwhile does not know. */
EXTRADOS_API int extrados_cancel_unheard(void);
/* While `on` was said more often than off, SIGINT and SIGTERM set the flag before they are answered as ever: for
 * computations in threads that may not touch Python's handlers. The handlers come back after. */
EXTRADOS_API void extrados_watch_signals(int on);

/* blas.c: `enter` before a call of BLAS or LAPACK that may run beside others, `leave` after it; out_of_memory where
 * there is no room for its buffer. `load`, once at the start, takes the buffer of the first and keeps BLAS to one thread. */
EXTRADOS_API int extrados_blas_enter(void);
EXTRADOS_API void extrados_blas_leave(void);
EXTRADOS_API int extrados_blas_load(void);

/* threads.c: as many of `wanted` threads as can be started now, at least 1. */
EXTRADOS_API int extrados_threads(int wanted);

/* start.c: GSL returns errors instead of ending the process, BLAS has its first buffer. */
EXTRADOS_API int extrados_library_init(void);

/* ldl.c: a symmetric sparse system, lower triangle by columns, 0-based. `order` gives the fill-reducing
 * order (ordering 0 AMD, 1 METIS; order[new] = old); everything after it expects equations in that order. */
EXTRADOS_API int extrados_sparse_order(int64_t n, const int64_t *start, const int64_t *row, int ordering,
                                       int64_t *order);
/* Analyse only: `values` doubles will hold the factor. The pattern must outlive the handle. */
EXTRADOS_API int extrados_sparse_new(int64_t n, const int64_t *start, const int64_t *row, void **handle,
                                     int64_t *values);
EXTRADOS_API void extrados_sparse_free(void **handle);
/* LDL' of new values; the smallest over the largest pivot, and the equation of the smallest (or the first
 * that is not positive). */
EXTRADOS_API int extrados_sparse_factor(void *handle, const double *value, double *ratio, int64_t *weakest);
EXTRADOS_API int extrados_sparse_solve(void *handle, int vectors, double *z);
enum { extrados_most_changes = 5 }; /* of one event: most_rank of fortran/sla/group.f90 */
/* K + sum sign(k) w(k) w(k)' for up to extrados_most_changes changes with `count` entries each at `index` (0-based, of one element), in
 * one walk up the elimination tree. On its way right-hand sides b with entries at the same places go forward through
 * the new factor: z gets them over D at the equations of the path. `least`: smallest det(K + w w') / det(K) of the
 * changes. After not_positive_definite the factor must be made anew. */
EXTRADOS_API int extrados_sparse_change(void *handle, int changes, const int *sign, int count, const int *index,
                                        const double *w, int vectors, const double *b, double *z, double *least);
/* Backward through the supernodes last to first: z holds what is known above them, and theirs over D. */
EXTRADOS_API int extrados_sparse_backward(void *handle, int64_t first, int64_t last, int vectors, double *z);
/* The supernodes: columns column[s] to column[s + 1] of s, which are its first rows; its rows are
 * row[start[s]] to row[start[s + 1]]. All belong to the handle. */
EXTRADOS_API void extrados_sparse_tree(void *handle, int64_t *blocks, const int64_t **column, const int64_t **start,
                                       const int64_t **row);
/* Factorise and solve by CHOLMOD alone: the algorithm the updates are compared with. */
EXTRADOS_API int extrados_sparse_plain(void *handle, const double *value, int vectors, double *z);
EXTRADOS_API int extrados_sparse_indefinite(void *handle, const double *value, int vectors, double *z);
EXTRADOS_API int extrados_sparse_again(void *handle, int vectors, double *z);

/* band.c: a symmetric positive matrix of n equations, `width` of them down from the diagonal, the lower triangle by columns
 * of width + 1; the factor takes its place, with the inverse of each pivot. not_positive_definite where a pivot is negative, or lost
 * in rounding. */
EXTRADOS_API int extrados_band_factor(int64_t n, int64_t width, double *band);
EXTRADOS_API void extrados_band_solve(int64_t n, int64_t width, const double *band, double *x);

/* envelope.c: `rows` (3 or 6) rows of Cholesky's factor from row i on, in the columns before i; the rows above are those of the factor;
 * invalid_argument for any other number of rows */
EXTRADOS_API void extrados_envelope_rows(int32_t rows, int32_t i, const int32_t *first, const int32_t *start, double *a,
                                         int32_t *status);

#endif
