//! The outputs of a recording as quantities and signals.

use super::machine_numbers::{GradientScene, WantedOf};
use crate::machines::CoordinateOf;
use crate::trajectory::compute::{Dyad, Quantity, RowScene, Signal, TrajectorySample};
use dwell_geometry::JointId;
use dwell_kinetostatics::WantedMotion;

/// A point that is an output.
#[derive(Debug, Clone, PartialEq)]
struct WantedPoint {
    body: usize,
    /// Its place in the frame of the body, m.
    at: [f64; 3],
    source: PointSource,
}

/// What gives a point its place in a variant of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
enum PointSource {
    /// The point of this number among the named ones of the body.
    Named(usize),
    /// The line of a dyad, by its number and side, from the origin.
    Line(usize, usize),
    /// The origin of the body.
    Origin,
    /// The point at unit distance along its first axis.
    Axis,
}

/// Where a recording has its outputs.
#[derive(Debug, Clone)]
pub(crate) struct RecordedOutputs {
    actuators: usize,
    reactions: usize,
    /// By wanted coordinate: its number among the measured ones.
    measured: Vec<usize>,
    points: Vec<WantedPoint>,
    /// By dyad of a transmission angle: the numbers of the points that are the ends of its lines, each after the origin of its body.
    dyads: Vec<(Dyad, [usize; 4])>,
    /// By body in the plane whose rotation is wanted: the numbers of its origin and of the point on its first axis.
    turns: Vec<(usize, [usize; 2])>,
    dimension: usize,
}

impl RecordedOutputs {
    /// The outputs that the signals of a scene need, of a model with so many actuators and reactions. `None` if a point has no name.
    pub(super) fn new<S: GradientScene>(
        scene: &S,
        model: &S::Model,
        [actuators, reactions]: [usize; 2],
        signals: &[Signal],
    ) -> Option<Self> {
        let mut found = Self {
            actuators,
            reactions,
            measured: Vec::new(),
            points: Vec::new(),
            dyads: Vec::new(),
            turns: Vec::new(),
            dimension: S::DIMENSION,
        };
        let named = scene.named_points();
        for quantity in signals.iter().flat_map(Signal::quantities) {
            match quantity {
                Quantity::Measured(k, _) if !found.measured.contains(&k) => found.measured.push(k),
                Quantity::Point(body, at, ..) => {
                    let mut places = named[body.0].1.iter();
                    let k = places.position(|(_, place)| *place == at)?;
                    found.point(body.0, at, PointSource::Named(k));
                }
                Quantity::Rotation(body, 0, _) if S::DIMENSION == 2 => {
                    let origin = found.point(body.0, [0.0; 3], PointSource::Origin);
                    let end = found.point(body.0, [1.0, 0.0, 0.0], PointSource::Axis);
                    found.turns.push((body.0, [origin, end]));
                }
                Quantity::TransmissionAngle(dyad) => {
                    let mut dyads = scene.dyads(model).into_iter();
                    let number = dyads.position(|other| other == dyad)?;
                    found.add_dyad(number, dyad);
                }
                _ => {}
            }
        }
        Some(found)
    }

    /// The number of a point among the outputs.
    fn point(&mut self, body: usize, at: [f64; 3], source: PointSource) -> usize {
        let wanted = WantedPoint { body, at, source };
        let known = self.points.iter().position(|point| *point == wanted);
        known.unwrap_or_else(|| {
            self.points.push(wanted);
            self.points.len() - 1
        })
    }

    fn add_dyad(&mut self, number: usize, dyad: Dyad) {
        if self.dyads.iter().any(|(known, _)| *known == dyad) {
            return;
        }
        let mut places = [0; 4];
        for (side, (body, [x, y])) in dyad.lines().into_iter().enumerate() {
            places[2 * side] = self.point(body.0, [0.0; 3], PointSource::Origin);
            let source = PointSource::Line(number, side);
            places[2 * side + 1] = self.point(body.0, [x, y, 0.0], source);
        }
        self.dyads.push((dyad, places));
    }

