//! A rod between two balls, solved in closed form: a group of its ball's three turns θ and one other unknown x, whose rows are the
//! points of the other ball and the row that holds the rod's spin.
//!
//! ```text
//! u x + σ θ×r = b,     g x + e·θ = s,     e ∥ r                                                       (1)
//! x = r·b / r·u,       θ = σ r×(b − u x)/r² + (s − g x) e                                             (2)
//! λₛ = e·f_θ,          λ = h×r/r² + μ r,   h = σ (f_θ − λₛ e),   μ = (f_x − g λₛ − u·(h×r)/r²) / r·u     (3)
//! ```
//!
//! with r from the ball to the other point, e the unit vector of the spin row, σ = ±1 the sense of the path. Along r the rod does not
//! give way: that is the one equation of x. (3) solves the transposed equations for the multipliers.

use super::closure::{Closure, RowKind};
use super::groups::Group;
use super::plan::{Plan, Pose};
use super::positions::singular;
use super::tree::{Link, Step};
use super::vector::{Vec3, vec3};
use dwell_numerics::{Constant, Lift, Scalar};

/// The positions of the parts of (1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rod {
    /// The closures of the points and of the spin.
    points: usize,
    spin: usize,
    /// The end of the first at which the rod is.
    end: usize,
    /// σ.
    sense: f64,
    /// Start of the freedoms of the spherical joint on both paths; the other unknown on the first path, and on the
    /// second, if there is one.
    balls: [usize; 2],
    other: usize,
    other_in_spin: Option<usize>,
    /// Of the group: the rows of the points and that of the spin; the first unknown of the ball and the other one.
    rows: [usize; 4],
    unknowns: [usize; 2],
}

/// The data of (2) and (3), stored in the memory of the factors.
struct Factors<T> {
    u: Vec3<T>,
    r: Vec3<T>,
    e: Vec3<T>,
    g: T,
    /// 1/(r·u) and 1/r².
    inverse: T,
    inverse_square: T,
}

/// Tolerance with which the axis of a row is that of the rod.
const PARALLEL: f64 = 1e-14;

impl Rod {
    /// The closure that holds the spin, and the vector from the ball to the other point in the frame of the rod.
    pub(super) fn spin_and_arm<C: Copy>(&self, closures: &[Closure<C>]) -> (usize, Vec3<C>) {
        (self.spin, closures[self.points].points[self.end])
    }
}

impl<T: Scalar> Factors<T> {
    #[inline(always)]
    fn read(from: &[T]) -> Self {
        let at = |k: usize| vec3(from[k], from[k + 1], from[k + 2]);
        Self {
            u: at(0),
            r: at(3),
            e: at(6),
            g: from[9],
            inverse: from[10],
            inverse_square: from[11],
        }
    }

    #[inline(always)]
    fn write(&self, to: &mut [T]) {
        for (k, v) in [self.u, self.r, self.e].into_iter().enumerate() {
            [to[3 * k], to[3 * k + 1], to[3 * k + 2]] = [v.x, v.y, v.z];
        }
        [to[9], to[10], to[11]] = [self.g, self.inverse, self.inverse_square];
    }
}

/// An axis of the ground times a vector.
#[inline(always)]
fn axis_cross<T: Scalar>(axis: usize, v: Vec3<T>) -> Vec3<T> {
    let zero = T::from_f64(0.0);
    match axis {
        0 => vec3(zero, -v.z, v.y),
        1 => vec3(v.z, zero, -v.x),
        _ => vec3(-v.y, v.x, zero),
    }
}

impl Plan {
    /// The rod that a group is, if it is one.
    pub(super) fn rod(&self, group: &Group) -> Option<Rod> {
        let (&[(ball, first)], 4, 4) = (&group.balls[..], group.rows.len(), group.unknowns.len())
        else {
            return None;
        };
        let link = &self.tree.links[ball];
        let ([points, spin], end) = self.rod_closures(group, link)?;
        let closures = [points, spin].map(|c| &self.closures[c]);
        let place = |c: usize, freedom: usize| {
            let path = &closures[c].path;
            path.iter().position(|(f, _)| *f == freedom)
        };
        let turns = link.freedoms.start;
        let in_order = |c: usize, at: usize| {
            let path = closures[c].path.get(at..at + 3);
            path.is_some_and(|p| (0..3).all(|k| p[k].0 == turns + k))
        };
        let balls = [place(0, turns)?, place(1, turns)?];
        let fits =
            in_order(0, balls[0]) && in_order(1, balls[1]) && closures[1].path[balls[1]].1 == 1.0;
        let row = |c: usize, k: usize| group.rows.iter().position(|r| *r == (c, k));
        let other_unknown = if first == 0 { 3 } else { 0 };
        let other = group.unknowns[other_unknown];
        fits.then_some(Rod {
            points,
            spin,
            end,
            sense: closures[0].path[balls[0]].1,
            balls,
            other: place(0, other)?,
            other_in_spin: place(1, other),
            rows: [
                row(points, 0)?,
                row(points, 1)?,
                row(points, 2)?,
                row(spin, 0)?,
            ],
            unknowns: [first, other_unknown],
        })
    }

