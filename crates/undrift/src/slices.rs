//! The front door: plain slices in, a result with a verdict out.
//!
//! Both functions are the commands of their names on numbers in memory. What they do not ask for is set in a
//! [`Drive`] built by [`Drive::from_samples`], or in [`identify::Settings`] and a [`Record`].

use undrift_drive::{
    drive::Drive,
    findings::{self, Finding},
    identify::{self, Identified, RecordingError},
    navigate::{self, Hindsight, NavigateError, Report, Wanted},
    record::Record,
};
use undrift_engine::{Navigator, align::AlignSettings, settings::Settings, vehicle::Profile};
use undrift_io::write::solution::SolutionRow;
use undrift_nav::{
    Vector3,
    parameters::Parameter,
    sample::{GnssFix, ImuSample},
};
use undrift_noise::{BiasModel, ImuModel, Provenance};
use undrift_results::{AxisDoubt, usability::Usability};

/// What is known of a drive beside its samples, fixes and noise model. The default knows nothing.
#[derive(Clone, Debug)]
pub struct Setup {
    /// From the IMU to the antenna, body axes forward, right, down \[m\]; where it is not known it is estimated, from
    /// zero known to half a metre.
    pub lever_arm: Option<Vector3>,
    /// What moves: its constraints are applied.
    pub vehicle: Profile,
    /// Whether the axes of the samples are the sensor's own, and how they sit in the vehicle is estimated from the drive.
    pub estimate_mounting: bool,
    /// How it starts: by default aligned from rest and motion.
    pub align: AlignSettings,
    /// In which form the filter carries the noise model. The default, [`BiasModel::Arma`], carries all of it: what
    /// [`identify`](fn@identify) recommends, as it was recommended; the others leave something out, for comparison.
    pub bias_model: BiasModel,
    /// How much of the drive each estimate may know: by default what came before it, as while driving.
    pub hindsight: Hindsight,
    /// Whether one clock stamps samples and fixes, each at the instant at which it holds (a receiver's pulse, one board). Else the
    /// offset between them is estimated, and what is not known of it is in the standard deviations: at 10 m/s and 20 ms 0.2 m, more
    /// than fixes of centimetres have.
    pub one_clock: bool,
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            lever_arm: None,
            vehicle: Profile::None,
            estimate_mounting: false,
            align: AlignSettings::default(),
            bias_model: BiasModel::Arma,
            hindsight: Hindsight::Causal,
            one_clock: false,
        }
    }
}

impl Setup {
    /// The drive that [`navigate`](fn@navigate) runs, for whatever else takes a drive: outages, tuning.
    pub fn drive(&self, imu: &[ImuSample], fixes: &[GnssFix], model: &ImuModel) -> Drive {
        let mut drive = Drive {
            estimate_mounting: self.estimate_mounting,
            align: self.align.clone(),
            model: Some(model.clone()),
            ..Drive::from_samples(imu, fixes).with_vehicle(self.vehicle)
        };
        if self.one_clock {
            drive.parameters = [
                Parameter::TimeOffset,
                Parameter::VelocityTimeOffset,
                Parameter::ClockRate,
            ]
            .into_iter()
            .fold(drive.parameters, |parameters, kind| {
                parameters.without(kind)
            });
        }
        match self.lever_arm {
            Some(lever_arm) => drive.with_lever_arm(lever_arm),
            None => drive,
        }
    }

    /// A navigator to push samples of `interval` \[s\] and fixes into, as they come: in real time there is no smoothing, and
    /// a mounting to be estimated is found on the way.
    ///
    /// One that goes on in another process is restored under the same settings:
    ///
    /// ```
    /// use undrift::{ImuModel, Navigator, Setup};
    ///
    /// let model = ImuModel::preset("adis16465").ok_or("no such preset")?;
    /// let setup = Setup::default();
    /// let navigator = setup.navigator(&model, 0.01)?.with_horizon(1.0);
    /// let bytes = navigator.checkpoint();
    /// let again = Navigator::restore(setup.settings(&model, 0.01)?, &bytes)?;
    /// assert_eq!(again.checkpoint(), bytes);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Setup::settings`].
    pub fn navigator(&self, model: &ImuModel, interval: f64) -> Result<Navigator, NavigateError> {
        self.settings(model, interval).map(Navigator::new)
    }

    /// The settings of that navigator, for [`Navigator::restore`] or to change some of them.
    ///
    /// # Errors
    /// A noise model that makes no filter at this interval.
    pub fn settings(&self, model: &ImuModel, interval: f64) -> Result<Settings, NavigateError> {
        let mut drive = self.drive(&[], &[], model);
        drive.imu.1.rate_hz = Some(1.0 / interval);
        navigate::settings(&drive, self.bias_model)
    }
}

/// A navigated drive.
#[derive(Debug)]
pub struct Navigated {
    /// Whether the solution can be used.
    pub verdict: Usability,
    /// What was found in the logs and the solution, causes before symptoms. As sentences: `undrift_report::say`.
    pub findings: Vec<Finding>,
    /// The solution at every sample, from the alignment on.
    pub solution: Vec<SolutionRow>,
    /// Counts, alignment, innovations and all else.
    pub report: Report,
}

