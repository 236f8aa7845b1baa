//! The mechanism: bodies, joints, actuators and coordinates.

use super::ValueShape::{
    Boolean, Either, Expression, Name, Names, Number, Pair, Rows, Table as One, TwoNames, TwoPairs,
};
use super::scene::POINTS;
use super::{KeySchema, PROFILE, SINUSOID, TRAPEZOID, TableSchema, key, table};

pub(crate) static BODY: TableSchema = table(
    "[bodies.<body>]",
    "A rigid body. Mass and inertia of the ground have no effect.",
    &[
        key(
            "points",
            One(&POINTS),
            "",
            "Its points: names and positions in the body's frame.",
            "{ A = [0, 0], B = [100, 0] }",
        ),
        key("mass", Number, "mass", "Its mass, 0 or more.", "2.0").with_default("0"),
        key(
            "center",
            Either(&[Name("point"), Pair]),
            "length",
            "Its centre of mass: one of its points, or [x, y].",
            "[50, 1]",
        )
        .with_default("none; needed with a mass"),
        key(
            "inertia",
            Number,
            "inertia",
            "Its moment of inertia about the centre of mass, 0 or more.",
            "1666.0",
        )
        .with_default("0"),
        key("fixed", Boolean, "", "Whether it is the ground.", "false")
            .with_default("whether its name is `ground`"),
    ],
);

pub(crate) static JOINTS: [&TableSchema; 9] = [
    &REVOLUTE, &PRISMATIC, &SLOT, &WELD, &GEAR, &RACK, &ROLLING, &DISTANCE, &COUPLING,
];

/// The first key of a joint: the two points it holds.
const fn two_points_key(name: &'static str, doc: &'static str, example: &'static str) -> KeySchema {
    key(name, TwoNames("body.point"), "", doc, example)
}

static REVOLUTE: TableSchema = table(
    "revolute",
    "A pin. Reaction: `x`, `y`.",
    &[key(
        "revolute",
        Names("body.point", 2),
        "",
        "The points that coincide. With three bodies or more on one pin, the first holds each of the others, in joints named `pin-body`.",
        "[\"ground.A\", \"crank.A\"]",
    )],
);

static PRISMATIC: TableSchema = table(
    "prismatic",
    "A sliding joint: the second body's point stays on the line through the first body's point along the axis, and the two axes stay parallel. Reaction: `normal`, `moment`.",
    &[
        two_points_key(
            "prismatic",
            "The point of each body.",
            "[\"ground.S\", \"piston.P\"]",
        ),
        key(
            "axis",
            Pair,
            "",
            "The axis, the same in the frames of both bodies.",
            "[1, 0]",
        )
        .one_of("axis"),
        key(
            "axes",
            TwoPairs,
            "",
            "The axis in the frame of each body.",
            "[[1, 0], [0, 1]]",
        )
        .one_of("axis"),
    ],
);

static SLOT: TableSchema = table(
    "slot",
    "A pin of the second body in a straight slot of the first. Reaction: `normal`.",
    &[
        two_points_key(
            "slot",
            "A point of the slot, and the pin.",
            "[\"rod.B\", \"piston.P\"]",
        ),
        key(
            "axis",
            Pair,
            "",
            "The slot's direction in the first body.",
            "[1, 0]",
        ),
    ],
);

static WELD: TableSchema = table(
    "weld",
    "A rigid connection of two bodies, whose reaction is computed. Reaction: `x`, `y`, `moment`.",
    &[
        two_points_key(
            "weld",
            "The points that coincide.",
            "[\"rod.P\", \"piston.P\"]",
        ),
        key(
            "angle",
            Number,
            "angle",
            "Angle of the second body's frame from the first's.",
            "90",
        )
        .with_default("0"),
    ],
);

/// The pressure angle of teeth.
const PRESSURE_ANGLE: KeySchema = key(
    "pressure-angle",
    Number,
    "angle",
    "Pressure angle of the teeth, above 0° and at most 45°. The teeth push each other apart with the absolute tooth force × tan(pressure-angle), along the line of centres (of a rack: normal to the pitch line). The bearings carry this separating force; the column `<joint>.separating` is its magnitude.",
    "20",
)
.with_default("no separating force");

static GEAR: TableSchema = table(
    "gear",
    "Two gears; other joints keep their centres at their distance, which has to be that of the radii to 0.2 %. They mesh as assembled. Reaction: `tooth`.",
    &[
        two_points_key("gear", "The centres.", "[\"crank.A\", \"wheel.C\"]"),
        key(
            "radii",
            Pair,
            "length",
            "The pitch radii, above zero.",
            "[30, 20]",
        ),
        key(
            "internal",
            Boolean,
            "",
            "Whether the gear with the larger radius is a ring gear around the other.",
            "true",
        )
        .with_default("`false`"),
        PRESSURE_ANGLE,
    ],
);

