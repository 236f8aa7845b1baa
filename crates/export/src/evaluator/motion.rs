//! Terms of the equation of motion at a coordinate, accelerations, reactions, energies and steps.

use super::pieces::{Functions, Pieces, Range};
use super::{Load, Status, runge_kutta};
use crate::machine::{MachineDescription, PartKind};
use crate::part::{Part, Precision, Wrapping};
use dwell_numerics::Real;
use dwell_numerics::StraightLine;

/// The terms of the equation of motion at a coordinate.
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
    /// The potential of one unit of each conservative load; zero for others.
    pub v: Vec<R>,
}

/// The terms of the reactions at a coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct ReactionTerms<R> {
    /// By reaction.
    pub a: Vec<R>,
    /// By reaction.
    pub b: Vec<R>,
    /// By load, then by reaction.
    pub c: Vec<R>,
}

/// A state of a motion, with the data of the step.
#[derive(Debug, Clone, PartialEq)]
pub struct State<R> {
    /// q within the domain, q̇, then the currents of motors with inductance.
    pub y: Vec<R>,
    /// The accumulated rounding errors of the sums in `y`.
    pub carry: Vec<R>,
    /// Whole periods that were subtracted from q.
    pub periods: i32,
}

/// The exported code, in one kind of number, with the parameters and inputs of the scene.
#[derive(Debug, Clone)]
pub struct Evaluator<R> {
    range: Range<R>,
    wrapping: Option<[R; 2]>,
    parts: [Functions<R>; 3],
    reactions: usize,
    /// The number of values of curves in the part of motion, and the number of columns after them.
    motion_values: [usize; 2],
    /// By load: the load, and the index of its curve or column.
    loads: Vec<(Load<R>, usize)>,
    order: usize,
}

impl<R: Real> Evaluator<R> {
    /// The evaluator of a machine and its fitted parts, in the order of [`PartKind::ALL`].
    pub fn new(machine: &MachineDescription, parts: &[Part; 3], precision: Precision) -> Self {
        let cells = |part, slopes| Functions::Cells(Pieces::new(part, machine.domain, slopes));
        let [motion, reactions, positions] = parts;
        let parts = [
            cells(motion, machine.rotor_columns()),
            cells(reactions, Vec::new()),
            cells(positions, Vec::new()),
        ];
        Self::of_functions(machine, parts, precision)
    }

    /// The evaluator of a machine and the operations of its functions, as in [`Export::exact`](crate::Export::exact).
    pub fn exact(
        machine: &MachineDescription,
        code: &[StraightLine; 3],
        precision: Precision,
    ) -> Self {
        Self::of_functions(machine, code.clone().map(Functions::Code), precision)
    }

    fn of_functions(
        machine: &MachineDescription,
        parts: [Functions<R>; 3],
        precision: Precision,
    ) -> Self {
        let (loads, order) = Load::all(&machine.loads, 1);
        let wrapping = Wrapping::new(machine.domain, precision);
        let kind = PartKind::Motion;
        Self {
            range: Range::new(machine.domain, precision),
            wrapping: wrapping.map(|w| [R::of(w.coarse), R::of(w.fine)]),
            parts,
            reactions: machine.reactions.len(),
            motion_values: [2 * machine.curves(kind).len(), machine.columns(kind).len()],
            loads: loads
                .into_iter()
                .zip((0..).map(|k| machine.place(k)))
                .collect(),
            order,
        }
    }

    fn at(&self, part: PartKind, q: R) -> Result<Vec<R>, Status> {
        let q = self.range.wrap(q)?;
        Ok(self.parts[part as usize].at(q))
    }

    /// m, ½m′, w and the potentials at `q` (rad or m).
    ///
    /// # Errors
    /// [`Status`] outside the domain.
    pub fn motion_terms(&self, q: R) -> Result<MotionTerms<R>, Status> {
        let values = self.at(PartKind::Motion, q)?;
        let [curves, columns] = self.motion_values;
        let zeros = vec![R::of(0.0); self.loads.len()];
        let mut terms = MotionTerms {
            m: values[0],
            half_dm: values[1],
            w: zeros.clone(),
            dw: zeros.clone(),
            v: zeros,
        };
        for (k, (load, place)) in self.loads.iter().enumerate() {
            if load.effect.is_conservative() {
                terms.v[k] = values[2 * place];
                terms.w[k] = R::of(-2.0) * values[2 * place + 1];
            } else {
                terms.w[k] = values[curves + place];
                terms.dw[k] = values[curves + columns + place];
            }
        }
        Ok(terms)
    }

