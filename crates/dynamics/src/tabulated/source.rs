//! The functions from which a table of a machine is built: the exact machine with exact derivatives.

use super::{CoordinateFunction, TabulatedCoordinate};
use crate::machine::Machine;
use dwell_kinetostatics::table::{InertiaSampler, Result, SlopeSampler, TableBuilder};
use dwell_kinetostatics::{
    ExactModel, Inertia, InverseDynamics, KinematicState, KinetostaticsError, Magnitude, Model,
    TableQuantity, Workspace,
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

    fn at(&mut self, q: f64) -> Result<DualState<'_>> {
        let (q, one) = (Dual::variable(q), Dual::from_f64(1.0));
        Ok(DualState {
            state: self
                .model
                .kinematic_state(&[q], &[one], &mut self.workspace)?,
            inverse_dynamics: &mut self.inverse_dynamics,
        })
    }
}

/// The state at that coordinate.
struct DualState<'a> {
    state: KinematicState<'a, Dual>,
    inverse_dynamics: &'a mut InverseDynamics<Dual>,
}

impl DualState<'_> {
    /// The generalised force of one unit of a load.
    fn unit_load_force(&mut self, load: usize) -> Result<Dual, KinetostaticsError> {
        let result = &mut *self.inverse_dynamics;
        self.state.unit_load_response(load, result)?;
        Ok(-result.tau[0])
    }
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
        let with_inertia = machine
            .drives
            .iter()
            .filter(|drive| drive.reflected_inertia > 0.0);
        Self {
            bodies: exact.inertia_sampler(),
            rotors: with_inertia
                .map(|drive| (drive.reflected_inertia, drive.measured))
                .collect(),
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
        let mut state = self.dual_model.at(q)?.state;
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
    /// None where no load has a potential.
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
        let mut state = self.dual_model.at(q)?;
        for &(load, magnitude) in &self.loads {
            let w = state.unit_load_force(load)?;
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
    entries: Vec<TableQuantity>,
    /// By measured entry: the coordinate, and the slope of its uniform growth with q.
    measured: Vec<(CoordinateFunction, f64)>,
}

impl AuxiliaryColumns {
    pub(super) fn new(machine: &Machine, builder: &TableBuilder, loads: &[usize]) -> Self {
        Self {
            dual_model: DualModel::new(machine),
            domain: builder.domain(),
            period: builder.period(),
            entries: loads
                .iter()
                .map(|&load| TableQuantity::W { load })
                .collect(),
            measured: Vec::new(),
        }
    }

    pub(super) fn entries(&self) -> &[TableQuantity] {
        &self.entries
    }

    /// The value and the slope of a coordinate.
    fn value_and_slope(&mut self, measured: CoordinateFunction, q: f64) -> Result<[f64; 2]> {
        let [value, slope] = self.dual_model.at(q)?.state.coordinate(measured);
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
            _ => 0.0,
        };
        let known = self.entries.iter().position(|entry| match *entry {
            TableQuantity::S { coordinate: k } => self.measured[k] == (measured, slope),
            _ => false,
        });
        let column = known.unwrap_or_else(|| self.add_column(measured, slope, true));
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
                slope: 0.0,
                offset: line.slope,
                column: None,
            });
        }
        let known = self.entries.iter().position(|entry| match *entry {
            TableQuantity::Ds { coordinate: k } => self.measured[k].0 == measured,
            _ => false,
        });
        let column = known.unwrap_or_else(|| self.add_column(measured, 0.0, false));
        Ok(TabulatedCoordinate {
            slope: 0.0,
            offset: 0.0,
            column: Some(column),
        })
    }

    /// Adds a column and returns its index.
    fn add_column(&mut self, coordinate: CoordinateFunction, slope: f64, value: bool) -> usize {
        let measured = self.measured.len();
        self.measured.push((coordinate, slope));
        self.entries.push(if value {
            TableQuantity::S {
                coordinate: measured,
            }
        } else {
            TableQuantity::Ds {
                coordinate: measured,
            }
        });
        self.entries.len() - 1
    }

    /// All columns at a coordinate.
    pub(super) fn fill(&mut self, q: f64, out: &mut [Dual]) -> Result<()> {
        let mut state = self.dual_model.at(q)?;
        for (out, entry) in out.iter_mut().zip(&self.entries) {
            *out = match *entry {
                TableQuantity::W { load } => state.unit_load_force(load)?,
                TableQuantity::S {
                    coordinate: measured,
                } => {
                    let (coordinate, slope) = self.measured[measured];
                    let [value, _] = state.state.coordinate(coordinate);
                    value - Dual::variable(q) * Dual::from_f64(slope)
                }
                TableQuantity::Ds {
                    coordinate: measured,
                } => state.state.coordinate(self.measured[measured].0)[1],
                _ => Dual::default(),
            };
        }
        Ok(())
    }
}
