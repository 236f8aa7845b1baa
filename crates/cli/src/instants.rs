//! The file of requested instants: one time in s on each line. Empty lines and text after `#` are ignored.

use dwell_scene::SceneError;
use std::path::Path;

/// Reads the instants; their order and range are checked later, with the motion.
pub(crate) fn read(path: &Path) -> Result<Vec<f64>, SceneError> {
    let shown = path.display();
    let fault = |message: String| {
        let help = "give one time in s on each line, such as 0.25".to_owned();
        SceneError::without_labels(message, Some(help))
    };
    let text = std::fs::read_to_string(path)
        .map_err(|e| fault(format!("the instants in `{shown}` cannot be read: {e}")))?;
    let mut times = Vec::new();
    for (k, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        let time = line.parse().ok().filter(|t: &f64| t.is_finite());
        let time =
            time.ok_or_else(|| fault(format!("line {} of `{shown}` is no time: `{line}`", k + 1)))?;
        times.push(time);
    }
    Ok(times)
}
