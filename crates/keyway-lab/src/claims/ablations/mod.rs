//! Effect of each part of a method, compared with the method without it, and of each parameter,
//! compared with other values.
//!
//! Nothing is judged here. All variants run on the same maps as the claims of their paper.

mod s1;
mod wang2019;
mod you2021;
mod zhuyin2024;

use super::claim::Figure;
use super::experiment::{Experiment, MapRow};
use super::family::Family;
use super::findings::Finding;
use super::measure::Measure;
use super::method::Method;
use super::report::{FamilyFigure, family_figure};
use keyway::map::Cell;
use keyway_sim::worlds::GeneratedMap;
use serde::Serialize;

/// Variants of a method, each compared with the method as published.
#[derive(Debug)]
pub struct Ablation {
    /// Key of the paper in docs/papers.md.
    pub paper: &'static str,
    /// Subject of the variation, in one sentence.
    pub about: &'static str,
    /// The variants, on the maps of the family.
    pub experiment: &'static Experiment,
    /// The method as published.
    pub base: &'static str,
    /// The varied parameter with its unit, and its value in each of the first methods; `None` if
    /// parts are left out.
    pub parameter: Option<(&'static str, &'static [f64])>,
    /// Measures to compare.
    pub measures: &'static [Measure],
}

/// Results of the variants.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AblationReport {
    /// The experiment.
    pub experiment: &'static str,
    /// Key of the paper in docs/papers.md.
    pub paper: &'static str,
    /// Subject of the variation, in one sentence.
    pub about: &'static str,
    /// Method with which the others are compared.
    pub base: &'static str,
    /// The varied parameter; `None` if parts are left out.
    pub parameter: Option<&'static str>,
    /// Values of the parameter, in the order of the first methods.
    pub values: &'static [f64],
    /// Maps that count.
    pub maps: usize,
    /// Maps on which a method that must succeed did not.
    pub left_out: usize,
    /// Change from the base, for each variant and each measure.
    pub figures: Vec<FamilyFigure>,
    /// Number of reconstructed maps that count; 0 without a reconstruction.
    pub reconstructed_maps: usize,
    /// The same figures on reconstructed maps; empty without any.
    pub reconstructed: Vec<FamilyFigure>,
}

impl Ablation {
    /// Returns all ablations, in the order of the papers.
    pub fn all() -> impl Iterator<Item = &'static Self> {
        let papers =
            [&you2021::ABLATIONS[..], &s1::ABLATIONS, &wang2019::ABLATIONS, &zhuyin2024::ABLATIONS];
        papers.into_iter().flatten()
    }

    /// Compares every variant with the base; without `times`, omits all timed measures.
    pub fn report(&self, family: &Family, times: bool) -> AblationReport {
        let (parameter, values) = self.parameter.unzip();
        let rows = &family.reconstructed;
        AblationReport {
            experiment: self.experiment.name,
            paper: self.paper,
            about: self.about,
            base: self.base,
            parameter,
            values: values.unwrap_or_default(),
            maps: family.rows.len(),
            left_out: family.left_out,
            figures: self.figures(&family.rows, times),
            reconstructed_maps: rows.len(),
            reconstructed: if rows.is_empty() { Vec::new() } else { self.figures(rows, times) },
        }
    }

    fn figures(&self, rows: &[MapRow], times: bool) -> Vec<FamilyFigure> {
        let measures = || self.measures.iter().filter(|measure| times || !measure.is_timed());
        let variants = self.experiment.methods.iter().filter(|method| method.name != self.base);
        let figures = variants.flat_map(|variant| {
            measures().map(|&measure| {
                let figure = Figure::lower(measure, variant.name, self.base, None);
                let finding = Finding::of(&figure, self.experiment, rows);
                // No direction is expected.
                let figure = family_figure(&figure, &finding);
                FamilyFigure { expected: "none", verdict: None, ..figure }
            })
        });
        figures.collect()
    }
}

impl AblationReport {
    /// Returns the measures of the figures, each once, in their order.
    pub fn measures(&self) -> Vec<Measure> {
        let mut measures = Vec::new();
        for measure in self.figures.iter().map(|figure| figure.measure) {
            if !measures.contains(&measure) {
                measures.push(measure);
            }
        }
        measures
    }
}

/// Creates an experiment on the maps of another one, with other methods.
const fn on_maps_of(
    name: &'static str,
    about: &'static str,
    family: GeneratedMap,
    ends: [Cell; 2],
    methods: &'static [Method],
) -> Experiment {
    let (kind, scene, reconstruction) =
        (None, None, Err("its methods are compared with each other alone"));
    Experiment { name, about, family, kind, ends, methods, scene, reconstruction }
}

/// Creates an ablation whose variants are the method with other values of a parameter.
const fn sweep(
    paper: &'static str,
    about: &'static str,
    (experiment, base): (&'static Experiment, &'static str),
    parameter: (&'static str, &'static [f64]),
    measures: &'static [Measure],
) -> Ablation {
    Ablation { paper, about, experiment, base, parameter: Some(parameter), measures }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::Claim;
    use std::collections::BTreeSet;

    #[test]
    fn every_ablation_can_be_measured_and_has_its_base() {
        let mut names: BTreeSet<&str> = Claim::all().map(|claim| claim.experiment.name).collect();
        for ablation in Ablation::all() {
            let Ablation { experiment, base, parameter, .. } = ablation;
            assert!(names.insert(experiment.name), "{} is there twice", experiment.name);
            assert!(experiment.method(base).is_some(), "{} {base}", experiment.name);
            assert!(experiment.family.validate().is_ok());
            let Some((_, values)) = parameter else { continue };
            assert!(values.len() > 2 && values.is_sorted(), "{}", experiment.name);
            for (method, value) in experiment.methods.iter().zip(*values) {
                assert!(method.name.ends_with(&value.to_string()), "{} {value}", method.name);
            }
        }
    }

    #[test]
    fn variants_are_compared_with_the_base() {
        let ablation = Ablation::all().next().unwrap();
        let (mut family, mut seed) = (Family::default(), 1);
        let experiment = ablation.experiment;
        while family.take(experiment, experiment.on_seed(seed, None).unwrap(), 3) {
            seed += 1;
        }
        let report = ablation.report(&family, false);
        let untimed = ablation.measures.iter().filter(|measure| !measure.is_timed()).count();
        assert_eq!(report.figures.len(), (experiment.methods.len() - 1) * untimed);
        assert!(report.figures.iter().all(|figure| figure.than == Some(ablation.base)));
        assert!(report.figures.iter().any(|figure| figure.mean != Some(0.0)));
    }
}
