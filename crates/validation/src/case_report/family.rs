//! The family of mechanisms that meet what a source states in words: numbers that it does not give are drawn, those
//! members are kept that stand still long enough, and the calibrated number is fitted to the stated period in each.
//!
//! The draws are the multiples of square roots of primes without their whole parts (Weyl), which fill the box of all
//! numbers evenly and are the same on every machine.

use super::dwell::{Dwell, RangePoses, requested_dwell};
use crate::error::ValidationError;
use dwell_dynamics::{Orbit, ReducedState};
use dwell_geometry::Range;
use dwell_kinetostatics::ReducedModel;
use dwell_scene::{Calibration, PlaneScene};
use dwell_study::{PreparedScene, find_value};
use rayon::prelude::*;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// The file beside the scene.
const FILE: &str = "family.toml";
/// Intervals of a revolution at which a member is computed.
const INTERVALS: usize = 360;
/// One for each number that is drawn.
const PRIMES: [f64; 12] = [
    2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0,
];

/// What the file says.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct Description {
    /// Number of draws.
    pub(super) draws: usize,
    /// The shortest dwell of a member, degrees of the crank.
    pub(super) shortest_dwell: f64,
    /// What is drawn.
    pub(super) drawn: Vec<DrawnNumber>,
}

/// A number that the source does not give.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DrawnNumber {
    /// What it is, in words.
    pub(super) name: String,
    /// The smallest and the largest factor by which it is multiplied.
    pub(super) factors: [f64; 2],
    /// By path of a number in the scene: the power of the factor that it grows with.
    powers: BTreeMap<String, i32>,
}

/// The members of a family, and those drawn that are none.
pub(super) struct Family {
    /// What is drawn.
    pub(super) described: Description,
    /// Draws that cannot be assembled over a whole revolution, whose dwelling body is no rocker, that stand still for a
    /// shorter time, and for which no value of the calibrated number gives the period.
    pub(super) left_out: [usize; 4],
    /// The scene itself, fitted to the period.
    pub(super) reconstruction: Member,
    /// All other mechanisms.
    pub(super) members: Vec<Member>,
}

/// A mechanism that meets the source.
pub(super) struct Member {
    /// The fitted number, in the unit of the scene.
    pub(super) calibrated: f64,
    /// Its dwell.
    pub(super) dwell: Dwell,
    /// Its motion over one revolution: the first row is its start.
    pub(super) rows: Vec<MemberRow>,
}

/// A member's free motion at one position.
#[derive(Debug, Clone, Copy)]
pub(super) struct MemberRow {
    /// Coordinate, rad.
    pub(super) q: f64,
    /// Time, s.
    pub(super) t: f64,
    /// Velocity, rad/s.
    pub(super) q_dot: f64,
    /// Generalised inertia and half its derivative, kg m².
    pub(super) m: f64,
    pub(super) half_dm: f64,
    /// The first requested reaction.
    pub(super) reaction: f64,
}

/// What a draw that is no member lacks; in the order of [`Family::left_out`].
#[derive(Debug, Clone, Copy)]
enum LeftOut {
    Revolution,
    Rocker,
    Dwell,
    Period,
}

impl Family {
    /// The family that the file beside a scene describes, if there is one, and the scene says what is calibrated.
    ///
    /// # Errors
    /// [`ValidationError::Reference`] when the file cannot be read, or names a number that the scene does not have.
    pub(super) fn read(folder: &Path, scene: &PlaneScene) -> Result<Option<Self>, ValidationError> {
        let path = folder.join(FILE);
        let refuse = |reason: String| ValidationError::Reference {
            path: path.display().to_string(),
            reason,
        };
        let Some(calibration) = &scene.calibration else {
            return Ok(None);
        };
        if !path.exists() {
            return Ok(None);
        }
        let text = std::fs::read_to_string(&path).map_err(|e| refuse(e.to_string()))?;
        let described: Description = toml::from_str(&text).map_err(|e| refuse(e.to_string()))?;
        if described.drawn.len() > PRIMES.len() {
            let limit = PRIMES.len();
            return Err(refuse(format!("at most {limit} numbers can be drawn")));
        }
        for number in described.drawn.iter().flat_map(|d| d.powers.keys()) {
            scene.value(number).map_err(|e| refuse(e.to_string()))?;
        }
        let member = |scene: &PlaneScene| Member::new(scene, calibration, described.shortest_dwell);
        let reconstruction = member(scene)
            .map_err(|why| refuse(format!("the scene itself is no member: {why:?}")))?;
        let drawn = (0..described.draws).into_par_iter().map(|k| {
            let varied = described.varied(scene, k).ok_or(LeftOut::Revolution)?;
            member(&varied)
        });
        let mut left_out = [0; 4];
        let mut members = Vec::new();
        for draw in drawn.collect::<Vec<_>>() {
            match draw {
                Ok(member) => members.push(member),
                Err(why) => left_out[why as usize] += 1,
            }
        }
        Ok(Some(Self {
            described,
            left_out,
            reconstruction,
            members,
        }))
    }
}

