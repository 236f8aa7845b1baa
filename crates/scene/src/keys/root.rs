//! The scene itself, and the sections that hold no mechanism.

use super::Shape::{Either, Kinds, Name, Names, Number, Table as One, Tables, Text, Word};
use super::{
    ACTUATOR, BODY, COORDINATE, DRIVES, JOINTS, LOADS, MOTION, PRESCRIBED, RUBBING_PIN,
    RUBBING_SLIDE, SWEEP,
};
use super::{Key, Shape, Table, key, table};
use crate::units::{ANGLE_NAMES, LENGTH_NAMES, MASS_NAMES};

/// A table whose keys are all names of the scene's own.
pub(super) const fn names(name: &'static str, doc: &'static str, named: Key) -> Table {
    Table {
        name,
        doc,
        keys: &[],
        named: Some(named),
    }
}

pub(crate) static SCENE: Table = table(
    "the scene",
    "A scene is a TOML file. Only `[bodies]` and `[joints]` are needed.",
    &[
        key("title", Text, "", "One line at the head of a report.", "\"Slider-crank\"")
            .or("the file's name"),
        key("note", Text, "", "What has to be said wherever the results are shown.", "\"A reconstruction.\"")
            .or("none"),
        key("units", One(&UNITS), "", "The units of the numbers below.", "{ length = \"mm\" }").or("SI"),
        key("bodies", One(&BODIES), "", "The rigid bodies, the ground among them.", "{ crank = { points = { A = [0, 0], B = [100, 0] } } }"),
        key("joints", One(&ALL_JOINTS), "", "What holds the bodies together.", "{ A = { revolute = [\"ground.A\", \"crank.A\"] } }"),
        key("actuators", One(&ACTUATORS), "", "The coordinates that are imposed, or move freely.", "{ phi = { angle = [\"ground\", \"crank\"] } }")
            .or("none"),
        key("coordinates", One(&COORDINATES), "", "Measures with a name.", "{ rise = { travel = \"slide\" } }")
            .or("none"),
        key("assembly", One(&ASSEMBLY), "", "Where and how the mechanism is put together.", "{ phi = 0.5, rod = -0.2 }")
            .or("all 0, nothing rough"),
        key("prescribed", One(&PRESCRIBED), "", "A prescribed motion: each actuator's coordinate as a function of time.", "{ duration = 2.0, phi = { speed = 10.0 } }")
            .or("none"),
        key("sweep", One(&SWEEP), "", "The positions at which kinematics, statics and kinetostatics are evaluated where no motion is prescribed.", "{ phi = [0.0, 6.28] }")
            .or("the whole range, or one turn"),
        key("loads", One(&ALL_LOADS), "", "What acts on the mechanism from outside.", "{ weight = { gravity = [0, -9.81] } }")
            .or("none"),
        key("friction", One(&FRICTION), "", "The friction in the joints.", "{ A = { coefficient = 0.1, radius = 5 } }")
            .or("none"),
        key("drives", One(&ALL_DRIVES), "", "What drives the mechanism in a free motion.", "{ engine = { action = \"phi\", magnitude = 2.0 } }")
            .or("none"),
        key("requests", One(&REQUESTS), "", "What the results hold.", "{ paths = [\"rod.P\"] }")
            .or("everything"),
        key("motion", One(&MOTION), "", "A free motion.", "{ speed = 10.0, periods = 2 }").or("none"),
        key("calibration", One(&CALIBRATION), "", "One number of the scene, fitted so that the free motion has a given period.", "{ set = \"rod.mass\", period = 5.42 }")
            .or("none"),
    ],
);

pub(crate) static UNITS: Table = table(
    "[units]",
    "The units of the numbers of the scene. Forces, couples, stiffnesses, gravity and time are always in SI.",
    &[
        key("length", Word(&LENGTH_NAMES), "", "Lengths.", "\"mm\"").or("`\"m\"`"),
        key("mass", Word(&MASS_NAMES), "", "Masses.", "\"kg\"").or("`\"kg\"`"),
        key(
            "inertia",
            Text,
            "",
            "Moments of inertia: a mass unit and a squared length unit.",
            "\"kg mm2\"",
        )
        .or("`\"kg m2\"`; has to be said with a length or mass unit other than SI's"),
        key("angle", Word(&ANGLE_NAMES), "", "Angles.", "\"deg\"").or("`\"rad\"`"),
    ],
);

static BODIES: Table = names(
    "[bodies]",
    "One table for each body. The body named `ground` is the ground.",
    key(
        "<body>",
        One(&BODY),
        "",
        "The body of that name.",
        "{ points = { A = [0, 0], B = [100, 0] } }",
    ),
);

