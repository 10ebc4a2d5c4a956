/*
 * undrift: position, velocity and attitude from a low-cost inertial sensor and GNSS, with any model of how
 * the sensor errs. No allocation, no global state, but for the navigator (undrift_navigator_..., of a library built
 * with the feature `navigator`), whose memory is that of undrift_set_allocator(). docs/embedded.md shows its use.
 *
 * SI units and radians. Navigation frame north-east-down, body frame forward-right-down; times in seconds of
 * one base. An error is estimate less truth.
 *
 * A pointer is null or points to as much memory as its type or the length beside it says. A filter is used
 * by one thread at a time. All else is checked: null pointers, numbers that are not finite, sizes and
 * alignment give a status that is not UNDRIFT_STATUS_OK, and the filter is then as it was, but for
 * UNDRIFT_STATUS_DIVERGED.
 *
 * This file is made from the library's source: change it there.
 */

#ifndef UNDRIFT_H
#define UNDRIFT_H

#include <stddef.h>
#include <stdint.h>
/*
 * Bytes of memory that are enough for a filter of a library built for so many states (undrift_max_states()):
 *
 *     static union { double align; unsigned char bytes[UNDRIFT_FILTER_BYTES(33)]; } memory;
 */
#define UNDRIFT_FILTER_BYTES(states) (8 * ((states) * (states) + (states)) + UNDRIFT_FILTER_OVERHEAD)


/**
 * Most states of one sensor axis.
 */
#define UNDRIFT_MAX_ORDER 6

/**
 * Sensor axes: gyro x, y, z, then accelerometer x, y, z.
 */
#define UNDRIFT_AXES 6

/**
 * Kinds of parameters.
 */
#define UNDRIFT_PARAMETERS 15

/**
 * Bytes of a filter beside its covariance and estimates, at most; see UNDRIFT_FILTER_BYTES.
 */
#define UNDRIFT_FILTER_OVERHEAD 7680

/**
 * What a call came to: 0 is success.
 */
enum undrift_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Done.
     */
    UNDRIFT_STATUS_OK = 0,
    /**
     * A pointer is null that must not be.
     */
    UNDRIFT_STATUS_NULL_POINTER = 1,
    /**
     * The memory or array given is too small.
     */
    UNDRIFT_STATUS_TOO_SMALL = 2,
    /**
     * The memory does not start at a multiple of undrift_filter_align().
     */
    UNDRIFT_STATUS_MISALIGNED = 3,
    /**
     * The filter was not initialised, or its initialisation failed.
     */
    UNDRIFT_STATUS_NOT_INITIALISED = 4,
    /**
     * A number is not finite.
     */
    UNDRIFT_STATUS_NOT_FINITE = 5,
    /**
     * A number lies outside of what it can be.
     */
    UNDRIFT_STATUS_OUT_OF_RANGE = 6,
    /**
     * More states than the filter or an axis holds.
     */
    UNDRIFT_STATUS_TOO_MANY_STATES = 7,
    /**
     * The autoregressive part of a noise model is unstable: its roots must lie inside the unit circle,
     * one may be 1.
     */
    UNDRIFT_STATUS_UNSTABLE = 8,
    /**
     * Noise models of different sample intervals.
     */
    UNDRIFT_STATUS_INTERVALS_DIFFER = 9,
    /**
     * The noise model does not exist at the sample interval asked for.
     */
    UNDRIFT_STATUS_NO_MODEL_AT_RATE = 10,
    /**
     * The second moments of a noise model are no covariance.
     */
    UNDRIFT_STATUS_BAD_SENSOR = 11,
    /**
     * The measurement's covariance is not symmetric or not positive definite.
     */
    UNDRIFT_STATUS_BAD_MEASUREMENT = 12,
    /**
     * The sample does not begin where the one before ended.
     */
    UNDRIFT_STATUS_GAP = 13,
    /**
     * The solution left the possible range or is no number; the filter must be initialised again.
     */
    UNDRIFT_STATUS_DIVERGED = 14,
    /**
     * The parameter is not estimated.
     */
    UNDRIFT_STATUS_NOT_ESTIMATED = 15,
    /**
     * No allocator was set for navigators.
     */
    UNDRIFT_STATUS_NO_ALLOCATOR = 16,
    /**
     * There are navigators whose memory is that of the allocator.
     */
    UNDRIFT_STATUS_IN_USE = 17,
    /**
     * The navigator has no solution yet, or none at the moment.
     */
    UNDRIFT_STATUS_NOT_ALIGNED = 18,
    /**
     * The measurement came later than the horizon and is not used.
     */
    UNDRIFT_STATUS_TOO_LATE = 19,
    /**
     * No event is left.
     */
    UNDRIFT_STATUS_NO_EVENT = 20,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum undrift_status undrift_status;
