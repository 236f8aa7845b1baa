//! The names of requested columns.

use crate::explain::{StudyError, scene_error};
use crate::trajectory::compute::{Column, RowScene, all_columns, extra_columns, is_prefix_of};
use dwell_scene::{SceneLocation, choices};

/// Rejects requested names that select no column: for analyses that write none of them, so that a scene is valid for all
/// analyses or for none.
///
/// # Errors
/// [`StudyError::Scene`] at the first of them.
pub(crate) fn reject_unknown_variables<S: RowScene>(scene: &S) -> Result<(), StudyError> {
    match scene.requests().variables {
        Some(_) => check_variables(scene, &scene.unloaded_rows()?),
        None => Ok(()),
    }
}

/// Every column that any analysis of a scene can write.
fn columns_of_all_analyses<S: RowScene>(
    scene: &S,
    rows: &S::Rows,
) -> Result<Vec<Column>, StudyError> {
    let loaded = &*scene.with_drive_loads()?;
    let mut columns = all_columns(loaded, rows, true);
    // Another analysis than `simulate` does not fail where the motion's machine cannot be built.
    let machine = scene
        .has_motion()
        .then(|| scene.machine(&[]).ok())
        .flatten();
    columns.extend(machine.map_or_else(Vec::new, |m| extra_columns(loaded, &m)));
    Ok(columns)
}

/// Rejects requested names that select no column of any analysis.
///
/// # Errors
/// [`StudyError::Scene`] at the first of them.
pub(crate) fn check_variables<S: RowScene>(scene: &S, rows: &S::Rows) -> Result<(), StudyError> {
    let Some(variables) = scene.requests().variables else {
        return Ok(());
    };
    let columns = columns_of_all_analyses(scene, rows)?;
    let is_known = |name: &str| columns.iter().any(|column| column.matches(name));
    let mut names = variables.iter().enumerate();
    let Some((k, name)) = names.find(|(_, name)| !is_known(name)) else {
        return Ok(());
    };
    let joint_of = |name: &str| name.split('.').next().map(str::to_owned);
    let mut open = scene.open_reactions(rows).into_iter();
    let (message, help, label) = if open.any(|open| joint_of(&open) == joint_of(name)) {
        (
            format!("`{name}` is statically indeterminate: redundant constraints share the load"),
            format!("`dwell check` lists such reactions; {}", S::TO_DETERMINE),
            "indeterminate",
        )
    } else {
        (
            format!("there is no column `{name}`"),
            suggestion(name, &columns),
            "unknown column",
        )
    };
    let place = (SceneLocation::Variable(k), label);
    Err(scene_error(scene, message, help, [place]))
}
/// Names that may have been meant: columns and their prefixes; otherwise those with the same first word,
/// or all first words.
pub(crate) fn suggestion(name: &str, columns: &[Column]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for column in columns {
        let ends = column.name.match_indices('.').map(|(at, _)| at);
        for end in ends.chain([column.name.len()]) {
            let prefix = &column.name[..end];
            if !names.contains(&prefix) {
                names.push(prefix);
            }
        }
    }
    let first = name.split('.').next().unwrap_or(name);
    let mut below: Vec<&str> = names.clone();
    below.retain(|n| *n != first && is_prefix_of(first, n));
    if below.is_empty() {
        names.sort_by_key(|n| n.contains('.'));
        choices(name, "columns", names.into_iter())
    } else {
        choices(name, &format!("columns of `{first}`"), below.into_iter())
    }
}
