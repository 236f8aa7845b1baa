//! The free motion: its start, the actuators that laws lead, its events.

use super::Shape::{Boolean, Either, Kinds, Name, Number, Table as One};
use super::root::names;
use super::{Key, LAW, Shape, Table, key, table};

/// A number for the only free actuator, or one for each by its name.
const EACH: Shape = Either(&[Number, One(&BY_ACTUATOR)]);

static BY_ACTUATOR: Table = names(
    "start, speed",
    "A number for each free actuator.",
    key(
        "<actuator>",
        Number,
        "angle or length",
        "That of the actuator.",
        "30",
    ),
);

pub(crate) static MOTION: Table = table(
    "[motion]",
    "A free motion: loads and drives move the actuators that no law leads. A bare number is that of the only free actuator.",
    &[
        key(
            "start",
            EACH,
            "angle or length",
            "Coordinate of each free actuator at the start.",
            "{ phi = 30 }",
        )
        .or("as in `[assembly]`"),
        key(
            "speed",
            EACH,
            "angle/s or length/s",
            "Speed of each free actuator at the start.",
            "{ phi = 180 }",
        )
        .or("0; needed where there are no loads, drives or laws"),
        key(
            "periods",
            Number,
            "",
            "How many periods it lasts, with one free actuator.",
            "2",
        )
        .one_of("length"),
        key("duration", Number, "s", "How long it lasts.", "5.0").one_of("length"),
        key(
            "laws",
            One(&LAWS),
            "",
            "The actuators that are led, each by its law.",
            "{ psi = { speed = 10.0 } }",
        )
        .or("all are free"),
        key(
            "events",
            One(&EVENTS),
            "",
            "What is looked for on the way.",
            "{ top = { reaches = \"phi\", value = 90 } }",
        )
        .or("none"),
    ],
);

static LAWS: Table = names(
    "[motion.laws]",
    "The actuators that are led; every other is free.",
    key(
        "<actuator>",
        One(&LAW),
        "",
        "The law of the actuator's coordinate.",
        "{ speed = 10.0 }",
    ),
);

static EVENTS: Table = names(
    "[motion.events]",
    "One table for each event.",
    key(
        "<event>",
        Kinds(&EVENT_KINDS),
        "",
        "The event of that name.",
        "{ turn = \"phi\", stop = true }",
    ),
);

pub(crate) static EVENT_KINDS: [&Table; 4] = [&REACHES, &REVERSES, &REACTION, &TURN];

/// The first key of an event of a coordinate.
const fn of(name: &'static str, example: &'static str) -> Key {
    let doc = "The actuator or coordinate.";
    key(name, Name("coordinate"), "", doc, example)
}

const STOP: Key = key(
    "stop",
    Boolean,
    "",
    "Whether the motion ends with it.",
    "true",
)
.or("`false`");

static REACHES: Table = table(
    "reaches",
    "A coordinate passes a value.",
    &[
        of("reaches", "\"rise\""),
        key(
            "value",
            Number,
            "angle or length",
            "The value; an angle counts whole turns.",
            "320",
        ),
        STOP,
    ],
);

static REVERSES: Table = table(
    "reverses",
    "A coordinate turns back: its speed changes sign.",
    &[of("reverses", "\"rise\""), STOP],
);

static REACTION: Table = table(
    "reaction",
    "A reaction passes a value; with 0 a contact lifts off.",
    &[
        key(
            "reaction",
            Name("joint.component"),
            "",
            "The reaction.",
            "\"slide.normal\"",
        ),
        key("value", Number, "N or N m", "The value.", "-15").or("0"),
        STOP,
    ],
);

static TURN: Table = table(
    "turn",
    "An angle completes a whole turn from where it started, and every further one.",
    &[of("turn", "\"phi\""), STOP],
);
