//! What the pulses act on: a wheel and a slider, whose motions are closed forms, and a pendulum, hanging and swinging.

use super::pulse::Pulse;
use crate::extremes::draws::Draws;

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
        let (joint, actuator, load) = match self.subject {
            PulseSubject::Slider => (
                "guide = { prismatic = [\"ground.O\", \"body.O\"], axis = [1, 0] }",
                "length = \"guide\"",
                "slide-force = \"guide\"",
            ),
            PulseSubject::Wheel | PulseSubject::Pendulum => (
                "O = { revolute = [\"ground.O\", \"body.O\"] }",
                "angle = [\"ground\", \"body\"]",
                "torque = \"body\"",
            ),
        };
        let (body, weight) = match self.subject {
            PulseSubject::Pendulum => (
                format!("mass = {INERTIA}\ncenter = [0, -1]\ninertia = 0"),
                "weight = { gravity = [0, -9.81] }",
            ),
            _ => (
                format!("mass = {INERTIA}\ncenter = [0, 0]\ninertia = {INERTIA}"),
                "",
            ),
        };
        let Self {
            speed,
            pulse: Pulse { span, .. },
            ..
        } = self;
        format!(
            "[bodies.ground]\npoints = {{ O = [0, 0] }}\n[bodies.body]\npoints = {{ O = [0, 0] }}\n{body}\n[joints]\n{joint}\n\
             [actuators]\nq = {{ {actuator} }}\n[loads]\n{weight}\npulse = {{ {load}, magnitude = \"{magnitude}\" }}\n\
             [requests]\nreactions = []\n[motion]\ninitial-coordinate = 0.0\ninitial-velocity = {speed}\nduration = {span}\n"
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
