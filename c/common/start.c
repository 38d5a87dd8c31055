/* What the libraries need once, when the compiled module loads. */
#include <gsl/gsl_errno.h>

#include "extrados.h"

int extrados_library_init(void) {
  gsl_set_error_handler_off(); /* GSL's own handler ends the process */
  return extrados_blas_load();
}
