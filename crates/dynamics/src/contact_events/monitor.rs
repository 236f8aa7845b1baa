//! Locates the events of contacts during an integration: surfaces that come to rest, and forces of sticking surfaces that
//! reach their limit. Each is the zero of a margin,
//!
//! ```text
//! ±v of surfaces that slide,    1 − |F|/(µₛ g) of surfaces that hold
//! distance from an end stop,     the force that keeps a coordinate on its stop
//! ```
//!
//! on the dense output: the modes are held within a step, so that everything is smooth, and a step may lead beyond.
//!
//! If the force that keeps a coordinate q on its stop passes zero at t₁, the coordinate leaves with q̈ = 0:
//!
//! ```text
//! q − q₁ = ½ q̈(t₁)(t − t₁)² + ⅙ q⃛ (t − t₁)³ + …,    q̈(t₁) = 0 but for rounding,    q⃛ > 0                       (1)
//! ```
//!
//! so that at first its distance is below the error of the method, and the sign of the computed distance is meaningless.
//! The sign of q̈ after t₁ decides: as long as q̈ leads away from the stop, there is no contact.

use crate::contact::ContactStep;
use crate::crossings::{are_together, fall_below_zero, first_inside, first_of};
use crate::error::Result;
use crate::ode::{OdeState, OdeSystem, Step};
use dwell_numerics::root;

/// How many events that happen together count as one without end.
const MAX_TOGETHER: usize = 64;
/// Number of events of a contact at one time after which they count as endless.
const REPEATED: usize = 8;
/// A margin below this is beyond its limit where a motion begins.
const BEYOND: f64 = 1e-12;

/// Watches the contacts of a system during its integration.
pub(crate) struct ContactMonitor {
    margins: Vec<Margin>,
    values: Vec<f64>,
    /// When the last event was, and how many happened then.
    last: (f64, usize),
    /// The length of the motion, s.
    span: f64,
}

/// The margin of a contact.
#[derive(Debug, Clone, Copy)]
struct Margin {
    /// The margins at the last points of the step, the latest first.
    points: [(f64, f64); 2],
    /// The largest in the step.
    largest: f64,
    /// Whether it was positive since the integration began: surfaces that have just let go have no speed yet.
    is_inside: bool,
    /// For a coordinate that leaves its stop from rest, by (1): the index of its speed in the state, and the sign of the
    /// direction away from the stop.
    leaving: Option<(usize, f64)>,
}

impl ContactMonitor {
    /// None for a system without contacts.
    pub(crate) fn new(system: &dyn OdeSystem, span: f64) -> Option<Self> {
        let count = system.contact_count();
        let margin = Margin {
            points: [(f64::NAN, f64::NAN); 2],
            largest: 0.0,
            is_inside: false,
            leaving: None,
        };
        (count > 0).then(|| Self {
            margins: vec![margin; count],
            values: vec![0.0; count],
            last: (f64::NEG_INFINITY, 0),
            span,
        })
    }

    /// Decides the undecided modes at the start of an integration, and those that another load or drive has changed.
    ///
    /// # Errors
    /// [`DynamicsError`] where no mode is found, or the state cannot be evaluated.
    pub(crate) fn settle(&mut self, system: &mut dyn OdeSystem, at: &mut OdeState) -> Result<()> {
        self.begin_anew();
        let is_open = system.contact_margins(at.t, &at.y, &mut self.values)?;
        // A margin that is not a number is none.
        let touched: Vec<bool> = self.values.iter().map(|margin| *margin < -BEYOND).collect();
        if !is_open && !touched.contains(&true) {
            return self.find_leaving(system, at, None);
        }
        self.change_modes(system, at, &touched)
    }

    /// Discards the margins, which are invalid for other modes and other pieces.
    fn begin_anew(&mut self) {
        for margin in &mut self.margins {
            margin.is_inside = false;
            margin.points = [(f64::NAN, f64::NAN); 2];
        }
    }

    /// The first event in a step.
    ///
    /// # Errors
    /// Where a state cannot be evaluated.
    pub(crate) fn first_event(
        &mut self,
        system: &mut dyn OdeSystem,
        step: &mut Step<'_>,
    ) -> Result<Option<(OdeState, Vec<bool>)>> {
        let before = step.before;
        // Most steps begin where the last one has ended, whose margins are known.
        let is_known = |margin: &Margin| margin.points[0].0 == before.t;
        if self.margins.iter().all(is_known) {
            for (value, margin) in self.values.iter_mut().zip(&self.margins) {
                *value = margin.points[0].1;
            }
        } else {
            system.contact_margins(before.t, &before.y, &mut self.values)?;
        }
        for (margin, &value) in self.margins.iter_mut().zip(&self.values) {
            margin.points = [(before.t, value), (f64::NAN, f64::NAN)];
            margin.largest = value.abs();
            margin.is_inside |= value > 0.0 && margin.leaving.is_none();
        }
        for t in step.root_subintervals() {
            let point = step.state_at(t)?;
            system.contact_margins(t, &point.y, &mut self.values)?;
            let each = 0..self.margins.len();
            let times = each.map(|k| Ok(self.crossing(k, t, system, step)?.map(|at| (at, k))));
            if let Some((at, all)) = first_of(times)? {
                let touched = (0..self.margins.len()).map(|k| all.contains(&k));
                return Ok(Some((step.state_from_start(at)?, touched.collect())));
            }
        }
        Ok(None)
    }

