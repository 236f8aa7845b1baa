//! Names of files that differ also where upper and lower case are one, as on most systems but Linux.

use std::collections::BTreeSet;

/// The names of some files.
#[derive(Debug, Default)]
pub(crate) struct DistinctNames {
    lower_case: BTreeSet<String>,
}

impl DistinctNames {
    /// A name; one that differs from an earlier one only by case gets a mark.
    pub(crate) fn add(&mut self, mut name: String) -> String {
        while !self.lower_case.insert(name.to_lowercase()) {
            name.push('~');
        }
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_differ_by_case_alone_are_told_apart() {
        let mut names = DistinctNames::default();
        let given = ["path-crank.B", "path-Crank.B", "path-CRANK.b", "path-rod.B"];
        let used = given.map(|name| names.add(name.to_owned()));
        let expected = [
            "path-crank.B",
            "path-Crank.B~",
            "path-CRANK.b~~",
            "path-rod.B",
        ];
        assert_eq!(used, expected);
    }
}
