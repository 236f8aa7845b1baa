//! Sequential quadratic programming: damped BFGS (M. J. D. Powell, 1978), a line search on an exact penalty function, a second-order
//! correction of the constraints (J. Nocedal and S. J. Wright, *Numerical Optimization*, 2nd ed. 2006, ch. 18).

use super::{QuadraticProgram, dot, largest};

/// A constraint at a point: `value` ≥ 0, or = 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    /// Its value.
    pub value: f64,
    /// Its derivatives.
    pub slope: Vec<f64>,
    /// Whether its value is to be zero.
    pub is_equality: bool,
    /// The family to which it belongs: only the largest violation in a family is penalised. There may be more or fewer members at another
    /// point, as of the extrema of a curve.
    pub family: usize,
    /// Its place in the family, from 0 to 1 and around: a member is the one at another point whose place is nearest.
    pub place: f64,
}

impl Constraint {
    /// How far it is from being satisfied.
    pub fn violation(&self) -> f64 {
        match self.is_equality {
            true => self.value.abs(),
            false => (-self.value).max(0.0),
        }
    }

    /// Whether no step changes it, to first order.
    fn is_constant(&self) -> bool {
        self.slope.iter().all(|part| *part == 0.0)
    }

    /// The member of the same family among others that is nearest.
    pub fn counterpart<'c>(&self, others: &'c [Self]) -> Option<&'c Self> {
        let distance = |other: &Self| {
            let apart = (other.place - self.place).abs();
            apart.min((1.0 - apart).abs())
        };
        let family = others.iter().filter(|other| other.family == self.family);
        family.min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

/// A problem at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// The goal.
    pub goal: f64,
    /// Its derivatives.
    pub slope: Vec<f64>,
    /// The constraints.
    pub constraints: Vec<Constraint>,
}

impl Evaluation {
    /// The largest violation of a constraint.
    pub fn violation(&self) -> f64 {
        let each = self.constraints.iter().map(Constraint::violation);
        each.fold(0.0, f64::max)
    }

    /// The largest violation of each family.
    fn violations(&self, families: usize) -> Vec<f64> {
        let mut all = vec![0.0_f64; families];
        for constraint in &self.constraints {
            let sum = &mut all[constraint.family];
            *sum = sum.max(constraint.violation());
        }
        all
    }
}

/// When a search ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SequentialSettings {
    /// The residual of the conditions of Karush, Kuhn and Tucker, and the violation, at which it has converged.
    pub tolerance: f64,
    /// The most iterations.
    pub iterations: usize,
    /// The number of families of constraints.
    pub families: usize,
}

/// Where a search ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Optimum {
    /// The point.
    pub x: Vec<f64>,
    /// The problem there.
    pub evaluation: Evaluation,
    /// By constraint: its multiplier, by how much the goal falls where the constraint is relaxed by one.
    pub multipliers: Vec<f64>,
    /// By variable: the multiplier of its bounds, positive at the lower and negative at the upper one.
    pub of_bounds: Vec<f64>,
    /// The largest component of ∇f − Σ λ ∇c, over 1 + that of ∇f.
    pub residual: f64,
    /// The largest product of a multiplier and the value of its inequality.
    pub complementarity: f64,
    /// Number of evaluations.
    pub evaluations: usize,
    /// Whether residual, violation and complementarity are below the tolerance.
    pub is_converged: bool,
}

/// The value of a problem at a point; `None` where it has none.
type Problem<'a> = dyn FnMut(&[f64]) -> Option<Evaluation> + 'a;

/// A relative change that is rounding, and the least step.
const ROUNDING: f64 = 1e-14;
const LEAST_STEP: f64 = 1e-9;
/// A residual of so many tolerances is as small as rounding may allow.
const NEARLY: f64 = 100.0;
/// The part of the predicted decrease that is enough.
const ENOUGH: f64 = 1e-4;
/// The price of leaving violations as they are where linear constraints contradict each other.
const PRICE: f64 = 1e4;
/// Below this part of the curvature along a step that of the Lagrangian is damped.
const DAMPED: f64 = 0.2;

