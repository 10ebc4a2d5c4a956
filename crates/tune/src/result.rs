//! What was found as a result.

use super::{
    Tuned,
    axes::{MISALIGNMENT_DEG, SCALE_FACTOR},
    noise::{COUNT, FIX, LASTING, RULE, WALK, WHITE},
};
use std::path::Path;
use undrift_drive::drive::Drive;
use undrift_noise::model_file::AXES;
use undrift_results::{
    self, Number, SCHEMA, Tune, TunedAxes, TunedDrift, TunedNees, TunedParameter, TunedVibration,
    VERSION,
};

/// Key of a parameter in the model or drive file, and its unit; of white noise that `follows` the vibration or not, of drives by poses or
/// by fixes.
fn named(i: usize, follows: bool, posed: bool) -> (String, &'static str) {
    const REST: [(&str, &str); COUNT - FIX] = [
        ("gnss.std_factors.position", ""),
        ("gnss.std_factors.velocity", ""),
        ("gnss.std_factors.position_correlated", ""),
        ("gnss.std_factors.velocity_correlated", ""),
        ("vehicle.non_holonomic", "m/s"),
        ("vehicle.non_holonomic_down", "m/s"),
        ("vehicle.side_slip", "s"),
    ];
    let axis = |i: usize| AXES[i];
    match i {
        WHITE..WALK if follows => (format!("imu.vibration_factors.{}", axis(i)), ""),
        WHITE..WALK if i < 3 => (format!("{}.white_noise", axis(i)), "rad/s/√Hz"),
        WHITE..WALK => (format!("{}.white_noise", axis(i)), "m/s²/√Hz"),
        WALK..FIX if i - WALK < 3 => (format!("{}.random_walk", axis(i - WALK)), "rad/s/√s"),
        WALK..FIX => (format!("{}.random_walk", axis(i - WALK)), "m/s²/√s"),
        _ if posed && i < RULE => {
            let name = REST[i - FIX].0.replace("gnss", "poses");
            (name.replace("velocity", "attitude"), REST[i - FIX].1)
        }
        _ => (REST[i - FIX].0.to_owned(), REST[i - FIX].1),
    }
}

/// Normalised errors squared at the ends of outages of poses.
fn nees(judged: &super::Judged) -> Vec<TunedNees> {
    let of = |(group, of): (usize, &str)| {
        Some(TunedNees {
            of: of.to_owned(),
            before: judged.nees(0, group)?.map(Number),
            after: judged.nees(1, group)?.map(Number),
        })
    };
    let groups = ["position", "attitude"].into_iter().enumerate();
    groups.filter_map(of).collect()
}

const _: () = assert!(LASTING == FIX + 2 && RULE == FIX + 4 && COUNT == RULE + 3);

