//! The events of a free motion.

use crate::coordinates::Measures;
use crate::fields::{Entry, Fields, Sign, boolean, coordinate, signed, string};
use crate::joints::Joints;
use crate::keys::EVENT_KINDS;
use crate::kind::kind;
use crate::names::{check, shorten};
use crate::problem::{Problem, Problems, Span, list};
use crate::requests::components;
use crate::scene::{EventTrigger, NamedEvent};
use crate::units::{Unit, Units};
use dwell_geometry::{Coordinate, JointId, Reaction};

/// What events are read with.
pub(crate) struct EventReader<'r> {
    pub(crate) measures: &'r Measures<'r>,
    pub(crate) joints: &'r Joints<'r>,
    pub(crate) units: &'r Units,
}

impl EventReader<'_> {
    /// Every event of `[motion.events]`, each with where it is named.
    pub(crate) fn read(
        &self,
        fields: &Fields<'_>,
        problems: &mut Problems,
    ) -> Vec<(NamedEvent, Span)> {
        let one = |entry: &Entry<'_>| {
            check("an event", entry.name, &entry.key, problems);
            Some((self.event(entry, problems)?, entry.key.clone()))
        };
        fields.entries.iter().filter_map(one).collect()
    }

    fn event(&self, entry: &Entry<'_>, problems: &mut Problems) -> Option<NamedEvent> {
        let what = format!("event `{}`", shorten(entry.name));
        let fields = Fields::open(entry, what, problems)?;
        let (word, held) = kind(&fields, &entry.key, "event", &EVENT_KINDS, problems)?;
        let stop = match fields.get("stop") {
            None => Some(false),
            Some(e) => {
                let what = format_args!("`stop` of {}", fields.what);
                boolean(e.value, what, problems)
            }
        };
        let trigger = match word {
            "reaches" => self.reaches(held, entry, &fields, problems),
            "reverses" => self
                .coordinate(held, &fields, problems)
                .map(EventTrigger::Turns),
            "reaction" => self.reaction(held, &fields, problems),
            _ => self.turn(held, &fields, problems),
        };
        Some(NamedEvent {
            name: entry.name.to_owned(),
            trigger: trigger?,
            stop: stop?,
        })
    }

    fn coordinate(
        &self,
        held: &Entry<'_>,
        fields: &Fields<'_>,
        problems: &mut Problems,
    ) -> Option<Coordinate> {
        let what = format_args!("{} of {}", held.name, fields.what);
        let name = string(held.value, what, problems)?;
        self.measures.find(name, &held.value.span(), problems)
    }

    fn reaches(
        &self,
        held: &Entry<'_>,
        entry: &Entry<'_>,
        fields: &Fields<'_>,
        problems: &mut Problems,
    ) -> Option<EventTrigger> {
        let reached = self.coordinate(held, fields, problems);
        let help = "add for instance `value = 0.0`: where it happens";
        let value = fields.need("value", &entry.key, help, problems);
        let (reached, value) = (reached?, value?);
        let what = format_args!("value of {}", fields.what);
        let value = coordinate(value.value, reached.is_angle(), self.units, what, problems)?;
        Some(EventTrigger::Reaches(reached, value))
    }

    fn turn(
        &self,
        held: &Entry<'_>,
        fields: &Fields<'_>,
        problems: &mut Problems,
    ) -> Option<EventTrigger> {
        let turned = self.coordinate(held, fields, problems)?;
        if turned.is_angle() {
            return Some(EventTrigger::WholeTurn(turned));
        }
        problems.push(
            Problem::new(format!("{} turns a length", fields.what))
                .at(held.value.span(), "not an angle")
                .help("an angle makes whole turns; a length `reaches` a value or `reverses`"),
        );
        None
    }

    fn reaction(
        &self,
        held: &Entry<'_>,
        fields: &Fields<'_>,
        problems: &mut Problems,
    ) -> Option<EventTrigger> {
        let what = &fields.what;
        let text = string(held.value, format_args!("reaction of {what}"), problems);
        let value = match fields.get("value") {
            None => Some(0.0),
            Some(e) => {
                let what = format_args!("value of {what}");
                signed(e.value, &Unit::of_si(), Sign::Any, what, "", problems)
            }
        };
        let at = held.value.span();
        let reaction = self.one_reaction(text?, &at, what, problems)?;
        Some(EventTrigger::Reaction(reaction, value?))
    }

    /// The one component of one joint that `text` names.
    fn one_reaction(
        &self,
        text: &str,
        at: &Span,
        what: &str,
        problems: &mut Problems,
    ) -> Option<Reaction> {
        let (name, component) = match text.split_once('.') {
            Some((name, component)) => (name, Some(component)),
            None => (text, None),
        };
        let range = self.joints.find(name, at, problems)?;
        let relations = &self.joints.relations;
        let mut all = Vec::new();
        for k in range {
            let joint = self.joints.list[k].joint.as_ref()?;
            let found = components(joint, component, relations, at, problems);
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
        problems.push(
            Problem::new(format!("{what} is of {} reactions", all.len()))
                .at(at.clone(), "which of them?")
                .help(format!("name one of {names}")),
        );
        None
    }
}
