//! Prescribed motions, sweeps, and the laws they are made of.

use super::ValueShape::{Count, Either, Expression, Number, Pair, Rows, Table as One};
use super::{KeySchema, TableSchema, ValueShape, key, table};

pub(crate) static PRESCRIBED: TableSchema = TableSchema {
    name: "[prescribed]",
    doc: "A prescribed motion: every actuator has a motion law.",
    keys: &[
        key("duration", Number, "s", "Duration.", "2.0"),
        key(
            "points",
            Count,
            "",
            "Number of times at which it is evaluated.",
            "401",
        )
        .with_default("361"),
    ],
    named: Some(key(
        "<actuator>",
        One(&LAW),
        "",
        "The motion law of the actuator's coordinate.",
        "{ speed = 10.0 }",
    )),
};

pub(crate) static LAW: TableSchema = table(
    "[prescribed.<actuator>], [motion.prescribed.<actuator>]",
    "The motion law of a coordinate: exactly one of these keys. A speed, a sinusoid and a rise start from the coordinate in `[assembly]`.",
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
            "A sinusoid from its start value.",
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
            "A rise with trapezoidal velocity.",
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

pub(crate) static SINUSOID: TableSchema = table(
    "sinusoid",
    "start + amplitude (sin(2π x/period + phase) − sin(phase)), where x is the time or the independent coordinate of a coupling.",
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
        key("phase", Number, "angle", "The phase at the start.", "0.5").with_default("0"),
    ],
);

const RISE: KeySchema = key("rise", Number, "angle or length", "Displacement.", "1.0");
const DURATION: KeySchema = key(
    "duration",
    Number,
    "s, angle or length",
    "Duration of the rise, above zero: in time, or in the independent coordinate of a coupling.",
    "0.5",
);
const DELAY: KeySchema = key(
    "delay",
    Number,
    "s, angle or length",
    "Dwell before the rise.",
    "0.1",
)
.with_default("0");

pub(crate) static PROFILE: TableSchema = table(
    "polynomial345, polynomial4567, cycloidal",
    "A rise from rest to rest; constant before and after.",
    &[RISE, DURATION, DELAY],
);

pub(crate) static TRAPEZOID: TableSchema = table(
    "trapezoidal",
    "A rise from rest to rest with constant acceleration, velocity and deceleration in turn; constant before and after.",
    &[
        RISE,
        DURATION,
        DELAY,
        key(
            "ramp",
            Number,
            "s, angle or length",
            "Duration of the acceleration, and of the deceleration: above zero, at most half of the whole.",
            "0.1",
        ),
    ],
);

/// The interval of the swept coordinate, or the value of a fixed one.
const SWEPT_OR_FIXED: ValueShape = Either(&[Number, Pair]);

pub(crate) static COORDINATE_SWEEP: TableSchema = TableSchema {
    name: "[coordinate-sweep]",
    doc: "The positions at which kinematics, statics and kinetostatics are evaluated where no motion is prescribed: one actuator is swept at constant speed, the others are fixed.",
    keys: &[
        key("points", Count, "", "Number of positions.", "181").with_default("361"),
        key(
            "speed",
            Number,
            "angle/s or length/s",
            "Speed of the swept actuator in kinematics and kinetostatics, above zero; statics is at rest.",
            "2.0",
        )
        .with_default("1 rad/s or 1 m/s"),
    ],
    named: Some(
        key(
            "<actuator>",
            SWEPT_OR_FIXED,
            "angle or length",
            "The interval over which the actuator is swept, or the value at which it is fixed.",
            "[0.0, 6.28]",
        )
        .with_default("fixed as in `[assembly]`; a single actuator is swept over its range"),
    ),
};

pub(crate) static MAGNITUDE: TableSchema = table(
    "magnitude, stiffness, damping, voltage, speed",
    "A tabulated function of one variable.",
    &[
        key(
            "table",
            Rows,
            "s, angle, length or their speeds; SI, but a reference speed in angle/s or length/s",
            "Points [x, magnitude]; a smooth curve passes through them. An analysis stops where x leaves the table: an angle counts whole revolutions, and the table has to cover them.",
            "[[0, 1], [1, 2]]",
        ),
        key(
            "of",
            ValueShape::Name("signal"),
            "",
            "The variable x: `t`, a coordinate such as `phi`, or a velocity such as `phi.velocity`.",
            "\"phi\"",
        )
        .with_default("`\"t\"`"),
    ],
);
