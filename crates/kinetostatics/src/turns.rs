//! The whole turns that loads feel: a torsional spring, or a magnitude that an angle commands, must
//! have no jump where a body points to −x.

use crate::acts::LoadError;
use crate::model::Model;
use dwell_geometry::{BodyId, Mechanism, Plan, Start};
use std::f64::consts::TAU;

impl Model {
    /// Has the plan count the turns of the bodies whose angles the loads feel. Its structure hangs
    /// on the mechanism alone, so all else of the model stays as it is.
    pub(crate) fn count_felt(&mut self, mechanism: &Mechanism) -> Result<(), LoadError> {
        let felt: Vec<Vec<[BodyId; 2]>> = self.loads().iter().map(|l| l.angles()).collect();
        let uncounted = |pairs: &Vec<[BodyId; 2]>| {
            let mut bodies = pairs.iter().flatten();
            bodies.any(|&body| !self.plan.counts_turns(body))
        };
        let Some(load) = felt.iter().position(uncounted) else {
            return Ok(());
        };
        let wrong = |what| LoadError { load, what };
        let start = self.told(&felt.concat());
        let start = start.ok_or(wrong("it feels an angle that has no value at the start"))?;
        let bodies = felt.concat().concat();
        self.plan = Plan::compile_counting(mechanism, &start, &bodies)
            .map_err(|_| wrong("it feels an angle whose whole turns cannot be counted"))?;
        Ok(())
    }

    /// The start with an angle for each body of these pairs: as its rough angle says, or else within
    /// half a turn of the other's; none where there is no pose.
    fn told(&self, pairs: &[[BodyId; 2]]) -> Option<Start> {
        let mut start = self.start.clone();
        let mut pose = self.plan.pose::<f64>();
        self.plan.place(&start.q, &mut pose).ok()?;
        let near = |body: BodyId, to: f64| {
            let angle = self.plan.body_angle(body, &pose);
            angle + TAU * ((to - angle) / TAU).round()
        };
        for &[one, two] in pairs {
            let said = |body: BodyId| {
                if self.plan.counts_turns(body) {
                    return Some(self.plan.body_angle(body, &pose));
                }
                start.rough[body.0].map(|rough| near(body, rough))
            };
            let (first, second) = match (said(one), said(two)) {
                (None, Some(second)) => (near(one, second), second),
                (first, second) => {
                    let first = first.unwrap_or_else(|| near(one, 0.0));
                    (first, second.unwrap_or_else(|| near(two, first)))
                }
            };
            for (body, angle) in [(one, first), (two, second)] {
                if !self.plan.counts_turns(body) {
                    start.rough[body.0] = Some(angle);
                }
            }
        }
        Some(start)
    }
}
