/* An instance of MUMPS behind functions: its structure has other places in each version, which the header at hand knows. */

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <dmumps_c.h>

_Static_assert(sizeof(MUMPS_INT) == sizeof(int), "a MUMPS with indices of 32 bits");

/* MPI_COMM_WORLD, with MPI and without. */
enum { COMM_WORLD = -987654 };

/* What a library of another version than the header would write beyond the structure. */
enum { BEYOND = 1 << 16 };

int proboscis_mumps_call(DMUMPS_STRUC_C *instance, int job, double *entries, double *right) {
    instance->job = job;
    instance->a = entries;
    instance->rhs = right;
    dmumps_c(instance);
    instance->a = NULL;
    instance->rhs = NULL;
    return instance->infog[0];
}

/* Null without memory. */
DMUMPS_STRUC_C *proboscis_mumps_begin(int symmetry) {
    DMUMPS_STRUC_C *instance = calloc(1, sizeof *instance + BEYOND);
    if (instance) {
        instance->par = 1;
        instance->sym = symmetry;
        instance->comm_fortran = COMM_WORLD;
        proboscis_mumps_call(instance, -1, NULL, NULL);
    }
    return instance;
}

void proboscis_mumps_end(DMUMPS_STRUC_C *instance) {
    proboscis_mumps_call(instance, -2, NULL, NULL);
    free(instance);
}

/* Version of the header. */
const char *proboscis_mumps_header(void) { return MUMPS_VERSION; }
/* Version of the library, where the header expects it. */
const char *proboscis_mumps_library(const DMUMPS_STRUC_C *instance, size_t *most) {
    *most = sizeof instance->version_number;
    return instance->version_number;
}

void proboscis_mumps_matrix(DMUMPS_STRUC_C *instance, int n, int64_t entries, int *rows, int *cols) {
    instance->n = n;
    instance->nnz = entries;
    instance->irn = rows;
    instance->jcn = cols;
}

int *proboscis_mumps_icntl(DMUMPS_STRUC_C *instance) { return instance->icntl; }
double *proboscis_mumps_cntl(DMUMPS_STRUC_C *instance) { return instance->cntl; }
const int *proboscis_mumps_infog(const DMUMPS_STRUC_C *instance) { return instance->infog; }
const int *proboscis_mumps_places(const DMUMPS_STRUC_C *instance) { return instance->sym_perm; }
