//! Who made the reference values of a case: the independent program, the literature, or Dwell itself.

use serde_json::Value;

/// Who made a table of reference values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SourceKind {
    /// A program that shares nothing with Dwell and is in the repository: `just reference` remakes them.
    Independent,
    /// A publication, with the digits that it prints.
    Literature,
    /// Dwell's own checks, without values from elsewhere.
    Own,
    /// The file does not say.
    Unstated,
}

impl SourceKind {
    pub(crate) const ALL: [Self; 4] = [
        Self::Independent,
        Self::Literature,
        Self::Own,
        Self::Unstated,
    ];
    /// The kinds that a file can give.
    const GIVEN: [Self; 3] = [Self::Independent, Self::Literature, Self::Own];

    /// The word in the file.
    const fn key(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Literature => "literature",
            Self::Own => "own",
            Self::Unstated => "not stated",
        }
    }

    /// The word in reports.
    pub(crate) const fn word(self) -> &'static str {
        match self {
            Self::Own => "own oracle",
            other => other.key(),
        }
    }

    fn read(value: &Value) -> Result<Self, String> {
        if value.is_null() {
            return Ok(Self::Unstated);
        }
        let mut given = Self::GIVEN.into_iter();
        let found = given.find(|k| value.as_str() == Some(k.key()));
        let known = || Self::GIVEN.map(Self::key).join(", ");
        found.ok_or_else(|| format!("`kind` is {value}; known are {}", known()))
    }
}

/// The tables of a case, each with who made it, in the order of the file's description.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct SourceKinds(Vec<(&'static str, SourceKind)>);

impl SourceKinds {
    /// Reads `kind` of the file, which holds for its samples, and of the tables `published` and `free_motion`.
    pub(super) fn read(value: &Value) -> Result<Self, String> {
        let of_samples = SourceKind::read(&value["kind"])?;
        let mut kinds = Vec::new();
        if !value["samples"].is_null() {
            kinds.push(("samples", of_samples));
        }
        for (name, table) in [
            ("published", &value["published"]),
            ("free motion", &value["free_motion"]),
        ] {
            if table.is_object() {
                let kind = SourceKind::read(&table["kind"]);
                kinds.push((name, kind.map_err(|e| format!("{name}: {e}"))?));
            }
        }
        Ok(Self(kinds))
    }

    /// The tables of a kind, such as `samples, free motion`; of a case without values its own checks are all there is.
    pub(crate) fn of(&self, kind: SourceKind) -> String {
        let of_kind = self.0.iter().filter(|(_, of)| *of == kind);
        let names: Vec<&str> = of_kind.map(|(name, _)| *name).collect();
        match (self.0.is_empty(), kind) {
            (true, SourceKind::Own) => "all checks".to_owned(),
            _ => names.join(", "),
        }
    }

    /// A sentence for the case's page.
    pub(crate) fn sentence(&self) -> String {
        let tables = SourceKind::ALL.map(|kind| (kind, self.of(kind)));
        let given = tables.into_iter().filter(|(_, tables)| !tables.is_empty());
        let given: Vec<String> = given
            .map(|(kind, tables)| format!("{} ({tables})", kind.word()))
            .collect();
        format!(
            "Reference values: {}. Independent ones are remade by `just reference`.",
            given.join("; ")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn an_unknown_kind_is_an_error() {
        for (file, expected) in [
            (
                json!({ "published": { "kind": "hearsay" } }),
                "published: `kind` is \"hearsay\"",
            ),
            (json!({ "kind": "mine" }), "`kind` is \"mine\""),
        ] {
            let error = SourceKinds::read(&file).expect_err("an error");
            assert!(error.starts_with(expected), "{error}");
            assert!(error.ends_with("independent, literature, own"), "{error}");
        }
    }

    #[test]
    fn every_table_is_listed_under_who_made_it() {
        let file = json!({ "kind": "independent", "samples": [],
            "published": { "kind": "literature" }, "free_motion": { "kind": "independent" } });
        let kinds = SourceKinds::read(&file).expect("kinds");
        assert_eq!(kinds.of(SourceKind::Independent), "samples, free motion");
        assert_eq!(kinds.of(SourceKind::Literature), "published");
        assert_eq!(kinds.of(SourceKind::Own), "");
        let none = SourceKinds::default();
        assert!(none.sentence().contains("own oracle (all checks)"));
    }

    #[test]
    fn every_case_of_the_repository_states_its_kinds() {
        let cases = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation");
        let mut count = 0;
        for folder in std::fs::read_dir(cases).expect("cases").flatten() {
            let Ok(text) = std::fs::read_to_string(folder.path().join("case.toml")) else {
                continue;
            };
            let kinds = SourceKinds::read(&toml::from_str(&text).expect("TOML")).expect("kinds");
            let name = folder.file_name();
            assert_eq!(kinds.of(SourceKind::Unstated), "", "{name:?}");
            count += 1;
        }
        assert!(count > 20, "{count} cases");
    }
}
