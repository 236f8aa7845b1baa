//! The events of a free motion.

use crate::coordinates::{AnyCoordinate, ParsedCoordinates};
use crate::diagnostics::Span;
use crate::kind::{kind, reject_unread_kind};
use crate::names::read_each;
use crate::scene_data::{EventTrigger, NamedEvent};
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::units::SI;
use crate::value::{NumberRule, SignRule};
use crate::wording::shorten;

/// The reaction that a text names, at a place in a table.
type ReadReaction<'r, R> = &'r dyn Fn(&str, &Span, &TableReader<'_>) -> Option<R>;

/// Reads events of coordinates and of reactions.
pub(crate) struct EventReader<'r, C, R> {
    pub(crate) coordinates: &'r ParsedCoordinates<'r, C>,
    pub(crate) reaction: ReadReaction<'r, R>,
}

impl<C: AnyCoordinate, R> EventReader<'_, C, R> {
    /// Every event of `[motion.events]`.
    pub(crate) fn events(&self, fields: &TableReader<'_>) -> Vec<NamedEvent<C, R>> {
        read_each(fields, "an event", SceneLocation::Event, |_, entry| {
            self.event(entry)
        })
    }

    fn event(&self, entry: &Entry<'_>) -> Option<NamedEvent<C, R>> {
        let fields = TableReader::open(entry, format!("event `{}`", shorten(entry.name)))?;
        let (kind, kind_entry) = kind(&fields, "event")?;
        let terminal = fields.boolean("stop");
        let coordinate = || self.coordinates.named_by(kind_entry, &fields);
        let trigger = match kind {
            "reaches" => reaches(coordinate(), &fields),
            "reverses" => coordinate().map(EventTrigger::Reversal),
            "reaction" => self.reaction_event(kind_entry, &fields),
            "revolution" => revolution(coordinate()?, kind_entry, &fields),
            _ => reject_unread_kind(kind_entry),
        };
        let name = entry.name.to_owned();
        Some(NamedEvent {
            name,
            trigger: trigger?,
            terminal: terminal?,
        })
    }

    fn reaction_event(
        &self,
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
    ) -> Option<EventTrigger<C, R>> {
        let text = entry.value.string(fields.name_of(entry));
        let rule = NumberRule::new(&SI, SignRule::Any);
        let value = fields.number_or(0.0, "value", &rule);
        let reaction = (self.reaction)(text?, &entry.value.span(), fields)?;
        Some(EventTrigger::Reaction(reaction, value?))
    }
}

fn reaches<C: AnyCoordinate, R>(
    reached: Option<C>,
    fields: &TableReader<'_>,
) -> Option<EventTrigger<C, R>> {
    let help = "add for instance `value = 0.0`, the value at which it occurs";
    let value = fields.require("value", help);
    let (reached, value) = (reached?, value?);
    let value = value
        .value
        .coordinate(reached.is_angle(), fields.name_of(value))?;
    Some(EventTrigger::Reaches(reached, value))
}

fn revolution<C: AnyCoordinate, R>(
    angle: C,
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
) -> Option<EventTrigger<C, R>> {
    if angle.is_angle() {
        return Some(EventTrigger::Revolution(angle));
    }
    let message = format!("{} counts revolutions of a length", fields.what);
    let help = "only an angle makes revolutions; a length `reaches` a value or `reverses`";
    entry.value.reject(message, "not an angle", help)
}
