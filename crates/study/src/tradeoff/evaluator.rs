//! Ways to evaluate the equation of motion and the reactions, of which any can be tried.

use super::combination::Evaluation;
use dwell_dynamics::{
    DynamicsError, Equation, Machine, MachineWork, Moving, Orbit, Point, State, System, Tabled,
};
use dwell_geometry::{PlaceError, Range};
use dwell_kinetostatics::{
    Coefficients, Exact, ExactWork, Inertia, Model, Reduced, Table, Workspace,
};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Finds the reactions at a state, N or N·m.
pub type Reactions<'e> = Box<dyn FnMut(&Point, &mut [f64]) -> Result<(), DynamicsError> + 'e>;

/// A way to evaluate. What is new (another kind of table, another number) is tried by making it one.
pub trait Evaluator {
    /// What it is called.
    fn evaluation(&self) -> Evaluation;

    /// The equation of motion with its working memory.
    ///
    /// # Errors
    /// [`DynamicsError`] where the start cannot be evaluated.
    fn system(&self) -> Result<Box<dyn System + '_>, DynamicsError>;

    /// The reactions, in its own arithmetic, with the working memory for them.
    fn reactions(&self) -> Reactions<'_>;

    /// The evaluations that one Jacobian is weighed as: a dual number is two.
    fn jacobian(&self) -> usize;

    /// How long it took to make it, s.
    fn making(&self) -> f64 {
        0.0
    }

    /// The motion by quadrature with the evaluations it took; none where it is not known by its energy.
    fn orbit(&self, start: State) -> Option<(Orbit, usize)>;
}

/// A reduced model of one freedom without loads.
#[derive(Debug)]
pub struct ByModel<R: Reduced> {
    /// The model, with the reactions that are compared.
    pub model: R,
    /// What it is called.
    pub evaluation: Evaluation,
    /// How long it took to make it, s.
    pub making: f64,
}

impl<R: Reduced> Evaluator for ByModel<R> {
    fn evaluation(&self) -> Evaluation {
        self.evaluation
    }

    fn system(&self) -> Result<Box<dyn System + '_>, DynamicsError> {
        Ok(Box::new(Equation::new(&self.model)))
    }

    fn reactions(&self) -> Reactions<'_> {
        let mut work = self.model.work();
        let room = vec![0.0; self.model.reactions()];
        let mut at = Coefficients {
            a: room.clone(),
            b: room,
            ..Coefficients::default()
        };
        Box::new(move |point, out| {
            let [q, q_dot] = [point.y[0], point.y[1]];
            self.model.coefficients(q, &mut work, &mut at)?;
            let square = q_dot * q_dot;
            let q_ddot = -at.half_dm * square / at.m;
            for ((out, a), b) in out.iter_mut().zip(&at.a).zip(&at.b) {
                *out = a * q_ddot + b * square;
            }
            Ok(())
        })
    }

    fn jacobian(&self) -> usize {
        2
    }

    fn making(&self) -> f64 {
        self.making
    }

    fn orbit(&self, start: State) -> Option<(Orbit, usize)> {
        let counted = Counted {
            model: &self.model,
            count: AtomicUsize::new(0),
        };
        let orbit = Orbit::new(&counted, start).ok()?;
        Some((orbit, counted.count.into_inner()))
    }
}

/// A model that counts its evaluations.
struct Counted<'a, R> {
    model: &'a R,
    count: AtomicUsize,
}

impl<R: Reduced> Reduced for Counted<'_, R> {
    type Work = R::Work;

    fn work(&self) -> R::Work {
        self.model.work()
    }

    fn reactions(&self) -> usize {
        self.model.reactions()
    }

    fn range(&self) -> Range {
        self.model.range()
    }

    fn inertia(&self, q: f64, work: &mut R::Work) -> Result<(f64, f64), PlaceError> {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.model.inertia(q, work)
    }

    fn curvature(&self, q: f64, work: &mut R::Work) -> Result<Inertia, PlaceError> {
        self.count.fetch_add(2, Ordering::Relaxed);
        self.model.curvature(q, work)
    }

    fn coefficients(
        &self,
        q: f64,
        work: &mut R::Work,
        out: &mut Coefficients,
    ) -> Result<(), PlaceError> {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.model.coefficients(q, work, out)
    }
}

/// The reduced model in single precision. Its derivative is that of double precision: it helps Newton's
/// method and is in no result.
#[derive(Debug)]
pub(super) struct Short {
    exact: Exact,
    /// Without reactions, and with nothing else that the inertia does not need.
    bare: Model,
}

impl Short {
    pub(super) fn new(exact: &Exact, mechanism: &dwell_geometry::Mechanism) -> Self {
        let model = exact.model();
        Self {
            bare: model.without_reactions().only_for(mechanism, &[]),
            exact: exact.clone(),
        }
    }
}

impl Reduced for Short {
    type Work = (Workspace<f32>, ExactWork);

    fn work(&self) -> Self::Work {
        (self.exact.model().workspace(), self.exact.work())
    }

    fn reactions(&self) -> usize {
        self.exact.reactions()
    }

    fn range(&self) -> Range {
        self.exact.range()
    }

    fn inertia(&self, q: f64, (work, _): &mut Self::Work) -> Result<(f64, f64), PlaceError> {
        let mut out = Coefficients::default();
        self.bare.reduce(q as f32, work, &mut out)?;
        Ok((f64::from(out.m), f64::from(out.half_dm)))
    }

    fn curvature(&self, q: f64, (_, work): &mut Self::Work) -> Result<Inertia, PlaceError> {
        self.exact.curvature(q, work)
    }

