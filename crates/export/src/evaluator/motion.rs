//! Terms of the equation of motion at a coordinate, accelerations, reactions, energies and steps.

use super::Status;
use super::pieces::{Found, Functions, Pieces, Range};
use crate::machine::{LoadEffect, MachineDescription, PartKind};
use crate::part::{Part, Precision, Wrapping};
use crate::real::Real;
use crate::straight_line::StraightLine;

/// What the equation of motion needs at a coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionTerms<R> {
    /// m of the bodies.
    pub m: R,
    /// ½m′ of the bodies.
    pub half_dm: R,
    /// w of each load.
    pub w: Vec<R>,
    /// The derivative of w of each motor with a rotor; zero of other loads.
    pub dw: Vec<R>,
    /// The potential of one unit of each conservative load; zero of others.
    pub v: Vec<R>,
}

/// What the reactions need at a coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct ReactionTerms<R> {
    /// By reaction.
    pub a: Vec<R>,
    /// By reaction.
    pub b: Vec<R>,
    /// By load, then by reaction.
    pub c: Vec<R>,
}

/// A state of a motion: what the step needs.
#[derive(Debug, Clone, PartialEq)]
pub struct State<R> {
    /// q within the domain, q̇, then the currents of motors with inductance.
    pub y: Vec<R>,
    /// What the sums in `y` have lost by rounding so far.
    pub carry: Vec<R>,
    /// Whole periods that were subtracted from q.
    pub periods: i32,
}

/// The values of the parameters and inputs of the scene.
#[derive(Debug, Clone)]
struct Load<R> {
    effect: LoadEffect,
    /// By the conservative loads the curve, by the others the column of the motion's part.
    place: usize,
    value: R,
    /// Of a motor: N k, R, L, N² J.
    motor: [R; 4],
    /// The place of its current in the state.
    current: Option<usize>,
}

/// The exported code, in one kind of number, with the parameters and inputs of the scene.
#[derive(Debug, Clone)]
pub struct Evaluator<R> {
    range: Range<R>,
    wrapping: Option<[R; 2]>,
    parts: [Functions<R>; 3],
    reactions: usize,
    points: usize,
    loads: Vec<Load<R>>,
    order: usize,
}

impl<R: Real> Evaluator<R> {
    /// Of a machine and its fitted parts, in the order of [`PartKind::ALL`].
    pub fn new(machine: &MachineDescription, parts: &[Part; 3], precision: Precision) -> Self {
        let cells = |k: usize| Functions::Cells(Pieces::new(&parts[k], machine.domain));
        Self::of_functions(machine, [0, 1, 2].map(cells), precision)
    }

    /// Of a machine and the operations of its functions, as [`Export::exact`](crate::Export::exact) takes them.
    pub fn exact(
        machine: &MachineDescription,
        code: &[StraightLine; 3],
        precision: Precision,
    ) -> Self {
        let code = |kind: PartKind| Functions::Code {
            code: code[kind as usize].clone(),
            curves: machine.curves(kind).len(),
            columns: machine.columns(kind).len(),
        };
        Self::of_functions(machine, PartKind::ALL.map(code), precision)
    }

    fn of_functions(
        machine: &MachineDescription,
        parts: [Functions<R>; 3],
        precision: Precision,
    ) -> Self {
        let (mut curves, mut columns, mut order) = (1, 0, 2);
        let loads = machine.loads.iter().map(|load| {
            let counter = match load.effect.is_conservative() {
                true => &mut curves,
                false => &mut columns,
            };
            let place = *counter;
            *counter += 1;
            let motor = load.effect.motor();
            let current = motor.is_some_and(|motor| motor.inductance > 0.0);
            let motor = motor.map_or([R::of(0.0); 4], |m| {
                let [ratio, torque] = [m.gear_ratio, m.torque_constant].map(R::of);
                let reflected = ratio * ratio * R::of(m.rotor_inertia);
                [
                    ratio * torque,
                    R::of(m.resistance),
                    R::of(m.inductance),
                    reflected,
                ]
            });
            order += usize::from(current);
            Load {
                effect: load.effect,
                place,
                value: R::of(scene_value(&load.effect)),
                motor,
                current: current.then_some(order - 1),
            }
        });
        let loads = loads.collect();
        let wrapping = Wrapping::new(machine.domain, precision);
        Self {
            range: Range::new(machine.domain, precision),
            wrapping: wrapping.map(|w| [R::of(w.coarse), R::of(w.fine)]),
            parts,
            reactions: machine.reactions.len(),
            points: machine.points.len(),
            loads,
            order,
        }
    }

