//! Searches on the map of a page, event by event.

use crate::error::PageError;
use crate::map::Opened;
use crate::message::{Message, json, numbers};
use crate::route::{Layers, Plan, Ready, if_unreachable, point, ready, refused, with_shortest};
use keyway::map::Cell;
use keyway::plan::{Plan as Planned, PlanError};
use keyway::route::RouteQuery;
use keyway::search::{Observer, Side, Workspace};
use serde::Serialize;

/// Maximum number of reported events. A page needs 24 bytes for each, several times.
pub const MOST_EVENTS: usize = 2_000_000;

/// A recorded search. The part `events` has six 32-bit numbers for each event, in order: kind
/// ([`EVENT_KINDS`]), side (0 from the start, 1 from the goal), column and row of the node,
/// column and row of the other end. The part `path` has column and row of each cell of the path.
/// The part `shortest` is as in a plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Search {
    /// Names of the kinds of events, by index.
    pub kinds: [&'static str; 6],
    /// Number of reported events.
    pub events: usize,
    /// Number of further events, which are dropped beyond [`MOST_EVENTS`].
    pub left_out: usize,
    /// Number of expanded nodes, on both sides.
    pub expanded: u64,
    /// Number of generated nodes, on both sides.
    pub generated: u64,
    /// Cost of the path \[cells\]; `null` without a path.
    pub cost_cells: Option<f64>,
    /// Reason for a failed search; `null` if there is a path.
    pub why: Option<String>,
}

/// The kinds of events of a search ([`keyway::search::SearchEvent`]).
pub const EVENT_KINDS: [&str; 6] =
    ["expanded", "generated", "reparented", "scanned", "linked", "met"];

/// Searches with a recording observer.
pub(crate) fn search(
    ask: &Plan,
    opened: &Opened,
    layers: &mut Layers,
    workspace: &mut Workspace,
) -> Result<Message, PageError> {
    let Ready { map, planner, .. } = ready(ask, opened, layers)?;
    let query = RouteQuery {
        budget: ask.budget,
        if_unreachable: if_unreachable(ask),
        ..RouteQuery::new(point(ask.start), point(ask.goal))
    };
    let query = query.on_cells(map).map_err(|error| refused(map, ask, &error))?;
    let (mut told, mut plan) = (Told::default(), Planned::default());
    let found = planner.plan_into(map, &query, workspace, Some(&mut told), &mut plan);
    if let Err(error @ (PlanError::Blocked { .. } | PlanError::OutsideMap { .. })) = &found {
        return Err(refused(map, ask, error));
    }
    let is_found = found.is_ok();
    let head = Search {
        kinds: EVENT_KINDS,
        events: told.events.len(),
        left_out: told.left_out,
        expanded: told.expanded,
        generated: told.generated,
        cost_cells: is_found.then(|| plan.cost.cells()),
        why: found.err().map(|error| error.to_string()),
    };
    let path = plan.cells.iter().flat_map(|cell| [cell.x, cell.y]);
    let answer = Message::new(json(&head))
        .with("events", numbers(told.events.into_iter().flatten()))
        .with("path", numbers(path));
    Ok(if is_found { with_shortest(answer, ask, map, &*planner) } else { answer })
}

/// Recorder of events as numbers, up to [`MOST_EVENTS`].
#[derive(Default)]
struct Told {
    events: Vec<[i32; 6]>,
    left_out: usize,
    expanded: u64,
    generated: u64,
}

impl Told {
    fn tell(&mut self, kind: i32, side: Side, at: Cell, other: Cell) {
        if self.events.len() == MOST_EVENTS {
            self.left_out += 1;
            return;
        }
        let side = i32::from(side == Side::Backward);
        self.events.push([kind, side, at.x, at.y, other.x, other.y]);
    }
}

impl Observer for Told {
    fn expanded(&mut self, side: Side, at: Cell, _g_cells: f64) {
        self.expanded += 1;
        self.tell(0, side, at, at);
    }

    fn generated(&mut self, side: Side, at: Cell, parent: Cell, _g_cells: f64) {
        self.generated += 1;
        self.tell(1, side, at, parent);
    }

    fn reparented(&mut self, side: Side, at: Cell, parent: Cell, _g_cells: f64) {
        self.tell(2, side, at, parent);
    }

    fn scanned(&mut self, side: Side, from: Cell, to: Cell) {
        self.tell(3, side, from, to);
    }

    fn linked(&mut self, side: Side, at: Cell, parent: Cell) {
        self.tell(4, side, at, parent);
    }

    fn met(&mut self, at: Cell) {
        self.tell(5, Side::Forward, at, at);
    }
}
