//! Prescribed motions, sweeps, and the laws they are made of.

use super::Shape::{Count, Either, Expression, Number, Pair, Rows, Table as One};
use super::{Key, Shape, Table, key, table};

pub(crate) static PRESCRIBED: Table = Table {
    name: "[prescribed]",
    doc: "A prescribed motion. Every actuator has its law.",
    keys: &[
        key("duration", Number, "s", "How long it lasts.", "2.0"),
        key(
            "points",
            Count,
            "",
            "At how many times it is evaluated.",
            "401",
        )
        .or("361"),
    ],
    named: Some(key(
        "<actuator>",
        One(&LAW),
        "",
        "The law of the actuator's coordinate.",
        "{ speed = 10.0 }",
    )),
};

pub(crate) static LAW: Table = table(
    "[prescribed.<actuator>]",
    "The law of a coordinate in time: one of these. A speed, a sine and a rise start from the coordinate in `[assembly]`.",
    &[
        key(
            "speed",
            Number,
            "angle/s or length/s",
            "A constant speed.",
            "10.0",
        )
        .one_of("law"),
        key(
            "sinusoid",
            One(&SINUSOID),
            "",
            "A sine about where it starts.",
            "{ amplitude = 0.3, period = 2.0 }",
        )
        .one_of("law"),
        key(
            "polynomial345",
            One(&PROFILE),
            "",
            "A rise by the 3-4-5 polynomial.",
            "{ rise = 1.0, duration = 0.5 }",
        )
        .one_of("law"),
        key(
            "polynomial4567",
            One(&PROFILE),
            "",
            "A rise by the 4-5-6-7 polynomial.",
            "{ rise = 1.0, duration = 0.5 }",
        )
        .one_of("law"),
        key(
            "cycloidal",
            One(&PROFILE),
            "",
            "A cycloidal rise.",
            "{ rise = 1.0, duration = 0.5 }",
        )
        .one_of("law"),
        key(
            "trapezoidal",
            One(&TRAPEZOID),
            "",
            "A rise with a trapezoidal speed.",
            "{ rise = 1.0, duration = 0.5, ramp = 0.1 }",
        )
        .one_of("law"),
        key(
            "table",
            Rows,
            "s, angle or length",
            "Points [t, q]; a smooth curve passes through them.",
            "[[0, 0], [1, 0.5], [2, 2]]",
        )
        .one_of("law"),
        key(
            "expression",
            Expression,
            "SI",
            "The coordinate as a function of the time t.",
            "\"0.5*t^2\"",
        )
        .one_of("law"),
    ],
);

pub(crate) static SINUSOID: Table = table(
    "sinusoid",
    "start + amplitude (sin(2π x/period + phase) − sin(phase)), where x is the time or the other coordinate of a relation.",
    &[
        key(
            "amplitude",
            Number,
            "angle or length",
            "The amplitude.",
            "0.3",
        ),
        key(
            "period",
            Number,
            "s, angle or length",
            "The period, above zero.",
            "2.0",
        ),
        key("phase", Number, "angle", "The phase at the start.", "0.5").or("0"),
    ],
);

const RISE: Key = key("rise", Number, "angle or length", "How far it goes.", "1.0");
const DURATION: Key = key(
    "duration",
    Number,
    "s, angle or length",
    "How long the rise takes, above zero: in time, or of a relation's other coordinate.",
    "0.5",
);
const DELAY: Key = key(
    "delay",
    Number,
    "s, angle or length",
    "How long it rests before.",
    "0.1",
)
.or("0");

pub(crate) static PROFILE: Table = table(
    "polynomial345, polynomial4567, cycloidal",
    "From rest to rest; at rest before and after.",
    &[RISE, DURATION, DELAY],
);

pub(crate) static TRAPEZOID: Table = table(
    "trapezoidal",
    "From rest to rest, the speed rising, staying and falling; at rest before and after.",
    &[
        RISE,
        DURATION,
        DELAY,
        key(
            "ramp",
            Number,
            "s, angle or length",
            "How long the speed rises, and falls: above zero, at most half of the duration.",
            "0.1",
        ),
    ],
);

/// A range that is swept, or a coordinate that is held.
const SWEPT: Shape = Either(&[Number, Pair]);

pub(crate) static SWEEP: Table = Table {
    name: "[sweep]",
    doc: "The positions at which kinematics, statics and kinetostatics are evaluated where no motion is prescribed: one actuator is swept at constant speed, the others are held.",
    keys: &[
        key("points", Count, "", "How many positions.", "181").or("361"),
        key(
            "speed",
            Number,
            "angle/s or length/s",
            "Speed of the swept actuator in kinematics and kinetostatics, above zero; statics is at rest.",
            "2.0",
        )
        .or("1 rad/s or 1 m/s"),
    ],
    named: Some(
        key(
            "<actuator>",
            SWEPT,
            "angle or length",
            "From where to where the actuator is swept, or the number at which it is held.",
            "[0.0, 6.28]",
        )
        .or("held as in `[assembly]`; the only one is swept over its range"),
    ),
};

pub(crate) static MAGNITUDE: Table = table(
    "magnitude, stiffness, constant",
    "A function through points.",
    &[
        key(
            "table",
            Rows,
            "s, angle, length or their speeds; SI",
            "Points [x, magnitude]; a smooth curve passes through them. A run ends where x leaves them: an angle counts whole turns, so they have to go as far as it does.",
            "[[0, 1], [1, 2]]",
        ),
        key(
            "of",
            Shape::Name("signal"),
            "",
            "What x is: `t`, a coordinate such as `phi`, or a speed such as `phi.speed`.",
            "\"phi\"",
        )
        .or("`\"t\"`"),
    ],
);
