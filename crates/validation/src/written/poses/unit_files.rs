//! The files of a scene in several systems of units.

use super::closure::closure;
use super::equilibrium::equilibrium;
use super::other_units::in_other_units;
use super::positions::Case;
use super::reading::Reading;
use super::same_columns::same_columns;
use super::scene_text::{has_motion, table_of, text_of};
use super::units::LENGTHS;

/// Systems of units in which each case is written again: as many as there are units of length.
const SYSTEMS: usize = LENGTHS.len();

/// The same files from the scene in other units.
pub(super) fn compare_units(case: &mut Case<'_>, scene: &str) -> Result<(), String> {
    let table = table_of(scene)?;
    let has_motion = has_motion(&table);
    let command = if has_motion {
        "kinetostatics"
    } else {
        "kinematics"
    };
    let file = format!("-{command}.npz");
    let program = case.program;
    let run = |name: &str, scene: &str| {
        let run = program.run(name, scene, &[command, "--points", "31"]);
        run?.npz(&file)
    };
    let expected = run("units", scene)?;
    let first = case.draws.below(SYSTEMS);
    for k in 0..SYSTEMS {
        let (other, units) = in_other_units(&table, case.reading, first + k);
        let other = text_of(&other)?;
        let file = format!("the scene in {units}");
        let rows = match run("other-units", &other) {
            Ok(rows) => rows,
            Err(reason) => {
                case.compared
                    .fail("written-units", format!("{file}: {reason}"));
                continue;
            }
        };
        // The same files; and they meet the equations of the rewritten text.
        case.merge("written-units", same_columns(&rows, &expected, &file));
        let reading = Reading::new(&other)?;
        let of = closure(&reading, &rows, &file);
        case.merge("written-closure", of.joints);
        case.merge("written-laws", of.laws);
        if has_motion {
            let forces = equilibrium(&reading, &rows, &file, false);
            case.merge("written-equilibrium", forces.bodies);
            case.merge("written-loads", forces.loads);
        }
    }
    Ok(())
}
