//! The reduced model of a mechanism with some of its reactions.

use super::Mechanism;
use crate::assembled::NamedReaction;
use crate::error::Error;
use crate::reduced::ReducedModel;

impl Mechanism {
    /// The reduced model with some reactions: joints (`A` for all its determined components)
    /// or components (`guide.normal`).
    ///
    /// ```text
    /// m q̈ + ½m′ q̇² = Σ w F,    R = a q̈ + b q̇² + Σ c F
    /// ```
    ///
    /// # Errors
    /// [`Error::Unknown`] for a reaction that the mechanism does not have, or that redundant constraints leave undetermined;
    /// [`Error::Study`] unless it has exactly one actuator.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let reduced = slider.reduced(["A", "guide.normal"])?;
    /// assert_eq!(reduced.reactions(), ["A.x", "A.y", "guide.normal"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn reduced<'r>(
        &self,
        reactions: impl IntoIterator<Item = &'r str>,
    ) -> Result<ReducedModel, Error> {
        let all = &self.names.reactions;
        let mut wanted: Vec<usize> = Vec::new();
        for name in reactions {
            let is_meant = |k: &usize| {
                let reaction = &all[*k];
                reaction.place.is_some() && (reaction.joint == name || reaction.name == name)
            };
            let before = wanted.len();
            wanted.extend((0..all.len()).filter(is_meant));
            if wanted.len() == before {
                return Err(unknown_reaction(all, name));
            }
        }
        let source = self.assembled.reduced(&wanted)?;
        let names = wanted.iter().map(|&k| all[k].name.clone());
        Ok(ReducedModel::new(
            source,
            names.collect(),
            self.names.loads.clone(),
        ))
    }
}

/// The error for a name that refers to no reaction.
fn unknown_reaction(all: &[NamedReaction], name: &str) -> Error {
    if all
        .iter()
        .any(|known| known.name == name || known.joint == name)
    {
        return Error::shared_load(name);
    }
    let mut joints: Vec<&str> = all.iter().map(|known| &known.joint[..]).collect();
    joints.dedup();
    let names = all.iter().map(|known| &known.name[..]).chain(joints);
    Error::unknown("reaction", "reactions", name, names)
}
