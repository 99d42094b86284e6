//! Claims and figures in words, for tables, pages and papers.

use crate::args::ReproduceArgs;
use keyway_lab::claims::{ClaimReport, FamilyFigure, Measure, PublishedFigure, Scale};
use keyway_sim::report::Inputs;

/// The version and the command that make a picture again; `what` is what is to be measured.
pub(super) fn made(args: &ReproduceArgs, what: &str) -> String {
    let ReproduceArgs { maps, seed, no_times, .. } = args;
    let times = if *no_times { " --no-times" } else { "" };
    let version = Inputs::VERSION;
    format!(
        "Keyway {version}: keyway reproduce {what} --maps {maps} --seed {seed}{times} --out DIR."
    )
}

/// What was published of a figure.
pub(super) fn published_of<'a>(
    claim: &'a ClaimReport,
    figure: &FamilyFigure,
) -> Option<&'a PublishedFigure> {
    let mut all = claim.published.iter().flat_map(|published| &published.figures);
    all.find(|it| (it.measure, it.of, it.than) == (figure.measure, figure.of, figure.than))
}

/// The published change; a dash where nothing comparable was published.
pub(super) fn published(claim: &ClaimReport, figure: &FamilyFigure) -> String {
    let effect = published_of(claim, figure).and_then(|published| published.effect);
    effect.map_or_else(|| "-".to_owned(), |effect| change(figure, effect))
}

/// Such as `expanded of bidirectional-astar, lower than astar`.
pub(super) fn words(figure: &FamilyFigure) -> String {
    words_of(figure, &str::to_owned)
}

/// The same with names of methods in a form of their own.
pub(super) fn words_of(figure: &FamilyFigure, of_method: &dyn Fn(&str) -> String) -> String {
    let (name, of) = (name(figure.measure), of_method(figure.of));
    let expected = figure.expected.replace('_', " ");
    let limit = figure.limit.map(|limit| (limit * 1e6).round() / 1e6);
    let tail = match (figure.than.map(of_method), limit) {
        (Some(than), Some(limit)) if figure.expected == "same" => {
            format!("within {} % of {than}", limit * 100.0)
        }
        (Some(than), Some(limit)) => format!("at most {} % above {than}", limit * 100.0),
        (Some(than), None) => format!("{expected} than {than}"),
        (None, Some(limit)) => format!("{expected} {limit} {}", figure.unit),
        (None, None) => expected,
    };
    format!("{name} of {of}, {}", tail.trim_end())
}

/// The name of a measure as in JSON, in words.
pub(super) fn name(measure: Measure) -> String {
    // A name is plain data: this cannot fail.
    let value = serde_json::to_value(measure).unwrap_or_default();
    value.as_str().unwrap_or_default().replace('_', " ")
}

/// The mean change and its interval; of a bound, on how many maps it is kept.
pub(super) fn measured(figure: &FamilyFigure) -> String {
    let (Some(mean), Some(low), Some(high)) = (figure.mean, figure.ci95_low, figure.ci95_high)
    else {
        return "-".to_owned();
    };
    if figure.than.is_none() {
        let kept = (mean * figure.pairs as f64).round();
        return format!("on {kept} of {} maps", figure.pairs);
    }
    format!("{} ({} to {})", change(figure, mean), number(figure, low), number(figure, high))
}

/// With its unit.
pub(super) fn change(figure: &FamilyFigure, effect: f64) -> String {
    let unit = if figure.scale == Scale::Relative { "%" } else { figure.unit };
    format!("{} {unit}", number(figure, effect)).trim_end().to_owned()
}

fn number(figure: &FamilyFigure, effect: f64) -> String {
    match figure.scale {
        Scale::Relative => format!("{:+.2}", effect * 100.0),
        Scale::Absolute => format!("{effect:+.3}"),
    }
}
