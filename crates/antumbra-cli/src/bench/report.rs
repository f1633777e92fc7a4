//! What a table hands over, and how it is printed and written.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde_json::{Value, json};

use super::plot::Plot;
use super::section::{Row, Section};
use crate::output::{self, OutputFile};
use crate::{describe, machine};

/// A finished table.
pub struct Report {
    /// The table's name on the command line; its files bear it.
    pub table: &'static str,
    /// Heading of the Markdown.
    pub title: &'static str,
    /// For people.
    pub sections: Vec<Section>,
    /// For scripts.
    pub rows: Vec<Row>,
    /// What rows add up to, for scripts; may be empty.
    pub summary: Row,
    pub plots: Vec<Plot>,
    pub images: Vec<Image>,
    /// The graphics card that figures come from, where one was used.
    pub gpu: Option<String>,
}

/// A picture to be written beside the table.
pub struct Image {
    pub file_name: String,
    /// PNG.
    pub bytes: Vec<u8>,
}

/// Where a table goes.
#[derive(clap::Args)]
pub struct OutputArgs {
    /// Print JSON alone
    #[arg(long)]
    json: bool,
    /// Folder for the table as Markdown and JSON (TABLE.md, TABLE.json) and for the plots; made if it is not there
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl OutputArgs {
    /// Makes the folder, before any long work.
    pub fn prepare(&self) -> Result<()> {
        let Some(folder) = &self.out else { return Ok(()) };
        fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder {}; choose another with --out", folder.display()))
    }

    /// Writes the table's files, if there is a folder for them, and prints the table.
    pub fn publish(&self, report: &Report) -> Result<()> {
        let mut machine = machine::describe();
        if let Some(gpu) = &report.gpu {
            machine["gpu"] = gpu.as_str().into();
        }
        let (json, text) = (report.json(&machine), report.markdown(&machine));
        if let Some(folder) = &self.out {
            write(folder, &format!("{}.md", report.table), text.as_bytes())?;
            write(folder, &format!("{}.json", report.table), format!("{json:#}\n").as_bytes())?;
            report.plots.iter().try_for_each(|plot| write(folder, &plot.file_name, plot.svg.as_bytes()))?;
            report.images.iter().try_for_each(|image| write(folder, &image.file_name, &image.bytes))?;
        }
        if self.json { describe::print(&json) } else { output::print(&text) }
    }
}

impl Report {
    fn json(&self, machine: &Value) -> Value {
        let mut json = json!({ "table": self.table, "machine": machine, "rows": self.rows });
        if !self.summary.is_empty() {
            json["summary"] = self.summary.clone().into();
        }
        json
    }

    fn markdown(&self, machine: &Value) -> String {
        let model = machine["model"].as_str().unwrap_or("unknown");
        let mut text = format!("# {}\n\nMachine: {} cores, {model}.\n", self.title, machine["cores"]);
        for section in &self.sections {
            // Writing to a string cannot fail.
            let _ = write!(text, "\n{}", section.markdown());
        }
        text
    }
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> Result<()> {
    OutputFile::new(&folder.join(name))?.write(bytes)
}