impl Tuned {
    /// The result; `drives` are the drive files.
    pub fn result<'a>(&self, drives: impl IntoIterator<Item = (&'a Path, &'a Drive)>) -> Tune {
        let z = self.fit.noise.ln();
        let at_rest = |i: usize| match i {
            WHITE..WALK if self.follows => Some(1.0),
            WHITE..WALK => Some(self.start.white[i - WHITE]),
            WALK..FIX => Some(self.start.walk[i - WALK]).filter(|walk| *walk > 0.0),
            FIX..RULE => Some(1.0),
            _ => Some(self.prior.centre[i].exp()),
        };
        let posed = self.posed;
        let parameter = |i: usize| {
            let (name, unit) = named(i, self.follows, posed);
            let (prior_low, prior_high) = self.prior.interval(i);
            let (low, high) = self.fit.interval[i];
            TunedParameter {
                name,
                unit: unit.into(),
                start: at_rest(i).into(),
                prior: self.prior.centre[i].exp().into(),
                prior_low: prior_low.exp().into(),
                prior_high: prior_high.exp().into(),
                value: z[i].exp().into(),
                low: low.exp().into(),
                high: high.exp().into(),
                determined: self.fit.determines(&self.prior, i),
            }
        };
        let drift = |judged: &super::Judged| {
            let [before, after] = judged.rms();
            let [ratio, low, high] = judged.ratio();
            TunedDrift {
                length_s: judged.length.into(),
                outages: judged.drift.len() as u64,
                before_m: before.into(),
                after_m: after.into(),
                ratio: ratio.into(),
                ratio_low: low.into(),
                ratio_high: high.into(),
                before_within: judged.within[0].map(Number),
                after_within: judged.within[1].map(Number),
                nees: match posed {
                    true => nees(judged),
                    false => Vec::new(),
                },
            }
        };
        let drives: Vec<_> = drives
            .into_iter()
            .map(|(file, drive)| drive.result(file))
            .collect();
        let unaligned = drives
            .iter()
            .zip(&self.aligns)
            .filter(|(_, aligns)| !**aligns);
        Tune {
            undrift: VERSION.into(),
            schema: SCHEMA,
            pose_faults: self.pose_faults.clone(),
            unaligned: unaligned
                .filter_map(|(drive, _)| drive.file.clone())
                .collect(),
            drives,
            start: self.start.name.clone(),
            guessed: self.start.guessed,
            unseen: self.unseen.into(),
            held_out: self.held_out,
            parameters: (0..COUNT)
                .filter(|i| self.prior.used[*i])
                .map(parameter)
                .collect(),
            drift: self.judged.iter().map(drift).collect(),
            axes: self.axes.map(|axes| TunedAxes {
                misalignment_rad: MISALIGNMENT_DEG.to_radians().into(),
                scale_factor: axes.scale_factors.then_some(Number(SCALE_FACTOR)),
                likelihood_gain: axes.gain.into(),
                kept: axes.kept,
            }),
            vibration: self.following.map(|following| TunedVibration {
                length_s: following.length.into(),
                ratio: following.ratio[0].into(),
                ratio_low: following.ratio[1].into(),
                ratio_high: following.ratio[2].into(),
                likelihood_gain: following.gain.into(),
                kept: following.kept,
            }),
            tuned: None,
            withheld: self.withheld[0],
            rejected: self.withheld[1],
            windows: self.fit.windows as u64,
            evaluations: self.fit.evaluations as u64,
            converged: self.fit.converged,
            stopped: self.stopped,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{fit::Fit, noise::Noise, prior::Prior, rest_noise::RestNoise};
    use super::*;
    use undrift_engine::settings::Settings;
    use undrift_nav::{covariance::AXES as COUNT_OF_AXES, shaping::ShapingFilter};

    /// Twice the centre of the prior, to a twentieth.
    fn tuned(follows: bool) -> Tuned {
        let model = undrift_noise::ImuModel::preset("mpu6050").unwrap();
        let start = RestNoise::from_model(&model, 0.01).unwrap();
        let settings = Settings::new([ShapingFilter::white(0.0, 0.01).unwrap(); COUNT_OF_AXES]);
        let prior = Prior::new(&start, &[&settings]);
        let twice = std::array::from_fn(|i| prior.centre[i] + 2f64.ln());
        Tuned {
            start,
            prior,
            fit: Fit {
                noise: Noise::new(&twice),
                interval: twice.map(|z: f64| (z - 0.098, z + 0.098)),
                likelihood: 0.0,
                windows: 120,
                evaluations: 45,
                converged: true,
            },
            follows,
            unseen: 0.3,
            held_out: true,
            judged: Vec::new(),
            axes: None,
            following: None,
            withheld: [600, 12],
            aligns: Vec::new(),
            posed: false,
            pose_faults: Vec::new(),
            stopped: false,
        }
    }

    #[test]
    fn parameters_have_their_intervals_of_ninety_five_percent() {
        let tuned = tuned(false);
        let result = tuned.result([]);
        let used: Vec<usize> = (0..COUNT).filter(|i| tuned.prior.used[*i]).collect();
        assert_eq!(result.parameters.len(), used.len());
        let near = |a: Number, b: f64| assert!((a.0 / b - 1.0).abs() < 1e-9, "{a:?} {b}");
        for (found, i) in result.parameters.iter().zip(used) {
            let (name, unit) = named(i, false, false);
            assert_eq!((&found.name, &*found.unit), (&name, unit));
            let centre = tuned.prior.centre[i].exp();
            near(found.prior, centre);
            near(
                found.prior_low,
                centre / (1.96 * tuned.prior.below[i]).exp(),
            );
            near(
                found.prior_high,
                centre * (1.96 * tuned.prior.above[i]).exp(),
            );
            near(found.value, 2.0 * centre);
            near(found.low, 2.0 * centre / 0.098f64.exp());
            near(found.high, 2.0 * centre * 0.098f64.exp());
            assert!(found.determined);
        }
        for axis in 0..AXES.len() {
            near(result.parameters[axis].start, tuned.start.white[axis]);
        }
        assert_eq!(
            (result.windows, result.evaluations, result.converged),
            (120, 45, true)
        );
        assert_eq!((result.withheld, result.rejected), (600, 12));
        assert_eq!(
            (result.unseen, result.held_out, result.stopped),
            (Number(0.3), true, false)
        );
    }

    #[test]
    fn factors_on_the_vibration_begin_at_one() {
        let result = tuned(true).result([]);
        for (found, axis) in result.parameters.iter().zip(AXES) {
            assert_eq!(found.name, format!("imu.vibration_factors.{axis}"));
            assert_eq!((&*found.unit, found.start), ("", Number(1.0)));
        }
        let constant = tuned(false).result([]);
        let units: Vec<(&str, &str)> = constant.parameters[..6]
            .iter()
            .map(|of| (&*of.name, &*of.unit))
            .collect();
        assert_eq!(units[2], ("gyro_z.white_noise", "rad/s/√Hz"));
        assert_eq!(units[3], ("accel_x.white_noise", "m/s²/√Hz"));
    }
}
