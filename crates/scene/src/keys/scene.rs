//! The scene itself, and the sections that hold no mechanism.

use super::ValueShape::{Either, Kinds, Name, Names, Number, Table as One, Tables, Text, Word};
use super::{
    ACTUATOR, BODY, COORDINATE, COORDINATE_SWEEP, DRIVES, JOINTS, LOADS, MOTION, PRESCRIBED,
    PRISMATIC_FRICTION, REVOLUTE_FRICTION,
};
use super::{KeySchema, TableSchema, ValueShape, key, table};
use crate::units::{ANGLE_NAMES, LENGTH_NAMES, MASS_NAMES};

/// A table whose keys are all names of the scene's own.
pub(super) const fn named_table(
    name: &'static str,
    doc: &'static str,
    named: KeySchema,
) -> TableSchema {
    TableSchema {
        name,
        doc,
        keys: &[],
        named: Some(named),
    }
}

pub(crate) static SCENE: TableSchema = table(
    "the scene",
    "A scene is a TOML file. Only `[bodies]` and `[joints]` are needed.",
    &[
        key("title", Text, "", "One line at the head of a report.", "\"Slider-crank\"")
            .with_default("the file's name"),
        key("note", Text, "", "A remark that is shown with all results.", "\"A reconstruction.\"")
            .with_default("none"),
        key("units", One(&UNITS), "", "The units of the numbers below.", "{ length = \"mm\" }").with_default("SI"),
        key("bodies", One(&BODIES), "", "The rigid bodies, the ground among them.", "{ crank = { points = { A = [0, 0], B = [100, 0] } } }"),
        key("joints", One(&ALL_JOINTS), "", "The joints between the bodies.", "{ A = { revolute = [\"ground.A\", \"crank.A\"] } }"),
        key("actuators", One(&ACTUATORS), "", "The independent coordinates, prescribed or free.", "{ phi = { angle = [\"ground\", \"crank\"] } }")
            .with_default("none"),
        key("coordinates", One(&COORDINATES), "", "Named coordinates: angles, travels and distances.", "{ rise = { travel = \"slide\" } }")
            .with_default("none"),
        key("assembly", One(&ASSEMBLY), "", "The coordinates at assembly, and initial guesses that select the assembly mode.", "{ phi = 0.5, rod = -0.2 }")
            .with_default("all 0, no initial guesses"),
        key("prescribed", One(&PRESCRIBED), "", "A prescribed motion: each actuator's coordinate as a function of time.", "{ duration = 2.0, phi = { speed = 10.0 } }")
            .with_default("none"),
        key("coordinate-sweep", One(&COORDINATE_SWEEP), "", "The positions at which kinematics, statics and kinetostatics are evaluated where no motion is prescribed.", "{ phi = [0.0, 6.28] }")
            .with_default("the whole range, or one turn").formerly(&["sweep"]),
        key("loads", One(&ALL_LOADS), "", "The loads on the mechanism.", "{ weight = { gravity = [0, -9.81] } }")
            .with_default("none"),
        key("friction", One(&FRICTION), "", "The friction in the joints.", "{ A = { coefficient = 0.1, radius = 5 } }")
            .with_default("none"),
        key("drives", One(&ALL_DRIVES), "", "The drives of a free motion.", "{ engine = { applied-force = \"phi\", magnitude = 2.0 } }")
            .with_default("none"),
        key("requests", One(&REQUESTS), "", "Which results are wanted.", "{ paths = [\"rod.P\"] }")
            .with_default("everything"),
        key("motion", One(&MOTION), "", "A free motion.", "{ initial-velocity = 10.0, periods = 2 }").with_default("none"),
        key("calibration", One(&CALIBRATION), "", "One number of the scene, fitted so that the free motion has a given period.", "{ parameter = \"rod.mass\", period = 5.42 }")
            .with_default("none"),
    ],
);

pub(crate) static UNITS: TableSchema = table(
    "[units]",
    "The units of the numbers of the scene. Forces, couples, stiffnesses, gravity and time are always in SI.",
    &[
        key("length", Word(&LENGTH_NAMES), "", "Lengths.", "\"mm\"").with_default("`\"m\"`"),
        key("mass", Word(&MASS_NAMES), "", "Masses.", "\"kg\"").with_default("`\"kg\"`"),
        key(
            "inertia",
            Text,
            "",
            "Moments of inertia: a mass unit and a squared length unit.",
            "\"kg mm2\"",
        )
        .with_default(
            "`\"kg m2\"`; required with a length unit other than m or a mass unit other than kg",
        ),
        key("angle", Word(&ANGLE_NAMES), "", "Angles.", "\"deg\"").with_default("`\"rad\"`"),
    ],
);

