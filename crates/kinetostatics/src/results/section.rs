//! Internal forces of a link: the action of one part on the other at a cut across a straight line.

use super::FreeBodyForces;
use crate::load::{AppliedWrench, ForceSource, Load, LoadShape as _};
use crate::mass::Mass;
use crate::model::stages::EvaluatedState;
use dwell_geometry::{BodyId, Vec2};

/// The assumed distribution of a link's mass along the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distribution {
    /// Evenly between the two points: its centre is the middle and its inertia m L²/12.
    UniformBar,
    /// All at the centre of mass, with the whole inertia.
    Lumped,
}

/// A bar counts as uniform when its centre and inertia differ from those of a uniform bar by less than this part of L
/// and m L²/12.
const UNIFORM_TOLERANCE: f64 = 1e-9;

/// The internal forces at a cut. The part towards B acts on the part towards A with the force
/// (axial, shear) along (A → B, that direction turned +90°) and with the couple `bending`; between
/// concentrated actions d(bending)/d(station) = −shear for a bar without mass.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Section {
    /// Distance of the cut from A, m.
    pub station: f64,
    /// Axial force, N; positive pulls.
    pub axial: f64,
    /// Shear force, N.
    pub shear: f64,
    /// Bending moment, N·m.
    pub bending: f64,
}

/// The forces on a link between two of its points, from which its internal forces follow.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkForces {
    /// The assumed distribution of the mass.
    pub distribution: Distribution,
    /// Distance of the two points, m.
    pub length: f64,
    /// Direction from A to B.
    along: Vec2,
    /// The forces at each station, with their moments about the line there.
    point_forces: Vec<(f64, Vec2, f64)>,
    bar: Option<Bar>,
}

/// A uniform bar in motion.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bar {
    /// Mass by length, kg/m.
    density: f64,
    /// Acceleration of A less gravity, m/s².
    start_acceleration: Vec2,
    /// Slope of the acceleration along the bar, 1/s²: α n − ω² u.
    acceleration_slope: Vec2,
}

impl FreeBodyForces {
    /// The internal forces of a body along the straight line from one of its points to another (in its frame, m), from
    /// the result of [`FreeBodyForces::wrenches`]; `None` for the ground, and if the points coincide. A force off the
    /// line acts at its projection on the line; a force beyond the ends acts at the end. A couple between two bodies
    /// acts at the joint between them.
    pub fn link_forces(
        &self,
        evaluated: &EvaluatedState<'_>,
        body: BodyId,
        [from, to]: [Vec2; 2],
        wrenches: &[AppliedWrench],
    ) -> Option<LinkForces> {
        let length = (to - from).norm();
        let model = evaluated.model();
        let mass = model.masses.get(body.0).copied()?;
        if body == self.ground || length <= 0.0 || !length.is_finite() {
            return None;
        }
        let state = evaluated.bodies().body(body);
        let along = ((to - from) * (1.0 / length)).rotate(state.rotation);
        let start = state.moment_arm(from);
        let mut found = LinkForces {
            distribution: Distribution::Lumped,
            length,
            along,
            point_forces: Vec::new(),
            bar: None,
        };
        // Weight is distributed as the mass is.
        let is_gravity = |load: &Load| load.kind.is_gravity();
        let is_weight = |source| match source {
            ForceSource::Load(load) => model.loads().get(load).is_some_and(is_gravity),
            ForceSource::Joint(_) | ForceSource::Actuator(_) => false,
        };
        for wrench in wrenches.iter().filter(|wrench| wrench.body == body) {
            if !is_weight(wrench.source) {
                found.add_force(wrench.moment_arm - start, wrench.force, wrench.couple);
            }
        }
        let gravity = evaluated.loads().gravity;
        if is_uniform(mass, [from, to], length) {
            let w = state.angular_velocity;
            found.distribution = Distribution::UniformBar;
            found.bar = Some(Bar {
                density: mass.mass / length,
                start_acceleration: state.acceleration_at(start) - gravity,
                acceleration_slope: along.perp() * state.angular_acceleration - along * (w * w),
            });
        } else {
            let center = state.moment_arm(mass.center);
            let force = (gravity - state.acceleration_at(center)) * mass.mass;
            let couple = -mass.inertia * state.angular_acceleration;
            found.add_force(center - start, force, couple);
        }
        Some(found)
    }
}

