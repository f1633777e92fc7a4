//! Text for people: aligned tables, and numbers with their units.

use std::fmt::Write;

/// Rows of two columns: what, and how much.
#[derive(Default)]
pub struct Table {
    rows: Vec<(String, String)>,
}

impl Table {
    /// Adds a row.
    pub fn row(&mut self, what: impl Into<String>, how_much: impl Into<String>) -> &mut Self {
        self.rows.push((what.into(), how_much.into()));
        self
    }

    /// The rows with their second column aligned, under a heading.
    #[must_use]
    pub fn text(&self, heading: &str) -> String {
        let width = self.rows.iter().map(|(what, _)| what.chars().count()).max().unwrap_or(0);
        let mut text = format!("{heading}\n");
        for (what, how_much) in &self.rows {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "  {what:width$}  {how_much}");
        }
        text
    }
}

/// A whole number with its thousands set apart.
#[must_use]
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Bytes in the largest unit that fits, beside the exact number.
#[must_use]
pub fn bytes(n: u64) -> String {
    let units = [(1 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB")];
    match units.iter().find(|(size, _)| n >= *size) {
        Some((size, unit)) => format!("{:.2} {unit}", n as f64 / *size as f64),
        None => format!("{n} bytes"),
    }
}

/// A share in percent, with as many digits as it takes to tell it from none and from all.
#[must_use]
pub fn percent(part: u64, whole: u64) -> String {
    let share = 100.0 * part as f64 / whole.max(1) as f64;
    let settled = part == 0 || part == whole || (0.1..=99.9).contains(&share);
    if settled { format!("{share:.1} %") } else { format!("{share:.4} %") }
}

/// A name from a file, safe to print on a terminal.
#[must_use]
pub fn printable(name: &str) -> String {
    name.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers() {
        assert_eq!([0, 999, 1000, 1_234_567].map(count), ["0", "999", "1,000", "1,234,567"]);
        assert_eq!([0, 1023, 1024, 3 << 29].map(bytes), ["0 bytes", "1023 bytes", "1.00 KiB", "1.50 GiB"]);
        assert_eq!([percent(0, 0), percent(1, 2), percent(999_999, 1_000_000)], ["0.0 %", "50.0 %", "99.9999 %"]);
    }

    #[test]
    fn tables_align() {
        let text = Table::default().row("a", "1").row("long", "2").text("Heading");
        assert_eq!(text, "Heading\n  a     1\n  long  2\n");
        assert_eq!(printable("sun\u{1b}[31m\n"), "sun\u{fffd}[31m\u{fffd}");
    }
}
