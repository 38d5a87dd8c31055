/* Four doubles at once, the same operations in the same order whatever the processor offers. */
#ifndef EXTRADOS_FOUR_H
#define EXTRADOS_FOUR_H

typedef double four __attribute__((vector_size(32), aligned(8), may_alias));
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define FOR_EACH_PROCESSOR __attribute__((target_clones("avx2", "default")))
#else
#define FOR_EACH_PROCESSOR
#endif

#endif
