//! Truth 8: each body obeys Newton and Euler by itself.
//!
//! ```text
//! Σ F on the body = m a_G                                    (1)
//! Σ M on the body about G = I α                              (2)
//! ```
//!
//! The accelerations are second differences, in time, of dense *positions* along
//! q(t) = q + q̇ t + ½ q̈ t². No velocity and no acceleration is computed on this side, so nothing
//! of that code can be wrong in the same way on both. Every reaction of every joint is judged, in
//! the state it is used in.
//!
//! Closed to rounding, positions are good to about 2e-16 of the size; a second difference divides
//! that by h². With the steps used here, a few hundredths of a radian and more, 1e-12 of the
//! largest force is left.

use super::{MOTIONS, over_motions, place_in, time_step};
use crate::acts::Act;
use crate::bench::{Bench, FORCE_FLOOR, Site};
use crate::closing::Closed;
use crate::differences::{Estimate, Order, derivatives};
use crate::judge::{Check, Reading, Worst};
use crate::subject::SubjectError;
use dwell_findings::Finding;
use dwell_laws::Polynomial;
use rayon::prelude::*;

/// One body's equations: difference, own error and sum of absolute terms of x, y and moment.
struct Equations {
    body: usize,
    difference: [f64; 3],
    own: [f64; 3],
    terms: [f64; 3],
}

/// Two findings: Newton's equation and Euler's.
pub fn bodies(bench: &Bench<'_>) -> Vec<Finding> {
    let all: Vec<[Result<Vec<Equations>, SubjectError>; 3]> = bench
        .sites
        .par_iter()
        .map(|site| MOTIONS.map(|motion| at(bench, site, motion)))
        .collect();
    let [mut force, mut moment] = [Worst::default(), Worst::default()];
    for (i, motion) in MOTIONS.into_iter().enumerate() {
        let largest = |components: std::ops::Range<usize>| {
            let equations = all.iter().flat_map(|motions| &motions[i]).flatten();
            equations
                .flat_map(|e| e.terms[components.clone()].iter().copied())
                .fold(0.0, f64::max)
        };
        let moments = largest(2..3);
        let forces = largest(0..2).max(FORCE_FLOOR * moments / bench.dense.size());
        for (site, motions) in bench.sites.iter().zip(&all) {
            let equations = match &motions[i] {
                Ok(equations) => equations,
                Err(error) => {
                    for worst in [&mut force, &mut moment] {
                        worst.refuse(format!("the subject failed to answer: {error}"));
                    }
                    continue;
                }
            };
            for e in equations {
                for c in 0..3 {
                    let (worst, scale, unit) = if c < 2 {
                        (&mut force, forces, "N")
                    } else {
                        (&mut moment, moments, "N m")
                    };
                    let reading = Reading {
                        difference: e.difference[c],
                        scale,
                        own: e.own[c],
                        unit,
                        condition: site.condition,
                    };
                    worst.meet(&reading, || {
                        let name = &bench.case.mechanism.bodies[e.body].name;
                        format!("{}, {name}", place_in(bench, site.q, motion))
                    });
                }
            }
        }
    }
    let check = |key, compared, scale| Check {
        key,
        truth: "8 Newton and Euler, body by body",
        compared,
        over: format!("every body at {}", over_motions(bench)),
        scale,
        tolerance: 2e-11,
        why: "rounding of the positions over the square of the shortest time step used",
    };
    vec![
        check(
            "bodies-force",
            "the forces on each body with m a_G, positions differenced twice in time",
            "the largest sum of absolute forces on a body in the same motion",
        )
        .judge(force),
        check(
            "bodies-moment",
            "the moments on each body about its centre of mass with I alpha, positions differenced twice",
            "the largest sum of absolute moments on a body in the same motion",
        )
        .judge(moment),
    ]
}

fn at(bench: &Bench<'_>, site: &Site, motion: [f64; 2]) -> Result<Vec<Equations>, SubjectError> {
    let dense = &bench.dense;
    let [q_dot, q_ddot] = motion;
    let actions = bench.subject.actions(site.q, q_dot, q_ddot)?;
    let acts = dense.acts(&site.closed, &actions.reactions, &[actions.tau]);
    let second = accelerations(bench, site, motion);
    let moving = dense
        .bodies
        .iter()
        .enumerate()
        .filter(|(_, b)| b.column.is_some());
    let equations = moving.enumerate().map(|(i, (body, of))| {
        let mass = of.mass;
        let inertias = [mass.mass, mass.mass, mass.inertia];
        let mut e = Equations {
            body,
            difference: [0.0; 3],
            own: [0.0; 3],
            terms: [0.0; 3],
        };
        for (c, inertia) in inertias.into_iter().enumerate() {
            let (value, error) = second
                .get(3 * i + c)
                .map_or((f64::NAN, f64::NAN), |s| (s.value, s.error));
            e.difference[c] = -inertia * value;
            e.own[c] = inertia * error;
            e.terms[c] = (inertia * value).abs();
        }
        let center = dense.center(of, &site.closed);
        let on_it = |act: &&Act| act.body == body;
        for act in acts.iter().filter(on_it) {
            e.difference[0] += act.force.x;
            e.difference[1] += act.force.y;
            e.difference[2] += act.moment(center);
            e.terms[0] += act.force.norm();
            e.terms[1] += act.force.norm();
            e.terms[2] += act.moment_terms(center);
        }
        e
    });
    Ok(equations.collect())
}

/// Accelerations of every moving body's centre of mass and angle, from positions alone: the start
/// of Newton's method is the site itself, not where its speeds would lead.
fn accelerations(bench: &Bench<'_>, site: &Site, motion: [f64; 2]) -> Vec<Estimate> {
    let (dense, row) = (&bench.dense, bench.dense.actuator_row());
    let law = Polynomial::motion(site.q, motion[0], motion[1]);
    let places = |closed: &Closed| -> Vec<f64> {
        let moving = dense.bodies.iter().filter_map(|b| Some((b, b.column?)));
        moving
            .flat_map(|(body, c)| {
                let center = dense.center(body, closed);
                [center.x, center.y, closed.x[c + 2]]
            })
            .collect()
    };
    let middle = places(&site.closed);
    let mut imposed = site.closed.imposed.clone();
    derivatives(
        Order::Second(&middle),
        time_step(bench, site, motion),
        site.pose_rounding(),
        |t| {
            imposed[row] = law.at(t)[0];
            let closed = dense
                .close_beside(&site.closed, &site.closed.x, &imposed)
                .ok()?;
            Some(places(&closed))
        },
    )
}
