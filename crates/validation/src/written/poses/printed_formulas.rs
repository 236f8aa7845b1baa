//! The formulas in LaTeX that `symbolic` writes, computed line by line as a reader of the page would.

use super::difference::Differences;
use super::generated_code::{Quantities, code_differences_of};
use super::rows::Rows;
use std::collections::HashMap;

/// The names of m, ½m′, a and b on the page.
const NAMES: [&str; 4] = ["m", "\\tfrac{1}{2} m'", "a", "b"];

/// The formulas of a page.
struct Page<'p> {
    coordinate: &'p str,
    constants: Vec<(&'p str, f64)>,
    /// Name and term of each line.
    lines: Vec<(String, String)>,
}

impl<'p> Page<'p> {
    /// Reads a page; `None` if its coordinate is not named.
    fn read(page: &'p str) -> Option<Self> {
        let (_, rest) = page.split_once("The coordinate is $")?;
        let (coordinate, _) = rest.split_once('$')?;
        let constant = |line: &'p str| {
            let mut cells = line.strip_prefix("| $")?.split(" | ");
            let name = cells.next()?.strip_suffix('$')?;
            Some((name, cells.next()?.trim().parse().ok()?))
        };
        let joined = page.replace(" \\\\\n&\\quad", " ");
        let line = |line: &str| {
            let (name, term) = line.split_once(" &= ")?;
            let term = term.strip_suffix(" \\\\").unwrap_or(term);
            Some((name.to_owned(), term.to_owned()))
        };
        Some(Self {
            coordinate,
            constants: page.lines().filter_map(constant).collect(),
            lines: joined.lines().filter_map(line).collect(),
        })
    }

    /// m, ½m′, a and b at a coordinate; `None` for quantities that the page does not define.
    fn at(&self, q: f64) -> [Option<f64>; 4] {
        let mut values: HashMap<&str, f64> = self.constants.iter().copied().collect();
        values.insert(self.coordinate, q);
        for (name, term) in &self.lines {
            let mut formula = Formula {
                rest: term,
                values: &values,
            };
            let value = formula.sum().filter(|_| formula.rest.is_empty());
            if let Some(value) = value {
                values.insert(name, value);
            }
        }
        NAMES.map(|name| values.get(name).copied())
    }
}

/// m, ½m′, and a and b of a reaction by the printed formulas at every row of `reduce`.
pub(crate) fn formula_differences(
    page: &str,
    rows: &Rows,
    coordinate: &str,
    reaction: &str,
) -> Differences {
    let page = Page::read(page);
    let at = |q: f64| -> Quantities { page.as_ref().map_or([None; 4], |page| page.at(q)) };
    code_differences_of("formulas", &at, rows, coordinate, reaction)
}

/// The rest of a term, and the values of all names so far.
struct Formula<'f> {
    rest: &'f str,
    values: &'f HashMap<&'f str, f64>,
}

impl Formula<'_> {
    /// Takes a text, and the blanks after it, if the rest begins with it.
    fn takes(&mut self, text: &str) -> bool {
        let rest = self.rest.strip_prefix(text);
        self.rest = rest.map_or(self.rest, str::trim_start);
        rest.is_some()
    }

    fn sum(&mut self) -> Option<f64> {
        let mut sum = match self.takes("-") {
            true => -self.product()?,
            false => self.product()?,
        };
        loop {
            if self.takes("+") {
                sum += self.product()?;
            } else if self.takes("-") {
                sum -= self.product()?;
            } else {
                return Some(sum);
            }
        }
    }

    fn product(&mut self) -> Option<f64> {
        let mut product = self.factor()?;
        while self.takes("\\,") {
            product *= self.factor()?;
        }
        Some(product)
    }

    /// Reads a sum that `end` follows.
    fn sum_before(&mut self, end: &str) -> Option<f64> {
        let sum = self.sum()?;
        self.takes(end).then_some(sum)
    }

    fn factor(&mut self) -> Option<f64> {
        let base = self.base()?;
        match self.takes("^{") {
            true => self.sum_before("}").map(|exponent| base.powf(exponent)),
            false => Some(base),
        }
    }

    /// Reads an operand without its power.
    fn base(&mut self) -> Option<f64> {
        for (name, function) in [("\\sin", f64::sin as fn(f64) -> f64), ("\\cos", f64::cos)] {
            if self.takes(&format!("{name}^2 ")) {
                return Some(function(self.base()?).powi(2));
            }
            if self.takes(&format!("{name} ")) {
                return self.base().map(function);
            }
        }
        if self.takes("\\frac{") {
            let above = self.sum_before("}{")?;
            return self.sum_before("}").map(|below| above / below);
        }
        if self.takes("\\sqrt{") {
            return self.sum_before("}").map(f64::sqrt);
        }
        if self.takes("\\operatorname{atan2}\\left(") {
            let y = self.sum_before(",")?;
            return self.sum_before("\\right)").map(|x| y.atan2(x));
        }
        if self.takes("\\left(") {
            return self.sum_before("\\right)");
        }
        if self.takes("{") {
            return self.sum_before("}");
        }
        self.number().or_else(|| self.name())
    }

    fn number(&mut self) -> Option<f64> {
        let part = |c: char| c.is_ascii_digit() || c == '.';
        let end = self.rest.find(|c| !part(c)).unwrap_or(self.rest.len());
        let value = self.rest[..end].parse().ok()?;
        self.rest = self.rest[end..].trim_start();
        Some(value)
    }

    /// The longest name that the rest begins with.
    fn name(&mut self) -> Option<f64> {
        let begins = self
            .values
            .keys()
            .filter(|name| self.rest.starts_with(**name));
        let name = *begins.max_by_key(|name| name.len())?;
        self.takes(name);
        self.values.get(name).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "The coordinate is $\\varphi$ (phi), in rad.\n\
        | $l_{1}$ | 0.5 | m | crank: from A to B |\n\
        ```math\n\\begin{aligned}\n\
        x'_{B} &= -l_{1} \\, \\sin \\varphi \\\\\n\
        m &= {x'_{B}}^{2} + \\frac{l_{1}^{2}}{2 \\, l_{1}} \\, \\cos^2 \\varphi \\\\\n\
        &\\quad - \\operatorname{atan2}\\left(x'_{B}, l_{1}\\right) \\, \\left(\\sqrt{l_{1}} - 1\\right)\n\
        \\end{aligned}\n```\n";

    #[test]
    fn a_page_is_computed_line_by_line() {
        let page = Page::read(PAGE).expect("a page");
        let (q, l) = (0.3_f64, 0.5_f64);
        let x = -l * q.sin();
        let m = x * x + 0.5 * l * q.cos().powi(2) - x.atan2(l) * (l.sqrt() - 1.0);
        let [found, rest @ ..] = page.at(q);
        assert!((found.expect("m") - m).abs() < 1e-15);
        assert_eq!(rest, [None; 3]);
    }

    /// A name that no line defines, and a bracket without another, leave a quantity without a value.
    #[test]
    fn what_is_not_defined_has_no_value() {
        for (from, to) in [("l_{1} \\, \\sin", "l_{2} \\, \\sin"), ("\\right)", "")] {
            let changed = PAGE.replace(from, to);
            let page = Page::read(&changed).expect("a page");
            assert_eq!(page.at(0.3), [None; 4]);
        }
    }
}
