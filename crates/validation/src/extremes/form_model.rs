//! A reduced model in one form of evaluation, with its stated errors.

use super::forms::{Evaluated, Form};
use super::mechanisms::scene;
use crate::lifted::{Plane, tilt};
use dwell_export::{Domain, Evaluator as ExportedCode, Precision, Request};
use dwell_geometry::space::{Placement, Vec3};
use dwell_geometry::{Component, PositionError, Range, Reaction};
use dwell_kinetostatics::space::{
    Axes, Component as SpaceComponent, Model as SpaceModel, Reaction as SpaceReaction,
};
use dwell_kinetostatics::{
    Coefficients, ExactModel, Inertia, ReducedModel, ReducibleModel, TableDomain, TabulatedModel,
};
use dwell_numerics::{DoubleDouble, Real, Scalar};
use dwell_scene::PlaneScene;
use dwell_study::models::{compile_model, reduced_model};
use dwell_study::{ExportRequest, compute_export, estimate};
use std::error::Error;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Writes the coefficients at a coordinate.
type Evaluate = Box<dyn FnMut(f64, &mut Coefficients) -> Result<(), PositionError> + Send>;
/// Creates an evaluator with its own memory.
type NewEvaluate = Box<dyn Fn() -> Evaluate + Send + Sync>;

/// A reduced model in a form.
pub(super) struct FormModel {
    form: Form,
    /// The planar mechanism, whose derivatives Newton's method uses.
    plane: ExactModel,
    evaluate: NewEvaluate,
    statement: Statement,
}

/// The origin of a form's stated errors.
enum Statement {
    /// Difference from the evaluation in wider numbers, plus two rounding errors.
    Wider(NewEvaluate),
    /// Measured against the planar model: the absolute error of each coefficient.
    Measured(Coefficients),
}

/// By planar reaction: the spatial reactions of which it is a linear combination, with their factors.
type Sums = Vec<Vec<(usize, f64)>>;

/// Both unit passes in a kind of number.
fn passes<T: Scalar, M: ReducibleModel + Send + 'static>(
    models: &Arc<[M; 2]>,
    sums: &Arc<Sums>,
) -> NewEvaluate {
    let (models, sums) = (Arc::clone(models), Arc::clone(sums));
    Box::new(move || {
        let (models, sums) = (Arc::clone(&models), Arc::clone(&sums));
        let [mut work, mut with_reactions] = [0, 1].map(|k| models[k].pass_workspace::<T>());
        let zeros = vec![T::from_f64(0.0); models[1].reaction_count()];
        let mut found = Coefficients {
            a: zeros.clone(),
            b: zeros,
            ..Coefficients::default()
        };
        Box::new(move |q, out| {
            let q = T::from_f64(q);
            let [m, half_dm] = models[0].reduced_inertia(q, &mut work)?;
            (out.m, out.half_dm) = (m.value(), half_dm.value());
            if sums.is_empty() {
                return Ok(());
            }
            models[1].reduce_at(q, &mut with_reactions, &mut found)?;
            let sum = |of: &[T], terms: &[(usize, f64)]| {
                terms.iter().map(|&(k, by)| by * of[k].value()).sum()
            };
            out.a = sums.iter().map(|terms| sum(&found.a, terms)).collect();
            out.b = sums.iter().map(|terms| sum(&found.b, terms)).collect();
            Ok(())
        })
    })
}

/// The terms of motion and reactions of exported code.
fn exported<R: Real + Send + Sync + 'static>(
    code: ExportedCode<R>,
    domain: Domain,
    reactions: bool,
) -> NewEvaluate {
    let code = Arc::new(code);
    Box::new(move || {
        let code = Arc::clone(&code);
        Box::new(move |q, out| {
            let Domain { from, to, .. } = domain;
            let outside = |_| PositionError::OutOfRange { q, from, to };
            let terms = code.motion_terms(R::of(q)).map_err(outside)?;
            (out.m, out.half_dm) = (terms.m.to_f64(), terms.half_dm.to_f64());
            if reactions {
                let terms = code.reaction_terms(R::of(q)).map_err(outside)?;
                out.a = terms.a.into_iter().map(R::to_f64).collect();
                out.b = terms.b.into_iter().map(R::to_f64).collect();
            }
            Ok(())
        })
    })
}

