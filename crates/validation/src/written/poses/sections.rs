//! The internal forces of a link by equilibrium of the part that was cut off at its far end: forces of joints and loads on
//! that part, and the inertia of its mass by quadrature.

use super::difference::Differences;
use super::equilibrium::{actuator_forces, reaction, written_joint_wrenches};
use super::motion::Motion;
use super::reading::{Joint, LoadKind, Place, Reading};
use super::rows::Rows;
use super::wrenches::Wrench;

/// A link between two points of a body.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Link {
    pub(crate) body: usize,
    pub(crate) names: [String; 2],
    pub(crate) ends: [[f64; 2]; 2],
}

/// Differences at the cuts, and at the far end, where the cut part is nothing but what acts there.
#[derive(Debug, Default)]
pub(crate) struct Sections {
    pub(crate) cuts: Differences,
    pub(crate) ends: Differences,
}

/// The links whose forces are all at points: of bodies on which couples act, only those of their joints' pins.
pub(crate) fn links(reading: &Reading) -> Vec<Link> {
    let mut all = Vec::new();
    let bodies = reading.bodies.iter().enumerate();
    for (body, of) in bodies.filter(|(_, of)| !of.is_ground && of.mass > 0.0) {
        for (k, (first, from)) in of.points.iter().enumerate() {
            for (second, to) in &of.points[k + 1..] {
                if (to[0] - from[0]).hypot(to[1] - from[1]) > 0.0 {
                    all.push(Link {
                        body,
                        names: [first.clone(), second.clone()],
                        ends: [*from, *to],
                    });
                }
            }
        }
    }
    all
}

/// A force at a point of the link, with the couple that remains on the line.
struct Applied {
    station: f64,
    along: f64,
    across: f64,
    couple: f64,
}

/// Judges the cuts of a link in a row: stations with axial force, shear and bending moment.
pub(crate) fn sections(
    reading: &Reading,
    rows: &Rows,
    row: usize,
    link: &Link,
    cuts: &Rows,
) -> Sections {
    let mut found = Sections::default();
    let name = format!(
        "{}.{}",
        reading.bodies[link.body].name,
        link.names.join(".")
    );
    let motion = Motion::new(reading, rows, row);
    let Some((applied, mass)) = motion.and_then(|motion| forces_on(&motion, link)) else {
        return found;
    };
    let [from, to] = link.ends;
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let expected =
        |station: f64, side: f64| far_part(&applied, mass.as_ref(), [station, side], length);
    let columns = ["station", "axial", "shear", "bending"];
    let force = applied
        .iter()
        .map(|a| a.along.hypot(a.across))
        .fold(0.0, f64::max);
    let moment = applied
        .iter()
        .map(|a| a.couple.abs())
        .fold(force * length, f64::max);
    for cut in 0..cuts.count {
        let [Some(station), written @ ..] = columns.map(|column| cuts.get(cut, column)) else {
            found.cuts.fail(format!("section {name}: no stations"));
            continue;
        };
        // At a force there are two cuts: before and behind it.
        let is_near = |other: usize| {
            cuts.get(other, "station")
                .is_some_and(|s| (s - station).abs() <= 1e-9 * length)
        };
        let behind = cut > 0 && is_near(cut - 1);
        let before = is_near(cut + 1);
        let side = f64::from(i8::from(behind) - i8::from(before));
        let is_end = cut + 1 == cuts.count;
        let to = if is_end {
            &mut found.ends
        } else {
            &mut found.cuts
        };
        let value = expected(if is_end { length } else { station }, side);
        for (k, (written, scale)) in written.into_iter().zip([force, force, moment]).enumerate() {
            let difference = written.unwrap_or(f64::NAN) - value[k];
            let unit = if k < 2 { "N" } else { "N m" };
            to.add(difference, scale, unit, || {
                format!("section {name}, row {row}, {station} m, {}", columns[k + 1])
            });
        }
    }
    found
}

/// Stations that differ by less than this part of the length are one.
const STATION_TOLERANCE: f64 = 1e-11;

/// Axial force, shear and bending moment by what is on the far side of a cut: they hold the near part as the far part's
/// forces less its inertia. A cut is at a station, before (−1) or behind (+1) the forces there.
fn far_part(
    applied: &[Applied],
    mass: Option<&Bar>,
    [station, side]: [f64; 2],
    length: f64,
) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let slack = STATION_TOLERANCE * length;
    let side = if side == 0.0 { 1.0 } else { side };
    for force in applied {
        // What is beyond the far end acts at it, and nothing in front of the near one is beyond a cut.
        let is_at_end = force.station >= length - slack;
        if is_at_end || (force.station > slack && force.station > station + side * slack) {
            sum[0] += force.along;
            sum[1] += force.across;
            sum[2] += (force.station - station) * force.across + force.couple;
        }
    }
    if let Some(bar) = mass {
        // Gauss's three points are exact for the cubic of the moment.
        let half = 0.5 * (length - station);
        for (x, weight) in [
            (-0.6_f64.sqrt(), 5.0 / 9.0),
            (0.0, 8.0 / 9.0),
            (0.6_f64.sqrt(), 5.0 / 9.0),
        ] {
            let at = station + half * (1.0 + x);
            let [along, across] = bar
                .acceleration(at)
                .map(|a| a * bar.density * weight * half);
            sum[0] -= along;
            sum[1] -= across;
            sum[2] -= (at - station) * across;
        }
    }
    sum
}