/// Searches the least goal between bounds, from a point; `None` if the problem has no value there. `done` takes each accepted point, and
/// says whether to go on.
// Long because the iteration is one loop with its ends.
pub fn minimise(
    problem: &mut Problem<'_>,
    start: &[f64],
    bounds: &[[f64; 2]],
    settings: SequentialSettings,
    done: &mut dyn FnMut(&[f64], &Evaluation) -> bool,
) -> Option<Optimum> {
    let x: Vec<f64> = (start.iter().zip(bounds))
        .map(|(x, [from, to])| x.clamp(*from, *to))
        .collect();
    let evaluation = problem(&x)?;
    let mut search = Search {
        hessian: unit(x.len()),
        is_fresh: true,
        penalties: vec![0.0; settings.families],
        bounds,
        settings,
        best: Optimum {
            multipliers: Vec::new(),
            of_bounds: vec![0.0; x.len()],
            residual: f64::INFINITY,
            complementarity: f64::INFINITY,
            evaluations: 1,
            is_converged: false,
            evaluation,
            x,
        },
    };
    for _ in 0..settings.iterations {
        let Some(step) = search.step(None) else {
            if search.is_fresh {
                break;
            }
            search.restart();
            continue;
        };
        search.judge(&step);
        if search.best.is_converged {
            break;
        }
        match search.line_search(problem, &step) {
            Some(next) => {
                let (x, evaluation) = next;
                search.update(&step, &x, &evaluation);
                (search.best.x, search.best.evaluation) = (x, evaluation);
                if !done(&search.best.x, &search.best.evaluation) {
                    break;
                }
            }
            None if search.is_fresh || search.is_nearly_converged() => break,
            None => search.restart(),
        }
    }
    // The multipliers are those of the last point.
    if !search.best.is_converged
        && let Some(step) = search.step(None)
    {
        search.judge(&step);
    }
    Some(search.best)
}

fn unit(n: usize) -> Vec<Vec<f64>> {
    let row = |i| (0..n).map(move |j| f64::from(u8::from(i == j)));
    (0..n).map(|i| row(i).collect()).collect()
}

/// A step of the quadratic program.
struct Step {
    d: Vec<f64>,
    /// Of the constraints, then of the bounds.
    multipliers: Vec<f64>,
    /// The part of the violations that it leaves.
    left: f64,
}

struct Search<'a> {
    hessian: Vec<Vec<f64>>,
    /// Whether nothing is known of the curvature.
    is_fresh: bool,
    /// By family.
    penalties: Vec<f64>,
    bounds: &'a [[f64; 2]],
    settings: SequentialSettings,
    best: Optimum,
}

