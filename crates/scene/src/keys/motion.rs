//! The free motion: its initial state, prescribed actuators and events.

use super::ValueShape::{Boolean, Either, Kinds, Name, Number, Table as One};
use super::scene::named_table;
use super::{KeySchema, LAW, TableSchema, ValueShape, key, table};

/// A number for the only free actuator, or one for each by its name.
const PER_ACTUATOR: ValueShape = Either(&[Number, One(&BY_ACTUATOR)]);

static BY_ACTUATOR: TableSchema = named_table(
    "initial-coordinate, initial-velocity",
    "A number for each free actuator.",
    key(
        "<actuator>",
        Number,
        "angle or length",
        "The value of that actuator.",
        "30",
    ),
);

pub(crate) static MOTION: TableSchema = table(
    "[motion]",
    "A free motion under loads and drives; actuators with a motion law are prescribed. A number without a name is that of the only free actuator.",
    &[
        key(
            "initial-coordinate",
            PER_ACTUATOR,
            "angle or length",
            "Coordinate of each free actuator at t = 0.",
            "{ phi = 30 }",
        )
        .formerly(&["start"])
        .with_default("as in `[assembly]`"),
        key(
            "initial-velocity",
            PER_ACTUATOR,
            "angle/s or length/s",
            "Velocity of each free actuator at t = 0, with its sign.",
            "{ phi = 180 }",
        )
        .formerly(&["speed"])
        .with_default("0; needed where there are no loads, drives or laws"),
        key(
            "periods",
            Number,
            "",
            "Duration in periods; only with one free actuator.",
            "2",
        )
        .one_of("length"),
        key("duration", Number, "s", "Duration.", "5.0").one_of("length"),
        key(
            "prescribed",
            One(&PRESCRIBED_BY_ACTUATOR),
            "",
            "The prescribed actuators, each with its motion law.",
            "{ psi = { speed = 10.0 } }",
        )
        .formerly(&["laws"])
        .with_default("all are free"),
        key(
            "events",
            One(&EVENTS),
            "",
            "Events that are located during the motion.",
            "{ top = { reaches = \"phi\", value = 90 } }",
        )
        .with_default("none"),
    ],
);

static PRESCRIBED_BY_ACTUATOR: TableSchema = named_table(
    "[motion.prescribed]",
    "The prescribed actuators; all others are free.",
    key(
        "<actuator>",
        One(&LAW),
        "",
        "The motion law of the actuator's coordinate.",
        "{ speed = 10.0 }",
    ),
);

static EVENTS: TableSchema = named_table(
    "[motion.events]",
    "One table for each event.",
    key(
        "<event>",
        Kinds(&EVENT_KINDS),
        "",
        "The event of that name.",
        "{ revolution = \"phi\", stop = true }",
    ),
);

pub(crate) static EVENT_KINDS: [&TableSchema; 4] = [&REACHES, &REVERSES, &REACTION, &REVOLUTION];

/// The first key of an event of a coordinate.
const fn coordinate_key(name: &'static str, example: &'static str) -> KeySchema {
    let doc = "The actuator or coordinate.";
    key(name, Name("coordinate"), "", doc, example)
}

const STOP: KeySchema = key(
    "stop",
    Boolean,
    "",
    "Whether the motion ends with it.",
    "true",
)
.with_default("`false`");

static REACHES: TableSchema = table(
    "reaches",
    "A coordinate passes a value.",
    &[
        coordinate_key("reaches", "\"rise\""),
        key(
            "value",
            Number,
            "angle or length",
            "The value; an angle counts whole revolutions.",
            "320",
        ),
        STOP,
    ],
);

static REVERSES: TableSchema = table(
    "reverses",
    "A coordinate reverses: its velocity changes sign.",
    &[coordinate_key("reverses", "\"rise\""), STOP],
);

static REACTION: TableSchema = table(
    "reaction",
    "A reaction passes a value; with 0, a contact would lift off.",
    &[
        key(
            "reaction",
            Name("joint.component"),
            "",
            "The reaction.",
            "\"slide.normal\"",
        ),
        key("value", Number, "N or N m", "The value.", "-15").with_default("0"),
        STOP,
    ],
);

static REVOLUTION: TableSchema = table(
    "revolution",
    "An angle completes a revolution from its initial value, and each further one.",
    &[
        coordinate_key("revolution", "\"phi\"").formerly(&["turn"]),
        STOP,
    ],
);
