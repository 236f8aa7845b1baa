//! What every truth starts from: the mechanism closed densely at every position, its unit speeds
//! there, and the scales that differences are relative to.

use crate::case::Case;
use crate::closing::Closed;
use crate::dense::{Dense, DenseError};
use crate::judge::Worst;
use crate::subject::{Coefficients, Subject, SubjectError};
use dwell_geometry::{Component, Reaction};
use rayon::prelude::*;

/// The dense mechanism at one sampled position.
#[derive(Debug, Clone)]
pub struct Site {
    /// The coordinate, rad.
    pub q: f64,
    /// The configuration, closed from the subject's pose.
    pub closed: Closed,
    /// How far closing moved the subject's pose, relative to the largest coordinate in it.
    pub moved: f64,
    /// Unit speeds of every row, the actuator's last.
    pub unit_speeds: Vec<Vec<f64>>,
    /// The coefficients by dense speeds and accelerations, without any step.
    pub exact: Coefficients,
    /// How much rounding may have moved each of them.
    pub noise: Coefficients,
    /// How much rounding may have moved the pose, relative to the mechanism's size.
    pub pose_noise: f64,
    /// Condition number of the dense scaled rows.
    pub condition: f64,
}

/// The largest coefficients of each unit over all positions, by the dense side.
///
/// A coefficient may be zero throughout: the moment of a guide on a slider without inertia is. It
/// is therefore held against the largest of its unit in the whole mechanism, the actuator's own
/// coefficients m and ½m′ included, since τ is a moment too. Where a whole unit is zero (every
/// force of a balanced flywheel) a small part of what the other coefficients would make of it
/// stands in, so that rounding is not divided by rounding.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Scales {
    /// Largest m, kg m².
    pub m: f64,
    /// Largest part of m that bodies of varying inertia have; zero if none varies.
    pub m_varying: f64,
    /// Largest ½m′, kg m²/rad.
    pub half_dm: f64,
    /// Largest a of a force and of a moment.
    pub a: [f64; 2],
    /// Largest b of a force and of a moment.
    pub b: [f64; 2],
}

/// A case and its subject, ready to be judged.
pub struct Bench<'a> {
    /// The case.
    pub case: &'a Case<'a>,
    /// What is judged.
    pub subject: &'a dyn Subject,
    /// The dense mechanism.
    pub dense: Dense,
    /// The positions that could be closed.
    pub sites: Vec<Site>,
    /// Why the others could not.
    pub refused: Vec<(f64, String)>,
    /// The scales.
    pub scales: Scales,
    /// Bodies whose share in m changes over the positions.
    pub varying: Vec<usize>,
    /// All reactions, in order.
    pub reactions: Vec<Reaction>,
}

/// Where a whole unit is zero: b against a (both are per 1/s²), forces against moments per size.
const B_FLOOR: f64 = 1e-4;
pub(crate) const FORCE_FLOOR: f64 = 1e-6;
/// A share in m that changes by less than this of itself is constant.
const CONSTANT: f64 = 1e-12;

impl<'a> Bench<'a> {
    /// Closes the mechanism at every position and measures the scales. A position that does not
    /// close is noted, not an error: the others are still judged.
    pub fn new(case: &'a Case<'a>, subject: &'a dyn Subject) -> Result<Self, DenseError> {
        let actuators = case.mechanism.actuators.len();
        if actuators != 1 {
            return Err(DenseError::Actuators { actuators });
        }
        let shown = case.positions.first().and_then(|&q| subject.poses(q).ok());
        let dense = match shown {
            None => Dense::new(case.mechanism, case.masses)?,
            // Gears mesh as the subject first shows them: from there on they must keep step.
            Some(poses) => Dense::meshed(case.mechanism, case.masses, &poses)?,
        };
        let tried: Vec<_> = case
            .positions
            .par_iter()
            .map(|&q| Site::new(&dense, subject, q).map_err(|message| (q, message)))
            .collect();
        let (mut sites, mut refused) = (Vec::new(), Vec::new());
        for site in tried {
            match site {
                Ok(site) => sites.push(site),
                Err(reason) => refused.push(reason),
            }
        }
        let reactions = case.mechanism.reactions();
        let varying = varying_bodies(&dense, &sites);
        let scales = scales(&dense, &sites, &varying, &reactions);
        Ok(Self {
            case,
            subject,
            dense,
            sites,
            refused,
            scales,
            varying,
            reactions,
        })
    }

