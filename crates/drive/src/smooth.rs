//! Fixed-interval smoothing: at every node the best estimate given the whole log.
//!
//! While the filter runs forward, [`History`] writes down at each node its state, its covariance and
//! the [`Tape`](undrift_nav::tape::Tape) of the span since the node before, in a temporary file: memory does not grow with the
//! log but for the result. Where there is no folder for one, as in a browser, it is memory. [`History::smooth`] then goes through the nodes from the last to the first
//! and carries the adjoint λ, Λ along; the smoothed error at a node is `P λ`, its covariance
//! `P − P Λ P` (see [`undrift_nav::tape`]). Exact for the linearised filter at the nodes, whatever
//! lies between them: updates of any kind, outages, states without noise.
//!
//! [`Path`] fills in the samples between two nodes: it integrates the log from the smoothed node, with
//! its sensor errors, and spreads the small difference at the next node over the span.

mod path;
mod store;

pub use path::Path;

use crate::{
    estimator::{
        Adjoint, Estimator, ReceiverClock, position_std_on_receiver_clock, vehicle_attitude,
    },
    reference::Predicted,
    replay::{Doubt, Measurements, Observer, ReplayError, Samples, Settings, replay},
};
use nalgebra::{DMatrix, DVector};
use std::io;
use store::Store;
use undrift_nav::{
    Quaternion, Vector3,
    covariance::{AXES, NAV, Sensors},
    earth::Geodetic,
    mechanisation::NavState,
    parameters::{Coupling, Parameter, Parameters},
    sample::ImuSample,
};

/// The smoothed solution at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Position, velocity and attitude of the IMU.
    pub nav: NavState,
    /// Standard deviations of `[δr; δv; ψ]` [m, m/s, rad].
    pub nav_std: [f64; NAV],
    /// Rotation q_bv from the vehicle's to the body's axes: the identity unless the mounting is estimated.
    pub q_bv: Quaternion,
    /// Standard deviations of the vehicle's attitude about north, east and down \[rad\].
    pub vehicle_std: [f64; 3],
    /// Covariances of δr, δv and ψ.
    pub predicted: Predicted,
    /// Estimated sensor states and parameters, in the order of the error state behind its first nine.
    pub estimates: Vec<f64>,
    /// Estimated sensor errors, gyro x, y, z [rad/s], accelerometer x, y, z [m/s²].
    pub sensor_error: [f64; AXES],
    /// Standard deviations of the sensor errors [rad/s, m/s²].
    pub sensor_error_std: [f64; AXES],
    /// Angular rate against the navigation frame as the filter had it, body axes [rad/s].
    pub omega_nb_b: Vector3,
    /// Time that smoothing found the fixes' positions to hold later than the filter believed \[s\].
    late: f64,
    /// The receiver's clock against the samples'; the zero where no time offset is estimated.
    pub receiver_clock: ReceiverClock,
}

impl Node {
    /// Attitude of the vehicle's axes, and its standard deviations about north, east and down \[rad\].
    pub fn vehicle_attitude(&self) -> (Quaternion, [f64; 3]) {
        (self.nav.q_nb * self.q_bv, self.vehicle_std)
    }
}

/// The smoothed nodes in order of time.
#[derive(Clone, Debug)]
pub struct Smoothed {
    /// The nodes in order of time: at fixes, and at most [`Settings::nodes`] \[s\] apart.
    pub nodes: Vec<Node>,
    /// What smoothing found the filter's first attitude, sensor states and parameters to be off by, as
    /// [`crate::replay::Settings::start`] takes it for a second run from a better place.
    ///
    /// An error-state filter is linearised about its own estimate, which may be degrees off in heading
    /// at first: second-order terms of that reach far into the log. Run again with the prior about
    /// the smoothed start, the filter is linearised about the truth, nearly. The prior keeps its
    /// width, in which the shift of its mean is lost: it is wide against what the whole log says.
    pub start: Vec<f64>,
    sensors: Sensors,
    parameters: Parameters,
}

