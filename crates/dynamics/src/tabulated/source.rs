//! The functions from which a table of a machine is built: the exact machine with exact derivatives.

use super::{CoordinateFunction, TabulatedCoordinate};
use crate::machine::Machine;
use dwell_kinetostatics::table::{InertiaSampler, Result, SlopeSampler, TableBuilder};
use dwell_kinetostatics::{
    ExactModel, Inertia, InverseDynamics, KinematicState, Magnitude, Model, TableQuantity,
    Workspace,
};
use dwell_numerics::{Dual, Scalar};
use std::f64::consts::TAU;

/// Points at which a measured coordinate is compared with a straight line, in parts of the domain.
const DOMAIN_FRACTIONS: [f64; 7] = [0.0, 0.131, 0.292, 0.417, 0.583, 0.719, 0.877];
/// Slopes that differ by less than this part of the largest are equal to rounding.
const SLOPE_TOLERANCE: f64 = 1e-12;

/// A model in dual numbers at one coordinate and unit speed.
struct DualModel {
    model: Model,
    workspace: Workspace<Dual>,
    inverse_dynamics: InverseDynamics<Dual>,
}

impl DualModel {
    fn new(machine: &Machine) -> Self {
        let model = machine.model().without_reactions();
        Self {
            workspace: model.workspace(),
            inverse_dynamics: model.result_buffer(),
            model,
        }
    }

    /// The state at a coordinate, and memory for its responses.
    fn at(&mut self, q: f64) -> Result<(KinematicState<'_, Dual>, &mut InverseDynamics<Dual>)> {
        let (q, one) = (Dual::variable(q), Dual::from_f64(1.0));
        let workspace = &mut self.workspace;
        let state = self.model.kinematic_state(&[q], &[one], workspace)?;
        Ok((state, &mut self.inverse_dynamics))
    }
}

/// The generalised force of one unit of a load at a state.
fn unit_load_force(
    state: &mut KinematicState<'_, Dual>,
    load: usize,
    result: &mut InverseDynamics<Dual>,
) -> Result<Dual> {
    state.unit_load_response(load, result)?;
    Ok(-result.tau[0])
}

/// m and ½m′ of the bodies, rotors and flywheel.
pub(super) struct TotalInertia<'a> {
    bodies: InertiaSampler<'a>,
    /// N² J of each rotor, and the coordinate of its drive.
    rotors: Vec<(f64, CoordinateFunction)>,
    flywheel: f64,
    dual_model: DualModel,
}

impl<'a> TotalInertia<'a> {
    pub(super) fn new(machine: &Machine, exact: &'a ExactModel) -> Self {
        let drives = machine.drives.iter();
        let rotors = drives.map(|drive| (drive.reflected_inertia, drive.measured));
        Self {
            bodies: exact.inertia_sampler(),
            rotors: rotors.filter(|(inertia, _)| *inertia > 0.0).collect(),
            flywheel: machine.flywheel(0),
            dual_model: DualModel::new(machine),
        }
    }

    /// The inertia of rotors, N² J (ds/dq)² each, and flywheel.
    fn rotors_and_flywheel(&mut self, q: f64) -> Result<Inertia> {
        let mut sum = Inertia {
            m: self.flywheel,
            ..Inertia::default()
        };
        if self.rotors.is_empty() {
            return Ok(sum);
        }
        // At unit speed and no acceleration s̈ is d²s/dq².
        let (mut state, _) = self.dual_model.at(q)?;
        let bodies = state.bodies_at(&[Dual::from_f64(0.0)]);
        for &(inertia, measured) in &self.rotors {
            let [_, slope, bend] = bodies.coordinate(measured);
            sum.m += inertia * slope.v * slope.v;
            sum.half_dm += inertia * slope.v * bend.v;
            sum.half_ddm += inertia * (bend.v * bend.v + slope.v * bend.d);
        }
        Ok(sum)
    }
}

