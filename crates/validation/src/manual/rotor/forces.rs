//! The torques on a rotor, from the text of its scene.

use toml::{Table, Value};

/// A state: angle (rad), speed (rad/s), and the state of a drive.
pub(crate) type RotorState = [f64; 3];

pub(super) fn as_number(value: &Value) -> Option<f64> {
    value.as_float().or(value.as_integer().map(|i| i as f64))
}

/// The torques and the inertia.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RotorForces {
    /// Moment of inertia including the rotors of motors, kg m².
    pub(crate) inertia: f64,
    drives: Vec<RotorDrive>,
    /// Limits, stiffness and damping of a compliant stop.
    yielding: Option<([f64; 2], [f64; 2])>,
    /// Torque of dry friction in motion, and its limit at rest, N m.
    friction: [f64; 2],
    /// Torque of the weight when the centre of mass is level with the pin, N m.
    weight: f64,
}

#[derive(Debug, Clone, PartialEq)]
enum RotorDrive {
    Torque(RotorMagnitude),
    Motor {
        voltage: RotorMagnitude,
        constant: f64,
        resistance: f64,
        inductance: f64,
        ratio: f64,
    },
    Line {
        stall: f64,
        no_load: f64,
        ratio: f64,
    },
    Controller {
        speed: RotorMagnitude,
        gains: [f64; 2],
        limit: f64,
    },
}

/// A number, or a table over time.
#[derive(Debug, Clone, PartialEq)]
enum RotorMagnitude {
    Constant(f64),
    /// Straight lines between points.
    Table(Vec<[f64; 2]>),
}

impl RotorMagnitude {
    fn read(value: &Value) -> Option<Self> {
        if let Some(number) = as_number(value) {
            return Some(Self::Constant(number));
        }
        let rows = value.get("table")?.as_array()?;
        let row = |row: &Value| {
            let row = row.as_array()?;
            Some([as_number(row.first()?)?, as_number(row.get(1)?)?])
        };
        rows.iter().map(row).collect::<Option<_>>().map(Self::Table)
    }

    fn at(&self, t: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Table(rows) => {
                let next = rows.iter().position(|row| row[0] > t);
                let k = next.unwrap_or(rows.len() - 1).clamp(1, rows.len() - 1);
                let [[t0, y0], [t1, y1]] = [rows[k - 1], rows[k]];
                y0 + (y1 - y0) * (t - t0) / (t1 - t0)
            }
        }
    }
}

impl RotorDrive {
    /// A drive, and the inertia of its rotor on the angle, kg m².
    fn read(drive: &Value) -> Option<(Self, f64)> {
        let number = |key: &str| drive.get(key).and_then(as_number);
        let magnitude = |key: &str| drive.get(key).and_then(RotorMagnitude::read);
        if drive.get("applied-force").is_some() {
            return Some((Self::Torque(magnitude("magnitude")?), 0.0));
        }
        if drive.get("speed-controller").is_some() {
            let gains = [number("proportional")?, number("integral").unwrap_or(0.0)];
            let limit = number("limit").unwrap_or(f64::INFINITY);
            let speed = magnitude("speed")?;
            let controller = Self::Controller {
                speed,
                gains,
                limit,
            };
            return Some((controller, 0.0));
        }
        let ratio = number("gear-ratio").unwrap_or(1.0);
        let inertia = ratio * ratio * number("inertia").unwrap_or(0.0);
        let motor = match number("stall-torque") {
            Some(stall) => Self::Line {
                stall,
                no_load: number("no-load-speed")?,
                ratio,
            },
            None => Self::Motor {
                voltage: magnitude("voltage")?,
                constant: number("torque-constant")?,
                resistance: number("resistance")?,
                inductance: number("inductance").unwrap_or(0.0),
                ratio,
            },
        };
        Some((motor, inertia))
    }

    /// Torque on the angle, and the rate of the drive's own state.
    fn act(&self, t: f64, [_, speed, state]: RotorState) -> [f64; 2] {
        match self {
            Self::Torque(magnitude) => [magnitude.at(t), 0.0],
            Self::Line {
                stall,
                no_load,
                ratio,
            } => [ratio * stall * (1.0 - ratio * speed / no_load), 0.0],
            Self::Motor {
                voltage,
                constant,
                resistance,
                inductance,
                ratio,
            } => {
                let left = voltage.at(t) - constant * ratio * speed;
                match *inductance {
                    0.0 => [ratio * constant * left / resistance, 0.0],
                    inductance => [
                        ratio * constant * state,
                        (left - resistance * state) / inductance,
                    ],
                }
            }
            Self::Controller {
                speed: wanted,
                gains: [proportional, integral],
                limit,
            } => {
                let error = wanted.at(t) - speed;
                let free = proportional * error + integral * state;
                let is_over = free.abs() > *limit && error * free > 0.0;
                [
                    free.clamp(-limit, *limit),
                    if is_over { 0.0 } else { error },
                ]
            }
        }
    }
}

