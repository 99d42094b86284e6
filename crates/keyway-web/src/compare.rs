//! Comparisons of planners on the map of a page, and of stacks by their runs.

use crate::error::{Kind, PageError};
use crate::map::Opened;
use crate::message::{Message, json};
use keyway::files::ParameterLayers;
use keyway_lab::batch::{
    AgainstFirst, Record, Row, RunTimes, StackSummary, against_first, against_first_table,
    summaries, summary_latex, summary_markdown, summary_table,
};
use keyway_lab::compare::{CompareReport, CompareRequest, QueriedError, QueryChoice, query_rows};
use keyway_lab::table::csv;
use serde::{Deserialize, Serialize};

/// `{"ask": "compare", ..}`: planners with smoothers on random queries, as in `keyway compare`. The
/// answer is a [`Comparison`].
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Compare {
    /// Names of planners.
    pub planners: Vec<String>,
    /// Names of smoothers.
    pub smoothers: Vec<String>,
    /// Radius of the robot \[m\].
    pub radius_m: f64,
    /// Number of queries.
    pub queries: usize,
    /// Seed of the queries.
    pub seed: u64,
}

/// Planners and smoothers on the same queries.
#[derive(Serialize)]
pub struct Comparison {
    /// `keyway.compare/1`, without times.
    pub report: CompareReport,
    /// Names of the columns of the table.
    pub header: Vec<&'static str>,
    /// Its rows.
    pub rows: Vec<Vec<String>>,
    /// The rows as CSV.
    pub csv: String,
    /// All answers as CSV.
    pub queries_csv: String,
    /// The table as LaTeX.
    pub latex: String,
}

/// `{"ask": "summary", "rows"}`: summarises the runs of several stacks, as in `keyway batch`. The
/// answer is a [`Summary`].
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Summarise {
    /// Rows of runs ([`Driven::row`](crate::drive::Driven::row)).
    pub rows: Vec<Row>,
}

/// The runs of several stacks.
#[derive(Serialize)]
pub struct Summary {
    /// A summary of each stack.
    pub stacks: Vec<StackSummary>,
    /// Each other stack against the first one.
    pub against_first: Vec<AgainstFirst>,
    /// The tables as in a terminal.
    pub text: String,
    /// The table of the stacks as Markdown.
    pub markdown: String,
    /// The same as LaTeX.
    pub latex: String,
    /// The runs as CSV.
    pub runs_csv: String,
    /// The summaries as CSV.
    pub csv: String,
}

/// Compares planners and smoothers.
pub(crate) fn compare(ask: &Compare, opened: &Opened) -> Result<Message, PageError> {
    let config = |error: &dyn std::fmt::Display, field: &str| {
        PageError::new(Kind::Config, error).field(field)
    };
    let request = CompareRequest {
        planners: ask.planners.clone(),
        smoothers: ask.smoothers.clone(),
        parameters: ParameterLayers::default(),
        radius_m: Some(ask.radius_m),
        queries: QueryChoice::Random { count: ask.queries, seed: ask.seed },
        has_times: false,
        ..CompareRequest::new(vec![opened.source.name.clone().into()])
    };
    let comparison = request.check().map_err(|error| config(&error, error.field()))?;
    let queried = comparison.queried(0, opened.grid.clone()).map_err(|error| {
        let field = if matches!(error, QueriedError::Queries(_)) { "queries" } else { "radius_m" };
        config(&error, field)
    })?;
    let compared = comparison.on(queried, &()).map_err(|error| config(&error, "planners"))?;
    let queries_csv = csv(&query_rows(&compared).collect::<Vec<_>>());
    let report = comparison.report(&[compared], None);
    let (header, rows, _) = comparison.columns().table(&report.rows);
    let (csv, latex) = (csv(&report.rows), comparison.columns().latex(&report.rows));
    Ok(Message::new(json(&Comparison { report, header, rows, csv, queries_csv, latex })))
}

/// Summarises runs.
pub(crate) fn summarise(ask: Summarise) -> Message {
    // A page has no clock.
    let measured = RunTimes { wall_s: 0.0, mean_cycle_us: None };
    let runs_csv = csv(&ask.rows);
    let record = |run| Record { run, robots: Vec::new(), measured };
    let records: Vec<Record> = ask.rows.into_iter().map(record).collect();
    let stacks = summaries(&records);
    let names: Vec<String> = stacks.iter().map(|stack| stack.stack.clone()).collect();
    let against_first = against_first(&records, &names);
    let tables = [Some(summary_table(&stacks)), against_first_table(&against_first)];
    let text = tables.into_iter().flatten().collect::<Vec<_>>().join("\n");
    Message::new(json(&Summary {
        text,
        markdown: summary_markdown(&stacks),
        latex: summary_latex(&stacks),
        runs_csv,
        csv: csv(&stacks),
        stacks,
        against_first,
    }))
}
