//! Internal forces of a link: what one part of it does to the other at a cut across a straight line.

use crate::acts::{Act, By};
use crate::ledger::Ledger;
use crate::load::LoadKind;
use crate::mass::Mass;
use crate::model::{Model, Workspace};
use dwell_geometry::{BodyId, Vec2};

/// How a link's mass is taken to lie along the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distribution {
    /// Evenly between the two points: its centre is the middle and its inertia m L²/12.
    UniformBar,
    /// All at the centre of mass, with the whole inertia.
    Lumped,
}

/// A bar counts as uniform when centre and inertia are those of one to this part of L and m L²/12.
const UNIFORM: f64 = 1e-9;

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

/// What the internal forces of a link between two of its points follow from.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkForces {
    /// How the mass was taken to lie.
    pub distribution: Distribution,
    /// Distance of the two points, m.
    pub length: f64,
    /// Direction from A to B.
    along: Vec2,
    /// What acts at a station, with its moment about the line there.
    points: Vec<(f64, Vec2, f64)>,
    bar: Option<Bar>,
}

/// A uniform bar in motion.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bar {
    /// Mass by length, kg/m.
    density: f64,
    /// Acceleration of A less gravity, m/s².
    start: Vec2,
    /// What the acceleration grows by along the bar, 1/s²: α n − ω² u.
    growth: Vec2,
}

impl Ledger {
    /// The internal forces of a body along the straight line from one of its points to another
    /// (in its frame, m), from everything that [`Ledger::acts`] found; none for the ground or where
    /// the points coincide. Actions beside the line are taken to reach it at their foot, those
    /// beyond its ends at the ends. A couple between two bodies stands at the joint between them.
    pub fn link_forces(
        &self,
        model: &Model,
        body: BodyId,
        [from, to]: [Vec2; 2],
        work: &Workspace<f64>,
        acts: &[Act],
    ) -> Option<LinkForces> {
        let length = (to - from).norm();
        let mass = model.masses.get(body.0).copied()?;
        if body == self.ground || length <= 0.0 || !length.is_finite() {
            return None;
        }
        let state = work.states().body(body);
        let along = ((to - from) * (1.0 / length)).turn(state.turn);
        let start = state.arm(from);
        let mut found = LinkForces {
            distribution: Distribution::Lumped,
            length,
            along,
            points: Vec::new(),
            bar: None,
        };
        // Weight lies where the mass does.
        for act in acts.iter().filter(|act| act.body == body) {
            if !model.is_weight(act.by) {
                found.put(act.arm - start, act.force, act.couple);
            }
        }
        let gravity = work.loads().gravity;
        if is_uniform(mass, [from, to], length) {
            let w = state.spin;
            found.distribution = Distribution::UniformBar;
            found.bar = Some(Bar {
                density: mass.mass / length,
                start: state.acceleration_at(start) - gravity,
                growth: along.perp() * state.spin_rate - along * (w * w),
            });
        } else {
            let center = state.arm(mass.center);
            let force = (gravity - state.acceleration_at(center)) * mass.mass;
            found.put(center - start, force, -mass.inertia * state.spin_rate);
        }
        Some(found)
    }
}

impl Model {
    fn is_weight(&self, by: By) -> bool {
        let By::Load(load) = by else { return false };
        let kind = self.loads().get(load).map(|load| load.kind);
        matches!(kind, Some(LoadKind::Gravity { .. }))
    }
}

fn is_uniform(mass: Mass, [from, to]: [Vec2; 2], length: f64) -> bool {
    let inertia = mass.mass * length * length / 12.0;
    let middle = (from + to) * 0.5;
    mass.mass > 0.0
        && (mass.center - middle).norm() <= UNIFORM * length
        && (mass.inertia - inertia).abs() <= UNIFORM * inertia
}

impl LinkForces {
    fn put(&mut self, from_start: Vec2, force: Vec2, couple: f64) {
        let station = from_start.dot(self.along);
        let beside = from_start.dot(self.along.perp());
        // Moved to its foot on the line, an axial force leaves a couple.
        let couple = couple - beside * force.dot(self.along);
        self.points.push((station, force, couple));
    }

    /// The internal forces at a station (m from A), just behind what acts there; at the end, and
    /// beyond it, just before.
    pub fn at(&self, station: f64) -> Section {
        self.cut(station, true)
    }

    /// The internal forces at a station (m from A), just before what acts there; at the start just
    /// behind.
    pub fn before(&self, station: f64) -> Section {
        self.cut(station, false)
    }

    /// Sections at the ends of `intervals` equal parts (at least one), and on both sides of every
    /// action that stands between the ends, in the order of their stations.
    pub fn sections(&self, intervals: usize) -> Vec<Section> {
        let n = intervals.max(1);
        #[allow(clippy::cast_precision_loss, reason = "a number of stations")]
        let even = (0..=n).map(|i| self.length * (i as f64 / n as f64));
        let acted = || {
            let stations = self.points.iter().map(|&(station, ..)| station);
            stations.filter(|&station| self.inside(station))
        };
        let mut stations: Vec<f64> = acted().chain(even).collect();
        stations.sort_by(f64::total_cmp);
        stations.dedup_by(|b, a| *b - *a <= self.slack());
        let mut all = Vec::with_capacity(stations.len() + self.points.len());
        for station in stations {
            if acted().any(|at| (at - station).abs() <= self.slack()) {
                all.push(self.before(station));
            }
            all.push(self.at(station));
        }
        all
    }

    /// Rounding of a station.
    fn slack(&self) -> f64 {
        1e-12 * self.length
    }

    fn inside(&self, station: f64) -> bool {
        station > self.slack() && station < self.length - self.slack()
    }

    fn cut(&self, station: f64, behind: bool) -> Section {
        let s = station.clamp(0.0, self.length);
        let reached = if behind {
            s + self.slack()
        } else {
            s - self.slack()
        };
        let (mut force, mut bending) = (Vec2::ZERO, 0.0);
        let normal = self.along.perp();
        for &(at, action, couple) in &self.points {
            let beyond = at >= self.length - self.slack();
            if at <= self.slack() || (!beyond && at <= reached) {
                force -= action;
                bending -= (at - s) * action.dot(normal) + couple;
            }
        }
        if let Some(Bar {
            density,
            start,
            growth,
        }) = self.bar
        {
            // Of the part before the cut: ∫ a dm and ∫ (σ − s) u×a dm.
            force += (start * s + growth * (0.5 * s * s)) * density;
            let moment = 0.5 * s * s * start.dot(normal) + s * s * s / 6.0 * growth.dot(normal);
            bending -= density * moment;
        }
        Section {
            station: s,
            axial: force.dot(self.along),
            shear: force.dot(normal),
            bending,
        }
    }
}
