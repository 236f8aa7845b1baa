//! The one-file HTML page of a command: `NAME-COMMAND.html`.

use super::results_page::RESULTS_HEADER;
use super::{CommandResult, Outcome};
use crate::explain::StudyError;
use crate::page::{error_messages, scene_page};
use dwell_page::{FileLink, Page, PageTable};
use dwell_report::{Block, Document};

/// Adds the page to the files of an outcome that is drawn: rows, peaks and mechanism, if the analysis has them, and the
/// printed text, the numbers, findings and messages.
///
/// # Errors
/// [`StudyError::Page`] if it cannot be encoded.
pub fn add_page(
    outcome: &mut Outcome,
    result: &CommandResult<'_>,
    path: &str,
) -> Result<(), StudyError> {
    let base = match result.scene {
        Some(scene) => scene_page(scene, result.command),
        None => Page {
            command: result.command.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            ..Page::default()
        },
    };
    let run = outcome.run.take().map_or_else(Page::default, |run| *run);
    let mut messages = base.messages;
    messages.extend(error_messages(result.errors));
    let title = [
        base.title,
        run.title.clone(),
        format!("dwell {}", base.command),
    ];
    let page = Page {
        title: title
            .into_iter()
            .find(|t| !t.is_empty())
            .unwrap_or_default(),
        command: base.command,
        note: base.note,
        scene: base.scene,
        version: base.version,
        units: base.units,
        messages,
        findings: outcome.findings.clone(),
        printed: outcome.summary.clone(),
        numbers: outcome.record.numbers.clone(),
        events: outcome.record.events.clone(),
        files: links(outcome, path),
        ..run
    };
    let html = page.html()?;
    outcome.files.add(path, html);
    Ok(())
}

/// Links to the files beside a page.
fn links(outcome: &Outcome, own: &str) -> Vec<FileLink> {
    let folder = own.rsplit_once('/').map_or("", |(folder, _)| folder);
    let link = |path: &str| {
        let path = path.strip_prefix(folder).unwrap_or(path);
        let path = path.trim_start_matches('/').to_owned();
        FileLink {
            title: path.clone(),
            path,
        }
    };
    let written = outcome.files.paths().map(|path| path.display().to_string());
    let all = written.chain(outcome.record.files.iter().cloned());
    all.filter(|path| path != own)
        .map(|path| link(&path))
        .collect()
}

/// A page with the tables of a document, except that of the numbers, which every page shows.
pub(super) fn tables_page(document: &Document) -> Box<Page> {
    let mut heading = String::new();
    let mut tables = Vec::new();
    for block in &document.blocks {
        match block {
            Block::Heading(text) => heading.clone_from(text),
            Block::Table { header, rows } if *header != RESULTS_HEADER => tables.push(PageTable {
                title: heading.clone(),
                header: header.clone(),
                rows: rows.clone(),
            }),
            Block::Table { .. }
            | Block::Text(_)
            | Block::Words(_)
            | Block::Figure { .. }
            | Block::Findings(_) => {}
        }
    }
    Box::new(Page {
        tables,
        ..Page::default()
    })
}
