//! What cannot be right of samples and fixes, as findings.

use super::Finding;
use undrift_events::Implausible;

impl From<Implausible> for Finding {
    fn from(what: Implausible) -> Self {
        match what {
            Implausible::Gravity { ratio, exchanged } => Self::WrongGravity { ratio, exchanged },
            Implausible::Down(down) => Self::NotDown { down },
            Implausible::TurnScale(ratio) => Self::WrongTurnRate { ratio },
            Implausible::TurnAxis(axis) => Self::WrongTurnAxis { axis },
            Implausible::NoTurn => Self::NoTurns,
            Implausible::Late(delay) => Self::Late { delay },
            Implausible::Push { forward, right } => Self::WrongAxes {
                forward,
                right,
                axes: None,
            },
            Implausible::Velocity(mend) => Self::WrongVelocity { mend },
            Implausible::Alternates(distance) => Self::TwoReceivers { distance },
            Implausible::Changed(change) => Self::SensorChanged(change),
            Implausible::VelocityScale(ratio) => Self::VelocityScale { ratio },
        }
    }
}