impl Description {
    /// The scene with the numbers of a draw; none where it cannot be assembled.
    fn varied(&self, scene: &PlaneScene, draw: usize) -> Option<PlaneScene> {
        let mut values: BTreeMap<&str, f64> = BTreeMap::new();
        for (number, prime) in self.drawn.iter().zip(PRIMES) {
            let [from, to] = number.factors;
            let part = ((draw + 1) as f64 * prime.sqrt()).fract();
            let factor = from + (to - from) * part;
            for (path, power) in &number.powers {
                let value = values
                    .entry(path.as_str())
                    .or_insert(scene.value(path).ok()?);
                *value *= factor.powi(*power);
            }
        }
        let values: Vec<(&str, f64)> = values.into_iter().collect();
        scene.with_values(&values).ok()
    }
}

impl Member {
    /// The member of a scene, unless it is none.
    fn new(
        scene: &PlaneScene,
        calibration: &Calibration,
        shortest_dwell: f64,
    ) -> Result<Self, LeftOut> {
        let dwell = {
            let prepared = PreparedScene::new(scene).map_err(|_| LeftOut::Revolution)?;
            if prepared.model.range() != Range::Full {
                return Err(LeftOut::Revolution);
            }
            let poses = RangePoses::new(&prepared).map_err(|_| LeftOut::Revolution)?;
            requested_dwell(&prepared, &poses).ok_or(LeftOut::Dwell)?
        };
        if dwell.swing >= PI {
            return Err(LeftOut::Rocker);
        }
        if (dwell.to - dwell.from).to_degrees() < shortest_dwell {
            return Err(LeftOut::Dwell);
        }
        let (path, period) = (&calibration.path, calibration.period);
        let fitted = find_value(scene, path, period).map_err(|_| LeftOut::Period)?;
        let fitted_scene = scene.with_value(path, fitted.value);
        let fitted_scene = fitted_scene.map_err(|_| LeftOut::Period)?;
        let prepared = PreparedScene::new(&fitted_scene).map_err(|_| LeftOut::Period)?;
        let start = prepared.initial_state().ok_or(LeftOut::Period)?;
        let rows = revolution(&prepared, start).ok_or(LeftOut::Period)?;
        Ok(Self {
            calibrated: fitted.value,
            dwell,
            rows,
        })
    }

    /// Generalised inertia at the start, kg m².
    pub(super) fn start_inertia(&self) -> f64 {
        self.rows[0].m
    }

    /// The row in which a value is largest.
    pub(super) fn row_of_largest(&self, value: impl Fn(&MemberRow) -> f64) -> MemberRow {
        let rows = self.rows.iter().copied();
        let largest = rows.max_by(|a, b| value(a).total_cmp(&value(b)));
        largest.unwrap_or(self.rows[0])
    }
}

/// The value that a part (0 to 1) of sorted values does not exceed.
pub(super) fn part_below(sorted: &[f64], part: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    let nearest = (part * last as f64).round() as usize;
    sorted.get(nearest).copied().unwrap_or(f64::NAN)
}

