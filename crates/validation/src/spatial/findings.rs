//! All findings of a case in space.

use super::bodies::body_by_body;
use super::claims::{NAMES, SpaceClaims, components};
use super::period::period;
use super::reference::{Reference, Sample};
use super::reference_poses::ReferencePoses;
use super::samples::{PASSES, POSITIONS, Pass, Samples};
use super::states::state_findings;
use crate::error::ValidationError;
use crate::written::poses::difference::Differences;
use crate::written::poses::rows::largest;
use dwell_findings::{Check, Finding};
use dwell_geometry::space::{Placement, Vec3};
use dwell_kinetostatics::{Coefficients, ReducedModel as _};
use dwell_study::PreparedSpaceScene;
use dwell_study::reduce::compute::ReducedScene as _;
use dwell_verify::FindingSpec;
use dwell_verify::space::{DenseSpace, closure_error};

/// Rounding of positions, amplified by the condition of the equations.
const ROUNDING: &str = "rounding, amplified by the condition of the equations";
/// The step of differences of m, in rad or sizes of the mechanism.
const STEP: f64 = 1e-3;

const CLOSURE: FindingSpec<'_> = FindingSpec {
    key: "closure",
    check: Check::ConstraintClosure,
    comparison: "points and axes of both bodies of each joint",
    scale: "the size of the mechanism, or one radian",
    tolerance: 1e-12,
    tolerance_reason: ROUNDING,
};
const ENERGY: FindingSpec<'_> = FindingSpec {
    key: "m-energy",
    check: Check::KineticEnergy,
    comparison: "m with twice the kinetic energy at unit speed, of velocities by the dense equations",
    scale: "m",
    tolerance: 1e-11,
    tolerance_reason: ROUNDING,
};
const SLOPE: FindingSpec<'_> = FindingSpec {
    key: "half-dm-differences",
    check: Check::EnergySlope,
    comparison: "½m′ with differences of m, extrapolated once",
    scale: "the largest m",
    tolerance: 1e-7,
    tolerance_reason: "differences of the fourth order",
};
const POWER: FindingSpec<'_> = FindingSpec {
    key: "half-dm-power",
    check: Check::Power,
    comparison: "½m′ with the power of the inertia forces at unit speed, of motions by the dense equations",
    scale: "the largest m",
    tolerance: 1e-11,
    tolerance_reason: ROUNDING,
};
const ACTIONS: FindingSpec<'_> = FindingSpec {
    key: "dense-actions",
    check: Check::NewtonEuler,
    comparison: "m, ½m′ and the weight's w with the actuator of the dense equations",
    scale: "the largest m, and the largest w",
    tolerance: 1e-11,
    tolerance_reason: ROUNDING,
};
const REACTIONS: FindingSpec<'_> = FindingSpec {
    key: "dense-reactions",
    check: Check::NewtonEuler,
    comparison: "a, b and the weight's c of all determined reactions with the dense equations",
    scale: "the largest force or moment of the pass there, or a thousandth of what the whole mass makes",
    tolerance: 1e-10,
    tolerance_reason: ROUNDING,
};
const IN_PASSES: FindingSpec<'_> = FindingSpec {
    key: "reduced-passes",
    check: Check::NewtonEuler,
    comparison: "m, ½m′, a and b of the reduced model with the two runs of the mechanism in space",
    scale: "m, and the largest reaction of the run there",
    // Seen: 3.5e-15.
    tolerance: 3e-13,
    tolerance_reason: ROUNDING,
};
const FORCES: FindingSpec<'_> = FindingSpec {
    key: "newton-force",
    check: Check::NewtonEuler,
    comparison: "forces on each body with its momentum, differenced from positions",
    scale: "the largest force on a body there, or a thousandth of the whole mass at its size",
    tolerance: 1e-6,
    tolerance_reason: "second differences of positions, of the fourth order",
};
const MOMENTS: FindingSpec<'_> = FindingSpec {
    key: "euler-moment",
    check: Check::NewtonEuler,
    comparison: "moments on each body with its angular momentum, differenced from positions",
    scale: "the largest moment on a body there, or a thousandth of the whole mass at its size",
    tolerance: 1e-6,
    tolerance_reason: "second differences of positions, of the fourth order",
};
const REFERENCE: FindingSpec<'_> = FindingSpec {
    key: "reference-inertia",
    check: Check::ReferenceValues,
    comparison: "m, ½m′ and the weight's w with the reference of 25 digits",
    scale: "the largest of each",
    tolerance: 1e-12,
    tolerance_reason: ROUNDING,
};
const REFERENCE_REACTIONS: FindingSpec<'_> = FindingSpec {
    key: "reference-reactions",
    check: Check::ReferenceValues,
    comparison: "a, b and the weight's c with the reference of 25 digits",
    scale: "the largest of each",
    tolerance: 1e-12,
    tolerance_reason: ROUNDING,
};
const DIGITS: FindingSpec<'_> = FindingSpec {
    key: "rounding",
    check: Check::Rounding,
    comparison: "m, ½m′, a and b with 32-digit arithmetic",
    scale: "the largest of each kind",
    tolerance: 1e-11,
    tolerance_reason: ROUNDING,
};