#else
typedef int32_t undrift_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Whether a measurement was used.
 */
enum undrift_outcome
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Used as it was.
     */
    UNDRIFT_OUTCOME_USED = 0,
    /**
     * Used with its covariance enlarged.
     */
    UNDRIFT_OUTCOME_WEAKENED = 1,
    /**
     * Not used.
     */
    UNDRIFT_OUTCOME_REJECTED = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum undrift_outcome undrift_outcome;
#else
typedef int32_t undrift_outcome;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What happened.
 */
enum undrift_event_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Navigation began; `value` is the standard deviation of the heading [rad].
     */
    UNDRIFT_EVENT_KIND_STARTED = 0,
    /**
     * Samples of an axis could not be right and were replaced; `value` is the axis, 0 to 5.
     */
    UNDRIFT_EVENT_KIND_SAMPLE_FAULT = 1,
    /**
     * Positions were rejected; `value` is the distance of the first [m].
     */
    UNDRIFT_EVENT_KIND_POSITION_REJECTED = 2,
    /**
     * Velocities were rejected; `value` is the distance of the first [m/s].
     */
    UNDRIFT_EVENT_KIND_VELOCITY_REJECTED = 3,
    /**
     * The solution was reset to fixes that contradicted it; `value` is by what its position was inflated [m].
     */
    UNDRIFT_EVENT_KIND_ACCEPTED_IN_THE_END = 4,
    /**
     * The course over ground contradicts the heading; `value` is by how much [rad].
     */
    UNDRIFT_EVENT_KIND_HEADING_OFF = 5,
    /**
     * Innovations were biased to one side for a while.
     */
    UNDRIFT_EVENT_KIND_ONE_SIDED = 6,
    /**
     * The solution ended and is aligned again.
     */
    UNDRIFT_EVENT_KIND_ALIGNS_AGAIN = 7,
    /**
     * What the fixes have shown of their errors is used; `value` is the factor on the standard deviation of positions.
     */
    UNDRIFT_EVENT_KIND_FIX_ERRORS = 8,
    /**
     * The mounting was found: body axes are the vehicle's from here on.
     */
    UNDRIFT_EVENT_KIND_MOUNTING = 9,
    /**
     * Another solution began.
     */
    UNDRIFT_EVENT_KIND_RESUMED = 10,
    /**
     * The solution diverged.
     */
    UNDRIFT_EVENT_KIND_DIVERGED = 11,
    /**
     * A measurement came later than the horizon and is not used.
     */
    UNDRIFT_EVENT_KIND_TOO_LATE = 12,
    /**
     * Headings by two antennas were rejected; `value` is what the last of them was off by [rad].
     */
    UNDRIFT_EVENT_KIND_HEADINGS_REJECTED = 13,
    /**
     * The magnetic field was disturbed and not used; `value` is what it was off by at most [T].
     */
    UNDRIFT_EVENT_KIND_FIELD_DISTURBED = 14,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum undrift_event_kind undrift_event_kind;
#else
typedef int32_t undrift_event_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Constants that can be estimated beside the sensors' errors: places in the array given to
 * undrift_filter_init().
 */