impl Smoothed {
    /// Antenna position and velocity [m/s, north-east-down] at a node that was made for a fix, when the fix holds by
    /// the smoothed time offset: the filter put the node where it then believed the fix to be.
    /// `lever_b` IMU → antenna as configured, body axes \[m\].
    pub fn antenna(&self, node: &Node, lever_b: &Vector3) -> (Geodetic, Vector3) {
        let mut lever = *lever_b;
        if let Some(at) = self.parameters.start(Parameter::LeverArm) {
            let at = self.sensors.states() + at - NAV;
            lever += Vector3::from_column_slice(&node.estimates[at..at + 3]);
        }
        let velocity = node.nav.v_n + node.nav.q_nb * node.omega_nb_b.cross(&lever);
        let offset = node.nav.q_nb * lever + velocity * node.late;
        let position = node.nav.position.displaced(&offset);
        (position, velocity)
    }

    /// Sensor errors of a sample, in which the specific force changes by `jerk` [m/s³], under the estimates of a node.
    fn sensor_error(&self, node: &Node, sample: &ImuSample, jerk: &Vector3) -> [f64; AXES] {
        let coupling = Coupling::new(
            &self.parameters,
            0,
            [
                &(sample.dtheta / sample.dt),
                &(sample.dvel / sample.dt),
                jerk,
            ],
        );
        let behind = self.sensors.states() - NAV;
        core::array::from_fn(|axis| {
            let scaled: f64 = coupling
                .axis(axis)
                .iter()
                .map(|(index, factor)| factor * node.estimates.get(behind + index).unwrap_or(&0.0))
                .sum();
            node.sensor_error[axis] + scaled
        })
    }
}

/// Numbers of a record before the matrices: a flag, time, position, velocity, quaternion, rate, how long the filter has run.
const HEAD: usize = 16;

/// The forward pass, node by node, on disk or in memory until it is smoothed. An [`Observer`] of a replay whose settings ask for nodes:
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::{replay::{Measurement, Settings, replay}, smooth::History};
/// # use undrift::nav::shaping::ShapingFilter;
/// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
/// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
/// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
/// let settings = Settings { nodes: Some(1.0), ..Settings::new(sensors) };
/// let mut history = History::new()?;
/// let mut imu = log.imu.iter().map(|sample| Ok(*sample));
/// let mut fixes = log.gnss.iter().map(|fix| Ok(Measurement::Gnss(*fix)));
/// replay(&mut imu, &mut fixes, &settings, &mut history)?;
/// let smoothed = history.smooth()?.expect("nodes");
/// // In the middle of the drive the fixes before and after count.
/// let node = &smoothed.nodes[smoothed.nodes.len() / 2];
/// assert!(node.nav_std[0] < 1.0, "north, one standard deviation [m]");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct History {
    store: Store,
    /// States of the filter.
    states: usize,
    nodes: usize,
    sensors: Option<(Sensors, Parameters)>,
    mounting_std: Vector3,
    record: Vec<u8>,
}

impl History {
    /// An empty pass, in a temporary file without a name, or in memory where no folder takes one.
    ///
    /// # Errors
    /// If the folder is there and the file cannot be made all the same.
    pub fn new() -> io::Result<Self> {
        Ok(Self {
            store: Store::new()?,
            states: 0,
            nodes: 0,
            sensors: None,
            mounting_std: Vector3::zeros(),
            record: Vec::new(),
        })
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes
    }

    /// Whether there is no node yet.
    pub fn is_empty(&self) -> bool {
        self.nodes == 0
    }

    /// Stores a node: the present state of the filter and the tape since the node before. Without a tape
    /// nothing after this node says anything about what was before it.
    ///
    /// # Errors
    /// If the temporary file cannot be written.
    pub fn push(&mut self, filter: &dyn Estimator, since: Option<&Adjoint>) -> io::Result<()> {
        self.states = filter.states();
        self.sensors = Some((*filter.sensors(), *filter.parameters()));
        self.mounting_std = self.mounting_std.sup(&filter.mounting_std());
        let n = self.states;
        let record = &mut self.record;
        record.clear();
        let mut put = |values: &[f64]| {
            for value in values {
                record.extend_from_slice(&value.to_ne_bytes());
            }
        };
        let nav = filter.nav();
        let place = nav.position;
        put(&[
            f64::from(u8::from(since.is_some())),
            nav.time,
            place.lat,
            place.lon,
            place.height,
        ]);
        put(nav.v_n.as_slice());
        put(nav.q_nb.coords.as_slice());
        put(filter.omega_nb_b().as_slice());
        put(&[filter.since_start()]);
        put(&filter.estimates()[NAV..n]);
        let p = filter.covariance();
        for j in 0..n {
            put(&p.column(j).as_slice()[j..n]);
        }
        match since {
            Some(tape) => {
                for j in 0..n {
                    put(&tape.transition.column(j).as_slice()[..n]);
                }
                put(&tape.gradient.as_slice()[..n]);
                for j in 0..n {
                    put(&tape.information.column(j).as_slice()[j..n]);
                }
            }
            None => put(&vec![0.0; n * n + n + n * (n + 1) / 2]),
        }
        self.nodes += 1;
        self.store.append(&self.record)
    }

