//! Runs the program as a user does: every command on a small city, exit codes, JSON keys, bad usage, damaged files.

mod ablations;
mod baking;
mod benching;
mod comparing;
mod folder;
mod pictures;
mod querying;
mod stage;
mod usage;
mod viewing;
