//! What a table of a machine is made from: the exact machine, with exact derivatives.

use super::{Felt, Measured};
use crate::machine::Machine;
use dwell_geometry::{Dual, Scalar};
use dwell_kinetostatics::table::{Inertias, Maker, Slopes};
use dwell_kinetostatics::{
    Actions, Entry, Exact, Inertia, KinetostaticsError, Magnitude, Model, TableError, Workspace,
};
use std::f64::consts::TAU;

/// Where a measured coordinate is looked at, in parts of the extent.
const LOOKED: [f64; 7] = [0.0, 0.131, 0.292, 0.417, 0.583, 0.719, 0.877];
/// Slopes nearer than this, as a part of the largest, are one: roundings of a pose.
const SAME: f64 = 1e-12;

/// A model in dual numbers at one coordinate and unit speed.
struct Shape {
    model: Model,
    work: Workspace<Dual>,
    actions: Actions<Dual>,
}

impl Shape {
    fn new(machine: &Machine) -> Self {
        let model = machine.model().without_reactions();
        Self {
            work: model.workspace(),
            actions: model.actions(),
            model,
        }
    }

    fn enter(&mut self, q: f64) -> Result<(), TableError> {
        let one = Dual::lift(1.0);
        self.model
            .enter_shape(&[Dual::variable(q)], &[one], &mut self.work)?;
        Ok(())
    }

    /// What one unit of a load gives the coordinate.
    fn w(&mut self, load: usize) -> Result<Dual, KinetostaticsError> {
        self.model
            .channel(load, &mut self.work, &mut self.actions)?;
        Ok(-self.actions.tau[0])
    }

    fn measure(&self, measured: Measured) -> [Dual; 3] {
        self.work.states().measure(measured)
    }
}

/// m and ½m′ of the bodies, rotors and flywheel.
pub(super) struct Inertial<'a> {
    bodies: Inertias<'a>,
    /// N² J of each rotor, and the coordinate it turns with.
    rotors: Vec<(f64, Measured)>,
    flywheel: f64,
    shape: Shape,
}

impl<'a> Inertial<'a> {
    pub(super) fn new(machine: &Machine, exact: &'a Exact) -> Self {
        let turning = machine.drives.iter().filter(|drive| drive.inertia > 0.0);
        Self {
            bodies: exact.slopes(),
            rotors: turning
                .map(|drive| (drive.inertia, drive.measured))
                .collect(),
            flywheel: machine.flywheel(0),
            shape: Shape::new(machine),
        }
    }

    /// What the rotors and the flywheel add: N² J (ds/dq)² each.
    fn beside(&mut self, q: f64) -> Result<Inertia, TableError> {
        let mut sum = Inertia {
            m: self.flywheel,
            ..Inertia::default()
        };
        if self.rotors.is_empty() {
            return Ok(sum);
        }
        self.shape.enter(q)?;
        // At unit speed and no acceleration s̈ is d²s/dq².
        let Shape { model, work, .. } = &mut self.shape;
        model.accelerate(&[Dual::lift(0.0)], work);
        for &(inertia, measured) in &self.rotors {
            let [_, slope, bend] = self.shape.measure(measured);
            sum.m += inertia * slope.v * slope.v;
            sum.half_dm += inertia * slope.v * bend.v;
            sum.half_ddm += inertia * (bend.v * bend.v + slope.v * bend.d);
        }
        Ok(sum)
    }
}

impl Slopes for Inertial<'_> {
    fn at(&mut self, q: f64) -> Result<Inertia, TableError> {
        let (bodies, beside) = (self.bodies.at(q)?, self.beside(q)?);
        Ok(Inertia {
            m: bodies.m + beside.m,
            half_dm: bodies.half_dm + beside.half_dm,
            half_ddm: bodies.half_ddm + beside.half_ddm,
        })
    }

    fn many(&mut self, q: &[f64]) -> Result<Vec<[f64; 2]>, TableError> {
        let mut found = self.bodies.many(q)?;
        for ([m, half_dm], &q) in found.iter_mut().zip(q) {
            let beside = self.beside(q)?;
            *m += beside.m;
            *half_dm += beside.half_dm;
        }
        Ok(found)
    }
}

/// V and ½V′ of all loads that have a potential.
pub(super) struct Potential {
    /// The loads and their magnitudes.
    loads: Vec<(usize, f64)>,
    shape: Shape,
    plain: Workspace<f64>,
}

impl Potential {
    /// None where no load has a potential.
    pub(super) fn new(machine: &Machine) -> Option<Self> {
        let held = machine.model().loads().iter().enumerate();
        let loads: Vec<(usize, f64)> = held
            .filter_map(|(load, held)| match held.magnitude {
                Magnitude::Constant(magnitude) if held.conservative() => Some((load, magnitude)),
                _ => None,
            })
            .collect();
        if loads.is_empty() {
            return None;
        }
        let shape = Shape::new(machine);
        Some(Self {
            loads,
            plain: shape.model.workspace(),
            shape,
        })
    }
}