    /// `phi = 1.3 rad`.
    pub(crate) fn place(&self, q: f64) -> String {
        let actuator = self.case.mechanism.actuators.first();
        let name = actuator.map_or("q", |a| a.name.as_str());
        format!("{name} = {q:.6} {}", self.unit())
    }

    /// Unit of the coordinate.
    pub(crate) fn unit(&self) -> &'static str {
        if self.dense.drives_an_angle() {
            "rad"
        } else {
            "m"
        }
    }

    /// `phi = 1.3 rad, slide.normal`.
    pub(crate) fn place_of(&self, q: f64, reaction: usize) -> String {
        let name = self.case.mechanism.reaction_name(self.reactions[reaction]);
        format!("{}, {name}", self.place(q))
    }

    /// The words for the positions judged.
    pub(crate) fn over(&self) -> String {
        let range = match self.case.range.limits() {
            None => "over a full turn".to_owned(),
            Some((low, high)) => format!("between {low:.6} and {high:.6} {}", self.unit()),
        };
        format!("{} positions {range}", self.sites.len())
    }

    /// Scale of the a of a reaction.
    pub(crate) fn a_scale(&self, reaction: usize) -> f64 {
        self.scales.a[unit_index(self.reactions[reaction])]
    }

    /// Scale of the b of a reaction.
    pub(crate) fn b_scale(&self, reaction: usize) -> f64 {
        self.scales.b[unit_index(self.reactions[reaction])]
    }

    /// Judges every position, in parallel, with one verdict. What the subject cannot answer is
    /// noted in it.
    pub(crate) fn each_site<F>(&self, judge: F) -> Worst
    where
        F: Fn(&Site, &mut Worst) -> Result<(), SubjectError> + Sync,
    {
        let [worst] = self.each_site_into(|site, [worst]| judge(site, worst));
        worst
    }

    /// The same with several verdicts at once.
    pub(crate) fn each_site_into<const N: usize, F>(&self, judge: F) -> [Worst; N]
    where
        F: Fn(&Site, &mut [Worst; N]) -> Result<(), SubjectError> + Sync,
    {
        let empty = || std::array::from_fn(|_| Worst::default());
        let all: Vec<[Worst; N]> = self
            .sites
            .par_iter()
            .map(|site| {
                let mut worst = empty();
                if let Err(error) = judge(site, &mut worst) {
                    for w in &mut worst {
                        w.refuse(format!("the subject failed to answer: {error}"));
                    }
                }
                worst
            })
            .collect();
        all.into_iter().fold(empty(), |sum, next| {
            let mut next = next.into_iter();
            sum.map(|w| w.merge(next.next().unwrap_or_default()))
        })
    }
}

impl Site {
    fn new(dense: &Dense, subject: &dyn Subject, q: f64) -> Result<Self, String> {
        let failed = |e: DenseError| e.to_string();
        let poses = subject.poses(q).map_err(|e| e.to_string())?;
        let start = dense.start(&poses).map_err(failed)?;
        let row = dense.actuator_row();
        let mut imposed = vec![0.0; row + 1];
        imposed[row] = q;
        let closed = dense.close(&start, &imposed).map_err(failed)?;
        let unit_speeds = dense.unit_speeds(&closed);
        let exact = dense.coefficients(&closed, &unit_speeds);
        let (noise, pose_noise) = noise(dense, &closed, &exact, &unit_speeds).map_err(failed)?;
        let condition = dense.condition(&closed.x);
        let moved: Vec<_> = start.iter().zip(&closed.x).map(|(s, x)| s - x).collect();
        let largest = poses
            .iter()
            .map(|p| p[0].hypot(p[1]))
            .fold(dense.size(), f64::max);
        Ok(Self {
            q,
            moved: dense.reach(&moved) * dense.size() / largest,
            closed,
            unit_speeds,
            exact,
            noise,
            pose_noise,
            condition,
        })
    }

