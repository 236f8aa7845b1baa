//! Joints that relate two coordinates by a law.

use super::Joints;
use crate::coordinates::{Measures, is_same};
use crate::fields::{Fields, coordinate, two_strings};
use crate::keys::{JOINTS, LAWS_OF_RELATIONS};
use crate::law::{Reach, law};
use crate::problem::{Problem, Problems, list};
use crate::units::Units;
use dwell_geometry::{Coordinate, Joint, JointKind, Relation, Vec2};

impl Joints<'_> {
    /// Reads the relations, now that the coordinates are known.
    pub(crate) fn relate(
        &mut self,
        measures: &Measures<'_>,
        units: &Units,
        problems: &mut Problems,
    ) {
        for (k, fields) in std::mem::take(&mut self.waiting) {
            self.list[k].joint = self.relation(k, &fields, measures, units, problems);
        }
    }

    fn relation(
        &mut self,
        k: usize,
        fields: &Fields<'_>,
        measures: &Measures<'_>,
        units: &Units,
        problems: &mut Problems,
    ) -> Option<Joint> {
        let what = &fields.what;
        let held = fields.get("relation")?;
        let names = two_strings(
            held.value,
            "two coordinates [\"value\", \"variable\"]",
            format_args!("relation of {what}"),
            problems,
        );
        let text = &mut self.list[k];
        let both = names.and_then(|[(of, at_of), (by, at_by)]| {
            text.ends = [at_of.clone(), at_by.clone()];
            let first = measures.find(of, &at_of, problems);
            let second = measures.find(by, &at_by, problems);
            let (first, second) = (first?, second?);
            if is_same(first, second) {
                problems.push(
                    Problem::new(format!("{what} relates a coordinate with itself"))
                        .at(at_of, "this coordinate")
                        .at(at_by, "and the same again")
                        .help("the first is the function's value, the second its variable"),
                );
                return None;
            }
            Some((first, second))
        });
        let chosen = fields
            .one_of(|n| LAWS_OF_RELATIONS.contains(&n), problems)
            .ok()?;
        let Some(chosen) = chosen else {
            // Its other keys have been looked at: a misspelt law is one slip, not two.
            let kind = JOINTS.iter().find(|t| t.kind() == "relation");
            if kind.is_some_and(|table| fields.has_others_than(table)) {
                return None;
            }
            let laws = list(LAWS_OF_RELATIONS.into_iter()).unwrap_or_default();
            problems.push(
                Problem::new(format!("{what} has no law"))
                    .at(text.key.clone(), "which function?")
                    .help(format!(
                        "add `expression = \"0.01*(1 - cos(x))\"`; the laws are {laws}"
                    )),
            );
            return None;
        };
        text.law = Some(chosen.key.start..chosen.value.span().end);
        let (of, by) = both?;
        let start = match fields.get("start") {
            None => 0.0,
            Some(e) => {
                let what = format_args!("the start of {what}");
                coordinate(e.value, of.is_angle(), units, what, problems)?
            }
        };
        if let (Some(e), "expression" | "table") = (fields.get("start"), chosen.name) {
            problems.push(
                Problem::new(format!(
                    "{what} has a `start` that its {} does not need",
                    chosen.name
                ))
                .at(e.key.clone(), "only for a sine or a rise")
                .help("leave it out, or add it to the function itself"),
            );
            return None;
        }
        let reach = Reach {
            variable: "x",
            x: units.of(by.is_angle()),
            y: units.of(of.is_angle()),
            start,
            end: None,
        };
        let law = law(chosen, what, &reach, units, problems)?;
        let (bodies, points) = self.held(of)?;
        self.relations.push(Relation { of, by, law });
        Some(Joint {
            name: self.list[k].name.clone(),
            bodies,
            points,
            kind: JointKind::Relation(self.relations.len() - 1),
        })
    }

    /// The bodies whose coordinate it is, and the points it is measured at.
    fn held(&self, of: Coordinate) -> Option<([dwell_geometry::BodyId; 2], [Vec2; 2])> {
        match of {
            Coordinate::Angle(bodies) => Some((bodies, [Vec2::ZERO; 2])),
            Coordinate::Length { bodies, points } => Some((bodies, points)),
            Coordinate::Travel(joint) => {
                let joint = self.list.get(joint.0)?.joint.as_ref()?;
                Some((joint.bodies, joint.points))
            }
        }
    }
}
