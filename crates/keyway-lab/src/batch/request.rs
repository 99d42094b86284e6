//! Request for a batch.

use super::limits::SEEDS;
use super::{BatchError, Keep, SceneSource, Shard};
use keyway::files::Assignment;
use keyway::map::formats::DEFAULT_MAX_CELLS;
use keyway_sim::sim::ReachedBy;
use std::ops::RangeInclusive;
use std::path::PathBuf;

/// Scenes, the stacks and robots that drive in them, and the folder for the results.
///
/// ```no_run
/// use keyway_lab::batch::BatchRequest;
///
/// let mut request = BatchRequest::new(vec!["scenes".into()], "results".into());
/// request.stacks = vec!["keyway".to_owned(), "s0-key-point".to_owned()];
/// request.seeds = 10;
/// let report = request.drive(&(), &())?;
/// assert_eq!(report.stacks.len(), 2);
/// # Ok::<(), keyway_lab::batch::BatchError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BatchRequest {
    /// The scenes, in this order.
    pub scenes: Vec<SceneSource>,
    /// Folder for the results. Runs that it already holds are not repeated.
    pub out: PathBuf,
    /// The stacks that drive each scene, with all its robots: names, or files relative to the
    /// current folder; `all` alone means all stacks. Empty: those of the scenes.
    pub stacks: Vec<String>,
    /// The robot that replaces all robots: a name, or a file relative to the current folder;
    /// `None`: those of the scenes.
    pub robot: Option<String>,
    /// Values of all robots (`robot.cycle_s=0.2`) and parameters of all stacks, changed one by one.
    pub set: Vec<Assignment>,
    /// True if every stack runs with the stop rule, even if a scene does not ask for it.
    pub safe: bool,
    /// File of the disturbances; `None`: those of the scenes.
    pub disturbances: Option<PathBuf>,
    /// Pose by which a goal is reached; `None`: as the scenes say.
    pub reached_by: Option<ReachedBy>,
    /// Number of seeds for each scene: its own seed, and the numbers that follow it.
    pub seeds: u64,
    /// Number of parallel runs; `None`: the number of processors.
    pub jobs: Option<usize>,
    /// The part of the runs that is executed; `None`: all runs.
    pub shard: Option<Shard>,
    /// The runs whose full records are stored.
    pub keep: Keep,
    /// Maximum number of cells of a map; larger maps are refused before memory is allocated.
    pub max_cells: u64,
}

/// Results of other batches that are to be merged, and the folder for the merged results.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MergeRequest {
    /// Folders of results. All parts of a batch must be given; different batches are
    /// concatenated.
    pub parts: Vec<PathBuf>,
    /// Folder for the merged results.
    pub out: PathBuf,
}

impl BatchRequest {
    /// Valid numbers of seeds for a scene.
    pub const SEEDS: RangeInclusive<u64> = SEEDS;

    /// Returns a request for one run of each scene with everything that the scene names.
    pub const fn new(scenes: Vec<SceneSource>, out: PathBuf) -> Self {
        Self {
            scenes,
            out,
            stacks: Vec::new(),
            robot: None,
            set: Vec::new(),
            safe: false,
            disturbances: None,
            reached_by: None,
            seeds: 1,
            jobs: None,
            shard: None,
            keep: Keep::None,
            max_cells: DEFAULT_MAX_CELLS,
        }
    }

    /// Checks everything that can be checked before any file is read.
    pub(super) fn check(&self) -> Result<(), BatchError> {
        if self.scenes.is_empty() {
            return Err(BatchError::NoScenes);
        }
        if self.out.as_os_str().is_empty() {
            return Err(BatchError::NoOut);
        }
        if !Self::SEEDS.contains(&self.seeds) {
            return Err(BatchError::Seeds { found: self.seeds });
        }
        if self.jobs == Some(0) {
            return Err(BatchError::NoJobs);
        }
        let is_repeated = |i: &usize| self.stacks[..*i].contains(&self.stacks[*i]);
        match (0..self.stacks.len()).find(is_repeated) {
            Some(i) => Err(BatchError::StackTwice { stack: self.stacks[i].clone() }),
            None => Ok(()),
        }
    }
}

impl MergeRequest {
    /// Checks everything that can be checked before any file is read.
    pub(super) fn check(&self) -> Result<(), BatchError> {
        if self.parts.is_empty() {
            return Err(BatchError::NoParts);
        }
        if self.out.as_os_str().is_empty() {
            return Err(BatchError::NoOut);
        }
        // The output must not replace results that are read.
        let Ok(out) = self.out.canonicalize() else { return Ok(()) };
        let is_out = |part: &PathBuf| part.canonicalize().is_ok_and(|part| part == out);
        if self.parts.iter().any(is_out) {
            return Err(BatchError::OutIsPart { out: self.out.clone() });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_that_cannot_be_is_refused_with_the_name_of_its_field() {
        let good = BatchRequest::new(vec!["a.toml".into()], "out".into());
        assert!(good.check().is_ok());
        let twice = vec!["keyway".to_owned(), "keyway".to_owned()];
        for (request, field, text) in [
            (BatchRequest { scenes: Vec::new(), ..good.clone() }, "scenes", "at least one scene"),
            (BatchRequest { out: PathBuf::new(), ..good.clone() }, "out", "a folder"),
            (BatchRequest { seeds: 0, ..good.clone() }, "seeds", "from 1 to 1000000, got 0"),
            (BatchRequest { seeds: 1_000_001, ..good.clone() }, "seeds", "got 1000001"),
            (BatchRequest { jobs: Some(0), ..good.clone() }, "jobs", "at least 1"),
            (BatchRequest { stacks: twice, ..good.clone() }, "stacks", "`keyway` is given twice"),
        ] {
            let error = request.check().unwrap_err();
            assert_eq!(error.field(), Some(field), "{error}");
            assert!(error.to_string().contains(text), "{error}");
        }
        let none = MergeRequest { parts: Vec::new(), out: "out".into() };
        assert_eq!(none.check().unwrap_err().field(), Some("parts"));
    }
}
