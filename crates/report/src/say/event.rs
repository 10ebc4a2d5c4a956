//! Sentences of what happens while the navigator runs.

use super::{fixes, sensors, solution, start};
use undrift_events::Event;

/// The sentence of an event; its time is said apart.
pub fn event(event: &Event) -> String {
    match event {
        Event::Started(_, alignment) => {
            format!("navigation begins: {}", start::alignment(alignment))
        }
        Event::SampleFault(fault) => {
            let axis = [
                "gyro x",
                "gyro y",
                "gyro z",
                "accelerometer x",
                "accelerometer y",
                "accelerometer z",
            ];
            let axis = axis.get(fault.axis).copied().unwrap_or("an axis");
            match fault.stuck {
                true => format!("{axis} repeats a value: it is taken as unknown"),
                false => format!("{axis} has a spike: the sample is replaced"),
            }
        }
        Event::Rejected(contradiction) => fixes::rejected(contradiction),
        Event::Doubted(doubt) => format!(
            "the solution accepts fixes that contradict it since {:.1} s: its covariance is inflated by {:.1} m, {:.2} m/s and {:.1} deg of tilt",
            doubt.start,
            doubt.position,
            doubt.velocity,
            doubt.tilt.to_degrees()
        ),
        Event::HeadingOff(off) => sensors::heading_off([off.start, off.end], off.angle, 0),
        Event::HeadingsRejected(headings) => sensors::rejected_headings(headings, 0),
        Event::FieldDisturbed(field) => sensors::disturbed_field(field),
        Event::Leant(lean) => fixes::one_sided(lean),
        Event::AlignsAgain(_, why) => {
            format!(
                "the solution ends and is aligned again: {}",
                solution::cause(*why)
            )
        }
        Event::FixErrors(_, errors) => {
            let of_velocity = errors.velocity_factor;
            format!(
                "from what the fixes show, their standard deviations count {:.2} (position) and {:.2}, {:.2}, {:.2} (velocity north, east, down) times",
                errors.position_factor, of_velocity.x, of_velocity.y, of_velocity.z
            )
        }
        Event::Mounting(_, mounting) => {
            format!("mounting found: {}", start::mounting(mounting))
        }
        Event::Resumed(_) => "another solution begins".into(),
        Event::Diverged(time) => solution::diverged(*time),
        Event::TooLate(_) => {
            "a measurement came later than the horizon and is not used: a longer --horizon takes it"
                .into()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_events::{RestartCause, SampleFault};

    #[test]
    fn an_event_says_what_happened_and_what_becomes_of_it() {
        let fault = SampleFault {
            axis: 4,
            start: 1.0,
            end: 1.5,
            stuck: true,
        };
        assert_eq!(
            event(&Event::SampleFault(fault)),
            "accelerometer y repeats a value: it is taken as unknown"
        );
        let again = event(&Event::AlignsAgain(3.0, RestartCause::NoSamples));
        assert!(
            again.starts_with("the solution ends and is aligned again: "),
            "{again}"
        );
        assert!(event(&Event::TooLate(1.0)).contains("--horizon"));
    }
}