    fn at(&self, part: PartKind, q: R) -> Result<Found<'_, R>, Status> {
        let q = self.range.wrap(q)?;
        Ok(self.parts[part as usize].at(q))
    }

    /// m, ½m′, w and the potentials at `q` (rad or m).
    ///
    /// # Errors
    /// [`Status`] outside the domain.
    pub fn motion_terms(&self, q: R) -> Result<MotionTerms<R>, Status> {
        let found = self.at(PartKind::Motion, q)?;
        let [m, half_dm] = found.curve(0);
        let zeros = vec![R::of(0.0); self.loads.len()];
        let (w, dw, v) = (zeros.clone(), zeros.clone(), zeros);
        let mut terms = MotionTerms {
            m,
            half_dm,
            w,
            dw,
            v,
        };
        for (k, load) in self.loads.iter().enumerate() {
            if load.effect.is_conservative() {
                let [value, half_slope] = found.curve(load.place);
                terms.v[k] = value;
                terms.w[k] = R::of(-2.0) * half_slope;
            } else {
                terms.w[k] = found.column(load.place);
            }
            if has_rotor(&load.effect) {
                terms.dw[k] = found.slope(load.place);
            }
        }
        Ok(terms)
    }

    /// a, b and c at `q` (rad or m).
    ///
    /// # Errors
    /// [`Status`] outside the domain.
    pub fn reaction_terms(&self, q: R) -> Result<ReactionTerms<R>, Status> {
        let found = self.at(PartKind::Reactions, q)?;
        let n = self.reactions;
        let column = |k: usize| found.column(k);
        Ok(ReactionTerms {
            a: (0..n).map(column).collect(),
            b: (n..2 * n).map(column).collect(),
            c: (2 * n..2 * n + n * self.loads.len()).map(column).collect(),
        })
    }

    /// x and y of every point at `q` (rad or m), m.
    ///
    /// # Errors
    /// [`Status`] outside the domain.
    pub fn positions(&self, q: R) -> Result<Vec<R>, Status> {
        let found = self.at(PartKind::Positions, q)?;
        Ok((0..2 * self.points).map(|k| found.column(k)).collect())
    }

    /// F of each load, m and ½m′ with rotors, at a state.
    fn forces(&self, terms: &MotionTerms<R>, y: &[R]) -> (Vec<R>, [R; 2]) {
        let q_dot = y[1];
        let mut inertia = [terms.m, terms.half_dm];
        let mut forces = Vec::with_capacity(self.loads.len());
        for (k, load) in self.loads.iter().enumerate() {
            let (w, value) = (terms.w[k], load.value);
            forces.push(match &load.effect {
                LoadEffect::Conservative { .. }
                | LoadEffect::Constant { .. }
                | LoadEffect::Input { .. } => value,
                LoadEffect::Damper { .. } | LoadEffect::VariableDamper { .. } => {
                    R::of(0.0) - value * w * q_dot
                }
                LoadEffect::Motor(_) => {
                    let [constant, resistance, ..] = load.motor;
                    match load.current {
                        Some(place) => constant * y[place],
                        None => constant * (value - constant * w * q_dot) / resistance,
                    }
                }
            });
            if has_rotor(&load.effect) {
                let reflected = load.motor[3];
                inertia[0] = inertia[0] + reflected * w * w;
                inertia[1] = inertia[1] + reflected * w * terms.dw[k];
            }
        }
        (forces, inertia)
    }

    /// The rates of a state's `y`: q̇, q̈ and those of the currents.
    ///
    /// # Errors
    /// [`Status`] outside the domain, without inertia, or where the rates are not finite.
    pub fn rates(&self, y: &[R]) -> Result<Vec<R>, Status> {
        let terms = self.motion_terms(y[0])?;
        let (forces, [m, half_dm]) = self.forces(&terms, y);
        let mut force = R::of(0.0) - half_dm * y[1] * y[1];
        for (f, w) in forces.iter().zip(&terms.w) {
            force = force + *f * *w;
        }
        if m.partial_cmp(&R::of(0.0)) != Some(std::cmp::Ordering::Greater) {
            return Err(Status::NoInertia);
        }
        let mut rates = vec![R::of(0.0); self.order];
        rates[0] = y[1];
        rates[1] = force / m;
        for (k, load) in self.loads.iter().enumerate() {
            if let Some(place) = load.current {
                let [constant, resistance, inductance, _] = load.motor;
                let net = load.value - resistance * y[place] - constant * terms.w[k] * y[1];
                rates[place] = net / inductance;
            }
        }
        match rates.iter().all(|rate| rate.to_f64().is_finite()) {
            true => Ok(rates),
            false => Err(Status::NotFinite),
        }
    }

    /// Every reaction at a state with an acceleration (rad/s² or m/s²), N or N m.
    ///
    /// # Errors
    /// [`Status`] outside the domain.
    pub fn reactions(&self, y: &[R], q_ddot: R) -> Result<Vec<R>, Status> {
        let terms = self.motion_terms(y[0])?;
        let speed2 = y[1] * y[1];
        let (mut forces, _) = self.forces(&terms, y);
        for (k, load) in self.loads.iter().enumerate() {
            if has_rotor(&load.effect) {
                let s_ddot = terms.w[k] * q_ddot + terms.dw[k] * speed2;
                forces[k] = forces[k] - load.motor[3] * s_ddot;
            }
        }
        let of = self.reaction_terms(y[0])?;
        let n = self.reactions;
        let reaction = |k: usize| {
            let inertial = of.a[k] * q_ddot + of.b[k] * speed2;
            let loads = forces.iter().enumerate();
            loads.fold(inertial, |sum, (l, f)| sum + of.c[l * n + k] * *f)
        };
        Ok((0..n).map(reaction).collect())
    }

    /// Kinetic and potential energy at a state, J.
    ///
    /// # Errors
    /// [`Status`] outside the domain.
    pub fn energies(&self, y: &[R]) -> Result<[R; 2], Status> {
        let terms = self.motion_terms(y[0])?;
        let (_, [m, _]) = self.forces(&terms, y);
        let mut potential = R::of(0.0);
        for (load, v) in self.loads.iter().zip(&terms.v) {
            if load.effect.is_conservative() {
                potential = potential + load.value * *v;
            }
        }
        Ok([R::of(0.5) * m * y[1] * y[1], potential])
    }

    /// The force on the coordinate that gives an acceleration against all loads, N m or N.
    ///
    /// # Errors
    /// [`Status`] outside the domain.
    pub fn required_force(&self, y: &[R], q_ddot: R) -> Result<R, Status> {
        let terms = self.motion_terms(y[0])?;
        let (forces, [m, half_dm]) = self.forces(&terms, y);
        let inertial = m * q_ddot + half_dm * y[1] * y[1];
        let both = forces.iter().zip(&terms.w);
        Ok(both.fold(inertial, |sum, (f, w)| sum - *f * *w))
    }

    /// A state at rest or in motion.
    pub fn state(&self, [q, q_dot]: [f64; 2]) -> State<R> {
        let mut y = vec![R::of(0.0); self.order];
        [y[0], y[1]] = [R::of(q), R::of(q_dot)];
        State {
            carry: vec![R::of(0.0); self.order],
            y,
            periods: 0,
        }
    }

    /// One step of the classical Runge–Kutta method of fourth order, s.
    ///
    /// # Errors
    /// [`Status`] where a stage has no rates; the state is then as it was.
    pub fn step(&self, h: R, state: &mut State<R>) -> Result<(), Status> {
        let half = R::of(0.5) * h;
        let moved = |by: R, rates: &[R]| -> Vec<R> {
            let both = state.y.iter().zip(rates);
            both.map(|(y, rate)| *y + by * *rate).collect()
        };
        let one = self.rates(&state.y)?;
        let two = self.rates(&moved(half, &one))?;
        let three = self.rates(&moved(half, &two))?;
        let four = self.rates(&moved(h, &three))?;
        let sixth = h / R::of(6.0);
        let mut next = state.clone();
        for i in 0..self.order {
            let sum = one[i] + R::of(2.0) * (two[i] + three[i]) + four[i];
            let change = sixth * sum - state.carry[i];
            next.y[i] = state.y[i] + change;
            next.carry[i] = (next.y[i] - state.y[i]) - change;
        }
        self.subtract_period(&mut next);
        if self.wrapping.is_none() {
            self.range.wrap(next.y[0])?;
        }
        *state = next;
        Ok(())
    }

    /// Subtracts a whole period where q has left the domain.
    fn subtract_period(&self, state: &mut State<R>) {
        let Some([coarse, fine]) = self.wrapping else {
            return;
        };
        let (zero, period) = (R::of(0.0), coarse + fine);
        let (q, mut carry) = (state.y[0], state.carry[0]);
        let next = if q >= period {
            state.periods += 1;
            carry = carry + fine;
            q - coarse
        } else if q < zero {
            state.periods -= 1;
            let next = q + coarse;
            carry = (carry - fine) + ((next - coarse) - q);
            next
        } else {
            return;
        };
        // The rest of the period is too much for a carry: the next step begins at q itself.
        let settled = next - carry;
        state.carry[0] = (settled - next) + carry;
        state.y[0] = settled;
    }
}

/// Whether a load has a rotor whose inertia counts.
pub(crate) fn has_rotor(effect: &LoadEffect) -> bool {
    effect
        .motor()
        .is_some_and(|motor| motor.rotor_inertia != 0.0)
}

/// The value of a load's parameter or input in the scene.
pub(crate) fn scene_value(effect: &LoadEffect) -> f64 {
    match effect {
        LoadEffect::Conservative { magnitude } | LoadEffect::Constant { magnitude } => *magnitude,
        LoadEffect::Damper { damping } => *damping,
        LoadEffect::VariableDamper { initial } | LoadEffect::Input { initial } => *initial,
        LoadEffect::Motor(motor) => motor.initial_voltage,
    }
}