enum undrift_parameter
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Scale factor errors of gyro x, y, z.
     */
    UNDRIFT_PARAMETER_GYRO_SCALE = 0,
    /**
     * Scale factor errors of accelerometer x, y, z.
     */
    UNDRIFT_PARAMETER_ACCEL_SCALE = 1,
    /**
     * Misalignment of the gyro axes xy, xz, yx, yz, zx, zy [rad].
     */
    UNDRIFT_PARAMETER_GYRO_MISALIGNMENT = 2,
    /**
     * Misalignment of the accelerometer axes, in the same order [rad].
     */
    UNDRIFT_PARAMETER_ACCEL_MISALIGNMENT = 3,
    /**
     * Lever arm from IMU to antenna, body axes [m]; three states.
     */
    UNDRIFT_PARAMETER_LEVER_ARM = 4,
    /**
     * By how much a fix is later than its time says [s].
     */
    UNDRIFT_PARAMETER_TIME_OFFSET = 5,
    /**
     * Turn of the vehicle's axes against the body axes, about pitch and yaw [rad].
     */
    UNDRIFT_PARAMETER_MOUNTING = 6,
    /**
     * Distance from IMU to the axle that does not steer, beyond the one given [m].
     */
    UNDRIFT_PARAMETER_AXLE = 7,
    /**
     * Scale factor error of the odometer.
     */
    UNDRIFT_PARAMETER_ODOMETER_SCALE = 8,
    /**
     * Error of the barometric height [m].
     */
    UNDRIFT_PARAMETER_BAROMETER_BIAS = 9,
    /**
     * By how much the velocity of a fix is later than its time says [s]; where it is estimated, the time offset
     * is that of the position alone.
     */
    UNDRIFT_PARAMETER_VELOCITY_TIME_OFFSET = 10,
    /**
     * By how much both time offsets grow, from the filter's start on [s/s].
     */
    UNDRIFT_PARAMETER_CLOCK_RATE = 11,
    /**
     * By how much the accelerometers are later than the gyros [s].
     */
    UNDRIFT_PARAMETER_ACCEL_DELAY = 12,
    /**
     * Direction of the second antenna in the body, from forward to right, beyond the one given [rad].
     */
    UNDRIFT_PARAMETER_HEADING_OFFSET = 13,
    /**
     * Hard iron of a magnetometer, body axes [T]; three states.
     */
    UNDRIFT_PARAMETER_HARD_IRON = 14,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum undrift_parameter undrift_parameter;
#else
typedef int32_t undrift_parameter;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Measurements of one number that a navigator takes.
 */
enum undrift_scalar_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Speed of a wheel, forward positive [m/s].
     */
    UNDRIFT_SCALAR_KIND_ODOMETER = 0,
    /**
     * Height, up positive [m].
     */
    UNDRIFT_SCALAR_KIND_BAROMETER = 1,
    /**
     * Azimuth of a second antenna as seen from the first, from north to east [rad].
     */
    UNDRIFT_SCALAR_KIND_HEADING = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum undrift_scalar_kind undrift_scalar_kind;
#else
typedef int32_t undrift_scalar_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What the vehicle is: what it cannot do constrains the solution.
 */
enum undrift_vehicle
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Nothing is known of it.
     */
    UNDRIFT_VEHICLE_NONE = 0,
    /**
     * A wheeled vehicle on a road: no side slip, at rest at times.
     */
    UNDRIFT_VEHICLE_CAR = 1,
    /**
     * An aircraft: it keeps its velocity through the air, and is at rest on the ground.
     */
    UNDRIFT_VEHICLE_AIRCRAFT = 2,
    /**
     * A person on foot.
     */
    UNDRIFT_VEHICLE_PEDESTRIAN = 3,
    /**
     * A copter: the drag of its rotors shows its velocity through the air.
     */
    UNDRIFT_VEHICLE_COPTER = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum undrift_vehicle undrift_vehicle;
#else
typedef int32_t undrift_vehicle;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * An error-state filter. Opaque; its memory is provided by the caller.
 */
typedef struct undrift_filter undrift_filter;

/**
 * A navigator. Opaque; its memory is that of the allocator.
 */
typedef struct undrift_navigator undrift_navigator;

/**
 * The noise model of one sensor axis, a shaping filter that steps once a sample:
 * x' = F x + G w, error = H x + D w. The functions undrift_sensor_... make the usual ones.
 * Only the first `order` rows and columns count. "unit" is rad/s for a gyro, m/s^2 for an accelerometer.
 */
