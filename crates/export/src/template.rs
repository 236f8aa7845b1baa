//! Templates of several texts.

/// The marks of lines: `2` and `3` for versions of FMI; `1` for one degree of freedom and `n` for several, `l` for loads and `z`
/// for none, `r` for reactions, `p` for points, `v` for potentials, `d` for derivatives of w, `o` for whole revolutions and `e` for ends.
const MARKS: &str = "123delnoprvz";

/// The text of a template in which these marks hold: a line that begins with marks and `|` is there only if all of them hold.
pub(crate) fn lines_for(template: &str, holding: &str) -> String {
    let line = |line: &str| {
        let (marks, rest) = match line.split_once('|') {
            Some((marks, rest)) if marks.chars().all(|mark| MARKS.contains(mark)) => (marks, rest),
            _ => ("", line),
        };
        let holds = marks.chars().all(|mark| holding.contains(mark));
        holds.then(|| format!("{rest}\n"))
    };
    template.lines().filter_map(line).collect()
}
