//! What each number of a scene changes.

use super::machine_numbers::GradientScene;
use super::recorded_machine::RecordedMachine;
use dwell_kinetostatics::MachineModel as _;
use dwell_scene::SceneLocation;

/// A relative step of a number to find what it changes, and the part of a change to which that is proportional to the step.
const STEP: f64 = 1e-3;
const PROPORTIONAL: f64 = 1e-11;

/// What a number of the scene changes.
pub(super) enum Change {
    /// Nothing.
    None,
    /// Numbers of the machine, by their place, at these rates.
    Numbers(Vec<(usize, f64)>),
    /// More than that, or numbers of which a recording does not know.
    More,
    /// The scene does not allow another value.
    Fixed(String),
}

/// A number of the scene.
pub(super) struct Varied {
    pub(super) path: String,
    pub(super) value: f64,
    /// A size of its order, in its unit.
    pub(super) scale: f64,
}

/// The numbers of a scene, with their sizes.
pub(super) fn varied_numbers<S: GradientScene>(scene: &S, rows: &S::Rows) -> Vec<Varied> {
    let size = S::model_of(rows).size();
    let (length, _) = scene.to_scene_unit(size, false);
    let number = |path: String| {
        let value = scene.value(&path).ok()?;
        let scale = match (value, scene.location_of(&path)) {
            (0.0, SceneLocation::Point(..) | SceneLocation::Center(_)) => length,
            (0.0, _) => 1.0,
            _ => value.abs(),
        };
        Some(Varied { path, value, scale })
    };
    let paths = scene.all_number_paths().into_iter();
    paths.filter_map(number).collect()
}

/// The numbers of the machine where a number of the scene is larger and smaller by a step.
type Around = [Vec<f64>; 2];

/// The numbers of the machine around a number of the scene; `None` if more changes than these, or why the scene has no other value.
fn around<S: GradientScene>(
    scene: &S,
    machine: &RecordedMachine<'_, S>,
    number: &Varied,
    step: f64,
) -> Result<Option<Around>, String> {
    let structure = machine.structure();
    let at = |value: f64| -> Result<Option<Vec<f64>>, String> {
        let varied = scene.varied(&[(number.path.as_str(), value)]);
        let varied = varied.map_err(|error| error.to_string())?;
        if !scene.differs_in_numbers_only(&varied, structure) {
            return Ok(None);
        }
        if machine.may_refuse_numbers() {
            varied.rows().map_err(|error| error.to_string())?;
        }
        Ok(machine.numbers_of(&varied))
    };
    let (after, before) = (at(number.value + step)?, at(number.value - step)?);
    Ok(after.zip(before).map(|(after, before)| [after, before]))
}

/// What a number changes.
pub(super) fn change<S: GradientScene>(
    scene: &S,
    machine: &RecordedMachine<'_, S>,
    number: &Varied,
) -> Change {
    let mut found: Vec<(f64, Around)> = Vec::new();
    for part in [1.0, 0.5, 0.25] {
        let step = part * STEP * number.scale;
        match around(scene, machine, number, step) {
            Ok(Some(numbers)) => found.push((step, numbers)),
            Ok(None) => return Change::More,
            Err(reason) => return Change::Fixed(reason),
        }
        let around = &found[found.len() - 1].1;
        if jumps(machine.numbers(), around) {
            return Change::More;
        }
        if found.len() == 1 && is_affine(machine.numbers(), around) {
            break;
        }
    }
    let changes = |k: &usize| {
        found[0]
            .1
            .iter()
            .any(|all| all[*k] != machine.numbers()[*k])
    };
    let changed = (0..machine.numbers().len()).filter(changes);
    let rates = changed.map(|k| {
        let rate = |(step, [after, before]): &(f64, Around)| (after[k] - before[k]) / (2.0 * step);
        let rates: Vec<f64> = found.iter().map(rate).collect();
        let rate = match rates[..] {
            // Of a direction, say.
            [wide, middle, narrow] => {
                let (first, second) = ((4.0 * middle - wide) / 3.0, (4.0 * narrow - middle) / 3.0);
                (16.0 * second - first) / 15.0
            }
            _ => rates[0],
        };
        (k, rate)
    });
    let rates: Vec<(usize, f64)> = rates.collect();
    if rates.is_empty() {
        return Change::None;
    }
    Change::Numbers(rates)
}

/// Whether numbers change in proportion to the step.
fn is_affine(at: &[f64], [after, before]: &Around) -> bool {
    let mut each = at.iter().zip(after.iter().zip(before));
    each.all(|(at, (after, before))| {
        let (ahead, behind) = (after - at, at - before);
        let rounding = 4.0 * f64::EPSILON * at.abs();
        (ahead - behind).abs() <= PROPORTIONAL * ahead.abs() + rounding
    })
}

/// A change that no small step makes, as a part of a number or of 1.
const JUMP: f64 = 1e-2;

/// Whether a number jumps: a direction at right angles to an axis that is chosen by its least component.
fn jumps(at: &[f64], [after, before]: &Around) -> bool {
    let mut each = at.iter().zip(after.iter().zip(before));
    each.any(|(at, (after, before))| (after + before - 2.0 * at).abs() > JUMP * at.abs().max(1.0))
}