impl Slopes for Potential {
    fn at(&mut self, q: f64) -> Result<Inertia, TableError> {
        let model = &self.shape.model;
        model.enter_shape(&[q], &[1.0], &mut self.plain)?;
        let all = self.loads.iter();
        let held = all.filter_map(|&(load, _)| model.potential(load, &self.plain));
        let mut sum = Inertia {
            m: held.sum(),
            ..Inertia::default()
        };
        self.shape.enter(q)?;
        for &(load, magnitude) in &self.loads {
            let w = self.shape.w(load)?;
            sum.half_dm -= 0.5 * magnitude * w.v;
            sum.half_ddm -= 0.5 * magnitude * w.d;
        }
        Ok(sum)
    }
}

/// Everything else: w of what has no potential, and what magnitudes depend on.
pub(super) struct Others {
    shape: Shape,
    extent: [f64; 2],
    period: Option<f64>,
    entries: Vec<Entry>,
    /// By measured entry: the coordinate, and what it gains evenly with q.
    measured: Vec<(Measured, f64)>,
}

impl Others {
    pub(super) fn new(machine: &Machine, maker: &Maker, loads: &[usize]) -> Self {
        Self {
            shape: Shape::new(machine),
            extent: maker.extent(),
            period: maker.period(),
            entries: loads.iter().map(|&load| Entry::W { load }).collect(),
            measured: Vec::new(),
        }
    }

    pub(super) fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The value and the slope of a coordinate.
    fn look(&mut self, measured: Measured, q: f64) -> Result<[f64; 2], TableError> {
        self.shape.enter(q)?;
        let [value, slope, _] = self.shape.measure(measured);
        Ok([value.v, slope.v])
    }

    /// A coordinate that follows q in a line, as q itself does; none if it does not.
    fn line(&mut self, measured: Measured) -> Result<Option<Felt>, TableError> {
        let [from, to] = self.extent;
        let [value, slope] = self.look(measured, from)?;
        let (mut apart, mut largest) = (0.0_f64, slope.abs());
        for part in LOOKED {
            let [_, other] = self.look(measured, from + part * (to - from))?;
            (apart, largest) = (apart.max((other - slope).abs()), largest.max(other.abs()));
        }
        let felt = Felt {
            slope,
            offset: value - slope * from,
            column: None,
        };
        Ok((apart <= SAME * largest).then_some(felt))
    }

    /// How to know a coordinate.
    pub(super) fn value(&mut self, measured: Measured) -> Result<Felt, TableError> {
        if let Some(line) = self.line(measured)? {
            return Ok(line);
        }
        // An angle may gain whole turns with each turn of q.
        let slope = match (self.period, measured) {
            (Some(period), Measured::Angle(_)) => {
                let [from, _] = self.extent;
                let [now, _] = self.look(measured, from)?;
                let [later, _] = self.look(measured, from + period)?;
                TAU * ((later - now) / TAU).round() / period
            }
            _ => 0.0,
        };
        let known = self.entries.iter().position(|entry| match *entry {
            Entry::S { measured: k } => self.measured[k] == (measured, slope),
            _ => false,
        });
        let column = known.unwrap_or_else(|| self.add(measured, slope, true));
        Ok(Felt {
            slope,
            offset: 0.0,
            column: Some(column),
        })
    }

    /// How to know its slope.
    pub(super) fn speed(&mut self, measured: Measured) -> Result<Felt, TableError> {
        if let Some(line) = self.line(measured)? {
            return Ok(Felt {
                slope: 0.0,
                offset: line.slope,
                column: None,
            });
        }
        let known = self.entries.iter().position(|entry| match *entry {
            Entry::Ds { measured: k } => self.measured[k].0 == measured,
            _ => false,
        });
        let column = known.unwrap_or_else(|| self.add(measured, 0.0, false));
        Ok(Felt {
            slope: 0.0,
            offset: 0.0,
            column: Some(column),
        })
    }

    /// One more column; its place.
    fn add(&mut self, coordinate: Measured, slope: f64, value: bool) -> usize {
        let measured = self.measured.len();
        self.measured.push((coordinate, slope));
        self.entries.push(if value {
            Entry::S { measured }
        } else {
            Entry::Ds { measured }
        });
        self.entries.len() - 1
    }

    /// All columns at a coordinate.
    pub(super) fn fill(&mut self, q: f64, out: &mut [Dual]) -> Result<(), TableError> {
        self.shape.enter(q)?;
        for (out, entry) in out.iter_mut().zip(&self.entries) {
            *out = match *entry {
                Entry::W { load } => self.shape.w(load)?,
                Entry::S { measured } => {
                    let (coordinate, slope) = self.measured[measured];
                    let [value, ..] = self.shape.measure(coordinate);
                    value - Dual::variable(q) * Dual::lift(slope)
                }
                Entry::Ds { measured } => self.shape.measure(self.measured[measured].0)[1],
                _ => Dual::default(),
            };
        }
        Ok(())
    }
}