/// The planar scene in an oblique plane in space, at a distance from the origin and with heights in proportion to it.
fn in_space(
    scene: &PlaneScene,
    reactions: &[Reaction],
    planes: bool,
) -> Result<(SpaceModel, Sums), Box<dyn Error>> {
    let size = scene.mechanism.size();
    let tilted = tilt();
    let plane = Plane {
        frame: Placement {
            position: tilted.position.scaled(size),
            ..tilted
        },
        heights: &|j| 0.04 * size * j as f64,
    };
    let model = compile_model(scene, &[])?;
    let lifted = plane
        .lift(&model, &scene.masses)
        .ok_or("a joint has no counterpart in space")?;
    let (mut all, mut sums) = (Vec::new(), Vec::new());
    for reaction in reactions {
        let along = |axis: usize, of: fn(Axes, usize) -> SpaceComponent| {
            let Vec3 { x, y, z } = tilted.rotation.apply(Vec3::AXES[axis]);
            let parts = [x, y, z]
                .into_iter()
                .enumerate()
                .map(|(k, part)| (of(Axes::Ground, k), part));
            parts.collect::<Vec<_>>()
        };
        let parts = match reaction.component {
            Component::X => along(0, SpaceComponent::Force),
            Component::Y => along(1, SpaceComponent::Force),
            Component::Moment => along(2, SpaceComponent::Moment),
            // The normals of a slide are oblique to the plane.
            _ => vec![
                (SpaceComponent::Force(Axes::Joint, 0), -0.6),
                (SpaceComponent::Force(Axes::Joint, 1), -0.8),
            ],
        };
        let (joint, mut sum) = (reaction.joint, Vec::new());
        for (component, part) in parts {
            sum.push((all.len(), part));
            all.push(SpaceReaction { joint, component });
        }
        sums.push(sum);
    }
    let compile = if planes {
        SpaceModel::new
    } else {
        SpaceModel::without_planes
    };
    let model = compile(&lifted.mechanism, &lifted.masses, &lifted.assembly, &all)?;
    Ok((model, sums))
}

impl FormModel {
    /// The model of a text, with the reactions of a joint if there is one of this name, over an interval around a coordinate if one is given.
    pub(super) fn of(
        form: Form,
        text: &str,
        joint: &str,
        around: Option<[f64; 2]>,
    ) -> Result<Self, Box<dyn Error>> {
        let scene = scene(text)?;
        let mut reactions = scene.mechanism.reactions();
        reactions.retain(|r| scene.mechanism.joints[r.joint.0].name == joint);
        Self::new(form, scene, reactions, around)
    }

    /// The model of a scene with some reactions.
    pub(super) fn new(
        form: Form,
        mut scene: PlaneScene,
        reactions: Vec<Reaction>,
        around: Option<[f64; 2]>,
    ) -> Result<Self, Box<dyn Error>> {
        let plane = reduced_model(&scene, &reactions)?;
        let interval = around.map(|[q, width]| (q - 0.5 * width, q + 0.5 * width));
        // An unbounded range has a table over the rows.
        let unbounded = plane.range() == Range::Unbounded;
        let interval = interval.or(unbounded.then_some((0.0, TAU)));
        let (evaluate, statement) = match form.evaluated {
            Evaluated::Plane => {
                let own = (0..reactions.len()).map(|k| vec![(k, 1.0)]);
                of_model(form, plane.model().clone(), own.collect())
            }
            Evaluated::Space | Evaluated::Loops => {
                let planes = form.evaluated == Evaluated::Space;
                let (model, sums) = in_space(&scene, &reactions, planes)?;
                of_model(form, model, sums)
            }
            Evaluated::Table => {
                let domain =
                    interval.map_or(TableDomain::Full, |(a, b)| TableDomain::Between(a, b));
                on_table(TabulatedModel::new(&plane, form.accuracy(), domain)?)
            }
            Evaluated::Cells | Evaluated::Operations => {
                scene.requests.reactions = reactions;
                as_code(form, &scene, interval)?
            }
        };
        Ok(Self {
            form,
            plane,
            evaluate,
            statement,
        })
    }

    /// The coefficients at a coordinate, with their stated errors.
    pub(super) fn coefficients_with_errors(
        &self,
        q: f64,
    ) -> Result<(Coefficients, Coefficients), Box<dyn Error>> {
        if self.form == Form::PLANE {
            return Ok(estimate::coefficients_with_errors(self.plane.model(), q)?);
        }
        let at = |new: &NewEvaluate| {
            let mut out = Coefficients::default();
            new()(q, &mut out).map(|()| out)
        };
        let values = at(&self.evaluate)?;
        let errors = match &self.statement {
            Statement::Wider(wider) => {
                let roundings = 2.0 * self.form.accuracy();
                let error =
                    |v: f64, w: f64, size: f64| (v - w).abs() + roundings * v.abs().max(size);
                combined(&values, &at(wider)?, error)
            }
            // A fit states its own error only; the fitted model states its rounding error.
            Statement::Measured(errors) => {
                let (_, of_model) = estimate::coefficients_with_errors(self.plane.model(), q)?;
                combined(errors, &of_model, |a, b, _| a + b)
            }
        };
        Ok((values, errors))
    }
}

