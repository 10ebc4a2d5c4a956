//! The limits and time constants of alignment and replay, each with its unit and reason.
//!
//! [`EngineSettings::default`] holds the values that everything in docs/ was measured with;
//! `docs/settings.md` lists them. What a user sets for a drive is in [`replay::Settings`].

pub mod fix_errors;
pub mod quality;
pub mod replay;

/// Makes the structs, their defaults and the list of all fields from one line a field.
macro_rules! settings {
    ($($(#[doc = $about:literal])+ $name:ident {
        $($(#[doc = $doc:literal])+ $field:ident: $type:ty = $value:expr,)+
    })+) => {
        $($(#[doc = $about])+
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name {
            $($(#[doc = $doc])+ pub $field: $type,)+
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $value,)+ }
            }
        }
        )+

        /// Every field: its struct, its name, its default and what it is.
        pub const ALL: &[[&str; 4]] = &[$($(
            [stringify!($name), stringify!($field), stringify!($value), concat!($($doc),+)],
        )+)+];
    };
}

/// Whether a value lies between two limits, the upper one excluded.
pub(crate) fn within([low, high]: [f64; 2], value: f64) -> bool {
    low <= value && value < high
}

settings! {
    /// All limits of the engine.
    EngineSettings {
        /// Alignment in general and after a rest.
        alignment: AlignmentSettings = AlignmentSettings::default(),
        /// How an alignment recognises rest.
        alignment_rest: AlignmentRestSettings = AlignmentRestSettings::default(),
        /// Alignment in motion.
        alignment_motion: AlignmentMotionSettings = AlignmentMotionSettings::default(),
        /// How the clocks of logs that do not overlap differ.
        clocks: ClockSettings = ClockSettings::default(),
        /// Gaps in the samples.
        gaps: GapSettings = GapSettings::default(),
        /// Implausible samples.
        samples: SampleSettings = SampleSettings::default(),
        /// White noise beyond the model's, measured in the samples.
        vibration: VibrationSettings = VibrationSettings::default(),
        /// Which fixes are accepted.
        gate: GateSettings = GateSettings::default(),
        /// How the accuracy of the fixes is adapted.
        adapt: AdaptSettings = AdaptSettings::default(),
        /// Receiver faults, and for how long its fixes are rejected.
        receiver: ReceiverSettings = ReceiverSettings::default(),
        /// What is checked in the fixes before navigation.
        fix_study: FixStudySettings = FixStudySettings::default(),
        /// Standard deviations by the kind of solution.
        quality: QualitySettings = QualitySettings::default(),
        /// How the course reveals a wrong heading.
        course: CourseWatchSettings = CourseWatchSettings::default(),
        /// When the covariance is too small for the innovations.
        fading: FadingSettings = FadingSettings::default(),
        /// When a solution has diverged.
        watch: WatchSettings = WatchSettings::default(),
        /// How rest is recognised while navigating.
        rest: RestSettings = RestSettings::default(),
        /// Measurements other than the fixes.
        constraints: ConstraintSettings = ConstraintSettings::default(),
        /// Velocities derived from positions, where the receiver reports none.
        derived_velocity: DerivedVelocitySettings = DerivedVelocitySettings::default(),
        /// Implausible units, axes, signs and times.
        plausibility: PlausibilitySettings = PlausibilitySettings::default(),
    }

    /// Alignment in general and after a rest.
    AlignmentSettings {
        /// Speed of the last fix above which nothing counts as rest \[m/s\].
        rest_speed: f64 = 0.5,
        /// A first fix that is faster than this after a rest \[m/s\] …
        start_speed: f64 = 2.0,
        /// … and what the vehicle may have gained since then at this acceleration \[m/s²\] shows that it was no rest.
        start_acceleration: f64 = 5.0,
        /// What disturbs the mean specific force of a vehicle at rest (engine, wind, people) \[m/s²\].
        level_floor: f64 = 0.02,
        /// What disturbs its mean rate \[rad/s\].
        rate_floor: f64 = 1e-4,
        /// Tilt before levelling, one standard deviation \[rad\].
        tilt_before: f64 = 0.5,
        /// Side slip of a vehicle and error of a course, one standard deviation \[rad\].
        course_floor: f64 = 0.035,
        /// A course with a larger standard deviation does not serve as heading \[rad\].
        course_worst: f64 = 0.52,
        /// Fixes further apart than this are not a pair \[s\].
        pair_span: f64 = 2.5,
    }

    /// How an alignment recognises rest: means over blocks that agree.
    AlignmentRestSettings {
        /// Length of the blocks that are compared \[s\].
        block: f64 = 0.5,
        /// Consecutive blocks that agree before they count as rest, or more where the noise asks for more.
        fewest_blocks: u32 = 2,
        /// The same while GNSS does not show that the vehicle stands: a steady turn has steady readings too.
        blocks_unseen: u32 = 6,
        /// The same for rest with another gyro bias than before, GNSS at rest.
        new_bias_blocks: u32 = 10,
        /// Blocks that noisy sensors need, at most.
        most_blocks: u32 = 20,
        /// White noise of the mean specific force that is small enough \[m/s²\]: 0.3 deg of level.
        force_noise: f64 = 0.05,
        /// White noise of the mean rate that is small enough \[rad/s\]: 0.05 deg/s.
        rate_noise: f64 = 1e-3,
        /// A block belongs to the rest while its means are this many standard deviations of their white noise from the rest's …
        sigmas: f64 = 5.0,
        /// … and this far beyond \[rad/s\] …
        rate: f64 = 0.003,
        /// … and this far beyond \[m/s²\].
        force: f64 = 0.05,
    }

    /// Alignment in motion: a least-squares search over a window.
    AlignmentMotionSettings {
        /// The window is no longer than this \[s\] …
        longest: f64 = 60.0,
        /// … nor than a gyro bias of one standard deviation needs for this angle \[rad\] …
        bias_turn: f64 = 1.2,
        /// … and no shorter than this \[s\].
        shortest: f64 = 20.0,
        /// Fixes in the search are at least this far apart \[s\].
        spacing: f64 = 0.45,
        /// A sample longer than this ends the window \[s\].
        longest_sample: f64 = 0.2,
        /// Least time between two searches \[s\].
        every: f64 = 1.0,
        /// Least time between two searches, as a share of the window, while none has succeeded.
        pause: f64 = 0.1,
        /// After so many searches of the longest window that found nothing that share grows …
        patience: usize = 5,
        /// … each time by this: a log that nothing explains shall not take long to say so …
        growth: f64 = 1.5,
        /// … up to this.
        longest_pause: f64 = 5.0,
        /// Velocities needed for a search to be worth it.
        fewest: usize = 6,
        /// How far apart they must be \[m/s\].
        spread: f64 = 1.0,
        /// A second minimum is out of the question when the best one's squared residuals are less by this much.
        rival: f64 = 25.0,
        /// Largest standard deviation of the attitude about any axis for an acceptable solution \[rad\] …
        certain: f64 = 0.05,
        /// … and for one that need not wait for a longer window \[rad\]: the filter, unlike the window, cannot undo what it took from an attitude that was some degrees off.
        good: f64 = 0.017,
        /// Squared residuals for each degree of freedom, at most.
        fit: f64 = 10.0,
        /// Standard deviation of the filter's velocity and attitude before the window determines them \[m/s, rad\].
        wide: f64 = 100.0,
        /// Standard deviation of unmodelled gyro bias \[rad/s\]: nothing is known exactly.
        gyro_floor: f64 = 1e-4,
        /// Standard deviation of unmodelled accelerometer bias \[m/s²\].
        accel_floor: f64 = 1e-2,
        /// Iterations of one solution, at most.
        iterations: usize = 20,
        /// Headings that the search starts from.
        headings: usize = 12,
        /// Attitudes within this angle are the same minimum \[rad\].
        same: f64 = 0.15,
    }

    /// How the clocks of logs that do not overlap differ.
    ClockSettings {
        /// Spans of the same drive differ by less than this factor.
        same_drive: f64 = 2.0,
        /// No receiver has a shorter interval \[s\] …
        shortest_fix: f64 = 0.01,
        /// … and no IMU a shorter one than this \[s\].
        shortest_sample: f64 = 2e-5,
        /// Unix times of the years 2001 to 2065 \[s\].
        unix: [f64; 2] = [1e9, 3e9],
        /// Times since boot, of the day and of the week are less than this \[s\].
        not_unix: f64 = 1e8,
        /// Time zones and days: logs that are more hours apart differ in something else.
        most_hours: f64 = 24.0,
        /// Logs of a drive begin at most so long one after the other to be whole hours apart \[s\].
        together: f64 = 300.0,
    }

    /// Gaps in the samples.
    GapSettings {
        /// A sample after more than this many intervals is a gap, not just late.
        intervals: f64 = 1.5,
        /// A gap longer than this is too long to interpolate over \[s\].
        longest_bridge: f64 = 0.2,
        /// What a vehicle may do unseen in a longer one: acceleration, one standard deviation \[m/s²\] …
        accel: f64 = 2.0,
        /// … and turn rate \[rad/s\].
        rate: f64 = 0.2,
        /// A gap longer than this ends the solution: the attitude is lost by then \[s\].
        longest: f64 = 60.0,
    }

    /// Implausible samples.
    SampleSettings {
        /// Values of an axis after which its usual behaviour is known.
        least_values: u64 = 500,
        /// A spike is this many times further from the mean of its neighbours than nine in ten samples, …
        spike_steps: f64 = 25.0,
        /// … by this rate \[rad/s\] …
        spike_rate: f64 = 1.0,
        /// … or this specific force \[m/s²\]: a pothole does less in one sample, …
        spike_force: f64 = 30.0,
        /// … and its neighbours are apart by no more than this part of that.
        spike_apart: f64 = 0.3,
        /// An axis whose values usually last fewer samples than this never repeats one: …
        alone: f64 = 1.5,
        /// … there a repeated value this many times further from the previous one is the end of its range.
        jump_steps: f64 = 5.0,
        /// By what part the usual distance to the neighbours' mean follows each sample.
        step_gain: f64 = 0.05,
        /// The replacement of a spike is uncertain by this many usual distances.
        replaced_steps: f64 = 5.0,
        /// A frozen axis repeats a value for this long \[s\] …
        frozen: f64 = 0.5,
        /// … and for this many times the usual number of samples.
        frozen_times: f64 = 20.0,
        /// If all axes of a sensor repeat their values for this long at rest \[s\], repetitions carry no information.
        noiseless: f64 = 5.0,
        /// Speed of the solution above which the vehicle does not rest \[m/s\]: walking pace.
        moves: f64 = 1.0,
        /// A saturated one repeats its largest or smallest value for this many times the usual number …
        saturated_times: f64 = 4.0,
        /// … this many usual standard deviations from its mean.
        saturated_spread: f64 = 4.0,
        /// Time over which the usual behaviour of an axis is averaged \[s\].
        usual: f64 = 60.0,
        /// Duration of a turn or an acceleration that a stuck axis misses \[s\].
        turn_lasts: f64 = 5.0,
        /// What a vehicle may at least do meanwhile: turn rate \[rad/s\] …
        rate: f64 = 0.3,
        /// … and acceleration \[m/s²\].
        force: f64 = 1.0,
    }

    /// White noise beyond the model's, measured in the samples.
    VibrationSettings {
        /// Samples are averaged to at most about this rate \[Hz\]: a low-pass filter of the sensor reaches less far.
        rate: f64 = 100.0,
        /// Below this rate \[Hz\] the motion of the vehicle reaches the band that is looked at.
        least_rate: f64 = 20.0,
        /// The model's noise is exceeded from this factor on, a density; less is chance.
        from: f64 = 1.5,
        /// Time over which the noise is averaged \[s\].
        memory: f64 = 3.0,
        /// A sample longer than this many intervals ends a block.
        gap: f64 = 1.5,
    }

    /// Which fixes are accepted. NIS is per degree of freedom.
    GateSettings {
        /// Innovations after which their usual size is known.
        least: usize = 10,
        /// Usual NIS until then: standard deviations five times too small.
        first_usual: f64 = 30.0,
        /// Usual NIS above which everything passes: twenty times the standard deviation.
        senseless: f64 = 400.0,
        /// NIS relative to the usual from which a fix is down-weighted …
        weaken: f64 = 5.0,
        /// … and rejected, …
        reject: f64 = 30.0,
        /// … in an unconfirmed solution, where rejecting a right fix costs most: one in a million of
        /// right ones has 30.7 of 3.
        reject_unconfirmed: f64 = 10.2,
        /// The solution is unconfirmed after this long without a fix \[s\] …
        gap: f64 = 3.0,
        /// … until it has accepted this many.
        confirm: u32 = 3,
        /// Innovations agree when they differ by less than this part of their size …
        agree: f64 = 0.3,
        /// … or by this many standard deviations of two fixes.
        agree_sigmas: f64 = 2.0,
        /// Fixes rejected within this time after the solution accepted others belong to the run before \[s\].
        goes_on: f64 = 3.0,
    }

    /// How the factor on the stated covariance of the fixes is learned.
    AdaptSettings {
        /// Information of the factor's logarithm at first: a standard deviation of a factor of ten in the variance.
        prior: f64 = 0.2,
        /// Information that is remembered; the logarithm's standard deviation is this to the power −½.
        memory: f64 = 300.0,
        /// Largest change of the logarithm by one fix.
        step: f64 = 0.5,
        /// Largest logarithm.
        range: f64 = 9.2,
        /// Updates before the mean is taken.
        settle: u64 = 40,
    }

    /// Receiver faults, and for how long its fixes are rejected.
    ReceiverSettings {
        /// A receiver does not measure the same numbers twice: a fix equal to one within this time before \[s\] is that one, held by the logger, …
        repeated: f64 = 2.0,
        /// … unless it is slower than this \[m/s\].
        repeated_speed: f64 = 0.1,
        /// A time offset of more prior standard deviations than this is no offset but an error of the sensors.
        most_late: f64 = 10.0,
        /// A receiver that repeats a position while the solution moves by more than this many of its standard deviations is frozen …
        frozen_sigmas: f64 = 3.0,
        /// … if the solution is faster than this \[m/s\].
        frozen_speed: f64 = 1.0,
        /// … or if its repeated fix has pulled at the velocity by more than this \[m/s\] …
        pull: f64 = 0.5,
        /// … within about so long \[s\], beyond what the attitude explains.
        pull_time: f64 = 4.0,
        /// Fixes further apart than this are not compared before the alignment \[s\].
        odd_gap: f64 = 2.5,
        /// Position and velocity of closer ones may differ by this \[m/s\] …
        odd_speed: f64 = 1.0,
        /// … and this acceleration \[m/s²\] …
        odd_accel: f64 = 5.0,
        /// … and this many standard deviations.
        odd_sigmas: f64 = 5.0,
        /// For how long fixes that agree with each other are rejected before a confirmed solution follows them \[s\]: a receiver finds position and velocity in different ways, so where velocity or both contradict the solution, the solution is more likely to be wrong.
        patience: f64 = 3.0,
        /// The same where position alone contradicts: then the position is more likely to be wrong \[s\].
        patience_position_alone: f64 = 15.0,
        /// The same where there is no velocity \[s\].
        patience_no_velocity: f64 = 5.0,
        /// The same where the receiver repeats itself \[s\].
        patience_frozen: f64 = 60.0,
        /// Tilt that a contradiction is taken to stand for, at most \[rad\].
        most_tilt: f64 = 0.1,
        /// A solution that followed contradicting positions and velocities three times within this time has diverged \[s\].
        three_times: f64 = 90.0,
    }

    /// How the course reveals a wrong heading.
    CourseWatchSettings {
        /// Speed above which there is a course \[m/s\].
        speed: f64 = 4.0,
        /// Largest standard deviation of the course \[rad\].
        course_std: f64 = 0.1,
        /// Turn rate below which the vehicle goes straight \[rad/s\].
        straight: f64 = 0.1,
        /// Cosine of the angle between body down and down below which there is no heading.
        level: f64 = 0.94,
        /// Courses further apart than this do not belong together \[s\].
        apart: f64 = 30.0,
        /// Differences of course and heading after which the usual one is known.
        least: usize = 30,
        /// Standard deviation of a heading from which the usual difference is learned \[rad\].
        known: f64 = 0.05,
        /// Least spread of the usual difference \[rad\]: wind and slip.
        least_spread: f64 = 0.01,
        /// The heading is wrong where the difference has changed by this many spreads …
        spreads: f64 = 4.0,
        /// … and standard deviations of the heading.
        sigmas: f64 = 2.0,
    }

    /// When the covariance is too small for the innovations. NIS is per degree of freedom.
    FadingSettings {
        /// Size of the last sixteen innovations squared, by their median, over the usual one, from which the covariance grows.
        from: f64 = 4.0,
        /// By at most this factor an update.
        most: f64 = 1.5,
        /// One innovation counts up to this many times the usual NIS.
        clip: f64 = 10.0,
        /// Autocorrelation of innovations from which they may be correlated measurements.
        correlated: f64 = 0.3,
        /// By what part the usual NIS follows each.
        gain: f64 = 0.005,
        /// Updates after which it is known.
        least: u32 = 40,
        /// Least usual NIS: standard deviations stated twice too large.
        least_usual: f64 = 0.25,
        /// Standard deviation of the heading beyond which nothing is gained \[rad\].
        most_heading: f64 = 0.5,
    }

    /// What is checked in the fixes before navigation.
    FixStudySettings {
        /// Fixes that are looked at: an hour and a half at 4 Hz.
        most: usize = 20_000,
        /// Fewer carry no information.
        least: usize = 80,
        /// While navigating they are looked at after this time \[s\], and whenever it has doubled.
        first_span: f64 = 60.0,
        /// Pairs of fixes for a mean square to be worth something.
        least_pairs: usize = 40,
        /// White noise this many times the stated one is reported to the filter.
        factor: f64 = 2.0,
        /// Velocities that the positions show to be better than this share of their stated standard deviations are
        /// taken as that good, …
        modest: f64 = 0.5,
        /// … as far as a latency that they do not show leaves room for it at this acceleration \[m/s²\], …
        accelerates: f64 = 2.0,
        /// … and down to this share.
        least_velocity: f64 = 0.1,
        /// Of what is left this share of the variance lasts, as a receiver that smooths has it …
        velocity_share: f64 = 0.6,
        /// … for this time \[s\].
        velocity_time: f64 = 3.0,
        /// White variance below this share of the stated one: the rest of the error lasts.
        white_share: f64 = 0.8,
        /// The white part has at least what is left of this share: receivers smooth, inertial sensors are not perfect.
        most_share: f64 = 0.99,
        /// Differences that grow to the whole sooner are the velocities' error, or white \[s\].
        shortest: f64 = 5.0,
        /// The velocities' own error makes the differences grow sooner, by about this factor.
        sooner: f64 = 2.0,
        /// A velocity that the positions contradict by this many standard errors …
        bias_errors: f64 = 5.0,
        /// … this many of its own standard deviations …
        bias_sigmas: f64 = 0.5,
        /// … and by this is wrong \[m/s\].
        least_bias: f64 = 0.15,
        /// Longer times are treated as equal \[s\].
        longest: f64 = 1000.0,
        /// Speed above which there is an along and an across \[m/s\].
        moves: f64 = 3.0,
        /// Along-track differences this many times the cross-track ones are errors of the stamps.
        along: f64 = 2.0,
        /// Steps whose variance is below this share of the stated one are how numbers are written.
        step_share: f64 = 0.25,
    }

    /// Standard deviations by the kind of solution.
    QualitySettings {
        /// Typical horizontal standard deviations of fixed, float, differential and single solutions under an open sky \[m\] (Teunissen & Montenbruck 2017, chapters 21 and 26).
        typical: [f64; 4] = [0.0, 0.3, 0.7, 2.5],
        /// Vertical ones are this many times as large.
        vertical: f64 = 1.5,
    }

    /// When a solution has diverged. NIS is per degree of freedom.
    WatchSettings {
        /// NIS over this many updates …
        suspect_updates: u32 = 20,
        /// … and above this makes a solution suspect of divergence.
        suspect_nis: f64 = 25.0,
        /// NIS of a sound solution.
        sound_nis: f64 = 4.0,
        /// A solution that was sound and has been suspect for this long is re-initialised \[s\].
        sick: f64 = 30.0,
        /// Fixes in a block over which innovations are averaged for a lean to one side.
        lean_block: usize = 40,
        /// The mean over a block leans when it is this many times the usual and the expected size, squared.
        leans: f64 = 60.0,
        /// Blocks after which their usual size is known.
        least_blocks: usize = 5,
        /// Whitened innovations count up to this size: a single outlier does not make a lean.
        clip: f64 = 4.0,
        /// Prior standard deviations beyond which an estimated parameter is remarked on.
        far: f64 = 5.0,
    }

    /// How rest is recognised while navigating.
    RestSettings {
        /// Length of the blocks that are judged \[s\].
        block: f64 = 0.5,
        /// Rest while the scatter of a block is below this many times that of rest, on the average of the axes …
        limit: f64 = 3.0,
        /// … or, until rest has been seen, that of the sensor's own noise.
        noise_limit: f64 = 2.0,
        /// The mean rate at rest is known to this much beyond the noise of the mean \[rad/s\].
        rate: f64 = 0.004,
        /// Means of the specific force in the two halves of a block agree to this much at rest \[m/s²\].
        force: f64 = 0.06,
        /// The mean specific force is the solution's gravity to this much at rest \[m/s²\]: 3° of wrong level, while a car that pulls away smoothly has twice that.
        level: f64 = 0.5,
        /// Both limits grow by this factor where GNSS shows that the vehicle stands.
        unsure: f64 = 5.0,
        /// Speed that GNSS calls standing, where its accuracy leaves no doubt \[m/s\].
        stands: f64 = 0.1,
        /// Speed that it calls moving \[m/s\].
        moves: f64 = 0.5,
        /// Weight of a block in the learned level.
        learn: f64 = 0.1,
    }

    /// Measurements other than the fixes.
    ConstraintSettings {
        /// NIS from which a constraint, wheel speed or height is down-weighted …
        weaken: f64 = 9.0,
        /// … and rejected: it contradicts the solution far beyond both.
        reject: f64 = 100.0,
        /// What the standard deviation of a rest is multiplied by that only the sensors see: a soft start has begun before it shows.
        rest_unconfirmed: f64 = 10.0,
        /// NIS from which a rest that only the sensors confirm is a start: χ² of three at p = 10⁻⁴.
        reject_rest: f64 = 21.1,
        /// The speed of a fix holds for this long \[s\].
        speed_holds: f64 = 1.5,
    }

    /// Velocities of positions: the slope of a line through the last of them.
    DerivedVelocitySettings {
        /// From the first of them to the last \[s\] …
        span: f64 = 2.0,
        /// … or longer, up to this \[s\], …
        longest: f64 = 5.0,
        /// … to have this many.
        least: usize = 5,
        /// What their scatter does not show, one standard deviation \[m/s\].
        floor: f64 = 0.1,
        /// By how much a vehicle may have slowed down since \[m/s²\].
        braking: f64 = 2.0,
    }

    /// Implausible units, axes, signs and times.
    PlausibilitySettings {
        /// Length of the blocks that specific force is averaged over \[s\].
        block: f64 = 1.0,
        /// How many there must be.
        least_blocks: u32 = 10,
        /// Least and largest multiple of gravity that a block of a vehicle has …
        gravity: [f64; 2] = [0.7, 1.4],
        /// … and the least share of such blocks.
        least_share: f64 = 0.1,
        /// Cosine of the angle between gravity and body down below which axes are not forward, right, down.
        down: f64 = 0.5,
        /// Length of the windows over which position and velocity are compared \[s\].
        move_window: f64 = 2.0,
        /// How many there must be.
        least_moves: u32 = 8,
        /// Fixes further apart than this do not belong together \[s\].
        apart: f64 = 2.5,
        /// Least share of windows of motion that are as they should be.
        least_sane: f64 = 0.4,
        /// Two displacements agree to this part of the larger one.
        agree: f64 = 0.2,
        /// Speed below which there is no course \[m/s\].
        course_speed: f64 = 3.0,
        /// Largest standard deviation of a course \[rad\].
        course_std: f64 = 0.1,
        /// Shortest and longest window of a turn \[s\].
        turn_window: [f64; 2] = [0.9, 2.5],
        /// What turns further in it is an outlier \[rad\].
        most_turn: f64 = 1.0,
        /// Sum of squares of the turns that is enough to judge by \[rad²\]: one right-angle bend.
        enough_turn: f64 = 0.25,
        /// Step between the lags at which turns are compared \[s\].
        lag: f64 = 0.25,
        /// Windows that have to be compared before a lag is believed.
        lag_windows: f64 = 20.0,
        /// From one entry of the history of turns to the next \[s\].
        history_step: f64 = 0.1,
        /// Least and largest multiple of the gyros' turns that the course may turn by: a bank makes 1/cos of it.
        turn_scale: [f64; 2] = [0.6, 1.7],
        /// Sum of squares of the accelerations that is enough to judge by \[m²/s⁴\]: some ten seconds of 0.5 m/s².
        enough_push: f64 = 2.5,
        /// A component of the velocity has the wrong sign where its innovations are this part of it, on the average: −2 if the solution ignores it, closer to 0 the more it follows …
        wrong_sign: f64 = -0.6,
        /// … and the sum of its squares is above this \[m²/s²\].
        sign_motion: f64 = 5.0,
    }
}