/// All findings; a reference may be missing.
pub(super) fn findings(
    prepared: &PreparedSpaceScene<'_>,
    reference: Option<&Reference>,
) -> Result<Vec<Finding>, ValidationError> {
    let samples = &mut Samples::new(prepared)?;
    let domain = format!("{POSITIONS} positions");
    let mut found = Vec::new();
    let [closure, actions, reactions, energy, power] = against_dense(samples)?;
    let [forces, moments] = body_by_body(samples)?;
    let [slope, digits] = by_evaluation(samples)?;
    let in_passes = against_passes(prepared, &samples.q)?;
    for (worst, of) in [
        (closure, &CLOSURE),
        (energy, &ENERGY),
        (slope, &SLOPE),
        (power, &POWER),
        (actions, &ACTIONS),
        (reactions, &REACTIONS),
        (in_passes, &IN_PASSES),
        (forces, &FORCES),
        (moments, &MOMENTS),
        (digits, &DIGITS),
    ] {
        found.extend(worst.finding(of, &domain));
    }
    let positions: Vec<Vec<f64>> = samples.q.iter().step_by(3).map(|q| vec![*q]).collect();
    found.extend(state_findings(prepared.scene, &positions)?);
    if let Some(reference) = reference {
        let domain = format!("{} positions of the reference", reference.samples().count());
        let [inertia, reactions] = against_reference(prepared, reference)?;
        found.extend(inertia.finding(&REFERENCE, &domain));
        found.extend(reactions.finding(&REFERENCE_REACTIONS, &domain));
        found.extend(period(prepared, reference)?);
        let claims = SpaceClaims::new(prepared.scene)?;
        let poses = ReferencePoses::of(prepared.scene, reference);
        found.extend(poses.placements(&claims.case(), &claims.in_numbers::<f64>()));
    }
    Ok(found)
}

/// Kinetic energy doubled, and power of the inertia forces, of all bodies at the dense equations' motions.
fn energy_and_power(
    samples: &Samples<'_>,
    placements: &[Placement],
    dense: &DenseSpace,
) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for (b, mass) in samples.scene.masses.iter().enumerate() {
        if b == samples.scene.mechanism.ground {
            continue;
        }
        let (motion, rotation) = (&dense.motions[b], placements[b].rotation);
        let (w, c) = (motion.angular_velocity, rotation.apply(mass.center));
        let velocity = motion.velocity + w.cross(c);
        let acceleration =
            motion.acceleration + motion.angular_acceleration.cross(c) + w.cross(w.cross(c));
        let tensor = |v: Vec3| rotation.apply(mass.angular_momentum(rotation.apply_inverse(v)));
        sums[0] += mass.mass * velocity.dot(velocity) + w.dot(tensor(w));
        sums[1] +=
            mass.mass * velocity.dot(acceleration) + w.dot(tensor(motion.angular_acceleration));
    }
    sums
}

