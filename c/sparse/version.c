#include <cholmod.h>

#include "extrados.h"

int extrados_cholmod_version(void) {
  int v[3];
  cholmod_version(v);
  return v[0] * 10000 + v[1] * 100 + v[2];
}
