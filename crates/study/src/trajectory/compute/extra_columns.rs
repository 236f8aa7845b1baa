//! The columns that only a free motion has: energies, works, and the states of its drives.

use crate::machines::MachineScene;
use crate::models::{drive_states, motor_columns};
use crate::trajectory::compute::{BALANCE, Column, KINETIC, POTENTIAL, Quantity};
use dwell_dynamics::{Machine, NonconservativeSource};

/// The columns of [`TrajectorySample::extra_values`](crate::trajectory::compute::TrajectorySample), in their order, of a scene in the plane
/// or in space; in the plane it is that with the loads of its drives.
pub(crate) fn extra_columns<S: MachineScene>(
    scene: &S,
    machine: &Machine<S::Model>,
) -> Vec<Column> {
    let sources = machine.nonconservative_sources().iter();
    let works = sources.map(|&source| {
        let meaning = match source {
            NonconservativeSource::Drive(_) => {
                "work since t = 0, before the rotor: what the rotor stores does not reach the bodies"
            }
            NonconservativeSource::Loads => "work of all loads without a potential since t = 0",
            NonconservativeSource::Load(_)
            | NonconservativeSource::Prescribed(_)
            | NonconservativeSource::Stop(_) => "work since t = 0",
        };
        (scene.name_of_source(source), meaning)
    });
    let states = drive_states(scene.drives(), S::is_angle).into_iter();
    columns_of_integration(works, states.chain(motor_columns(scene.drives())))
}

/// The columns of energies, of works by the names of their sources, of the balance, and of further values such as states of drives, each
/// with its meaning.
fn columns_of_integration<'a>(
    works: impl IntoIterator<Item = (&'a str, &'static str)>,
    further: impl IntoIterator<Item = (String, &'static str, &'static str)>,
) -> Vec<Column> {
    let kinetic = "kinetic energy of all bodies and rotors";
    let potential = "potential energy of gravity, springs and constant forces";
    let balance =
        "drift of kinetic + potential energy − work since t = 0: error of the integration";
    let mut all = vec![
        (KINETIC.to_owned(), "J", kinetic),
        (POTENTIAL.to_owned(), "J", potential),
    ];
    let works = works.into_iter();
    all.extend(works.map(|(name, meaning)| (format!("{name}.work"), "J", meaning)));
    all.push((BALANCE.to_owned(), "J", balance));
    all.extend(further);
    let column = |(k, (name, unit, meaning)): (usize, (String, _, &str))| Column {
        name,
        unit,
        quantity: Quantity::Extra(k),
        meaning: meaning.to_owned(),
        unwraps: false,
    };
    all.into_iter().enumerate().map(column).collect()
}
