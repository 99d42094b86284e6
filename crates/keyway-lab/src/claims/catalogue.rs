//! Claims of all papers.

use super::claim::Claim;
use super::{s1, wang2019, you2021, zhuyin2024};

impl Claim {
    /// Returns all claims of the four papers, in the order of their names: S0 is \[You2021\], S1
    /// \[S1\], S2 \[Wang2019\] and S4 \[ZhuYin2024\].
    pub fn all() -> impl Iterator<Item = &'static Self> {
        let papers = [&you2021::CLAIMS[..], &s1::CLAIMS, &wang2019::CLAIMS, &zhuyin2024::CLAIMS];
        papers.into_iter().flatten()
    }

    /// Returns the claims of a name: the name of a single claim, `s0`, `s1`, `s2` or `s4` for all
    /// claims of a paper, or `all`; case does not matter. Empty for an unknown name.
    pub fn named(name: &str) -> Vec<&'static Self> {
        let name = name.to_uppercase();
        let is_named = |claim: &&Self| {
            name == "ALL" || claim.id == name || claim.id.split('-').next() == Some(&name)
        };
        Self::all().filter(is_named).collect()
    }

    /// Returns the source file that defines the claim, its figures and its experiment.
    pub fn source(&self) -> &'static str {
        match self.paper {
            you2021::PAPER => "crates/keyway-lab/src/claims/you2021.rs",
            s1::PAPER => "crates/keyway-lab/src/claims/s1.rs",
            wang2019::PAPER => "crates/keyway-lab/src/claims/wang2019.rs",
            _ => "crates/keyway-lab/src/claims/zhuyin2024.rs",
        }
    }
}