    /// Goes back through the nodes, last to first, and returns them smoothed in order of time; `None` without nodes.
    ///
    /// # Errors
    /// If the temporary file cannot be read.
    pub fn smooth(mut self) -> io::Result<Option<Smoothed>> {
        let Some((sensors, parameters)) = self.sensors else {
            return Ok(None);
        };
        let n = self.states;
        let packed = n * (n + 1) / 2;
        let length = HEAD + (n - NAV) + packed + n * n + n + packed;

        // Blocks of about a megabyte, from the end.
        let per_block = ((1 << 20) / (8 * length)).max(1);
        let mut lambda = DVector::<f64>::zeros(n);
        let mut information = DMatrix::<f64>::zeros(n, n);
        let mut nodes = Vec::with_capacity(self.nodes);
        let mut bytes = Vec::new();
        let mut start = DVector::zeros(n);
        let mut end = self.nodes;
        while end > 0 {
            let begin = end.saturating_sub(per_block);
            bytes.resize((end - begin) * length * 8, 0);
            self.store.read(begin * length * 8, &mut bytes)?;
            for record in bytes.chunks_exact(length * 8).rev() {
                let mut numbers = record.chunks_exact(8).map(|b| {
                    let mut word = [0; 8];
                    word.copy_from_slice(b);
                    f64::from_ne_bytes(word)
                });
                let mut take =
                    |count: usize| -> Vec<f64> { numbers.by_ref().take(count).collect() };
                let head = take(HEAD);
                let estimates = take(n - NAV);
                let p = unpack(&take(packed), n);
                let t = DMatrix::from_vec(n, n, take(n * n));
                let gradient = DVector::from_vec(take(n));
                let tape_information = unpack(&take(packed), n);

                let error = &p * &lambda;
                let covariance = &p - &p * &information * &p;
                let models = (&sensors, &parameters, &self.mounting_std);
                nodes.push(node(&head, &estimates, &error, &covariance, models));
                start = error;
                if head[0] > 0.0 {
                    lambda = gradient + t.tr_mul(&lambda);
                    let carried = t.tr_mul(&(&information * &t));
                    information = tape_information + (&carried + carried.transpose()) * 0.5;
                } else {
                    lambda.fill(0.0);
                    information.fill(0.0);
                }
            }
            end = begin;
        }
        nodes.reverse();
        start.rows_mut(0, 6).fill(0.0);
        Ok(Some(Smoothed {
            nodes,
            start: start.as_slice().to_vec(),
            sensors,
            parameters,
        }))
    }
}

/// A symmetric matrix from its lower triangle, column by column.
fn unpack(packed: &[f64], n: usize) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(n, n);
    let mut values = packed.iter();
    for j in 0..n {
        for i in j..n {
            let value = values.next().copied().unwrap_or(0.0);
            matrix[(i, j)] = value;
            matrix[(j, i)] = value;
        }
    }
    matrix
}

