/* Steps of a controller: a line of time and state on standard input, one of source and inputs on standard output; "late" in place of a state. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proboscis.h"

int main(int count, char **arguments) {
  char message[400], line[400];
  size_t i, states, inputs;
  double *measured, *voltages;
  proboscis_controller *controller;
  if (count < 3) return 2;
  controller = proboscis_create(arguments[1], (size_t)atol(arguments[2]), message, sizeof message);
  if (controller == NULL) {
    puts(message);
    return 1;
  }
  states = proboscis_measured_count(controller);
  inputs = proboscis_input_count(controller);
  measured = malloc(states * sizeof *measured);
  voltages = malloc(inputs * sizeof *voltages);
  printf("%.17g %lu %lu\n", proboscis_interval(controller), (unsigned long)states, (unsigned long)inputs);
  for (i = 0; proboscis_measured_name(controller, i) != NULL; i++) puts(proboscis_measured_name(controller, i));
  for (i = 0; proboscis_input_name(controller, i) != NULL; i++) puts(proboscis_input_name(controller, i));
  while (fgets(line, sizeof line, stdin) != NULL) {
    char *at = line;
    double time = strtod(at, &at);
    int is_late = strstr(at, "late") != NULL;
    for (i = 0; i < states && !is_late; i++) measured[i] = strtod(at, &at);
    printf("%d", proboscis_step(controller, time, is_late ? NULL : measured, voltages));
    for (i = 0; i < inputs; i++) printf(" %.17g", voltages[i]);
    puts("");
    proboscis_prepare(controller);
  }
  printf("%d\n", proboscis_step(NULL, 0.0, NULL, voltages));
  proboscis_free(controller);
  free(measured);
  free(voltages);
  return 0;
}
