//! Pictures of maps, plans and runs.
