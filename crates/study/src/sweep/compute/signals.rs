//! The quantities along a trajectory whose statistics a sweep computes: the columns of its analysis, the magnitudes of the shaking force
//! and moment, the least determinant, and distances from tables.

use crate::explain::StudyError;
use crate::sweep::compute::SweptScene;
use crate::sweep::compute::point::RequestedQuantities;
use crate::sweep::compute::targets::Target;
use crate::trajectory::compute::{
    Analysis, Quantity, Signal, Statistic, all_columns, statistics_along,
};

/// A signal with its name and unit.
pub(super) struct NamedSignal {
    pub(super) name: String,
    pub(super) unit: &'static str,
    pub(super) signal: Signal,
}

/// All signals along the trajectory of an analysis, the distances from targets last.
pub(super) fn signals<S: SweptScene>(
    scene: &S,
    rows: &S::Rows,
    analysis: Analysis,
    targets: &[Target],
) -> Vec<NamedSignal> {
    let columns = all_columns(scene, rows, false).into_iter();
    let columns = columns.filter(|column| column.is_computed_by(analysis));
    let named = columns.map(|column| NamedSignal {
        name: column.name.clone(),
        unit: column.unit,
        signal: Signal::Column(column),
    });
    let mut all: Vec<NamedSignal> = named.collect();
    for (name, unit) in [("shaking.force", "N"), ("shaking.moment", "N m")] {
        let of_unit = all.iter().filter(|of| of.unit == unit);
        let quantities = of_unit.filter_map(|of| of.signal.quantity());
        let is_shaking = |of: &Quantity| matches!(of, Quantity::ShakingForce(_));
        let components: Vec<Quantity> = quantities.filter(is_shaking).collect();
        // In the plane the moment is a column itself.
        if components.len() > 1 {
            all.push(NamedSignal {
                name: name.to_owned(),
                unit,
                signal: Signal::Norm(components),
            });
        }
    }
    all.push(NamedSignal {
        name: "closure.determinant".to_owned(),
        unit: "",
        signal: Signal::of(Quantity::LeastDeterminant),
    });
    let distances = targets.iter().flat_map(|target| target.distances(&all));
    let distances: Vec<NamedSignal> = distances.collect();
    all.extend(distances);
    all
}

/// The signal of a statistic along the trajectory of an analysis, by the name of the result.
pub(crate) fn signal_of<S: SweptScene>(
    scene: &S,
    rows: &S::Rows,
    analysis: Analysis,
    name: &str,
) -> Option<Signal> {
    let (of, _) = Statistic::of_name(name)?;
    signal_among(scene, rows, analysis, of, &[])
}

/// Actuator forces and requested reactions, which need no list of columns.
fn forces<S: SweptScene>(scene: &S, rows: &S::Rows) -> Vec<(String, Signal)> {
    let actuators = (0..).map_while(|i| Some((i, scene.actuator(i)?)));
    let actuators = actuators.map(|(i, (name, _))| {
        let force = Signal::of(Quantity::ActuatorForce(i));
        (format!("{name}.actuator_force"), force)
    });
    let reactions = scene.swept_reactions(rows).into_iter();
    let reactions = reactions.map(|(k, name, _)| (name, Signal::of(Quantity::Reaction(k))));
    actuators.chain(reactions).collect()
}

/// The requested statistics along the trajectory of an analysis, with their names. A variant in space may lack a reaction.
///
/// # Errors
/// [`StudyError`] where the trajectory ends early, or a result has no value.
pub(super) fn along_values<S: SweptScene>(
    scene: &S,
    rows: &S::Rows,
    analysis: Analysis,
    requested: &RequestedQuantities,
) -> Result<Vec<(String, f64)>, StudyError> {
    let mut known = forces(scene, rows);
    let is_among = |known: &[(String, Signal)], name: &str| known.iter().any(|(n, _)| n == name);
    let mut names = requested.along();
    let are_forces = names.all(|(q, _)| {
        let of = Statistic::of_name(&q.name);
        of.is_some_and(|(name, _)| is_among(&known, name))
    });
    if !are_forces {
        let all = signals(scene, rows, analysis, &requested.targets).into_iter();
        known = all.map(|of| (of.name, of.signal)).collect();
    }
    let has_peaks = requested.along().any(|(q, _)| q.kind.is_by_default());
    let mut all = Vec::new();
    if has_peaks {
        all = scene.largest_forces(rows, analysis)?;
    }
    let (mut found, mut wanted) = (Vec::new(), Vec::new());
    for (quantity, statistic) in requested.along() {
        let of = Statistic::of_name(&quantity.name);
        let signal = of.and_then(|(name, _)| known.iter().find(|(n, _)| n == name));
        let is_open = !all.iter().any(|(name, _)| *name == quantity.name);
        if let Some((_, signal)) = signal.filter(|_| is_open) {
            found.push(quantity.name.clone());
            wanted.push((signal.clone(), statistic));
        }
    }
    if wanted.is_empty() {
        return Ok(all);
    }
    let values = statistics_along(scene, rows, analysis, &wanted)?;
    if let Some(k) = values.iter().position(|value| !value.is_finite()) {
        let message = format!(
            "`{}` has no value: its column is empty at some positions, or its table goes beyond them",
            found[k]
        );
        return Err(scene.error(message, None, &[]).into());
    }
    all.extend(found.into_iter().zip(values));
    Ok(all)
}

/// The signal of a requested statistic along the trajectory of an analysis, also of a distance from a table.
pub(crate) fn signal_along<S: SweptScene>(
    scene: &S,
    rows: &S::Rows,
    analysis: Analysis,
    name: &str,
    requested: &RequestedQuantities,
) -> Option<Signal> {
    let (of, _) = Statistic::of_name(name)?;
    signal_among(scene, rows, analysis, of, &requested.targets)
}

fn signal_among<S: SweptScene>(
    scene: &S,
    rows: &S::Rows,
    analysis: Analysis,
    of: &str,
    targets: &[Target],
) -> Option<Signal> {
    let all = signals(scene, rows, analysis, targets).into_iter();
    let mut named = all.map(|named| (named.name, named.signal));
    let found = named.find(|(name, _)| name == of);
    let found = found.or_else(|| forces(scene, rows).into_iter().find(|(name, _)| name == of));
    found.map(|(_, signal)| signal)
}
