//! Pictures checked against what geometry says they must show.

mod area;
mod common;
mod day;
mod masks;
mod night;