    /// The closures of a group that are the points of another ball on a link's body and its spin about the line of both balls, and the
    /// end of the first at which the body is.
    fn rod_closures(&self, group: &Group, link: &Link) -> Option<([usize; 2], usize)> {
        let of_kinds = |wanted: fn(&[RowKind]) -> bool| {
            let mut found = group.closures.iter().map(|(c, _)| *c);
            found.find(|c| wanted(&self.closures[*c].kinds))
        };
        let points = of_kinds(|kinds| {
            use RowKind::Point;
            matches!(kinds, [Point(0), Point(1), Point(2)])
        })?;
        let spin = of_kinds(|kinds| matches!(kinds, [RowKind::NoSpin(_)]))?;
        let closure = &self.closures[points];
        let end = (0..2).find(|k| closure.bodies[*k] == link.body)?;
        let RowKind::NoSpin(axis) = self.closures[spin].kinds[0] else {
            return None;
        };
        let is_on_rod = self.closures[spin].bodies[1] == link.body
            && closure.on == closure.bodies
            && matches!(link.steps[..], [Step::Ball(..)])
            && axis.cross(closure.points[end].unit()?).norm() < PARALLEL;
        is_on_rod.then_some(([points, spin], end))
    }
}

impl<C: Constant> Plan<C> {
    /// Computes the entries of a rod's closed rows and the data of (2) and (3); returns false if it is singular.
    #[inline(always)]
    pub(super) fn factor_rod<T: Lift<C>>(
        &self,
        group: &Group,
        rod: &Rod,
        pose: &mut Pose<T>,
    ) -> bool {
        let (closure, spin) = (&self.closures[rod.points], &self.closures[rod.spin]);
        let frame = &pose.frames[closure.bodies[rod.end]];
        let r = frame.rotation.apply(closure.points[rod.end].cast());
        let at = frame.position + r;
        let e = match spin.kinds[0] {
            RowKind::NoSpin(axis) => frame.rotation.apply(axis.cast()),
            _ => return false,
        };
        let freedoms = closure.path.len();
        let mut u = Vec3::zero();
        for (p, &(freedom, sign)) in closure.path.iter().enumerate() {
            let column = match p.wrapping_sub(rod.balls[0]) {
                k @ 0..3 => axis_cross(k, r).scaled(T::from_f64(sign)),
                _ => pose.screws[freedom].velocity(self.tree.freedoms[freedom], at, sign),
            };
            if p == rod.other {
                u = column;
            }
            for (k, entry) in [column.x, column.y, column.z].into_iter().enumerate() {
                pose.entries[closure.entries + k * freedoms + p] = entry;
            }
        }
        let row = &mut pose.row_wrenches[spin.rows.start];
        (row.force, row.moment) = (Vec3::zero(), e);
        for (p, &(freedom, sign)) in spin.path.iter().enumerate() {
            let angular = self.tree.freedoms[freedom].angular();
            let along = e.dot(pose.screws[freedom].axis);
            pose.entries[spin.entries + p] = along * T::from_f64(angular * sign);
        }
        let g = match rod.other_in_spin {
            Some(p) => pose.entries[spin.entries + p],
            None => T::from_f64(0.0),
        };
        let (one, across, square) = (T::from_f64(1.0), r.dot(u), r.dot(r));
        let factors = Factors {
            u,
            r,
            e,
            g,
            inverse: one / across,
            inverse_square: one / square,
        };
        factors.write(&mut pose.factors[group.factors..]);
        let [across, square, other] = [across, square, u.dot(u)].map(|v| v.value());
        let smallest = singular::<T>();
        across * across >= smallest * smallest * square * other && across != 0.0
    }

    /// (2) for the right-hand sides in the scratch memory; it leaves the unknowns there.
    #[inline(always)]
    pub(super) fn solve_rod<T: Scalar>(group: &Group, rod: &Rod, pose: &mut Pose<T>) {
        let of = Factors::read(&pose.factors[group.factors..]);
        let [x_row, y_row, z_row, spin] = rod.rows;
        let values = &mut pose.scratch;
        let b = vec3(values[x_row], values[y_row], values[z_row]);
        let x = of.r.dot(b) * of.inverse;
        let across = of.r.cross(b - of.u.scaled(x));
        let along = values[spin] - of.g * x;
        let by = of.inverse_square * T::from_f64(rod.sense);
        let turns = across.scaled(by) + of.e.scaled(along);
        let [ball, other] = rod.unknowns;
        [values[ball], values[ball + 1], values[ball + 2]] = [turns.x, turns.y, turns.z];
        values[other] = x;
    }

