//! Which columns of a table were asked for.

use crate::error::StudyError;
use crate::run::columns::{Column, Columns, Quantity};
use dwell_kinetostatics::Model;
use dwell_scene::{Place, Scene, choices};

/// Whether a name stands for a column: its own, or the first part of it.
pub(crate) fn stands_for(name: &str, column: &str) -> bool {
    column
        .strip_prefix(name)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// Refuses names of columns that no command computes.
///
/// # Errors
/// [`StudyError::Scene`] at the first of them.
pub(crate) fn check(scene: &Scene, model: &Model) -> Result<(), StudyError> {
    let Some(variables) = &scene.requests.variables else {
        return Ok(());
    };
    let columns = Columns::all(scene, model, true);
    for (k, name) in variables.iter().enumerate() {
        if columns.iter().any(|c| c.answers_to(name)) {
            continue;
        }
        if let Some(error) = shared(scene, model, k, name) {
            return Err(error);
        }
        let labels = [(Place::Variable(k), "unknown column".to_owned())];
        return Err(scene
            .error(
                format!("there is no column `{name}`"),
                Some(near(name, &columns)),
                &labels,
            )
            .into());
    }
    Ok(())
}

/// The refusal of a reaction that the loads do not determine.
fn shared(scene: &Scene, model: &Model, k: usize, name: &str) -> Option<StudyError> {
    let mechanism = &scene.mechanism;
    let joint = name.split('.').next();
    let of_joint = |(r, reaction): (usize, &dwell_geometry::Reaction)| {
        let named = Some(mechanism.joints[reaction.joint.0].name.as_str()) == joint;
        named && !model.plan().is_unique(r)
    };
    model
        .reactions()
        .iter()
        .enumerate()
        .find(|&r| of_joint(r))?;
    let labels = [(Place::Variable(k), "not determined".to_owned())];
    let error = scene.error(
        format!(
            "the loads do not determine `{name}`: constraints that repeat each other share them"
        ),
        Some(
            "`dwell check` lists such reactions; take away one of the joints that repeat"
                .to_owned(),
        ),
        &labels,
    );
    Some(error.into())
}

/// What may have been meant: a column, or a word before one of its dots; else what there is under the
/// same first word, or the first words.
fn near(name: &str, columns: &[Column]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for column in columns {
        let ends = column.name.match_indices('.').map(|(at, _)| at);
        for end in ends.chain([column.name.len()]) {
            let part = &column.name[..end];
            if !names.contains(&part) {
                names.push(part);
            }
        }
    }
    let first = name.split('.').next().unwrap_or(name);
    let mut below: Vec<&str> = names.clone();
    below.retain(|n| *n != first && stands_for(first, n));
    if below.is_empty() {
        names.sort_by_key(|n| n.contains('.'));
        choices(name, "columns", names.into_iter())
    } else {
        choices(name, &format!("columns of `{first}`"), below.into_iter())
    }
}

/// Whether a column is asked for by a name.
pub(crate) fn is_named(scene: &Scene, column: &Column) -> bool {
    let names = scene.requests.variables.iter().flatten();
    names.into_iter().any(|n| column.answers_to(n))
}

/// The places of the columns that go into the tables: those asked for, behind the time and the
/// actuators' coordinates.
pub(crate) fn chosen(scene: &Scene, columns: &[Column]) -> Vec<usize> {
    let wanted = |column: &Column| match (&scene.requests.variables, column.quantity) {
        (None, _) | (_, Quantity::Time | Quantity::Drive(_, 0)) => true,
        (Some(_), _) => is_named(scene, column),
    };
    (0..columns.len())
        .filter(|&k| wanted(&columns[k]))
        .collect()
}
