//! Actuators.

use super::Reader;
use crate::error::DoorError;
use crate::finding::Effect;
use crate::xml::Element;

impl<'d> Reader<'d, '_> {
    /// An actuator of a joint drives it.
    pub(super) fn actuator(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let tag = element.tag();
        let item = self.defaults.item(element, None)?;
        let _ = element.attribute("name");
        let drives = ["motor", "position", "velocity", "general", "intvelocity"].contains(&tag);
        let Some(joint) = element.attribute("joint").filter(|_| drives) else {
            let of = element
                .attribute("joint")
                .map_or(String::new(), |joint| format!(" of {joint}"));
            element.leave(
                Effect::Changes,
                format!("{tag} actuator{of}: left out (changes the motion)"),
            );
            return Ok(());
        };
        let joint = self.joint_named(&element, joint)?;
        let gear = item
            .numbers("gear")?
            .and_then(|gear| gear.first().copied())
            .unwrap_or(1.0);
        let value = |name, default| Ok::<f64, DoorError>(item.number(name)?.unwrap_or(default));
        let gains = match tag {
            "position" => Some([value("kp", 1.0)?, value("kv", 0.0)?]),
            "velocity" => Some([0.0, value("kv", 1.0)?]),
            _ => None,
        };
        let label = &self.model.joints[joint].name;
        if !self.model.joints[joint].is_driveable() {
            return Err(element.error(
                format!("joint `{label}` has no single coordinate to drive"),
                "",
            ));
        }
        let text = match tag {
            "motor" => {
                format!("motor of {label}: drives it, with {gear} N m or N for a control of 1")
            }
            "position" => "position actuator: servo: kept as a drive (kp, kv)".to_owned(),
            "velocity" => "velocity actuator: servo: kept as a drive (kv)".to_owned(),
            _ => format!("{tag} actuator of {label}: drives it; its own law is left out"),
        };
        element.note(Effect::Kept, text);
        if let Some(drive) = self.model.drive(joint) {
            drive.servo = gains.map(|gains| gains.map(|gain| gain * gear * gear));
        }
        Ok(())
    }
}