typedef struct {
    /**
     * Number of states, 0 to UNDRIFT_MAX_ORDER.
     */
    uint32_t order;
    /**
     * Sample interval [s].
     */
    double interval;
    /**
     * Transition F.
     */
    double f[UNDRIFT_MAX_ORDER][UNDRIFT_MAX_ORDER];
    /**
     * Output row H.
     */
    double h[UNDRIFT_MAX_ORDER];
    /**
     * Driving covariance G G'.
     */
    double q[UNDRIFT_MAX_ORDER][UNDRIFT_MAX_ORDER];
    /**
     * Cross-covariance G D'.
     */
    double s[UNDRIFT_MAX_ORDER];
    /**
     * Variance D D' of one sample [unit^2].
     */
    double r;
    /**
     * Covariance of the states before the first sample.
     */
    double p0[UNDRIFT_MAX_ORDER][UNDRIFT_MAX_ORDER];
} undrift_sensor;

/**
 * Position, velocity and attitude of the IMU before the first sample, and how well they are known.
 */
typedef struct {
    /**
     * Time [s], where the first sample begins.
     */
    double time;
    /**
     * Latitude [rad].
     */
    double latitude;
    /**
     * Longitude [rad].
     */
    double longitude;
    /**
     * Height above the ellipsoid [m].
     */
    double height;
    /**
     * Velocity over ground north, east, down [m/s].
     */
    double velocity[3];
    /**
     * Roll, pitch, yaw [rad].
     */
    double roll_pitch_yaw[3];
    /**
     * Standard deviation of the position north, east, down [m].
     */
    double position_std[3];
    /**
     * Standard deviation of the velocity north, east, down [m/s].
     */
    double velocity_std[3];
    /**
     * Standard deviation of the attitude about north, east, down [rad].
     */
    double attitude_std[3];
} undrift_start;

/**
 * What is known of a parameter before: its correction is zero with this standard deviation.
 */
typedef struct {
    /**
     * Standard deviation of each state [the parameter's unit]; 0: not estimated.
     */
    double std;
    /**
     * Random walk [unit/sqrt(s)]; 0 for a constant.
     */
    double walk;
    /**
     * Correlation time of a Gauss-Markov process in place of the random walk [s]; 0 for a random walk.
     */
    double time;
} undrift_prior;

/**
 * One inertial sample as increments over the interval that ends at `time`, body axes.
 */
typedef struct {
    /**
     * End of the interval [s].
     */
    double time;
    /**
     * Length of the interval [s].
     */
    double dt;
    /**
     * Integrated angular rate [rad]: rate times dt for a sensor that gives rates.
     */
    double dtheta[3];
    /**
     * Integrated specific force [m/s].
     */
    double dvel[3];
} undrift_sample;

/**
 * Position of the antenna.
 */
typedef struct {
    /**
     * Latitude [rad].
     */
    double latitude;
    /**
     * Longitude [rad].
     */
    double longitude;
    /**
     * Height above the ellipsoid [m].
     */
    double height;
    /**
     * Covariance, north-east-down [m^2].
     */
    double covariance[3][3];
} undrift_position;

/**
 * Limits of the normalised innovation squared, chi-squared with as many degrees of freedom as the
 * measurement has numbers; reject is at least weaken. INFINITY is no limit.
 */
typedef struct {
    /**
     * Above it the measurement's covariance is enlarged in proportion.
     */
    double weaken;
    /**
     * Above it the measurement is not used.
     */
    double reject;
} undrift_gate;

/**
 * What an update did.
 */
typedef struct {
    /**
     * Normalised innovation squared of the measurement at its stated covariance.
     */
    double nis;
    /**
     * Number of scalar measurements.
     */
    int32_t dof;
    /**
     * Whether it was used.
     */
    undrift_outcome outcome;
    /**
     * Factor on its covariance: 1 if it was used as it was, above 1 if weakened, INFINITY if rejected.
     */
    double factor;
} undrift_update;