/// Closure, actions, reactions, energy and power at all positions.
fn against_dense(samples: &mut Samples<'_>) -> Result<[Differences; 5], ValidationError> {
    let mut worst: [Differences; 5] = Default::default();
    let [closure, actions, reactions, energy, power] = &mut worst;
    // The actuator's actions of each pass, those found and those wanted.
    let mut taus: [Vec<[f64; 2]>; 3] = Default::default();
    for q in samples.q.clone() {
        let at = |what: &str| format!("q = {q:.4}, {what}");
        let placements = samples.placements(q)?;
        let mut workspace = samples.model.workspace();
        let determined = samples.model.determined(&[q], &mut workspace);
        let determined = determined.map_err(|e| samples.explain(&e))?;
        let size = samples.model.plan().size();
        for joint in &samples.scene.mechanism.joints {
            // A driven distance holds nothing.
            let is_driven = samples.scene.mechanism.actuators.iter().any(|a| {
                samples.scene.mechanism.joints[a.kind.joint().0].name == joint.name
                    && matches!(a.kind, dwell_geometry::space::ActuatorKind::Length(_))
            });
            if !is_driven {
                let open = closure_error(joint, &placements);
                closure.compare([open, 0.0, size.max(1.0)], "m or rad", || at(&joint.name));
            }
        }
        for (pass, taus) in PASSES.into_iter().zip(&mut taus) {
            let found = samples.found(q, pass)?;
            let Some(dense) = samples.dense(&placements, pass) else {
                continue;
            };
            taus.push([found.tau[0], dense.actuator_actions[0]]);
            if pass.q_dot != 0.0 {
                let inertia = samples.found(q, PASSES[1])?.tau[0];
                let [doubled, rate] = energy_and_power(samples, &placements, &dense);
                energy.compare([inertia, doubled, doubled], "kg m2", || at("m"));
                power.compare([found.tau[0], rate, doubled], "kg m2/rad", || at("½m′"));
            }
            compare_reactions(
                samples,
                (&found.reactions, &determined),
                (&dense, pass),
                reactions,
                &at,
            );
        }
    }
    let largest = |pass: usize| largest(taus[pass].iter().map(|[_, wanted]| wanted));
    // ½m′ may vanish where m does not.
    let scales = [largest(0).max(largest(1)), largest(1), largest(2)];
    for ((taus, what), largest) in taus.iter().zip(["½m′", "m", "w"]).zip(scales) {
        for (k, [found, wanted]) in taus.iter().enumerate() {
            let q = samples.q[k];
            actions.compare([*found, *wanted, largest], "", || {
                format!("q = {q:.4}, {what}")
            });
        }
    }
    Ok(worst)
}

/// The determined reactions of a pass.
fn compare_reactions(
    samples: &Samples<'_>,
    (found, determined): (&[f64], &[bool]),
    (dense, pass): (&DenseSpace, Pass),
    worst: &mut Differences,
    at: &impl Fn(&str) -> String,
) {
    let wanted: Vec<f64> = dense.reactions.iter().flat_map(components).collect();
    // Of a determined component both must say so; what is open is not compared.
    let both = |k: usize| determined[k] && dense.determined[k / 6][k % 6];
    let largest = |kind: usize| {
        let of_kind = (0..wanted.len()).filter(|k| k % 6 / 3 == kind && both(*k));
        largest(of_kind.map(|k| &wanted[k]))
    };
    // What nothing makes is zero to the rounding of what may be.
    let [force, size] = [samples.floor(pass), samples.model.plan().size()];
    let scales = [largest(0).max(force), largest(1).max(force * size)];
    for k in (0..wanted.len()).filter(|k| both(*k)) {
        let joint = &samples.scene.mechanism.joints[k / 6].name;
        let (kind, name) = (k % 6 / 3, NAMES[k % 6]);
        worst.compare(
            [found[k], wanted[k], scales[kind]],
            ["N", "N m"][kind],
            || at(&format!("{joint}.{name}")),
        );
    }
}

/// The reduced coefficients, which may come from a planar equivalent, with the passes that the dense equations judge.
fn against_passes(
    prepared: &PreparedSpaceScene<'_>,
    q: &[f64],
) -> Result<Differences, ValidationError> {
    let mut worst = Differences::default();
    let model = prepared.model.model();
    let (mut workspace, mut found) = (model.workspace(), model.result_buffer());
    let names = prepared.reaction_units();
    for (&q, at) in q.iter().zip(&prepared.coefficients(q)?) {
        let runs = [(&PASSES[0], at.half_dm, &at.b), (&PASSES[1], at.m, &at.a)];
        for (pass, action, reactions) in runs {
            let rates = [[pass.q_dot], [pass.q_ddot]];
            let done =
                model.inverse_dynamics(&[q], &rates[0], &rates[1], &mut workspace, &mut found);
            done.map_err(|e| prepared.explain(&e))?;
            let place = |what: &str| format!("q = {q:.4}, {what}");
            worst.compare([action, found.tau[0], at.m], "kg m2", || place("m or ½m′"));
            let wanted = &found.reactions;
            let largest = largest(wanted);
            for ((name, _), (found, wanted)) in names.iter().zip(reactions.iter().zip(wanted)) {
                worst.compare([*found, *wanted, largest], "", || place(name));
            }
        }
    }
    Ok(worst)
}

