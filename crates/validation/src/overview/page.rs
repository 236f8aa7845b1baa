//! The overview as one HTML file, with links from every case and check to its findings and pictures, and to the other reports.

use super::{CheckCell, ValidatedCase, ValidationRun, check_cells};
use crate::report_parts::{margin, margin_text};
use dwell_findings::Check;
use dwell_report::escaped;

const STYLE: &str = include_str!("page.css");

/// The other reports with their contents.
const REPORTS: &str = "<nav><ul>\n\
    <li><a href=\"manual.html\">Verification manual</a>: what is required, and the evidence for each capability</li>\n\
    <li><a href=\"extremes.html\">Extreme parameters</a>: ratios, scales, singular and stiff cases</li>\n\
    <li><a href=\"extremes-forms.html\">Extremes in other forms</a>: in space, in single precision, on tables, as exported code</li>\n\
    <li><a href=\"mutations.md\">Mutation study</a>: which checks detect which fault (just mutations)</li>\n\
    <li><a href=\"mutations-space.md\">Mutation study in space</a>: the same for mechanisms in space</li>\n\
    <li><a href=\"exported-runs.html\">Exported runs</a>: what tables of other programs are worth</li>\n\
    </ul></nav>\n";

/// The overview. Its text is escaped; it has no script and loads nothing.
pub(super) fn html(judged: &ValidationRun<'_>) -> String {
    let results = &judged.cases;
    let mut text = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>Dwell: cases</title>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src {}\">\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <h1>{}</h1>\n<p>Dwell {}. A number is the margin of a check: how many times its difference the tolerance of the nearest finding is. \
         It leads to the findings.</p>\n",
        dwell_page::source_hash(STYLE),
        escaped(&judged.headline()),
        env!("CARGO_PKG_VERSION"),
    );
    text += REPORTS;
    text += "<div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\">case</th>";
    text.extend(Check::ALL.map(|check| {
        let check = escaped(&check.to_string());
        format!("<th scope=\"col\" class=\"check\"><span>{check}</span></th>")
    }));
    text += "</tr></thead>\n<tbody>\n";
    text.extend(results.iter().map(row));
    text += "</tbody>\n</table></div>\n<h2>Pictures and failures</h2>\n";
    text.extend(results.iter().map(case));
    text + "</body>\n</html>\n"
}

/// A case with the margin of each check.
fn row(case: &ValidatedCase<'_>) -> String {
    let done = match &case.result {
        Ok(validated) => validated,
        Err(reason) => {
            return format!(
                "<tr><th scope=\"row\">{}</th><td class=\"fail\" colspan=\"{}\">not validated: {}</td></tr>\n",
                escaped(case.name),
                Check::ALL.len(),
                escaped(reason)
            );
        }
    };
    let page = format!("{}.html", case.name);
    let cells = Check::ALL
        .into_iter()
        .zip(check_cells(done))
        .map(|(check, cell)| {
            let f = match cell {
                CheckCell::Nearest(finding) => finding,
                CheckCell::NotApplicable(why) => {
                    return format!("<td class=\"none\" title=\"{}\">·</td>", escaped(why));
                }
            };
            let (difference, tolerance) = (f.relative_difference, f.tolerance);
            let title = format!("{}: {difference:.1e}, tolerance {tolerance:.1e}", f.key);
            let (class, text) = if f.pass {
                (format!("d{}", shade(margin(f))), margin_text(margin(f)))
            } else {
                ("fail".to_owned(), format!("FAIL {}", f.key))
            };
            format!(
                "<td class=\"{class}\"><a href=\"{}#check={}\" title=\"{}\">{}</a></td>",
                escaped(&page),
                check.number(),
                escaped(&title),
                escaped(&text)
            )
        });
    format!(
        "<tr><th scope=\"row\"><a href=\"{}\">{}</a></th>{}</tr>\n",
        escaped(&page),
        escaped(case.title),
        cells.collect::<String>()
    )
}

/// The shade of a margin: one for each power of ten.
fn shade(margin: f64) -> usize {
    margin.log10().clamp(0.0, 5.0) as usize
}

/// The pictures of a case, and its failures.
fn case(case: &ValidatedCase<'_>) -> String {
    let Ok(done) = &case.result else {
        return format!(
            "<p class=\"fail\">{}: not validated</p>\n",
            escaped(case.name)
        );
    };
    let findings = &done.outcome.findings;
    let passed = findings.iter().filter(|f| f.pass).count();
    let failed: String = findings
        .iter()
        .filter(|f| !f.pass)
        .map(|f| {
            format!(
                "<li class=\"fail\">{}: {}</li>\n",
                escaped(&f.key),
                escaped(&f.comparison)
            )
        })
        .collect();
    let pictures: Vec<String> = done
        .outcome
        .pictures
        .iter()
        .map(|picture| {
            let path = &picture.path;
            let file = path.rsplit('/').next().unwrap_or(path);
            let words = file.strip_suffix(".png").unwrap_or(file);
            format!("<a href=\"{}\">{}</a>", escaped(path), escaped(words))
        })
        .collect();
    format!(
        "<details{}><summary>{} <small>{passed} of {} findings pass</small></summary>\n<ul>{failed}</ul>\n<p><a href=\"{}.html\">page of the case</a> · {}</p></details>\n",
        if failed.is_empty() { "" } else { " open" },
        escaped(case.title),
        findings.len(),
        escaped(case.name),
        pictures.join(" · ")
    )
}
