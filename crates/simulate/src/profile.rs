//! Smooth functions of time, exact with their derivatives and their integral.
//!
//! A [`Profile`] holds a value, and moves to the next one by polynomial pieces whose first three
//! derivatives are zero where they join a hold: three times continuously differentiable. A
//! [`Channel`] is a profile plus sinusoids that a gate fades in and out.

use std::f64::consts::TAU;

const DEGREE: usize = 7;

/// Shortest piece \[s\].
const SHORTEST: f64 = 1e-3;

/// S(u) = 35u⁴ − 84u⁵ + 70u⁶ − 20u⁷, the step from 0 to 1 with three zero derivatives at each end.
const STEP: [f64; DEGREE + 1] = [0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0];

/// Largest slope of S(u), at u = 1/2: a step of Δ in a time D is nowhere steeper than 2.1875 Δ/D.
pub(super) const STEP_SLOPE: f64 = 2.1875;

/// ∫(10u³ − 15u⁴ + 6u⁵) du: a slope that grows from 0 to 1, having risen by 1/2.
const BEND: [f64; DEGREE + 1] = [0.0, 0.0, 0.0, 0.0, 2.5, -3.0, 1.0, 0.0];

/// One polynomial piece `Σ c_k u^k`, `u = (t − start)/length` in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    start: f64,
    length: f64,
    coefficients: [f64; DEGREE + 1],
    /// Value at `u = 1`, held until the next piece.
    end_value: f64,
    /// Integral of the profile from time 0 to `start`.
    integral: f64,
}

/// A profile at one instant. "unit" is the unit of the profile.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProfileValue {
    /// The value \[unit\].
    pub value: f64,
    /// First derivative [unit/s].
    pub rate: f64,
    /// Second derivative [unit/s²].
    pub acceleration: f64,
    /// Integral from time 0 [unit·s].
    pub integral: f64,
}

/// A piecewise polynomial function of time \[s\], three times continuously differentiable.
///
/// ```
/// use undrift_simulate::profile::Profile;
/// let mut speed = Profile::hold(0.0);
/// speed.step_to(2.0, 4.0, 10.0); // from 0 at 2 s to 10 at 6 s
/// assert_eq!(speed.at(1.0).value, 0.0);
/// assert_eq!(speed.at(4.0).value, 5.0);
/// assert_eq!(speed.at(7.0).value, 10.0);
/// assert_eq!(speed.at(7.0).integral, 30.0);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Profile {
    initial: f64,
    pieces: Vec<Piece>,
}

impl Profile {
    /// The constant `value`.
    pub fn hold(value: f64) -> Self {
        Self {
            initial: value,
            pieces: Vec::new(),
        }
    }

    /// From the last value, a step of degree seven to `value` over `start … start + length` \[s\];
    /// its steepest slope is 2.1875 times the mean. Returns where it ends \[s\].
    ///
    /// A start before the end of what is already there is moved to that end, a length below 1 ms
    /// is made 1 ms, and a number that is not finite leaves the profile as it is.
    pub fn step_to(&mut self, start: f64, length: f64, value: f64) -> f64 {
        if !(start.is_finite() && length.is_finite() && value.is_finite()) {
            return self.end();
        }
        let start = start.max(self.end());
        let from = self.last_value();
        let mut coefficients = STEP.map(|c| c * (value - from));
        coefficients[0] = from;
        self.push(start, length.max(SHORTEST), coefficients, value)
    }

