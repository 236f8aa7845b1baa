//! The loads, and the friction in joints.

use super::ValueShape::{Either, Expression, Name, Number, Pair, Table as One, TwoNames, Word};
use super::{KeySchema, MAGNITUDE, TableSchema, ValueShape, key, table};

pub(crate) static LOADS: [&TableSchema; 9] = [
    &GRAVITY,
    &FORCE,
    &TORQUE,
    &POINT_TO_POINT_FORCE,
    &SLIDE_FORCE,
    &SPRING,
    &TORSION_SPRING,
    &DAMPER,
    &ROTATIONAL_DAMPER,
];

pub(super) const MAGNITUDE_SHAPE: ValueShape = Either(&[Number, Expression, One(&MAGNITUDE)]);

/// The magnitude of a load: a number, an expression or a table.
const fn magnitude_key(
    name: &'static str,
    unit: &'static str,
    doc: &'static str,
    example: &'static str,
) -> KeySchema {
    key(name, MAGNITUDE_SHAPE, unit, doc, example)
}

static GRAVITY: TableSchema = table(
    "gravity",
    "The weight of every body.",
    &[key(
        "gravity",
        Pair,
        "m/s2",
        "The acceleration of gravity, in the ground's frame.",
        "[0, -9.81]",
    )],
);

static FORCE: TableSchema = table(
    "force",
    "A force at a point of a body.",
    &[
        key(
            "force",
            Name("body.point"),
            "",
            "The point it acts at.",
            "\"piston.P\"",
        ),
        key("direction", Pair, "", "Its direction.", "[-1, 0]"),
        key(
            "frame",
            Word(&["ground", "body"]),
            "",
            "The frame in which the direction is given and constant.",
            "\"body\"",
        )
        .with_default("`\"ground\"`"),
        magnitude_key(
            "magnitude",
            "N",
            "The force: a number, an expression, or a table.",
            "\"100*max(0, sin(phi))\"",
        ),
    ],
);

static TORQUE: TableSchema = table(
    "torque",
    "A torque.",
    &[
        key(
            "torque",
            Either(&[Name("body"), TwoNames("body")]),
            "",
            "The body it acts on, with its reaction on the ground; or two bodies: the first acts on the second.",
            "[\"rod\", \"crank\"]",
        ),
        magnitude_key(
            "magnitude",
            "N m",
            "The torque, counter-clockwise positive: a number, an expression, or a table.",
            "-3.0",
        ),
    ],
);

static POINT_TO_POINT_FORCE: TableSchema = table(
    "point-to-point-force",
    "A force between two points, along the line through them.",
    &[
        key(
            "point-to-point-force",
            TwoNames("body.point"),
            "",
            "The points.",
            "[\"ground.A\", \"piston.P\"]",
        )
        .formerly(&["push"]),
        magnitude_key(
            "magnitude",
            "N",
            "The force; positive values push the points apart: a number, an expression, or a table.",
            "50",
        ),
    ],
);

static SLIDE_FORCE: TableSchema = table(
    "slide-force",
    "A force along the axis of a prismatic joint or a slot, of its first body on its second.",
    &[
        key("slide-force", Name("joint"), "", "The joint.", "\"slide\"").formerly(&["slide"]),
        magnitude_key(
            "magnitude",
            "N",
            "The force, positive along the axis: a number, an expression, or a table.",
            "\"-20*sign(rise.velocity)\"",
        ),
    ],
);

static SPRING: TableSchema = table(
    "spring",
    "A spring between two points; its tension is stiffness × (length − free-length).",
    &[
        key(
            "spring",
            TwoNames("body.point"),
            "",
            "The points.",
            "[\"ground.A\", \"piston.P\"]",
        ),
        magnitude_key(
            "stiffness",
            "N/m",
            "Its stiffness: a number, an expression, or a table.",
            "4530",
        ),
        key(
            "free-length",
            Number,
            "length",
            "Its length without force, 0 or more.",
            "77.85",
        )
        .formerly(&["free"]),
    ],
);

