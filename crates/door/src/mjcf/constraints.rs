//! Equality constraints and tendons.

use super::{Item, Reader};
use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::{Coupling, End, Kind, Load};
use crate::pose::{Matrix, Pose, length, sub};
use crate::xml::Element;

impl<'d> Reader<'d, '_> {
    pub(super) fn constraint(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        if !["connect", "weld", "joint"].contains(&element.tag()) {
            return Ok(());
        }
        let item = self.defaults.item(element, None)?;
        let count = self
            .model
            .joints
            .iter()
            .filter(|joint| !joint.in_tree)
            .count()
            + self.model.couplings.len();
        let name = element
            .attribute("name")
            .map_or(format!("loop{}", count + 1), str::to_owned);
        if item.is("active", "false") {
            element.leave(
                Effect::Kept,
                format!("equality {name}: not active, left out"),
            );
            return Ok(());
        }
        match element.tag() {
            "joint" => self.joint_equality(&item, name),
            "connect" => self.connect(&item, name),
            _ => self.weld(&item, name),
        }
    }

    /// The two ends at sites, if they are given by sites.
    fn ends_at_sites(&self, item: &Item<'d>) -> Result<Option<[End; 2]>, DoorError> {
        let element = &item.element;
        let (Some(one), Some(other)) = (element.attribute("site1"), element.attribute("site2"))
        else {
            return Ok(None);
        };
        let end = |name| {
            self.site(element, name)
                .map(|(body, frame)| End { body, frame })
        };
        Ok(Some([end(one)?, end(other)?]))
    }

    fn two_bodies(&self, element: &Element<'d>) -> Result<[usize; 2], DoorError> {
        let first = self.body_named(element, "body1")?;
        let first = first.ok_or_else(|| element.error("the constraint names no body", ""))?;
        Ok([
            first,
            self.body_named(element, "body2")?.unwrap_or_default(),
        ])
    }

    fn connect(&mut self, item: &Item<'d>, name: String) -> Result<(), DoorError> {
        let element = item.element;
        if let Some(ends) = self.ends_at_sites(item)? {
            return self.close(name, element, Kind::Ball, ends);
        }
        let [first, second] = self.two_bodies(&element)?;
        let anchor = item.vector("anchor")?;
        let anchor =
            anchor.ok_or_else(|| element.error("a connect needs an anchor, or two sites", ""))?;
        let first = End {
            body: first,
            frame: Pose::at(anchor),
        };
        // The point on the second body is where the anchor is in the reference pose, whatever was meant.
        let second = self.model.seen_from(second, &first);
        let [x, y, z] = second.frame.origin;
        let mut text = format!(
            "derived: `{name}` on {} at ({x:.6}, {y:.6}, {z:.6})",
            self.model.bodies[second.body].name
        );
        let hinge = self
            .model
            .joints
            .iter()
            .find(|joint| joint.second.body == second.body);
        if let Some(hinge) = hinge {
            let radius = length(sub(second.frame.origin, hinge.second.frame.origin));
            text += &format!(", {radius:.6} m from `{}`", hinge.name);
        }
        element.note(Effect::Kept, text);
        self.close(name, element, Kind::Ball, [first, second])
    }

    fn weld(&mut self, item: &Item<'d>, name: String) -> Result<(), DoorError> {
        let element = item.element;
        let ends = match self.ends_at_sites(item)? {
            Some(ends) => ends,
            None => {
                let [first, second] = self.two_bodies(&element)?;
                let second = End {
                    body: second,
                    frame: Pose::at(item.vector("anchor")?.unwrap_or_default()),
                };
                let relative = item
                    .vector::<7>("relpose")?
                    .and_then(|[x, y, z, quat @ ..]| {
                        let turn = Matrix::quaternion(quat)?;
                        let origin = [x, y, z];
                        Some(second.moved(first, Pose { origin, turn }))
                    });
                [
                    relative.unwrap_or_else(|| self.model.seen_from(first, &second)),
                    second,
                ]
            }
        };
        self.close(name, element, Kind::Fixed, ends)
    }

    fn close(
        &mut self,
        name: String,
        element: Element<'d>,
        kind: Kind,
        ends: [End; 2],
    ) -> Result<(), DoorError> {
        if ends[0].body == ends[1].body {
            return Err(element.error("the constraint connects a body with itself", ""));
        }
        let joint = self.push_joint(name, element, kind, ends);
        self.model.joints[joint].in_tree = false;
        Ok(())
    }

    fn joint_equality(&mut self, item: &Item<'d>, name: String) -> Result<(), DoorError> {
        let element = item.element;
        let one = element.attribute("joint1").unwrap_or_default();
        let dependent = self.joint_named(&element, one)?;
        let polynomial = item.numbers("polycoef")?.unwrap_or_else(|| vec![0.0, 1.0]);
        let Some(other) = element.attribute("joint2") else {
            if polynomial.first().is_none_or(|offset| *offset == 0.0) {
                self.model.joints[dependent].kind = Kind::Fixed;
                element.note(
                    Effect::Kept,
                    format!("equality {name}: joint {one} is fixed"),
                );
            } else {
                element.note(
                    Effect::Changes,
                    format!("equality {name}: left out (changes the motion)"),
                );
            }
            return Ok(());
        };
        let independent = self.joint_named(&element, other)?;
        let reference = |joint: usize| self.model.joints[joint].drawn;
        self.model.couplings.push(Coupling {
            name,
            place: element.place(),
            dependent,
            independent,
            references: [reference(dependent), reference(independent)],
            polynomial,
        });
        Ok(())
    }

    /// A straight tendon between two sites is a spring.
    pub(super) fn tendon(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let name = element.attribute("name").unwrap_or("tendon").to_owned();
        let item = self.defaults.item(element, None)?;
        let children = element.children();
        let sites: Vec<_> = children
            .iter()
            .filter_map(|one| one.attribute("site"))
            .collect();
        let ([one, other], 2, "spatial") = (
            sites.get(..2).unwrap_or(&["", ""]),
            children.len(),
            element.tag(),
        ) else {
            element.leave(
                Effect::Changes,
                format!(
                    "tendon {name}, {}: left out (may change the motion)",
                    element.tag()
                ),
            );
            return Ok(());
        };
        let ends = [self.site(&element, one)?, self.site(&element, other)?]
            .map(|(body, pose)| (body, pose.origin));
        let drawn = length(sub(self.world_point(ends[0]), self.world_point(ends[1])));
        let free_length = item.number("springlength")?.filter(|length| *length >= 0.0);
        let value = |name| Ok::<f64, DoorError>(item.number(name)?.unwrap_or_default());
        let (stiffness, damping) = (value("stiffness")?, value("damping")?);
        for active in ["frictionloss", "armature"] {
            if value(active)? != 0.0 {
                element.note(
                    Effect::Changes,
                    format!("tendon {name} {active}: left out (changes the motion)"),
                );
            }
        }
        let range = item.text("range").is_some() && !item.is("limited", "false");
        let named = if range {
            ", its range left out (acts only at a limit)"
        } else {
            ""
        };
        let effect = if range {
            Effect::AtLimits
        } else {
            Effect::Kept
        };
        let text = format!(
            "tendon {name}: kept as a spring between {one} and {other} (straight, two sites){named}"
        );
        element.note(effect, text);
        if stiffness != 0.0 || damping != 0.0 {
            self.model.loads.push(Load::Spring {
                name,
                place: element.place(),
                ends,
                stiffness,
                damping,
                free_length: free_length.unwrap_or(drawn),
            });
        }
        Ok(())
    }
}
