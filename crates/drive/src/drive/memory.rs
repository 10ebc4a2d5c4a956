//! Drives of samples in memory.

use super::{Beginning, Drive, Logs, ScalarLog, scalars::about, tables};
use crate::{
    align::AlignSettings,
    replay::{GnssUse, QualityStd},
    settings::fix_errors::{Correlation, StdFactors},
    vehicle::Profile,
};
use std::path::{Path, PathBuf};
use undrift_io::{
    Memory, gnss::GnssSource, imu::ImuFormat, scalar::ScalarFormat, source::BytesRead,
    truth::TruthSource,
};
use undrift_nav::{
    Vector3,
    covariance::AXES,
    sample::{GnssFix, ImuSample, Scalar, TruthSample},
};

/// What messages and results call the logs.
const IMU: &str = "<imu>";
const GNSS: &str = "<gnss>";
const TRUTH: &str = "<truth>";

impl Drive {
    /// A drive of samples and fixes in memory, each in order of time in the same time base: samples in body axes, antenna at
    /// the IMU, no vehicle. All else is as in a drive file that says nothing of it, and is set in the fields; `model` must be.
    ///
    /// Samples and fixes are checked where they are read, as those of a file: what is not finite or out of order is
    /// skipped and counted.
    pub fn from_samples(imu: &[ImuSample], fixes: &[GnssFix]) -> Self {
        let (imu_path, gnss_path) = (PathBuf::from(IMU), PathBuf::from(GNSS));
        let mut logs = Logs::default();
        logs.memory
            .insert(imu_path.clone(), Memory::Samples(imu.into()));
        logs.memory
            .insert(gnss_path.clone(), Memory::Fixes(fixes.into()));
        let (constraints, parameters) =
            tables::vehicle_by_default(Profile::default(), tables::states_by_default());
        let mut drive = Self {
            imu: (imu_path, ImuFormat::samples()),
            imu_read: BytesRead::default(),
            estimate_mounting: false,
            mounting_std: Vector3::zeros(),
            accel_scale_error: 0.0,
            vibration: Some([1.0; AXES]),
            gnss: (
                gnss_path,
                GnssSource::Fixes {
                    time_offset: 0.0,
                    span: None,
                },
            ),
            poses: None,
            scalars: Default::default(),
            magnetometer: None,
            magnetometer_lasting: 0.0,
            gnss_use: GnssUse::default(),
            truth: None,
            lever_arm: Vector3::zeros(),
            align: AlignSettings::default(),
            parameters,
            constraints,
            gating: true,
            adapt: false,
            quality: QualityStd::AsStated,
            correlation: Correlation::Auto,
            std_factors: StdFactors::ONE,
            model: None,
            epoch: None,
            beginning: Beginning::default(),
            guessed_rate: None,
            pose_faults: Vec::new(),
            logs,
        };
        drive.date(None);
        drive
    }

    /// This drive of a vehicle: with its constraints, and the constants that are estimated for them (mounting, place of the axle).
    ///
    /// ```
    /// # use undrift_drive as undrift;
    /// use undrift::{Drive, nav::parameters::Parameter, vehicle::Profile};
    /// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
    /// # let log = simulate(&Trajectory::car(5.0, 1), 50.0, None, &GnssNoise::default(), 1)?;
    /// let car = Drive::from_samples(&log.imu, &log.gnss).with_vehicle(Profile::Car);
    /// assert!(car.constraints.non_holonomic.is_some() && car.parameters.prior(Parameter::Mounting).is_some());
    /// # Ok::<(), undrift_simulate::SimulationError>(())
    /// ```
    pub fn with_vehicle(mut self, profile: Profile) -> Self {
        let heading_baseline = self.constraints.heading_baseline;
        (self.constraints, self.parameters) = tables::vehicle_by_default(profile, self.parameters);
        self.constraints.heading_baseline = heading_baseline;
        self
    }

    /// This drive with the antenna at a known place, `lever_arm` from the IMU, body axes \[m\]: to 0.05 m each way, as with a tape.
    pub fn with_lever_arm(mut self, lever_arm: Vector3) -> Self {
        self.lever_arm = lever_arm;
        self.parameters = tables::with_given_lever_arm(self.parameters);
        self
    }

    /// This drive with a reference solution in memory, in order of time, to compare with.
    pub fn with_truth(mut self, truth: &[TruthSample]) -> Self {
        let path = self.hold(TRUTH, Memory::Truth(truth.into()));
        self.truth = Some((path, TruthSource::Samples { time_offset: 0.0 }));
        self
    }

    /// This drive with the measurements of a sensor of one number in memory, in SI units and in order of time, and the
    /// constants that such a sensor asks for where no more is known of it (such as the scale factor of a wheel).
    pub fn with_scalars(mut self, log: ScalarLog, measured: &[Scalar]) -> Self {
        let path = self.hold(
            &format!("<{}>", log.name()),
            Memory::Scalars(measured.into()),
        );
        let about = about(log);
        self.scalars[log] = Some((path, ScalarFormat::scalars(log.name(), about.range)));
        self.parameters = (about.by_default)(self.parameters);
        self
    }

    pub(super) fn hold(&mut self, name: &str, memory: Memory) -> PathBuf {
        let path = Path::new(name).to_path_buf();
        self.logs.memory.insert(path.clone(), memory);
        path
    }
}
