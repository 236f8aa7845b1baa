//! Loads whose magnitude is a function of the program that uses the library: a file cannot hold one.

use crate::error::SceneError;
use crate::scene::Scene;
use crate::spans::SceneLocation;
use crate::wording::choices;
use dwell_kinetostatics::{Load, Magnitude, MagnitudeFunction, Signal};

impl Scene {
    /// The same scene with the magnitude of the load `name` computed by `function` from `signals`: `t`, a coordinate
    /// such as `phi` (rad or m), or its velocity `phi.velocity`, in SI. The magnitude in the file is dropped. At the breakpoints, values of
    /// signals by their names, the function jumps or has a kink.
    ///
    /// # Errors
    /// [`SceneError`] where there is no such load or no such signal, or a breakpoint is of another signal or not finite.
    pub fn with_load_function(
        mut self,
        name: &str,
        signals: &[&str],
        mut function: MagnitudeFunction,
        breakpoints: &[(&str, &[f64])],
    ) -> Result<Self, SceneError> {
        let Some(load) = self.loads.iter().position(|load| load.name == name) else {
            let names = self.loads.iter().map(|load| load.name.as_str());
            let help = choices(name, "loads", names);
            return Err(self.error(format!("there is no load `{name}`"), Some(help), &[]));
        };
        for (signal, values) in breakpoints {
            let index = signals.iter().position(|known| known == signal);
            let index = index.filter(|_| values.iter().all(|value| value.is_finite()));
            let Some(index) = index else {
                let label = (SceneLocation::Load(load), "its function".to_owned());
                let message = format!("load `{name}` has breakpoints {values:?} of `{signal}`");
                let help = format!(
                    "breakpoints are finite values of the signals of its function: {}",
                    signals.join(", ")
                );
                return Err(self.error(message, Some(help), &[label]));
            };
            function = function.with_breakpoints(index, values);
        }
        let find = |signal: &&str| self.find_signal(load, signal);
        let signals = signals.iter().map(find).collect::<Result<_, _>>()?;
        self.loads[load].magnitude = Magnitude::Function(function, signals);
        Ok(self)
    }

    fn find_signal(&self, load: usize, name: &str) -> Result<Signal, SceneError> {
        if name == "t" {
            return Ok(Signal::Time);
        }
        let found = match name.strip_suffix(".velocity") {
            Some(coordinate) => self.coordinate(coordinate).map(Signal::Velocity),
            None => self.coordinate(name).map(Signal::Value),
        };
        found.ok_or_else(|| {
            let known = self.all_coordinates().map(|(name, _)| name);
            let help = choices(name.trim_end_matches(".velocity"), "coordinates", known);
            let message = format!(
                "the function of load `{}` depends on `{name}`, which is not `t`, a coordinate or a velocity",
                self.loads[load].name
            );
            let label = (SceneLocation::Load(load), "its function".to_owned());
            self.error(message, Some(help), &[label])
        })
    }

    /// Takes over the functions of `loads`, of which this scene is a variant: its text does not hold them.
    pub(crate) fn keep_functions(&mut self, loads: &[Load]) {
        for (load, former) in self.loads.iter_mut().zip(loads) {
            if let Magnitude::Function(..) = former.magnitude {
                load.magnitude.clone_from(&former.magnitude);
            }
        }
    }
}
