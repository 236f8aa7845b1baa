#!/usr/bin/env python3
"""Tests on small texts: possible changes, extents of expressions, and differences between two runs."""
import contents
import schemata
from changes import changes_of

CHANGED = [
    # A line in a function, and all that its changes make of the expression.
    ("let x = a + b * c;", ["a - b * c", "a + b / c"]),
    ("f(x - y, 0.5)", ["x + y", "(2.0 * 0.5)", "(1.01 * 0.5)"]),
    ("y[0] -= offset;", ["y[1] -= offset", "y[0] += offset", "()"]),
    ("if t <= end { stop() }", ["t >= end"]),
    ("let v = -s;", ["s"]),
    ("let s = a.sin().max(b);", ["a.cos().max(b)", "a.sin().min(b)"]),
    ('let text = format!("{} - {}", a - b, c);', []),
    ("const HALF: f64 = 0.5;", []),
    ("let s: &'a str = t;", []),
]


def check_changes():
    for line, expected in CHANGED:
        text = f"fn f(a: f64) -> f64 {{\n    {line}\n}}\n"
        found = [change.text for change in changes_of("file.rs", text)]
        assert found == expected, (line, found)
    outside = "trait T: A + B {}\n#[cfg(test)]\nmod tests {\n    fn g() -> f64 { 1.0 + 2.0 }\n}\nconst fn h() -> f64 { 1.0 + 2.0 }\n"
    assert not changes_of("file.rs", outside)


def check_choices():
    text = "fn f() {\n    let x = g(a + 1.5) * b;\n}\n"
    changes = changes_of("file.rs", text)
    for number, change in enumerate(changes, 1):
        change.number = number
    rendered = schemata.Rendered(text, changes)
    written = rendered.written()
    assert written.count("{ g(a + 1.5) / b }") == 1 and written.count("{ a - 1.5 }") == 1, written
    # An error in one choice is attributed to its change only.
    at = len(written[: written.index("a - 1.5")].encode())
    assert [c.text for c in rendered.blamed(at, at + 3)] == ["a - 1.5"]


def check_differences():
    def written(text, printed=""):
        class Run:
            files = {"a.csv": text.encode()}
        Run.printed = printed
        return Run

    base = written("t [s],x [m]\n0.0,1.0\n1.0,2.0\n", "period 2.0 s")
    assert contents.difference(base, written("t [s],x [m]\n0.0,1.0\n1.0,2.000000000001\n", "period 2.0 s")) is None
    found = contents.difference(base, written("t [s],x [m]\n0.0,1.001\n1.0,2.0\n", "period 2.0 s"))
    assert abs(found.largest - 0.0005) < 1e-12 and "x [m]" in found.place and not found.only_estimates
    assert contents.difference(base, written("t [s],x [m]\n0.0,1.0\n1.0,2.0\n", "period 2.1 s")).largest > 0.04
    steps = [written("", f"{n} steps") for n in (7, 8)]
    assert contents.difference(*steps).only_estimates


if __name__ == "__main__":
    check_changes()
    check_choices()
    check_differences()
    print("the changes of the source text are as they should be")