/// The free motion over one revolution from its start: the velocity by the energy, the time by quadrature, the reaction by
/// R = a q̈ + b q̇².
fn revolution(prepared: &PreparedScene<'_>, start: ReducedState) -> Option<Vec<MemberRow>> {
    let model = &prepared.model;
    let orbit = Orbit::new(model, start).ok()?;
    let (mut at, mut workspace) = (model.model().coefficient_buffer(), model.workspace());
    let mut rows = Vec::with_capacity(INTERVALS + 1);
    for k in 0..=INTERVALS {
        let turned = TAU * k as f64 / INTERVALS as f64;
        let q = start.q + turned * start.q_dot.signum();
        model.coefficients(q, &mut workspace, &mut at).ok()?;
        let q_dot = start.q_dot.signum() * (2.0 * orbit.energy / at.m).sqrt();
        let q_ddot = -at.half_dm * q_dot * q_dot / at.m;
        let reaction = at.a.first().zip(at.b.first());
        rows.push(MemberRow {
            q,
            t: match k {
                INTERVALS => start.t + orbit.period,
                _ => orbit.time_at(q)?,
            },
            q_dot,
            m: at.m,
            half_dm: at.half_dm,
            reaction: reaction.map_or(f64::NAN, |(a, b)| a * q_ddot + b * q_dot * q_dot),
        });
    }
    Some(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn single_dwell() -> (std::path::PathBuf, PlaneScene) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/single-dwell");
        let scene = PlaneScene::read(folder.join("scene.toml")).expect("the scene");
        (folder, scene)
    }

    /// Every member's free motion, integrated as time over the angle by the trapezoidal rule on the rows themselves, takes
    /// the stated period, and starts with the stated velocity.
    #[test]
    fn every_member_has_the_stated_period() {
        let (folder, scene) = single_dwell();
        let family = Family::read(&folder, &scene)
            .expect("a family")
            .expect("a file");
        let kept = family.members.len();
        let Description {
            draws,
            shortest_dwell,
            ..
        } = family.described;
        assert!(kept >= 30, "{kept} members of {draws} draws");
        assert_eq!(kept + family.left_out.iter().sum::<usize>(), draws);
        for member in family.members.iter().chain([&family.reconstruction]) {
            assert_eq!(member.rows[0].q_dot, 1.0);
            let rows = &member.rows[..INTERVALS];
            let period: f64 = rows
                .iter()
                .map(|row| TAU / INTERVALS as f64 / row.q_dot)
                .sum();
            assert!((period - 5.42).abs() < 1e-9, "{period}");
            let dwell = (member.dwell.to - member.dwell.from).to_degrees();
            assert!(dwell >= shortest_dwell);
        }
    }

    /// Masses multiplied by two, and lengths by three, change no velocity: m grows with the mass and the square of the
    /// length, the force in the slide with the mass and the length. So neither scale follows from the period.
    #[test]
    fn the_scales_of_mass_and_length_change_no_velocity() {
        let (_, scene) = single_dwell();
        let moving = ["crank", "coupler", "rocker", "guide", "slider"];
        let calibration = scene.calibration.clone().expect("a calibration");
        let own = Member::new(&scene, &calibration, 90.0).expect("a member");
        let mut values = Vec::new();
        for body in moving {
            for (key, factor) in [("mass", 2.0), ("inertia", 2.0 * 9.0)] {
                let number = format!("{body}.{key}");
                if let Ok(value) = scene.value(&number) {
                    values.push((number, value * factor));
                }
            }
        }
        let lengths = [
            "ground.points.O[0]",
            "ground.points.Q[0]",
            "ground.points.Q[1]",
            "crank.points.B[0]",
            "coupler.points.C[0]",
            "coupler.points.P[0]",
            "rocker.points.C[0]",
            "rocker.center[0]",
            "guide.points.end[0]",
            "guide.center[0]",
        ];
        for number in lengths {
            values.push((number.to_owned(), 3.0 * scene.value(number).expect(number)));
        }
        let values: Vec<(&str, f64)> = values.iter().map(|(n, v)| (n.as_str(), *v)).collect();
        let scaled = scene.with_values(&values).expect("a scene");
        let scaled = Member::new(&scaled, &calibration, 90.0).expect("a member");
        for (a, b) in own.rows.iter().zip(&scaled.rows) {
            assert!((a.q_dot - b.q_dot).abs() < 1e-12);
            assert!((18.0 * a.m - b.m).abs() < 1e-11 * b.m);
            assert!((6.0 * a.reaction - b.reaction).abs() < 1e-10);
        }
    }
}