    /// Solves (3) for the required forces of the unknowns; the multipliers replace them in the same memory.
    #[inline(always)]
    pub(super) fn solve_rod_transposed<T: Scalar>(
        group: &Group,
        rod: &Rod,
        pose: &Pose<T>,
        values: &mut [T],
    ) {
        let of = Factors::read(&pose.factors[group.factors..]);
        let [ball, other] = rod.unknowns;
        let turns = vec3(values[ball], values[ball + 1], values[ball + 2]);
        let spin = of.e.dot(turns);
        let h = turns - of.e.scaled(spin);
        let by = of.inverse_square * T::from_f64(rod.sense);
        let across = h.cross(of.r).scaled(by);
        let along = (values[other] - of.g * spin - of.u.dot(across)) * of.inverse;
        let force = across + of.r.scaled(along);
        for (row, multiplier) in rod.rows.into_iter().zip([force.x, force.y, force.z, spin]) {
            values[row] = multiplier;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::joint_kinds::JointKind;
    use super::super::mechanism::{Actuator, Assembly, Joint, Mechanism, Side};
    use super::super::plan::Plan;
    use super::super::vector::{Vec3, vec3};
    use crate::Body;

    /// An RSSR whose bodies' frames coincide with that of the ground at q = 0.
    fn rssr(ball_orders: [[usize; 2]; 2]) -> Plan {
        let side = |point, axis: Vec3| Side {
            point,
            axis,
            normal: axis.any_normal(),
        };
        let [_, y, z] = Vec3::AXES;
        let joint = |name: &str, bodies, kind, point, axis| {
            Joint::new(name, bodies, kind, [side(point, axis), side(point, axis)])
        };
        let [b, c] = ball_orders;
        let mechanism = Mechanism {
            bodies: ["ground", "crank", "coupler", "rocker"]
                .map(Body::named)
                .into(),
            ground: 0,
            joints: vec![
                joint("A", [0, 1], JointKind::Revolute, Vec3::ZERO, z),
                joint("B", b, JointKind::Spherical, vec3(0.1, 0.0, 0.0), z),
                joint("C", c, JointKind::Spherical, vec3(0.15, 0.15, 0.2), z),
                joint("D", [0, 3], JointKind::Revolute, vec3(0.25, 0.06, -0.04), y),
            ],
            actuators: vec![Actuator::angle("q", 0)],
            couplings: Vec::new(),
        };
        Plan::compile(&mechanism, &Assembly::at(&[0.0])).expect("a plan")
    }

    /// The closed forms and the entries of the Jacobian are those of the rows in general, whichever way the balls' bodies are named.
    #[test]
    fn a_rod_is_solved_as_its_dense_equations() {
        for orders in [
            [[1, 2], [2, 3]],
            [[2, 1], [2, 3]],
            [[1, 2], [3, 2]],
            [[2, 1], [3, 2]],
        ] {
            let plan = rssr(orders);
            let [group] = &plan.groups[..] else {
                panic!("one group");
            };
            assert!(group.rod.is_some());
            let mut dense_group = group.clone();
            dense_group.rod = None;
            for q in [-0.2, 0.1, 0.4] {
                let mut pose = plan.pose::<f64>();
                plan.positions(&[q], &mut pose).expect("a pose");
                let mut dense = pose.clone();
                plan.fill_rows(&dense_group, &mut dense);
                plan.factor(&dense_group, &mut dense);
                let largest = plan.largest_residual(&dense_group, &dense);
                assert!(largest < 1e-14, "open by {largest:.1e}");
                for (a, b) in pose.entries.iter().zip(&dense.entries) {
                    assert!((a - b).abs() < 1e-14, "an entry {a} is {b}");
                }
                for row in 0..4 {
                    let mut unit = [0.0; 4];
                    unit[row] = 1.0;
                    let (mut by_rod, mut by_factors) = (unit, unit);
                    for (group, pose, values) in [
                        (group, &mut pose, &mut by_rod),
                        (&dense_group, &mut dense, &mut by_factors),
                    ] {
                        pose.scratch[..4].copy_from_slice(&unit);
                        plan.solve(group, pose);
                        plan.solve_transposed(group, pose, values);
                    }
                    let found = [&pose.scratch[..4], &by_rod[..]];
                    let wanted = [&dense.scratch[..4], &by_factors[..]];
                    for (found, wanted) in found.into_iter().zip(wanted) {
                        for (a, b) in found.iter().zip(wanted) {
                            assert!((a - b).abs() < 1e-11, "{found:?} is {wanted:?}");
                        }
                    }
                }
            }
        }
    }
}
