//! The quantities that a scene may be swept for, in the order of their columns.

use crate::number_format::{coordinate_unit, force_unit};
use crate::reduce::compute::inertia_units;
use crate::sweep::compute::motions::NamedUnit;
use crate::sweep::compute::point::{ResultKind, SweepQuantity};
use crate::sweep::compute::signals::NamedSignal;
use crate::sweep::compute::targets::Target;
use crate::trajectory::compute::{Analysis, Quantity, STATISTICS, Statistic};
use std::collections::HashSet;

/// A reaction: its index among the results of its kind, its name and its unit.
pub(crate) type IndexedReaction = (usize, String, &'static str);

/// Every quantity of a scene.
#[derive(Debug, Default)]
pub(super) struct Available {
    pub(crate) quantities: Vec<SweepQuantity>,
    /// Notes on the scene's assembly.
    pub(crate) notes: String,
    /// The tables of wanted values.
    pub(crate) targets: Vec<Target>,
}

impl Available {
    fn add(&mut self, name: String, unit: &str, kind: ResultKind, index: usize) {
        self.quantities.push(SweepQuantity {
            name,
            unit: unit.to_owned(),
            kind,
            index,
        });
    }

    /// Smallest and largest m and ½m′ with their places, and the ends of the range.
    pub(crate) fn add_inertia(&mut self, is_angle: bool) {
        let [m, half_dm] = inertia_units(is_angle);
        let place_unit = coordinate_unit(is_angle);
        for (k, (name, unit)) in [("m", m), ("half_dm", half_dm)].into_iter().enumerate() {
            for (index, end) in [(2 * k, "min"), (2 * k + 1, "max")] {
                self.add(format!("{name}.{end}"), unit, ResultKind::Inertia, index);
                let place = format!("place.{name}.{end}");
                self.add(place, place_unit, ResultKind::InertiaPlace, index);
            }
        }
        self.add("range.lower".to_owned(), place_unit, ResultKind::Range, 0);
        self.add("range.upper".to_owned(), place_unit, ResultKind::Range, 1);
    }

    /// Period and energy of the conservative motion, and the largest reactions in it with their places.
    pub(crate) fn add_orbit(&mut self, is_angle: bool, reactions: Vec<IndexedReaction>) {
        self.add("period".to_owned(), "s", ResultKind::Orbit, 0);
        self.add("energy".to_owned(), "J", ResultKind::Orbit, 1);
        for (k, name, unit) in reactions {
            self.add(format!("{name}.max_abs"), unit, ResultKind::FreeReaction, k);
            let place = format!("place.{name}.max_abs");
            let unit = coordinate_unit(is_angle);
            self.add(place, unit, ResultKind::FreeReactionPlace, k);
        }
    }

    /// The largest actuator forces (by actuator its name, and whether it drives an angle) and reactions.
    pub(crate) fn add_peaks<'a>(
        &mut self,
        actuators: impl Iterator<Item = (&'a str, bool)>,
        reactions: Vec<IndexedReaction>,
    ) {
        let largest = Statistic::MaxAbs;
        for (k, (name, is_angle)) in actuators.enumerate() {
            let name = format!("{name}.actuator_force.max_abs");
            let kind = ResultKind::ActuatorForce(largest);
            self.add(name, force_unit(is_angle), kind, k);
        }
        for (k, name, unit) in reactions {
            let kind = ResultKind::Reaction(largest);
            self.add(format!("{name}.max_abs"), unit, kind, k);
        }
    }

    /// All statistics of signals along the trajectory of an analysis that are not among the quantities yet.
    pub(crate) fn add_along(&mut self, signals: &[NamedSignal], analysis: Analysis) {
        let known: HashSet<String> = self.quantities.iter().map(|q| q.name.clone()).collect();
        for (k, of) in signals.iter().enumerate() {
            for (statistic, end, _) in STATISTICS {
                let name = format!("{}.{end}", of.name);
                let unit = statistic.unit(&of.signal, of.unit, analysis);
                let Some(unit) = unit.filter(|_| !known.contains(&name)) else {
                    continue;
                };
                // The largest forces that are computed by default are known.
                let is_force = statistic != Statistic::MaxAbs;
                let (kind, index) = match of.signal.quantity().filter(|_| is_force) {
                    Some(Quantity::Reaction(k)) => (ResultKind::Reaction(statistic), k),
                    Some(Quantity::ActuatorForce(i)) => (ResultKind::ActuatorForce(statistic), i),
                    _ => (ResultKind::Along(statistic), k),
                };
                self.add(name, unit, kind, index);
            }
        }
    }

    /// Quantities of a kind in their order.
    pub(crate) fn add_all(&mut self, kind: ResultKind, all: Vec<NamedUnit>) {
        for (index, (name, unit)) in all.into_iter().enumerate() {
            self.add(name, &unit, kind, index);
        }
    }
}
