//! The drawing of a mechanism: outlines fixed to bodies, the placements of bodies in each row, and the columns of arrows.

use serde::Serialize;

/// A mechanism in the plane or in space. Points have two or three numbers, in m, in the frame of a body.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawing {
    /// Reference length of symbols, in space half the length of a hinge, m.
    pub size: f64,
    /// In space the initial direction of view, rad: azimuth about z and elevation. `None` in the plane.
    pub view: Option<[f64; 2]>,
    /// The bodies.
    pub bodies: Vec<DrawnBody>,
    /// Its parts, from the back to the front.
    pub parts: Vec<Part>,
    /// Forces that can be shown as arrows.
    pub arrows: Vec<ForceArrow>,
    /// Points whose paths can be shown.
    pub paths: Vec<DrawnPath>,
}

/// A body.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DrawnBody {
    /// Its name.
    pub name: String,
    /// The index of its colour: six of the palette, then ink; `None` for the ground.
    pub paint: Option<usize>,
    /// Its placement in each row: in the plane x, y (m) and the angle (rad); in space x, y, z (m) and the first two columns
    /// of its rotation matrix. Empty for a fixed body. Stored in single precision, because they are only drawn.
    pub placements: Vec<Vec<f64>>,
}

/// A point of a body.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Anchor {
    /// The body.
    pub body: usize,
    /// The point in its frame, m.
    pub point: Vec<f64>,
}

/// The kind of an outline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum OutlineLook {
    /// A bar through points on one line.
    Bar,
    /// A plate through three points or more.
    Plate,
    /// A block that slides.
    Block,
    /// A wheel: its centre, and a point of its rim.
    Wheel,
    /// The barrel of a cylinder.
    Barrel,
    /// A thin rod on which something slides.
    Guide,
    /// A thin line from a body to its centre of mass.
    Arm,
    /// The curve of a cam.
    Cam,
    /// An open part of the curve of a cam.
    OpenCam,
    /// A rack with its teeth.
    Rack,
    /// A slot or a guide of a moving body.
    Slot,
    /// A line of the ground, hatched on its right.
    GroundLine,
}

/// The kind of a connection of two points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LinkLook {
    /// A rod of a cylinder, or a massless rod.
    Rod,
    /// A driven length: the barrel of a cylinder in the first half.
    Cylinder,
    /// A spring.
    Spring,
    /// A damper.
    Damper,
    /// A rod through a sleeve, which extends beyond both ends.
    Shaft,
    /// The arrow of a driven length.
    Drive,
}

/// The symbol of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MarkLook {
    /// A pin.
    #[default]
    Pin,
    /// The bearing of a pin on the ground, drawn behind the bodies.
    Support,
    /// A weld.
    Weld,
    // In space.
    /// A hinge.
    Hinge,
    /// A sleeve on a rod.
    Sleeve,
    /// A screw with a right-handed thread.
    Screw,
    /// A screw with a left-handed thread.
    LeftScrew,
    /// A block that slides.
    Slide,
    /// A ball.
    Ball,
    /// A ball at the end of a massless rod.
    RodEnd,
    /// One of the forks of a universal joint, towards its normal, with its arm of the cross.
    Fork,
    /// The middle of a universal joint.
    Cross,
    /// A plate on which a disc slides, with its normal as the axis.
    Plate,
    /// A disc that slides on a plate.
    Disc,
    /// Teeth, with the normal of their flanks as the axis.
    Teeth,
    /// The arrow of an actuator about an axis.
    Turned,
    /// The arrow of an actuator along an axis.
    Pushed,
    /// A body of one point.
    Ring,
    /// The centre of mass of a body.
    CenterOfMass,
}

/// A symbol at a point of a body.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Mark {
    /// Its kind.
    pub look: MarkLook,
    /// Where it is.
    pub at: Anchor,
    /// The body in whose frame the axis and the normal are given.
    pub frame: usize,
    /// The axis, a unit vector; empty without axis.
    pub axis: Vec<f64>,
    /// A unit vector perpendicular to the axis, or empty.
    pub normal: Vec<f64>,
    /// The body whose colour it has.
    pub body: usize,
    /// For a symbol on the ground, a point opposite the ground, such as the middle of the moving body; for a slide, the ends of its rail.
    pub ground: Vec<Anchor>,
    /// Its label, or empty.
    pub label: String,
    /// Its description, such as `revolute joint A of ground and crank`.
    pub title: String,
}

/// A part of a drawing.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "part", rename_all = "kebab-case")]
pub enum Part {
    /// A line or an area that moves with a body.
    Outline {
        /// Its kind.
        look: OutlineLook,
        /// The body.
        body: usize,
        /// Its points in the frame of the body, m.
        points: Vec<Vec<f64>>,
    },
    /// A connection of two points.
    Link {
        /// Its kind.
        look: LinkLook,
        /// Its ends.
        ends: [Anchor; 2],
        /// For a rod through a sleeve, its axis in the frame of the first end; otherwise empty.
        axis: Vec<f64>,
        /// The body to which it belongs; `None` for massless parts.
        body: Option<usize>,
        /// Its description.
        title: String,
    },
    /// A symbol.
    Mark(Mark),
}

/// A component of a force: a column along a unit vector.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForcePart {
    /// The column, N.
    pub column: usize,
    /// The unit vector of a positive force.
    pub axis: Vec<f64>,
}

/// The direction of a force.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "direction", rename_all = "kebab-case")]
pub enum Direction {
    /// Its components along the axes of the ground, by column.
    Components {
        /// The columns, N.
        columns: Vec<usize>,
    },
    /// Along directions of a body.
    Body {
        /// The body.
        body: usize,
        /// The perpendicular components of the force, in the frame of the body.
        parts: Vec<ForcePart>,
        /// From the anchor to the point of action, m, in the frame of the same body; empty if the force acts at the anchor. The
        /// pitch point of a rack is fixed in neither body, but at a constant offset from the pinion's centre in the frame of the rack.
        offset: Vec<f64>,
    },
    /// Along a line from one point to another in the plane, and perpendicular to it.
    Line {
        /// The points.
        ends: [Anchor; 2],
        /// The perpendicular components of the force: the first number of an axis is along the line, the second along the line
        /// rotated by +90°.
        parts: Vec<ForcePart>,
        /// The position of the point of action on the line: 0 at its start, 1 at its end; it may be outside.
        place: f64,
    },
}

/// A force that can be shown as an arrow.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForceArrow {
    /// The joint or the load.
    pub name: String,
    /// `Reactions` or `Loads`: forces of a group have one scale.
    pub group: String,
    /// Its description.
    pub title: String,
    /// Whether it is shown initially.
    pub initially_visible: bool,
    /// The point of action; ignored for a force along a line.
    pub at: Anchor,
    /// Its direction.
    #[serde(flatten)]
    pub direction: Direction,
}

/// A point whose path can be shown.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DrawnPath {
    /// The point.
    pub at: Anchor,
    /// Its name, such as `coupler.P`.
    pub name: String,
    /// Whether the scene requests it; then it is shown initially.
    pub requested: bool,
}
