//! Reports of claims and experiments: plain data.

use super::claim::{Bound, Claim, Direction, Expected, Figure, Rule};
use super::experiment::{Experiment, MapRow};
use super::family::Family;
use super::findings::{Finding, change_on, mean, value};
use super::measure::{Measure, Scale};
use super::verdict::{Evidence, FigureCounts, FigureVerdict, Verdict};
use keyway_sim::metrics::statistics::Confidence;
use serde::Serialize;

/// A claim with its published figures, its measured figures, and the verdict.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClaimReport {
    /// Name such as `S0-1`.
    pub id: &'static str,
    /// Key of the paper in docs/papers.md.
    pub paper: &'static str,
    /// The claim in a sentence.
    pub statement: &'static str,
    /// File that defines the claim ([`Claim::source`]).
    pub source: &'static str,
    /// Rule of judgement: by published figures or by the sign alone.
    pub rule: Rule,
    /// Published figures; `None` if nothing comparable was published.
    pub published: Option<PublishedReport>,
    /// Results on the scene; `None` if the claim has none.
    pub scene: Option<SceneReport>,
    /// Results on reconstructed maps; `None` if too little of the paper's map is published.
    pub reconstructed: Option<ReconstructedReport>,
    /// Reason why there is no reconstruction; `None` if there is one.
    pub not_reconstructed: Option<&'static str>,
    /// Results over the family of maps, which decide the verdict.
    pub family: FamilyReport,
    /// Numbers of its figures with each verdict.
    pub figures: FigureCounts,
    /// Verdict that follows from them.
    pub verdict: Verdict,
}

/// Published figures of a claim.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PublishedReport {
    /// Figures with published values.
    pub figures: Vec<PublishedFigure>,
}

/// Published values of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PublishedFigure {
    /// Measure.
    pub measure: Measure,
    /// Method.
    pub of: &'static str,
    /// Other method of the comparison.
    pub than: Option<&'static str>,
    /// Value of the other method.
    pub old: f64,
    /// Value of this method.
    pub new: f64,
    /// Change, on the `scale` of the family's figure.
    pub effect: Option<f64>,
}

/// Results on the reconstructed scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneReport {
    /// The scene file.
    pub file: &'static str,
    /// All figures.
    pub figures: Vec<SceneFigure>,
}

/// Result for a figure on one map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SceneFigure {
    /// Measure.
    pub measure: Measure,
    /// Method.
    pub of: &'static str,
    /// Other method of the comparison; `None` for a bound.
    pub than: Option<&'static str>,
    /// Value of the other method; `None` for a bound, or without a path.
    pub old: Option<f64>,
    /// Value of this method.
    pub new: Option<f64>,
    /// Change between the two.
    pub effect: Option<f64>,
}

/// Results on maps on which the baselines have their published figures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReconstructedReport {
    /// The reconstruction.
    pub name: &'static str,
    /// Number of maps tried.
    pub tried: u64,
    /// Seeds of the maps that fit.
    pub seeds: Vec<u64>,
    /// Maps that count: on the others, a method that must succeed did not.
    pub maps: usize,
    /// All figures.
    pub figures: Vec<FamilyFigure>,
}

/// Results over the family of maps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FamilyReport {
    /// The experiment.
    pub experiment: &'static str,
    /// Maps that count.
    pub maps: usize,
    /// Maps on which a method that must succeed did not.
    pub left_out: usize,
    /// Mean of the first figure.
    pub mean: Option<f64>,
    /// Lower end of its interval.
    pub ci95_low: Option<f64>,
    /// Upper end of its interval.
    pub ci95_high: Option<f64>,
    /// All figures.
    pub figures: Vec<FamilyFigure>,
}

