//! The HTML file of a page: markup, style, script, description and numbers.

use crate::description::Page;
use crate::encoded::PageError;
use crate::packed::packed;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest as _, Sha256};

/// The style of a page.
pub const STYLE: &str = include_str!("page/page.css");

/// The script of a page. It defines `DwellPage`, whose `create(root)` returns an object that shows one encoded page after
/// another by `show(description, numbers)`.
pub const SCRIPT: &str = concat!(
    "'use strict';\nconst DwellPage = (() => {\n",
    include_str!("page/elements.js"),
    include_str!("page/numbers.js"),
    include_str!("page/run.js"),
    include_str!("page/space.js"),
    include_str!("page/mechanism.js"),
    include_str!("page/symbols.js"),
    include_str!("page/solids.js"),
    include_str!("page/arrows.js"),
    include_str!("page/curve.js"),
    include_str!("page/chart.js"),
    include_str!("page/charts.js"),
    include_str!("page/player.js"),
    include_str!("page/peaks.js"),
    include_str!("page/words.js"),
    include_str!("page/downloads.js"),
    include_str!("page/state.js"),
    include_str!("page/page.js"),
    "return { create, unpack };\n})();\n",
);

/// The script that runs when the file is opened.
const START: &str = include_str!("page/start.js");
const MARKUP: &str = include_str!("page/page.html");

impl Page {
    /// The page as one HTML file, which loads nothing else. Its content security policy admits only its own style and scripts,
    /// by their hashes.
    ///
    /// # Errors
    /// As [`encode`](Self::encode); [`PageError::Packing`] if the numbers cannot be packed.
    pub fn html(&self) -> Result<String, PageError> {
        let encoded = self.encode()?;
        // Within a script element only `</` and `<!--` are special; in JSON both can be escaped.
        let description = encoded.description.replace('<', "\\u003c");
        let parts = [
            ("{{title}}", escaped(&self.title)),
            ("{{policy}}", policy()),
            ("{{style}}", STYLE.to_owned()),
            ("{{description}}", description),
            ("{{numbers}}", packed(&encoded.numbers)?),
            ("{{script}}", SCRIPT.to_owned()),
            ("{{start}}", START.to_owned()),
        ];
        // Each placeholder is replaced once; inserted text is never searched for placeholders.
        let mut html = String::new();
        let mut rest = MARKUP;
        for (place, text) in parts {
            let Some((before, after)) = rest.split_once(place) else {
                continue;
            };
            html += before;
            html += &text;
            rest = after;
        }
        Ok(html + rest)
    }
}

/// The hash of a style or script, for a content security policy.
///
/// ```
/// assert!(dwell_page::source_hash("p{margin:0}").starts_with("'sha256-"));
/// ```
pub fn source_hash(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)))
}

/// The content security policy of the file.
fn policy() -> String {
    let [style, script, start] = [STYLE, SCRIPT, START].map(source_hash);
    format!(
        "default-src 'none'; img-src data:; style-src {style}; script-src {script} {start}; base-uri 'none'; form-action 'none'"
    )
}

/// Text with HTML's special characters escaped.
fn escaped(text: &str) -> String {
    let mut html = String::new();
    for c in text.chars() {
        match c {
            '&' => html += "&amp;",
            '<' => html += "&lt;",
            '>' => html += "&gt;",
            '"' => html += "&quot;",
            '\'' => html += "&#39;",
            c => html.push(c),
        }
    }
    html
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PageColumn;

    fn hostile() -> Page {
        let title = "</title><script>alert(1)</script>{{script}}";
        let key = "</script><img src=x onerror=alert(1)>";
        Page {
            title: title.to_owned(),
            printed: "<!--<script>".to_owned(),
            columns: vec![PageColumn::new(key, "m", vec![1.0])],
            ..Page::default()
        }
    }

    #[test]
    fn what_a_scene_names_is_no_markup() {
        let html = hostile().html().unwrap();
        assert_eq!(html.matches("</script>").count(), 4);
        assert_eq!(html.matches("<script").count(), 4);
        assert!(!html.contains("<!--") && !html.contains("<img"));
        assert!(html.contains(
            "<title>&lt;/title&gt;&lt;script&gt;alert(1)&lt;/script&gt;{{script}}</title>"
        ));
    }

    #[test]
    fn the_policy_names_the_scripts_and_the_style_by_hash_and_nothing_else() {
        let html = Page::default().html().unwrap();
        let policy = policy();
        assert!(html.contains(&policy));
        assert!(!policy.contains("unsafe") && policy.starts_with("default-src 'none';"));
        // The hash is that of the text between the tags.
        for (open, hashed) in [
            ("<style>", STYLE),
            ("<script id=\"page-script\">", SCRIPT),
            ("<script id=\"page-start\">", START),
        ] {
            let (_, rest) = html.split_once(open).unwrap();
            assert!(rest.starts_with(hashed));
            assert!(rest[hashed.len()..].starts_with("</"));
        }
    }

    #[test]
    fn the_same_page_has_the_same_bytes() {
        assert_eq!(hostile().html().unwrap(), hostile().html().unwrap());
    }
}