/// Combines two values of each coefficient and the largest of its kind.
fn combined(
    one: &Coefficients,
    other: &Coefficients,
    of: impl Fn(f64, f64, f64) -> f64,
) -> Coefficients {
    let list = |one: &[f64], other: &[f64]| {
        let size = one.iter().fold(0.0_f64, |size, v| size.max(v.abs()));
        one.iter()
            .zip(other)
            .map(|(&v, &w)| of(v, w, size))
            .collect()
    };
    Coefficients {
        m: of(one.m, other.m, 0.0),
        half_dm: of(one.half_dm, other.half_dm, 0.0),
        a: list(&one.a, &other.a),
        b: list(&one.b, &other.b),
    }
}

/// The passes of a model.
fn of_model<M: ReducibleModel + Send + 'static>(
    form: Form,
    model: M,
    sums: Sums,
) -> (NewEvaluate, Statement) {
    let models = Arc::new([model.for_inertia(), model.for_coefficients()]);
    let sums = Arc::new(sums);
    let double = passes::<f64, M>(&models, &sums);
    match form.precision {
        Precision::Float => (passes::<f32, M>(&models, &sums), Statement::Wider(double)),
        Precision::Double => {
            let wider = passes::<DoubleDouble, M>(&models, &sums);
            (double, Statement::Wider(wider))
        }
    }
}

fn on_table(table: TabulatedModel) -> (NewEvaluate, Statement) {
    let errors = table.bounds().iter().map(|bound| bound.error * bound.scale);
    let statement = measured(&errors.collect::<Vec<_>>(), table.reactions());
    let table = Arc::new(table);
    let evaluate = move || -> Evaluate {
        let table = Arc::clone(&table);
        Box::new(move |q, out| {
            out.a.resize(table.reactions(), 0.0);
            out.b.resize(table.reactions(), 0.0);
            table.coefficients(q, &mut (), out)
        })
    };
    (Box::new(evaluate), statement)
}

/// The errors of m and ½m′, then of the a and of the b of all reactions.
fn measured(errors: &[f64], reactions: usize) -> Statement {
    Statement::Measured(Coefficients {
        m: errors[0],
        half_dm: errors[1],
        a: errors[2..2 + reactions].to_vec(),
        b: errors[2 + reactions..2 + 2 * reactions].to_vec(),
    })
}

fn as_code(
    form: Form,
    scene: &PlaneScene,
    interval: Option<(f64, f64)>,
) -> Result<(NewEvaluate, Statement), Box<dyn Error>> {
    let (accuracy, precision) = (form.accuracy(), form.precision);
    let asked = ExportRequest {
        request: Request {
            accuracy,
            precision,
        },
        exact: form.evaluated == Evaluated::Operations,
        interval,
    };
    let export = compute_export(scene, &asked)?;
    let (domain, reactions) = (export.machine.domain, export.machine.reactions.len());
    let statement = measured(&export.measured.tolerances, reactions);
    let evaluate = match precision {
        Precision::Double => exported(export.evaluator::<f64>(), domain, reactions > 0),
        Precision::Float => exported(export.evaluator::<f32>(), domain, reactions > 0),
    };
    Ok((evaluate, statement))
}

impl ReducedModel for FormModel {
    type Workspace = (
        Evaluate,
        Coefficients,
        <ExactModel as ReducedModel>::Workspace,
    );

    fn workspace(&self) -> Self::Workspace {
        (
            (self.evaluate)(),
            Coefficients::default(),
            self.plane.workspace(),
        )
    }

    fn reactions(&self) -> usize {
        self.plane.reactions()
    }

    fn range(&self) -> Range {
        self.plane.range()
    }

    fn inertia(
        &self,
        q: f64,
        (evaluate, out, _): &mut Self::Workspace,
    ) -> Result<(f64, f64), PositionError> {
        evaluate(q, out)?;
        Ok((out.m, out.half_dm))
    }

    fn inertia_derivatives(
        &self,
        q: f64,
        (.., plane): &mut Self::Workspace,
    ) -> Result<Inertia, PositionError> {
        self.plane.inertia_derivatives(q, plane)
    }

    fn coefficients(
        &self,
        q: f64,
        (evaluate, ..): &mut Self::Workspace,
        out: &mut Coefficients,
    ) -> Result<(), PositionError> {
        evaluate(q, out)
    }
}
