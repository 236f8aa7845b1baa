//! The poses of several coordinates: continued from the assembly along a straight line, far from it by way of stations that are
//! remembered. The cost of a pose does not grow with its distance where the motion has come along.

use super::follow::SAME;
use super::plan::{Plan, Pose};
use super::vector::Rotation;
use crate::error::PositionError;
use dwell_numerics::Scalar;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::OnceLock;

/// Largest step of each of several coordinates on the way from the assembly, rad or m.
const STEP: f64 = 0.05;
/// Largest number of steps on this line; the steps become longer if more would be needed.
const MAX_STEPS: f64 = 1e4;
/// Farther from the assembly the way is remembered.
const FAR: f64 = 20.0 * STEP;
/// Poses that are remembered on it, then they are forgotten.
const MAX_STATIONS: usize = 20_000;
impl Plan {
    /// The pose of several coordinates: along the straight line from those of the assembly.
    pub(super) fn continue_to<T: Scalar>(
        &self,
        q: &[T],
        pose: &mut Pose<T>,
    ) -> Result<(), PositionError> {
        let from = &self.assembly_q;
        if self.groups.is_empty() {
            // Nothing has to be followed.
            self.start_from(&self.start, 0.0, pose);
            return self.close(q, None, pose);
        }
        let span = q
            .iter()
            .zip(from)
            .map(|(q, a)| (q.value() - a).abs())
            .fold(0.0, f64::max);
        if span > FAR && self.continue_by_stations(q, pose).is_ok() {
            return Ok(());
        }
        let count = (span / STEP).ceil().clamp(1.0, MAX_STEPS);
        let mut real = self.pose::<f64>();
        self.start_from(&self.start, 0.0, &mut real);
        for k in 1..=count as usize {
            let part = k as f64 / count;
            let at: Vec<f64> = q
                .iter()
                .zip(from)
                .map(|(q, a)| a + part * (q.value() - a))
                .collect();
            self.close(&at, None, &mut real)?;
        }
        take_freedoms(&real, pose);
        self.close(q, None, pose)
    }

    /// The pose, continued from the preceding station, from which a motion along the lattice needs only one more step.
    fn continue_by_stations<T: Scalar>(
        &self,
        q: &[T],
        pose: &mut Pose<T>,
    ) -> Result<(), PositionError> {
        // Whole revolutions after which all bodies stand where they stood need not be followed.
        let ends = || q.iter().zip(&self.assembly_q);
        let turned = ends().enumerate().map(|(i, (q, a))| {
            let turns = ((q.value() - a) / TAU).round();
            let revolution = (turns != 0.0).then(|| self.revolution(i))?;
            revolution.map(|gains| (turns, gains))
        });
        let turned: Vec<Option<(f64, &Revolution)>> = turned.collect();
        let ahead = ends().zip(&turned).map(|((q, a), turned)| {
            let turns = turned.map_or(0.0, |(turns, _)| turns);
            q.value() - a - turns * TAU
        });
        let ahead: Vec<f64> = ahead.collect();
        let span = ahead.iter().fold(0.0, |max: f64, part| max.max(part.abs()));
        let doubled = (span / (STEP * MAX_STEPS)).log2().ceil().max(0.0);
        let unit = STEP * doubled.exp2();
        // Towards the assembly.
        let place = ahead.iter().map(|part| (part / unit) as i32).collect();
        let mut stations = std::mem::take(&mut pose.stations);
        let reached = self.reach_station(place, unit, &mut stations);
        if let (Ok(()), Some(real)) = (&reached, &stations.pose) {
            take_freedoms(real, pose);
            for (turns, gains) in turned.into_iter().flatten() {
                let gains = gains.iter().zip(&mut pose.coordinates);
                gains.for_each(|(gain, freedom)| *freedom += T::from_f64(turns * gain));
            }
        }
        pose.stations = stations;
        reached?;
        self.close(q, None, pose)
    }

    /// A revolution of one of several coordinates from the assembly, if all bodies return to their positions.
    fn revolution(&self, actuator: usize) -> Option<&Revolution> {
        let found = self.revolutions.0.get(actuator)?;
        found
            .get_or_init(|| self.find_revolution(actuator))
            .as_ref()
    }

    fn find_revolution(&self, actuator: usize) -> Option<Revolution> {
        if !self.is_angle(actuator) {
            return None;
        }
        let (mut start, mut q) = (self.pose(), self.assembly_q.clone());
        self.start_from(&self.start, 0.0, &mut start);
        self.close(&q, None, &mut start).ok()?;
        let mut pose = start.clone();
        let steps = (TAU / STEP).ceil();
        for k in 1..=steps as usize {
            q[actuator] = self.assembly_q[actuator] + TAU * k as f64 / steps;
            self.close(&q, None, &mut pose).ok()?;
        }
        let ends = pose.coordinates.iter().zip(&start.coordinates);
        let returns = self.moved_by(&start.frames, &pose.frames) < SAME;
        returns.then(|| ends.map(|(to, from)| to - from).collect())
    }

    /// Leaves a station's pose in the memory: from the last known one on the straight line of stations from the assembly.
    fn reach_station(
        &self,
        mut place: Vec<i32>,
        unit: f64,
        stations: &mut Stations,
    ) -> Result<(), PositionError> {
        if stations.unit != unit {
            stations.known.clear();
            stations.unit = unit;
        }
        let mut ahead = Vec::new();
        while place.iter().any(|k| *k != 0) && !stations.known.contains_key(&place) {
            let next = towards_assembly(&place);
            ahead.push(std::mem::replace(&mut place, next));
        }
        let real = stations.pose.get_or_insert_with(|| Box::new(self.pose()));
        match stations.known.get(&place) {
            Some((coordinates, balls)) => {
                real.coordinates.clone_from(coordinates);
                real.balls.clone_from(balls);
            }
            None => self.start_from(&self.start, 0.0, real),
        }
        while let Some(place) = ahead.pop() {
            let from = self.assembly_q.iter().zip(&place);
            let at: Vec<f64> = from.map(|(a, k)| a + f64::from(*k) * unit).collect();
            self.close(&at, None, real)?;
            if stations.known.len() >= MAX_STATIONS {
                stations.known.clear();
            }
            let found = (real.coordinates.clone(), real.balls.clone());
            stations.known.insert(place, found);
        }
        Ok(())
    }
}