    /// What is wanted of the states of a scene or of a variant of it, whose structure is that of the model.
    pub(crate) fn wanted_in<S: GradientScene>(
        &self,
        scene: &S,
        model: &S::Model,
    ) -> Option<WantedOf<S>> {
        let coordinates = self.measured.iter().map(|&k| coordinate(scene, k));
        let (named, dyads) = (scene.named_points(), scene.dyads(model));
        let place = |point: &WantedPoint| match point.source {
            PointSource::Named(k) => named[point.body].1.get(k).map(|(_, at)| *at),
            PointSource::Origin => Some([0.0; 3]),
            PointSource::Axis => Some([1.0, 0.0, 0.0]),
            PointSource::Line(number, side) => {
                let (_, [x, y]) = dyads.get(number)?.lines()[side];
                Some([x, y, 0.0])
            }
        };
        let points = self.points.iter();
        let points = points.map(|point| Some((point.body.into(), S::point(place(point)?))));
        Some(WantedMotion {
            coordinates: coordinates.collect::<Option<_>>()?,
            points: points.collect::<Option<_>>()?,
        })
    }

    /// The output that a quantity is; none of a coordinate of an actuator, which no number changes.
    pub(crate) fn place(&self, quantity: Quantity) -> Option<usize> {
        let coordinates = self.actuators + self.reactions;
        match quantity {
            Quantity::ActuatorForce(i) => Some(i),
            Quantity::Reaction(k) => Some(self.actuators + k),
            Quantity::Measured(k, order) => {
                let at = self.measured.iter().position(|m| *m == k)?;
                Some(coordinates + 3 * at + order)
            }
            Quantity::Point(body, at, order, axis) => {
                let is_it = |p: &WantedPoint| {
                    matches!(p.source, PointSource::Named(_)) && (p.body, p.at) == (body.0, at)
                };
                let k = self.points.iter().position(is_it)?;
                Some(self.point_output(k) + self.dimension * order + axis)
            }
            Quantity::ShakingForce(axis) => Some(self.point_output(self.points.len()) + axis),
            _ => None,
        }
    }

    /// The first output of a point.
    fn point_output(&self, k: usize) -> usize {
        let first = self.actuators + self.reactions + 3 * self.measured.len();
        first + 3 * self.dimension * k
    }

    /// The outputs on which a signal depends.
    pub(crate) fn places(&self, signal: &Signal) -> Vec<usize> {
        let quantities = signal.quantities().into_iter();
        let places = quantities.flat_map(|quantity| match quantity {
            Quantity::TransmissionAngle(dyad) => self.line_outputs(dyad).to_vec(),
            Quantity::Rotation(body, ..) => self.turn_outputs(body.0).to_vec(),
            other => self.place(other).into_iter().collect(),
        });
        places.collect()
    }

    /// The outputs of the first axis of a body: x and y of its origin and of its end.
    fn turn_outputs(&self, body: usize) -> [usize; 4] {
        let known = self.turns.iter().find(|(known, _)| *known == body);
        let points = known.map_or([0; 2], |(_, points)| *points);
        std::array::from_fn(|k| self.point_output(points[k / 2]) + k % 2)
    }

    /// The outputs of the lines of a dyad: x and y of an origin and of the end of a line, twice.
    fn line_outputs(&self, dyad: Dyad) -> [usize; 8] {
        let known = self.dyads.iter().find(|(known, _)| *known == dyad);
        let points = known.map_or([0; 4], |(_, points)| *points);
        std::array::from_fn(|k| self.point_output(points[k / 2]) + k % 2)
    }

