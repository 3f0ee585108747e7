/* Controllers of proboscis: inputs of each interval of a control problem, planned anew from what is measured at its start.
 *
 *     proboscis_controller *c = proboscis_create("trunk.json", 20, message, sizeof message);
 *     for (;;) {
 *       wait for the start of an interval, measure
 *       source = proboscis_step(c, time, measured, inputs);
 *       put out the inputs
 *       proboscis_prepare(c);
 *     }
 *
 * Numbers are in SI units. Neither a step nor a preparation allocates memory or waits for anything; both take a bounded time. A controller belongs
 * to one thread at a time. Link with -lproboscis_c -lm.
 */
#ifndef PROBOSCIS_H
#define PROBOSCIS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct proboscis_controller proboscis_controller;

/* Origin of the inputs of a step. */
enum proboscis_source {
  PROBOSCIS_WRONG = -1,    /* a controller or a place for inputs is NULL, or the step broke off: no inputs */
  PROBOSCIS_PLAN = 0,      /* the plan, with what was measured */
  PROBOSCIS_LATE = 1,      /* the plan as it was: nothing was measured in time */
  PROBOSCIS_UNUSABLE = 2,  /* the plan as it was: what was measured is no state of the robot */
  PROBOSCIS_KEPT = 3,      /* the plan as it was: its iteration failed */
  PROBOSCIS_REGULATOR = 4  /* gains of the regulator: the plan has failed, and begins anew */
};

/* Solves the control problem of a JSON file and prepares a controller that looks ahead over a number of its intervals. NULL if there is none: the
 * message, of at most size bytes with its end, says why. */
proboscis_controller *proboscis_create(const char *problem, size_t intervals, char *message, size_t size);

void proboscis_free(proboscis_controller *controller);

/* Length of the intervals in s. */
double proboscis_interval(const proboscis_controller *controller);

/* Numbers of what is measured and of inputs, and their names with units, such as "rate of coordinate of joint1 in rad/s"; NULL behind the last. */
size_t proboscis_measured_count(const proboscis_controller *controller);
size_t proboscis_input_count(const proboscis_controller *controller);
const char *proboscis_measured_name(const proboscis_controller *controller, size_t place);
const char *proboscis_input_name(const proboscis_controller *controller, size_t place);

/* The inputs that act from a time in s on, or the delay of the feedback later, within their bounds, with what is measured at that time; NULL where
 * it did not come before a deadline. Returns a proboscis_source. Called again within an interval, or at
 * a time that is no finite number, it gives the same inputs. */
int proboscis_step(proboscis_controller *controller, double time, const double *measured, double *inputs);

/* Prepares the next step, when the inputs went out; otherwise that step does it first. */
void proboscis_prepare(proboscis_controller *controller);

#ifdef __cplusplus
}
#endif

#endif