static RACK: TableSchema = table(
    "rack",
    "A straight rack (first body) and a pinion (second); other joints keep the centre at its distance from the pitch line, which has to be the radius to 0.2 %. Reaction: `tooth`.",
    &[
        two_points_key(
            "rack",
            "A point of the pitch line, and the pinion's centre.",
            "[\"piston.P\", \"wheel.C\"]",
        ),
        key(
            "axis",
            Pair,
            "",
            "The pitch line's direction in the first body.",
            "[1, 0]",
        ),
        key(
            "radius",
            Number,
            "length",
            "Pitch radius; below zero for a pinion to the right of the axis.",
            "20",
        ),
        PRESSURE_ANGLE,
    ],
);

static ROLLING: TableSchema = table(
    "rolling",
    "A disc (second body) that rolls on a straight track of the first. Reaction: `normal`, `tangent`.",
    &[
        two_points_key(
            "rolling",
            "A point of the track, and the disc's centre.",
            "[\"ground.T\", \"wheel.C\"]",
        ),
        key(
            "axis",
            Pair,
            "",
            "The track's direction in the first body.",
            "[1, 0]",
        ),
        key(
            "radius",
            Number,
            "length",
            "Radius; below zero for a disc to the right of the axis.",
            "20",
        ),
    ],
);

static DISTANCE: TableSchema = table(
    "distance",
    "Two points keep a constant distance, as if joined by a massless link. Reaction: `axial`.",
    &[
        two_points_key("distance", "The two points.", "[\"crank.B\", \"piston.P\"]"),
        key(
            "length",
            Number,
            "length",
            "The distance, above zero.",
            "200",
        ),
    ],
);

static COUPLING: TableSchema = table(
    "coupling",
    "A constraint by which one coordinate is a function of another, such as the travel of a cam follower and the angle of the cam (not the shaft coupling, a machine element). Reaction: `force` for a travel or length, `moment` for an angle.",
    &[
        key(
            "coupling",
            TwoNames("coordinate"),
            "",
            "The first coordinate is the function's value, the second its variable.",
            "[\"rise\", \"phi\"]",
        )
        .formerly(&["relation"]),
        key(
            "expression",
            Expression,
            "SI",
            "The function, of the variable x.",
            "\"0.01*(1 - cos(x))\"",
        )
        .one_of("law"),
        key(
            "table",
            Rows,
            "angle or length",
            "Points [x, y] of the function; a smooth curve passes through them, and goes on along its end tangents.",
            "[[0, 0], [90, 10], [180, 12]]",
        )
        .one_of("law"),
        key(
            "sinusoid",
            One(&SINUSOID),
            "",
            "A sinusoid.",
            "{ amplitude = 10, period = 360 }",
        )
        .one_of("law"),
        key(
            "polynomial345",
            One(&PROFILE),
            "",
            "A rise by the 3-4-5 polynomial.",
            "{ rise = 10, duration = 120 }",
        )
        .one_of("law"),
        key(
            "polynomial4567",
            One(&PROFILE),
            "",
            "A rise by the 4-5-6-7 polynomial.",
            "{ rise = 10, duration = 120 }",
        )
        .one_of("law"),
        key(
            "cycloidal",
            One(&PROFILE),
            "",
            "A cycloidal rise.",
            "{ rise = 10, duration = 120 }",
        )
        .one_of("law"),
        key(
            "trapezoidal",
            One(&TRAPEZOID),
            "",
            "A rise with trapezoidal velocity.",
            "{ rise = 10, duration = 120, ramp = 30 }",
        )
        .one_of("law"),
        key(
            "start",
            Number,
            "angle or length",
            "Start value of a sinusoid or a rise.",
            "5",
        )
        .with_default("0"),
    ],
);

/// The keys of a coupling that give its law.
pub(crate) const COUPLING_LAWS: [&str; 7] = [
    "expression",
    "table",
    "sinusoid",
    "polynomial345",
    "polynomial4567",
    "cycloidal",
    "trapezoidal",
];

pub(crate) static ACTUATOR: TableSchema = table(
    "[actuators.<actuator>]",
    "What the actuator drives.",
    &[
        key("angle", TwoNames("body"), "", "The angle of the second body from the first; it exerts a torque.", "[\"ground\", \"crank\"]").one_of("measure"),
        key("length", Either(&[Name("joint"), TwoNames("body.point")]), "", "The travel of a prismatic joint or a slot, or the distance of two points; it exerts a force.", "\"slide\"").one_of("measure"),
    ],
);

pub(crate) static COORDINATE: TableSchema = table(
    "[coordinates.<coordinate>]",
    "What the coordinate measures.",
    &[
        key("angle", TwoNames("body"), "", "The angle of the second body from the first.", "[\"ground\", \"rod\"]").one_of("measure"),
        key("travel", Name("joint"), "", "The travel of a prismatic joint or a slot: how far the second point is from the first along the axis.", "\"slide\"").one_of("measure"),
        key("length", TwoNames("body.point"), "", "The distance of two points.", "[\"ground.A\", \"piston.P\"]").one_of("measure"),
    ],
);
