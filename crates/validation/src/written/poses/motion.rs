//! How the bodies move in a row of a file: position, velocity and acceleration of every body, from its angle and one of its
//! points as they are written.

use super::jet::{Jet, JetVector};
use super::reading::{Body, Measure, Place, Reading};
use super::rows::Rows;

/// The motion of all bodies in one row of a file.
#[derive(Debug, Clone)]
pub(crate) struct Motion<'a> {
    pub(crate) reading: &'a Reading,
    pub(crate) rows: &'a Rows,
    pub(crate) row: usize,
    pub(crate) bodies: Vec<Frame>,
}

/// A body's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    pub(crate) origin: JetVector,
    pub(crate) angle: Jet,
}

impl<'a> Motion<'a> {
    /// The motion in a row; none where a column is missing. A file without velocities is one of rest.
    pub(crate) fn new(reading: &'a Reading, rows: &'a Rows, row: usize) -> Option<Self> {
        let frame = |body: &Body| {
            if body.is_ground {
                return Some(Frame {
                    origin: JetVector::constant([0.0; 2]),
                    angle: Jet::constant(0.0),
                });
            }
            let ends = [".angle", ".angular_velocity", ".angular_acceleration"];
            let angle = rows.jet(row, &body.name, ends)?;
            let (point, at) = body.points.first()?;
            let point = point_in(rows, row, &body.name, point)?;
            let origin = point.minus(JetVector::rotated(*at, angle));
            Some(Frame { origin, angle })
        };
        let bodies = reading.bodies.iter().map(frame).collect::<Option<_>>()?;
        Some(Self {
            reading,
            rows,
            row,
            bodies,
        })
    }

    /// The motions in all rows; none where a column is missing.
    pub(crate) fn of_all(reading: &'a Reading, rows: &'a Rows) -> Option<Vec<Self>> {
        (0..rows.count)
            .map(|row| Self::new(reading, rows, row))
            .collect()
    }

    /// A number of the row.
    pub(crate) fn get(&self, name: &str) -> Option<f64> {
        self.rows.get(self.row, name)
    }

    /// The variable of the row.
    pub(crate) fn time(&self) -> f64 {
        self.rows.time(self.row)
    }

    /// The point of a body.
    pub(crate) fn point(&self, place: Place) -> JetVector {
        let Frame { origin, angle } = self.bodies[place.body];
        origin.plus(JetVector::rotated(place.point, angle))
    }

    /// A direction of a body.
    pub(crate) fn direction(&self, body: usize, direction: [f64; 2]) -> JetVector {
        JetVector::rotated(direction, self.bodies[body].angle)
    }

    /// From the first place to the second.
    pub(crate) fn gap(&self, places: [Place; 2]) -> JetVector {
        self.point(places[1]).minus(self.point(places[0]))
    }

    /// The angle of the second body from the first.
    pub(crate) fn relative_angle(&self, [first, second]: [usize; 2]) -> Jet {
        self.bodies[second].angle - self.bodies[first].angle
    }

    /// A coordinate.
    pub(crate) fn measure(&self, measure: Measure) -> Jet {
        match measure {
            Measure::Angle(bodies) => self.relative_angle(bodies),
            Measure::Travel(places, axis) => {
                self.gap(places).dot(self.direction(places[0].body, axis))
            }
            Measure::Length(places) => self.gap(places).length(),
        }
    }

    /// The same positions without velocities and accelerations.
    pub(crate) fn at_rest(&self) -> Self {
        let frame = |frame: &Frame| Frame {
            origin: JetVector::constant(frame.origin.order(0)),
            angle: Jet::constant(frame.angle.value()),
        };
        Self {
            bodies: self.bodies.iter().map(frame).collect(),
            ..*self
        }
    }

    /// The centre of mass of a body.
    pub(crate) fn center(&self, body: usize) -> JetVector {
        let point = self.reading.bodies[body].center;
        self.point(Place { body, point })
    }
}

/// A point as written.
pub(crate) fn point_in(rows: &Rows, row: usize, body: &str, point: &str) -> Option<JetVector> {
    let prefix = format!("{body}.{point}");
    let x = rows.jet(row, &prefix, [".x", ".vx", ".ax"])?;
    let y = rows.jet(row, &prefix, [".y", ".vy", ".ay"])?;
    Some(JetVector::new(x, y))
}
