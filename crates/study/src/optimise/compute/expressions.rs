//! Goals and conditions of a job: expressions of results and of numbers of the scene.

use super::measured::Measured;
use crate::explain::StudyError;
use crate::sweep::compute::Design;
use dwell_laws::Expression;
use dwell_scene::{JobPart, SceneFile, SceneLocation};

/// What a variable of an expression is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Variable {
    /// A result, by its number among those of the job.
    Result(usize),
    /// A number of the design, by its number.
    Number(usize),
}

/// An expression of results and numbers.
#[derive(Debug, Clone)]
pub(super) struct JobExpression {
    /// As written.
    pub(super) text: String,
    expression: Expression,
    pub(super) variables: Vec<Variable>,
}

/// The names that expressions of a job may contain.
pub(super) struct Names<'a> {
    pub(super) scene: &'a SceneFile,
    /// Of results.
    pub(super) results: Vec<String>,
    pub(super) design: &'a Design,
}

/// A place in a job.
pub(super) type Place = (usize, JobPart, usize);

impl Names<'_> {
    /// The error of a part of a job.
    pub(super) fn error(&self, (job, part, k): Place, message: String, help: &str) -> StudyError {
        let location = SceneLocation::JobPart(job, part, k);
        let help = Some(help.to_owned()).filter(|help| !help.is_empty());
        let label = (location, "here".to_owned());
        self.scene.error(message, help, &[label]).into()
    }

    /// Reads an expression; `used` collects the names of its results.
    ///
    /// # Errors
    /// [`StudyError`] that points to it.
    pub(super) fn read(
        &self,
        text: &str,
        place: Place,
        used: &mut Vec<String>,
    ) -> Result<JobExpression, StudyError> {
        let assigned: Vec<&str> = self.design.paths().collect();
        // A single name needs no backticks.
        let is_name = |name: &&str| *name == text.trim();
        let names = self.results.iter().map(String::as_str);
        let all: Vec<&str> = names.chain(assigned.iter().copied()).collect();
        let quoted = format!("`{}`", text.trim());
        let written = if all.iter().any(is_name) {
            &quoted
        } else {
            text
        };
        let expression = Expression::parse(written, &all).map_err(|error| {
            let near = dwell_laws::expression::nearest(text.trim(), all.iter().copied());
            let near = near.map(|near| format!("did you mean `{near}`? "));
            let help = format!(
                "{}an expression knows the results of `dwell sweep` and the numbers of the job; names with brackets or hyphens stand between backticks",
                near.unwrap_or_default()
            );
            self.error(place, error.message, &help)
        })?;
        let expression = expression.retain_used();
        let variables = expression.variables().iter().map(|name| {
            if let Some(k) = assigned.iter().position(|path| path == name) {
                return Variable::Number(k);
            }
            let known = used.iter().position(|known| known == name);
            Variable::Result(known.unwrap_or_else(|| {
                used.push(name.clone());
                used.len() - 1
            }))
        });
        Ok(JobExpression {
            text: text.trim().to_owned(),
            variables: variables.collect(),
            expression,
        })
    }
}

/// The results of a design with its numbers.
pub(super) struct DesignValues<'a> {
    pub(super) results: &'a [Measured],
    pub(super) numbers: &'a [f64],
    /// By axis: the derivatives of the numbers.
    pub(super) effects: &'a [Vec<f64>],
}

impl JobExpression {
    /// The result that it is, if it is one alone.
    pub(super) fn result(&self) -> Option<usize> {
        match self.variables[..] {
            [Variable::Result(k)] => {
                let [_, slope, bend, _] = self.expression.derivatives_wrt(&[0.7], 0);
                let value = self.expression.eval(&[0.3]);
                (slope == 1.0 && bend == 0.0 && value == 0.3).then_some(k)
            }
            _ => None,
        }
    }

    fn inputs(&self, at: &DesignValues<'_>) -> Vec<f64> {
        let input = |variable: &Variable| match *variable {
            Variable::Result(k) => at.results[k].value,
            Variable::Number(k) => at.numbers[k],
        };
        self.variables.iter().map(input).collect()
    }

    /// Its value.
    pub(super) fn value(&self, at: &DesignValues<'_>) -> f64 {
        self.expression.eval(&self.inputs(at))
    }

    /// By variable: its derivative.
    pub(super) fn partials(&self, at: &DesignValues<'_>) -> Vec<f64> {
        let inputs = self.inputs(at);
        let each = 0..self.variables.len();
        each.map(|k| self.expression.derivatives_wrt(&inputs, k)[1])
            .collect()
    }

    /// Its derivatives by the axes, with those of the results that `is_left_out` does not name.
    pub(super) fn slope(
        &self,
        at: &DesignValues<'_>,
        is_left_out: &dyn Fn(usize) -> bool,
    ) -> Vec<f64> {
        let mut slope = vec![0.0; at.effects.len()];
        for (variable, partial) in self.variables.iter().zip(self.partials(at)) {
            for (axis, sum) in slope.iter_mut().enumerate() {
                *sum += partial
                    * match *variable {
                        Variable::Result(k) if is_left_out(k) => 0.0,
                        Variable::Result(k) => at.results[k].slope[axis],
                        Variable::Number(k) => at.effects[axis][k],
                    };
            }
        }
        slope
    }
}
