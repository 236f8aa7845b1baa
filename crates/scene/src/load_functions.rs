//! Loads whose magnitude is a function of the program that uses the library: a file cannot hold one.

use crate::build::Sections;
use crate::coordinates::AnyCoordinate;
use crate::error::SceneError;
use crate::file::SceneFile;
use crate::scene_data::SceneIn;
use crate::spans::SceneLocation;
use crate::wording::choices;
use dwell_kinetostatics::{Load, Magnitude, MagnitudeFunction, Signal};

/// A function of signals by their names, and values of some of these at which it jumps or has a kink.
pub(crate) struct NamedFunction<'f> {
    pub(crate) load: &'f str,
    pub(crate) signals: &'f [&'f str],
    pub(crate) function: MagnitudeFunction,
    pub(crate) breakpoints: &'f [(&'f str, &'f [f64])],
}

impl NamedFunction<'_> {
    /// Gives it to its load in a scene.
    pub(crate) fn give_to<D: Sections>(self, scene: &mut SceneIn<D>) -> Result<(), SceneError> {
        let mut loads = std::mem::take(&mut scene.loads);
        self.set(&scene.file, &scene.all_coordinates(), &mut loads)?;
        scene.loads = loads;
        Ok(())
    }

    /// Gives it to its load; `coordinates` have names.
    fn set<'c, K, C: AnyCoordinate>(
        self,
        file: &SceneFile,
        coordinates: &(impl Iterator<Item = (&'c str, C)> + Clone),
        loads: &mut [Load<K, C>],
    ) -> Result<(), SceneError> {
        let name = self.load;
        let Some(load) = loads.iter().position(|load| load.name == name) else {
            let names = loads.iter().map(|load| load.name.as_str());
            let help = choices(name, "loads", names);
            return Err(file.error(format!("there is no load `{name}`"), Some(help), &[]));
        };
        let error = |message: String, help: String| {
            let label = (SceneLocation::Load(load), "its function".to_owned());
            file.error(message, Some(help), &[label])
        };
        let mut function = self.function;
        for (signal, values) in self.breakpoints {
            let index = self.signals.iter().position(|known| known == signal);
            let index = index.filter(|_| values.iter().all(|value| value.is_finite()));
            let Some(index) = index else {
                let message = format!("load `{name}` has breakpoints {values:?} of `{signal}`");
                let help = format!(
                    "breakpoints are finite values of the signals of its function: {}",
                    self.signals.join(", ")
                );
                return Err(error(message, help));
            };
            function = function.with_breakpoints(index, values);
        }
        let find = |signal: &&str| {
            find_signal(signal, coordinates).ok_or_else(|| {
                let known = coordinates.clone().map(|(name, _)| name);
                let help = choices(signal.trim_end_matches(".velocity"), "coordinates", known);
                let message = format!(
                    "the function of load `{name}` depends on `{signal}`, which is not `t`, a coordinate or a velocity"
                );
                error(message, help)
            })
        };
        let signals = self.signals.iter().map(find).collect::<Result<_, _>>()?;
        loads[load].magnitude = Magnitude::Function(function, signals);
        Ok(())
    }
}

/// The signal of a name.
fn find_signal<'c, C: AnyCoordinate>(
    name: &str,
    coordinates: &(impl Iterator<Item = (&'c str, C)> + Clone),
) -> Option<Signal<C>> {
    if name == "t" {
        return Some(Signal::Time);
    }
    let find = |name: &str| {
        let mut all = coordinates.clone();
        all.find(|(known, _)| *known == name).map(|(_, c)| c)
    };
    match name.strip_suffix(".velocity") {
        Some(coordinate) => find(coordinate).map(Signal::Velocity),
        None => find(name).map(Signal::Value),
    }
}

/// Takes over the functions of `former` loads into those of a variant: its text does not hold them.
pub(crate) fn keep_functions<K, C: AnyCoordinate>(loads: &mut [Load<K, C>], former: &[Load<K, C>]) {
    for (load, former) in loads.iter_mut().zip(former) {
        if let Magnitude::Function(..) = former.magnitude {
            load.magnitude.clone_from(&former.magnitude);
        }
    }
}
