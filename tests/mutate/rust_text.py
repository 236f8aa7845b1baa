"""The computing parts of a Rust source text: tokens, bodies of functions, and extents of expressions."""
import re

TOKEN = re.compile(
    r"""
      (?P<space>\s+|//[^\n]*|/\*.*?\*/)
    | (?P<string>b?r(\#*)".*?"\3|b?"(?:\\.|[^"\\])*")
    | (?P<char>b?'(?:\\.[^']*|[^'\\])')
    | (?P<lifetime>'\w+)
    | (?P<float>\d[\d_]*\.\d[\d_]*(?:e[+-]?\d+)?(?:_?f64)?|\d[\d_]*e[+-]?\d+(?:_?f64)?|\d[\d_]*_f64)
    | (?P<integer>\d\w*)
    | (?P<name>[^\W\d]\w*)
    | (?P<sign>\.\.=|<<=|>>=|::|->|=>|&&|\|\||==|!=|<=|>=|\+=|-=|\*=|/=|%=|\.\.|<<|>>|.)
    """,
    re.X | re.S,
)
OPENING = {"(": ")", "[": "]", "{": "}"}
CLOSING = set(OPENING.values())
ASSIGNMENTS = {"=", "+=", "-=", "*=", "/=", "%="}
# What ends an expression on its left and on its right, outside of its own brackets.
LEFT_ENDS = ASSIGNMENTS | set("( [ { , ; => && || ! : | .. ..= @ ->".split()) | set(
    "return break if while match in else move let ref mut".split()
)
RIGHT_ENDS = ASSIGNMENTS | set(", ; ) ] } => && || | .. ..= else in".split())
KEYWORDS = {"return", "break", "if", "while", "match", "in", "else", "move", "let", "ref", "mut", "as", "where", "for", "loop", "fn"}
# A new statement begins with these after a closing brace; else the braces belong to the expression that follows them.
CONTINUES = {".", "?", "+", "-", "*", "/", "as", ")", "]", ",", ";", "}"}
# Macros whose contents compute. The others hold messages and patterns.
COMPUTING_MACROS = {"vec"}


class Token:
    """A token and its range in the text."""

    __slots__ = ("kind", "text", "start", "end")

    def __init__(self, kind, text, start):
        self.kind, self.text, self.start, self.end = kind, text, start, start + len(text)


class Source:
    """A source text with its tokens and brackets."""

    def __init__(self, text):
        self.text = text
        self.tokens = []
        for found in TOKEN.finditer(text):
            if found.lastgroup != "space" and not found.group("space"):
                kind = next(k for k in ("string", "char", "lifetime", "float", "integer", "name", "sign") if found.group(k) is not None)
                self.tokens.append(Token(kind, found.group(0), found.start()))
        self.partner = self._partners()
        self.bodies = self._bodies()
        self.excluded = self._excluded()

    def _partners(self):
        partner, open_ones = {}, []
        for k, token in enumerate(self.tokens):
            if token.kind != "sign":
                continue
            if token.text in OPENING:
                open_ones.append(k)
            elif token.text in CLOSING and open_ones:
                partner[k] = open_ones.pop()
                partner[partner[k]] = k
        return partner

    def is_sign(self, k, text):
        return 0 <= k < len(self.tokens) and self.tokens[k].kind == "sign" and self.tokens[k].text == text

    def _block_from(self, k):
        """The first braces after a token, or None where a semicolon comes before them."""
        while k < len(self.tokens) and not self.is_sign(k, ";"):
            if self.is_sign(k, "{"):
                return k, self.partner.get(k, k)
            k = self.partner.get(k, k) + 1 if self.tokens[k].text in ("(", "[") and self.tokens[k].kind == "sign" else k + 1
        return None

    def _bodies(self):
        """The bodies of functions that are not constant."""
        bodies = []
        for k, token in enumerate(self.tokens):
            if token.text == "fn" and k + 1 < len(self.tokens) and self.tokens[k + 1].kind == "name":
                if k and self.tokens[k - 1].text == "const":
                    continue
                if body := self._block_from(k):
                    bodies.append(body)
        return bodies

    def _excluded(self):
        """Tests, attributes, macros, constants."""
        out = []
        for k, token in enumerate(self.tokens):
            if self.is_sign(k, "#") and (self.is_sign(k + 1, "[") or self.is_sign(k + 2, "[")):
                begin = k + 1 if self.is_sign(k + 1, "[") else k + 2
                end = self.partner.get(begin, begin)
                out.append((k, end))
                inside = "".join(t.text for t in self.tokens[begin : end + 1])
                if inside in ("[cfg(test)]", "[test]") and (block := self._block_from(end + 1)):
                    out.append(block)
            elif token.kind == "name" and self.is_sign(k + 1, "!") and k + 2 in self.partner and token.text not in COMPUTING_MACROS:
                out.append((k, self.partner[k + 2]))
            elif token.text in ("const", "static") and self.tokens[k + 1].kind == "name" and self.tokens[k + 1].text != "fn":
                end = k
                while end < len(self.tokens) and not self.is_sign(end, ";"):
                    end = self.partner.get(end, end) + 1 if self.tokens[end].text in OPENING else end + 1
                out.append((k, end))
        return out

    def computing(self):
        """The indices of all tokens in bodies of functions, except in tests, macros and constants."""
        inside = set()
        for begin, end in self.bodies:
            inside.update(range(begin + 1, end))
        for begin, end in self.excluded:
            inside.difference_update(range(begin, end + 1))
        return sorted(inside)

    def is_value_end(self, k):
        """Whether a value may end with this token, so that an operator after it has two operands."""
        token = self.tokens[k]
        if token.kind == "sign":
            return token.text in (")", "]", "?")
        return token.kind in ("float", "integer") or token.kind == "name" and token.text not in KEYWORDS

    def is_spaced(self, k):
        """Whether there are blanks on both sides, as around operators of two operands."""
        before, token, after = self.tokens[k - 1 : k + 2]
        return before.end < token.start and token.end < after.start

    def extent(self, k):
        """From which token to which the whole expression around a token reaches, with its assignment if the token is on its left.
        None where that cannot be said."""
        left = k
        while True:
            if left == 0:
                return None
            token = self.tokens[left - 1]
            if token.kind == "sign" and token.text in CLOSING:
                after = self.tokens[left].text
                if token.text == "}" and after not in CONTINUES:
                    break
                if token.text == "}" and "\n" in self.text[token.end : self.tokens[left].start] and after in ("*", "-"):
                    break
                left = self.partner.get(left - 1, 0)
                continue
            if token.text in LEFT_ENDS and token.kind in ("sign", "name"):
                break
            left -= 1
        before = self.tokens[left - 1].text
        if before in ("let", "ref", "mut", "->", "@"):
            return None
        right = self._right_end(k, before in ("if", "while", "match", "in", "&&", "||"))
        if right is None or self.tokens[right].text not in ASSIGNMENTS:
            return right and (left, right)
        right = self._right_end(right + 1, False)
        return right and (left, right)

    def _right_end(self, k, is_condition):
        while k < len(self.tokens):
            token = self.tokens[k]
            if token.text in ("if", "match", "loop", "for", "while") and token.kind == "name":
                return None
            if token.kind == "sign" and token.text in OPENING:
                named = self.tokens[k - 1].kind == "name" and self.tokens[k - 1].text[0].isupper()
                if token.text == "{" and (is_condition or not named):
                    return k
                if k not in self.partner:
                    return None
                k = self.partner[k] + 1
                continue
            if token.text in RIGHT_ENDS and token.kind in ("sign", "name"):
                return k
            k += 1
        return None
