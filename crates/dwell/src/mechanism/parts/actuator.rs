//! Actuators and named coordinates.

use super::Keys;

/// An actuator: an independent coordinate, which is prescribed or free.
///
/// ```
/// use dwell::Actuator;
/// let [crank, cylinder] = [Actuator::angle("ground", "crank"), Actuator::length("ground.T", "boom.P")];
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Actuator(pub(crate) Keys);

impl Actuator {
    /// In the plane: the angle of the second body from the first, rad.
    ///
    /// ```
    /// let phi = dwell::Actuator::angle("ground", "crank");
    /// ```
    pub fn angle(first: &str, second: &str) -> Self {
        Self(Keys::new("angle", [first, second]))
    }

    /// The angle of a joint in space, rad.
    ///
    /// ```
    /// let phi = dwell::Actuator::joint_angle("A");
    /// ```
    pub fn joint_angle(joint: &str) -> Self {
        Self(Keys::new("angle", joint))
    }

    /// The travel of a joint in space, m.
    ///
    /// ```
    /// let feed = dwell::Actuator::joint_travel("slide");
    /// ```
    pub fn joint_travel(joint: &str) -> Self {
        Self(Keys::new("travel", joint))
    }

    /// The distance of two points, m.
    ///
    /// ```
    /// let cylinder = dwell::Actuator::length("ground.T", "boom.P");
    /// ```
    pub fn length(first: &str, second: &str) -> Self {
        Self(Keys::new("length", [first, second]))
    }

    /// In the plane: the travel of a prismatic joint or a slot, m.
    ///
    /// ```
    /// let feed = dwell::Actuator::travel("guide");
    /// ```
    pub fn travel(joint: &str) -> Self {
        Self(Keys::new("length", joint))
    }
}

/// A named coordinate, on which loads, laws and events can depend.
///
/// ```
/// let rise = dwell::Coordinate::travel("guide");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Coordinate(pub(crate) Keys);

impl Coordinate {
    /// The angle of a joint in space, rad.
    ///
    /// ```
    /// let swing = dwell::Coordinate::joint_angle("D");
    /// ```
    pub fn joint_angle(joint: &str) -> Self {
        Self(Keys::new("angle", joint))
    }

    /// In the plane: the angle of the second body from the first, rad.
    ///
    /// ```
    /// let swing = dwell::Coordinate::angle("ground", "rocker");
    /// ```
    pub fn angle(first: &str, second: &str) -> Self {
        Self(Keys::new("angle", [first, second]))
    }

    /// The travel of a prismatic joint or a slot, m.
    ///
    /// ```
    /// let rise = dwell::Coordinate::travel("guide");
    /// ```
    pub fn travel(joint: &str) -> Self {
        Self(Keys::new("travel", joint))
    }

    /// The distance of two points, m.
    ///
    /// ```
    /// let gap = dwell::Coordinate::length("ground.A", "piston.P");
    /// ```
    pub fn length(first: &str, second: &str) -> Self {
        Self(Keys::new("length", [first, second]))
    }
}
