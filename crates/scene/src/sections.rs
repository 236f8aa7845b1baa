//! Sections, titles and bodies without joints.

use crate::bodies::Bodies;
use crate::diagnostics::{Diagnostics, Span};
use crate::dimensions::{Dimensions, Notation};
use crate::error::SceneError;
use crate::keys::table;
use crate::spans::SceneLocation;
use crate::table_reader::TableReader;
use crate::units::Units;
use crate::value::Context;
use crate::wording::shorten;
use dwell_geometry::BodyId;
use dwell_laws::expression::nearest;
use toml::de::DeTable;

/// Longest title, in characters: it heads a page and a picture.
const MAX_TITLE_LENGTH: usize = 200;

/// The scene that `read` makes of the root of a file, or all that is wrong with it.
pub(crate) fn read_root<S>(
    root: &DeTable<'_>,
    log: &Diagnostics,
    read: impl FnOnce(&TableReader<'_>) -> Option<S>,
) -> Result<S, SceneError> {
    let fields = |units| {
        let context = Context { units, log };
        TableReader::new("the scene", 0..0, 0..0, root, context)
    };
    let si = Units::default();
    let units = Units::read(fields(&si).get("units"));
    let scene = read(&fields(&units));
    if let Some(error) = log.to_error() {
        return Err(error);
    }
    // Parts are missing only where something was found wrong.
    let incomplete = || SceneError::without_labels("the scene is incomplete".to_owned(), None);
    scene.ok_or_else(incomplete)
}

/// Reports the keys that a table does not have. Keys that exist only in the plane are named and explained with `planar`.
pub(crate) fn reject_other_keys<D: Notation>(
    fields: &TableReader<'_>,
    id: &str,
    planar: impl Fn(&str) -> (String, &'static str),
) {
    for entry in fields.unknown_entries(D::table(id)) {
        if table(id).contains_key(entry.name) {
            let (what, help) = planar(entry.name);
            let message = format!("a scene in space has no {what}");
            entry.reject::<()>(message, "for scenes in the plane", help);
        } else {
            fields.report_unknown_key(entry, "keys here", D::table(id).names());
        }
    }
}

/// Notes where the sections are that messages of the levels above point at.
pub(crate) fn place_sections(fields: &TableReader<'_>) {
    for (key, location) in [
        ("units", SceneLocation::Units),
        ("assembly", SceneLocation::Assembly),
        ("prescribed", SceneLocation::Prescribed),
        ("coordinate-sweep", SceneLocation::CoordinateSweep),
        ("requests", SceneLocation::Requests),
        ("motion", SceneLocation::Motion),
    ] {
        fields.place(key, location);
    }
}

/// The table of a section.
pub(crate) fn section<'a>(fields: &TableReader<'a>, key: &str) -> Option<TableReader<'a>> {
    TableReader::open(fields.get(key)?, format!("[{key}]"))
}

/// The table of a section that has to be there, and not empty.
pub(crate) fn needed_section<'a>(fields: &TableReader<'a>, key: &str) -> Option<TableReader<'a>> {
    let missing = |span: &Span, label: &str| {
        let help = match key {
            "bodies" => "describe the bodies: `[bodies.crank]` with `points = { A = [0, 0] }`",
            _ => "connect the bodies: `A = { revolute = [\"ground.A\", \"crank.A\"] }`",
        };
        let message = format!("the scene has no {key}");
        fields.log().reject(message, &[(span, label)], help)
    };
    match fields.get(key) {
        None => missing(&(0..0), &format!("there is no [{key}] in this file")),
        Some(entry) => match section(fields, key)? {
            table if table.entries.is_empty() => missing(&entry.key, "nothing in it"),
            table => Some(table),
        },
    }
}

pub(crate) fn title<'a>(fields: &TableReader<'a>) -> Option<&'a str> {
    let (title, entry) = (text_of(fields, "title")?, fields.get("title")?);
    if title.chars().count() > MAX_TITLE_LENGTH {
        let message = format!("the title is longer than {MAX_TITLE_LENGTH} characters");
        let help = "a title is a line at the head of a page; the rest can go into `note`";
        entry.reject::<()>(message, "this text", help);
    }
    Some(title)
}

/// A text for readers; a blank text counts as absent.
pub(crate) fn text_of<'a>(fields: &TableReader<'a>, key: &str) -> Option<&'a str> {
    let value = fields.get(key)?.value;
    let text = value.string(format_args!("the {key}"))?.trim();
    (!text.is_empty()).then_some(text)
}

/// Reports the bodies that no joint holds.
pub(crate) fn report_unjoined_bodies<D: Dimensions>(
    bodies: &Bodies<'_, D>,
    of_joints: impl Iterator<Item = BodyId>,
    log: &Diagnostics,
) {
    let mut joined = vec![false; bodies.list.len()];
    for body in of_joints {
        joined[body.0] = true;
    }
    let by_body = || bodies.list.iter().zip(&joined);
    let others = by_body()
        .filter(|(_, joined)| **joined)
        .map(|(b, _)| b.name);
    for (body, _) in by_body().filter(|(_, joined)| !**joined) {
        let message = format!("body `{}` is in no joint", shorten(body.name));
        let mut help = "join it to another body in [joints], or leave it out".to_owned();
        if let Some(near) = nearest(body.name, others.clone()) {
            help += &format!("; or did you mean `{near}`?");
        }
        log.report(message, &[(&body.key, "not connected")], help);
    }
}

/// A title heads a page: whatever white space it is written with becomes single spaces.
pub(crate) fn one_line(text: &str) -> String {
    let text = printable(text);
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Control characters other than line breaks would reach the reader's terminal: they become spaces.
pub(crate) fn printable(text: &str) -> String {
    let visible = |c: char| if c.is_control() && c != '\n' { ' ' } else { c };
    text.chars().map(visible).collect()
}
