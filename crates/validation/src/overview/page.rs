//! The overview as one HTML file: from every case and check to its findings and pictures, and to the other reports.

use super::{CaseResult, CheckCell, check_cells, passed};
use dwell_findings::{Check, Finding};
use dwell_report::escaped;

const STYLE: &str = include_str!("page.css");

/// The other reports, each with what it holds.
const REPORTS: &str = "<nav><ul>\n\
    <li><a href=\"manual.html\">Verification manual</a>: what is required, and the evidence for each capability</li>\n\
    <li><a href=\"space.html\">Mechanisms in space</a>: linkages in space against the dense equations and references</li>\n\
    <li><a href=\"extremes.html\">Extreme parameters</a>: ratios, scales, singular and stiff cases</li>\n\
    <li><a href=\"extremes-forms.html\">Extremes in other forms</a>: in space, in single precision, on tables, as exported code</li>\n\
    <li><a href=\"extremes-pulses.html\">Pulses</a>: random pulses against closed forms</li>\n\
    <li><a href=\"extremes-machines.html\">Machines</a>: random machines against the multibody equations</li>\n\
    <li><a href=\"mutations.md\">Mutation study</a>: which checks detect which fault (just mutations)</li>\n\
    <li><a href=\"mutations-space.md\">Mutation study in space</a>: the same for mechanisms in space</li>\n\
    <li><a href=\"exported-runs.html\">Exported runs</a>: what tables of other programs are worth</li>\n\
    </ul></nav>\n";

/// The overview. Its text is escaped, it has no script, and loads nothing.
pub(super) fn html(results: &[CaseResult<'_>]) -> String {
    let mut text = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>Dwell: cases</title>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src {}\">\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <h1>Cases and checks</h1>\n<p>{} of {} cases pass. Dwell {}. A number is the agreeing decimal digits of the worst finding of a check; \
         double precision has 15.7. It leads to the findings.</p>\n",
        dwell_page::source_hash(STYLE),
        passed(results),
        results.len(),
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

/// A case with the digits of each check.
fn row((name, result): &CaseResult<'_>) -> String {
    let (scene, done) = match result {
        Ok(validated) => validated,
        Err(reason) => {
            return format!(
                "<tr><th scope=\"row\">{}</th><td class=\"fail\" colspan=\"{}\">not validated: {}</td></tr>\n",
                escaped(name),
                Check::ALL.len(),
                escaped(reason)
            );
        }
    };
    let page = format!("{}.html", scene.name);
    let cells = Check::ALL.into_iter().zip(check_cells(done));
    let cells = cells.map(|(check, cell)| {
        let findings = done.outcome.findings.iter();
        let worst = worst(findings.filter(|f| f.check == check));
        let title = worst.map_or_else(String::new, |f| {
            format!(
                "{}: {:.1e}, tolerance {:.1e}",
                f.key, f.relative_difference, f.tolerance
            )
        });
        let link = format!("{}#check={}", escaped(&page), check.number());
        let title = escaped(&title);
        match cell {
            CheckCell::Digits(digits) => format!(
                "<td class=\"d{}\"><a href=\"{link}\" title=\"{title}\">{digits:.1}</a></td>",
                shade(digits)
            ),
            CheckCell::Failed(key) => format!(
                "<td class=\"fail\"><a href=\"{link}\" title=\"{title}\">FAIL {}</a></td>",
                escaped(&key)
            ),
            CheckCell::NotApplicable(why) => {
                format!("<td class=\"none\" title=\"{}\">·</td>", escaped(why))
            }
        }
    });
    format!(
        "<tr><th scope=\"row\"><a href=\"{}\">{}</a></th>{}</tr>\n",
        escaped(&page),
        escaped(&scene.title),
        cells.collect::<String>()
    )
}

/// The finding that is nearest to its tolerance, or beyond it; what is not a number is the worst there is.
fn worst<'f>(findings: impl Iterator<Item = &'f Finding>) -> Option<&'f Finding> {
    findings.max_by(|a, b| a.relative_difference.total_cmp(&b.relative_difference))
}

/// The shade of a number of digits: three of each.
fn shade(digits: f64) -> usize {
    (digits / 3.0).clamp(0.0, 5.0) as usize
}

/// The pictures of a case, and what fails in it.
fn case((name, result): &CaseResult<'_>) -> String {
    let Ok((scene, done)) = result else {
        return format!("<p class=\"fail\">{}: not validated</p>\n", escaped(name));
    };
    let findings = &done.outcome.findings;
    let passed = findings.iter().filter(|f| f.pass).count();
    let failed = findings.iter().filter(|f| !f.pass).map(|f| {
        format!(
            "<li class=\"fail\">{}: {}</li>\n",
            escaped(&f.key),
            escaped(&f.comparison)
        )
    });
    let failed: String = failed.collect();
    let pictures = done.outcome.pictures.iter().map(|picture| {
        let path = &picture.path;
        let file = path.rsplit('/').next().unwrap_or(path);
        let words = file.strip_suffix(".png").unwrap_or(file);
        format!("<a href=\"{}\">{}</a>", escaped(path), escaped(words))
    });
    let pictures: Vec<String> = pictures.collect();
    format!(
        "<details{}><summary>{} <small>{passed} of {} findings pass</small></summary>\n<ul>{failed}</ul>\n<p><a href=\"{}.html\">page of the case</a> · {}</p></details>\n",
        if failed.is_empty() { "" } else { " open" },
        escaped(&scene.title),
        findings.len(),
        escaped(&scene.name),
        pictures.join(" · ")
    )
}
