//! The numbers of a variant that follow from those that are varied.

use crate::explain::{StudyError, SweepError};
use crate::sweep::compute::Axis;
use dwell_scene::{SceneFile, SceneLocation, TiedNumber};

/// A number that follows from others.
#[derive(Debug)]
pub(crate) struct Tie {
    pub(crate) number: TiedNumber,
    /// By variable of its expression.
    inputs: Vec<Input>,
}

/// What a variable of an expression stands for.
#[derive(Debug, Clone, Copy)]
enum Input {
    /// A number of the variant: the axes first, then the tied numbers before this one.
    Varied(usize),
    /// A number of the scene that does not vary.
    Written(f64),
}

/// Where a tied number is given: the place in the section `[sweep]`, or the text of the option.
#[derive(Debug, Clone, Copy)]
enum Origin<'g> {
    Section(usize),
    Option(&'g str),
}

impl Origin<'_> {
    fn error(self, scene: &SceneFile, reason: String, help: &str) -> StudyError {
        match self {
            Self::Section(k) => {
                let place = (SceneLocation::Tied(k), "tied here".to_owned());
                scene.error(reason, Some(help.to_owned()), &[place]).into()
            }
            Self::Option(given) => SweepError::Axis {
                option: "--tied",
                given: given.to_owned(),
                reason,
                help: help.to_owned(),
            }
            .into(),
        }
    }
}

impl Tie {
    /// The tied numbers of a scene's section and of `--tied`, which replaces those of the section, in the order of their evaluation.
    ///
    /// # Errors
    /// [`StudyError`] for an expression that is none, and a number that is varied, tied twice, or used before it is tied.
    pub(crate) fn all(
        scene: &SceneFile,
        axes: &[Axis],
        given: &[String],
    ) -> Result<Vec<Self>, StudyError> {
        let of_section = scene.sweep_section.tied.iter().enumerate();
        let mut all: Vec<(Origin<'_>, TiedNumber)> = of_section
            .map(|(k, tied)| (Origin::Section(k), tied.clone()))
            .collect();
        let mut of_options = Vec::new();
        for text in given {
            let origin = Origin::Option(text);
            let tied = text.split_once('=').ok_or_else(|| {
                let reason = "the expression is missing".to_owned();
                origin.error(scene, reason, "write PATH=EXPRESSION")
            })?;
            let tied = scene.tied_number(tied.0.trim(), tied.1.trim());
            let tied = tied.map_err(|(reason, help)| origin.error(scene, reason, &help))?;
            of_options.push((origin, tied));
        }
        all.retain(|(_, tied)| !of_options.iter().any(|(_, other)| other.path == tied.path));
        all.extend(of_options);
        let paths: Vec<&str> = all.iter().map(|(_, tied)| tied.path.as_str()).collect();
        let each = all.iter().enumerate();
        let ties = each.map(|(k, (origin, tied))| {
            let inputs = inputs(scene, axes, &paths, k, &tied.expression);
            let inputs = inputs.map_err(|(reason, help)| origin.error(scene, reason, help))?;
            Ok(Self {
                number: tied.clone(),
                inputs,
            })
        });
        ties.collect()
    }

    /// Its value, from the numbers of the variant before it.
    pub(crate) fn value(&self, numbers: &[f64]) -> f64 {
        self.number.expression.eval(&self.values(numbers))
    }

    /// Its derivative, from those of the numbers of the variant before it.
    pub(crate) fn slope(&self, numbers: &[f64], slopes: &[f64]) -> f64 {
        let inputs = self.values(numbers);
        let each = self.inputs.iter().enumerate();
        let terms = each.map(|(i, input)| match *input {
            Input::Varied(k) => self.number.expression.derivatives_wrt(&inputs, i)[1] * slopes[k],
            Input::Written(_) => 0.0,
        });
        terms.sum()
    }

    /// The values of the variables of its expression.
    fn values(&self, numbers: &[f64]) -> Vec<f64> {
        let inputs = self.inputs.iter().map(|input| match *input {
            Input::Varied(k) => numbers[k],
            Input::Written(value) => value,
        });
        inputs.collect()
    }
}

/// What the variables of the `k`th tied number stand for, or why there is a fault.
fn inputs(
    scene: &SceneFile,
    axes: &[Axis],
    paths: &[&str],
    k: usize,
    expression: &dwell_laws::Expression,
) -> Result<Vec<Input>, (String, &'static str)> {
    let path = paths[k];
    if axes.iter().any(|axis| axis.path == path) {
        let help = "vary the numbers from which it follows, or remove the tie";
        return Err((format!("`{path}` is both varied and tied"), help));
    }
    if paths[..k].contains(&path) {
        return Err((format!("`{path}` is tied twice"), "keep one of the two"));
    }
    let input = |name: &String| {
        if let Some(i) = axes.iter().position(|axis| axis.path == *name) {
            return Ok(Input::Varied(i));
        }
        match paths.iter().position(|path| path == name) {
            Some(j) if j < k => Ok(Input::Varied(axes.len() + j)),
            Some(_) => {
                let reason = format!("`{path}` follows from `{name}`, which is not tied before it");
                Err((reason, "write a number before those that follow from it"))
            }
            None => scene
                .value(name)
                .map(Input::Written)
                .map_err(|e| (e.message, "")),
        }
    };
    expression.variables().iter().map(input).collect()
}
