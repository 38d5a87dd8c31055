#include <stdatomic.h>

#include "extrados.h"

static atomic_int flag;

void extrados_cancel_set(int value) { atomic_store_explicit(&flag, value, memory_order_relaxed); }

int extrados_cancel_get(void) { return atomic_load_explicit(&flag, memory_order_relaxed); }