    /// When the margin of a contact becomes negative between the last point of the step and `t`.
    fn crossing(
        &mut self,
        k: usize,
        t: f64,
        system: &mut dyn OdeSystem,
        step: &mut Step<'_>,
    ) -> Result<Option<f64>> {
        let value = self.values[k];
        if self.is_leaving(k, t, system, step)? {
            let margin = &mut self.margins[k];
            margin.points = [(t, value), margin.points[0]];
            return Ok(None);
        }
        let margin = &mut self.margins[k];
        let earlier = margin.points;
        margin.points = [(t, value), earlier[0]];
        margin.largest = margin.largest.max(value.abs());
        let was_inside = margin.is_inside;
        margin.is_inside |= value > 0.0;
        let mut values = Vec::new();
        let mut margin_at = |at: f64| -> Result<f64> {
            let state = step.state_from_start(at)?;
            values.resize(self.values.len(), 0.0);
            system.contact_margins(at, &state.y, &mut values)?;
            Ok(values[k])
        };
        if value < 0.0 && !was_inside {
            let start = earlier[0].0;
            return match first_inside([start, t], &mut margin_at)? {
                Some([inside, until]) => root::find(margin_at, inside, until),
                None => Ok(Some(start)),
            };
        }
        fall_below_zero(earlier, (t, value), margin_at)
    }

    /// Finds the coordinates that leave their stops from rest: those that a force of zero releases, and those that no force
    /// holds. Coordinates that already leave continue to do so if no mode has changed.
    fn find_leaving(
        &mut self,
        system: &mut dyn OdeSystem,
        at: &OdeState,
        touched: Option<&[bool]>,
    ) -> Result<()> {
        let mut rates = Vec::new();
        for (k, margin) in self.margins.iter_mut().enumerate() {
            if margin.leaving.is_some() && touched.is_none() {
                continue;
            }
            margin.leaving = system.speed_at_stop(k, &at.y);
            let is_touched = touched.is_some_and(|touched| touched[k]);
            let Some((speed, away)) = margin.leaving.filter(|_| !is_touched) else {
                continue;
            };
            if rates.is_empty() {
                rates.resize(at.y.len(), 0.0);
                system.rhs(at.t, &at.y, &mut rates)?;
            }
            // What is pushed onto its stop comes to rest there.
            margin.leaving = margin.leaving.filter(|_| away * rates[speed] >= 0.0);
        }
        Ok(())
    }

    /// Whether a coordinate still leaves its stop at a time `t` of the step, by (1): its acceleration leads away from it.
    fn is_leaving(
        &mut self,
        k: usize,
        t: f64,
        system: &mut dyn OdeSystem,
        step: &mut Step<'_>,
    ) -> Result<bool> {
        let margin = &mut self.margins[k];
        let Some((speed, away)) = margin.leaving else {
            return Ok(false);
        };
        let state = step.state_at(t)?;
        let mut rates = vec![0.0; state.y.len()];
        system.rhs(t, &state.y, &mut rates)?;
        let leaves = away * rates[speed] > 0.0;
        if !leaves {
            margin.leaving = None;
        }
        Ok(leaves)
    }

    /// Changes the modes where an event has ended an integration.
    ///
    /// # Errors
    /// [`DynamicsError`] where no mode is found, or events without end happen there.
    pub(crate) fn change_modes(
        &mut self,
        system: &mut dyn OdeSystem,
        at: &mut OdeState,
        touched: &[bool],
    ) -> Result<()> {
        let together = are_together(at.t, self.last.0);
        self.last = (at.t, if together { self.last.1 + 1 } else { 0 });
        if self.last.1 > MAX_TOGETHER {
            let first = touched.iter().position(|touched| *touched);
            return Err(system.contact_without_mode(first.unwrap_or(0)));
        }
        let largest: Vec<f64> = self.margins.iter().map(|margin| margin.largest).collect();
        let step = ContactStep {
            largest_speeds: &largest,
            touched,
            span: self.span,
            repeated: self.last.1 > REPEATED,
        };
        self.begin_anew();
        system.pass_contacts(at.t, &mut at.y, &step)?;
        self.find_leaving(system, at, Some(touched))
    }
}
