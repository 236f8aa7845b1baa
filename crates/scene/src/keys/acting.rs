//! The loads, and the friction in joints.

use super::Shape::{Either, Expression, Name, Number, Pair, Table as One, TwoNames, Word};
use super::{Key, MAGNITUDE, Shape, Table, key, table};

pub(crate) static LOADS: [&Table; 9] = [
    &GRAVITY,
    &FORCE,
    &TORQUE,
    &PUSH,
    &SLIDE,
    &SPRING,
    &TORSION,
    &DAMPER,
    &TORSION_DAMPER,
];

pub(super) const SIZE: Shape = Either(&[Number, Expression, One(&MAGNITUDE)]);

/// How strong the load is: a number, an expression or a table.
const fn size(
    name: &'static str,
    unit: &'static str,
    doc: &'static str,
    example: &'static str,
) -> Key {
    key(name, SIZE, unit, doc, example)
}

static GRAVITY: Table = table(
    "gravity",
    "The weight of every body.",
    &[key(
        "gravity",
        Pair,
        "m/s2",
        "The acceleration of gravity, in the ground.",
        "[0, -9.81]",
    )],
);

static FORCE: Table = table(
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
            "In which frame the direction is given, and with which it turns.",
            "\"body\"",
        )
        .or("`\"ground\"`"),
        size(
            "magnitude",
            "N",
            "The force: a number, an expression, or a table.",
            "\"100*max(0, sin(phi))\"",
        ),
    ],
);

static TORQUE: Table = table(
    "torque",
    "A couple.",
    &[
        key(
            "torque",
            Either(&[Name("body"), TwoNames("body")]),
            "",
            "The body it acts on, from the ground; or the first body acts on the second.",
            "[\"rod\", \"crank\"]",
        ),
        size(
            "magnitude",
            "N m",
            "The couple, counter-clockwise: a number, an expression, or a table.",
            "-3.0",
        ),
    ],
);

static PUSH: Table = table(
    "push",
    "A force between two points, along the line through them.",
    &[
        key(
            "push",
            TwoNames("body.point"),
            "",
            "The points.",
            "[\"ground.A\", \"piston.P\"]",
        ),
        size(
            "magnitude",
            "N",
            "The force, above zero where it pushes them apart: a number, an expression, or a table.",
            "50",
        ),
    ],
);

static SLIDE: Table = table(
    "slide",
    "A force along the axis of a prismatic joint or a slot, of its first body on its second.",
    &[
        key("slide", Name("joint"), "", "The joint.", "\"slide\""),
        size(
            "magnitude",
            "N",
            "The force, above zero along the axis: a number, an expression, or a table.",
            "\"-20*sign(rise.speed)\"",
        ),
    ],
);

static SPRING: Table = table(
    "spring",
    "A spring between two points; it pulls with stiffness × (length − free).",
    &[
        key(
            "spring",
            TwoNames("body.point"),
            "",
            "The points.",
            "[\"ground.A\", \"piston.P\"]",
        ),
        size(
            "stiffness",
            "N/m",
            "Its stiffness: a number, an expression, or a table.",
            "4530",
        ),
        key(
            "free",
            Number,
            "length",
            "Its free length, 0 or more.",
            "77.85",
        ),
    ],
);

static TORSION: Table = table(
    "torsion",
    "A torsional spring; its couple on the second body is −stiffness × (angle − free).",
    &[
        key(
            "torsion",
            TwoNames("body"),
            "",
            "The bodies.",
            "[\"ground\", \"crank\"]",
        ),
        size(
            "stiffness",
            "N m/rad",
            "Its stiffness: a number, an expression, or a table.",
            "10",
        ),
        key(
            "free",
            Number,
            "angle",
            "The angle of the second body from the first at which it is free.",
            "0.0",
        ),
    ],
);

static DAMPER: Table = table(
    "damper",
    "A viscous damper between two points; it resists with constant × the speed of their distance.",
    &[
        key(
            "damper",
            TwoNames("body.point"),
            "",
            "The points.",
            "[\"ground.A\", \"piston.P\"]",
        ),
        size(
            "constant",
            "N s/m",
            "Its constant: a number, an expression, or a table.",
            "100",
        ),
    ],
);

static TORSION_DAMPER: Table = table(
    "torsion-damper",
    "A viscous damper that turns; its couple on the second body is −constant × their relative speed.",
    &[
        key(
            "torsion-damper",
            TwoNames("body"),
            "",
            "The bodies.",
            "[\"ground\", \"crank\"]",
        ),
        size(
            "constant",
            "N m s/rad",
            "Its constant: a number, an expression, or a table.",
            "0.1",
        ),
    ],
);

const COEFFICIENT: Key = key(
    "coefficient",
    Number,
    "",
    "Coefficient of dry friction, 0 or more.",
    "0.1",
)
.or("no dry friction");

pub(crate) static RUBBING_PIN: Table = table(
    "[friction.<pin>]",
    "Friction in a revolute joint: dry, with the couple coefficient × radius × |reaction| × tanh(speed/fade) against the relative speed, and viscous.",
    &[
        COEFFICIENT,
        key(
            "radius",
            Number,
            "length",
            "Radius of the pin, above zero.",
            "5",
        )
        .or("none; needed with a coefficient"),
        key(
            "fade",
            Number,
            "angle/s",
            "Relative speed below which dry friction fades, above zero.",
            "0.5",
        )
        .or("0.01 rad/s"),
        key(
            "viscous",
            Number,
            "N m s/rad",
            "Viscous friction, 0 or more: the couple by the relative speed.",
            "0.002",
        )
        .or("0"),
    ],
);

pub(crate) static RUBBING_SLIDE: Table = table(
    "[friction.<slide>]",
    "Friction in a prismatic joint or a slot: dry, with the force coefficient × what presses on the guide × tanh(speed/fade) against the travel, and viscous.",
    &[
        COEFFICIENT,
        key(
            "guide",
            Number,
            "length",
            "Length of the guide of a prismatic joint, 0 or more: at its two ends the normal reaction and the moment press. With 0 the moment does not rub.",
            "40",
        )
        .or("0"),
        key(
            "fade",
            Number,
            "length/s",
            "Speed of travel below which dry friction fades, above zero.",
            "0.5",
        )
        .or("0.001 m/s"),
        key(
            "viscous",
            Number,
            "N s/m",
            "Viscous friction, 0 or more: the force by the speed of travel.",
            "3.0",
        )
        .or("0"),
    ],
);
