//! Tables: for display, for papers and for programs.

mod csv;
mod latex;
mod text;

pub use csv::csv;
pub use latex::{comment, latex_table};
pub use text::{facts, number, paragraph, percent, quantity, range, rows, with_range};
