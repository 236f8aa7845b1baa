//! Couplings: joints by which one coordinate is a function of another.

use super::Joints;
use crate::coordinates::{ParsedCoordinates, is_same};
use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::keys::table;
use crate::law::{LawDomain, law};
use crate::table_reader::{TableReader, coordinate, two_strings};
use crate::units::Units;
use crate::wording::list;
use dwell_geometry::{Coordinate, Coupling, Joint, JointKind, Vec2};

impl Joints<'_> {
    /// Reads the couplings, once the coordinates are known.
    pub(crate) fn read_couplings(
        &mut self,
        named_coordinates: &ParsedCoordinates<'_>,
        units: &Units,
        diagnostics: &mut Diagnostics,
    ) {
        for (k, fields) in std::mem::take(&mut self.pending_couplings) {
            self.list[k].joint =
                self.read_coupling(k, &fields, named_coordinates, units, diagnostics);
        }
    }

    fn read_coupling(
        &mut self,
        k: usize,
        fields: &TableReader<'_>,
        named_coordinates: &ParsedCoordinates<'_>,
        units: &Units,
        diagnostics: &mut Diagnostics,
    ) -> Option<Joint> {
        let what = &fields.what;
        let kind_entry = fields.get("coupling")?;
        let names = two_strings(
            kind_entry.value,
            "two coordinates [\"value\", \"variable\"]",
            format_args!("coupling of {what}"),
            diagnostics,
        );
        let parsed = &mut self.list[k];
        let both = names.and_then(
            |[(dependent, at_dependent), (independent, at_independent)]| {
                parsed.points = [at_dependent.clone(), at_independent.clone()];
                let first = named_coordinates.find(dependent, &at_dependent, diagnostics);
                let second = named_coordinates.find(independent, &at_independent, diagnostics);
                let (first, second) = (first?, second?);
                if is_same(first, second) {
                    diagnostics.push(
                        Diagnostic::new(format!("{what} couples a coordinate to itself"))
                            .label(at_dependent, "this coordinate")
                            .label(at_independent, "and the same again")
                            .help("the first is the function's value, the second its variable"),
                    );
                    return None;
                }
                Some((first, second))
            },
        );
        let table = table("coupling");
        let laws = table.alternatives();
        let chosen = fields.one_of(|n| laws.contains(&n), diagnostics).ok()?;
        let Some(chosen) = chosen else {
            // Its other keys have been looked at: a misspelt law is one slip, not two.
            if fields.has_unknown_keys(table) {
                return None;
            }
            let laws = list(laws.into_iter()).unwrap_or_default();
            diagnostics.push(
                Diagnostic::new(format!("{what} has no law"))
                    .label(parsed.key.clone(), "no law")
                    .help(format!(
                        "add `expression = \"0.01*(1 - cos(x))\"`; the laws are {laws}"
                    )),
            );
            return None;
        };
        parsed.law = Some(chosen.key.start..chosen.value.span().end);
        let (dependent, independent) = both?;
        let start = match fields.get("start") {
            None => 0.0,
            Some(e) => {
                let what = format_args!("the start of {what}");
                coordinate(e.value, dependent.is_angle(), units, what, diagnostics)?
            }
        };
        if let (Some(e), "expression" | "table") = (fields.get("start"), chosen.name) {
            diagnostics.push(
                Diagnostic::new(format!(
                    "{what} has a `start` that its {} does not need",
                    chosen.name
                ))
                .label(e.key.clone(), "only for a sinusoid or a rise")
                .help("leave it out, or add it to the function itself"),
            );
            return None;
        }
        let domain = LawDomain {
            variable: "x",
            x_unit: units.coordinate_unit(independent.is_angle()),
            y_unit: units.coordinate_unit(dependent.is_angle()),
            start_value: start,
            end_time: None,
        };
        let law = law(chosen, what, &domain, units, diagnostics)?;
        let (bodies, points) = self.bodies_and_points(dependent)?;
        self.couplings.push(Coupling {
            dependent,
            independent,
            law,
        });
        Some(Joint {
            name: self.list[k].name.clone(),
            bodies,
            points,
            kind: JointKind::Coupling(self.couplings.len() - 1),
        })
    }

    /// The bodies whose coordinate it is, and the points it is measured at.
    fn bodies_and_points(
        &self,
        of: Coordinate,
    ) -> Option<([dwell_geometry::BodyId; 2], [Vec2; 2])> {
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
