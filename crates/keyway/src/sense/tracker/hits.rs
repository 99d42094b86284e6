//! The hits of one scan and their assignment to tracks.

use crate::geometry::Point;
use crate::map::{Cell, OccupancyGrid};
use crate::sense::ProjectedScan;

/// Assignment of a beam's hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Owner {
    /// No hit, or a hit that the known map explains.
    Explained,
    /// A hit that belongs to no track.
    Nobody,
    /// The track of this index.
    Track(u32),
}

/// One beam.
#[derive(Clone, Copy, Debug)]
struct Hit {
    owner: Owner,
    point: Point,
    /// `None` outside the map.
    cell: Option<Cell>,
    /// Misfit to its track \[m\]; smaller is better.
    score_m: f64,
}

/// All beams of a scan.
#[derive(Clone, Debug, Default)]
pub(super) struct Hits(Vec<Hit>);

impl Hits {
    /// Takes in the hits of a scan. Hits within `explained_m` of an occupied cell of the known
    /// map are explained, and so are those outside the map.
    pub(super) fn take_in(
        &mut self,
        known: &OccupancyGrid,
        scan: &ProjectedScan,
        explained_m: f64,
    ) {
        let nothing = Hit {
            owner: Owner::Explained,
            point: Point::default(),
            cell: None,
            score_m: f64::INFINITY,
        };
        self.0.clear();
        self.0.resize(scan.len(), nothing);
        let frame = known.frame();
        let cells = (explained_m / frame.resolution_m()).ceil().min(f64::from(i32::MAX / 4)) as i32;
        for (beam, projected) in scan.hits() {
            let hit = &mut self.0[beam];
            (hit.cell, hit.point) = (projected.cell, projected.point);
            if hit.cell.is_some_and(|cell| !is_near_known(known, cell, cells)) {
                hit.owner = Owner::Nobody;
            }
        }
    }

    /// The assignment of a beam; `None` if the beam does not exist.
    pub(super) fn owner(&self, beam: usize) -> Option<Owner> {
        self.0.get(beam).map(|hit| hit.owner)
    }

    /// The hit point of a beam, unless the map explains it.
    pub(super) fn point(&self, beam: usize) -> Option<Point> {
        let hit = self.0.get(beam)?;
        (hit.owner != Owner::Explained).then_some(hit.point)
    }

    /// The hit point of a beam, if it belongs to no track.
    pub(super) fn unexplained(&self, beam: usize) -> Option<Point> {
        let hit = self.0.get(beam)?;
        (hit.owner == Owner::Nobody).then_some(hit.point)
    }

    /// Offers a hit to a track, which takes it if no other track fits as well.
    pub(super) fn offer(&mut self, beam: usize, track: u32, score_m: f64) {
        let hit = &mut self.0[beam];
        if score_m < hit.score_m {
            (hit.owner, hit.score_m) = (Owner::Track(track), score_m);
        }
    }

    /// Assigns a hit to a track.
    pub(super) fn give(&mut self, beam: usize, track: u32) {
        self.0[beam].owner = Owner::Track(track);
    }

    /// Takes a hit away from its track.
    pub(super) fn release(&mut self, beam: usize) {
        self.0[beam].owner = Owner::Nobody;
    }

    /// Renumbers the track of index `from`, or ends it.
    pub(super) fn renumber(&mut self, from: u32, to: Option<u32>) {
        if to == Some(from) {
            return;
        }
        let new = to.map_or(Owner::Nobody, Owner::Track);
        let own = self.0.iter_mut().filter(|hit| hit.owner == Owner::Track(from));
        own.for_each(|hit| hit.owner = new);
    }

    /// The cells of all hits that the map does not explain, with their assignment.
    pub(super) fn cells(&self) -> impl Iterator<Item = (Owner, Cell)> + '_ {
        let hits = self.0.iter().filter(|hit| hit.owner != Owner::Explained);
        hits.filter_map(|hit| Some((hit.owner, hit.cell?)))
    }
}

/// True if the known map has an occupied cell within this many cells.
fn is_near_known(known: &OccupancyGrid, cell: Cell, cells: i32) -> bool {
    let (low, high) = (cell.x.saturating_sub(cells), cell.x.saturating_add(cells));
    let rows = cell.y.saturating_sub(cells).max(0)
        ..=cell.y.saturating_add(cells).min(known.frame().height() as i32 - 1);
    rows.into_iter().any(|y| known.occupied().any_in_span(y, low, high))
}
