//! The mechanism as a page draws it: what is fixed to bodies, where bodies are in each row, and which columns arrows show.

use serde::Serialize;

/// A mechanism in the plane or in space. Points have two or three numbers, in m, in the frame of a body.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawing {
    /// Reference length of symbols, in space half the length of a hinge, m.
    pub size: f64,
    /// In space the direction from which it is seen first, rad: azimuth about z and elevation. None in the plane.
    pub view: Option<[f64; 2]>,
    /// The bodies.
    pub bodies: Vec<DrawnBody>,
    /// What is drawn, from the back to the front.
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
    /// The number of its colour: six of the palette, then ink; none of the ground.
    pub paint: Option<usize>,
    /// Where it is in each row. In the plane x, y (m) and the angle (rad); in space x, y, z (m) and the first two columns
    /// of its rotation. Empty where it is fixed. They are kept in single precision, as they are only drawn.
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

/// What an outline is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum OutlineLook {
    /// A bar through points of one line.
    Bar,
    /// A plate through three points or more.
    Plate,
    /// A block that slides.
    Block,
    /// A wheel: its centre, and from there a point of its rim.
    Wheel,
    /// The barrel of a cylinder.
    Barrel,
    /// A thin rod on which something slides.
    Guide,
    /// A thin line from a body to its centre of mass.
    Arm,
    /// The curve of a cam.
    Cam,
    /// A part of such a curve.
    OpenCam,
    /// A rack with its teeth.
    Rack,
    /// A slot or a guide of a moving body.
    Slot,
    /// A line of the ground, hatched on its right.
    GroundLine,
}

/// What a connection of two points is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LinkLook {
    /// A rod: of a cylinder, or without mass.
    Rod,
    /// A driven length: the barrel of a cylinder in the first half.
    Cylinder,
    /// A spring.
    Spring,
    /// A damper.
    Damper,
    /// A rod through a sleeve, which goes on beyond both.
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
    /// The bearing of a pin on the ground, which is behind the bodies.
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
    /// That disc.
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
    /// What it is.
    pub look: MarkLook,
    /// Where it is.
    pub at: Anchor,
    /// The body in whose frame its axis and a direction across it are.
    pub frame: usize,
    /// The axis, a unit vector; empty where it has none.
    pub axis: Vec<f64>,
    /// A unit vector at right angles to the axis, or nothing.
    pub normal: Vec<f64>,
    /// The body whose colour it has.
    pub body: usize,
    /// On the ground the point from which the ground is away, such as the middle of the moving body; of a slide the ends of its rail.
    pub ground: Vec<Anchor>,
    /// Its label, or nothing.
    pub label: String,
    /// What it is in words, such as `revolute joint A of ground and crank`.
    pub title: String,
}

/// A part of a drawing.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "part", rename_all = "kebab-case")]
pub enum Part {
    /// A line or an area that moves with a body.
    Outline {
        /// What it is.
        look: OutlineLook,
        /// The body.
        body: usize,
        /// Its points in the frame of the body, m.
        points: Vec<Vec<f64>>,
    },
    /// A connection of two points.
    Link {
        /// What it is.
        look: LinkLook,
        /// Its ends.
        ends: [Anchor; 2],
        /// Of a rod through a sleeve its axis in the frame of the first end; else nothing.
        axis: Vec<f64>,
        /// The body to which it belongs; none of what has no mass.
        body: Option<usize>,
        /// What it is in words.
        title: String,
    },
    /// A symbol.
    Mark(Mark),
}

/// A part of a force: a column along a unit vector.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForcePart {
    /// The column, N.
    pub column: usize,
    /// The unit vector of a positive force.
    pub axis: Vec<f64>,
}

/// Where a force points to.
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
        /// The parts of the force, at right angles to each other, in the frame of the body.
        parts: Vec<ForcePart>,
        /// From the anchor to where the force acts, m, in the frame of the same body; empty where it acts at the anchor. The
        /// pitch point of a rack is fixed neither to the rack nor to the pinion, but beside the pinion's centre as the rack sees it.
        offset: Vec<f64>,
    },
    /// Along a line from one point to another in the plane, and across it.
    Line {
        /// The points.
        ends: [Anchor; 2],
        /// The parts of the force, at right angles to each other: the first number of an axis is along the line, the second across
        /// it, along the line turned by +90°.
        parts: Vec<ForcePart>,
        /// Where on the line it acts, from 0 to 1; it may be outside.
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
    /// What it is.
    pub title: String,
    /// Whether it is shown before anyone has chosen.
    pub initially_visible: bool,
    /// Where it acts; of one along a line the line decides.
    pub at: Anchor,
    /// Where it points to.
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
    /// Whether the scene asks for it: it is shown at first.
    pub requested: bool,
}
