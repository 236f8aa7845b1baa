"""The overview of the outcomes of all changes: reports/source-mutations.txt and .md."""
import collections
import tomllib

import judge

# The outcomes, in the order of the table.
OUTCOMES = [judge.CAUGHT, "caught by one", "refused", "endless", "not caught", "only an estimate", "no number changed", "not reached"]
# Largest fraction of the changes of a number that may stay uncaught.
MOST_UNCAUGHT = 0.02
GROUPS = ["laws, every line", "drawn lines", "named faults"]
ESTIMATE = "only an estimated error, a residual or a count of steps changes, which no result depends on"

SENTENCE = "only a printed sentence changes: check 19 compares it with the summary, whose numbers the other checks judge"


def group_of(result):
    if result["named"]:
        return GROUPS[2]
    return GROUPS[0] if result["file"].startswith("crates/laws/") else GROUPS[1]


def reasons(top):
    path = top / "tests/mutate/reasons.toml"
    listed = tomllib.loads(path.read_text(encoding="utf-8")).get("reason", []) if path.is_file() else []
    return {(one["file"], one["line"], one["change"]): one["why"] for one in listed}


def why(result, known):
    """The reason why two checks do not catch a change: from reasons.toml, or derived from the outcome."""
    written = known.get((result["file"], result["text"], result["change"]))
    if written:
        return written
    if result["only_estimates"]:
        return ESTIMATE
    is_sentence = set(result["checks"]) == {"19"} and set(result.get("kinds", ())) == {"printed"}
    return SENTENCE if is_sentence else ""


def outcome_of(result):
    """Its outcome; what is not caught and says only how certain or how costly a result is counts by itself."""
    is_estimate = result["outcome"] == "not caught" and result["only_estimates"]
    return "only an estimate" if is_estimate else result["outcome"]


def has_changed_number(result):
    return outcome_of(result) in (judge.CAUGHT, "caught by one", "not caught")


def is_open(result):
    return outcome_of(result) in ("caught by one", "not caught", "only an estimate")


def write(top, results, left_out, options, say, compiled):
    """Writes both files; status 1 where too many changes are uncaught, or one without a reason. `compiled` counts all changes that
    compile, of which a run that is stopped tries a part."""
    known = reasons(top)
    text = table(results)
    changed = [r for r in results if has_changed_number(r)]
    by_none = [r for r in changed if r["outcome"] == "not caught"]
    by_one = [r for r in changed if r["outcome"] == "caught by one"]
    uncaught = [r for r in results if is_open(r)]
    unexplained = [r for r in by_none if not why(r, known)]
    share = len(by_none) / max(1, len(changed))
    text += [
        "",
        f"Of {len(changed)} changes of a result {len(changed) - len(by_none) - len(by_one)} are caught by two checks of different number, {len(by_one)} by one,",
        f"{len(by_none)} ({share:.1%}) by none, {len(unexplained)} of them without a reason. {left_out} changes do not compile.",
    ]
    if len(results) < compiled:
        text.append(f"{len(results)} of the {compiled} changes that compile were tried: the run was stopped.")
    name = "named-source-faults" if options.named else "source-mutations"
    origin = "the named faults" if options.named else f"{options.lines} drawn lines, seed {options.seed}; all of the laws; the named faults"
    title = f"Changes of the source text: {origin}"
    document = [f"# {title}", "", "```text", *text, "```", "", *named_table(results), *open_table(uncaught, known)]
    (top / "reports" / f"{name}.md").write_text("\n".join(document) + "\n", encoding="utf-8")
    lines = [title, "", *text, "", *named_lines(results), *open_lines(uncaught, known)]
    (top / "reports" / f"{name}.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    for line in text:
        say(line)
    say(f"reports/{name}.md, reports/{name}.txt")
    return int(share > MOST_UNCAUGHT or bool(unexplained))


def table(results):
    """How many changes of each group had which outcome, and how often each check failed."""
    counts = collections.Counter((group_of(r), outcome_of(r)) for r in results)
    lines = [" " * 20 + "".join(f"{group:>20}" for group in GROUPS)]
    for outcome in OUTCOMES:
        lines.append(f"{outcome:20}" + "".join(f"{counts[group, outcome]:20}" for group in GROUPS))
    lines.append(f"{'all':20}" + "".join(f"{sum(group_of(r) == group for r in results):20}" for group in GROUPS))
    checks = collections.Counter(number for r in results for number in r["checks"])
    lines += ["", "check that fails: changes   " + "  ".join(f"{n}: {checks[n]}" for n in sorted(checks, key=int))]
    return lines


def named_table(results):
    rows = [r for r in results if r["named"]]
    if not rows:
        return []
    lines = ["## Named faults", "", "| class | fault | outcome | checks that fail |", "|---|---|---|---|"]
    for r in rows:
        checks = "; ".join(f"{n} ({where})" for n, where in sorted(r["checks"].items(), key=lambda c: int(c[0])))
        lines.append(f"| {r['named']['class']} | {r['named']['sentence']} | {r['outcome']} | {checks} |")
    return [*lines, ""]


def named_lines(results):
    """The named faults with the checks that fail, for the committed file."""
    rows = [r for r in results if r["named"]]
    # As in mutations.txt, from which the verification manual reads: sentence, where it is, the numbers of the checks.
    of = lambda r: " ".join(sorted(r["checks"], key=int)) or r["outcome"]
    lines = [f"  {r['named']['sentence']:84}  {r['named']['class']:18}  {of(r)}" for r in rows]
    return ["Named faults, and the checks that fail", *lines, ""] if rows else []


def open_lines(uncaught, known):
    """What two checks do not catch, by files: the line, the change, the checks that fail, the largest change and where, the reason."""
    lines, file = ["Changes of a number that two checks do not catch"], None
    for r in uncaught:
        if r["named"]:
            continue
        if r["file"] != file:
            file = r["file"]
            lines.append(f"  {file}")
        place = r["place"].split(": ", 1)[-1]
        lines.append(f"    {r['line']:4}  {r['text']}")
        lines.append(f"          {r['change']}; [{' '.join(r['checks'])}]; {r['size']:.0e} in {place}; {why(r, known) or 'no reason'}")
    return lines


def open_table(uncaught, known):
    lines = ["## Changes of a number that two checks do not catch", ""]
    if not uncaught:
        return [*lines, "None."]
    lines += ["| where | change | line | number that changes | by | checks | reason |", "|---|---|---|---|---|---|---|"]
    for r in uncaught:
        of = lambda text: text.replace("|", "\\|")
        size = f"{r['size']:.1g}"
        lines.append(
            f"| {r['file']}:{r['line']} | {of(r['change'])} | `{of(r['text'])}` | {of(r['place'])} | {size} "
            f"| {', '.join(r['checks'])} | {of(why(r, known))} |"
        )
    return lines