/// By freedom: its change in a revolution of a coordinate.
type Revolution = Vec<f64>;

/// By coordinate: its revolution if there is one, computed when a pose half a revolution away is first requested. They follow from the
/// rest of a plan, so comparisons of plans ignore them.
#[derive(Debug, Clone, Default)]
pub(super) struct Revolutions(pub(super) Vec<OnceLock<Option<Revolution>>>);

impl PartialEq for Revolutions {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// The poses of several coordinates by their places in a lattice about the assembly. Each depends on its place alone, so that a pose
/// does not depend on earlier evaluations.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Stations {
    /// Distance of neighbouring stations, rad or m.
    unit: f64,
    known: BTreeMap<Vec<i32>, (Vec<f64>, Vec<Rotation>)>,
    pose: Option<Box<Pose>>,
}

/// Sets the freedoms of a pose to those of another.
fn take_freedoms<T: Scalar>(from: &Pose, pose: &mut Pose<T>) {
    for (to, from) in pose.coordinates.iter_mut().zip(&from.coordinates) {
        *to = T::from_f64(*from);
    }
    for (to, from) in pose.balls.iter_mut().zip(&from.balls) {
        *to = from.cast();
    }
}

/// The next place on the straight line to the assembly, by one unit of the largest coordinate.
fn towards_assembly(place: &[i32]) -> Vec<i32> {
    let largest = place.iter().map(|k| k.abs()).max().unwrap_or(0);
    let part = f64::from(largest - 1) / f64::from(largest.max(1));
    let shorter = place.iter().map(|k| (f64::from(*k) * part).round() as i32);
    shorter.collect()
}

#[cfg(test)]
mod tests {
    use super::super::joint_kinds::JointKind;
    use super::super::mechanism::{Actuator, Assembly, Joint, Mechanism, Side};
    use super::super::plan::{Plan, Pose};
    use super::super::vector::{Vec3, vec3};
    use super::MAX_STATIONS;
    use crate::Body;
    use std::f64::consts::TAU;

    /// An RSSR, and a pendulum on its crank.
    fn two_coordinates() -> Plan {
        let side = |point, axis: Vec3| Side {
            point,
            axis,
            normal: axis.any_normal(),
        };
        let [_, y, z] = Vec3::AXES;
        let joint = |name: &str, bodies, kind, point, axis| {
            Joint::new(name, bodies, kind, [side(point, axis), side(point, axis)])
        };
        let b = vec3(0.1, 0.0, 0.0);
        let mechanism = Mechanism {
            bodies: ["ground", "crank", "coupler", "rocker", "bob"]
                .map(Body::named)
                .into(),
            ground: 0,
            joints: vec![
                joint("A", [0, 1], JointKind::Revolute, Vec3::ZERO, z),
                joint("B", [1, 2], JointKind::Spherical, b, z),
                joint("C", [2, 3], JointKind::Spherical, vec3(0.15, 0.15, 0.2), z),
                joint("D", [0, 3], JointKind::Revolute, vec3(0.25, 0.06, -0.04), y),
                joint("P", [1, 4], JointKind::Revolute, b, z),
            ],
            actuators: vec![Actuator::angle("phi", 0), Actuator::angle("psi", 4)],
            couplings: Vec::new(),
        };
        Plan::compile(&mechanism, &Assembly::at(&[0.0; 2])).expect("a plan")
    }

    fn at(plan: &Plan, q: [f64; 2], pose: &mut Pose) -> Vec<f64> {
        plan.positions(&q, pose).expect("a position");
        pose.coordinates.clone()
    }

    /// A pose does not depend on earlier evaluations, bit for bit, and a hundred revolutions store no more stations than one.
    #[test]
    fn poses_depend_on_their_coordinates_alone() {
        let plan = two_coordinates();
        let (mut pose, mut known) = (plan.pose::<f64>(), Vec::new());
        for k in 0..20_000 {
            let phi = 0.03 * f64::from(k);
            let q = [phi, (0.7 * phi).sin() - 0.9 * phi];
            let here = at(&plan, q, &mut pose);
            if k % 500 == 0 {
                let fresh = at(&plan, q, &mut plan.pose());
                assert_eq!(here, fresh, "{q:?}");
                known.push(pose.stations.known.len());
            }
        }
        let last = known[known.len() - 1];
        assert!(last < MAX_STATIONS && last > 100, "{known:?}");
    }

    /// Far away the pose is that of the same position within the first revolution, with its revolutions counted.
    #[test]
    fn whole_revolutions_return_to_the_same_pose() {
        let plan = two_coordinates();
        let (mut pose, mut near_pose) = (plan.pose::<f64>(), plan.pose());
        for k in 1..40 {
            let near = [0.15 * f64::from(k) - 3.0, 2.5 - 0.13 * f64::from(k)];
            let far = [near[0] + 30.0 * TAU, near[1] - 7.0 * TAU];
            plan.positions(&far, &mut pose).expect("a position");
            plan.positions(&near, &mut near_pose).expect("a position");
            assert!(
                plan.moved_by(&near_pose.frames, &pose.frames) < 1e-12,
                "{k}"
            );
        }
    }
}