    /// The value of a signal where the outputs have these values.
    pub(crate) fn value(
        &self,
        signal: &Signal,
        output: &dyn Fn(usize) -> f64,
        sample: &TrajectorySample,
    ) -> f64 {
        let component = |quantity: Quantity| match quantity {
            Quantity::Time => sample.t,
            Quantity::ActuatorCoordinate(i, order) => {
                [&sample.q, &sample.q_dot, &sample.q_ddot][order][i]
            }
            Quantity::TransmissionAngle(dyad) => self.angle(dyad, output).0,
            Quantity::Rotation(body, ..) => {
                let of = self.turn_outputs(body.0).map(output);
                (of[3] - of[1]).atan2(of[2] - of[0])
            }
            other => self.place(other).map_or(f64::NAN, output),
        };
        match signal {
            Signal::Column(column) => component(column.quantity),
            Signal::Norm(all) => {
                let squares = all.iter().map(|of| component(*of).powi(2));
                squares.sum::<f64>().sqrt()
            }
            Signal::Power(i) => output(*i) * sample.q_dot[*i],
            Signal::Distance(_) => f64::NAN,
        }
    }

    /// The angle between the lines of a dyad, from 0 to π rad, and its derivatives by their components.
    fn angle(&self, dyad: Dyad, output: &dyn Fn(usize) -> f64) -> (f64, [f64; 4]) {
        let of = self.line_outputs(dyad).map(output);
        let [ax, ay, bx, by] = [of[2] - of[0], of[3] - of[1], of[6] - of[4], of[7] - of[5]];
        let (cross, dot) = (ax * by - ay * bx, ax * bx + ay * by);
        let (sign, a, b) = (cross.signum(), ax * ax + ay * ay, bx * bx + by * by);
        let slopes = [ay / a, -ax / a, -by / b, bx / b].map(|slope| sign * slope);
        (cross.abs().atan2(dot), slopes)
    }

    /// The outputs on which a signal depends, with its derivatives by them, where outputs and velocities have these values.
    pub(crate) fn slopes(
        &self,
        signal: &Signal,
        output: &dyn Fn(usize) -> f64,
        q_dot: &[f64],
    ) -> Vec<(usize, f64)> {
        match signal {
            Signal::Column(column) => match column.quantity {
                Quantity::TransmissionAngle(dyad) => {
                    let (_, [ax, ay, bx, by]) = self.angle(dyad, output);
                    let slopes = [-ax, -ay, ax, ay, -bx, -by, bx, by];
                    self.line_outputs(dyad).into_iter().zip(slopes).collect()
                }
                Quantity::Rotation(body, ..) => {
                    let places = self.turn_outputs(body.0);
                    let of = places.map(output);
                    // The axis has unit length.
                    let (x, y) = (of[2] - of[0], of[3] - of[1]);
                    places.into_iter().zip([y, -x, -y, x]).collect()
                }
                other => self.place(other).map(|k| (k, 1.0)).into_iter().collect(),
            },
            Signal::Norm(components) => {
                let places = components.iter().filter_map(|c| self.place(*c));
                let places: Vec<usize> = places.collect();
                let squares = places.iter().map(|k| output(*k) * output(*k));
                let norm = squares.sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
                places.into_iter().map(|k| (k, output(k) / norm)).collect()
            }
            Signal::Power(i) => vec![(*i, q_dot[*i])],
            Signal::Distance(_) => Vec::new(),
        }
    }
}

/// Whether a quantity of scenes of a kind is an output of a recording, or depends on no number.
pub(crate) fn is_recorded<S: RowScene>(quantity: Quantity) -> bool {
    use Quantity as Q;
    match quantity {
        Q::Time | Q::ActuatorCoordinate(..) | Q::ActuatorForce(_) | Q::Reaction(_) => true,
        Q::Measured(..) | Q::Point(..) | Q::TransmissionAngle(_) => true,
        Q::ShakingForce(_) | Q::Rotation(_, 0, _) => S::DIMENSION == 2,
        _ => false,
    }
}

/// A measured coordinate by its number, as of [`RowScene::measured`].
fn coordinate<S: RowScene>(scene: &S, k: usize) -> Option<CoordinateOf<S>> {
    let named = scene.named_coordinates();
    match k.checked_sub(named.len()) {
        None => Some(named[k].coordinate),
        Some(joint) => (joint < scene.joint_names().len()).then(|| S::travel(JointId(joint))),
    }
}