fn is_uniform(mass: Mass, [from, to]: [Vec2; 2], length: f64) -> bool {
    let inertia = mass.mass * length * length / 12.0;
    let middle = (from + to) * 0.5;
    mass.mass > 0.0
        && (mass.center - middle).norm() <= UNIFORM_TOLERANCE * length
        && (mass.inertia - inertia).abs() <= UNIFORM_TOLERANCE * inertia
}

impl LinkForces {
    fn add_force(&mut self, from_start: Vec2, force: Vec2, couple: f64) {
        let station = from_start.dot(self.along);
        let offset = from_start.dot(self.along.perp());
        // An axial force that is moved to its foot on the line leaves a couple.
        let couple = couple - offset * force.dot(self.along);
        self.point_forces.push((station, force, couple));
    }

    /// The internal forces at a station (m from A), just after the forces there; at the end, and beyond it, just before
    /// them.
    pub fn section_after(&self, station: f64) -> Section {
        self.cut(station, true)
    }

    /// The internal forces at a station (m from A), just before the forces there; at the start just after them.
    pub fn section_before(&self, station: f64) -> Section {
        self.cut(station, false)
    }

    /// Sections at the ends of `intervals` equal parts (at least one), and on both sides of every
    /// action between the ends, in the order of their stations.
    pub fn sections(&self, intervals: usize) -> Vec<Section> {
        let n = intervals.max(1);
        let even = (0..=n).map(|i| self.length * (i as f64 / n as f64));
        let acted = || {
            let stations = self.point_forces.iter().map(|&(station, ..)| station);
            stations.filter(|&station| self.inside(station))
        };
        let mut stations: Vec<f64> = acted().chain(even).collect();
        stations.sort_by(f64::total_cmp);
        stations.dedup_by(|b, a| *b - *a <= self.station_tolerance());
        let mut all = Vec::with_capacity(stations.len() + self.point_forces.len());
        for station in stations {
            if acted().any(|at| (at - station).abs() <= self.station_tolerance()) {
                all.push(self.section_before(station));
            }
            all.push(self.section_after(station));
        }
        all
    }

    /// Rounding of a station.
    fn station_tolerance(&self) -> f64 {
        1e-12 * self.length
    }

    fn inside(&self, station: f64) -> bool {
        station > self.station_tolerance() && station < self.length - self.station_tolerance()
    }

    fn cut(&self, station: f64, after: bool) -> Section {
        let s = station.clamp(0.0, self.length);
        let side = if after { 1.0 } else { -1.0 };
        let reached = s + side * self.station_tolerance();
        let (mut force, mut bending) = (Vec2::ZERO, 0.0);
        let normal = self.along.perp();
        for &(at, applied, couple) in &self.point_forces {
            let beyond = at >= self.length - self.station_tolerance();
            if at <= self.station_tolerance() || (!beyond && at <= reached) {
                force -= applied;
                bending -= (at - s) * applied.dot(normal) + couple;
            }
        }
        if let Some(bar) = self.bar {
            let (start, growth) = (bar.start_acceleration, bar.acceleration_slope);
            // Of the part before the cut: ∫ a dm and ∫ (σ − s) u×a dm.
            force += (start * s + growth * (0.5 * s * s)) * bar.density;
            let moment = 0.5 * s * s * start.dot(normal) + s * s * s / 6.0 * growth.dot(normal);
            bending -= bar.density * moment;
        }
        Section {
            station: s,
            axial: force.dot(self.along),
            shear: force.dot(normal),
            bending,
        }
    }
}
