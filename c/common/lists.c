#include <string.h>

#include "extrados.h"

struct entry {
  int code;
  const char *name, *text;
};

#define TABLE_ENTRY(code, name, text) {code, #name, text},
#define LIST_HEAD(list, entries) {-1, #list, ""}, entries(TABLE_ENTRY)
/* A code of -1 opens a list. */
static const struct entry table[] = {EXTRADOS_LISTS(LIST_HEAD)};

static void put(const char *list, const char *from, int size, char *to) {
  if (size < 1) return;
  memset(to, '\0', (size_t)size);
  if (list) {
    strncat(to, list, (size_t)size - 1);
    strncat(to, ".", (size_t)size - 1 - strlen(to));
  }
  strncat(to, from, (size_t)size - 1 - strlen(to));
}

int extrados_list_entry(int index, int *code, int name_size, char *name, int text_size, char *text) {
  const char *list = NULL;
  for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
    if (table[i].code < 0) {
      list = table[i].name;
    } else if (index-- == 0) {
      *code = table[i].code;
      put(list, table[i].name, name_size, name);
      put(NULL, table[i].text, text_size, text);
      return 1;
    }
  }
  return 0;
}
