//! The reference: another method with step control of its own (Dormand and Prince 1980, order 5), restarted by hand
//! where a load switches in time. It shares with the program the right-hand side, and nothing of its integrators.

use super::draw::RandomMachine;
use dwell_dynamics::{Machine, MachineWorkspace};
use dwell_scene::PlaneScene;
use dwell_study::models::build_machine;

/// Tolerance of the reference, and of the run that shows its error.
const TOLERANCES: [f64; 2] = [1e-13, 1e-12];
/// Steps, also those that are rejected, before a motion counts as one that cannot be followed: one that comes to rest at
/// a switch that holds it switches without end.
const MAX_STEPS: usize = 150_000;
/// Shortest step, in spans: below it a step is taken whatever its error, for it crosses a jump.
const SHORTEST: f64 = 1e-14;
/// How far from a switch in time its sides are evaluated, in spans.
const SWITCH_MARGIN: f64 = 4e-15;
/// A reaction of this part of the others is rounding.
const ROUNDING: f64 = 1e-9;

const C: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const A: [&[f64]; 7] = [
    &[],
    &[0.2],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[
        19372.0 / 6561.0,
        -25360.0 / 2187.0,
        64448.0 / 6561.0,
        -212.0 / 729.0,
    ],
    &[
        9017.0 / 3168.0,
        -355.0 / 33.0,
        46732.0 / 5247.0,
        49.0 / 176.0,
        -5103.0 / 18656.0,
    ],
    &[
        35.0 / 384.0,
        0.0,
        500.0 / 1113.0,
        125.0 / 192.0,
        -2187.0 / 6784.0,
        11.0 / 84.0,
    ],
];
/// The weights of order 5 less those of order 4.
const E: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339_200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// The true motion at some times.
pub(super) struct Reference {
    /// By time: the free coordinates, rad or m.
    pub(super) coordinates: Vec<Vec<f64>>,
    /// Whether each of them is an angle.
    pub(super) is_angle: Vec<bool>,
    /// By coordinate: how far it gets from its start.
    pub(super) travels: Vec<f64>,
    /// By coordinate: the error of the reference itself.
    pub(super) errors: Vec<f64>,
    /// By time: the reactions, N or N m.
    pub(super) reactions: Vec<Vec<f64>>,
    /// By reaction: its column, its unit, and the error of the reference itself.
    pub(super) of_reactions: Vec<(String, &'static str, f64)>,
}

impl Reference {
    /// The motion at some times, ascending, s.
    ///
    /// # Errors
    /// Where it cannot be followed, as text.
    pub(super) fn new(random: &RandomMachine, times: &[f64]) -> Result<Self, String> {
        let scene = PlaneScene::parse("machine.toml", &random.text).map_err(|e| e.to_string())?;
        let spec = scene.motion.as_ref().ok_or("no motion")?;
        let components = scene.mechanism.reactions();
        let machine = build_machine(&scene, spec, &[]).map_err(|e| e.to_string())?;
        let with_reactions = build_machine(&scene, spec, &components).map_err(|e| e.to_string())?;
        let start = machine.initial_state(&spec.initial_coordinates, &spec.initial_velocities);
        let free = machine.free().len();
        let run = |tolerance| {
            let mut integration = Integration {
                workspace: machine.workspace(),
                machine: &machine,
                span: random.span,
                tolerance,
                steps: 0,
                slopes: vec![vec![0.0; start.len()]; 7],
            };
            integration.follow(start.clone(), &random.switches, times)
        };
        let [fine, coarse] = TOLERANCES.map(run);
        let (fine, coarse) = (fine?, coarse?);
        let reactions = |states: &[Vec<f64>]| -> Result<Vec<Vec<f64>>, String> {
            let mut workspace = with_reactions.workspace();
            let at = |(&t, y): (&f64, &Vec<f64>)| {
                let state = with_reactions.evaluate(t, y, &mut workspace);
                let state = state.map_err(|e| e.to_string())?;
                Ok(state.inverse_dynamics().reactions.clone())
            };
            times.iter().zip(states).map(at).collect()
        };
        let (reactions, others) = (reactions(&fine)?, reactions(&coarse)?);
        let largest = |of: &dyn Fn(usize) -> f64| (0..times.len()).map(of).fold(0.0, f64::max);
        let travel = |i: usize| largest(&|k| (fine[k][i] - start[i]).abs());
        let error = |i: usize| largest(&|k| (fine[k][i] - coarse[k][i]).abs());
        let of_reactions = components.iter().enumerate().map(|(i, &component)| {
            let error = largest(&|k| (reactions[k][i] - others[k][i]).abs());
            let name = scene.mechanism.reaction_name(component);
            (name, component.component.unit(), error)
        });
        let is_angle = machine
            .free()
            .iter()
            .map(|&i| machine.model().plan().is_angle(i));
        Ok(Self {
            of_reactions: of_reactions.collect(),
            is_angle: is_angle.collect(),
            travels: (0..free).map(travel).collect(),
            errors: (0..free).map(error).collect(),
            coordinates: fine.iter().map(|y| y[..free].to_vec()).collect(),
            reactions,
        })
    }