/// A node of the forward pass with its smoothed error taken out; `covariance` is that of what is left.
fn node(
    head: &[f64],
    estimates: &[f64],
    error: &DVector<f64>,
    covariance: &DMatrix<f64>,
    (sensors, parameters, mounting_std): (&Sensors, &Parameters, &Vector3),
) -> Node {
    let nav = NavState {
        time: head[1],
        position: Geodetic {
            lat: head[2],
            lon: head[3],
            height: head[4],
        },
        v_n: Vector3::new(head[5], head[6], head[7]),
        q_nb: Quaternion::new_unchecked(nalgebra::Quaternion::from(nalgebra::Vector4::new(
            head[8], head[9], head[10], head[11],
        ))),
    };
    let part = |at: usize| Vector3::new(error[at], error[at + 1], error[at + 2]);
    let estimates: Vec<f64> = estimates
        .iter()
        .enumerate()
        .map(|(i, x)| x + error[NAV + i])
        .collect();
    let mut sensor_error = [0.0; AXES];
    for axis in 0..AXES {
        let (filter, at) = (sensors.axis(axis), sensors.start(axis));
        for i in 0..filter.order {
            sensor_error[axis] += filter.h[i] * estimates[at + i - NAV];
        }
    }
    let nav = nav.without_error(&part(0), &part(3), &part(6));
    let mounted = parameters.start(Parameter::Mounting).map(|start| {
        let at = sensors.states() + start;
        (at, [estimates[at - NAV], estimates[at + 1 - NAV]])
    });
    let offset = |kind| {
        let start = parameters.start(kind)?;
        Some(error[sensors.states() + start])
    };
    let late = offset(Parameter::TimeOffset)
        .map(|late| late + offset(Parameter::ClockRate).unwrap_or(0.0) * head[15]);
    let of = (parameters, sensors.states(), head[15]);
    let place = |kind| Some(sensors.states() + parameters.start(kind)?);
    let terms = [
        (place(Parameter::TimeOffset), 1.0),
        (place(Parameter::ClockRate), head[15]),
    ];
    let terms = || {
        terms
            .into_iter()
            .filter_map(|(at, factor)| Some((at?, factor)))
    };
    let pairs = terms().flat_map(|(i, a)| terms().map(move |(j, b)| a * b * covariance[(i, j)]));
    let receiver_clock = ReceiverClock {
        offset: terms()
            .map(|(at, factor)| factor * estimates[at - NAV])
            .sum(),
        offset_std: pairs.sum::<f64>().max(0.0).sqrt(),
        position_std: position_std_on_receiver_clock(of, &nav.v_n, |i, j| covariance[(i, j)]),
        interval: sensors.axis(0).interval,
    };
    let (q_nv, vehicle_std) =
        vehicle_attitude(&nav.q_nb, mounted, mounting_std, |i, j| covariance[(i, j)]);
    Node {
        q_bv: nav.q_nb.inverse() * q_nv,
        vehicle_std,
        nav,
        nav_std: core::array::from_fn(|i| covariance[(i, i)].max(0.0).sqrt()),
        predicted: Predicted(
            [0, 3, 6].map(|at| covariance.fixed_view::<3, 3>(at, at).into_owned()),
        ),
        estimates,
        sensor_error,
        sensor_error_std: sensors.error_std(|i, j| covariance[(i, j)]),
        omega_nb_b: Vector3::new(head[12], head[13], head[14]),
        late: late.unwrap_or(0.0),
        receiver_clock,
    }
}

/// Longest part of a log that [`better_start`] looks at \[s\].
const START_SPAN: f64 = 300.0;

/// The start that a smoother finds in the first minutes of a log, for [`Settings::start`]; `None`
/// without nodes, and where those minutes are not enough for an alignment.
///
/// # Errors
/// As [`replay`].
pub fn better_start(
    imu: &mut Samples,
    aiding: &mut Measurements,
    settings: &Settings,
) -> Result<Option<Vec<f64>>, ReplayError> {
    if settings.nodes.is_none() {
        return Ok(None);
    }
    let mut until = None;
    let mut first = imu.take_while(|sample| match sample {
        Ok(sample) => sample.time < *until.get_or_insert(sample.time + START_SPAN),
        Err(_) => true,
    });
    let mut history = History::new()?;
    match replay(&mut first, aiding, settings, &mut history) {
        Ok(_) => Ok(history.smooth()?.map(|smoothed| smoothed.start)),
        Err(ReplayError::NotAligned(_)) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Spans in which a first pass finds the solution to go wrong, for [`Settings::doubts`] of the pass that is smoothed: a
/// covariance that jumps at one instant would cut the smoother in two there. Empty without nodes.
///
/// # Errors
/// As [`replay`].
pub fn doubts(
    imu: &mut Samples,
    aiding: &mut Measurements,
    settings: &Settings,
) -> Result<Vec<Doubt>, ReplayError> {
    if settings.nodes.is_none() || !settings.gating {
        return Ok(Vec::new());
    }
    let settings = Settings {
        nodes: None,
        ..settings.clone()
    };
    match replay(imu, aiding, &settings, &mut ()) {
        Ok(summary) => Ok(summary.doubts),
        Err(ReplayError::NotAligned(_)) => Ok(Vec::new()),
        Err(error) => Err(error),
    }
}

/// Keeps the nodes of a replay.
impl Observer for History {
    fn node(&mut self, filter: &dyn Estimator, since: Option<&Adjoint>) -> Result<(), ReplayError> {
        Ok(self.push(filter, since)?)
    }
}

#[cfg(test)]
mod tests;