    fn coefficients(
        &self,
        q: f64,
        (work, _): &mut Self::Work,
        out: &mut Coefficients,
    ) -> Result<(), PlaceError> {
        let model = self.exact.model();
        let mut short = model.coefficients::<f32>();
        model.reduce(q as f32, work, &mut short)?;
        (out.m, out.half_dm) = (f64::from(short.m), f64::from(short.half_dm));
        let lists = [(&mut out.a, &short.a), (&mut out.b, &short.b)];
        for (out, short) in lists {
            out.clear();
            out.extend(short.iter().map(|&v| f64::from(v)));
        }
        Ok(())
    }
}

/// A machine: any number of freedoms, loads, drives.
pub(super) struct ByMachine<'m> {
    pub(super) machine: &'m Machine,
    /// The same with the reactions that are compared, its first ones.
    pub(super) seen: &'m Machine,
    pub(super) start: &'m Point,
}

impl Evaluator for ByMachine<'_> {
    fn evaluation(&self) -> Evaluation {
        Evaluation::Exact
    }

    fn system(&self) -> Result<Box<dyn System + '_>, DynamicsError> {
        let moving = Moving::new(self.machine, self.start.t, &self.start.y)?;
        Ok(Box::new(moving))
    }

    fn reactions(&self) -> Reactions<'_> {
        let mut work = self.seen.work::<f64>();
        Box::new(move |point, out| {
            self.seen.evaluate(point.t, &point.y, &mut work)?;
            for (out, value) in out.iter_mut().zip(&work.actions().reactions) {
                *out = *value;
            }
            Ok(())
        })
    }

    fn jacobian(&self) -> usize {
        2 * self.machine.first_work()
    }

    fn orbit(&self, start: State) -> Option<(Orbit, usize)> {
        let orbit = Orbit::loaded(self.machine, start).ok()?;
        let points = orbit.points;
        Some((orbit, points))
    }
}

/// The same machine on a table. Reactions are those of the machine at the table's states: a table of it holds none.
pub(super) struct ByTable<'m> {
    pub(super) table: Tabled,
    /// How long it took to make it, s.
    pub(super) making: f64,
    pub(super) accuracy: f64,
    pub(super) exact: ByMachine<'m>,
}

impl Evaluator for ByTable<'_> {
    fn evaluation(&self) -> Evaluation {
        let [cells, ..] = self.table.cells();
        Evaluation::Table {
            accuracy: self.accuracy,
            cells,
            bytes: self.table.bytes(),
        }
    }

    fn system(&self) -> Result<Box<dyn System + '_>, DynamicsError> {
        let Point { t, y } = self.exact.start;
        Ok(Box::new(self.table.moving(*t, y)?))
    }

    fn reactions(&self) -> Reactions<'_> {
        self.exact.reactions()
    }

    fn jacobian(&self) -> usize {
        self.exact.jacobian()
    }

    fn making(&self) -> f64 {
        self.making
    }

    fn orbit(&self, _: State) -> Option<(Orbit, usize)> {
        None
    }
}

/// The same machine in single precision.
pub(super) struct ByShortMachine<'m>(pub(super) ByMachine<'m>);

impl Evaluator for ByShortMachine<'_> {
    fn evaluation(&self) -> Evaluation {
        Evaluation::Short
    }

    fn system(&self) -> Result<Box<dyn System + '_>, DynamicsError> {
        let machine = self.0.machine;
        Ok(Box::new(ShortMoving {
            machine,
            work: machine.work(),
            y: vec![0.0; machine.states()],
            out: vec![0.0; machine.states()],
            exact: Moving::new(machine, self.0.start.t, &self.0.start.y)?,
        }))
    }

    fn reactions(&self) -> Reactions<'_> {
        let seen = self.0.seen;
        let mut work = seen.work::<f32>();
        let mut y = vec![0.0; seen.states()];
        Box::new(move |point, out| {
            shorten(&point.y, &mut y);
            seen.evaluate(point.t, &y, &mut work)?;
            for (out, &value) in out.iter_mut().zip(&work.actions().reactions) {
                *out = f64::from(value);
            }
            Ok(())
        })
    }

    fn jacobian(&self) -> usize {
        self.0.jacobian()
    }

    fn orbit(&self, _: State) -> Option<(Orbit, usize)> {
        None
    }
}

/// A machine about to move, evaluated in single precision; its Jacobian is that of double precision.
struct ShortMoving<'m> {
    machine: &'m Machine,
    work: MachineWork<f32>,
    y: Vec<f32>,
    out: Vec<f32>,
    exact: Moving<'m>,
}

impl System for ShortMoving<'_> {
    fn size(&self) -> usize {
        self.machine.states()
    }

    fn rates(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        shorten(y, &mut self.y);
        self.machine.evaluate(t, &self.y, &mut self.work)?;
        self.machine.rates(&self.work, &mut self.out);
        for (out, &value) in out.iter_mut().zip(&self.out) {
            *out = f64::from(value);
        }
        Ok(())
    }

    fn jacobian(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        self.exact.jacobian(t, y, out)
    }

    fn weight(&self, state: usize) -> f64 {
        self.exact.weight(state)
    }
}

fn shorten(y: &[f64], short: &mut [f32]) {
    for (short, &value) in short.iter_mut().zip(y) {
        *short = value as f32;
    }
}

/// What a table is called.
pub(super) fn of_table(table: &Table, accuracy: f64) -> Evaluation {
    let ([cells, ..], [bytes, _]) = (table.cells(), table.bytes());
    Evaluation::Table {
        accuracy,
        cells,
        bytes,
    }
}