impl SlopeSampler for TotalInertia<'_> {
    fn sample(&mut self, q: f64) -> Result<Inertia> {
        let (bodies, added) = (self.bodies.sample(q)?, self.rotors_and_flywheel(q)?);
        Ok(Inertia {
            m: bodies.m + added.m,
            half_dm: bodies.half_dm + added.half_dm,
            half_ddm: bodies.half_ddm + added.half_ddm,
        })
    }

    fn sample_many(&mut self, q: &[f64]) -> Result<Vec<[f64; 2]>> {
        let mut found = self.bodies.sample_many(q)?;
        for ([m, half_dm], &q) in found.iter_mut().zip(q) {
            let added = self.rotors_and_flywheel(q)?;
            *m += added.m;
            *half_dm += added.half_dm;
        }
        Ok(found)
    }
}

/// V and ½V′ of all loads that have a potential.
pub(super) struct TotalPotential {
    /// The loads and their magnitudes.
    loads: Vec<(usize, f64)>,
    dual_model: DualModel,
    workspace: Workspace<f64>,
}

impl TotalPotential {
    /// `None` if no load has a potential.
    pub(super) fn new(machine: &Machine) -> Option<Self> {
        let entry = machine.model().loads().iter().enumerate();
        let loads: Vec<(usize, f64)> = entry
            .filter_map(|(load, entry)| match entry.magnitude {
                Magnitude::Constant(magnitude) if entry.is_conservative() => {
                    Some((load, magnitude))
                }
                _ => None,
            })
            .collect();
        if loads.is_empty() {
            return None;
        }
        let dual_model = DualModel::new(machine);
        Some(Self {
            loads,
            workspace: dual_model.model.workspace(),
            dual_model,
        })
    }
}

impl SlopeSampler for TotalPotential {
    fn sample(&mut self, q: f64) -> Result<Inertia> {
        let model = &self.dual_model.model;
        let state = model.kinematic_state(&[q], &[1.0], &mut self.workspace)?;
        let all = self.loads.iter();
        let potentials = all.filter_map(|&(load, _)| state.potential_energy(load));
        let mut sum = Inertia {
            m: potentials.sum(),
            ..Inertia::default()
        };
        let (mut state, result) = self.dual_model.at(q)?;
        for &(load, magnitude) in &self.loads {
            let w = unit_load_force(&mut state, load, result)?;
            sum.half_dm -= 0.5 * magnitude * w.v;
            sum.half_ddm -= 0.5 * magnitude * w.d;
        }
        Ok(sum)
    }
}

/// Everything else: w of loads without a potential, and the coordinates on which magnitudes depend.
pub(super) struct AuxiliaryColumns {
    dual_model: DualModel,
    domain: [f64; 2],
    period: Option<f64>,
    pub(super) entries: Vec<TableQuantity>,
    /// By measured entry: the coordinate, and the slope of its uniform growth with q.
    measured: Vec<(CoordinateFunction, f64)>,
}

impl AuxiliaryColumns {
    pub(super) fn new(machine: &Machine, builder: &TableBuilder, loads: &[usize]) -> Self {
        let entries = loads.iter().map(|&load| TableQuantity::W { load });
        Self {
            dual_model: DualModel::new(machine),
            domain: builder.domain(),
            period: builder.period(),
            entries: entries.collect(),
            measured: Vec::new(),
        }
    }

    /// The value and the slope of a coordinate.
    fn value_and_slope(&mut self, measured: CoordinateFunction, q: f64) -> Result<[f64; 2]> {
        let (state, _) = self.dual_model.at(q)?;
        let [value, slope] = state.coordinate(measured);
        Ok([value.v, slope.v])
    }

