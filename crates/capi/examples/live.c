/*
 * Navigates while samples and fixes come, lines on standard input in order of arrival, and prints the solution after each sample:
 *
 *     imu TIME GX GY GZ AX AY AZ                                [s, rad/s, m/s^2]
 *     gnss TIME LAT LON HEIGHT SN SE SD VN VE VD SVN SVE SVD    [s, deg, m, m/s]
 */
#include "undrift.h"
#include <stdio.h>
#include <stdlib.h>

#define DEG 0.017453292519943295
#define INTERVAL 0.02

/* The memory: here the system's; on a board a pool. Both keep the 16 bytes of alignment that are asked for at most. */
static void *give(void *context, size_t size, size_t align) { (void)context; (void)align; return malloc(size); }
static void take(void *context, void *memory, size_t size) { (void)context; (void)size; free(memory); }
static const undrift_allocator allocator = {NULL, give, take};

int main(void)
{
    const double white[2] = {1e-4, 2e-3}, walk[2] = {1e-6, 2e-5}, turn_on[2] = {0.03, 0.5};
    undrift_navigator_settings settings;
    undrift_sensor sensors[UNDRIFT_AXES], part;
    undrift_navigator *navigator;
    undrift_event event;
    undrift_state state;
    double n[13];
    char line[512];
    int i;

    for (i = 0; i < UNDRIFT_AXES; i++) { /* Gyros [rad/s], then accelerometers [m/s^2]. */
        undrift_sensor_white(white[i / 3], INTERVAL, &sensors[i]);
        undrift_sensor_random_walk(walk[i / 3], INTERVAL, &part);
        undrift_sensor_add(&sensors[i], &part, &sensors[i]);
        undrift_sensor_constant(turn_on[i / 3], INTERVAL, &part);
        undrift_sensor_add(&sensors[i], &part, &sensors[i]);
    }
    undrift_set_allocator(&allocator);
    undrift_navigator_defaults(&settings);
    if (undrift_navigator_new(&settings, sensors, NULL, &navigator) != UNDRIFT_STATUS_OK)
        return 1;
    while (fgets(line, sizeof line, stdin)) {
        if (sscanf(line, "imu %lf %lf %lf %lf %lf %lf %lf", n, n + 1, n + 2, n + 3, n + 4, n + 5, n + 6) == 7) {
            undrift_sample sample = {n[0], INTERVAL, {n[1] * INTERVAL, n[2] * INTERVAL, n[3] * INTERVAL},
                                     {n[4] * INTERVAL, n[5] * INTERVAL, n[6] * INTERVAL}};
            undrift_navigator_imu(navigator, &sample);
            if (undrift_navigator_state(navigator, &state) == UNDRIFT_STATUS_OK)
                printf("%.4f,%.10f,%.10f,%.4f,%.4f\n", state.time, state.latitude / DEG, state.longitude / DEG, state.height, state.position_std[0]);
        } else if (sscanf(line, "gnss %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf", n, n + 1, n + 2, n + 3, n + 4, n + 5, n + 6, n + 7, n + 8, n + 9, n + 10, n + 11, n + 12) == 13) {
            undrift_position position = {n[1] * DEG, n[2] * DEG, n[3], {{n[4] * n[4], 0, 0}, {0, n[5] * n[5], 0}, {0, 0, n[6] * n[6]}}};
            undrift_velocity velocity = {{n[7], n[8], n[9]}, {{n[10] * n[10], 0, 0}, {0, n[11] * n[11], 0}, {0, 0, n[12] * n[12]}}};
            undrift_navigator_fix(navigator, n[0], &position, &velocity);
        }
        while (undrift_navigator_event(navigator, &event) == UNDRIFT_STATUS_OK)
            fprintf(stderr, "%.1f s: event %d (%g)\n", event.time, (int)event.kind, event.value);
    }
    undrift_navigator_free(navigator);
    return 0;
}
