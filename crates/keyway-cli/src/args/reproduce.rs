//! Arguments of `keyway reproduce`.

use super::groups::Format;
use super::values::whole;
use clap::Args;
use std::path::PathBuf;

const REPRODUCE_TERMS: &str = "\
A figure is a value that a claim is about, such as the length of a path. It holds if the 95 % interval of its mean change over
the maps lies on the side that the paper states, and the mean is at least half of the published change, if there is one. It
does not hold if the interval lies on the other side, or below that half. Otherwise it is undecided. A property claimed to
hold always must hold on significantly more than nine maps in ten. Times are reported, but not judged. A claim holds if all of
its judged figures hold, and does not hold if none holds and some do not; otherwise it is mixed. Only maps count on which all
methods of a comparison find a path. A claim that does not hold is a result, not an error: the exit code is 0.";

const REPRODUCE_EXAMPLES: &str = "\
Examples:
  keyway reproduce S0-1 --maps 10 --out reproduced
  keyway reproduce S2-2 --ablations --maps 5 --out parts
  keyway reproduce s2 S4-6 --maps 10 --seed 1000 --no-times --out weights --format json";

#[derive(Debug, Args)]
#[command(after_help = format!("{REPRODUCE_TERMS}\n\n{REPRODUCE_EXAMPLES}"))]
pub(crate) struct ReproduceArgs {
    /// Claims, such as S0-1; or s0, s1, s2 or s4 for all claims of a paper; or `all`
    #[arg(value_name = "CLAIM", default_value = "all")]
    pub(crate) claims: Vec<String>,
    /// Number of maps for each claim
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "N", default_value_t = 100, value_parser = whole::<usize, 2, 100_000>)]
    pub(crate) maps: usize,
    /// Seed of the first map; the others have the following seeds
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "N", default_value_t = 1, value_parser = whole::<u64, 0, { u64::MAX }>)]
    pub(crate) seed: u64,
    /// Number of maps processed in parallel [default: one per processor]
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "N", value_parser = whole::<usize, 1, { u64::MAX }>)]
    pub(crate) jobs: Option<usize>,
    /// Also run ablations of the methods and sweeps of their parameters
    #[arg(long)]
    pub(crate) ablations: bool,
    /// Omit all times, also the figures of claims that are times; the output is then deterministic
    #[arg(long)]
    pub(crate) no_times: bool,
    /// Folder for the report (JSON, HTML, tables, pictures) and the measurements on each map; an
    /// interrupted reproduction is resumed
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}