/**
 * Velocity of the antenna over ground.
 */
typedef struct {
    /**
     * North, east, down [m/s].
     */
    double velocity[3];
    /**
     * Covariance, north-east-down [(m/s)^2].
     */
    double covariance[3][3];
} undrift_velocity;

/**
 * The solution and its standard deviations.
 */
typedef struct {
    /**
     * Time [s].
     */
    double time;
    /**
     * Latitude of the IMU [rad].
     */
    double latitude;
    /**
     * Longitude [rad].
     */
    double longitude;
    /**
     * Height above the ellipsoid [m].
     */
    double height;
    /**
     * Velocity over ground north, east, down [m/s].
     */
    double velocity[3];
    /**
     * Attitude, body to north-east-down: w, x, y, z.
     */
    double quaternion[4];
    /**
     * The same as roll, pitch, yaw [rad].
     */
    double roll_pitch_yaw[3];
    /**
     * Estimated errors of the gyros [rad/s]: what is taken off the next sample.
     */
    double gyro_error[3];
    /**
     * Estimated errors of the accelerometers [m/s^2].
     */
    double accel_error[3];
    /**
     * Angular rate of the body against the navigation frame, body axes, from the last sample [rad/s].
     */
    double angular_rate[3];
    /**
     * Standard deviation of the position north, east, down [m].
     */
    double position_std[3];
    /**
     * Standard deviation of the velocity north, east, down [m/s].
     */
    double velocity_std[3];
    /**
     * Standard deviation of the attitude about north, east, down [rad].
     */
    double attitude_std[3];
    /**
     * Standard deviation of the gyros' errors [rad/s].
     */
    double gyro_error_std[3];
    /**
     * Standard deviation of the accelerometers' errors [m/s^2].
     */
    double accel_error_std[3];
} undrift_state;

/**
 * Where the memory of navigators comes from.
 */
typedef struct {
    /**
     * Passed to both functions.
     */
    void *context;
    /**
     * Allocates `size` bytes with the alignment `align`, a power of two of at most 16. Null where memory is exhausted: the program aborts.
     */
    void *(*allocate)(void *context, size_t size, size_t align);
    /**
     * Frees what `allocate` returned for this size.
     */
    void (*release)(void *context, void *memory, size_t size);
} undrift_allocator;

/**
 * How a navigator works; undrift_navigator_defaults() sets the defaults of `undrift navigate`.
 */
typedef struct {
    /**
     * By how much a measurement may come late [s]; its memory is some 60 kB for each fifth of a second.
     */
    double horizon;
    /**
     * IMU to antenna, body axes [m].
     */
    double lever_arm[3];
    /**
     * An undrift_vehicle.
     */
    int32_t vehicle;
    /**
     * First heading from north to east [rad], where its standard deviation is above 0.
     */
    double heading;
    /**
     * Standard deviation of the heading [rad]; 0: the heading comes from the course over ground.
     */
    double heading_std;
    /**
     * Not 0: the IMU sits in the vehicle in an unknown way, which is to be found.
     */
    int32_t find_mounting;
    /**
     * Not 0: the errors of fixes beyond their covariance are learned from the fixes.
     */
    int32_t learn_fix_errors;
    /**
     * Direction of a second antenna as seen from the first in the body, from forward to right [rad]; how well it is known is the prior
     * UNDRIFT_PARAMETER_HEADING_OFFSET.
     */
    double heading_baseline;
    /**
     * Standard deviation of errors of a magnetometer that last for some seconds [T]; its hard iron is the prior
     * UNDRIFT_PARAMETER_HARD_IRON.
     */
    double magnetometer_lasting;
    /**
     * Year with its fraction, for the Earth's magnetic field; 0: about now.
     */
    double year;
    /**
     * Factors on the noise that vibration adds, gyro and accelerometer x, y, z; all 0: the noise is the model's throughout.
     */
    double vibration[UNDRIFT_AXES];
} undrift_navigator_settings;

/**
 * An event of the navigation.
 */
