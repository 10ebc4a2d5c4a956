//! What a run finds out, as values in SI units and the log's own time base, by the names that the stored JSON has. The engine's watches and `undrift-drive` make them, `undrift_report::sentence` words them.

mod implausible;
mod kinds;
mod weight;
pub use kinds::*;
pub use weight::{is_doubtful, is_jump, ranked, verdict};

use undrift_events::{Contradiction, FixMend, Lean, Part, RestartCause, SensorChange, WindowPart};

/// One thing found.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "finding", rename_all = "snake_case")]
pub enum Finding {
    /// The solution diverged and ends.
    Diverged {
        /// When \[s\].
        time: f64,
    },
    /// There is a truth, but no error against it.
    NotCompared {
        /// Why.
        why: NoError,
        /// First and last time of the truth, as far as it was read \[s\].
        truth: [f64; 2],
        /// When the solution began, if it did \[s\].
        started: Option<f64>,
        /// When it ended \[s\].
        ended: f64,
    },
    /// Short gaps between samples were bridged by interpolation.
    Bridged {
        /// How many.
        gaps: u64,
    },
    /// The bias over temperature of the model could not be taken out of all samples, or only by extrapolation.
    Temperature(TemperatureUse),
    /// Gaps between samples were too long to be bridged by interpolation.
    LongGaps {
        /// How many.
        gaps: u64,
        /// Start of the first \[s\].
        first: f64,
        /// Length of the longest \[s\].
        longest: f64,
    },
    /// The mounting was not found while driving: the solution is in the sensor's axes. One of the three says why.
    NoMounting {
        /// Driving with a known heading, which was too little \[s\].
        driving: Option<f64>,
        /// Standard deviation of the direction of motion in the sensor's axes, which was too much \[rad\].
        wander: Option<f64>,
        /// Standard deviation of pitch or yaw, which was too much \[rad\].
        std: Option<f64>,
    },
    /// A long span has no usable fix.
    WithoutGnss {
        /// Start of the longest \[s\].
        start: f64,
        /// Its length \[s\].
        length: f64,
    },
    /// The inertial log ends long before the fixes do: it may be cut short.
    EndsEarly(LogEnd),
    /// Fixes state a covariance that is not positive definite.
    BadCovariance {
        /// How many.
        fixes: u64,
    },
    /// All axes of the IMU repeat their values at the same time.
    Frozen {
        /// First sample of them \[s\].
        start: f64,
        /// Time to the last \[s\].
        length: f64,
        /// Samples on end.
        samples: u64,
    },
    /// An axis of the IMU holds a value longer than its noise explains.
    Held {
        /// 0 to 2 for the sensor's gyros x, y, z, 3 to 5 for its accelerometers.
        axis: usize,
        /// The value as it is in the log.
        value: f64,
        /// First sample of it \[s\].
        start: f64,
        /// Time to the last \[s\].
        length: f64,
        /// Samples on end.
        samples: u64,
        /// Whether it is the largest or smallest value of the axis.
        saturated: bool,
    },
    /// An axis of the IMU has the same value from end to end.
    Constant {
        /// 0 to 2 for the sensor's gyros x, y, z, 3 to 5 for its accelerometers.
        axis: usize,
        /// The value as it is in the log.
        value: f64,
        /// How many samples.
        samples: u64,
        /// Whether it is the gyro that measures the turns of the vehicle.
        vertical: bool,
    },
    /// Heights scatter more than they state.
    NoisyHeights {
        /// Times the stated standard deviation.
        factor: f64,
    },
    /// Two axes of the IMU have the same values from end to end.
    Copied {
        /// 0 to 2 for the sensor's gyros x, y, z, 3 to 5 for its accelerometers.
        axes: [usize; 2],
    },
    /// An axis of the IMU jumps from one end of its range to the other: its counts have too few bits.
    Wrapped(WrappedAxis),
    /// From some time on a sensor measures the motion otherwise than before.
    SensorChanged(SensorChange),
    /// Velocities are a multiple of the changes of position.
    VelocityScale {
        /// Which, and its standard deviation [–].
        ratio: [f64; 2],
    },
    /// Samples and fixes do not go together.
    Mismatch {
        /// By what.
        what: undrift_events::Mismatch,
    },
    /// The mean specific force is not gravity.
    WrongGravity {
        /// Mean specific force over gravity.
        ratio: f64,
        /// The gyros measure gravity in place of the accelerometers.
        #[serde(default)]
        exchanged: bool,
    },
    /// Poses and samples do not go together as the drive file reads them.
    Poses(PosesApart),
    /// Gravity does not point along body down.
    NotDown {
        /// Its direction in body axes, forward, right, down.
        down: [f64; 3],
    },
    /// The course turns by a multiple of what the gyros measure.
    WrongTurnRate {
        /// Turn of the course over that of the gyros.
        ratio: f64,
    },
    /// The course turns as a gyro measures that is not the vertical one.
    WrongTurnAxis {
        /// The gyro, 0 to 2 for body forward, right, down.
        axis: usize,
    },
    /// The gyros do not measure the turns of the course.
    NoTurns,
    /// The gyros measure the turns of the course at another time.
    Late {
        /// By how much later than the stamps of the fixes \[s\].
        delay: f64,
    },
    /// The moving average of a slow ARMA(1,1) of the noise model has the sign of programs that add it.
    MovingAverageSign {
        /// Axes by name.
        axes: Vec<String>,
    },
    /// The inertial log has no times, and its rate is a guess.
    GuessedRate {
        /// Samples a second \[Hz\].
        rate: f64,
    },
    /// Solution and fixes do not go together, and so few samples miss what the vehicle does between them.
    SlowSamples {
        /// Samples a second \[Hz\].
        rate: f64,
        /// Times the predicted size, of innovations that are too large.
        factor: Option<f64>,
    },
    /// The stamps are later than the motion measured (of a slow log perhaps earlier), and the vehicle is fast enough to show it.
    LateSamples {
        /// By how much they are late against the fixes, negative if early, and its standard deviation \[s\].
        delay: [f64; 2],
        /// How far the solution on the IMU's clock is behind the receiver's, at most \[m\].
        most: f64,
    },
    /// The IMU's axes are not forward, right, down of the vehicle: 1 forward, −1 backward, 2 right, −2 left, as far as it shows.
    WrongAxes {
        /// Body axis along which the vehicle accelerates.
        forward: Option<i8>,
        /// Body axis along which it is pushed in turns to the right.
        right: Option<i8>,
        /// The value of `imu.axes` that mends it, where one does.
        axes: Option<String>,
    },
    /// Positions and velocities disagree.
    WrongVelocity {
        /// What would make them, where something simple does.
        mend: Option<FixMend>,
    },
    /// The positions alternate between two places.
    TwoReceivers {
        /// How far these are apart, horizontally \[m\].
        distance: f64,
    },
    /// The solution was re-initialised.
    Restart {
        /// When it was given up \[s\].
        time: f64,
        /// Why.
        why: RestartCause,
        /// When the new one began, if it did \[s\].
        resumed: Option<f64>,
    },
    /// Consecutive fixes contradicted the solution and were rejected.
    Rejected(Contradiction),
    /// Further spans of rejected fixes, beyond those given one by one.
    MoreRejected {
        /// How many spans.
        spans: u64,
        /// After how many of them the fixes were accepted.
        accepted: u64,
    },
    /// Fixes differ from the solution to one side.
    OneSided(Lean),
    /// A component of the measured velocity has the wrong sign.
    WrongSign {
        /// 0 to 2 for north, east, down.
        axis: usize,
    },
    /// The solution and a part of the fixes disagree over a span.
    Disagreement {
        /// Which part of them.
        part: WindowPart,
        /// Time of the first fix there \[s\].
        start: f64,
        /// Time of the last one \[s\].
        end: f64,
        /// Share of the innovations inside three standard deviations there.
        inside: f64,
        /// Their root mean square in standard deviations.
        rms: f64,
        /// The share of all innovations of that part.
        overall: f64,
        /// Further such spans, of any part.
        more: u64,
    },
    /// Innovations are far beyond their predicted size.
    LargeInnovations {
        /// From when on \[s\].
        start: f64,
    },
    /// The stated standard deviations of the fixes do not fit the innovations.
    WrongAccuracy {
        /// Of which part of the fixes.
        part: Part,
        /// What they should be multiplied by.
        factor: f64,
        /// Whether they were adapted.
        adapted: bool,
        /// Whether innovations are correlated from fix to fix, which no accuracy explains.
        correlated: bool,
    },
    /// Records were skipped while reading.
    Skipped {
        /// Of which log.
        log: Log,
        /// How many.
        records: u64,
        /// How many of each kind, and the first, as the reader reports them.
        kinds: String,
    },
    /// Rows of a log are out of the order of time and were skipped.
    OutOfOrder {
        /// Of which log.
        log: Log,
        /// How many.
        rows: u64,
        /// Line or message of the first.
        line: u64,
    },
    /// Most rows of a log repeat the time stamp of the one before and were skipped.
    SharedStamps {
        /// Of which log.
        log: Log,
        /// How many.
        rows: u64,
        /// Usual interval of the stamps \[s\].
        interval: f64,
    },
    /// The clock of a log was set back and went on from there.
    SetBack {
        /// Of which log.
        log: Log,
        /// Line or message.
        line: u64,
        /// By how much \[s\].
        step: f64,
    },
    /// A log of scalars has gaps.
    Gaps {
        /// Which log.
        log: Log,
        /// How many.
        gaps: u64,
        /// Start of the longest \[s\].
        start: f64,
        /// Its length \[s\].
        length: f64,
    },
    /// Nothing of a log was used.
    Unused {
        /// Which log.
        log: Log,
    },
    /// Measurements of a log were far from what was predicted.
    Outliers {
        /// Which log.
        log: Log,
        /// How many were rejected.
        rejected: u64,
        /// How many were used with less weight.
        weakened: u64,
    },
    /// An outage begins before the solution.
    StartedLate {
        /// When navigation began \[s\].
        time: f64,
    },
    /// Outages have no reference inside them.
    NoReference {
        /// How many.
        outages: usize,
    },
    /// Single samples of an axis of the IMU cannot be right and were replaced.
    Spikes {
        /// 0 to 2 for the sensor's gyros x, y, z, 3 to 5 for its accelerometers.
        axis: usize,
        /// How many.
        samples: u64,
        /// Time of the first \[s\].
        start: f64,
    },
    /// Fixes repeat the one before: the receiver is slower than the log.
    RepeatedFixes {
        /// How many.
        fixes: u64,
        /// Interval of the others \[s\].
        interval: f64,
    },
    /// Positions come in steps.
    RoundedFixes {
        /// Size of the largest \[m\].
        step: f64,
    },
    /// The stamps of the fixes jitter.
    FixJitter {
        /// Standard deviation \[s\].
        std: f64,
    },
    /// The position's error is correlated in time.
    CorrelatedFixes {
        /// Share of its variance.
        share: f64,
        /// Correlation time \[s\].
        time: f64,
    },
    /// The white part of the position's error is larger than stated.
    NoisyFixes {
        /// Times the stated standard deviation.
        factor: f64,
    },
    /// The velocity is better than stated.
    ModestVelocity {
        /// Times the stated standard deviation.
        factor: f64,
    },
    /// The specific force at rest is not gravity by more than the accelerometers' noise model has.
    UnexplainedForce {
        /// By how much it is larger \[m/s²\].
        excess: f64,
    },
    /// The vertical velocities are all 0, and taken as not measured.
    NoVerticalVelocity {
        /// From when on \[s\].
        start: f64,
    },
    /// The vehicle moves across its forward axis more than wheels do, which the non-holonomic constraint denies.
    SideSlip {
        /// From when on \[s\].
        start: f64,
        /// RMS over the worst minute of motion [m/s].
        speed: f64,
    },
    /// The velocity is wrong for the positions by a constant.
    VelocityBias {
        /// What it reads too much, north, east, down [m/s].
        bias: [f64; 3],
    },
    /// The magnetic field was disturbed: the span that lasted longest.
    DisturbedField(undrift_events::DisturbedField),
    /// Headings by two antennas were rejected for a while.
    RejectedHeadings {
        /// The longest run of them.
        longest: undrift_events::RejectedHeadings,
        /// Further runs.
        more: u64,
    },
    /// The course contradicts the heading.
    HeadingOff {
        /// When it was seen first \[s\].
        start: f64,
        /// When it was seen last \[s\].
        end: f64,
        /// Course less heading, beyond what is usual, at most \[rad\].
        angle: f64,
        /// Further such spans.
        more: u64,
    },
    /// Innovations are larger than predicted although the fixes agree with each other.
    OptimisticModel {
        /// Times the predicted size.
        factor: f64,
        /// Whether the noise model was tuned on drives.
        #[serde(default)]
        tuned: bool,
    },
    /// Innovations are as large as predicted and do not change from fix to fix: what makes them lasts.
    CorrelatedInnovations {
        /// Of which part of the fixes.
        part: Part,
        /// Their autocorrelation from one fix to the next.
        correlation: f64,
        /// Whether the noise model was tuned on drives.
        #[serde(default)]
        tuned: bool,
    },
    /// Errors in outages are larger than predicted.
    OptimisticDrift {
        /// By which model.
        model: String,
        /// Share of the position errors inside three predicted standard deviations.
        inside: f64,
        /// Outages of which more than a tenth lies outside.
        #[serde(default)]
        outside: u64,
        /// Outages.
        #[serde(default)]
        outages: u64,
        /// Whether the noise model was tuned on drives.
        #[serde(default)]
        tuned: bool,
    },
    /// The run without outages rejects withheld fixes: they are no reference.
    RejectedReference {
        /// How many.
        fixes: u64,
        /// Of how many withheld ones.
        of: u64,
    },
    /// Outages were left out, as there is nothing to measure in them.
    OutagesLeftOut(LeftOut),
    /// No outage is left to measure in.
    NoOutage,
    /// Bias models that could not be run.
    NotRun {
        /// Which.
        models: Vec<String>,
        /// Whether there is no other.
        all: bool,
        /// Why, where it is the same for all of them.
        why: Option<String>,
    },
    /// Of one of several models.
    OfModel {
        /// Which.
        model: String,
        /// What was found of its run.
        what: Box<Finding>,
    },
    /// The solution covers a part of the log only.
    CoversPart {
        /// Begin of the solution, or of its longest part \[s\].
        from: f64,
        /// Its end \[s\].
        to: f64,
        /// First and last time of the inertial log \[s\].
        log: [f64; 2],
    },
    /// An estimated parameter is far from what was known of it.
    FarParameter(FarParameter),
    /// The stamps of a static recording are not evenly spaced.
    Uneven {
        /// Gaps between them.
        gaps: usize,
        /// Root mean square of the jitter \[s\].
        jitter_rms: f64,
        /// The usual interval \[s\].
        interval: f64,
    },
}
