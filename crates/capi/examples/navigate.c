/*
 * Navigates a recorded minute and prints the states once a second, for a filter as large as the library was
 * built for: with 15 states a random walk a sensor axis, from 27 on an ARMA model and a constant.
 *
 *     navigate testdata/golden/embedded/minute.bin
 *
 * crates/undrift/examples/embedded_minute.rs tells the file's layout. tools/c-example builds and runs this.
 */
#include "undrift.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STATES 33
#define ROUNDING 1e-6

/* The filter: no heap. */
static union {
    double align;
    unsigned char bytes[UNDRIFT_FILTER_BYTES(STATES)];
} memory;
static undrift_sensor sensors[UNDRIFT_AXES];
static unsigned char file[100000];

static void check(undrift_status status, const char *what)
{
    if (status != UNDRIFT_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", what, undrift_error_text(status));
        exit(1);
    }
}

/* Little-endian numbers, wherever they lie. */
static unsigned long long bits(const unsigned char *at, int bytes)
{
    unsigned long long value = 0;
    while (bytes > 0)
        value = value << 8 | at[--bytes];
    return value;
}

static double number(const unsigned char *at)
{
    unsigned long long value = bits(at, 8);
    double real;
    memcpy(&real, &value, sizeof real);
    return real;
}

static double count(const unsigned char *at)
{
    int value = (int)bits(at, 2);
    return value < 32768 ? value : value - 65536;
}

static void numbers(const unsigned char *at, double *out, int count)
{
    int i;
    for (i = 0; i < count; i++)
        out[i] = number(at + 8 * i);
}

/* White noise and a bias that wanders from its turn-on value: one state. */
static void random_walk(double white, double walk, double turn_on, double interval, undrift_sensor *out)
{
    undrift_sensor part;
    check(undrift_sensor_white(white, interval, out), "white noise");
    check(undrift_sensor_random_walk(walk, interval, &part), "random walk");
    check(undrift_sensor_add(out, &part, out), "sum");
    check(undrift_sensor_constant(turn_on, interval, &part), "constant");
    check(undrift_sensor_add(out, &part, out), "sum");
}

/* ARMA(2,2) and a turn-on constant: three states. */
static void arma(double sigma, double turn_on, double interval, undrift_sensor *out)
{
    static const double phi[] = {1.8087, -0.81058}, theta[] = {1.65, -0.665};
    undrift_sensor part;
    check(undrift_sensor_arma(phi, 2, theta, 2, sigma, interval, out), "ARMA");
    check(undrift_sensor_constant(turn_on, interval, &part), "constant");
    check(undrift_sensor_add(out, &part, out), "sum");
}

static void update(undrift_filter *filter, const double *fix, const double *lever)
{
    /* Chi-squared with three degrees of freedom is above these once in a thousand, once in a billion. */
    static const undrift_gate gate = {16.27, 44.8};
    undrift_position position = {0};
    undrift_velocity velocity = {0};
    int i;
    position.latitude = fix[1];
    position.longitude = fix[2];
    position.height = fix[3];
    for (i = 0; i < 3; i++) {
        velocity.velocity[i] = fix[4 + i];
        position.covariance[i][i] = fix[7 + i] * fix[7 + i];
        velocity.covariance[i][i] = fix[10 + i] * fix[10 + i];
    }
    check(undrift_update_position(filter, &position, lever, &gate, NULL), "position");
    check(undrift_update_velocity(filter, &velocity, lever, &gate, NULL), "velocity");
}

static void print3(const double *three)
{
    printf(" %.16e %.16e %.16e", three[0], three[1], three[2]);
}

static void print(const undrift_filter *filter)
{
    undrift_state s;
    check(undrift_get_state(filter, &s), "state");
    printf("%lu %.16e", (unsigned long)undrift_states(filter), s.time);
    printf(" %.16e %.16e %.16e", s.latitude, s.longitude, s.height);
    print3(s.velocity);
    print3(s.roll_pitch_yaw);
    print3(s.gyro_error);
    print3(s.accel_error);
    print3(s.position_std);
    print3(s.velocity_std);
    print3(s.attitude_std);
    print3(s.gyro_error_std);
    print3(s.accel_error_std);
    printf("\n");
}

int main(int argc, char **argv)
{
    undrift_start start;
    undrift_sample sample;
    undrift_filter *filter;
    double interval, angle, velocity, first[9], std[9], lever[3], fix[13];
    unsigned long samples, fixes, k, next = 0;
    const unsigned char *header, *increments, *fixed;
    FILE *from = argc == 2 ? fopen(argv[1], "rb") : NULL;
    size_t length = from ? fread(file, 1, sizeof file, from) : 0;
    int i;

    if (length < 280 || memcmp(file, "undrift1", 8) != 0) {
        fprintf(stderr, "give a recorded minute\n");
        return 1;
    }
    fclose(from);
    samples = (unsigned long)bits(file + 8, 4);
    fixes = (unsigned long)bits(file + 12, 4);
    header = file + 16;
    increments = header + 8 * 33;
    if (samples > length / 12 || fixes > length / 104 || length != 280 + 12 * samples + 104 * fixes) {
        fprintf(stderr, "the record is damaged\n");
        return 1;
    }
    fixed = increments + 12 * samples;
    interval = number(header);
    angle = number(header + 8);
    velocity = number(header + 16);
    numbers(header + 24, first, 9);
    numbers(header + 96, std, 9);
    numbers(header + 168, lever, 3);

    start.time = 0;
    start.latitude = first[0];
    start.longitude = first[1];
    start.height = first[2];
    memcpy(start.velocity, first + 3, sizeof start.velocity);
    memcpy(start.roll_pitch_yaw, first + 6, sizeof start.roll_pitch_yaw);
    memcpy(start.position_std, std, sizeof start.position_std);
    memcpy(start.velocity_std, std + 3, sizeof start.velocity_std);
    memcpy(start.attitude_std, std + 6, sizeof start.attitude_std);
    for (i = 0; i < UNDRIFT_AXES; i++) {
        int gyro = i < 3;
        if (undrift_max_states() >= 27)
            arma(gyro ? 1e-3 : 5e-3, gyro ? 1.7e-3 : 0.05, interval, &sensors[i]);
        else
            random_walk(gyro ? 1e-4 : 5e-4, gyro ? 4e-4 : 2e-3, gyro ? 1.7e-3 : 0.05, interval, &sensors[i]);
    }
    check(undrift_filter_init(&memory, sizeof memory, &start, sensors, NULL, &filter), "start");

    for (k = 0; k < samples; k++) {
        const unsigned char *at = increments + 12 * k;
        sample.time = (double)(k + 1) * interval;
        sample.dt = interval;
        for (i = 0; i < 3; i++) {
            sample.dtheta[i] = count(at + 2 * i) * angle;
            sample.dvel[i] = count(at + 6 + 2 * i) * velocity;
        }
        check(undrift_sample_begin(filter, &sample), "sample");
        for (; next < fixes; next++) {
            numbers(fixed + 104 * next, fix, 13);
            if (fix[0] > sample.time + ROUNDING)
                break;
            check(undrift_sample_advance(filter, fix[0], ROUNDING), "step");
            update(filter, fix, lever);
        }
        check(undrift_sample_end(filter), "step");
        if ((k + 1) % 100 == 0)
            print(filter);
    }
    return 0;
}
