//! The mounting found on the way. Body axes are the sensor's until it is known to be of use, and the vehicle's from then
//! on; what is known in the vehicle's axes waits until there are such.
//!
//! While it goes on the navigator runs in the sensor's axes at the antenna: the lever arm is zero, and what
//! ties the vehicle's axes to its motion (no slip, course as heading) is off. A mounting is taken once pitch
//! and yaw are known to 0.03 rad, to 0.015 rad where such constraints follow and nothing estimates the rest.
//!
//! Sequence: until a mounting is found, body axes are the sensor's and [`Search`] keeps heading,
//! constraints and lever arm away from the navigator; then [`Search::sample`] returns a [`Turned`]
//! once, the run turns ([`crate::run`]), and from there every sample is turned by
//! [`Search::in_body_axes`]. Later estimates correct the axes by the difference.
//!
//! How a mounting is estimated is in [`super`]; this module only decides when to ask and when to
//! believe. Yaw and pitch come from the direction of driving, roll from the mean vertical, which is
//! soon known: the limits are on the first two.

use super::{BLOCK, LONGEST_PASS, MIN_BLOCKS, Mounting, MountingError, MountingEstimator};
use crate::{
    align::{AlignSettings, Heading},
    checked::Checked,
    estimator::Estimator,
    settings::Settings,
    vehicle::Constraints,
};
use alloc::boxed::Box;
use undrift_nav::{Quaternion, Vector3, parameters::Parameter};

/// Standard deviation of pitch and yaw from which a mounting is of use \[rad\]: less than what a mounting stated by hand is
/// taken to be wrong by, 0.05.
const USEFUL: f64 = 0.03;
/// Standard deviation from which constraints may take a mounting for right, without a state for the rest \[rad\]: at 15 m/s what a car's
/// velocity to the right scatters by, 0.2 m/s.
const TRUSTED: f64 = 0.015;

/// Looks for the mounting.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Search {
    /// What holds in the vehicle's axes.
    ///
    /// Put back by [`Search::apply`].
    align: AlignSettings,
    constraints: Constraints,
    /// IMU → antenna, vehicle axes \[m\].
    lever_arm: Vector3,
    estimator: MountingEstimator,
    /// Start of the drive, and the last sample that the filter had \[s\].
    since: Option<f64>,
    last: Option<f64>,
    /// Driving at which it was looked at last, and from which it is next \[s\].
    seen: f64,
    next: f64,
    /// Standard deviation of pitch and yaw from which it is taken \[rad\].
    ///
    /// [`USEFUL`], or [`TRUSTED`] where constraints follow without a state for the rest.
    limit: f64,
    /// The last mounting that was taken.
    found: Option<Mounting>,
    /// Why none has been taken so far.
    failure: MountingError,
    /// No further look: the time is over, or constraints tie the axes to the motion.
    over: bool,
}

/// Axes that turn.
///
/// `turn` is q from the old to the new body axes: v_new = turn · v_old.
pub(crate) struct Turned {
    /// What they turn to.
    pub(crate) mounting: Mounting,
    /// Rotation from the axes so far to the new ones.
    pub(crate) turn: Quaternion,
    /// Whether those were the sensor's.
    pub(crate) first: bool,
}

impl Search {
    /// Where it is asked for; what the settings know of the vehicle's axes is kept until there are such. Not beside nodes
    /// or a log of the updates, whose states stay the same.
    ///
    /// `None` too where the settings do not ask for it; the settings are then unchanged.
    pub(crate) fn from_settings(settings: &mut Settings) -> Option<Box<Self>> {
        if !settings.find_mounting || settings.nodes.is_some() || settings.log.is_some() {
            return None;
        }
        let free = AlignSettings {
            heading: Heading::Auto,
            attitude: None,
            ..settings.align.clone()
        };
        let untied = Constraints {
            non_holonomic: None,
            course: None,
            air: None,
            ..settings.constraints.clone()
        };
        let mut search = Self {
            align: core::mem::replace(&mut settings.align, free),
            constraints: core::mem::replace(&mut settings.constraints, untied),
            lever_arm: core::mem::replace(&mut settings.lever_arm, Vector3::zeros()),
            estimator: MountingEstimator::default(),
            since: None,
            last: None,
            seen: 0.0,
            next: MIN_BLOCKS as f64 * BLOCK,
            limit: USEFUL,
            found: None,
            failure: MountingError::TooLittle { found: 0.0 },
            over: false,
        };
        if search.ties() && settings.parameters.prior(Parameter::Mounting).is_none() {
            search.limit = TRUSTED;
        }
        Some(Box::new(search))
    }

