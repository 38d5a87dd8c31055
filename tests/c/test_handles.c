/* The registry of handles: each wrong use has its status, and each object is destroyed once. */
#include <assert.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "extrados.h"

enum { objects = 2000, threads = 4 };

static atomic_int destroyed[objects];
static int64_t handles[objects];

static void destroy(void *object) { atomic_fetch_add((atomic_int *)object, 1); }

static void rules(void) {
  int64_t first, second, third;
  void *object;
  assert(extrados_handle_new(EXTRADOS_handle_dem, &destroyed[0], destroy, &first) == EXTRADOS_ok);
  assert(first > 0 && extrados_handle_count() == 1);
  assert(extrados_handle_take(first, EXTRADOS_handle_sla, 1, &object) == EXTRADOS_wrong_handle && !object);
  assert(extrados_handle_take(first + 1, EXTRADOS_handle_dem, 1, &object) == EXTRADOS_closed_handle);
  assert(extrados_handle_take(0, EXTRADOS_handle_dem, 1, &object) == EXTRADOS_closed_handle);
  assert(extrados_handle_take(-first, EXTRADOS_handle_dem, 1, &object) == EXTRADOS_closed_handle);

  /* Shared twice; nobody may have it alone, or close it, until both have left. */
  assert(extrados_handle_take(first, EXTRADOS_handle_dem, 0, &object) == EXTRADOS_ok && object == &destroyed[0]);
  assert(extrados_handle_take(first, EXTRADOS_handle_dem, 0, &object) == EXTRADOS_ok);
  assert(extrados_handle_take(first, EXTRADOS_handle_dem, 1, &object) == EXTRADOS_busy && !object);
  extrados_handle_leave(first);
  assert(extrados_handle_close(first, 0) == EXTRADOS_busy);
  extrados_handle_leave(first);
  assert(extrados_handle_take(first, EXTRADOS_handle_dem, 1, &object) == EXTRADOS_ok);
  assert(extrados_handle_take(first, EXTRADOS_handle_dem, 0, &object) == EXTRADOS_busy);
  extrados_handle_leave(first);
  assert(extrados_handle_close(first, 0) == EXTRADOS_ok && destroyed[0] == 1);
  assert(extrados_handle_close(first, 0) == EXTRADOS_closed_handle && destroyed[0] == 1);

  /* The place is free again, the number is not. */
  assert(extrados_handle_new(EXTRADOS_handle_dem, &destroyed[1], destroy, &second) == EXTRADOS_ok);
  assert(second != first);
  assert(extrados_handle_take(first, EXTRADOS_handle_dem, 0, &object) == EXTRADOS_closed_handle);

  /* Closed for later: gone for all others at once, destroyed as the last call leaves. */
  assert(extrados_handle_take(second, EXTRADOS_handle_dem, 0, &object) == EXTRADOS_ok);
  assert(extrados_handle_take(second, EXTRADOS_handle_dem, 0, &object) == EXTRADOS_ok);
  assert(extrados_handle_close(second, 1) == EXTRADOS_ok && destroyed[1] == 0);
  assert(extrados_handle_take(second, EXTRADOS_handle_dem, 0, &object) == EXTRADOS_closed_handle);
  assert(extrados_handle_new(EXTRADOS_handle_dem, &destroyed[2], destroy, &third) == EXTRADOS_ok && third != second);
  extrados_handle_leave(second);
  assert(destroyed[1] == 0);
  extrados_handle_leave(second);
  assert(destroyed[1] == 1 && destroyed[2] == 0);
  assert(extrados_handle_close(third, 1) == EXTRADOS_ok && destroyed[2] == 1 && extrados_handle_count() == 0);
}

/* A name that has no room is cut, and nothing is written behind it. */
static void cut_names(void) {
  int code;
  char name[16], text[16];
  for (int k = 0; extrados_list_entry(k, &code, 8, name, 8, text); k++) {
    memset(name, 7, sizeof name);
    memset(text, 7, sizeof text);
    assert(extrados_list_entry(k, &code, 8, name, 8, text));
    for (int i = 8; i < 16; i++) assert(name[i] == 7 && text[i] == 7);
  }
}

static void *worker(void *number) {
  void *object;
  for (int k = 0; k < objects; k++) {
    const int alone = (k + *(int *)number) % 2;
    if (extrados_handle_take(handles[k], EXTRADOS_handle_motions, alone, &object) == EXTRADOS_ok) {
      assert(*(atomic_int *)object == 0); /* alive while it is used */
      extrados_handle_leave(handles[k]);
    }
    if (k % threads == *(int *)number) extrados_handle_close(handles[k], 1);
  }
  return NULL;
}

int main(void) {
  pthread_t thread[threads];
  int number[threads];
  rules();
  cut_names();
  for (int k = 0; k < objects; k++) {
    destroyed[k] = 0;
    assert(extrados_handle_new(EXTRADOS_handle_motions, &destroyed[k], destroy, &handles[k]) == EXTRADOS_ok);
  }
  for (int k = 0; k < threads; k++) {
    number[k] = k;
    assert(pthread_create(&thread[k], NULL, worker, &number[k]) == 0);
  }
  for (int k = 0; k < threads; k++) pthread_join(thread[k], NULL);
  for (int k = 0; k < objects; k++) assert(destroyed[k] == 1);
  assert(extrados_handle_count() == 0);
  puts("handles: all right");
  return 0;
}