    /// Rounding of an energy relative to itself, which next to a dead point is not the last place.
    pub(crate) fn energy_rounding(&self) -> f64 {
        // Where nothing has a mass the quotient is not a number, and `max` drops it.
        (self.noise.m / self.exact.m).max(f64::EPSILON)
    }

    /// Rounding of a position relative to the mechanism's size.
    pub(crate) fn pose_rounding(&self) -> f64 {
        self.pose_noise.max(f64::EPSILON)
    }

    /// The speeds at q̇ = 1.
    pub fn speed(&self) -> &[f64] {
        self.unit_speeds.last().map_or(&[], Vec::as_slice)
    }
}

/// What rounding does to the coefficients and to the pose.
fn noise(
    dense: &Dense,
    closed: &Closed,
    exact: &Coefficients,
    unit_speeds: &[Vec<f64>],
) -> Result<(Coefficients, f64), DenseError> {
    let flat = |c: &Coefficients| [&[c.m, c.half_dm][..], &c.a, &c.b].concat();
    let (noise, pose) = dense.rounding(closed, unit_speeds, &flat(exact), |there| {
        Ok(flat(&dense.coefficients(there, &dense.unit_speeds(there))))
    })?;
    let (a, b) = noise[2..].split_at(exact.a.len());
    let noise = Coefficients {
        m: noise[0],
        half_dm: noise[1],
        a: a.to_vec(),
        b: b.to_vec(),
    };
    Ok((noise, pose))
}

/// 0 for a force, 1 for a moment.
pub(crate) fn unit_index(reaction: Reaction) -> usize {
    usize::from(reaction.component == Component::Moment)
}

/// Bodies whose share in m is not the same at all positions.
fn varying_bodies(dense: &Dense, sites: &[Site]) -> Vec<usize> {
    let varies = |&body: &usize| {
        let shares = sites
            .iter()
            .map(|s| dense.inertia_of(body, &s.closed, s.speed(), s.speed()));
        let (low, high) = shares.fold((f64::INFINITY, 0.0_f64), |(low, high), share| {
            (low.min(share), high.max(share))
        });
        high - low > CONSTANT * high
    };
    (0..dense.bodies.len()).filter(varies).collect()
}

fn scales(dense: &Dense, sites: &[Site], varying: &[usize], reactions: &[Reaction]) -> Scales {
    let mut s = Scales::default();
    for site in sites {
        let (at, u) = (&site.closed, site.speed());
        s.m = s.m.max(site.exact.m);
        let part: f64 = varying.iter().map(|&b| dense.inertia_of(b, at, u, u)).sum();
        s.m_varying = s.m_varying.max(part);
        s.half_dm = s.half_dm.max(site.exact.half_dm.abs());
        for (k, &reaction) in reactions.iter().enumerate() {
            let kind = unit_index(reaction);
            s.a[kind] = s.a[kind].max(site.exact.a[k].abs());
            s.b[kind] = s.b[kind].max(site.exact.b[k].abs());
        }
    }
    let varying_or_all = if s.m_varying > 0.0 { s.m_varying } else { s.m };
    s.half_dm = s.half_dm.max(B_FLOOR * varying_or_all);
    // τ is a moment, or a force if the coordinate is a length; the other unit has a floor.
    let (tau, other, arm) = match dense.drives_an_angle() {
        true => (1, 0, dense.size()),
        false => (0, 1, 1.0 / dense.size()),
    };
    s.a[tau] = s.a[tau].max(s.m);
    s.b[tau] = s.b[tau].max(s.half_dm);
    s.a[other] = s.a[other].max(FORCE_FLOOR * varying_or_all / arm);
    s.b[other] = s.b[other].max(B_FLOOR * s.a[other]);
    s
}