    /// A coordinate that is linear in q, as q itself is; none if it is not.
    fn linear_coordinate(
        &mut self,
        measured: CoordinateFunction,
    ) -> Result<Option<TabulatedCoordinate>> {
        let [from, to] = self.domain;
        let [value, slope] = self.value_and_slope(measured, from)?;
        let (mut max_difference, mut largest) = (0.0_f64, slope.abs());
        for part in DOMAIN_FRACTIONS {
            let [_, other] = self.value_and_slope(measured, from + part * (to - from))?;
            max_difference = max_difference.max((other - slope).abs());
            largest = largest.max(other.abs());
        }
        let coordinate = TabulatedCoordinate {
            slope,
            offset: value - slope * from,
            column: None,
        };
        Ok((max_difference <= SLOPE_TOLERANCE * largest).then_some(coordinate))
    }

    /// How a coordinate is evaluated.
    pub(super) fn value(&mut self, measured: CoordinateFunction) -> Result<TabulatedCoordinate> {
        if let Some(line) = self.linear_coordinate(measured)? {
            return Ok(line);
        }
        // An angle may gain whole revolutions in each period of q.
        let slope = match (self.period, measured) {
            (Some(period), CoordinateFunction::Angle(_)) => {
                let [from, _] = self.domain;
                let [now, _] = self.value_and_slope(measured, from)?;
                let [later, _] = self.value_and_slope(measured, from + period)?;
                TAU * ((later - now) / TAU).round() / period
            }
            (None, _)
            | (_, CoordinateFunction::Travel { .. } | CoordinateFunction::Length { .. }) => 0.0,
        };
        let column = self.column(measured, slope, |coordinate| TableQuantity::S {
            coordinate,
        });
        Ok(TabulatedCoordinate {
            slope,
            offset: 0.0,
            column: Some(column),
        })
    }

    /// How its slope is evaluated.
    pub(super) fn speed(&mut self, measured: CoordinateFunction) -> Result<TabulatedCoordinate> {
        if let Some(line) = self.linear_coordinate(measured)? {
            return Ok(TabulatedCoordinate {
                offset: line.slope,
                ..TabulatedCoordinate::default()
            });
        }
        let column = self.column(measured, 0.0, |coordinate| TableQuantity::Ds { coordinate });
        Ok(TabulatedCoordinate {
            column: Some(column),
            ..TabulatedCoordinate::default()
        })
    }

    /// The index of the column of a quantity; adds the column if it does not exist.
    fn column(
        &mut self,
        measured: CoordinateFunction,
        slope: f64,
        quantity: impl Fn(usize) -> TableQuantity,
    ) -> usize {
        let known = (0..self.measured.len()).filter(|&k| self.measured[k] == (measured, slope));
        let mut known = known.filter_map(|k| self.entries.iter().position(|e| *e == quantity(k)));
        if let Some(known) = known.next() {
            return known;
        }
        self.entries.push(quantity(self.measured.len()));
        self.measured.push((measured, slope));
        self.entries.len() - 1
    }

    /// All columns at a coordinate.
    pub(super) fn fill(&mut self, q: f64, out: &mut [Dual]) -> Result<()> {
        let (mut state, result) = self.dual_model.at(q)?;
        for (out, entry) in out.iter_mut().zip(&self.entries) {
            *out = match *entry {
                TableQuantity::W { load } => unit_load_force(&mut state, load, result)?,
                TableQuantity::S { coordinate } => {
                    let (coordinate, slope) = self.measured[coordinate];
                    let [value, _] = state.coordinate(coordinate);
                    value - Dual::variable(q) * Dual::from_f64(slope)
                }
                TableQuantity::Ds { coordinate } => {
                    state.coordinate(self.measured[coordinate].0)[1]
                }
                // Those of the model itself and of its potential are filled elsewhere.
                TableQuantity::M
                | TableQuantity::HalfDm
                | TableQuantity::A { .. }
                | TableQuantity::B { .. }
                | TableQuantity::C { .. }
                | TableQuantity::V
                | TableQuantity::HalfDv => Dual::default(),
            };
        }
        Ok(())
    }
}
