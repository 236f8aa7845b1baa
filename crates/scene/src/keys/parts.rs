//! What the mechanism is made of.

use super::Shape::{
    Boolean, Either, Expression, Name, Names, Number, Pair, Rows, Table as One, TwoNames, TwoPairs,
};
use super::root::POINTS;
use super::{Key, PROFILE, SINUSOID, TRAPEZOID, Table, key, table};

pub(crate) static BODY: Table = table(
    "[bodies.<body>]",
    "A rigid body. Masses of the ground are read and dropped: it does not move.",
    &[
        key(
            "points",
            One(&POINTS),
            "",
            "Its points, each a name and where it is in the body's frame.",
            "{ A = [0, 0], B = [100, 0] }",
        ),
        key("mass", Number, "mass", "Its mass, 0 or more.", "2.0").or("0"),
        key(
            "center",
            Either(&[Name("point"), Pair]),
            "length",
            "Its centre of mass: one of its points, or [x, y].",
            "[50, 1]",
        )
        .or("none; needed with a mass"),
        key(
            "inertia",
            Number,
            "inertia",
            "Its moment of inertia about the centre of mass, 0 or more.",
            "1666.0",
        )
        .or("0"),
        key("fixed", Boolean, "", "Whether it is the ground.", "false")
            .or("whether its name is `ground`"),
    ],
);

pub(crate) static JOINTS: [&Table; 9] = [
    &REVOLUTE, &PRISMATIC, &SLOT, &WELD, &GEAR, &RACK, &ROLLING, &DISTANCE, &RELATION,
];

/// The first key of a joint: the two points it holds.
const fn held(name: &'static str, doc: &'static str, example: &'static str) -> Key {
    key(name, TwoNames("body.point"), "", doc, example)
}

static REVOLUTE: Table = table(
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

static PRISMATIC: Table = table(
    "prismatic",
    "A slide: the second body's point stays on the line through the first's along the axis, and the axes keep one direction. Reaction: `normal`, `moment`.",
    &[
        held(
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

static SLOT: Table = table(
    "slot",
    "A pin of the second body in a straight slot of the first. Reaction: `normal`.",
    &[
        held(
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

static WELD: Table = table(
    "weld",
    "Two bodies that are one, so that the action between them is known. Reaction: `x`, `y`, `moment`.",
    &[
        held(
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
        .or("0"),
    ],
);

static GEAR: Table = table(
    "gear",
    "Two gears; other joints keep their centres at their distance, which has to be that of the radii to 0.2 %. They mesh as assembled. Reaction: `tooth`.",
    &[
        held("gear", "The centres.", "[\"crank.A\", \"wheel.C\"]"),
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
            "Whether the one with the larger radius is a ring around the other.",
            "true",
        )
        .or("`false`"),
    ],
);

static RACK: Table = table(
    "rack",
    "A straight rack (first body) and a pinion (second); other joints keep the centre at its distance from the pitch line, which has to be the radius to 0.2 %. Reaction: `tooth`.",
    &[
        held(
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
    ],
);

static ROLLING: Table = table(
    "rolling",
    "A disc (second body) that rolls on a straight track of the first. Reaction: `normal`, `tangent`.",
    &[
        held(
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

static DISTANCE: Table = table(
    "distance",
    "Two points keep their distance, as if by a massless link. Reaction: `axial`.",
    &[
        held("distance", "The two points.", "[\"crank.B\", \"piston.P\"]"),
        key(
            "length",
            Number,
            "length",
            "The distance, above zero.",
            "200",
        ),
    ],
);

static RELATION: Table = table(
    "relation",
    "One coordinate is a function of another, such as a cam follower's of the cam's angle. Reaction: `force` for a travel or length, `moment` for an angle.",
    &[
        key(
            "relation",
            TwoNames("coordinate"),
            "",
            "The first coordinate is the function's value, the second its variable.",
            "[\"rise\", \"phi\"]",
        ),
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
            "A sine.",
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
            "A rise of trapezoidal slope.",
            "{ rise = 10, duration = 120, ramp = 30 }",
        )
        .one_of("law"),
        key(
            "start",
            Number,
            "angle or length",
            "What a sine or a rise starts from.",
            "5",
        )
        .or("0"),
    ],
);

/// The keys of a relation that give its law.
pub(crate) const LAWS_OF_RELATIONS: [&str; 7] = [
    "expression",
    "table",
    "sinusoid",
    "polynomial345",
    "polynomial4567",
    "cycloidal",
    "trapezoidal",
];

pub(crate) static ACTUATOR: Table = table(
    "[actuators.<actuator>]",
    "What the actuator drives.",
    &[
        key("angle", TwoNames("body"), "", "The angle of the second body from the first; its action is a couple.", "[\"ground\", \"crank\"]").one_of("measure"),
        key("length", Either(&[Name("joint"), TwoNames("body.point")]), "", "The travel of a prismatic joint or a slot, or the distance of two points; its action is a force.", "\"slide\"").one_of("measure"),
    ],
);

pub(crate) static COORDINATE: Table = table(
    "[coordinates.<coordinate>]",
    "What the coordinate measures.",
    &[
        key("angle", TwoNames("body"), "", "The angle of the second body from the first.", "[\"ground\", \"rod\"]").one_of("measure"),
        key("travel", Name("joint"), "", "The travel of a prismatic joint or a slot: how far the second point is from the first along the axis.", "\"slide\"").one_of("measure"),
        key("length", TwoNames("body.point"), "", "The distance of two points.", "[\"ground.A\", \"piston.P\"]").one_of("measure"),
    ],
);
