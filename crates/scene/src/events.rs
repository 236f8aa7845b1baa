//! The events of a free motion.

use crate::coordinates::ParsedCoordinates;
use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::joints::Joints;
use crate::kind::kind;
use crate::names::check;
use crate::requests::components;
use crate::scene::{EventTrigger, NamedEvent};
use crate::table_reader::{
    Entry, SignRule, TableReader, boolean, coordinate, quantity_with_sign, string,
};
use crate::units::{Unit, Units};
use crate::wording::{list, shorten};
use dwell_geometry::{Coordinate, JointId, Reaction};

/// Reads the events.
pub(crate) struct EventReader<'r> {
    pub(crate) named_coordinates: &'r ParsedCoordinates<'r>,
    pub(crate) joints: &'r Joints<'r>,
    pub(crate) units: &'r Units,
}

impl EventReader<'_> {
    /// Every event of `[motion.events]`, each with where it is named.
    pub(crate) fn read(
        &self,
        fields: &TableReader<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Vec<(NamedEvent, Span)> {
        let one = |entry: &Entry<'_>| {
            check("an event", entry.name, &entry.key, diagnostics);
            Some((self.event(entry, diagnostics)?, entry.key.clone()))
        };
        fields.entries.iter().filter_map(one).collect()
    }

    fn event(&self, entry: &Entry<'_>, diagnostics: &mut Diagnostics) -> Option<NamedEvent> {
        let what = format!("event `{}`", shorten(entry.name));
        let fields = TableReader::open(entry, what, diagnostics)?;
        let (kind_name, kind_entry) = kind(&fields, &entry.key, "event", diagnostics)?;
        let terminal = match fields.get("stop") {
            None => Some(false),
            Some(e) => {
                let what = format_args!("`stop` of {}", fields.what);
                boolean(e.value, what, diagnostics)
            }
        };
        let trigger = match kind_name {
            "reaches" => self.reaches(kind_entry, entry, &fields, diagnostics),
            "reverses" => self
                .coordinate(kind_entry, &fields, diagnostics)
                .map(EventTrigger::Reversal),
            "reaction" => self.reaction(kind_entry, &fields, diagnostics),
            _ => self.revolution(kind_entry, &fields, diagnostics),
        };
        Some(NamedEvent {
            name: entry.name.to_owned(),
            trigger: trigger?,
            terminal: terminal?,
        })
    }

    fn coordinate(
        &self,
        kind_entry: &Entry<'_>,
        fields: &TableReader<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Coordinate> {
        let what = format_args!("{} of {}", kind_entry.name, fields.what);
        let name = string(kind_entry.value, what, diagnostics)?;
        self.named_coordinates
            .find(name, &kind_entry.value.span(), diagnostics)
    }

    fn reaches(
        &self,
        kind_entry: &Entry<'_>,
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<EventTrigger> {
        let reached = self.coordinate(kind_entry, fields, diagnostics);
        let help = "add for instance `value = 0.0`, the value at which it occurs";
        let value = fields.require("value", &entry.key, help, diagnostics);
        let (reached, value) = (reached?, value?);
        let what = format_args!("value of {}", fields.what);
        let value = coordinate(
            value.value,
            reached.is_angle(),
            self.units,
            what,
            diagnostics,
        )?;
        Some(EventTrigger::Reaches(reached, value))
    }

    fn revolution(
        &self,
        kind_entry: &Entry<'_>,
        fields: &TableReader<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<EventTrigger> {
        let angle = self.coordinate(kind_entry, fields, diagnostics)?;
        if angle.is_angle() {
            return Some(EventTrigger::Revolution(angle));
        }
        diagnostics.push(
            Diagnostic::new(format!("{} counts revolutions of a length", fields.what))
                .label(kind_entry.value.span(), "not an angle")
                .help("only an angle makes revolutions; a length `reaches` a value or `reverses`"),
        );
        None
    }

    fn reaction(
        &self,
        kind_entry: &Entry<'_>,
        fields: &TableReader<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<EventTrigger> {
        let what = &fields.what;
        let text = string(
            kind_entry.value,
            format_args!("reaction of {what}"),
            diagnostics,
        );
        let value = match fields.get("value") {
            None => Some(0.0),
            Some(e) => {
                let what = format_args!("value of {what}");
                quantity_with_sign(
                    e.value,
                    &Unit::si_unit(),
                    SignRule::Any,
                    what,
                    "",
                    diagnostics,
                )
            }
        };
        let at = kind_entry.value.span();
        let reaction = self.one_reaction(text?, &at, what, diagnostics)?;
        Some(EventTrigger::Reaction(reaction, value?))
    }

    /// The one component of one joint that `text` names.
    fn one_reaction(
        &self,
        text: &str,
        at: &Span,
        what: &str,
        diagnostics: &mut Diagnostics,
    ) -> Option<Reaction> {
        let (name, component) = match text.split_once('.') {
            Some((name, component)) => (name, Some(component)),
            None => (text, None),
        };
        let range = self.joints.find(name, at, diagnostics)?;
        let relations = &self.joints.couplings;
        let mut all = Vec::new();
        for k in range {
            let joint = self.joints.list[k].joint.as_ref()?;
            let found = components(joint, component, relations, at, diagnostics);
            if found.is_empty() {
                return None;
            }
            all.extend(found.into_iter().map(|component| {
                let reaction = Reaction {
                    joint: JointId(k),
                    component,
                };
                (reaction, format!("{}.{}", joint.name, component.name()))
            }));
        }
        if let [(reaction, _)] = all.as_slice() {
            return Some(*reaction);
        }
        let names = list(all.iter().map(|(_, name)| name.as_str())).unwrap_or_default();
        diagnostics.push(
            Diagnostic::new(format!("{what} names {} reactions", all.len()))
                .label(at.clone(), "which of them?")
                .help(format!("name one of {names}")),
        );
        None
    }
}
