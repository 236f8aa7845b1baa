//! The drives.

use super::Shape::{Name, Number};
use super::acting::SIZE;
use super::{Key, Table, key, table};

pub(crate) static DRIVES: [&Table; 3] = [&ACTION, &MOTOR, &REGULATOR];

/// The first key of a drive: what it drives.
const fn driven(name: &'static str) -> Key {
    let doc = "The actuator or coordinate that it drives.";
    key(name, Name("coordinate"), "", doc, "\"phi\"")
}

static ACTION: Table = table(
    "action",
    "A couple or force that grows the coordinate where it is above zero.",
    &[
        driven("action"),
        key(
            "magnitude",
            SIZE,
            "N or N m",
            "The action: a number, an expression, or a table.",
            "\"2 - 0.1*phi.speed\"",
        ),
    ],
);

static MOTOR: Table = table(
    "motor",
    "A motor of direct current behind a gear: inductance × d(current)/dt = voltage − resistance × current − constant × speed of its shaft; its torque is constant × current. It is told by its circuit, or by the line of its torque over its speed.",
    &[
        driven("motor"),
        key(
            "voltage",
            SIZE,
            "V",
            "The voltage: a number, an expression, or a table.",
            "12",
        )
        .in_set("circuit"),
        key(
            "constant",
            Number,
            "N m/A",
            "Torque by current, and voltage by speed, above zero.",
            "0.05",
        )
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
            "stall",
            Number,
            "N m",
            "Torque of its shaft at rest, above zero.",
            "0.5",
        )
        .in_set("line"),
        key(
            "idle",
            Number,
            "angle/s",
            "Speed of its shaft without torque, above zero.",
            "14000",
        )
        .in_set("line"),
        key(
            "inductance",
            Number,
            "H",
            "Inductance of the winding, 0 or more; not beside a line.",
            "0.002",
        )
        .or("0: the current follows at once"),
        key(
            "ratio",
            Number,
            "rad/m for a length",
            "Turns of its shaft by those of the coordinate, not 0; below zero it turns the other way.",
            "20",
        )
        .or("1"),
        key(
            "inertia",
            Number,
            "inertia",
            "Moment of inertia of the rotor, 0 or more.",
            "3.5",
        )
        .or("0"),
    ],
);

static REGULATOR: Table = table(
    "regulator",
    "A regulator of speed: its action is proportional × e + integral × ∫e dt, where e is the wanted speed less the speed of the coordinate.",
    &[
        driven("regulator"),
        key(
            "speed",
            SIZE,
            "angle/s or length/s",
            "The wanted speed: a number, an expression (in SI), or a table.",
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
        .or("0"),
        key(
            "limit",
            Number,
            "N m or N",
            "Largest action in either direction, above zero.",
            "10",
        )
        .or("unlimited"),
    ],
);
