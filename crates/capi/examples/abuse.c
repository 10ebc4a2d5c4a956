/* What a filter must survive: null pointers, numbers that are none, memory that is no filter. */
#include "undrift.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures;

#define EXPECT(call, expected)                                                                              \
    do {                                                                                                    \
        undrift_status status = (call);                                                                     \
        if (status != (expected)) {                                                                         \
            printf("line %d: %s, not %s\n", __LINE__, undrift_error_text(status),                           \
                   undrift_error_text(expected));                                                           \
            failures++;                                                                                     \
        }                                                                                                   \
    } while (0)

int main(void)
{
    undrift_sensor sensors[UNDRIFT_AXES], sensor, bad;
    undrift_prior priors[UNDRIFT_PARAMETERS];
    undrift_start start, wrong;
    undrift_sample sample;
    undrift_position position;
    undrift_velocity velocity;
    undrift_gate gate;
    undrift_update done;
    undrift_state before, after;
    undrift_filter *filter = NULL, *none = NULL;
    double covariance[33 * 33], six[6] = {0}, more[6];
    size_t size = undrift_filter_size(), n;
    char *memory = malloc(size + 1);
    int i;

    if (memory == NULL)
        return 1;
    memset(memory, 0x55, size + 1);
    memset(priors, 0, sizeof priors);
    memset(&start, 0, sizeof start);
    memset(&position, 0, sizeof position);
    memset(&velocity, 0, sizeof velocity);
    for (i = 0; i < 3; i++) {
        start.position_std[i] = start.velocity_std[i] = 1;
        start.attitude_std[i] = 0.02;
        position.covariance[i][i] = velocity.covariance[i][i] = 0.01;
    }

    /* Models. */
    EXPECT(undrift_sensor_white(1e-3, 0.01, NULL), UNDRIFT_STATUS_NULL_POINTER);
    EXPECT(undrift_sensor_white(NAN, 0.01, &sensor), UNDRIFT_STATUS_OUT_OF_RANGE);
    EXPECT(undrift_sensor_white(1e-3, 0, &sensor), UNDRIFT_STATUS_OUT_OF_RANGE);
    EXPECT(undrift_sensor_arma(NULL, 2, NULL, 0, 1, 0.01, &sensor), UNDRIFT_STATUS_NULL_POINTER);
    EXPECT(undrift_sensor_arma(six, 7, NULL, 0, 1, 0.01, &sensor), UNDRIFT_STATUS_TOO_MANY_STATES);
    EXPECT(undrift_sensor_arma(six, (size_t)-1, NULL, 0, 1, 0.01, &sensor), UNDRIFT_STATUS_TOO_MANY_STATES);
    six[0] = 1.1;
    EXPECT(undrift_sensor_arma(six, 1, NULL, 0, 1, 0.01, &sensor), UNDRIFT_STATUS_UNSTABLE);
    EXPECT(undrift_sensor_constant(1e-3, 0.02, &bad), UNDRIFT_STATUS_OK);
    EXPECT(undrift_sensor_white(1e-3, 0.01, &sensor), UNDRIFT_STATUS_OK);
    EXPECT(undrift_sensor_add(&sensor, &bad, &bad), UNDRIFT_STATUS_INTERVALS_DIFFER);
    EXPECT(undrift_sensor_add(&sensor, NULL, &bad), UNDRIFT_STATUS_NULL_POINTER);
    EXPECT(undrift_sensor_at_interval(&sensor, -1, &bad), UNDRIFT_STATUS_OUT_OF_RANGE);
    EXPECT(undrift_sensor_gauss_markov(1e-3, 100, 0.01, &bad), UNDRIFT_STATUS_OK);
    EXPECT(undrift_sensor_add(&sensor, &bad, &sensor), UNDRIFT_STATUS_OK);
    for (i = 0; i < UNDRIFT_AXES; i++)
        sensors[i] = sensor;

    /* Starts. */
    EXPECT(undrift_filter_init(NULL, size, &start, sensors, NULL, &filter), UNDRIFT_STATUS_NULL_POINTER);
    EXPECT(undrift_filter_init(memory, size, NULL, sensors, NULL, &filter), UNDRIFT_STATUS_NULL_POINTER);
    EXPECT(undrift_filter_init(memory, size, &start, NULL, NULL, &filter), UNDRIFT_STATUS_NULL_POINTER);
    EXPECT(undrift_filter_init(memory, size, &start, sensors, NULL, NULL), UNDRIFT_STATUS_NULL_POINTER);
    EXPECT(undrift_filter_init(memory, size - 1, &start, sensors, NULL, &filter), UNDRIFT_STATUS_TOO_SMALL);
    EXPECT(undrift_filter_init(memory + 1, size, &start, sensors, NULL, &filter), UNDRIFT_STATUS_MISALIGNED);
    wrong = start;
    wrong.velocity[1] = NAN;
    EXPECT(undrift_filter_init(memory, size, &wrong, sensors, NULL, &filter), UNDRIFT_STATUS_NOT_FINITE);
    wrong = start;
    wrong.latitude = 2;
    EXPECT(undrift_filter_init(memory, size, &wrong, sensors, NULL, &filter), UNDRIFT_STATUS_OUT_OF_RANGE);
    wrong = start;
    wrong.attitude_std[2] = -1;
    EXPECT(undrift_filter_init(memory, size, &wrong, sensors, NULL, &filter), UNDRIFT_STATUS_OUT_OF_RANGE);
    sensors[3].order = 4000000000u;
    EXPECT(undrift_filter_init(memory, size, &start, sensors, NULL, &filter), UNDRIFT_STATUS_TOO_MANY_STATES);
    sensors[3] = sensor;
    sensors[3].s[0] = 1;
    EXPECT(undrift_filter_init(memory, size, &start, sensors, NULL, &filter), UNDRIFT_STATUS_BAD_SENSOR);
    sensors[3] = sensor;
    sensors[3].f[0][0] = INFINITY;
    EXPECT(undrift_filter_init(memory, size, &start, sensors, NULL, &filter), UNDRIFT_STATUS_NOT_FINITE);
    sensors[3] = sensor;
    EXPECT(undrift_sensor_white(1e-3, 0.02, &sensors[3]), UNDRIFT_STATUS_OK);
    EXPECT(undrift_filter_init(memory, size, &start, sensors, NULL, &filter),
           UNDRIFT_STATUS_INTERVALS_DIFFER);
    sensors[3] = sensor;
    for (i = 0; i < UNDRIFT_PARAMETERS; i++)
        priors[i].std = 1e-3;
    EXPECT(undrift_filter_init(memory, size, &start, sensors, priors, &filter),
           UNDRIFT_STATUS_TOO_MANY_STATES);
    if (filter != NULL) {
        printf("a failed start leaves a filter\n");
        failures++;
    }

    /* Memory that is no filter. */
    EXPECT(undrift_check((undrift_filter *)(void *)memory), UNDRIFT_STATUS_NOT_INITIALISED);
    EXPECT(undrift_predict((undrift_filter *)(void *)memory, NULL), UNDRIFT_STATUS_NOT_INITIALISED);
    EXPECT(undrift_predict(none, &sample), UNDRIFT_STATUS_NULL_POINTER);
    EXPECT(undrift_get_state(none, &after), UNDRIFT_STATUS_NULL_POINTER);
    EXPECT(undrift_update_position(none, NULL, NULL, NULL, NULL), UNDRIFT_STATUS_NULL_POINTER);

    /* A filter, and what must leave it as it is. */
    memset(priors, 0, sizeof priors);
    priors[UNDRIFT_PARAMETER_LEVER_ARM].std = 0.1;
    EXPECT(undrift_filter_init(memory, size, &start, sensors, priors, &filter), UNDRIFT_STATUS_OK);
    memset(&sample, 0, sizeof sample);
    sample.time = sample.dt = 0.01;
    sample.dvel[2] = -0.0978;
    EXPECT(undrift_predict(filter, &sample), UNDRIFT_STATUS_OK);
    EXPECT(undrift_get_state(filter, &before), UNDRIFT_STATUS_OK);
    EXPECT(undrift_predict(filter, NULL), UNDRIFT_STATUS_NULL_POINTER);
    EXPECT(undrift_predict(filter, &sample), UNDRIFT_STATUS_GAP);
    sample.time = 0.05;
    EXPECT(undrift_predict(filter, &sample), UNDRIFT_STATUS_GAP);
    sample.time = 0.02;
    sample.dt = 0;
    EXPECT(undrift_predict(filter, &sample), UNDRIFT_STATUS_OUT_OF_RANGE);
    sample.dt = NAN;
    EXPECT(undrift_predict(filter, &sample), UNDRIFT_STATUS_NOT_FINITE);
    sample.dt = 0.01;
    sample.dtheta[1] = INFINITY;
    EXPECT(undrift_predict(filter, &sample), UNDRIFT_STATUS_NOT_FINITE);
    sample.dtheta[1] = 0;
    sample.dvel[0] = 1e9;
    EXPECT(undrift_predict(filter, &sample), UNDRIFT_STATUS_OUT_OF_RANGE);
    sample.dvel[0] = 0;
    sample.time = 1e6;
    sample.dt = 1e6 - 0.01;
    EXPECT(undrift_predict(filter, &sample), UNDRIFT_STATUS_OUT_OF_RANGE);
    EXPECT(undrift_sample_advance(filter, NAN, 0), UNDRIFT_STATUS_NOT_FINITE);
    EXPECT(undrift_sample_advance(filter, 0, -1), UNDRIFT_STATUS_OUT_OF_RANGE);
    EXPECT(undrift_update_position(filter, NULL, NULL, NULL, NULL), UNDRIFT_STATUS_NULL_POINTER);
    position.latitude = NAN;
    EXPECT(undrift_update_position(filter, &position, NULL, NULL, NULL), UNDRIFT_STATUS_NOT_FINITE);
    position.latitude = 3;
    EXPECT(undrift_update_position(filter, &position, NULL, NULL, NULL), UNDRIFT_STATUS_OUT_OF_RANGE);
    position.latitude = 0;
    position.covariance[0][0] = 0;
    EXPECT(undrift_update_position(filter, &position, NULL, NULL, NULL), UNDRIFT_STATUS_BAD_MEASUREMENT);
    position.covariance[0][0] = 0.01;
    position.covariance[0][1] = 0.005;
    EXPECT(undrift_update_position(filter, &position, NULL, NULL, NULL), UNDRIFT_STATUS_BAD_MEASUREMENT);
    position.covariance[0][1] = 0;
    six[0] = NAN;
    EXPECT(undrift_update_position(filter, &position, six, NULL, NULL), UNDRIFT_STATUS_NOT_FINITE);
    EXPECT(undrift_set_sensor_error(filter, six), UNDRIFT_STATUS_NOT_FINITE);
    EXPECT(undrift_set_sensor_error(filter, NULL), UNDRIFT_STATUS_NULL_POINTER);
    gate.weaken = NAN;
    gate.reject = 1;
    EXPECT(undrift_update_velocity(filter, &velocity, NULL, &gate, NULL), UNDRIFT_STATUS_NOT_FINITE);
    gate.weaken = -1;
    EXPECT(undrift_update_velocity(filter, &velocity, NULL, &gate, NULL), UNDRIFT_STATUS_OUT_OF_RANGE);
    gate.weaken = 2;
    EXPECT(undrift_update_velocity(filter, &velocity, NULL, &gate, NULL), UNDRIFT_STATUS_OUT_OF_RANGE);
    velocity.velocity[0] = 1e12;
    EXPECT(undrift_update_velocity(filter, &velocity, NULL, NULL, NULL), UNDRIFT_STATUS_OUT_OF_RANGE);
    velocity.velocity[0] = 0;
    EXPECT(undrift_update_zero_velocity(filter, 0, NULL, NULL), UNDRIFT_STATUS_OUT_OF_RANGE);
    EXPECT(undrift_update_odometer(filter, NAN, 1, NULL, NULL, NULL), UNDRIFT_STATUS_NOT_FINITE);
    EXPECT(undrift_update_height(filter, 1, INFINITY, NULL, NULL), UNDRIFT_STATUS_NOT_FINITE);
    EXPECT(undrift_update_non_holonomic(filter, NULL, 1, NAN, NULL, NULL), UNDRIFT_STATUS_NOT_FINITE);
    EXPECT(undrift_get_state(filter, NULL), UNDRIFT_STATUS_NULL_POINTER);
    n = undrift_states(filter);
    EXPECT(undrift_get_covariance(filter, covariance, n * n - 1), UNDRIFT_STATUS_TOO_SMALL);
    EXPECT(undrift_get_covariance(filter, NULL, n * n), UNDRIFT_STATUS_NULL_POINTER);
    EXPECT(undrift_get_parameter(filter, 99, six, more), UNDRIFT_STATUS_OUT_OF_RANGE);
    EXPECT(undrift_get_parameter(filter, UNDRIFT_PARAMETER_AXLE, six, more), UNDRIFT_STATUS_NOT_ESTIMATED);
    EXPECT(undrift_get_parameter(filter, UNDRIFT_PARAMETER_LEVER_ARM, NULL, more),
           UNDRIFT_STATUS_NULL_POINTER);
    EXPECT(undrift_get_state(filter, &after), UNDRIFT_STATUS_OK);
    if (memcmp(&before, &after, sizeof before) != 0) {
        printf("what was refused changed the filter\n");
        failures++;
    }

    /* What it is for. */
    position.latitude = 1e-3;
    gate.weaken = 10;
    gate.reject = 20;
    EXPECT(undrift_update_position(filter, &position, NULL, &gate, &done), UNDRIFT_STATUS_OK);
    if (done.outcome != UNDRIFT_OUTCOME_REJECTED || done.dof != 3 || !(done.nis > 20)) {
        printf("the gate let a jump of 6 km pass\n");
        failures++;
    }
    position.latitude = 0;
    EXPECT(undrift_update_position(filter, &position, NULL, &gate, &done), UNDRIFT_STATUS_OK);
    EXPECT(undrift_update_velocity(filter, &velocity, NULL, NULL, NULL), UNDRIFT_STATUS_OK);
    EXPECT(undrift_update_zero_velocity(filter, 0.01, NULL, NULL), UNDRIFT_STATUS_OK);
    EXPECT(undrift_update_odometer(filter, 0, 0.1, NULL, NULL, NULL), UNDRIFT_STATUS_OK);
    EXPECT(undrift_update_height(filter, 0, 1, NULL, NULL), UNDRIFT_STATUS_OK);
    EXPECT(undrift_update_non_holonomic(filter, NULL, 0.1, 0.1, NULL, NULL), UNDRIFT_STATUS_OK);
    EXPECT(undrift_get_covariance(filter, covariance, n * n), UNDRIFT_STATUS_OK);
    EXPECT(undrift_get_parameter(filter, UNDRIFT_PARAMETER_LEVER_ARM, six, more), UNDRIFT_STATUS_OK);
    EXPECT(undrift_get_state(filter, &after), UNDRIFT_STATUS_OK);
    if (n != 18 || covariance[0] != after.position_std[0] * after.position_std[0]) {
        /* A root and its square differ in the last bit. */
        if (n != 18 || fabs(covariance[0] / (after.position_std[0] * after.position_std[0]) - 1) > 1e-15) {
            printf("the covariance is not the states'\n");
            failures++;
        }
    }

    /* Numbers that are finite and would break it are refused, and it is as before. */
    sample.time = 0.02;
    sample.dt = 0.01;
    sample.dtheta[1] = 0;
    sample.dvel[0] = 1e300;
    EXPECT(undrift_predict(filter, &sample), UNDRIFT_STATUS_OUT_OF_RANGE);
    EXPECT(undrift_check(filter), UNDRIFT_STATUS_OK);
    EXPECT(undrift_filter_init(memory, size, &start, sensors, NULL, &filter), UNDRIFT_STATUS_OK);
    EXPECT(undrift_check(filter), UNDRIFT_STATUS_OK);

    for (i = -1; i < 20; i++)
        failures += strlen(undrift_error_text(i)) == 0;
    free(memory);
    printf(failures == 0 ? "abused and well\n" : "broken\n");
    return failures != 0;
}