/// ½m′ by differences of m, and the rounding errors.
fn by_evaluation(samples: &mut Samples<'_>) -> Result<[Differences; 2], ValidationError> {
    let mut worst: [Differences; 2] = Default::default();
    let prepared = samples.prepared;
    let mut workspace = prepared.model.workspace();
    let mut m_at = |q: f64| prepared.model.inertia(q, &mut workspace).map(|(m, _)| m);
    let step = STEP
        * if prepared.is_angle() {
            1.0
        } else {
            prepared.size()
        };
    let all = prepared.coefficients(&samples.q)?;
    let m_max = all.iter().map(|at| at.m).fold(0.0, f64::max);
    let largest = |of: fn(&Coefficients) -> &Vec<f64>| largest(all.iter().flat_map(of));
    let (a_max, b_max) = (largest(|at| &at.a), largest(|at| &at.b));
    for (&q, at) in samples.q.iter().zip(&all) {
        let mut central = |h: f64| Some((m_at(q + h).ok()? - m_at(q - h).ok()?) / (2.0 * h));
        if let (Some(one), Some(two)) = (central(step), central(2.0 * step)) {
            let half = 0.5 * (4.0 * one - two) / 3.0;
            worst[0].compare([at.half_dm, half, m_max], "kg m2/rad", || {
                format!("q = {q:.4}")
            });
        }
        let errors = prepared.rounding_errors(q, at)?;
        let place = |what: &str| format!("q = {q:.4}, {what}");
        worst[1].compare([errors.m, 0.0, m_max], "kg m2", || place("m"));
        worst[1].compare([errors.half_dm, 0.0, m_max], "kg m2/rad", || place("½m′"));
        for (errors, max, what) in [(&errors.a, a_max, "a"), (&errors.b, b_max, "b")] {
            let error = errors.iter().copied().fold(0.0, f64::max);
            worst[1].compare([error, 0.0, max], "", || place(what));
        }
    }
    Ok(worst)
}

/// m, ½m′ and w, then a, b and c, with the reference.
fn against_reference(
    prepared: &PreparedSpaceScene<'_>,
    reference: &Reference,
) -> Result<[Differences; 2], ValidationError> {
    let mut worst: [Differences; 2] = Default::default();
    let samples: Vec<_> = reference.samples().collect();
    let q: Vec<f64> = samples.iter().filter_map(|s| s.number("q")).collect();
    let found = prepared.coefficients(&q)?;
    let columns = prepared.unit_loads(&q)?;
    let columns = columns.map_or_else(Vec::new, |loads| loads.columns(prepared));
    let gravity = prepared.weight().unwrap_or(0.0);
    let column = |name: &str, k: usize| {
        let column = columns.iter().find(|(c, _)| c.name == name);
        column.map_or(0.0, |(_, values)| gravity * values[k])
    };
    let names = prepared.reaction_units();
    let scales = [0, 1, 2].map(|k| {
        let all = samples
            .iter()
            .flat_map(|s| names.iter().map(move |n| (s, n)));
        let all = all.filter_map(|(s, (name, _))| s.reaction(name)[k]);
        largest(&all.collect::<Vec<f64>>())
    });
    let weights: Vec<f64> = samples.iter().filter_map(Sample::weight).collect();
    let w_max = largest(&weights);
    for (k, (sample, at)) in samples.iter().zip(&found).enumerate() {
        let place = |what: &str| format!("q = {:.4}, {what}", q[k]);
        let m = sample.number("m").unwrap_or(f64::NAN);
        let half_dm = sample.number("half_dm").unwrap_or(f64::NAN);
        worst[0].compare([at.m, m, m], "kg m2", || place("m"));
        worst[0].compare([at.half_dm, half_dm, m], "kg m2/rad", || place("½m′"));
        if let Some(w) = sample.weight() {
            worst[0].compare([column("weight.w", k), w, w_max], "N m", || place("w"));
        }
        for (i, (name, _)) in names.iter().enumerate() {
            let found = [at.a[i], at.b[i], column(&format!("{name}.c.weight"), k)];
            let wanted = sample.reaction(name);
            for (j, wanted) in wanted.into_iter().enumerate() {
                // What the joint cannot transmit there is not in the reference: it is zero.
                let wanted = wanted.unwrap_or(0.0);
                worst[1].compare([found[j], wanted, scales[j]], "", || place(name));
            }
        }
    }
    Ok(worst)
}
