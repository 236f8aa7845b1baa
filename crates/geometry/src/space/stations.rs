//! The poses of several coordinates: continued from the assembly along a straight line, far from it by way of stations that are
//! remembered. The cost of a pose does not grow with its distance where the motion has come along.

use super::plan::{Plan, Pose};
use super::vector::Rotation;
use crate::error::PositionError;
use dwell_numerics::Scalar;
use std::collections::BTreeMap;

/// Largest step of each of several coordinates on the way from the assembly, rad or m.
const STEP: f64 = 0.05;
/// Steps of that way; they are longer where there were more.
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
        if span > FAR && self.continue_by_stations(q, span, pose).is_ok() {
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

    /// The same by way of the station before it, which a motion along it reaches with one step more.
    fn continue_by_stations<T: Scalar>(
        &self,
        q: &[T],
        span: f64,
        pose: &mut Pose<T>,
    ) -> Result<(), PositionError> {
        let doubled = (span / (STEP * MAX_STEPS)).log2().ceil().max(0.0);
        let unit = STEP * doubled.exp2();
        let ends = q.iter().zip(&self.assembly_q);
        // Towards the assembly.
        let place = ends.map(|(q, a)| ((q.value() - a) / unit) as i32).collect();
        let mut stations = std::mem::take(&mut pose.stations);
        let reached = self.reach_station(place, unit, &mut stations);
        if let (Ok(()), Some(real)) = (&reached, &stations.pose) {
            take_freedoms(real, pose);
        }
        pose.stations = stations;
        reached?;
        self.close(q, None, pose)
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

/// The poses of several coordinates by their places in a lattice about the assembly. Each depends on its place alone, so that a pose
/// does not depend on what was evaluated before.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Stations {
    /// Between two of them, rad or m.
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
