//! Couplings: joints by which one coordinate is a function of another.

use super::Joints;
use crate::coordinates::{AnyCoordinate, ParsedCoordinates};
use crate::keys::table;
use crate::law::{LawDomain, interpolation, law};
use crate::spans::SceneLocation;
use crate::table_reader::TableReader;
use crate::wording::list;
use dwell_geometry::{BodyId, Coordinate, Coupling, Joint, JointId, JointKind, Vec2};
use dwell_laws::Interpolation;

/// Reads a coupling of two coordinates, of the plane or of space.
pub(crate) fn coupling<C: AnyCoordinate>(
    joint: JointId,
    fields: &TableReader<'_>,
    named: &ParsedCoordinates<'_, C>,
) -> Option<Coupling<C>> {
    let both = coupled_coordinates(joint, fields, named);
    let laws = list(table("coupling").alternatives().into_iter()).unwrap_or_default();
    let help = format!("add `expression = \"0.01*(1 - cos(x))\"`; the laws are {laws}");
    let chosen = fields.alternative(table("coupling"), "has no law", "no law", help)?;
    let location = SceneLocation::CouplingLaw(joint);
    fields.log().place(location, &chosen.span());
    let [dependent, independent] = both?;
    let what = &fields.what;
    let start = match fields.get("start") {
        None => 0.0,
        Some(e) => e
            .value
            .coordinate(dependent.is_angle(), format_args!("the start of {what}"))?,
    };
    if let (Some(e), "expression" | "table") = (fields.get("start"), chosen.name) {
        let message = format!(
            "{what} has a `start` that its {} does not need",
            chosen.name
        );
        let help = "leave it out, or add it to the function itself";
        return e.reject(message, "only for a sinusoid or a rise", help);
    }
    let units = fields.units();
    let domain = LawDomain {
        variable: "x",
        x_unit: units.coordinate_unit(independent.is_angle()),
        y_unit: units.coordinate_unit(dependent.is_angle()),
        start_value: start,
        interpolation: interpolation(fields, Interpolation::Spline)?,
        end_time: None,
    };
    let law = law(chosen, what, &domain)?;
    Some(Coupling {
        dependent,
        independent,
        law,
    })
}

/// The dependent and the independent coordinate, which differ.
fn coupled_coordinates<C: AnyCoordinate>(
    joint: JointId,
    fields: &TableReader<'_>,
    named: &ParsedCoordinates<'_, C>,
) -> Option<[C; 2]> {
    let entry = fields.get("coupling")?;
    let expected = "two coordinates [\"value\", \"variable\"]";
    let names = entry.value.two_strings(expected, fields.name_of(entry))?;
    for (i, (_, at)) in names.iter().enumerate() {
        let location = SceneLocation::JointPoint(joint, i);
        fields.log().place(location, at);
    }
    let [first, second] = names.each_ref().map(|(name, at)| named.find(name, at));
    let (first, second) = (first?, second?);
    if first.is_same(second) {
        let message = format!("{} couples a coordinate to itself", fields.what);
        let [first, second] = &names.map(|(_, at)| at);
        let labels = [(first, "this coordinate"), (second, "and the same again")];
        let help = "the first is the function's value, the second its variable";
        return fields.log().reject(message, &labels, help);
    }
    Some([first, second])
}

impl Joints<'_> {
    /// Reads the couplings, once the coordinates are known.
    pub(crate) fn read_couplings(&mut self, named: &ParsedCoordinates<'_>) {
        for (k, fields) in std::mem::take(&mut self.pending_couplings) {
            self.list[k].joint = self.coupling(k, &fields, named);
        }
    }

    fn coupling(
        &mut self,
        k: usize,
        fields: &TableReader<'_>,
        named: &ParsedCoordinates<'_>,
    ) -> Option<Joint> {
        let coupling = coupling(JointId(k), fields, named)?;
        let (bodies, points) = self.bodies_and_points(coupling.dependent)?;
        self.couplings.push(coupling);
        let kind = JointKind::Coupling(self.couplings.len() - 1);
        Some(Joint::new(&self.list[k].name, bodies, points, kind))
    }

    /// The bodies whose coordinate it is, and the points it is measured at.
    fn bodies_and_points(&self, of: Coordinate) -> Option<([BodyId; 2], [Vec2; 2])> {
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
