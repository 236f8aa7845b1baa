//! Writes the tolerances of the cases from measurement: `cargo run --release --example tolerances`
//! replaces `[tolerances]` in every `validation/*/case.toml`, or in those of the cases named. What has changed is
//! to be read and explained before it is committed.
#![allow(clippy::print_stdout, reason = "a study, run by hand")]

use dwell_findings::{Check, Finding};
use dwell_scene::Scene;
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

/// Differences met, and roundings, that a tolerance leaves room for: another machine has another sine.
const DIFFERENCE_FACTOR: f64 = 15.0;
const ROUNDING_FACTOR: f64 = 20.0;
/// The part for roundings grows with the condition number, but to no more than this many differences: at another
/// machine's worst place the rows may be better.
const MAX_CONDITION_FACTOR: f64 = 10.0;
const HEADER: &str = "[tolerances] # measured, with room for another machine's rounding";

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../validation");
    let named: Vec<String> = std::env::args().skip(1).collect();
    let mut cases: Vec<_> = std::fs::read_dir(folder)?.collect::<Result<_, _>>()?;
    cases.sort_by_key(std::fs::DirEntry::path);
    for case in cases {
        let name = case.file_name().to_string_lossy().into_owned();
        let holds = case.path().join("scene.toml").is_file();
        if holds && (named.is_empty() || named.contains(&name)) {
            println!("{name}: {} tolerances", rewrite(&case.path())?);
        }
    }
    Ok(())
}

/// Measures a case and writes its tolerances; how many.
fn rewrite(case: &Path) -> Result<usize, Box<dyn Error>> {
    let scene = Scene::read(case.join("scene.toml"))?;
    let file = case.join("case.toml");
    let old = std::fs::read_to_string(&file).unwrap_or_default();
    let rest = without_tolerances(&old);
    // A key that is left over from another time would be an error.
    let bare = std::env::temp_dir().join(format!("dwell-tolerances-{}", std::process::id()));
    std::fs::create_dir_all(&bare)?;
    std::fs::write(bare.join("case.toml"), &rest)?;
    let validation = dwell_validation::validate(&scene, &bare, None, &dwell_study::no_progress)?;
    std::fs::remove_dir_all(&bare)?;
    let mut tolerances: BTreeMap<&str, f64> = BTreeMap::new();
    // Of the integrated ones only check 6 has a bound by case: the others are factors of an integrator's tolerance.
    let bound = |f: &&Finding| !f.integrated || f.check == Check::MultibodyMotion;
    let exact = validation.outcome.findings.iter().filter(bound);
    for finding in exact.filter(|f| f.tolerance > 0.0 && f.relative_difference.is_finite()) {
        let max = tolerances.entry(&finding.key).or_default();
        *max = max.max(tolerance(finding));
    }
    let mut block = format!("{HEADER}\n");
    for (key, tolerance) in &tolerances {
        block += &format!("{key} = {tolerance:.0e}\n");
    }
    let at = rest.find("\n[").map_or(rest.len(), |at| at + 1);
    let (head, tail) = rest.split_at(at);
    let gap = if head.is_empty() { "" } else { "\n" };
    let text = format!(
        "{}{gap}{block}\n{tail}",
        head.trim_end().to_owned() + if head.is_empty() { "" } else { "\n" }
    );
    std::fs::write(&file, text.trim_end().to_owned() + "\n")?;
    Ok(tolerances.len())
}

/// Rounded up to one digit.
fn tolerance(finding: &Finding) -> f64 {
    let rounding = ROUNDING_FACTOR * f64::EPSILON;
    let more = (rounding * finding.condition_number)
        .min(MAX_CONDITION_FACTOR * finding.relative_difference);
    let tolerance_bound = (DIFFERENCE_FACTOR * finding.relative_difference + more).max(rounding);
    let unit = 10_f64.powf(tolerance_bound.log10().floor());
    // Not up for the rounding of this quotient.
    (tolerance_bound / unit - 1e-9).ceil() * unit
}

/// The file without its tolerances.
fn without_tolerances(text: &str) -> String {
    let Some(from) = text.find("[tolerances]") else {
        return text.to_owned();
    };
    let to = text[from..]
        .find("\n[")
        .map_or(text.len(), |at| from + at + 1);
    text[..from].to_owned() + &text[to..]
}