    /// Whether constraints tie heading and mounting together.
    fn ties(&self) -> bool {
        self.constraints.non_holonomic.is_some() || self.constraints.course.is_some()
    }

    /// The mounting that was taken last; until there is one, body axes are the sensor's.
    pub(crate) fn found(&self) -> Option<&Mounting> {
        self.found.as_ref()
    }

    /// Why the axes are the sensor's still.
    pub(crate) fn failure(&self) -> Option<MountingError> {
        self.found.is_none().then_some(self.failure)
    }

    /// A sample of the sensor in body axes.
    ///
    /// As it is until a mounting is found; what is in doubt of it turns, too.
    pub(crate) fn in_body_axes(&mut self, mut checked: Checked) -> Checked {
        self.since.get_or_insert(checked.sample.time);
        if let Some(mounting) = &self.found {
            let c = mounting.matrix();
            checked.sample.dtheta = c * checked.sample.dtheta;
            checked.sample.dvel = c * checked.sample.dvel;
            checked.doubt = checked
                .doubt
                .map(|doubt| doubt.map(|p| c * p * c.transpose()));
        }
        checked
    }

    /// A vector in the sensor's axes in body axes.
    pub(crate) fn turned(&self, vector: &Vector3) -> Vector3 {
        let found = self.found.as_ref();
        found.map_or(*vector, |mounting| mounting.matrix() * vector)
    }

    /// What the settings are in the vehicle's axes.
    pub(crate) fn apply(&self, settings: &mut Settings) {
        settings.align = self.align.clone();
        settings.constraints = self.constraints.clone();
        settings.lever_arm = self.lever_arm;
    }

    /// Looks at the filter at the end of a sample, with the antenna at `lever` \[m\]; whether and how the axes turn.
    ///
    /// `None` where they stay. A quarter of an hour after the first sample ([`LONGEST_PASS`]) the search ends
    /// and frees what it has gathered.
    pub(crate) fn sample(&mut self, filter: &dyn Estimator, lever: &Vector3) -> Option<Turned> {
        if self.over {
            return None;
        }
        let nav = filter.nav();
        if self
            .since
            .is_some_and(|since| nav.time > since + LONGEST_PASS)
        {
            self.end();
            return None;
        }
        let last = self.last.replace(nav.time)?;
        let std = filter.nav_std();
        let attitude_std = Vector3::new(std[6], std[7], std[8]);
        let q_vb = self
            .found
            .map_or(Quaternion::identity(), |found| found.q_vb);
        // The antenna's velocity before and after the lever arm is known: no jump.
        self.estimator.add(
            (nav.time - last).min(1.0),
            &(nav.q_nb * q_vb),
            &filter.antenna_velocity(lever),
            &(q_vb.inverse() * filter.omega_nb_b()),
            &attitude_std,
        );
        let mounting = self.look()?;
        let first = self.found.is_none();
        self.found = Some(mounting);
        // What a tied filter shows of the mounting is what it was given. The rest it estimates itself.
        if self.ties() {
            self.end();
        }
        Some(Turned {
            mounting,
            turn: mounting.q_vb * q_vb.inverse(),
            first,
        })
    }

    /// A first estimate as soon as it is of use, another one each time that the driving it rests on has doubled.
    ///
    /// Estimates of driving that has not doubled are correlated with the one before and not worth a
    /// turn of the axes; one of another kind, from straight driving, is.
    fn look(&mut self) -> Option<Mounting> {
        let driving = self.estimator.duration();
        if driving == self.seen {
            return None;
        }
        self.seen = driving;
        if let MountingError::TooLittle { found } = &mut self.failure {
            *found = driving;
        }
        let straight = self.estimator.is_straight();
        let better_kind = straight && self.found.is_some_and(|found| !found.straight);
        if driving < self.next && !better_kind {
            return None;
        }
        match self.estimator.estimate() {
            Ok(mounting) if self.found.is_some() || mounting.std.yz().max() < self.limit => {
                self.next = 2.0 * driving;
                Some(mounting)
            }
            Ok(mounting) => {
                let std = mounting.std.yz().max();
                self.failure = MountingError::Unsure { std };
                None
            }
            Err(failure) => {
                self.failure = failure;
                if self.found.is_some() {
                    self.next = 2.0 * driving;
                }
                None
            }
        }
    }

    /// Ends the search and frees what it has gathered.
    fn end(&mut self) {
        self.over = true;
        self.estimator = MountingEstimator::default();
    }
}

#[cfg(test)]
mod tests;
