/* State of a controller. */
typedef struct {
  long interval;
  double deviation[FEEDBACK_READ + 1];
  double correction[FEEDBACK_DELAY + 1][FEEDBACK_INPUTS];
} feedback_state_t;

/* The row of the tables of an interval; the last one after the end. */
static int feedback_point(long interval) {
  return interval < FEEDBACK_POINTS ? (int)interval : FEEDBACK_POINTS - 1;
}

/* An input with a correction, kept within its bounds, as it acts: by its square, or as it is. */
static double feedback_acting(int input, double given, double correction) {
  const double *bound = feedback_bounds[input];
  const int squared = feedback_squared[input];
  const double low = squared ? bound[0] * bound[0] : bound[0];
  const double high = squared ? bound[1] * bound[1] : bound[1];
  const double wanted = (squared ? given * given : given) + correction;
  return wanted < low ? low : wanted > high ? high : wanted;
}

void feedback_start(feedback_state_t *self) {
  memset(self, 0, sizeof *self);
}

/* The inputs of the plan in an interval. */
void feedback_planned(long interval, double inputs[FEEDBACK_INPUTS]) {
  memcpy(inputs, feedback_given[feedback_point(interval)], sizeof feedback_given[0]);
}

/* Takes what was measured at the start of the next interval, from 0 on, and gives the inputs of the interval FEEDBACK_DELAY later. */
void feedback_step(feedback_state_t *self, const double measured[FEEDBACK_STATES], double inputs[FEEDBACK_INPUTS]) {
  const int row = feedback_point(self->interval);
  double *deviation = self->deviation;
  int i, j, k;
  /* The deviation of the last step lasted until now. */
  for (i = 0; self->interval > 0 && i < FEEDBACK_INTEGRALS; i++)
    deviation[FEEDBACK_STATES + i] += feedback_interval[0] * deviation[feedback_integrated[i]];
  /* What is no number was not measured: its deviation is that of before. */
  for (i = 0; i < FEEDBACK_STATES; i++)
    if (isfinite(measured[i]))
      deviation[i] = measured[i] - feedback_state[row][i];
  /* Corrections that act before this one. */
  for (k = 0; k < FEEDBACK_DELAY; k++)
    for (i = 0; i < FEEDBACK_INPUTS; i++) {
      const double given = feedback_given[feedback_point(self->interval + k)][i];
      const double correction = self->correction[(self->interval + k) % (FEEDBACK_DELAY + 1)][i];
      deviation[FEEDBACK_STATES + FEEDBACK_INTEGRALS + k * FEEDBACK_INPUTS + i] =
          feedback_acting(i, given, correction) - (feedback_squared[i] ? given * given : given);
    }
  for (i = 0; i < FEEDBACK_INPUTS; i++) {
    double sum = 0.0;
    for (j = 0; j < FEEDBACK_READ; j++)
      sum += feedback_gain[row][i][j] * deviation[j];
#if FEEDBACK_DELAY > 0
    /* Behind the end the goal is not quite where the motion leads. */
    sum -= feedback_offset[row][i];
#endif
    self->correction[(self->interval + FEEDBACK_DELAY) % (FEEDBACK_DELAY + 1)][i] = -sum;
  }
  for (i = 0; i < FEEDBACK_INPUTS; i++) {
    const double given = feedback_given[feedback_point(self->interval + FEEDBACK_DELAY)][i];
    const double acting = feedback_acting(i, given, self->correction[(self->interval + FEEDBACK_DELAY) % (FEEDBACK_DELAY + 1)][i]);
    inputs[i] = feedback_squared[i] ? sqrt(acting) : acting;
  }
  self->interval++;
}
