//! The numbers of loads apart from their structure: points, free lengths and angles, constant magnitudes.

use crate::load::{
    CompiledLoads, CompiledSignal, Guide, Load, LoadCoordinate as _, LoadKind, LoadShape as _,
    Magnitude, Signal, Strength, compile_signals,
};
use crate::mass::Mass;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{Coordinate, Mechanism, Vec2};

/// The function that is called with each number.
type Visit<'a> = &'a mut dyn FnMut(&mut f64);

fn visit_points(points: &mut [Vec2], visit: Visit<'_>) {
    for point in points {
        visit(&mut point.x);
        visit(&mut point.y);
    }
}

/// Visits the numbers of a load that may differ between variants. Directions are none of them.
fn visit_load(load: &mut Load, visit: Visit<'_>) {
    match &mut load.kind {
        LoadKind::Gravity { .. } => {}
        LoadKind::Force { point, .. } | LoadKind::Drag { point, .. } => {
            visit_points(std::slice::from_mut(point), visit);
        }
        LoadKind::Along(coordinate, strength) => {
            visit_coordinate(coordinate, visit);
            if let Strength::Elastic { free } = strength {
                visit(free);
            }
        }
        // Not among the loads of variants.
        LoadKind::Special(_) => {}
    }
    match &mut load.magnitude {
        Magnitude::Constant(value) => visit(value),
        Magnitude::Law(signal, _) => visit_signal(signal, visit),
        Magnitude::Expression(_, signals)
        | Magnitude::Function(_, signals)
        | Magnitude::External(signals) => {
            signals.iter_mut().for_each(|s| visit_signal(s, visit));
        }
        Magnitude::Friction(_) | Magnitude::Separating(_) => {}
    }
}

fn visit_signal(signal: &mut Signal, visit: Visit<'_>) {
    match signal {
        Signal::Value(Coordinate::Length { points, .. })
        | Signal::Velocity(Coordinate::Length { points, .. }) => visit_points(points, visit),
        Signal::Value(Coordinate::Angle(_) | Coordinate::Travel(_))
        | Signal::Velocity(Coordinate::Angle(_) | Coordinate::Travel(_))
        | Signal::Time => {}
    }
}

fn visit_compiled_signal(signal: &mut CompiledSignal, visit: Visit<'_>) {
    if let Signal::Value(function) | Signal::Velocity(function) = signal {
        visit_coordinate(function, visit);
    }
}

fn visit_coordinate(coordinate: &mut CoordinateFunction, visit: Visit<'_>) {
    match coordinate {
        CoordinateFunction::Travel(Guide { points, .. })
        | CoordinateFunction::Length { points, .. } => {
            visit_points(points, visit);
        }
        CoordinateFunction::Angle(_) => {}
    }
}

/// Visits the numbers of a load and those of its compiled signals.
fn visit_all(load: &mut Load, signals: &mut [CompiledSignal], visit: Visit<'_>) {
    visit_load(load, visit);
    signals
        .iter_mut()
        .for_each(|s| visit_compiled_signal(s, visit));
}

/// The numbers of some loads with these signals.
fn numbers(loads: &[Load], signals: Vec<Vec<CompiledSignal>>) -> Vec<f64> {
    let mut numbers = Vec::new();
    for (load, mut signals) in loads.iter().zip(signals) {
        visit_all(&mut load.clone(), &mut signals, &mut |n| numbers.push(*n));
    }
    numbers
}

/// Whether a load keeps its meaning with other numbers: its magnitude is known from the state alone.
pub(super) fn is_supported(load: &Load) -> bool {
    let by_state = match load.magnitude {
        Magnitude::Constant(_)
        | Magnitude::Law(..)
        | Magnitude::Expression(..)
        | Magnitude::Function(..) => true,
        Magnitude::Friction(_) | Magnitude::Separating(_) | Magnitude::External(_) => false,
    };
    by_state && load.does_work()
}

/// Whether a load with these numbers is one that a compilation takes: stiffness, damping and gravity above zero, free
/// lengths not below. A compilation decides on everything else.
fn is_sound(load: &Load) -> bool {
    let is_distance = matches!(load.kind, LoadKind::Along(along, _) if along.ends().is_some());
    let is_free_length_sound = load.kind.strength().is_sound(is_distance);
    let may_have_any_sign = load.kind.strength() == Strength::Direct && !load.kind.is_gravity();
    let is_magnitude_sound = match load.magnitude {
        Magnitude::Constant(value) => value > 0.0 || may_have_any_sign,
        _ => true,
    };
    is_free_length_sound && is_magnitude_sound
}

/// The load with all its numbers zero.
fn structure(load: &Load) -> Load {
    let mut load = load.clone();
    visit_load(&mut load, &mut |number| *number = 0.0);
    load
}

impl CompiledLoads {
    /// The numbers of other loads of the same structure, on a mechanism of the same structure. `None` if they have
    /// another one: other bodies, directions, laws.
    pub(super) fn numbers_of(&self, mechanism: &Mechanism, loads: &[Load]) -> Option<Vec<f64>> {
        let same = |(one, other): (&Load, &Load)| structure(one) == structure(other);
        if loads.len() != self.loads.len() || !self.loads.iter().zip(loads).all(same) {
            return None;
        }
        let signals = loads
            .iter()
            .map(|load| compile_signals(mechanism, &load.magnitude));
        let signals: Vec<_> = signals.collect::<Result<_, _>>().ok()?;
        Some(numbers(loads, signals))
    }

    /// Sets the numbers of a variant with these masses, by body; returns false if a compilation must decide on them.
    /// The points at which couples are drawn stay, because a couple has the same effect at each.
    pub(super) fn set_numbers(&mut self, numbers: &[f64], masses: &[Mass]) -> bool {
        let mut next = numbers.iter().copied();
        let mut fill = |to: &mut f64| *to = next.next().unwrap_or(f64::NAN);
        for (load, signals) in self.loads.iter_mut().zip(&mut self.compiled_signals) {
            visit_all(load, signals, &mut fill);
        }
        let mut with_weight = 0;
        for (body, mass) in &mut self.weighted_bodies {
            *mass = masses[body.0];
            with_weight += usize::from(mass.mass > 0.0);
        }
        let with_mass = masses.iter().filter(|mass| mass.mass > 0.0);
        with_mass.count() == with_weight
            && numbers.iter().all(|number| number.is_finite())
            && self.loads.iter().all(is_sound)
    }

    /// How many numbers [`numbers_of`](Self::numbers_of) gives.
    pub(super) fn number_count(&self) -> usize {
        numbers(&self.loads, self.compiled_signals.clone()).len()
    }

    /// Whether all magnitudes are constant.
    pub(super) fn are_constant(&self) -> bool {
        let mut loads = self.loads.iter();
        loads.all(|load| matches!(load.magnitude, Magnitude::Constant(_)))
    }
}
