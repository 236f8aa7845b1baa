//! Truth 0: the subject's poses close every joint, and lie on one branch.
//!
//! Everything else is measured where the subject says the mechanism is, so that has to be right
//! first. With x the subject's pose and x* the nearest pose that meets all rows,
//!
//! ```text
//! Φ(x*) = 0,  D(x*) = q                                      (1)
//! |x − x*| → 0                                               (2)
//! ```
//!
//! A subject that changed its assembly branch between two positions would satisfy (1) and (2) at
//! both. So the branch is also followed from position to position, by Newton steps too short to
//! jump, and must arrive where the subject says (modulo whole turns of a body).

use crate::bench::{Bench, Site};
use crate::judge::{Check, Reading, Worst};
use dwell_findings::Finding;
use std::f64::consts::TAU;

/// Both findings.
pub fn closure(bench: &Bench<'_>) -> Vec<Finding> {
    let mut closed = bench.each_site(|site, worst| {
        let reading = Reading {
            difference: site.moved,
            scale: 1.0,
            own: site.pose_noise,
            unit: "",
            condition: site.condition,
        };
        worst.meet(&reading, || bench.place(site.q));
        Ok(())
    });
    for (q, reason) in &bench.refused {
        closed.refuse(format!("{}: {reason}", bench.place(*q)));
    }
    vec![
        Check {
            key: "closure",
            truth: "0 closure",
            compared: "the subject's poses with the nearest ones that meet every dense row",
            over: bench.over(),
            scale: "the largest coordinate of a pose",
            tolerance: 1e-13,
            why: "a pose is given in rounded coordinates, and closed from rounded attachments",
        }
        .judge(closed),
        Check {
            key: "branch",
            truth: "0 closure",
            compared: "the subject's poses with those reached by following the first one through the range",
            over: bench.over(),
            scale: "the mechanism's size, angles in rad",
            tolerance: 1e-12,
            why: "both ends are closed to rounding; another branch is another configuration",
        }
        .judge(branch(bench)),
    ]
}

fn branch(bench: &Bench<'_>) -> Worst {
    let (dense, row) = (&bench.dense, bench.dense.actuator_row());
    let mut sorted: Vec<&Site> = bench.sites.iter().collect();
    sorted.sort_by(|a, b| a.q.total_cmp(&b.q));
    let mut worst = Worst::default();
    let Some((first, others)) = sorted.split_first() else {
        return worst;
    };
    let mut here = first.closed.clone();
    worst.meet(&apart(0.0, first), || bench.place(first.q));
    for site in others {
        match dense.follow(&here, row, site.q) {
            Ok(next) => here = next,
            Err(error) => {
                worst.refuse(format!("on the way to {}: {error}", bench.place(site.q)));
                return worst;
            }
        }
        let mut between: Vec<_> = here
            .x
            .iter()
            .zip(&site.closed.x)
            .map(|(a, b)| a - b)
            .collect();
        for angle in between.iter_mut().skip(2).step_by(3) {
            *angle -= TAU * (*angle / TAU).round();
        }
        worst.meet(&apart(dense.reach(&between), site), || bench.place(site.q));
    }
    worst
}

fn apart(difference: f64, site: &Site) -> Reading {
    Reading {
        difference,
        scale: 1.0,
        own: 0.0,
        unit: "",
        condition: site.condition,
    }
}
