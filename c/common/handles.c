/* A handle is the number of its slot and a serial that never comes again: serial * 2^20 + slot. A number that is
 * not that of a living object finds its slot empty or taken by another serial, so it can never reach a stranger. */
#include <pthread.h>
#include <stdlib.h>

#include "extrados.h"

enum { slot_bits = 20, alone_mark = -1 };

struct slot {
  int64_t handle; /* 0: free */
  void *object;
  extrados_destroy destroy;
  int kind;
  int users;  /* calls that share the object; alone_mark: one that changes it */
  int doomed; /* destroy as the last call leaves */
};

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static struct slot *slots;
static int64_t room, serial;

static struct slot *find(int64_t handle) {
  int64_t place = handle & ((INT64_C(1) << slot_bits) - 1);
  if (handle <= 0 || place >= room || slots[place].handle != handle) return NULL;
  return &slots[place];
}

int extrados_handle_new(int kind, void *object, extrados_destroy destroy, int64_t *handle) {
  int code = EXTRADOS_ok;
  int64_t place = 0;
  *handle = 0;
  pthread_mutex_lock(&lock);
  while (place < room && slots[place].handle) place++;
  if (place == room) {
    int64_t wanted = room ? 2 * room : 64;
    struct slot *longer = wanted <= INT64_C(1) << slot_bits ? realloc(slots, (size_t)wanted * sizeof *slots) : NULL;
    if (longer) {
      for (int64_t k = room; k < wanted; k++) longer[k] = (struct slot){0};
      slots = longer;
      room = wanted;
    } else {
      code = EXTRADOS_out_of_memory;
    }
  }
  if (code == EXTRADOS_ok) {
    *handle = (++serial << slot_bits) | place;
    slots[place] = (struct slot){*handle, object, destroy, kind, 0, 0};
  }
  pthread_mutex_unlock(&lock);
  return code;
}

int extrados_handle_take(int64_t handle, int kind, int alone, void **object) {
  int code = EXTRADOS_ok;
  *object = NULL;
  pthread_mutex_lock(&lock);
  struct slot *it = find(handle);
  if (!it || it->doomed)
    code = EXTRADOS_closed_handle;
  else if (it->kind != kind)
    code = EXTRADOS_wrong_handle;
  else if (it->users == alone_mark || (alone && it->users))
    code = EXTRADOS_busy;
  else {
    it->users = alone ? alone_mark : it->users + 1;
    *object = it->object;
  }
  pthread_mutex_unlock(&lock);
  return code;
}

/* Empty a slot; what is returned is destroyed outside the lock. */
static struct slot clear(struct slot *it) {
  struct slot was = *it;
  *it = (struct slot){0};
  return was;
}

void extrados_handle_leave(int64_t handle) {
  struct slot gone = {0};
  pthread_mutex_lock(&lock);
  struct slot *it = find(handle);
  if (it && it->users) {
    it->users = it->users == alone_mark ? 0 : it->users - 1;
    if (it->doomed && !it->users) gone = clear(it);
  }
  pthread_mutex_unlock(&lock);
  if (gone.destroy) gone.destroy(gone.object);
}

int extrados_handle_close(int64_t handle, int later) {
  int code = EXTRADOS_ok;
  struct slot gone = {0};
  pthread_mutex_lock(&lock);
  struct slot *it = find(handle);
  if (!it || it->doomed)
    code = EXTRADOS_closed_handle;
  else if (!it->users)
    gone = clear(it);
  else if (later)
    it->doomed = 1;
  else
    code = EXTRADOS_busy;
  pthread_mutex_unlock(&lock);
  if (gone.destroy) gone.destroy(gone.object);
  return code;
}

int extrados_handle_count(void) {
  int count = 0;
  pthread_mutex_lock(&lock);
  for (int64_t k = 0; k < room; k++) count += slots[k].handle != 0;
  pthread_mutex_unlock(&lock);
  return count;
}