impl Search<'_> {
    /// Whether rounding may be what hinders another step.
    fn is_nearly_converged(&self) -> bool {
        let tolerance = NEARLY * self.settings.tolerance;
        self.best.residual <= tolerance && self.best.evaluation.violation() <= tolerance
    }

    fn restart(&mut self) {
        (self.hessian, self.is_fresh) = (unit(self.best.x.len()), true);
    }

    /// The step of the quadratic program, with other values of the constraints if they are given. Where linear constraints contradict each
    /// other, they are relaxed together as little as possible.
    fn step(&self, values: Option<&[f64]>) -> Option<Step> {
        let (x, at) = (&self.best.x, &self.best.evaluation);
        let constraints = &at.constraints;
        let own: Vec<f64> = constraints.iter().map(|c| c.value).collect();
        let values = values.unwrap_or(&own);
        let mut normals: Vec<Vec<f64>> = constraints.iter().map(|c| c.slope.clone()).collect();
        // No step changes a constant constraint, which therefore limits none.
        let mut limits: Vec<f64> = (constraints.iter().zip(values))
            .map(|(of, v)| if of.is_constant() { 0.0 } else { -v })
            .collect();
        let mut are_equalities: Vec<bool> = constraints.iter().map(|c| c.is_equality).collect();
        for (k, [from, to]) in self.bounds.iter().enumerate() {
            for (sign, room) in [(1.0, from - x[k]), (-1.0, x[k] - to)] {
                let mut normal = vec![0.0; x.len()];
                normal[k] = sign;
                normals.push(normal);
                limits.push(room);
                are_equalities.push(false);
            }
        }
        let program = QuadraticProgram {
            hessian: &self.hessian,
            slope: &at.slope,
            normals: &normals,
            limits: &limits,
            are_equalities: &are_equalities,
        };
        if let Some(found) = program.solve() {
            return Some(Step {
                d: found.x,
                multipliers: found.multipliers,
                left: 0.0,
            });
        }
        self.relaxed_step(values, normals, limits, are_equalities)
    }

    /// The step where linear constraints contradict each other, with one more variable: the part of the violations that is left.
    fn relaxed_step(
        &self,
        values: &[f64],
        mut normals: Vec<Vec<f64>>,
        mut limits: Vec<f64>,
        mut are_equalities: Vec<bool>,
    ) -> Option<Step> {
        let (x, at) = (&self.best.x, &self.best.evaluation);
        let mut hessian = self.hessian.clone();
        hessian.iter_mut().for_each(|row| row.push(0.0));
        let mut last = vec![0.0; x.len() + 1];
        last[x.len()] = PRICE * (1.0 + largest(&at.slope));
        hessian.push(last);
        for (k, normal) in normals.iter_mut().enumerate() {
            let is_open = k < values.len() && !at.constraints[k].is_constant();
            let is_left = is_open && (are_equalities[k] || values[k] < 0.0);
            normal.push(if is_left { -values[k] } else { 0.0 });
        }
        let mut normal = vec![0.0; x.len() + 1];
        normal[x.len()] = -1.0;
        normals.push(normal);
        limits.push(-1.0);
        are_equalities.push(false);
        let program = QuadraticProgram {
            hessian: &hessian,
            slope: &[&at.slope[..], &[0.0]].concat(),
            normals: &normals,
            limits: &limits,
            are_equalities: &are_equalities,
        };
        let mut found = program.solve()?;
        let left = found.x.pop()?.clamp(0.0, 1.0);
        found.multipliers.pop();
        Some(Step {
            d: found.x,
            multipliers: found.multipliers,
            left,
        })
    }

    /// The conditions of an optimum, with the multipliers of a step: H d = Σ λ ∇c − ∇f.
    fn judge(&mut self, step: &Step) {
        let best = &mut self.best;
        let constraints = &best.evaluation.constraints;
        let (own, of_bounds) = step.multipliers.split_at(constraints.len());
        let bends: Vec<f64> = self.hessian.iter().map(|row| dot(row, &step.d)).collect();
        best.residual = largest(&bends) / (1.0 + largest(&best.evaluation.slope));
        let inequalities = constraints.iter().zip(own).filter(|(c, _)| !c.is_equality);
        let products: Vec<f64> = inequalities.map(|(c, l)| c.value * l).collect();
        best.complementarity = largest(&products);
        best.multipliers = own.to_vec();
        best.of_bounds = of_bounds.chunks(2).map(|pair| pair[0] - pair[1]).collect();
        let scale = 1.0 + best.evaluation.goal.abs();
        let tolerance = self.settings.tolerance;
        best.is_converged = best.residual <= tolerance
            && best.evaluation.violation() <= tolerance
            && best.complementarity <= tolerance * scale
            && step.left == 0.0;
    }

    /// The next point along a step, with its values; `None` if there is none.
    fn line_search(
        &mut self,
        problem: &mut Problem<'_>,
        step: &Step,
    ) -> Option<(Vec<f64>, Evaluation)> {
        let at = &self.best.evaluation;
        let mut sums = vec![0.0; self.penalties.len()];
        for (constraint, multiplier) in at.constraints.iter().zip(&step.multipliers) {
            sums[constraint.family] += multiplier.abs();
        }
        for (penalty, sum) in self.penalties.iter_mut().zip(sums) {
            *penalty = sum.max(0.5 * (*penalty + sum));
        }
        let penalties = self.penalties.clone();
        let merit = |of: &Evaluation| of.goal + dot(&penalties, &of.violations(penalties.len()));
        let before = merit(at);
        let removed = (1.0 - step.left) * dot(&penalties, &at.violations(penalties.len()));
        let rate = (dot(&at.slope, &step.d) - removed).min(0.0);
        let rounding = ROUNDING * (1.0 + before.abs());
        let mut part = 1.0;
        while part > LEAST_STEP {
            let x = self.moved(&step.d, part);
            self.best.evaluations += 1;
            let next = problem(&x).filter(|next| merit(next).is_finite());
            let Some(next) = next else {
                part *= 0.3;
                continue;
            };
            let after = merit(&next);
            if after <= before + ENOUGH * part * rate + rounding {
                return Some((x, next));
            }
            if part == 1.0
                && let Some(x) = self.corrected(step, &next)
            {
                self.best.evaluations += 1;
                let corrected = problem(&x).filter(|next| merit(next).is_finite());
                if let Some(next) =
                    corrected.filter(|next| merit(next) <= before + ENOUGH * rate + rounding)
                {
                    return Some((x, next));
                }
            }
            // The least of the parabola through both values and the slope.
            let parabolic = -0.5 * rate * part / ((after - before) / part - rate);
            part = parabolic.clamp(0.1 * part, 0.5 * part);
        }
        None
    }

    fn moved(&self, d: &[f64], part: f64) -> Vec<f64> {
        let each = self.best.x.iter().zip(d).zip(self.bounds);
        let moved = each.map(|((x, d), [from, to])| (x + part * d).clamp(*from, *to));
        moved.collect()
    }

    /// The point of the quadratic program whose constraints have the values at the end of a step.
    fn corrected(&self, step: &Step, end: &Evaluation) -> Option<Vec<f64>> {
        let constraints = &self.best.evaluation.constraints;
        let value = |c: &Constraint| {
            let there = c.counterpart(&end.constraints)?;
            Some(there.value - dot(&c.slope, &step.d))
        };
        let values: Option<Vec<f64>> = constraints.iter().map(value).collect();
        let second = self
            .step(Some(&values?))
            .filter(|second| second.left == 0.0)?;
        Some(self.moved(&second.d, 1.0))
    }

    /// The curvature of the Lagrangian from the change of its slope.
    fn update(&mut self, step: &Step, x: &[f64], next: &Evaluation) {
        let at = &self.best.evaluation;
        let s: Vec<f64> = x.iter().zip(&self.best.x).map(|(a, b)| a - b).collect();
        let mut y: Vec<f64> = (next.slope.iter().zip(&at.slope))
            .map(|(a, b)| a - b)
            .collect();
        for (constraint, multiplier) in at.constraints.iter().zip(&step.multipliers) {
            if *multiplier == 0.0 {
                continue;
            }
            let there = constraint.counterpart(&next.constraints);
            let there = there.map_or(&constraint.slope, |there| &there.slope);
            for (k, y) in y.iter_mut().enumerate() {
                *y -= multiplier * (there[k] - constraint.slope[k]);
            }
        }
        let along = dot(&s, &y);
        if self.is_fresh && along > 0.0 {
            let size = (dot(&y, &y) / along).clamp(1e-6, 1e6);
            for (k, row) in self.hessian.iter_mut().enumerate() {
                row[k] = size;
            }
        }
        self.is_fresh = false;
        let bend: Vec<f64> = self.hessian.iter().map(|row| dot(row, &s)).collect();
        let curvature = dot(&s, &bend);
        if curvature.is_nan() || curvature <= f64::MIN_POSITIVE {
            return;
        }
        let damping = match along < DAMPED * curvature {
            true => (1.0 - DAMPED) * curvature / (curvature - along),
            false => 1.0,
        };
        for (y, bend) in y.iter_mut().zip(&bend) {
            *y = damping * *y + (1.0 - damping) * bend;
        }
        let along = dot(&s, &y);
        for (i, row) in self.hessian.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry += y[i] * y[j] / along - bend[i] * bend[j] / curvature;
            }
        }
    }
}

#[cfg(test)]
mod tests;
