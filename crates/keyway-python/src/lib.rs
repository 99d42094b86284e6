//! Keyway for Python: it parses, calls and converts. Every rule is one of the library's.
//!
//! One file per Python class; [`ready`] has what plans need of a map, [`values`] what comes in and [`arrays`] what goes out,
//! [`errors`] which exception an error is, and [`watched`] how long calls are watched and stopped.

#![expect(clippy::needless_pass_by_value, reason = "arguments come from Python by value")]
#![expect(clippy::doc_link_with_quotes, reason = "the docstrings are those of Python")]

mod arrays;
mod batch;
mod comparison;
mod errors;
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
