//! Keyway for Python: parses arguments, calls the library and converts results. All rules are
//! those of the library.
//!
//! There is one file per Python class. [`ready`] has the layers of a map and the planners on it,
//! [`values`] the conversion of arguments, [`arrays`] that of results, [`errors`] that of errors,
//! and [`watched`] the progress and interruption of long calls.

#![expect(clippy::needless_pass_by_value, reason = "arguments come from Python by value")]
#![expect(clippy::doc_link_with_quotes, reason = "the docstrings are those of Python")]

mod arrays;
mod batch;
mod comparison;
mod errors;
mod given_map;
mod map;
mod measured;
mod navigator;
mod parameters;
mod pictures;
mod plan;
mod planner;
mod points;
mod program;
mod ready;
mod run;
mod scan;
mod scene;
mod simulation;
mod step;
mod values;
mod watched;

use pyo3::pymodule;

/// The compiled part of Keyway. Import `keyway` instead.
#[pymodule]
mod _keyway {
    #[pymodule_export]
    use crate::batch::{batch, merge};
    #[pymodule_export]
    use crate::comparison::{Comparison, compare};
    #[pymodule_export]
    use crate::map::Map;
    #[pymodule_export]
    use crate::navigator::Navigator;
    #[pymodule_export]
    use crate::plan::Plan;
    #[pymodule_export]
    use crate::planner::{Planner, plan, plan_many};
    #[pymodule_export]
    use crate::points::Points;
    #[pymodule_export]
    use crate::program::{names, program};
    #[pymodule_export]
    use crate::run::{Run, simulate, simulate_team};
    #[pymodule_export]
    use crate::scan::Scan;
    #[pymodule_export]
    use crate::scene::Scene;
    #[pymodule_export]
    use crate::simulation::Simulation;
    #[pymodule_export]
    use crate::step::Step;
}