static ALL_JOINTS: Table = names(
    "[joints]",
    "One table for each joint. A reaction is the action of the first-named body on the second.",
    key(
        "<joint>",
        Kinds(&JOINTS),
        "",
        "The joint of that name.",
        "{ revolute = [\"ground.A\", \"crank.A\"] }",
    ),
);

static ACTUATORS: Table = names(
    "[actuators]",
    "One table for each actuator: each imposes one independent coordinate.",
    key(
        "<actuator>",
        One(&ACTUATOR),
        "",
        "The actuator of that name.",
        "{ angle = [\"ground\", \"crank\"] }",
    ),
);

static COORDINATES: Table = names(
    "[coordinates]",
    "One table for each named measure. Every actuator is one already, under its own name.",
    key(
        "<coordinate>",
        One(&COORDINATE),
        "",
        "The coordinate of that name.",
        "{ travel = \"slide\" }",
    ),
);

static ALL_LOADS: Table = names(
    "[loads]",
    "One table for each load.",
    key(
        "<load>",
        Kinds(&LOADS),
        "",
        "The load of that name.",
        "{ gravity = [0, -9.81] }",
    ),
);

static FRICTION: Table = names(
    "[friction]",
    "One table for each joint that rubs: pins, prismatic joints and slots. Each joint of a pin of several bodies rubs as the pin's table says.",
    key(
        "<joint>",
        Either(&[One(&RUBBING_PIN), One(&RUBBING_SLIDE)]),
        "",
        "The friction in the joint of that name.",
        "{ coefficient = 0.1, radius = 5 }",
    ),
);

static ALL_DRIVES: Table = names(
    "[drives]",
    "One table for each drive. What it drives is free: an actuator that `[motion]` leads by a law has no drive.",
    key(
        "<drive>",
        Kinds(&DRIVES),
        "",
        "The drive of that name.",
        "{ motor = \"phi\", stall = 0.5, idle = 14000, ratio = 20 }",
    ),
);

pub(crate) static ASSEMBLY: Table = names(
    "[assembly]",
    "Where the mechanism is put together, which picks its branch. An actuator's coordinate is exact, a body's angle is rough (only gears mesh exactly as the angles given here say), and so is what is said of a joint: the travel of a prismatic joint or a slot, the direction of a distance. Of several ways, the one nearest to all that is said is picked. A name that is a body's and a joint's means the body.",
    key(
        "<actuator, body or joint>",
        Number,
        "angle or length",
        "The actuator's coordinate at the start, the rough angle of the body, or the rough travel or direction of the joint.",
        "90",
    )
    .or("0 for an actuator that drives no distance of two points; unknown for a body or a joint"),
);

pub(crate) static REQUESTS: Table = table(
    "[requests]",
    "What the results hold.",
    &[
        key("reactions", Names("joint or joint.component", 0), "", "Reactions of joints.", "[\"A\", \"slide.normal\"]")
            .or("all"),
        key("paths", Names("body.point", 0), "", "Points whose paths are drawn.", "[\"rod.P\"]").or("none"),
        key("dwell", One(&DWELL), "", "A dwell that is marked.", "{ body = \"rod\", band = 0.02 }").or("none"),
        key("variables", Names("variable", 0), "", "Columns of the tables, such as `crank.angle`, `rod.P.x`, `phi.action`, `A.magnitude`, `rocker.advantage`, `coupler.pole` or the name of a coordinate.", "[\"crank.angle\", \"rod.P.x\"]")
            .or("all"),
        key("sections", Tables(&SECTION), "", "Links along which axial force, shear and bending moment are wanted.", "[{ body = \"rod\", from = \"B\", to = \"P\" }]")
            .or("none"),
    ],
);

pub(crate) static DWELL: Table = table(
    "dwell",
    "Where the angle of a body stays within a fraction of its swing.",
    &[
        key("body", Name("body"), "", "The body.", "\"rod\""),
        key("band", Number, "", "The fraction, between 0 and 1.", "0.02"),
    ],
);

pub(crate) static SECTION: Table = table(
    "sections",
    "A line between two points of a body.",
    &[
        key("body", Name("body"), "", "The body.", "\"rod\""),
        key(
            "from",
            Name("point"),
            "",
            "The point where it begins.",
            "\"B\"",
        ),
        key("to", Name("point"), "", "The point where it ends.", "\"P\""),
    ],
);

pub(crate) static CALIBRATION: Table = table(
    "[calibration]",
    "One number of the scene fitted to a period of the free motion.",
    &[
        key(
            "set",
            Name("number"),
            "",
            "The number, by its path.",
            "\"rod.mass\"",
        ),
        key("period", Number, "s", "The period.", "5.42"),
    ],
);

/// The points of a body.
pub(crate) static POINTS: Table = names(
    "points",
    "The points of a body, in its frame.",
    key(
        "<point>",
        Shape::Pair,
        "length",
        "The point of that name.",
        "[100, 0]",
    ),
);
