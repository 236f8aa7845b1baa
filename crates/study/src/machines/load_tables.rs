//! The states of a machine at which the tables of its loads are given.

use super::machine_scene::MachineScene;
use super::scene_machine::SceneMachine;
use crate::explain::{StudyError, covers, off_table_error, table_of};
use crate::ranges::equally_spaced;
use dwell_kinetostatics::{MachineModel, Signal};

/// Positions at which an interval is tried.
const POSITIONS: usize = 360;
/// Halvings of the distance between two of them: to a rounding of the interval.
const HALVINGS: usize = 50;
/// An end within this distance of an end of a table, relative to the interval, is the end of the table.
const OWN_END: f64 = 1e-9;

/// The first load whose table does not cover its argument, and the argument; `motion_of` gives a coordinate with its rate and acceleration.
pub(crate) fn first_uncovered<M: MachineModel>(
    model: &M,
    t: f64,
    mut motion_of: impl FnMut(M::CoordinateFunction) -> [f64; 3],
) -> Option<(usize, f64)> {
    let mut loads = model.loads().iter().enumerate();
    loads.find_map(|(k, load)| {
        let (_, table) = table_of(&load.magnitude)?;
        let value = match *model.compiled_signals(k).first()? {
            Signal::Time => t,
            Signal::Value(of) => motion_of(of)[0],
            Signal::Velocity(of) => motion_of(of)[1],
        };
        (!covers(table, value)).then_some((k, value))
    })
}

impl<S: MachineScene> SceneMachine<'_, S> {
    /// The first load whose table does not cover a state, and the table's argument there.
    pub(crate) fn uncovered(&self, y: &[f64]) -> Option<(usize, f64)> {
        let model = self.machine.model();
        let has_tables = model
            .loads()
            .iter()
            .any(|l| table_of(&l.magnitude).is_some());
        if !has_tables {
            return None;
        }
        let mut workspace = self.machine.workspace();
        // Where there is no pose, that is another error.
        let mut state = self.machine.evaluate(0.0, y, &mut workspace).ok()?;
        first_uncovered(model, 0.0, |of| state.coordinate_with_acceleration(of))
    }

    /// Rejects a state that the table of a load does not cover; `when` describes the state.
    pub(crate) fn require_covered(&self, y: &[f64], when: &str) -> Result<(), StudyError> {
        let Some((load, value)) = self.uncovered(y) else {
            return Ok(());
        };
        let magnitude = &self.machine.model().loads()[load].magnitude;
        let name_of = |c| self.scene.name_of_coordinate(c);
        let (scene, is_angle) = (self.scene, S::is_angle);
        let error = off_table_error(scene, magnitude, name_of, is_angle, load, value, when);
        error.map_or(Ok(()), Err)
    }

    /// The part of an interval of the only coordinate, around the start, at rest in which the tables of all loads are given.
    pub(crate) fn covered_interval(&self, [from, to]: [f64; 2]) -> Result<[f64; 2], StudyError> {
        let at = |q: f64| {
            let mut y = self.initial_state();
            (y[0], y[1]) = (q, 0.0);
            y
        };
        let start = self.initial_state()[0];
        self.require_covered(&at(start), "at the start")?;
        let loads = self.machine.model().loads();
        let tables = loads.iter().filter_map(|load| table_of(&load.magnitude));
        let own_ends: Vec<f64> = tables.flat_map(|(_, table)| table.range()).collect();
        let end_towards = |end: f64| {
            let beyond = |q: &f64| self.uncovered(&at(*q)).is_some();
            let places = equally_spaced([start, end], POSITIONS);
            let Some(k) = places.iter().position(beyond) else {
                return end;
            };
            let (mut inside, mut outside) = (places[k - 1], places[k]);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (inside + outside);
                if beyond(&middle) {
                    outside = middle;
                } else {
                    inside = middle;
                }
            }
            // Where the coordinate itself is the argument, the interval ends where the table does, to the last bit.
            let own = own_ends
                .iter()
                .copied()
                .find(|own| (own - inside).abs() <= OWN_END * (end - start).abs() && !beyond(own));
            own.unwrap_or(inside)
        };
        Ok([end_towards(from), end_towards(to)])
    }

    /// The name of the load whose table ends next to a value of the only coordinate, within a part of an interval's width.
    #[cfg(feature = "output")]
    pub(crate) fn table_that_ends(&self, q: f64, width: f64) -> Option<&str> {
        let mut y = self.initial_state();
        (y[0], y[1]) = (q + 1e-6 * width, 0.0);
        let (load, _) = self.uncovered(&y)?;
        self.scene.load_name(load)
    }
}