static BODIES: TableSchema = named_table(
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

static ALL_JOINTS: TableSchema = named_table(
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

static ACTUATORS: TableSchema = named_table(
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

static COORDINATES: TableSchema = named_table(
    "[coordinates]",
    "One table for each named coordinate. The coordinate of an actuator has the actuator's name.",
    key(
        "<coordinate>",
        One(&COORDINATE),
        "",
        "The coordinate of that name.",
        "{ travel = \"slide\" }",
    ),
);

static ALL_LOADS: TableSchema = named_table(
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

static FRICTION: TableSchema = named_table(
    "[friction]",
    "One table for each joint with friction: revolute joints, prismatic joints and slots. The table of a pin of several bodies holds for each of its joints.",
    key(
        "<joint>",
        Either(&[One(&REVOLUTE_FRICTION), One(&PRISMATIC_FRICTION)]),
        "",
        "The friction in the joint of that name.",
        "{ coefficient = 0.1, radius = 5 }",
    ),
);

static ALL_DRIVES: TableSchema = named_table(
    "[drives]",
    "One table for each drive. It acts on a free coordinate: a prescribed actuator has no drive.",
    key(
        "<drive>",
        Kinds(&DRIVES),
        "",
        "The drive of that name.",
        "{ motor = \"phi\", stall-torque = 0.5, no-load-speed = 14000, gear-ratio = 20 }",
    ),
);

pub(crate) static ASSEMBLY: TableSchema = named_table(
    "[assembly]",
    "Selects the assembly mode. The coordinate of an actuator is exact. The angle of a body is an initial guess (only gears mesh exactly at the angles given here), and so is the value of a joint: the travel of a prismatic joint or slot, the direction of a distance. Of several assembly modes, the one nearest to all given values is selected. A name shared by a body and a joint means the body.",
    key(
        "<actuator, body or joint>",
        Number,
        "angle or length",
        "The coordinate of the actuator at assembly; or an initial guess of the body's angle, or of the joint's travel or direction.",
        "90",
    )
    .with_default("0 for an actuator, but required where it drives a distance of two points; no initial guess of a body or a joint"),
);

pub(crate) static REQUESTS: TableSchema = table(
    "[requests]",
    "Which results are wanted.",
    &[
        key("reactions", Names("joint or joint.component", 0), "", "Reactions of joints.", "[\"A\", \"slide.normal\"]")
            .with_default("all"),
        key("paths", Names("body.point", 0), "", "Points whose paths are drawn.", "[\"rod.P\"]").with_default("none"),
        key("dwell", One(&DWELL), "", "A dwell that is marked in the results.", "{ body = \"rod\", relative-band = 0.02 }").with_default("none"),
        key("variables", Names("variable", 0), "", "Columns of the tables, such as `crank.angle`, `rod.P.x`, `phi.actuator_force`, `A.magnitude`, `rocker.mechanical_advantage`, `coupler.velocity_pole` or the name of a coordinate.", "[\"crank.angle\", \"rod.P.x\"]")
            .with_default("all"),
        key("sections", Tables(&SECTION), "", "Links along which axial force, shear and bending moment are wanted.", "[{ body = \"rod\", from = \"B\", to = \"P\" }]")
            .with_default("none"),
    ],
);

pub(crate) static DWELL: TableSchema = table(
    "dwell",
    "Where the angle of a body stays within a fraction of its angular range.",
    &[
        key("body", Name("body"), "", "The body.", "\"rod\""),
        key(
            "relative-band",
            Number,
            "",
            "The fraction, between 0 and 1.",
            "0.02",
        )
        .formerly(&["band"]),
    ],
);

pub(crate) static SECTION: TableSchema = table(
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

pub(crate) static CALIBRATION: TableSchema = table(
    "[calibration]",
    "One number of the scene fitted to a period of the free motion.",
    &[
        key(
            "parameter",
            Name("number"),
            "",
            "The number, by its path.",
            "\"rod.mass\"",
        )
        .formerly(&["set"]),
        key("period", Number, "s", "The period.", "5.42"),
    ],
);

/// The points of a body.
pub(crate) static POINTS: TableSchema = named_table(
    "points",
    "The points of a body, in its frame.",
    key(
        "<point>",
        ValueShape::Pair,
        "length",
        "The point of that name.",
        "[100, 0]",
    ),
);
