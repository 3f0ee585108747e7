/* State of a controller. */
typedef struct {
  long interval;
  double deviation[FEEDBACK_READ + 1];
  double correction[FEEDBACK_DELAY + 1][FEEDBACK_INPUTS];
#if FEEDBACK_OBSERVER
  double expected[FEEDBACK_ESTIMATED];
#endif
} feedback_state_t;

/* The row of the tables of an interval; the last one after the end. */
static int feedback_point(long interval) {
  return interval < FEEDBACK_POINTS ? (int)interval : FEEDBACK_POINTS - 1;
}

/* A value as it acts: by its square, or as it is. */
static double feedback_as_acting(int input, double value) {
  return feedback_squared[input] ? value * value : value;
}

/* An input of an interval with its correction, kept within its bounds, as it acts. */
static double feedback_acting(const feedback_state_t *self, long interval, int i) {
  const double low = feedback_as_acting(i, feedback_bounds[i][0]);
  const double high = feedback_as_acting(i, feedback_bounds[i][1]);
  const double given = feedback_as_acting(i, feedback_given[feedback_point(interval)][i]);
  const double wanted = given + self->correction[interval % (FEEDBACK_DELAY + 1)][i];
  return wanted < low ? low : wanted > high ? high : wanted;
}

#if FEEDBACK_OBSERVER || FEEDBACK_DELAY > 0
/* What the bounds leave of the correction of an input in an interval. */
static double feedback_acted(const feedback_state_t *self, long interval, int i) {
  return feedback_acting(self, interval, i) - feedback_as_acting(i, feedback_given[feedback_point(interval)][i]);
}
#endif

#if FEEDBACK_FORCES > 0
/* Improves the changes of inputs that hold the goal against lasting forces, within bounds, by sweeps of coordinate descent. */
static void feedback_hold(double *deviation) {
  const double *force = deviation + FEEDBACK_STATES, small = 1e-9;
  double *against = deviation + FEEDBACK_ESTIMATED, left[FEEDBACK_FORCES];
  int sweep, i, j;
  for (j = 0; j < FEEDBACK_FORCES; j++) {
    left[j] = feedback_force_unit[j] * force[j];
    for (i = 0; i < FEEDBACK_INPUTS; i++)
      left[j] += feedback_force[j][i] * against[i];
  }
  for (sweep = 0; sweep < 50; sweep++)
    for (i = 0; i < FEEDBACK_INPUTS; i++) {
      const double goal = feedback_as_acting(i, feedback_given[FEEDBACK_POINTS - 1][i]);
      const double low = feedback_as_acting(i, feedback_bounds[i][0]) - goal;
      const double high = feedback_as_acting(i, feedback_bounds[i][1]) - goal;
      double size = 0.0, slope = 0.0, wanted, change;
      for (j = 0; j < FEEDBACK_FORCES; j++) {
        size += feedback_force[j][i] * feedback_force[j][i];
        slope += feedback_force[j][i] * left[j];
      }
      if (size == 0.0)
        continue;
      wanted = against[i] - (slope + small * size * against[i]) / (size * (1.0 + small));
      change = (wanted < low ? low : wanted > high ? high : wanted) - against[i];
      against[i] += change;
      for (j = 0; j < FEEDBACK_FORCES; j++)
        left[j] += feedback_force[j][i] * change;
    }
}
#endif

#if FEEDBACK_OBSERVER
/* Corrects the state that was expected by what was measured; what is no number was not measured. */
static void feedback_find(feedback_state_t *self, int row, const double *measured) {
  double *state = self->deviation, error[FEEDBACK_READINGS];
  int i, j;
  memcpy(state, self->expected, sizeof self->expected);
  for (j = 0; j < FEEDBACK_READINGS; j++) {
    error[j] = measured[j] - feedback_reading[row][j];
    for (i = 0; i < FEEDBACK_ESTIMATED; i++)
      error[j] -= feedback_output[row][j][i] * state[i];
    if (!isfinite(error[j]))
      error[j] = 0.0;
  }
  for (i = 0; i < FEEDBACK_ESTIMATED; i++)
    for (j = 0; j < FEEDBACK_READINGS; j++)
      state[i] += feedback_filter[row][i][j] * error[j];
#if FEEDBACK_FORCES > 0
  feedback_hold(state);
#endif
}

/* Expects the state at the start of the next interval. */
static void feedback_expect(feedback_state_t *self, int row) {
  int i, j;
  for (i = 0; i < FEEDBACK_ESTIMATED; i++) {
    self->expected[i] = self->interval + 1 == FEEDBACK_END ? feedback_jump[i] : 0.0;
    for (j = 0; j < FEEDBACK_ESTIMATED; j++)
      self->expected[i] += feedback_by_state[row][i][j] * self->deviation[j];
    for (j = 0; j < FEEDBACK_INPUTS; j++)
      self->expected[i] += feedback_by_input[row][i][j] * feedback_acted(self, self->interval, j);
  }
}
#else
/* Takes what was measured; the deviation of what is no number, and was not measured, stays that of before. */
static void feedback_find(feedback_state_t *self, int row, const double *measured) {
  int i;
  for (i = 0; i < FEEDBACK_STATES; i++)
    if (isfinite(measured[i]))
      self->deviation[i] = measured[i] - feedback_state[row][i];
}
#endif

void feedback_start(feedback_state_t *self) {
  memset(self, 0, sizeof *self);
}

/* The inputs of the plan in an interval. */
void feedback_planned(long interval, double inputs[FEEDBACK_INPUTS]) {
  memcpy(inputs, feedback_given[feedback_point(interval)], sizeof feedback_given[0]);
}

/* Takes what was measured at the start of the next interval, from 0 on, and gives the inputs of the interval FEEDBACK_DELAY later. */
void feedback_step(feedback_state_t *self, const double measured[FEEDBACK_READINGS], double inputs[FEEDBACK_INPUTS]) {
  const int row = feedback_point(self->interval);
  const long later = self->interval + FEEDBACK_DELAY;
  double *deviation = self->deviation;
  int i, j;
#if FEEDBACK_INTEGRALS > 0
  /* The deviation of the last step lasted until now. */
  for (i = 0; self->interval > 0 && i < FEEDBACK_INTEGRALS; i++)
    deviation[FEEDBACK_FOUND + i] += feedback_interval[0] * deviation[feedback_integrated[i]];
#endif
  feedback_find(self, row, measured);
#if FEEDBACK_DELAY > 0
  /* Corrections that act before this one. */
  for (j = 0; j < FEEDBACK_DELAY; j++)
    for (i = 0; i < FEEDBACK_INPUTS; i++)
      deviation[FEEDBACK_FOUND + FEEDBACK_INTEGRALS + j * FEEDBACK_INPUTS + i] =
          feedback_acted(self, self->interval + j, i);
#endif
  for (i = 0; i < FEEDBACK_INPUTS; i++) {
    double sum = 0.0;
    for (j = 0; j < FEEDBACK_READ; j++)
      sum += feedback_gain[row][i][j] * deviation[j];
#if FEEDBACK_DELAY > 0
    /* Behind the end the goal is not quite where the motion leads. */
    sum -= feedback_offset[row][i];
#endif
    self->correction[later % (FEEDBACK_DELAY + 1)][i] = -sum;
  }
  for (i = 0; i < FEEDBACK_INPUTS; i++) {
    const double acting = feedback_acting(self, later, i);
    inputs[i] = feedback_squared[i] ? sqrt(acting) : acting;
  }
#if FEEDBACK_OBSERVER
  feedback_expect(self, row);
#endif
  self->interval++;
}
