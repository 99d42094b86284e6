//! Claims of the papers, measured on the maps of a page.

use crate::error::{Kind, PageError};
use crate::map::{MapFacts, Opened, cells_of, facts};
use crate::message::{Message, json};
use crate::route::points;
use keyway::geometry::{Disc, Point};
use keyway::map::formats::digest;
use keyway_lab::claims::{
    Claim, ClaimReport, Experiment, Family, FamilyFigure, FigureVerdict, MapRow, Place, Shown,
};
use keyway_lab::reproduce::{measured_text, published_text, statement};
use keyway_sim::episode::EpisodeError;
use keyway_sim::report::MapSource;
use keyway_sim::sim::Outcome;
use serde::{Deserialize, Serialize};

/// `{"ask": "open_claim", "id", "seed"}`: opens a map of a claim's experiment, and returns the
/// results of all methods on it. The answer is a [`ClaimMap`].
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OpenClaim {
    /// Name such as `S0-1`.
    pub id: String,
    /// Seed of the map; `null` for the reconstruction of the paper's map.
    pub seed: Option<u64>,
}

/// `{"ask": "measure_claim", "id", "seed"}`: the results of all methods on one map, a [`MapRow`].
/// It has the fields of [`OpenClaim`], and does not change the open map.
pub type MeasureClaim = OpenClaim;

/// `{"ask": "judge_claim", "id", "rows", "scene"}`: the verdict on a claim. The answer is a
/// [`Judged`].
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JudgeClaim {
    /// Name such as `S0-1`.
    pub id: String,
    /// Results on maps, in the order of their seeds.
    pub rows: Vec<MapRow>,
    /// Results on the scene.
    pub scene: Option<MapRow>,
}

/// A claim. The answer to `{"ask": "claims"}` is a list of them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ClaimFacts {
    /// Name such as `S0-1`.
    pub id: &'static str,
    /// Key of the paper.
    pub paper: &'static str,
    /// The claim in a sentence.
    pub statement: &'static str,
    /// The maps of its experiment in a sentence.
    pub about: &'static str,
    /// Names of the compared methods.
    pub methods: Vec<&'static str>,
    /// True if the paper's map was reconstructed.
    pub has_scene: bool,
}

/// A map of a claim. The part `cells` is as for a map; `line i` is the path or trajectory of
/// method `i`, points of two 64-bit numbers \[m\]. It is missing if the method failed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClaimMap {
    /// The map.
    pub map: MapFacts,
    /// Start and goal \[m\].
    pub ends: [Point; 2],
    /// Length of the line of each method \[m\]; `null` if it failed.
    pub lengths_m: Vec<Option<f64>>,
    /// True for each drive that did not reach its goal: its line ends early.
    pub is_cut_off: Vec<bool>,
    /// Discs that are not on the map, `[x, y, radius]` \[m\].
    pub discs: Vec<[f64; 3]>,
    /// Moving obstacles at the start, `[x, y, radius]` \[m\].
    pub movers: Vec<[f64; 3]>,
}

/// A claim and its verdict.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judged {
    /// The report of the claim, as in `keyway.reproduce`.
    pub report: ClaimReport,
    /// Its figures, as text.
    pub figures: Vec<JudgedFigure>,
}

/// A figure of a claim, as text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct JudgedFigure {
    /// Statement of the figure.
    pub statement: String,
    /// The published value; a dash if nothing comparable was published.
    pub published: String,
    /// The measured value.
    pub measured: String,
    /// The verdict; `null` if the figure is not judged.
    pub verdict: Option<FigureVerdict>,
}

/// All claims.
pub(crate) fn claims() -> Message {
    let facts = |claim: &Claim| ClaimFacts {
        id: claim.id,
        paper: claim.paper,
        statement: claim.statement,
        about: claim.experiment.about,
        methods: claim.experiment.methods.iter().map(|method| method.name).collect(),
        has_scene: claim.experiment.scene.is_some(),
    };
    Message::new(json(&Claim::all().map(facts).collect::<Vec<_>>()))
}

