//! The scene of a case with what the commands need: a prescribed motion, and a free one.

use super::super::claims::SpaceClaims;
use crate::written::poses::scene_text::{text_of, value_of};
use crate::written::poses::units::Units;
use dwell_kinetostatics::MachineModel as _;
use dwell_scene::{MotionDuration, SpaceScene};
use std::f64::consts::TAU;
use toml::{Table, Value};

/// Amplitudes of a prescribed motion that the scene does not give, rad or parts of the size, and its period, s.
const AMPLITUDES: [f64; 4] = [0.25, 0.2, 0.15, 0.1];
pub(super) const PERIOD: f64 = 1.0;
/// Speed of a free motion that the scene does not give, rad/s or sizes/s, and how long it lasts, s.
const SPEED: f64 = 1.5;
const DURATION: f64 = 0.3;
/// Rows of a free motion, and the longest time that is looked at, s.
pub(super) const ROWS: usize = 150;
const MAX_DURATION: f64 = 1.0;

/// Texts of scenes.
pub(super) struct Scenes {
    /// With a prescribed motion.
    pub(super) forced: String,
    /// The amplitudes of its sinusoids by actuator, rad or m, if it has sinusoids.
    pub(super) amplitudes: Option<Vec<f64>>,
    /// With a free motion, and the interval of its rows, s.
    pub(super) free: Option<(String, String)>,
    /// As it is, but for its requests.
    pub(super) plain: String,
}

impl Scenes {
    pub(super) fn new(scene: &SpaceScene, claims: &SpaceClaims<'_>) -> Self {
        let text = scene.source.inner();
        let mut table: Table = text.parse().unwrap_or_default();
        table.remove("requests");
        let plain = text_of(&table).unwrap_or_default();
        let units = Units::read(&table).unwrap_or(Units {
            length: 1.0,
            mass: 1.0,
            inertia: 1.0,
            angle: 1.0,
        });
        let in_units = |k: usize, part: f64| match claims.model().is_angle(k) {
            true => (part, part / units.angle),
            false => {
                let length = part * claims.case().size;
                (length, length / units.length)
            }
        };
        let has_forced = scene.prescribed.is_some() || scene.sweep.is_some();
        let mut forced = table.clone();
        let mut amplitudes = Vec::new();
        if !has_forced {
            let mut prescribed = vec![("duration", PERIOD.into())];
            for (k, actuator) in scene.mechanism.actuators.iter().enumerate() {
                let (amplitude, written) = in_units(k, AMPLITUDES[k % AMPLITUDES.len()]);
                amplitudes.push(amplitude);
                let sinusoid = [("amplitude", written.into()), ("period", PERIOD.into())];
                let law = value_of([("sinusoid", value_of(sinusoid))]);
                prescribed.push((&actuator.name, law));
            }
            forced.insert("prescribed".to_owned(), value_of(prescribed));
        }
        Self {
            forced: text_of(&forced).unwrap_or_default(),
            amplitudes: (!has_forced).then_some(amplitudes),
            free: free(scene, table, in_units(0, SPEED).1),
            plain,
        }
    }
}

/// The scene with a free motion, and the interval of its rows, s.
fn free(scene: &SpaceScene, mut table: Table, speed: f64) -> Option<(String, String)> {
    let duration = match &scene.motion {
        Some(motion) => match motion.duration {
            MotionDuration::Seconds(seconds) => seconds.min(MAX_DURATION),
            MotionDuration::Periods(_) => DURATION,
        },
        None if scene.mechanism.actuators.len() == 1 => DURATION,
        None => return None,
    };
    let motion = table.entry("motion").or_insert(Value::Table(Table::new()));
    let motion = motion.as_table_mut()?;
    motion.remove("periods");
    motion.insert("duration".to_owned(), Value::Float(duration));
    if scene.motion.is_none() {
        motion.insert("initial-velocity".to_owned(), Value::Float(speed));
    }
    let interval = format!("{:e}", duration / ROWS as f64);
    Some((text_of(&table).ok()?, interval))
}

/// What a sinusoid from its start gives at a time: value, velocity, acceleration.
pub(super) fn sinusoid(amplitude: f64, t: f64) -> [f64; 3] {
    let w = TAU / PERIOD;
    let (sin, cos) = (w * t).sin_cos();
    [
        amplitude * sin,
        amplitude * w * cos,
        -amplitude * w * w * sin,
    ]
}