impl Navigated {
    /// The likeliest cause of a verdict that is not `usable`.
    pub fn cause(&self) -> Option<&Finding> {
        findings::verdict(&self.findings).1
    }
}

/// Navigates a drive held in memory: samples and fixes, each in order of time and in the same time base.
///
/// Samples are in body axes, forward, right, down ([`ImuSample::from_rates`]), fixes of the antenna ([`GnssFix::at`]).
///
/// ```
/// use undrift::{ImuModel, Setup, Usability, navigate};
/// # use undrift::{BiasModel, Trajectory, simulate, simulate::GnssNoise};
/// # let model = ImuModel::preset("adis16465").ok_or("no such preset")?;
/// # let sensors = model.shaping(BiasModel::GaussMarkov, 0.02)?;
/// # let log = simulate(&Trajectory::car(150.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
/// # let (imu, fixes) = (&log.imu, &log.gnss);
///
/// let model = ImuModel::preset("adis16465").ok_or("no such preset")?;
/// let done = navigate(imu, fixes, &model, &Setup::default())?;
/// let end = done.solution.last().ok_or("no solution")?;
/// println!("{}: {:?} ± {:.1} m", done.verdict, end.position, end.nav_std[0]);
/// assert_ne!(done.verdict, Usability::NotUsable);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`navigate::navigate`](crate::navigate::navigate()): no usable samples or fixes, no alignment before they end, a noise
/// model that makes no filter at their rate.
pub fn navigate(
    imu: &[ImuSample],
    fixes: &[GnssFix],
    model: &ImuModel,
    setup: &Setup,
) -> Result<Navigated, NavigateError> {
    let drive = setup.drive(imu, fixes, model);
    let wanted = Wanted {
        hindsight: setup.hindsight,
        rows: true,
        ..Wanted::default()
    };
    let mut report = navigate::navigate(&drive, setup.bias_model, wanted)?;
    let findings = report.findings();
    Ok(Navigated {
        verdict: findings::verdict(&findings).0.into(),
        findings,
        solution: std::mem::take(&mut report.rows),
        report,
    })
}

/// An identified static recording.
pub struct Identification {
    /// Whether the models can be used.
    pub verdict: Usability,
    /// The axes that are not to be trusted, and why.
    pub doubts: Vec<(String, AxisDoubt)>,
    /// The noise model for [`navigate`](fn@navigate). One recording bounds the turn-on constants only; with those of a data
    /// sheet: [`Identified::model`].
    pub model: ImuModel,
    /// Tests, candidates and scores of each axis.
    pub identified: Identified,
}

/// Identifies the noise of a sensor from a recording at rest: rows of gyro x, y, z [rad/s] and accelerometer x, y, z [m/s²]
/// at a rate \[Hz\], NaN where a value is missing; an axis of NaN alone is left out. Some minutes to hours; it takes seconds.
///
/// ```
/// # use undrift::{BiasModel, ImuModel, noise::synthesis::NoiseGenerator};
/// # let preset = ImuModel::preset("adis16465").ok_or("no such preset")?;
/// # let sensors = preset.shaping(BiasModel::White, 0.1)?;
/// # let mut noise: Vec<_> = (0..6).map(|axis| NoiseGenerator::new(&sensors[axis], axis as u64)).collect();
/// # let mut rows: Vec<[f64; 6]> = (0..4000).map(|_| std::array::from_fn(|axis| noise[axis].sample())).collect();
/// # rows.iter_mut().for_each(|row| row[5] -= 9.81);
/// // `rows`: a recording at 10 Hz of a sensor that lies level and still, here simulated from a preset.
/// let found = undrift::identify(&rows, 10.0)?;
/// println!("{}: {:?}", found.verdict, found.doubts);
/// let density = found.model.gyro[0].white_density(); // Angle random walk of gyro x [rad/√s].
/// println!("{:.3} deg/√h", density.to_degrees() * 60.0);
/// assert!((density / preset.gyro[0].white_density() - 1.0).abs() < 0.1);
/// let file = found.model.to_toml(); // The model file, for `ImuModel::load`.
/// # assert!(file.contains("[gyro"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`RecordingError::NotStatic`] of a sensor that moves, or of other units; [`RecordingError::NoAxis`] where no axis could
/// be identified.
pub fn identify(samples: &[[f64; 6]], rate_hz: f64) -> Result<Identification, RecordingError> {
    let settings = identify::Settings {
        rate_hz: Some(rate_hz),
        ..identify::Settings::default()
    };
    let prepared = identify::prepare(Record::from_samples(samples).with_values(), &settings)?;
    if let Some(why) = prepared.not_static {
        return Err(why.into());
    }
    let identified = identify::recordings(&[prepared], &settings, || ())?;
    let provenance = Provenance {
        rate_hz: Some(rate_hz),
        samples: Some(samples.len() as u64),
        program: Some(format!("undrift {}", env!("CARGO_PKG_VERSION"))),
        ..Provenance::default()
    };
    let model = identified.model(None, "identified", provenance)?;
    // Its verdict and doubts are values: no sentence of it is shown.
    let result = identified.result("", &|_| String::new());
    let doubts = result.doubts().into_iter();
    Ok(Identification {
        verdict: result.verdict(),
        doubts: doubts.map(|(axis, why)| (axis.to_owned(), why)).collect(),
        model,
        identified,
    })
}