    /// From the last value to `value` at the constant slope `slope` [unit/s, its sign is ignored],
    /// the two corners rounded over `rounding` \[s\] each. Returns where it ends \[s\]: after
    /// `|Δ|/slope + rounding`, or twice the rounding where the change is too small to reach the slope.
    ///
    /// Starts, short lengths and odd numbers are treated as in [`Profile::step_to`]; a slope of zero
    /// never arrives, and leaves the profile as it is.
    pub fn ramp_to(&mut self, start: f64, slope: f64, rounding: f64, value: f64) -> f64 {
        let from = self.last_value();
        let change = value - from;
        let finite = [start, slope, rounding, change]
            .iter()
            .all(|x| x.is_finite());
        if !finite || slope == 0.0 || change == 0.0 {
            return self.end();
        }
        let start = start.max(self.end());
        let rounding = rounding.max(SHORTEST);
        let slope = slope.abs().min(change.abs() / rounding) * change.signum();
        let straight = change / slope - rounding;
        // Slope up, constant slope, slope down: the last is a line minus the first's curve.
        let bend = slope * rounding;
        let mut coefficients = BEND.map(|c| c * bend);
        coefficients[0] = from;
        let corner = from + bend / 2.0;
        let mut end = self.push(start, rounding, coefficients, corner);
        let second_corner = value - bend / 2.0;
        if straight > 1e-9 {
            let mut line = [0.0; DEGREE + 1];
            line[0] = corner;
            line[1] = second_corner - corner;
            end = self.push(end, straight, line, second_corner);
        }
        let mut coefficients = BEND.map(|c| -c * bend);
        coefficients[0] = self.last_value();
        coefficients[1] = value - bend / 2.0 - coefficients[0] + bend;
        self.push(end, rounding, coefficients, value)
    }

    /// Appends a piece that starts at or after the end of the last; returns its end \[s\].
    fn push(
        &mut self,
        start: f64,
        length: f64,
        coefficients: [f64; DEGREE + 1],
        end_value: f64,
    ) -> f64 {
        let integral = self.at(start).integral;
        self.pieces.push(Piece {
            start,
            length,
            coefficients,
            end_value,
            integral,
        });
        start + length
    }

    /// End of the last piece \[s\]; 0 for a constant.
    pub fn end(&self) -> f64 {
        self.pieces.last().map_or(0.0, |p| p.start + p.length)
    }

    /// Value after the last piece \[unit\].
    pub fn last_value(&self) -> f64 {
        self.pieces.last().map_or(self.initial, |p| p.end_value)
    }

    /// The times \[s\] where the third derivative may jump: ends of pieces, unsorted.
    pub fn knots(&self) -> impl Iterator<Item = f64> + '_ {
        self.pieces
            .iter()
            .flat_map(|p| [p.start, p.start + p.length])
    }

    /// Value, derivatives and integral at `time` \[s\].
    pub fn at(&self, time: f64) -> ProfileValue {
        let next = self.pieces.partition_point(|p| p.start <= time);
        let Some(piece) = next.checked_sub(1).and_then(|i| self.pieces.get(i)) else {
            return ProfileValue {
                value: self.initial,
                integral: self.initial * time,
                ..ProfileValue::default()
            };
        };
        let elapsed = time - piece.start;
        let u = (elapsed / piece.length).min(1.0);
        // Horner from the top: value, both derivatives and the antiderivative by u.
        let (mut value, mut first, mut second, mut integral) = (0.0, 0.0, 0.0, 0.0);
        for (k, c) in piece.coefficients.iter().enumerate().rev() {
            second = second * u + 2.0 * first;
            first = first * u + value;
            value = value * u + c;
            integral = integral * u + c / (k as f64 + 1.0);
        }
        integral = piece.integral + piece.length * u * integral;
        if elapsed >= piece.length {
            return ProfileValue {
                value: piece.end_value,
                integral: integral + piece.end_value * (elapsed - piece.length),
                ..ProfileValue::default()
            };
        }
        ProfileValue {
            value,
            rate: first / piece.length,
            acceleration: second / (piece.length * piece.length),
            integral,
        }
    }
}

/// A sinusoid `amplitude · sin(2π t/period + phase)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Amplitude [unit of the channel].
    pub amplitude: f64,
    /// Period \[s\].
    pub period: f64,
    /// Phase at time 0 \[rad\].
    pub phase: f64,
}

/// An angle as a function of time \[rad\]: a profile, plus waves that a gate fades in and out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Channel {
    /// The part that is there always \[rad\].
    pub profile: Profile,
    /// The part that is multiplied by the gate \[rad\].
    pub waves: Vec<Wave>,
}