/// Results for a figure over the family.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FamilyFigure {
    /// Measure.
    pub measure: Measure,
    /// Unit of the values.
    pub unit: &'static str,
    /// Scale on which values are compared.
    pub scale: Scale,
    /// Method.
    pub of: &'static str,
    /// Other method of the comparison; `None` for a bound.
    pub than: Option<&'static str>,
    /// `lower`, `higher`, `same`, `not_higher`, `at_least` or `at_most`.
    pub expected: &'static str,
    /// The bound, or the change that counts as none.
    pub limit: Option<f64>,
    /// Maps on which the figure is defined.
    pub pairs: usize,
    /// Counted maps on which it is not defined.
    pub undefined: usize,
    /// Mean of the other method.
    pub old_mean: Option<f64>,
    /// Mean of this one.
    pub new_mean: Option<f64>,
    /// Mean change; for a bound, the share of maps on which it is kept.
    pub mean: Option<f64>,
    /// Lower end of the 95 % confidence interval of the true value: bootstrap, or Wilson's
    /// interval for a share.
    pub ci95_low: Option<f64>,
    /// Upper end of the interval.
    pub ci95_high: Option<f64>,
    /// Verdict on it; `None` if nothing is expected.
    pub verdict: Option<FigureVerdict>,
}

/// An experiment with its maps and the results of each method.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExperimentReport {
    /// Name of the experiment.
    pub experiment: &'static str,
    /// Description of the maps in one sentence.
    pub about: &'static str,
    /// Maps that count.
    pub maps: usize,
    /// Maps on which a method that must succeed did not.
    pub left_out: usize,
    /// All methods, including the yardstick.
    pub methods: Vec<MethodReport>,
}

/// Means of a method over the maps that count and on which it succeeded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MethodReport {
    /// Name in the experiment.
    pub method: &'static str,
    /// Number of all maps, including those left out, on which it found a path and, if it drives,
    /// drove it to its end.
    pub succeeded: usize,
    /// Nodes taken from the open lists.
    pub mean_expanded: Option<f64>,
    /// Length of the path \[m\].
    pub mean_length_m: Option<f64>,
    /// Relative excess of the path's length over that of the yardstick.
    pub mean_excess: Option<f64>,
    /// Points.
    pub mean_points: Option<f64>,
    /// Turns.
    pub mean_turns: Option<f64>,
    /// Heading jumps.
    pub mean_non_smooth_turns: Option<f64>,
    /// Sum of the absolute heading changes \[deg\].
    pub mean_turning_angle_deg: Option<f64>,
    /// Smallest distance to an obstacle \[m\].
    pub mean_clearance_m: Option<f64>,
    /// Time of search and smoothing \[s\]; `None` without a clock, and for runs.
    pub mean_planning_s: Option<f64>,
    /// Simulated time of the runs \[s\]; `None` for paths, here and below.
    pub mean_run_time_s: Option<f64>,
    /// Distance driven \[m\].
    pub mean_driven_length_m: Option<f64>,
    /// Distance driven over time \[m/s\].
    pub mean_speed_mps: Option<f64>,
    /// Smallest distance of the robot to any obstacle \[m\].
    pub mean_run_clearance_m: Option<f64>,
}

impl ClaimReport {
    /// Judges a claim by its measured figures. Timed figures are never judged; without `times`,
    /// they are not reported either.
    pub fn new(claim: &Claim, family: &Family, times: bool) -> Self {
        let figures = || claim.figures.iter().filter(|figure| times || !figure.measure.is_timed());
        let published: Vec<PublishedFigure> = claim.figures.iter().filter_map(published).collect();
        let experiment = claim.experiment;
        let findings_of = |rows: &[MapRow]| -> Vec<(Figure, Finding)> {
            figures().map(|figure| (*figure, Finding::of(figure, experiment, rows))).collect()
        };
        let scene = experiment.scene.as_ref().zip(family.scene.as_ref()).map(|(scene, row)| {
            let figures = figures().map(|figure| scene_figure(figure, experiment, row)).collect();
            SceneReport { file: scene.file, figures }
        });
        let reconstructed = experiment.reconstruction.ok().map(|of| ReconstructedReport {
            name: of.name,
            tried: family.fitted.tried,
            seeds: family.fitted.seeds.clone(),
            maps: family.reconstructed.len(),
            figures: family_figures(&findings_of(&family.reconstructed)),
        });
        let family = FamilyReport::new(experiment, family, &findings_of(&family.rows));
        // Timed figures count even if they are not reported.
        let unreported =
            std::iter::repeat_n(FigureVerdict::NotJudged, claim.figures.len() - figures().count());
        let judged = family.figures.iter().filter_map(|figure| figure.verdict);
        let counts = FigureCounts::of(judged.chain(unreported));
        Self {
            id: claim.id,
            paper: claim.paper,
            statement: claim.statement,
            source: claim.source(),
            rule: claim.rule(),
            published: (!published.is_empty()).then_some(PublishedReport { figures: published }),
            scene,
            reconstructed,
            not_reconstructed: experiment.reconstruction.err(),
            family,
            figures: counts,
            verdict: counts.verdict(),
        }
    }
}