static TORSION_SPRING: TableSchema = table(
    "torsion-spring",
    "A torsional spring; its torque on the second body is −stiffness × (angle − free-angle).",
    &[
        key(
            "torsion-spring",
            TwoNames("body"),
            "",
            "The bodies.",
            "[\"ground\", \"crank\"]",
        )
        .formerly(&["torsion"]),
        magnitude_key(
            "stiffness",
            "N m/rad",
            "Its stiffness: a number, an expression, or a table.",
            "10",
        ),
        key(
            "free-angle",
            Number,
            "angle",
            "The angle of the second body from the first at which the torque is zero.",
            "0.0",
        )
        .formerly(&["free"]),
    ],
);

static DAMPER: TableSchema = table(
    "damper",
    "A viscous damper between two points; its force is damping × the rate of their distance, and opposes it.",
    &[
        key(
            "damper",
            TwoNames("body.point"),
            "",
            "The points.",
            "[\"ground.A\", \"piston.P\"]",
        ),
        magnitude_key(
            "damping",
            "N s/m",
            "Its damping coefficient: a number, an expression, or a table.",
            "100",
        )
        .formerly(&["constant"]),
    ],
);

static ROTATIONAL_DAMPER: TableSchema = table(
    "rotational-damper",
    "A viscous rotational damper; its torque on the second body is −damping × the relative angular velocity.",
    &[
        key(
            "rotational-damper",
            TwoNames("body"),
            "",
            "The bodies.",
            "[\"ground\", \"crank\"]",
        )
        .formerly(&["torsion-damper"]),
        magnitude_key(
            "damping",
            "N m s/rad",
            "Its damping coefficient: a number, an expression, or a table.",
            "0.1",
        )
        .formerly(&["constant"]),
    ],
);

const COEFFICIENT: KeySchema = key(
    "coefficient",
    Number,
    "",
    "Coefficient of dry friction, 0 or more.",
    "0.1",
)
.with_default("no dry friction");

pub(crate) static REVOLUTE_FRICTION: TableSchema = table(
    "[friction.<pin>]",
    "Friction in a revolute joint: dry, with the torque coefficient × radius × |reaction| × tanh(speed/regularization-speed) against the relative angular velocity, and viscous.",
    &[
        COEFFICIENT,
        key(
            "radius",
            Number,
            "length",
            "Radius of the pin, above zero.",
            "5",
        )
        .with_default("none; needed with a coefficient"),
        key(
            "regularization-speed",
            Number,
            "angle/s",
            "Relative speed below which dry friction is smoothed, above zero.",
            "0.5",
        )
        .formerly(&["fade"])
        .with_default("0.01 rad/s"),
        key(
            "viscous",
            Number,
            "N m s/rad",
            "Viscous friction, 0 or more: torque per relative angular velocity.",
            "0.002",
        )
        .with_default("0"),
    ],
);

pub(crate) static PRISMATIC_FRICTION: TableSchema = table(
    "[friction.<slide>]",
    "Friction in a prismatic joint or a slot: dry, with the force coefficient × normal force on the guide × tanh(speed/regularization-speed) against the sliding velocity, and viscous.",
    &[
        COEFFICIENT,
        key(
            "guide-length",
            Number,
            "length",
            "Length of the guide of a prismatic joint, 0 or more. The normal reaction and the moment act as two forces at its ends; with 0 the moment causes no friction.",
            "40",
        )
        .formerly(&["guide"])
        .with_default("0"),
        key(
            "regularization-speed",
            Number,
            "length/s",
            "Sliding speed below which dry friction is smoothed, above zero.",
            "0.5",
        )
        .formerly(&["fade"])
        .with_default("0.001 m/s"),
        key(
            "viscous",
            Number,
            "N s/m",
            "Viscous friction, 0 or more: force per sliding velocity.",
            "3.0",
        )
        .with_default("0"),
    ],
);
