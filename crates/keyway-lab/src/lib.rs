//! Experiments with robots of [`keyway`] in worlds of [`keyway_sim`].
//!
//! For now: what papers [claim](claims), measured again.

pub mod claims;