    /// a, b and c at `q` (rad or m).
    ///
    /// # Errors
    /// [`Status`] outside the domain.
    pub fn reaction_terms(&self, q: R) -> Result<ReactionTerms<R>, Status> {
        let mut a = self.at(PartKind::Reactions, q)?;
        let mut b = a.split_off(self.reactions);
        let c = b.split_off(self.reactions);
        Ok(ReactionTerms { a, b, c })
    }

    /// x and y of every point at `q` (rad or m), m.
    ///
    /// # Errors
    /// [`Status`] outside the domain.
    pub fn positions(&self, q: R) -> Result<Vec<R>, Status> {
        self.at(PartKind::Positions, q)
    }

    /// F of each load, m and ½m′ with rotors, at a state.
    fn forces(&self, terms: &MotionTerms<R>, y: &[R]) -> (Vec<R>, [R; 2]) {
        let mut inertia = [terms.m, terms.half_dm];
        let mut forces = Vec::with_capacity(self.loads.len());
        for ((load, _), (w, dw)) in self.loads.iter().zip(terms.w.iter().zip(&terms.dw)) {
            forces.push(load.force(y, |factor| factor * *w * y[1]));
            if let Some(reflected) = load.rotor() {
                inertia[0] = inertia[0] + reflected * *w * *w;
                inertia[1] = inertia[1] + reflected * *w * *dw;
            }
        }
        (forces, inertia)
    }

    /// The rates of a state's `y`: q̇, q̈ and the rates of the currents.
    ///
    /// # Errors
    /// [`Status`] outside the domain, without inertia, or if the rates are not finite.
    pub fn rates(&self, y: &[R]) -> Result<Vec<R>, Status> {
        let terms = self.motion_terms(y[0])?;
        let (forces, [m, half_dm]) = self.forces(&terms, y);
        let mut force = R::of(0.0) - half_dm * y[1] * y[1];
        for (f, w) in forces.iter().zip(&terms.w) {
            force = force + *f * *w;
        }
        let has_inertia = m.to_f64() > 0.0;
        if !has_inertia {
            return Err(Status::NoInertia);
        }
        let mut rates = vec![R::of(0.0); self.order];
        rates[0] = y[1];
        rates[1] = force / m;
        for ((load, _), w) in self.loads.iter().zip(&terms.w) {
            if let Some((place, rate)) = load.current_rate(y, |factor| factor * *w * y[1]) {
                rates[place] = rate;
            }
        }
        if rates.iter().all(|rate| rate.to_f64().is_finite()) {
            return Ok(rates);
        }
        Err(Status::NotFinite)
    }

    /// Every reaction at a state with an acceleration (rad/s² or m/s²), N or N m.
    ///
    /// # Errors
    /// [`Status`] outside the domain.
    pub fn reactions(&self, y: &[R], q_ddot: R) -> Result<Vec<R>, Status> {
        let terms = self.motion_terms(y[0])?;
        let speed2 = y[1] * y[1];
        let (mut forces, _) = self.forces(&terms, y);
        for (k, (load, _)) in self.loads.iter().enumerate() {
            if let Some(reflected) = load.rotor() {
                let s_ddot = terms.w[k] * q_ddot + terms.dw[k] * speed2;
                forces[k] = forces[k] - reflected * s_ddot;
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
        let loads = self.loads.iter().map(|(load, _)| load).zip(&terms.v);
        Ok([R::of(0.5) * m * y[1] * y[1], Load::potential(loads)])
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
    /// [`Status`] if a stage has no rates; the state is then not changed.
    pub fn step(&self, h: R, state: &mut State<R>) -> Result<(), Status> {
        let changes = runge_kutta(&state.y, h, |y| self.rates(y))?;
        let mut next = state.clone();
        for (i, change) in changes.into_iter().enumerate() {
            let change = change - state.carry[i];
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
        let period = coarse + fine;
        let (q, mut carry) = (state.y[0], state.carry[0]);
        let next = if q.to_f64() >= period.to_f64() {
            state.periods += 1;
            carry = carry + fine;
            q - coarse
        } else if q.to_f64() < 0.0 {
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