fn family_figures(findings: &[(Figure, Finding)]) -> Vec<FamilyFigure> {
    findings.iter().map(|(figure, finding)| family_figure(figure, finding)).collect()
}

impl FamilyReport {
    fn new(experiment: &Experiment, family: &Family, findings: &[(Figure, Finding)]) -> Self {
        let figures = family_figures(findings);
        let first = figures.first();
        Self {
            experiment: experiment.name,
            maps: family.rows.len(),
            left_out: family.left_out,
            mean: first.and_then(|figure| figure.mean),
            ci95_low: first.and_then(|figure| figure.ci95_low),
            ci95_high: first.and_then(|figure| figure.ci95_high),
            figures,
        }
    }
}

fn published(figure: &Figure) -> Option<PublishedFigure> {
    let [old, new] = figure.published()?;
    let Figure { measure, of, .. } = *figure;
    Some(PublishedFigure {
        measure,
        of,
        than: figure.than(),
        old,
        new,
        effect: figure.published_effect(),
    })
}

fn scene_figure(figure: &Figure, experiment: &Experiment, row: &MapRow) -> SceneFigure {
    let Figure { measure, of, .. } = *figure;
    let than = figure.than();
    SceneFigure {
        measure,
        of,
        than,
        old: than.and_then(|than| value(figure, than, experiment, row)),
        new: value(figure, of, experiment, row),
        effect: change_on(figure, experiment, row).map(|[_, _, change]| change),
    }
}

pub(super) fn family_figure(figure: &Figure, finding: &Finding) -> FamilyFigure {
    let Figure { measure, of, expected } = *figure;
    let (word, limit) = match expected {
        Expected::Change { direction: Direction::Lower, .. } => ("lower", None),
        Expected::Change { direction: Direction::Higher, .. } => ("higher", None),
        Expected::Change { direction: Direction::Same { within }, .. } => ("same", Some(within)),
        Expected::Change { direction: Direction::NotHigher { beyond }, .. } => {
            ("not_higher", Some(beyond))
        }
        Expected::Always(Bound::AtLeast(least)) => ("at_least", Some(least)),
        Expected::Always(Bound::AtMost(most)) => ("at_most", Some(most)),
    };
    let [mean, ci95_low, ci95_high] = match finding.evidence {
        Evidence::Missing => [None; 3],
        Evidence::Change { mean, low, high } => [mean, low, high].map(Some),
        Evidence::Kept(rate) => {
            let interval = rate.interval(Confidence::USUAL);
            [rate.share(), interval.map(|ends| ends.low), interval.map(|ends| ends.high)]
        }
    };
    let &Finding { pairs, undefined, old_mean, new_mean, evidence } = finding;
    FamilyFigure {
        measure,
        unit: measure.unit(),
        scale: figure.scale(),
        of,
        than: figure.than(),
        expected: word,
        limit,
        pairs,
        undefined,
        old_mean,
        new_mean,
        mean,
        ci95_low,
        ci95_high,
        verdict: Some(FigureVerdict::of(figure, evidence)),
    }
}