impl Channel {
    /// A constant angle \[rad\] without waves.
    pub fn hold(angle: f64) -> Self {
        Self {
            profile: Profile::hold(angle),
            waves: Vec::new(),
        }
    }

    /// Angle \[rad\] and its rate [rad/s] at `time` \[s\], with the gate's value (0…1) and rate [1/s].
    pub fn at(&self, time: f64, gate: f64, gate_rate: f64) -> (f64, f64) {
        let base = self.profile.at(time);
        let (mut sum, mut sum_rate) = (0.0, 0.0);
        if gate != 0.0 || gate_rate != 0.0 {
            for wave in &self.waves {
                let omega = TAU / wave.period;
                let (s, c) = (omega * time + wave.phase).sin_cos();
                sum += wave.amplitude * s;
                sum_rate += wave.amplitude * omega * c;
            }
        }
        (
            base.value + gate * sum,
            base.rate + gate * sum_rate + gate_rate * sum,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive() -> Profile {
        let mut p = Profile::hold(1.0);
        p.step_to(2.0, 3.0, -2.0);
        p.ramp_to(6.0, 1.5, 1.0, 4.0); // reaches its slope
        p.ramp_to(12.0, 9.0, 1.0, 3.5); // does not
        p
    }

    #[test]
    fn derivatives_and_integral_belong_to_the_value() {
        let (p, h) = (drive(), 1e-4);
        for i in 0..1500 {
            let t = 0.005 + f64::from(i) * 0.01;
            let (a, b, c) = (p.at(t - h), p.at(t), p.at(t + h));
            // Truncation h²/6 times a third derivative below 60 Δ/D³ = 360: 6e-7; rounding 1e-12.
            assert!(
                ((c.value - a.value) / (2.0 * h) - b.rate).abs() < 6e-7,
                "{t}"
            );
            // The fourth derivative is below 840 Δ/D⁴ = 5040.
            assert!(
                ((c.rate - a.rate) / (2.0 * h) - b.acceleration).abs() < 9e-6,
                "{t}"
            );
            let slope = (c.integral - a.integral) / (2.0 * h);
            assert!((slope - b.value).abs() < 1e-6, "{t}");
        }
    }

    #[test]
    fn joins_are_smooth() {
        let (p, h) = (drive(), 1e-7);
        for knot in p.knots() {
            let (a, b) = (p.at(knot - h), p.at(knot + h));
            // Over 2e-7 s, times slope 1.5, curvature below 8, third derivative below 360.
            assert!((a.value - b.value).abs() < 1e-6, "{knot}");
            assert!((a.rate - b.rate).abs() < 2e-6, "{knot}");
            assert!((a.acceleration - b.acceleration).abs() < 8e-5, "{knot}");
        }
    }

    #[test]
    fn ramp_takes_the_time_it_says() {
        let mut p = Profile::hold(0.0);
        let end = p.ramp_to(10.0, 2.0, 1.5, 12.0);
        assert!((end - (10.0 + 6.0 + 1.5)).abs() < 1e-12);
        assert!((p.at(14.0).rate - 2.0).abs() < 1e-12);
        assert_eq!((p.at(end).value, p.last_value()), (12.0, 12.0));
        // Symmetric: the mean over the ramp is half the height.
        assert!((p.at(end).integral - 7.5 * 6.0).abs() < 1e-12);
    }

    #[test]
    fn odd_numbers_leave_it_alone() {
        let mut p = drive();
        let before = p.clone();
        p.step_to(f64::NAN, 1.0, 1.0);
        p.step_to(20.0, f64::NAN, 1.0);
        p.step_to(20.0, 1.0, f64::INFINITY);
        p.ramp_to(20.0, 0.0, 1.0, 9.0);
        p.ramp_to(20.0, f64::NAN, 1.0, 9.0);
        p.ramp_to(20.0, 1.0, f64::NAN, 9.0);
        p.ramp_to(20.0, 1.0, 1.0, f64::NAN);
        assert_eq!(p, before);
        // Late, and of no length: moved and stretched.
        assert_eq!(p.step_to(0.0, 0.0, 7.0), before.end() + SHORTEST);
    }
}