typedef struct {
    /**
     * When it began or happened [s].
     */
    double time;
    /**
     * What it is.
     */
    undrift_event_kind kind;
    /**
     * See the kinds; 0 where they say nothing.
     */
    double value;
} undrift_event;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * One line of English about a status, never null; it lives as long as the program.
 */
const char *undrift_error_text(int32_t status);

/**
 * White noise of `density` [unit*sqrt(s)], the angle or velocity random walk; no state.
 */
undrift_status undrift_sensor_white(double density, double interval, undrift_sensor *out);

/**
 * A constant that differs from one turn-on to the next with standard deviation `sigma` [unit]; one state.
 */
undrift_status undrift_sensor_constant(double sigma, double interval, undrift_sensor *out);

/**
 * A random walk of the bias with coefficient `k` [unit/sqrt(s)], from zero; one state.
 */
undrift_status undrift_sensor_random_walk(double k, double interval, undrift_sensor *out);

/**
 * A first-order Gauss-Markov process of standard deviation `sigma` [unit] and correlation time `tau`
 * [s], as a bias instability is commonly modelled; one state.
 */
undrift_status undrift_sensor_gauss_markov(double sigma, double tau, double interval, undrift_sensor *out);

/**
 * ARMA(p, q), x_t - phi_1 x_(t-1) - ... = a_t - theta_1 a_(t-1) - ..., the standard deviation of a being
 * `sigma` [unit]; max(p, q) states. An array of no coefficients may be null.
 */
undrift_status undrift_sensor_arma(const double *phi,
                                   size_t p,
                                   const double *theta,
                                   size_t q,
                                   double sigma,
                                   double interval,
                                   undrift_sensor *out);

/**
 * The sum of two independent errors, as white noise and a bias; `out` may be one of them. A random walk
 * and a constant share one state.
 */
undrift_status undrift_sensor_add(const undrift_sensor *one,
                                  const undrift_sensor *other,
                                  undrift_sensor *out);

/**
 * The same noise at another sample interval [s]: for coefficients found at another rate than the
 * filter's; `out` may be `sensor`.
 */
undrift_status undrift_sensor_at_interval(const undrift_sensor *sensor, double interval, undrift_sensor *out);

/**
 * Most states a filter of this library holds.
 */
size_t undrift_max_states(void);

/**
 * Bytes of a filter.
 */
size_t undrift_filter_size(void);

/**
 * Of which number of bytes a filter's address must be a multiple.
 */
size_t undrift_filter_align(void);

/**
 * Makes a filter in `memory` of `length` bytes, at least undrift_filter_size(), and sets `filter` to it.
 * `sensors` are UNDRIFT_AXES models at one interval: gyro x, y, z [rad/s], accelerometer x, y, z [m/s^2].
 * `parameters` are UNDRIFT_PARAMETERS priors, or null for none.
 */
undrift_status undrift_filter_init(void *memory,
                                   size_t length,
                                   const undrift_start *start,
                                   const undrift_sensor *sensors,
                                   const undrift_prior *parameters,
                                   undrift_filter **filter);

/**
 * Sets the estimated errors of gyro x, y, z [rad/s] and accelerometer x, y, z [m/s^2], UNDRIFT_AXES
 * numbers: what a rest before the start has shown. How uncertain they are stays.
 */
undrift_status undrift_set_sensor_error(undrift_filter *filter, const double *error);

/**
 * Carries the filter over one whole sample. UNDRIFT_STATUS_GAP, the filter unchanged, if the sample does
 * not begin where the one before ended, to half its length: samples were lost, or came twice. One that
 * spans the gap, of up to 10 s, takes the filter across. UNDRIFT_STATUS_OUT_OF_RANGE, the filter unchanged,
 * if it is longer than that, or if no solution would be left after it.
 */
undrift_status undrift_predict(undrift_filter *filter, const undrift_sample *sample);

/**
 * Takes up a sample without moving yet, for a fix that lies within it: undrift_sample_advance() to the
 * fix, update, then undrift_sample_end(). What is left of the sample before is done first.
 */
undrift_status undrift_sample_begin(undrift_filter *filter, const undrift_sample *sample);

