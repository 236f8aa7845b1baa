"""The possible changes of a line of computation: one operator, constant, sign, function or index at a time."""

from rust_text import Source

SWAPPED = {"+": "-", "-": "+", "*": "/", "/": "*", "<": ">", ">": "<", "<=": ">=", ">=": "<=", "==": "!="}
ASSIGNED = {"+=": "-=", "-=": "+=", "*=": "/=", "/=": "*="}
METHODS = {"sin": "cos", "cos": "sin", "min": "max", "max": "min", "floor": "ceil", "ceil": "floor"}
INDICES = {"0": "1", "1": "0"}


class Change:
    """One change: the expression that contains it (`start` to `end` in the text), and its replacement."""

    def __init__(self, path, line, what, region, text):
        self.path, self.line, self.what = path, line, what
        (self.start, self.end), self.text = region, text
        self.number, self.named = 0, None


def changes_of(path, text):
    """All changes of a file, in the order of its text."""
    source = Source(text)
    found = []
    for k in source.computing():
        for region, edits, what in at_token(source, k):
            start, end = region
            original = text[start:end]
            changed = original
            for first, last, new in sorted(edits, reverse=True):
                changed = changed[: first - start] + new + changed[last - start :]
            line = text.count("\n", 0, source.tokens[k].start) + 1
            found.append(Change(path, line, what, region, changed))
    return found


def at_token(source, k):
    """The changes at a token: (region, edits, what)."""
    token = source.tokens[k]
    whole = lambda: expression(source, k)
    replaced = lambda new: [(token.start, token.end, new)]
    if token.kind == "float":
        yield from constant(source, k)
    elif token.kind == "sign" and token.text in SWAPPED and source.is_spaced(k) and source.is_value_end(k - 1):
        if region := whole():
            yield region, replaced(SWAPPED[token.text]), f"{token.text} → {SWAPPED[token.text]}"
    elif token.kind == "sign" and token.text in ASSIGNED:
        if region := whole():
            yield region, replaced(ASSIGNED[token.text]), f"{token.text} → {ASSIGNED[token.text]}"
            yield region, [(*region, "()")], f"the statement with {token.text} left out"
    elif source.is_sign(k, "-") and not source.is_value_end(k - 1) and not source.is_spaced(k):
        if region := whole():
            yield region, replaced(""), "the sign − left out"
    elif token.kind == "name" and source.is_sign(k - 1, ".") and source.is_sign(k + 1, "("):
        yield from method(source, k)
    elif token.text in INDICES and source.is_sign(k - 1, "[") and source.is_sign(k + 1, "]") and is_indexed(source, k - 1):
        if region := whole_of_indexed(source, k):
            yield region, replaced(INDICES[token.text]), f"[{token.text}] → [{INDICES[token.text]}]"


def constant(source, k):
    """The number doubled, and the number increased by one per cent."""
    token = source.tokens[k]
    value = token.text.replace("_f64", "").replace("f64", "").replace("_", "")
    if source.is_sign(k - 1, ".") or float(value) == 0.0:
        return
    for factor in ("2.0", "1.01"):
        yield (token.start, token.end), [(token.start, token.end, f"({factor} * {token.text})")], f"{token.text} × {factor}"


def method(source, k):
    """Another function, the argument of `abs` itself, or another power."""
    token, region = source.tokens[k], None
    if token.text in METHODS:
        if region := expression(source, k):
            new = METHODS[token.text]
            yield region, [(token.start, token.end, new)], f"{token.text} → {new}"
    elif token.text == "abs" and source.is_sign(k + 2, ")"):
        if region := expression(source, k):
            yield region, [(source.tokens[k - 1].start, source.tokens[k + 2].end, "")], "abs left out"
    elif token.text == "powi" and source.tokens[k + 2].text == "2":
        if region := expression(source, k):
            exponent = source.tokens[k + 2]
            yield region, [(exponent.start, exponent.end, "3")], "powi(2) → powi(3)"


def expression(source, k):
    """The range of the whole expression around a token in the text."""
    return region_of(source, source.extent(k))


def whole_of_indexed(source, k):
    """The range of the expression around an index: that of the indexed number, not of the index."""
    return region_of(source, source.extent(k - 1))


def region_of(source, extent):
    if extent is None:
        return None
    first, last = extent
    return source.tokens[first].start, source.tokens[last - 1].end


def is_indexed(source, k):
    before, bracket = source.tokens[k - 1], source.tokens[k]
    return before.end == bracket.start and source.is_value_end(k - 1)
