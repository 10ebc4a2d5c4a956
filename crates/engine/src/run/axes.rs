//! Body axes that turn from the sensor's to the vehicle's while the navigator runs.
//!
//! The first turn is from the sensor's axes to the vehicle's, later ones are corrections by some degrees.
//! State, covariance, past samples and watches turn; what was learned of single axes begins again, since it is
//! of other axes now.
//!
//! Conventions: `q_vb` turns the old body axes b to the new ones v, C = C_b^v; a vector goes to C
//! x, a covariance to C P Cᵀ, and the attitude `q_nb` to `q_nb q_vb⁻¹`, so that the navigation
//! frame does not move. Variances of axes that were taken for independent turn by the squares of C
//! ([`crate::vibration`], [`crate::rest`]).
//!
//! Which watches begin again: the course's, where axes turn for the first time, and the alignment
//! that is under way.

use super::Run;
use crate::{
    course::CourseWatch, mounting::Turned, observer::Observer, settings::Settings,
    solution::Solution,
};
use alloc::sync::Arc;
use nalgebra::DVector;
use undrift_nav::{Vector3, attitude::to_rpy, earth::wrap_pi, parameters::Parameter};

impl Run {
    /// Whether body axes are the vehicle's, as far as the settings promise.
    ///
    /// True where the settings give the mounting; false until it is found where they ask to find
    /// it.
    pub(super) fn has_vehicle_axes(&self) -> bool {
        self.search
            .as_ref()
            .is_none_or(|search| search.found().is_some())
    }

    /// How well it is known how the IMU sits, about the vehicle's axes \[rad\]: as it was found on the way, else as the settings say.
    pub(super) fn mounting_std(&self) -> Vector3 {
        let found = self.search.as_ref().and_then(|search| search.found());
        found.map_or(self.settings.mounting_std, |mounting| mounting.std)
    }

    /// Looks for the mounting at the end of a sample; where it is found, all that is in body axes turns.
    ///
    /// Each mounting that was found is noted with its time and reported to the observer.
    pub(super) fn look_for_mounting(&mut self, observer: &mut dyn Observer) {
        let (Some(search), Some(solution)) = (&mut self.search, &self.solution) else {
            return;
        };
        let time = solution.filter.nav().time;
        let Some(turned) = search.sample(&*solution.filter, &self.settings.lever_arm) else {
            return;
        };
        if turned.first {
            search.apply(Arc::make_mut(&mut self.settings));
        }
        self.turn(&turned);
        self.summary.mountings.push((time, turned.mounting));
        observer.mounted(&turned.mounting);
    }

    /// Looks whether the IMU nods in its mount: while it does the vehicle's attitude is as uncertain as that.
    pub(super) fn look_for_loose_mount(&mut self) {
        if !self.settings.gating
            || self.settings.constraints.air.is_some()
            || !self.has_vehicle_axes()
        {
            return;
        }
        let solution = self.solution.as_ref();
        let Some(nods) = solution.and_then(|solution| self.rocking.sample(&*solution.filter))
        else {
            return;
        };
        let known = self.mounting_std();
        if let Some(Solution { filter, .. }) = &mut self.solution {
            filter.set_mounting_std(&known);
            filter.loosen(nods);
        }
    }

    /// Turns all that is in body axes by `turned`: samples, watches, vehicle, solution.
    ///
    /// A state of the mounting is set back to its prior, at least as wide as the new estimate is
    /// uncertain.
    fn turn(&mut self, turned: &Turned) {
        let c = turned.turn.to_rotation_matrix().into_inner();
        if let Some(previous) = &mut self.log.previous {
            previous.dtheta = c * previous.dtheta;
            previous.dvel = c * previous.dvel;
        }
        self.plausible.turn(&c, &self.settings);
        self.vehicle.turn(&c);
        if let Some(vibration) = &mut self.vibration {
            vibration.turn(&c);
        }
        if let Some(solution) = &mut self.solution {
            let filter = &mut *solution.filter;
            let heading = to_rpy(&filter.nav().q_nb).z;
            filter.turn(&turned.turn);
            filter.set_mounting_std(&turned.mounting.std);
            match turned.first {
                true => self.course = CourseWatch::new(),
                false => {
                    let now = to_rpy(&filter.nav().q_nb).z;
                    self.course.turn(wrap_pi(now - heading));
                }
            }
            if let Some(vibration) = &self.vibration {
                filter.set_white_noise(&vibration.variances());
            }
            if let Some(prior) = filter.parameters().prior(Parameter::Mounting) {
                let std = turned.mounting.std.yz().max().max(prior.std);
                filter.renew(Parameter::Mounting, std);
            }
            // What was found of the antennas was in other axes than those in which they are stated.
            if let Some(prior) = filter.parameters().prior(Parameter::HeadingOffset) {
                filter.renew(Parameter::HeadingOffset, prior.std);
            }
            if turned.first {
                from_antenna(filter, &self.settings);
            }
        }
        if self.aligns() {
            self.alignment.aligner = self.second_aligner();
        }
    }
}

/// A solution that was the antenna's becomes the sensor's.
///
/// While the mounting was unknown the lever arm was taken for zero: position and velocity were the antenna's.
/// They move by the lever arm in the attitude found, and by what it swings.
///
/// The lever arm l is in the new body axes \[m\]: p_imu = p_antenna − q_nb l, v_imu = v_antenna − ω
/// × l; a state of the lever arm is made unknown again, since nothing was learned of it.
fn from_antenna(filter: &mut dyn crate::estimator::Estimator, settings: &Settings) {
    let lever = settings.lever_arm;
    if lever == Vector3::zeros() {
        return;
    }
    if let Some(prior) = filter.parameters().prior(Parameter::LeverArm) {
        filter.renew(Parameter::LeverArm, prior.std);
    }
    let nav = *filter.nav();
    let mut error = DVector::zeros(filter.states());
    let away = nav.q_nb * lever;
    let faster = filter.antenna_velocity(&lever) - nav.v_n;
    error.rows_mut(0, 3).copy_from(&away);
    error.rows_mut(3, 3).copy_from(&faster);
    filter.apply_correction(error.as_slice());
}