impl RotorForces {
    pub(super) fn read(
        root: &Table,
        inertia: f64,
        [mass, arm]: [f64; 2],
        stop: Option<(&Value, [f64; 2])>,
    ) -> Option<Self> {
        let section = |name: &str| {
            let table = root.get(name).and_then(Value::as_table);
            table.into_iter().flat_map(|all| all.values())
        };
        let drives: Option<Vec<_>> = section("drives").map(RotorDrive::read).collect();
        let (drives, rotors): (Vec<_>, Vec<f64>) = drives?.into_iter().unzip();
        let gravity = section("loads").find_map(|load| load.get("gravity")?.as_array());
        let weight = gravity.map_or(0.0, |g| {
            let g = g.iter().filter_map(as_number);
            g.map(|g| g * g).sum::<f64>().sqrt()
        });
        let friction = section("friction").next().map(|friction| {
            let of = |key: &str| friction.get(key).and_then(as_number);
            let dry = of("coefficient").unwrap_or(0.0);
            // On a guide the arm is one.
            let arm = of("radius").unwrap_or(1.0) * mass * weight;
            [dry * arm, of("static-coefficient").unwrap_or(dry) * arm]
        });
        let yielding = stop.and_then(|(stop, limits)| {
            let stiffness = as_number(stop.get("stiffness")?)?;
            let damping = stop.get("damping").and_then(as_number).unwrap_or(0.0);
            Some((limits, [stiffness, damping]))
        });
        Some(Self {
            inertia: inertia + rotors.iter().sum::<f64>(),
            drives,
            yielding,
            friction: friction.unwrap_or_default(),
            weight: mass * arm * weight,
        })
    }

    /// Torque without dry friction, N m, and the rate of the drive's state.
    fn torque(&self, t: f64, y: RotorState) -> [f64; 2] {
        let mut sum = [0.0, 0.0];
        for drive in &self.drives {
            let [torque, rate] = drive.act(t, y);
            sum = [sum[0] + torque, sum[1] + rate];
        }
        sum[0] -= self.weight * y[0].cos();
        if let Some(([low, high], [stiffness, damping])) = self.yielding {
            // The stop can only push.
            sum[0] += match y[0] {
                angle if angle > high => (-stiffness * (angle - high) - damping * y[1]).min(0.0),
                angle if angle < low => (-stiffness * (angle - low) - damping * y[1]).max(0.0),
                _ => 0.0,
            };
        }
        sum
    }

    /// The remaining torque of sticking friction, relative to its limit.
    pub(crate) fn rest_margin(&self, t: f64, y: RotorState) -> f64 {
        let [torque, _] = self.torque(t, y);
        1.0 - torque.abs() / self.friction[1]
    }

    /// Whether it is at rest and sticks.
    pub(super) fn holds(&self, t: f64, y: RotorState) -> bool {
        y[1] == 0.0 && self.friction[1] > 0.0 && self.rest_margin(t, y) >= 0.0
    }

    /// The rates of a state.
    pub(super) fn rates(&self, t: f64, y: RotorState) -> RotorState {
        let [torque, rate] = self.torque(t, y);
        let [moving, resting] = self.friction;
        let left = match y[1] {
            0.0 if torque.abs() <= resting => 0.0,
            0.0 => torque - moving.copysign(torque),
            speed => torque - moving.copysign(speed),
        };
        [y[1], left / self.inertia, rate]
    }

    /// Power of all torques, W, and the rate of the drive's state.
    pub(crate) fn power(&self, t: f64, y: RotorState) -> [f64; 2] {
        let [torque, rate] = self.torque(t, y);
        [torque * y[1] - self.friction[0] * y[1].abs(), rate]
    }

    /// A Runge–Kutta step of order 4.
    pub(super) fn step(&self, t: f64, y: RotorState, h: f64) -> RotorState {
        let moved = |k: RotorState, h: f64| [0, 1, 2].map(|i| y[i] + h * k[i]);
        let k1 = self.rates(t, y);
        let k2 = self.rates(t + 0.5 * h, moved(k1, 0.5 * h));
        let k3 = self.rates(t + 0.5 * h, moved(k2, 0.5 * h));
        let k4 = self.rates(t + h, moved(k3, h));
        [0, 1, 2].map(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
    }
}
