//! A document as an HTML file that prints well, without scripts or external resources.

use crate::markdown::{Block, Document};
use crate::number::scientific;
use dwell_findings::Finding;

/// For screens and paper: tables do not break inside a row, and headings stay with what follows.
const STYLE: &str = "body{font:10.5pt/1.4 Georgia,serif;margin:2em auto;max-width:62em;padding:0 1em;color:#111}\
h1{font-size:1.7em}h2{font-size:1.25em;margin-top:2em;border-bottom:1px solid #999}\
table{border-collapse:collapse;width:100%;font:8.5pt/1.3 Helvetica,Arial,sans-serif;margin:.8em 0}\
th,td{border:1px solid #bbb;padding:.25em .4em;text-align:left;vertical-align:top;overflow-wrap:anywhere}\
th{background:#eee;overflow-wrap:normal}code{font-size:.95em}td strong,.fail{color:#a00}\
figure{margin:1em 0}figure img{max-width:100%;height:auto}figcaption{font-style:italic}.words{white-space:pre-line}.table{overflow-x:auto}\
@media print{@page{size:A4 landscape;margin:14mm}body{margin:0;max-width:none;font-size:9.5pt}\
h2{break-after:avoid}tr{break-inside:avoid}thead{display:table-header-group}a{color:inherit;text-decoration:none}}";

impl Document {
    /// The document as an HTML file that prints well, without scripts. Its pictures are files beside it; it uses no external
    /// resources.
    ///
    /// ```
    /// use dwell_report::{Block, Document};
    ///
    /// let blocks = vec![Block::Words("a < b".to_owned())];
    /// let document = Document { title: "Study".to_owned(), blocks };
    /// assert!(document.html().contains("<p class=\"words\">a &lt; b</p>"));
    /// ```
    pub fn html(&self) -> String {
        let title = escaped(&self.title);
        let mut text = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
        );
        for block in &self.blocks {
            match block {
                Block::Heading(heading) => text += &format!("<h2>{}</h2>\n", inline(heading)),
                Block::Text(paragraphs) => {
                    for paragraph in paragraphs.split("\n\n") {
                        text += &paragraph_or_list(paragraph);
                    }
                }
                Block::Words(words) => {
                    text += &format!("<p class=\"words\">{}</p>\n", escaped(words));
                }
                Block::Table { header, rows } => text += &table(header, rows),
                Block::Figure { file, alt, caption } => text += &figure(file, alt, caption),
                Block::Findings(all) => text += &findings(all),
            }
        }
        text + "</body>\n</html>\n"
    }
}

/// A picture, which a click opens by itself.
fn figure(file: &str, alt: &str, caption: &str) -> String {
    let [file, alt, caption] = [file, alt, caption].map(escaped);
    format!(
        "<figure><a href=\"{file}\"><img src=\"{file}\" alt=\"{alt}\" loading=\"lazy\"></a><figcaption>{caption}</figcaption></figure>\n"
    )
}

fn findings(all: &[Finding]) -> String {
    const HEADER: [&str; 6] = [
        "Result",
        "Check",
        "Comparison",
        "Relative difference",
        "Tolerance",
        "Worst at",
    ];
    let line = |f: &Finding| {
        let result = if f.pass {
            "<td>pass</td>".to_owned()
        } else {
            "<td class=\"fail\">FAIL</td>".to_owned()
        };
        let [relative, tolerance] =
            [f.relative_difference, f.tolerance].map(|value| scientific(value, 3));
        let cells = [
            f.check.to_string(),
            f.comparison.clone(),
            relative,
            tolerance,
            f.worst_at.clone(),
        ]
        .map(|cell| format!("<td>{}</td>", escaped(&cell)));
        format!("<tr>{result}{}</tr>\n", cells.concat())
    };
    let header = HEADER.map(|cell| format!("<th>{cell}</th>")).concat();
    let body: String = all.iter().map(line).collect();
    format!("<table>\n<thead><tr>{header}</tr></thead>\n<tbody>\n{body}</tbody>\n</table>\n")
}

fn paragraph_or_list(paragraph: &str) -> String {
    let items: Option<Vec<&str>> = paragraph
        .lines()
        .map(|line| line.strip_prefix("- "))
        .collect();
    match items {
        Some(items) if !items.is_empty() => {
            let items = items
                .iter()
                .map(|item| format!("<li>{}</li>\n", inline(item)));
            format!("<ul>\n{}</ul>\n", items.collect::<String>())
        }
        _ => format!("<p>{}</p>\n", inline(paragraph)),
    }
}

fn table(header: &[String], rows: &[Vec<String>]) -> String {
    let line = |row: &[String], tag: &str| {
        let cells = row
            .iter()
            .map(|cell| format!("<{tag}>{}</{tag}>", inline(cell)));
        format!("<tr>{}</tr>\n", cells.collect::<String>())
    };
    let body: String = rows.iter().map(|row| line(row, "td")).collect();
    format!(
        "<div class=\"table\"><table>\n<thead>{}</thead>\n<tbody>\n{body}</tbody>\n</table></div>\n",
        line(header, "th")
    )
}

/// Text with the marks of Markdown that the manual uses: `code`, **strong**, [words](address).
fn inline(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(['`', '*', '[', '\\']) {
        out += &escaped(&rest[..at]);
        rest = &rest[at..];
        let (marked, after) = mark(rest);
        out += &marked;
        rest = after;
    }
    out + &escaped(rest)
}

/// The mark that a text begins with, and what is behind it.
fn mark(text: &str) -> (String, &str) {
    if let Some(after) = text.strip_prefix('\\') {
        let end = after.chars().next().map_or(0, char::len_utf8);
        return (escaped(&after[..end]), &after[end..]);
    }
    let between = |open: &str, close: &str| text.strip_prefix(open)?.split_once(close);
    if let Some((code, after)) = between("`", "`") {
        return (format!("<code>{}</code>", escaped(code)), after);
    }
    if let Some((strong, after)) = between("**", "**") {
        return (format!("<strong>{}</strong>", inline(strong)), after);
    }
    if let Some((words, after)) = between("[", "](")
        && let Some((address, after)) = after.split_once(')')
        && !words.contains(']')
    {
        let link = format!("<a href=\"{}\">{}</a>", escaped(address), inline(words));
        return (link, after);
    }
    let end = text.chars().next().map_or(0, char::len_utf8);
    (escaped(&text[..end]), &text[end..])
}

/// Text with HTML's special characters escaped, also for attributes.
///
/// ```
/// assert_eq!(dwell_report::escaped("a < \"b\""), "a &lt; &quot;b&quot;");
/// ```
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_become_elements_and_everything_else_is_escaped() {
        assert_eq!(
            inline("a < `b*c` is **FAIL**, see [x](y.md#z) [friction.<pin>] 2*3"),
            "a &lt; <code>b*c</code> is <strong>FAIL</strong>, see <a href=\"y.md#z\">x</a> [friction.&lt;pin&gt;] 2*3"
        );
    }

    #[test]
    fn the_page_is_whole_and_has_no_script() {
        let document = Document {
            title: "T".to_owned(),
            blocks: vec![Block::Table {
                header: vec!["h".to_owned()],
                rows: vec![vec!["<script>".to_owned()]],
            }],
        };
        let page = document.html();
        assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
        assert!(!page.contains("<script"), "{page}");
        assert!(page.contains("@media print"));
    }
}