/// A uniform bar: its accelerations less gravity along and across the line, at both ends.
struct Bar {
    density: f64,
    length: f64,
    ends: [[f64; 2]; 2],
}

impl Bar {
    fn acceleration(&self, station: f64) -> [f64; 2] {
        let share = station / self.length;
        let [a, b] = self.ends;
        [0, 1].map(|k| a[k] + share * (b[k] - a[k]))
    }
}

/// The line of a link in the plane.
struct Line {
    origin: [f64; 2],
    direction: [f64; 2],
}

impl Line {
    /// The parts of a vector along and across it.
    fn parts(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [ux, uy] = self.direction;
        [x * ux + y * uy, y * ux - x * uy]
    }

    /// A force at its foot on the line.
    fn applied(&self, force: [f64; 2], place: [f64; 2], couple: f64) -> Applied {
        let [station, offset] = self.parts([0, 1].map(|k| place[k] - self.origin[k]));
        let [along, across] = self.parts(force);
        Applied {
            station,
            along,
            across,
            couple: couple - offset * along,
        }
    }
}

/// The forces on a body by their feet on the line of a link, and the bar's mass if it is uniform. None where a reaction
/// is not in the file, or a couple acts on the body that no joint places.
fn forces_on(motion: &Motion<'_>, link: &Link) -> Option<(Vec<Applied>, Option<Bar>)> {
    let (reading, body) = (motion.reading, link.body);
    let ends = link.ends.map(|point| motion.point(Place { body, point }));
    let [[ax, ay], [bx, by]] = ends.map(|end| end.order(0));
    let length = (bx - ax).hypot(by - ay);
    let line = Line {
        origin: [ax, ay],
        direction: [(bx - ax) / length, (by - ay) / length],
    };
    let wrenches = placed_wrenches(motion, body)?;
    let applied =
        |(wrench, place): &(Wrench, [f64; 2])| line.applied(wrench.force, *place, wrench.couple);
    let mut all: Vec<Applied> = wrenches.iter().map(applied).collect();
    let loads = reading.loads.iter();
    let gravity = loads.fold([0.0; 2], |[x, y], load| match load.kind {
        LoadKind::Gravity([gx, gy]) => [x + gx, y + gy],
        _ => [x, y],
    });
    let body = &reading.bodies[link.body];
    let middle = [0, 1].map(|k| 0.5 * (link.ends[0][k] + link.ends[1][k]));
    let bar = body.mass * length * length / 12.0;
    let off_center = (body.center[0] - middle[0]).hypot(body.center[1] - middle[1]);
    if off_center <= 1e-9 * length && (body.inertia - bar).abs() <= 1e-9 * bar {
        let ends = ends.map(|end| {
            let [x, y] = end.order(2);
            line.parts([x - gravity[0], y - gravity[1]])
        });
        return Some((
            all,
            Some(Bar {
                density: body.mass / length,
                length,
                ends,
            }),
        ));
    }
    let center = motion.center(link.body);
    let [x, y] = center.order(2);
    let force = [body.mass * (gravity[0] - x), body.mass * (gravity[1] - y)];
    let couple = -body.inertia * motion.bodies[link.body].angle.0[2];
    all.push(line.applied(force, center.order(0), couple));
    Some((all, None))
}

/// What joints, actuators, loads but weights, and friction exert on a body, and where.
fn placed_wrenches(motion: &Motion<'_>, body: usize) -> Option<Vec<(Wrench, [f64; 2])>> {
    let reading = motion.reading;
    let mut wrenches = written_joint_wrenches(motion, "", &actuator_forces(motion))?;
    let is_weight = |kind: &LoadKind| matches!(kind, LoadKind::Gravity(_));
    for load in reading.loads.iter().filter(|load| !is_weight(&load.kind)) {
        wrenches.extend(load.wrenches(motion)?);
    }
    for friction in &reading.frictions {
        let reaction = reaction(motion, &reading.joints[friction.joint], "")?;
        wrenches.extend(friction.wrenches(motion, &reaction)?);
    }
    let place = |(k, wrench): (usize, &Wrench)| match wrench.force {
        // Couples come in pairs, one behind the other, with the bodies between which they act.
        [0.0, 0.0] if wrench.couple != 0.0 => {
            let is_opposite = |w: &&Wrench| w.body != body && w.couple == -wrench.couple;
            let neighbours = [k.checked_sub(1), Some(k + 1)].into_iter().flatten();
            let other = neighbours
                .filter_map(|k| wrenches.get(k))
                .find(is_opposite)?
                .body;
            Some((*wrench, couple_place(motion, body, other)?))
        }
        _ => Some((*wrench, wrench.point)),
    };
    let all = wrenches.iter().enumerate();
    all.filter(|(_, w)| w.body == body).map(place).collect()
}

/// Where a couple between two bodies acts: at the only joint of both.
fn couple_place(motion: &Motion<'_>, body: usize, other: usize) -> Option<[f64; 2]> {
    let between = |joint: &&Joint| {
        let bodies = joint.places.map(|p| p.body);
        bodies == [body, other] || bodies == [other, body]
    };
    let mut joints = motion.reading.joints.iter().filter(between);
    let joint = joints.next().filter(|_| joints.next().is_none())?;
    Some(motion.point(joint.places[1]).order(0))
}
