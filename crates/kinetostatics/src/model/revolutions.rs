//! The whole revolutions on which loads depend: a torsional spring, or a magnitude that depends on an angle, must have
//! no jump where a body points to −x.

use super::Model;
use crate::error::LoadError;
use dwell_geometry::{AssemblyConfiguration, BodyId, Plan};
use std::f64::consts::TAU;

impl Model {
    /// Compiles the plan again if it does not count the revolutions of the bodies on whose angles the loads depend. The
    /// plan's structure depends on the mechanism alone, so the rest of the model stays valid.
    pub(crate) fn count_load_angles(&mut self) -> Result<(), LoadError> {
        let angle_pairs: Vec<Vec<[BodyId; 2]>> =
            self.loads().iter().map(|l| l.angle_pairs()).collect();
        let uncounted = |pairs: &Vec<[BodyId; 2]>| {
            let mut bodies = pairs.iter().flatten();
            bodies.any(|&body| !self.pass_model.plan.counts_revolutions(body))
        };
        let Some(load) = angle_pairs.iter().position(uncounted) else {
            return Ok(());
        };
        let wrong = |what| LoadError { load, what };
        let assembly = self.assembly_with_angles(&angle_pairs.concat());
        let undefined = wrong("it depends on an angle that has no value at the start");
        let assembly = assembly.ok_or(undefined)?;
        let bodies = angle_pairs.concat().concat();
        let plan = Plan::compile_counting_revolutions(&self.mechanism, &assembly, &bodies);
        let uncounted = "it depends on an angle whose whole revolutions cannot be counted";
        self.pass_model.plan = plan.map_err(|_| wrong(uncounted))?;
        Ok(())
    }

    /// The assembly with an initial angle for each body of these pairs: nearest to its own initial guess, or else
    /// within half a revolution of the other's; `None` if there is no pose.
    fn assembly_with_angles(&self, pairs: &[[BodyId; 2]]) -> Option<AssemblyConfiguration> {
        let mut assembly = self.assembly.clone();
        let plan = self.plan();
        let mut pose = plan.pose::<f64>();
        plan.positions(&assembly.q, &mut pose).ok()?;
        let nearest_angle = |body: BodyId, to: f64| {
            let angle = plan.body_angle(body, &pose);
            angle + TAU * ((to - angle) / TAU).round()
        };
        for &[one, two] in pairs {
            let initial_angle = |body: BodyId| {
                if plan.counts_revolutions(body) {
                    return Some(plan.body_angle(body, &pose));
                }
                assembly.initial_guess[body.0].map(|guess| nearest_angle(body, guess))
            };
            let (first, second) = match (initial_angle(one), initial_angle(two)) {
                (None, Some(second)) => (nearest_angle(one, second), second),
                (first, second) => {
                    let first = first.unwrap_or_else(|| nearest_angle(one, 0.0));
                    (first, second.unwrap_or_else(|| nearest_angle(two, first)))
                }
            };
            for (body, angle) in [(one, first), (two, second)] {
                if !plan.counts_revolutions(body) {
                    assembly.initial_guess[body.0] = Some(angle);
                }
            }
        }
        Some(assembly)
    }
}