/**
 * Moves to `time` [s] within the sample taken up, not back; a time beyond its end is its end, one within
 * `rounding` [s] of it too.
 */
undrift_status undrift_sample_advance(undrift_filter *filter, double time, double rounding);

/**
 * Moves to the end of the sample taken up.
 */
undrift_status undrift_sample_end(undrift_filter *filter);

/**
 * Updates with the position of the antenna; `lever` is the vector from the IMU to it, three numbers [m, body axes],
 * null if it is at the IMU. As every update: without a `gate` (null) nothing is rejected, `done` may be null, and a measurement that
 * the gate rejects is a success whose outcome says so. After a failure the filter is as before;
 * UNDRIFT_STATUS_OUT_OF_RANGE is also returned for a measurement that would move the solution off the Earth.
 */
undrift_status undrift_update_position(undrift_filter *filter,
                                       const undrift_position *position,
                                       const double *lever,
                                       const undrift_gate *gate,
                                       undrift_update *done);

/**
 * Updates with the velocity of the antenna; `lever` as for the position.
 */
undrift_status undrift_update_velocity(undrift_filter *filter,
                                       const undrift_velocity *velocity,
                                       const double *lever,
                                       const undrift_gate *gate,
                                       undrift_update *done);

/**
 * Zero-velocity update: the velocity is zero with standard deviation `std` [m/s] along each axis.
 */
undrift_status undrift_update_zero_velocity(undrift_filter *filter,
                                            double std,
                                            const undrift_gate *gate,
                                            undrift_update *done);

/**
 * Non-holonomic constraint: at the point `lever` from the IMU [m, body axes], on the axle that does not steer,
 * the lateral and the vertical velocity are zero, with these standard deviations [m/s].
 */
undrift_status undrift_update_non_holonomic(undrift_filter *filter,
                                            const double *lever,
                                            double sideways_std,
                                            double up_std,
                                            const undrift_gate *gate,
                                            undrift_update *done);

/**
 * Updates with the speed [m/s, forward positive] of the wheel at `lever` from the IMU [m, body axes], with standard deviation `std` [m/s].
 */
undrift_status undrift_update_odometer(undrift_filter *filter,
                                       double speed,
                                       double std,
                                       const double *lever,
                                       const undrift_gate *gate,
                                       undrift_update *done);

/**
 * Updates with a barometric height of the IMU above the ellipsoid [m], which may be off by
 * UNDRIFT_PARAMETER_BAROMETER_BIAS, with standard deviation `std` [m].
 */
undrift_status undrift_update_height(undrift_filter *filter,
                                     double height,
                                     double std,
                                     const undrift_gate *gate,
                                     undrift_update *done);

/**
 * Updates with the azimuth of a second antenna as seen from the first, from north to east [rad], with standard deviation `std` [rad].
 * The second lies in the direction `baseline` in the body, from forward to right [rad], which may be off by
 * UNDRIFT_PARAMETER_HEADING_OFFSET. UNDRIFT_STATUS_OUT_OF_RANGE where one is above the other.
 */
undrift_status undrift_update_heading(undrift_filter *filter,
                                      double heading,
                                      double std,
                                      double baseline,
                                      const undrift_gate *gate,
                                      undrift_update *done);

/**
 * Updates with a magnetic field, three numbers in body axes, with standard deviation `std` each; `earth` is the Earth's field north,
 * east, down of undrift_magnetic_field(), all in [T]. The hard iron is UNDRIFT_PARAMETER_HARD_IRON.
 */
undrift_status undrift_update_magnetometer(undrift_filter *filter,
                                           const double *field,
                                           double std,
                                           const double *earth,
                                           const undrift_gate *gate,
                                           undrift_update *done);

/**
 * The Earth's magnetic field north, east, down [T], three numbers to `earth`, at a place [rad, rad, m] in a year with its fraction:
 * the World Magnetic Model 2025, made for 2025 to 2030.
 */
undrift_status undrift_magnetic_field(double latitude,
                                      double longitude,
                                      double height,
                                      double year,
                                      double *earth);

/**
 * Number of states in use; 0 for what is no filter.
 */
size_t undrift_states(const undrift_filter *filter);