/// Opens a map of a claim.
pub(crate) fn open_claim(ask: &OpenClaim) -> Result<(Opened, Message), PageError> {
    let claim = claim(&ask.id)?;
    let place = claim.experiment.place(ask.seed).map_err(|error| failed(&error))?;
    let Place { map, ends, shown } = place.ok_or_else(|| no_scene(&ask.id))?;
    let lines = || shown.iter().map(|shown| shown.as_ref().map(|shown| &shown.line));
    let source = MapSource {
        name: ask.seed.map_or_else(
            || format!("scene of {}", claim.id),
            |seed| format!("map {seed} of {}", claim.experiment.name),
        ),
        digest: digest(&map),
        placement: None,
    };
    let opened = Opened { grid: map, source };
    let is_cut_off = |shown: &Option<Shown>| {
        let run = shown.as_ref().and_then(|shown| shown.run.as_ref());
        run.is_some_and(|run| run.outcome != Outcome::Reached)
    };
    let disc = |disc: Disc| [disc.centre.x, disc.centre.y, disc.radius_m];
    // Of several drives, the last one has the most obstacles.
    let last = || shown.iter().rev().flatten().find(|shown| shown.run.is_some()).into_iter();
    let head = ClaimMap {
        map: facts(&opened, Vec::new()),
        ends,
        is_cut_off: shown.iter().map(is_cut_off).collect(),
        discs: last().flat_map(|shown| &shown.obstacles).map(|it| disc(*it)).collect(),
        movers: last().flat_map(|shown| &shown.movers).map(|it| disc(it.at(0.0))).collect(),
        lengths_m: lines().map(|line| line.map(keyway::geometry::Polyline::length_m)).collect(),
    };
    let mut message = Message::new(json(&head)).with("cells", cells_of(&opened));
    for (i, line) in lines().enumerate() {
        if let Some(line) = line {
            message = message.with(&format!("line {i}"), points(line.points()));
        }
    }
    Ok((opened, message))
}

/// Measures a claim on one map.
pub(crate) fn measure_claim(ask: &MeasureClaim) -> Result<Message, PageError> {
    let experiment: &Experiment = claim(&ask.id)?.experiment;
    let row = match ask.seed {
        Some(seed) => experiment.on_seed(seed, None).map(Some),
        None => experiment.on_scene(None),
    };
    let row = row.map_err(|error| failed(&error))?;
    Ok(Message::new(json(&row.ok_or_else(|| no_scene(&ask.id))?)))
}

/// Judges a claim by its measurements.
pub(crate) fn judge_claim(ask: JudgeClaim) -> Result<Message, PageError> {
    let claim = claim(&ask.id)?;
    let (mut family, wanted) = (Family { scene: ask.scene, ..Family::default() }, ask.rows.len());
    for row in ask.rows {
        if row.outcomes.len() != claim.experiment.methods.len() {
            let message = "a row has not one outcome for each method";
            return Err(PageError::new(Kind::Usage, message).field("rows"));
        }
        family.take(claim.experiment, row, wanted);
    }
    let report = ClaimReport::new(claim, &family, false);
    let figure = |figure: &FamilyFigure| JudgedFigure {
        statement: statement(figure),
        published: published_text(&report, figure),
        measured: measured_text(figure),
        verdict: figure.verdict,
    };
    let figures = report.family.figures.iter().map(figure).collect();
    Ok(Message::new(json(&Judged { report, figures })))
}

fn claim(id: &str) -> Result<&'static Claim, PageError> {
    Claim::all().find(|claim| claim.id == id).ok_or_else(|| {
        let ids: Vec<&str> = Claim::all().map(|claim| claim.id).collect();
        let message = format!("there is no claim `{id}`, expected one of {}", ids.join(", "));
        PageError::new(Kind::Usage, message).field("id")
    })
}

fn no_scene(id: &str) -> PageError {
    let message = format!("the paper's map of {id} was not reconstructed: expected a seed");
    PageError::new(Kind::Usage, message).field("seed")
}

fn failed(error: &EpisodeError) -> PageError {
    PageError::new(Kind::Config, error).field("id")
}
