//! The faults of the mutation study, with the checks that detect each, from its committed text.

use std::path::Path;

/// The texts of the fault studies: single operations, and the source text.
const FILES: [&str; 2] = ["mutations.txt", "source-mutations.txt"];

/// A fault, and the numbers of the checks that detect it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CommittedMutation {
    /// Its heading.
    pub(super) group: String,
    pub(super) description: String,
    pub(super) detected_by: Vec<usize>,
}

/// The faults of all studies whose text is in a folder, and the names of these texts.
pub(super) fn committed_mutations(folder: &Path) -> (Vec<CommittedMutation>, Vec<&'static str>) {
    let (mut faults, mut found) = (Vec::new(), Vec::new());
    for file in FILES {
        if let Ok(text) = std::fs::read_to_string(folder.join(file)) {
            faults.extend(read(&text));
            found.push(file);
        }
    }
    (faults, found)
}

/// The faults of a text: lines that begin with two blanks, contain a description, and end with numbers of checks. Lines without
/// leading blanks are headings.
fn read(text: &str) -> Vec<CommittedMutation> {
    let mut group = String::new();
    let mut faults = Vec::new();
    for line in text.lines() {
        let Some(line) = line.strip_prefix("  ") else {
            group = line.trim().to_owned();
            continue;
        };
        let parts: Vec<&str> = line.split("  ").map(str::trim).collect();
        let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
        let [description, .., last] = parts[..] else {
            continue;
        };
        // Numbers, in brackets if slightly above the tolerance; in a full line they follow the name of a mechanism.
        let words = last.rsplit(' ').map(|w| w.trim_matches(['[', ']', ',']));
        let numbers = words.map_while(|word| word.parse::<usize>().ok());
        let mut detected_by: Vec<usize> = numbers.collect();
        detected_by.reverse();
        if !detected_by.is_empty() {
            faults.push(CommittedMutation {
                group: group.clone(),
                description: description.to_owned(),
                detected_by,
            });
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_has_its_heading_and_its_checks() {
        let text = "Deliberate faults\n\nIn states\n  gravity with the other sign         double-slider      2 3 [4] 7\n\
                    \x20 friction with the other sign                            slider-crank-friction 2 3 4\nBy function\n  a.rs b   -\n";
        let faults = read(text);
        assert_eq!(faults.len(), 2);
        assert_eq!(faults[0].description, "gravity with the other sign");
        assert_eq!(
            (&faults[0].group[..], &faults[0].detected_by[..]),
            ("In states", &[2, 3, 4, 7][..])
        );
        assert_eq!(faults[1].detected_by, [2, 3, 4]);
    }
}
