/* Declarations of src/ipopt/declarations.rs, held against the header of the Ipopt at hand: this file compiles where they agree.
   TRUTH is the type that build.rs expects of Bool. */

#include <stdbool.h>
#include <IpStdCInterface.h>

typedef TRUTH Objective(int, double *, TRUTH, double *, void *);
typedef TRUTH Gradient(int, double *, TRUTH, double *, void *);
typedef TRUTH Constraint(int, double *, TRUTH, int, double *, void *);
typedef TRUTH Jacobian(int, double *, TRUTH, int, int, int *, int *, double *, void *);
typedef TRUTH Hessian(int, double *, TRUTH, double, int, double *, TRUTH, int, int *, int *, double *, void *);
typedef TRUTH Iteration(int, int, double, double, double, double, double, double, double, double, int, void *);
typedef struct IpoptProblemInfo Problem;

Problem *(*const create)(int, double *, double *, int, double *, double *, int, int, int, Objective *, Constraint *, Gradient *,
                         Jacobian *, Hessian *) = CreateIpoptProblem;
void (*const release)(Problem *) = FreeIpoptProblem;
TRUTH (*const set_text)(Problem *, char *, char *) = AddIpoptStrOption;
TRUTH (*const set_number)(Problem *, char *, double) = AddIpoptNumOption;
TRUTH (*const set_integer)(Problem *, char *, int) = AddIpoptIntOption;
TRUTH (*const set_callback)(Problem *, Iteration *) = SetIntermediateCallback;
enum ApplicationReturnStatus (*const solve)(Problem *, double *, double *, double *, double *, double *, double *,
                                            void *) = IpoptSolve;
