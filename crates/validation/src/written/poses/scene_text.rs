//! Scenes that the checks write: the scene of a case, changed in its plain TOML.

use toml::{Table, Value};

/// FNV-1a of a text, 64 bits: the same on every machine.
pub(crate) fn hash(text: &str) -> u64 {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    text.bytes().fold(0xcbf2_9ce4_8422_2325, step)
}

/// Numbers drawn one after another from a seed (SplitMix64).
#[derive(Debug, Clone)]
pub(crate) struct Draws(u64);

impl Draws {
    /// The draws of a scene's text.
    pub(crate) fn of(text: &str) -> Self {
        Self(hash(text))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from 0 to below `count`.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        usize::try_from(self.next() % count.max(1) as u64).unwrap_or(0)
    }

    /// A number between 0 and 1.
    pub(crate) fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The table of a scene's text.
pub(crate) fn table_of(text: &str) -> Result<Table, String> {
    text.parse()
        .map_err(|e| format!("the scene is no TOML: {e}"))
}

/// A value that is a table of some entries.
pub(crate) fn value_of<'a>(entries: impl IntoIterator<Item = (&'a str, Value)>) -> Value {
    let named = entries
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value));
    Value::Table(named.collect())
}

/// Whether a scene has a motion along which forces of inertia are known.
pub(crate) fn has_motion(scene: &Table) -> bool {
    scene.contains_key("prescribed") || scene.contains_key("coordinate-sweep")
}

/// The scene without what moves and loads it.
pub(crate) fn without_forces(text: &str) -> Result<Table, String> {
    let mut scene = table_of(text)?;
    for section in [
        "prescribed",
        "loads",
        "friction",
        "drives",
        "stops",
        "motion",
        "calibration",
    ] {
        scene.remove(section);
    }
    Ok(scene)
}

/// The scene without its requests: everything is written.
pub(crate) fn requests_everything(text: &str) -> Result<Table, String> {
    let mut scene = table_of(text)?;
    scene.remove("requests");
    Ok(scene)
}

/// The text of a changed scene.
pub(crate) fn text_of(scene: &Table) -> Result<String, String> {
    toml::to_string(scene).map_err(|e| e.to_string())
}
