#include <string.h>

#include "extrados.h"

struct entry {
  int code;
  const char *name, *text;
};

#define TABLE_ENTRY(code, name, text) {code, #name, text},
static const struct entry table[] = {EXTRADOS_STATUS_LIST(TABLE_ENTRY)};

static void put(const char *from, int size, char *to) {
  if (size < 1) return;
  strncpy(to, from, (size_t)size - 1);
  to[size - 1] = '\0';
}

int extrados_status_entry(int index, int *code, int name_size, char *name, int text_size, char *text) {
  if (index < 0 || index >= (int)(sizeof table / sizeof table[0])) return 0;
  *code = table[index].code;
  put(table[index].name, name_size, name);
  put(table[index].text, text_size, text);
  return 1;
}
