//! Every public function and type of the front door has an example in its documentation; the examples run as tests.

use std::path::Path;

#[test]
fn every_public_item_has_an_example() -> Result<(), std::io::Error> {
    let mut items = 0;
    let mut without = Vec::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src")];
    while let Some(folder) = folders.pop() {
        for entry in folder.read_dir()? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path)?;
            let mut has_example = false;
            for line in text.lines().map(str::trim) {
                if line.starts_with("///") {
                    has_example |= line == "/// ```";
                    continue;
                }
                let is_item = ["pub fn ", "pub struct ", "pub enum ", "pub use dwell_"]
                    .iter()
                    .any(|start| line.starts_with(start));
                if is_item {
                    items += 1;
                    if !has_example {
                        without.push(format!("{}: {line}", path.display()));
                    }
                }
                // A blank line ends what belongs to an item.
                has_example &= !is_item && !line.is_empty();
            }
        }
    }
    assert!(items > 100, "{items} items");
    assert!(
        without.is_empty(),
        "without an example:\n{}",
        without.join("\n")
    );
    Ok(())
}
