//! What the pulses act on: a wheel and a slider, whose motions are closed forms, and a pendulum, hanging and swinging.

use super::pulse::Pulse;
use crate::draws::Draws;
use dwell_validation::extremes::mechanisms::{mass, rotor, slider};

/// The inertia of each, kg m² or kg.
pub(super) const INERTIA: f64 = 2.0;

/// A mechanism with its state at the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PulseSubject {
    /// A wheel on its axle.
    Wheel,
    /// A body on a straight guide.
    Slider,
    /// A pendulum.
    Pendulum,
}

impl PulseSubject {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wheel => "wheel",
            Self::Slider => "slider",
            Self::Pendulum => "pendulum",
        }
    }

    /// Whether it moves as the impulse says, whatever its position.
    pub(super) fn has_closed_form(self) -> bool {
        self != Self::Pendulum
    }

    fn spans(self) -> &'static [f64] {
        match self {
            Self::Wheel | Self::Slider => &[1.0, 30.0, 1000.0],
            // Some hundred oscillations.
            Self::Pendulum => &[1.0, 30.0],
        }
    }
}

/// A motion under a pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PulsedMotion {
    pub(super) subject: PulseSubject,
    /// The speed at the start, rad/s or m/s.
    pub(super) speed: f64,
    pub(super) pulse: Pulse,
}

impl PulsedMotion {
    /// Half of all motions begin at rest.
    pub(super) fn draw(draws: &mut Draws) -> Self {
        let all = [
            PulseSubject::Wheel,
            PulseSubject::Slider,
            PulseSubject::Pendulum,
        ];
        let subject = draws.choose(&all);
        let span = draws.choose(subject.spans());
        let speed = match draws.happens(0.5) {
            true => 0.0,
            false => draws.between(0.2, 2.0),
        };
        Self {
            subject,
            speed,
            pulse: Pulse::draw(draws, span),
        }
    }

    /// The scene under a magnitude of time.
    pub(super) fn scene(&self, magnitude: &str) -> String {
        let (mechanism, load, weight) = match self.subject {
            PulseSubject::Slider => (slider(INERTIA), "slide-force = \"guide\"", ""),
            PulseSubject::Wheel => {
                let wheel = rotor(&mass(INERTIA, [0.0; 2], INERTIA));
                (wheel, "torque = \"rotor\"", "")
            }
            PulseSubject::Pendulum => {
                let pendulum = rotor(&mass(INERTIA, [0.0, -1.0], 0.0));
                let weight = "weight = { gravity = [0, -9.81] }\n";
                (pendulum, "torque = \"rotor\"", weight)
            }
        };
        let (speed, span) = (self.speed, self.pulse.span);
        format!(
            "{mechanism}[loads]\n{weight}pulse = {{ {load}, magnitude = \"{magnitude}\" }}\n[requests]\nreactions = []\n\
             [motion]\ninitial-coordinate = 0.0\ninitial-velocity = {speed}\nduration = {span}\n"
        )
    }

    /// Coordinate and speed at the end, where they have a closed form.
    pub(super) fn closed_form(&self) -> Option<[f64; 2]> {
        let [area, at] = self.pulse.impulse();
        let (span, gained) = (self.pulse.span, area / INERTIA);
        let end = [
            self.speed * span + gained * (span - at),
            self.speed + gained,
        ];
        self.subject.has_closed_form().then_some(end)
    }
}