impl ExperimentReport {
    /// Reports the results of each method over the family.
    pub fn new(experiment: &Experiment, family: &Family) -> Self {
        let methods = experiment.methods.iter().enumerate().map(|(i, method)| {
            let outcomes = || family.rows.iter().map(move |row| row.outcomes[i].as_ref());
            let mean_of =
                |measure: Measure| mean(outcomes().filter_map(|outcome| measure.of(outcome)));
            MethodReport {
                method: method.name,
                succeeded: family.succeeded.get(i).copied().unwrap_or_default(),
                mean_expanded: mean_of(Measure::Expanded),
                mean_length_m: mean_of(Measure::Length),
                mean_excess: mean_of(Measure::Excess),
                mean_points: mean_of(Measure::Points),
                mean_turns: mean_of(Measure::Turns),
                mean_non_smooth_turns: mean_of(Measure::NonSmoothTurns),
                mean_turning_angle_deg: mean_of(Measure::TurningAngle),
                mean_clearance_m: mean_of(Measure::Clearance),
                mean_planning_s: mean_of(Measure::PlanningTime),
                mean_run_time_s: mean_of(Measure::RunTime),
                mean_driven_length_m: mean_of(Measure::DrivenLength),
                mean_speed_mps: mean_of(Measure::MeanSpeed),
                mean_run_clearance_m: mean_of(Measure::RunClearance),
            }
        });
        Self {
            experiment: experiment.name,
            about: experiment.about,
            maps: family.rows.len(),
            left_out: family.left_out,
            methods: methods.collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn family(claim: &Claim, seeds: u64) -> Family {
        let experiment = claim.experiment;
        let mut family = Family { scene: experiment.on_scene(None).unwrap(), ..Family::default() };
        for seed in 1..=seeds {
            family.take(experiment, experiment.on_seed(seed, None).unwrap(), seeds as usize);
        }
        family
    }

    #[test]
    fn a_claim_with_everything() {
        let claim = Claim::named("S0-1")[0];
        let report = ClaimReport::new(claim, &family(claim, 4), false);
        assert_eq!((report.id, report.rule), ("S0-1", Rule::Figures));
        let published = report.published.unwrap();
        assert_eq!(published.figures.len(), 3);
        assert_eq!((published.figures[1].old, published.figures[1].new), (87.0, 35.0));
        // The time is neither reported nor judged.
        let (scene, family) = (report.scene.unwrap(), report.family);
        assert_eq!((scene.figures.len(), family.figures.len()), (2, 2));
        // The scene is fitted to the length of A*.
        assert!((scene.figures[1].old.unwrap() - 29.213).abs() < 1e-3, "{scene:?}");
        let first = family.figures[0];
        assert_eq!((first.expected, first.pairs, first.unit), ("lower", family.maps, ""));
        assert_eq!([family.mean, family.ci95_low], [first.mean, first.ci95_low]);
        assert!(first.old_mean > first.new_mean, "{first:?}");
        assert_ne!(report.verdict, Verdict::NotMeasured, "its times are not judged");
        let json = serde_json::to_value(first).unwrap();
        assert_eq!((&json["measure"], &json["scale"]), (&"expanded".into(), &"relative".into()));
    }

    #[test]
    fn a_claim_that_is_not_measured_has_no_verdict() {
        let claim = Claim::named("S0-1")[0];
        let report = ClaimReport::new(claim, &Family::default(), false);
        assert_eq!(report.verdict, Verdict::NotMeasured, "without a map");
    }

    #[test]
    fn bounds_and_methods() {
        let claim = Claim::named("S0-4")[0];
        let family = family(claim, 3);
        let report = ClaimReport::new(claim, &family, true);
        assert_eq!((report.rule, report.published), (Rule::Sign, None));
        let figure = report.family.figures[1];
        assert_eq!((figure.expected, figure.than, figure.old_mean), ("at_least", None, None));
        assert!(figure.limit.is_some() && figure.mean.is_some() && figure.ci95_low < figure.mean);
        let report = ExperimentReport::new(claim.experiment, &family);
        assert_eq!((report.maps, report.methods.len()), (family.rows.len(), 6));
        let jps = report.methods[5];
        assert_eq!((jps.method, jps.succeeded), (Experiment::YARDSTICK, report.maps));
        assert_eq!((jps.mean_excess, jps.mean_planning_s), (Some(0.0), None));
    }
}
