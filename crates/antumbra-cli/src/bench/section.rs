//! Rows of numbers, as JSON and as Markdown.

use std::fmt::Write;

use serde_json::{Map, Value};

use crate::table::{bytes, count};

/// Keys and values of a row, in order.
pub type Row = Map<String, Value>;

/// How a column's values are shown.
#[derive(Clone, Copy, Debug)]
pub enum Shown {
    /// As it is.
    Plain,
    /// A whole number.
    Count,
    /// A number of bytes.
    Bytes,
    /// With two digits behind the point.
    Decimal,
    /// A share, in percent.
    Percent,
    /// Metres, with four digits that count.
    Metres,
    /// A time, in milliseconds below a second.
    Seconds,
    /// A number of bytes in millions, as the papers give them.
    Megabytes,
}

/// A column: its key in a row, its heading in Markdown.
pub type Column<'a> = (&'a str, &'a str, Shown);

/// One table.
pub struct Section {
    pub title: &'static str,
    /// What is compared, how, and what the papers say.
    pub about: String,
    columns: Vec<(String, String, Shown)>,
    pub rows: Vec<Row>,
}

/// A row from a JSON object.
pub fn row(object: Value) -> Row {
    match object {
        Value::Object(row) => row,
        other => Map::from_iter([("value".to_owned(), other)]),
    }
}

impl Section {
    pub fn new(title: &'static str, about: impl Into<String>, columns: &[Column<'_>]) -> Self {
        let owned = |(key, heading, shown): &Column<'_>| ((*key).to_owned(), (*heading).to_owned(), *shown);
        Self { title, about: about.into(), columns: columns.iter().map(owned).collect(), rows: Vec::new() }
    }

    /// Heading, text and table.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut text = format!("## {}\n\n{}\n\n|", self.title, self.about);
        for (_, heading, _) in &self.columns {
            // Writing to a string cannot fail.
            let _ = write!(text, " {heading} |");
        }
        text += "\n|";
        for (_, _, shown) in &self.columns {
            text += if matches!(shown, Shown::Plain) { "---|" } else { "---:|" };
        }
        text += "\n";
        for row in &self.rows {
            text += "|";
            for (key, _, shown) in &self.columns {
                let _ = write!(text, " {} |", shown.text(row.get(key).unwrap_or(&Value::Null)));
            }
            text += "\n";
        }
        text
    }
}

impl Shown {
    /// A value as text; words stay as they are.
    #[must_use]
    pub fn text(self, value: &Value) -> String {
        let number = value.as_f64();
        match (self, value.as_u64(), number) {
            (_, _, None) => value.as_str().unwrap_or("").replace('|', "\\|"),
            (Self::Plain, ..) => value.to_string(),
            (Self::Count, Some(n), _) => count(n),
            (Self::Bytes, Some(n), _) => bytes(n),
            (Self::Percent, _, Some(share)) => format!("{:.2} %", 100.0 * share),
            (Self::Metres, _, Some(metres)) => metres_text(metres),
            (Self::Seconds, _, Some(seconds)) => seconds_text(seconds),
            (Self::Megabytes, _, Some(bytes)) => format!("{:.2} MB", 1e-6 * bytes),
            (_, _, Some(number)) => format!("{number:.2}"),
        }
    }
}

/// Four digits that count.
fn metres_text(metres: f64) -> String {
    let digits_before = if metres > 0.0 { metres.log10().floor() as i32 + 1 } else { 1 };
    format!("{metres:.*}", (4 - digits_before).clamp(0, 12) as usize)
}

/// Three digits that count, of times up to 1000 s.
fn seconds_text(seconds: f64) -> String {
    match seconds {
        ..0.01 => format!("{:.2} ms", 1e3 * seconds),
        ..0.1 => format!("{:.1} ms", 1e3 * seconds),
        ..1.0 => format!("{:.0} ms", 1e3 * seconds),
        ..10.0 => format!("{seconds:.2} s"),
        ..100.0 => format!("{seconds:.1} s"),
        _ => format!("{seconds:.0} s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn tables_are_markdown() {
        let columns: &[Column<'_>] = &[
            ("scene", "scene", Shown::Plain),
            ("n", "N", Shown::Count),
            ("size", "size", Shown::Bytes),
            ("share", "share", Shown::Percent),
            ("height_m", "m", Shown::Metres),
        ];
        let mut section = Section::new("Title", "About.", columns);
        section.rows = vec![
            row(json!({"scene": "a|b", "n": 4096, "size": 2048, "share": 0.125, "height_m": 0.012_345_6})),
            row(json!({"scene": "c", "n": 64, "size": null, "share": 0, "height_m": 123.456})),
        ];
        let expected = "## Title\n\nAbout.\n\n| scene | N | size | share | m |\n|---|---:|---:|---:|---:|\n\
                        | a\\|b | 4,096 | 2.00 KiB | 12.50 % | 0.01235 |\n| c | 64 |  | 0.00 % | 123.5 |\n";
        assert_eq!(section.markdown(), expected);
    }

    #[test]
    fn times_and_sizes_have_their_units() {
        let shown = |seconds: f64| Shown::Seconds.text(&seconds.into());
        assert_eq!([0.0012, 0.025, 0.434, 1.7, 24.12].map(shown), ["1.20 ms", "25.0 ms", "434 ms", "1.70 s", "24.1 s"]);
        assert_eq!(shown(1398.8), "1399 s");
        assert_eq!(Shown::Megabytes.text(&1_234_567.into()), "1.23 MB");
        assert_eq!(Shown::Seconds.text(&"out of memory".into()), "out of memory");
    }
}
