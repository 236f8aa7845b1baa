//! The drives.

use super::ValueShape::{Name, Number};
use super::loads::MAGNITUDE_SHAPE;
use super::{KeySchema, TableSchema, key, table};

pub(crate) static DRIVES: [&TableSchema; 3] = [&APPLIED_FORCE, &MOTOR, &SPEED_CONTROLLER];

/// The first key of a drive: what it drives.
const fn coordinate_key(name: &'static str, former: &'static [&'static str]) -> KeySchema {
    let doc = "The actuator or coordinate that it drives.";
    key(name, Name("coordinate"), "", doc, "\"phi\"").formerly(former)
}

static APPLIED_FORCE: TableSchema = table(
    "applied-force",
    "A generalised force along the coordinate: a torque on an angle, a force on a length. Positive values increase the coordinate.",
    &[
        coordinate_key("applied-force", &["action"]),
        key(
            "magnitude",
            MAGNITUDE_SHAPE,
            "N or N m",
            "The force or torque: a number, an expression, or a table.",
            "\"2 - 0.1*phi.velocity\"",
        ),
    ],
);

static MOTOR: TableSchema = table(
    "motor",
    "A DC motor with a gear: inductance × d(current)/dt = voltage − resistance × current − torque-constant × motor speed; its torque is torque-constant × current. It is given by its circuit, or by its torque–speed line.",
    &[
        coordinate_key("motor", &[]),
        key(
            "voltage",
            MAGNITUDE_SHAPE,
            "V",
            "The voltage: a number, an expression, or a table.",
            "12",
        )
        .in_set("circuit"),
        key(
            "torque-constant",
            Number,
            "N m/A",
            "Torque per current, which is also the induced voltage per motor speed; above zero.",
            "0.05",
        )
        .formerly(&["constant"])
        .in_set("circuit"),
        key(
            "resistance",
            Number,
            "ohm",
            "Resistance of the winding, above zero.",
            "1.2",
        )
        .in_set("circuit"),
        key(
            "stall-torque",
            Number,
            "N m",
            "Torque of the motor shaft at rest, above zero.",
            "0.5",
        )
        .formerly(&["stall"])
        .in_set("line"),
        key(
            "no-load-speed",
            Number,
            "angle/s",
            "Speed of the motor shaft without load, above zero.",
            "14000",
        )
        .formerly(&["idle"])
        .in_set("line"),
        key(
            "inductance",
            Number,
            "H",
            "Inductance of the winding, 0 or more; only with the circuit.",
            "0.002",
        )
        .with_default("0: the current follows without delay"),
        key(
            "gear-ratio",
            Number,
            "rad/m for a length",
            "Speed of the motor shaft divided by that of the coordinate, not 0; below zero they have opposite directions.",
            "20",
        )
        .formerly(&["ratio"])
        .with_default("1"),
        key(
            "inertia",
            Number,
            "inertia",
            "Moment of inertia of the rotor, 0 or more.",
            "3.5",
        )
        .with_default("0"),
    ],
);

static SPEED_CONTROLLER: TableSchema = table(
    "speed-controller",
    "A PI controller of the speed: its force or torque is proportional × e + integral × ∫e dt, where e is the reference speed minus the velocity of the coordinate.",
    &[
        coordinate_key("speed-controller", &["regulator"]),
        key(
            "speed",
            MAGNITUDE_SHAPE,
            "angle/s or length/s",
            "The reference speed: a number, an expression (in SI), or a table.",
            "180",
        ),
        key(
            "proportional",
            Number,
            "N m s/rad or N s/m",
            "Its proportional gain, 0 or more.",
            "2.0",
        ),
        key(
            "integral",
            Number,
            "N m/rad or N/m",
            "Its integral gain, 0 or more.",
            "5.0",
        )
        .with_default("0"),
        key(
            "limit",
            Number,
            "N m or N",
            "Largest force or torque in either direction, above zero.",
            "10",
        )
        .with_default("unlimited"),
    ],
);
