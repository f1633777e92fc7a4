//! The program `antumbra`: bakes, inspects, queries, compares and draws precomputed shadows.
//!
//! Thin: each command is one file in [`commands`] that reads its arguments, calls the libraries and prints. Exit codes:
//! 0 done, 2 bad usage, 1 anything else, with one sentence on stderr.

mod area;
mod args;
mod bench;
mod camera;
mod commands;
mod compare;
mod describe;
mod inputs;
mod lamp_maps;
mod lights;
mod machine;
mod memory;
mod npy;
mod output;
mod processor;
mod progress;
mod table;

use std::process::ExitCode;

use clap::Parser;

use commands::Command;

/// Exact, compact, precomputed shadows.
///
/// Start with `antumbra demo`: it needs no input.
#[derive(Parser)]
#[command(version, arg_required_else_help = true, max_term_width = 110)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    match Cli::parse().command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            output::complain(&format!("error: {error:#}"));
            ExitCode::from(1)
        }
    }
}