/**
 * The solution.
 */
undrift_status undrift_get_state(const undrift_filter *filter, undrift_state *state);

/**
 * The covariance of the error state, undrift_states() rows of as many numbers, into an array of `count`
 * numbers: position [m], velocity [m/s], misalignment [rad], each north, east, down, then the sensors'
 * states, then the parameters.
 */
undrift_status undrift_get_covariance(const undrift_filter *filter, double *covariance, size_t count);

/**
 * The estimated correction of a parameter (undrift_parameter) to what was given, and its standard
 * deviation: up to six numbers each, as many as the parameter has states.
 */
undrift_status undrift_get_parameter(const undrift_filter *filter,
                                     int32_t parameter,
                                     double *value,
                                     double *std);

/**
 * UNDRIFT_STATUS_OK while the solution is one: finite, possible, its covariance not negative.
 */
undrift_status undrift_check(const undrift_filter *filter);

/**
 * Sets where the memory of navigators comes from, before the first of them: all of it is asked for there, none elsewhere.
 * `allocator` stays where it is as long as there are navigators. UNDRIFT_STATUS_IN_USE while there are some.
 */
undrift_status undrift_set_allocator(const undrift_allocator *allocator);

/**
 * Sets the defaults: measurements up to 2 s late, antenna at the IMU, no vehicle, heading from the course, errors of the
 * fixes learned from them, noise that follows the vibration.
 */
undrift_status undrift_navigator_defaults(undrift_navigator_settings *settings);

/**
 * Makes a navigator without data and sets `navigator` to it. `sensors` are UNDRIFT_AXES models at one interval, `parameters`
 * UNDRIFT_PARAMETERS priors of constants to estimate, or null for none. UNDRIFT_STATUS_NO_ALLOCATOR before undrift_set_allocator().
 */
undrift_status undrift_navigator_new(const undrift_navigator_settings *settings,
                                     const undrift_sensor *sensors,
                                     const undrift_prior *parameters,
                                     undrift_navigator **navigator);

/**
 * Gives a navigator's memory back to the allocator; null is nothing.
 */
void undrift_navigator_free(undrift_navigator *navigator);

/**
 * Pushes a sample, in order of time. The solution goes to the end of the sample before it: only the next shows whether one can
 * be right. UNDRIFT_STATUS_OUT_OF_RANGE for a time that does not go on or a length that is not above 0, the navigator
 * unchanged.
 */
undrift_status undrift_navigator_imu(undrift_navigator *navigator,
                                     const undrift_sample *sample);

/**
 * Pushes a fix of the antenna at `time` [s] on the clock of the samples, early or late: its position and its velocity, null for
 * what it lacks. UNDRIFT_STATUS_TOO_LATE, and nothing is used, where it came later than the horizon.
 */
undrift_status undrift_navigator_fix(undrift_navigator *navigator,
                                     double time,
                                     const undrift_position *position,
                                     const undrift_velocity *velocity);

/**
 * Pushes a measurement of one number, an undrift_scalar_kind, with its standard deviation, in the manner of undrift_navigator_fix().
 */
undrift_status undrift_navigator_scalar(undrift_navigator *navigator,
                                        int32_t kind,
                                        double time,
                                        double value,
                                        double std);

/**
 * Pushes a magnetic field, three numbers in body axes [T], with the standard deviation of its white noise, in the manner of
 * undrift_navigator_fix().
 */
undrift_status undrift_navigator_magnetometer(undrift_navigator *navigator,
                                              double time,
                                              const double *field,
                                              double std);

/**
 * The solution, its attitude that of the vehicle's axes where the mounting is estimated. UNDRIFT_STATUS_NOT_ALIGNED, and nothing is
 * written, before the alignment and between a restart and the next one.
 */
undrift_status undrift_navigator_state(undrift_navigator *navigator,
                                       undrift_state *state);

/**
 * The next event; an event that lasts comes at its start. UNDRIFT_STATUS_NO_EVENT where none is left.
 */
undrift_status undrift_navigator_event(undrift_navigator *navigator, undrift_event *event);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* UNDRIFT_H */
