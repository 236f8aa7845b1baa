//! The sources of work without a potential, and the works that are separate states.

/// Largest number of loads with separate works.
const MAX_SEPARATE_WORKS: usize = 32;

/// Something that does work for which no potential accounts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NonconservativeSource {
    /// A load, by its index in the model.
    Load(usize),
    /// All nonconservative loads together, where they are more than 32: each work is a state of the integration, and an implicit method solves
    /// for all states at once.
    Loads,
    /// A drive, by its index in the machine.
    Drive(usize),
    /// The prescribed motion of an actuator.
    Prescribed(usize),
    /// An end stop, by its index: the energy lost in its impacts.
    Stop(usize),
}

/// The sources of the nonconservative loads, and the loads whose works are one sum.
pub(super) fn of_loads(loads: Vec<usize>) -> (Vec<NonconservativeSource>, Vec<usize>) {
    if loads.len() > MAX_SEPARATE_WORKS {
        return (vec![NonconservativeSource::Loads], loads);
    }
    let each = loads.into_iter().map(NonconservativeSource::Load);
    (each.collect(), Vec::new())
}
