/* For which processor BLAS computes. src/driver/version_report.f90 prints it. */
#include <stdio.h>

/* OpenBLAS has it; another BLAS may be linked. */
extern char *openblas_get_corename(void) __attribute__((weak));

/* The processor in OpenBLAS's words, ending with a null character; empty with another BLAS. */
void blas_processor(char *name, int length)
{
   snprintf(name, (size_t)length, "%s", openblas_get_corename ? openblas_get_corename() : "");
}