    /// By reaction: the error of a column, that of the reference, and the largest reaction of the unit; only where that
    /// is more than rounding. Beside forces (N) and energies (J) moments (N m) are, in mechanisms of about a metre.
    pub(super) fn reaction_errors(
        &self,
        kinetic: f64,
        column: &dyn Fn(&str) -> Vec<f64>,
    ) -> Vec<(f64, f64, f64)> {
        let largest = |i: usize| {
            let sizes = self.reactions.iter().map(|at| at[i].abs());
            sizes.fold(0.0, f64::max)
        };
        let of_unit = |wanted: &str| {
            let alike = self.of_reactions.iter().enumerate();
            let alike = alike.filter(|(_, (_, unit, _))| *unit == wanted);
            alike.map(|(i, _)| largest(i)).fold(0.0, f64::max)
        };
        let [force, moment] = ["N", "N m"].map(of_unit);
        let all = self.of_reactions.iter().enumerate();
        let error = |(i, (name, unit, own)): (usize, &(String, &str, f64))| {
            let scale = if *unit == "N" { force } else { moment };
            let rows = column(name).into_iter().zip(&self.reactions);
            let differences = rows.map(|(value, expected)| (value - expected[i]).abs());
            let is_rounding = scale <= ROUNDING * force.max(moment).max(kinetic);
            (!is_rounding).then(|| (differences.fold(0.0, f64::max), *own, scale))
        };
        all.filter_map(error).collect()
    }
}

struct Integration<'m> {
    machine: &'m Machine,
    workspace: MachineWorkspace,
    span: f64,
    tolerance: f64,
    steps: usize,
    slopes: Vec<Vec<f64>>,
}

impl Integration<'_> {
    /// The states at some times, from switch to switch.
    fn follow(
        &mut self,
        mut y: Vec<f64>,
        switches: &[f64],
        times: &[f64],
    ) -> Result<Vec<Vec<f64>>, String> {
        let mut stops: Vec<f64> = switches.iter().chain(times).copied().collect();
        stops.sort_by(f64::total_cmp);
        // A time may be a switch, too.
        stops.dedup();
        let (mut t, mut step, mut found) = (0.0, 1e-4 * self.span, Vec::new());
        for stop in stops {
            if stop > t {
                self.piece([t, stop], &mut y, &mut step)?;
                t = stop;
            }
            if times.contains(&stop) {
                found.push(y.clone());
            }
        }
        match found.len() == times.len() {
            true => Ok(found),
            false => Err("a time is missing".to_owned()),
        }
    }

    /// From a time to another, between which no load switches in time.
    fn piece(
        &mut self,
        [from, to]: [f64; 2],
        y: &mut Vec<f64>,
        step: &mut f64,
    ) -> Result<(), String> {
        let mut t = from;
        let shortest = SHORTEST * self.span;
        while t < to {
            self.steps += 1;
            if self.steps > MAX_STEPS {
                return Err(format!("more than {MAX_STEPS} steps"));
            }
            let is_last = t + *step >= to - shortest;
            let h = if is_last { to - t } else { *step };
            let (next, error) = self.try_step(t, h, [from, to], y)?;
            if error <= 1.0 || h <= shortest {
                t = if is_last { to } else { t + h };
                *y = next;
            }
            let factor = (0.9 * error.max(1e-10).powf(-0.2)).clamp(0.1, 4.0);
            *step = (h * factor).max(shortest);
        }
        Ok(())
    }

    /// The state after a step, and its error in tolerances.
    fn try_step(
        &mut self,
        t: f64,
        h: f64,
        piece: [f64; 2],
        y: &[f64],
    ) -> Result<(Vec<f64>, f64), String> {
        let margin = SWITCH_MARGIN * self.span;
        let inside = [piece[0] + margin, piece[1] - margin];
        let mut next = y.to_vec();
        for stage in 0..7 {
            for (i, value) in next.iter_mut().enumerate() {
                let slopes = A[stage].iter().zip(&self.slopes);
                *value = y[i] + h * slopes.map(|(a, slope)| a * slope[i]).sum::<f64>();
            }
            let at = (t + C[stage] * h)
                .max(inside[0])
                .min(inside[1].max(inside[0]));
            let state = self.machine.evaluate(at, &next, &mut self.workspace);
            state
                .map_err(|e| e.to_string())?
                .derivative(&mut self.slopes[stage]);
        }
        // The works do not act on the motion.
        let counted = self.machine.work_offset();
        let mut error = 0.0_f64;
        for i in 0..counted {
            let of_state: f64 = E
                .iter()
                .zip(&self.slopes)
                .map(|(e, slope)| e * slope[i])
                .sum();
            let scale = self.tolerance * (1.0 + y[i].abs().max(next[i].abs()));
            error = error.max((h * of_state / scale).abs());
        }
        Ok((next, if error.is_nan() { f64::INFINITY } else { error }))
    }
}
