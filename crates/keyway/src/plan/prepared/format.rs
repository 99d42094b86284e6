//! The binary format of prepared maps.
//!
//! All numbers are little-endian:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `KeywayPM` |
//! | 4 | version of the format, 1 |
//! | 4 | corner rule, 0: corners are not cut |
//! | 8 | [`SearchMap::fingerprint`] |
//! | 8 | edges |
//! | 4 | nodes n |
//! | 4 | label entries m |
//! | 4 n | for each node the number of its corner cell, row by row |
//! | 4 n | for each node the entries of its label |
//! | 8 m | entries: hub << 40, straight steps << 20, diagonal steps |
//! | 4 m | hops: place of the next entry << 3, octant |
//! | 8 | checksum of all before |
//!
//! Values that follow from the map are not stored: the bytes are read together with their map.

use super::corners::Corners;
use super::labels::{Entry, Hop, Labels, octant};
use super::{Prepared, inverse};
use crate::map::{Cell, SearchMap, mix};
use crate::search::Cost;
use thiserror::Error;

const MAGIC: [u8; 8] = *b"KeywayPM";
const VERSION: u32 = 1;
const CORNERS_ARE_NOT_CUT: u32 = 0;
const HEADER_BYTES: usize = 40;
const CHECKSUM_BYTES: usize = 8;

/// The reason why a prepared map cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PreparedFormatError {
    /// The magic number is wrong.
    #[error("this is not a prepared map, expected a file that `keyway prepare` has written")]
    Magic,
    /// Written by another version of the format, or for another corner rule.
    #[error(
        "the prepared map has format {version} and corner rule {corners}, expected 1 and 0; prepare the map again"
    )]
    Version {
        /// The version in the file.
        version: u32,
        /// The corner rule in the file.
        corners: u32,
    },
    /// The bytes are truncated, or have trailing data.
    #[error("the prepared map has {found} bytes, expected {expected}; prepare the map again")]
    Length {
        /// Bytes in the file.
        found: u64,
        /// Bytes according to the header.
        expected: u64,
    },
    /// The checksum does not match.
    #[error("the prepared map is damaged: its checksum is wrong; prepare the map again")]
    Checksum,
    /// The blocked cells differ.
    #[error(
        "the preparation was made for another map, clearance or treatment of unknown cells; \
         prepare this map with these settings"
    )]
    OtherMap,
    /// The checksum matches, but the content is inconsistent.
    #[error("the prepared map is inconsistent at {part} {index}; prepare the map again")]
    Content {
        /// The affected table.
        part: &'static str,
        /// The index in this table.
        index: usize,
    },
}

impl Prepared {
    /// Serialises the preparation; the same map gives the same bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let Labels { first, entries, hops } = &self.labels;
        let (n, m) = (self.nodes.len(), entries.len());
        let mut bytes = Vec::with_capacity(HEADER_BYTES + 8 * n + 12 * m + CHECKSUM_BYTES);
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(CORNERS_ARE_NOT_CUT.to_le_bytes());
        bytes.extend(self.fingerprint.to_le_bytes());
        bytes.extend(self.edges.to_le_bytes());
        bytes.extend((n as u32).to_le_bytes());
        bytes.extend((m as u32).to_le_bytes());
        bytes.extend(inverse(&self.nodes).iter().flat_map(|number| number.to_le_bytes()));
        bytes.extend(first.windows(2).flat_map(|pair| (pair[1] - pair[0]).to_le_bytes()));
        bytes.extend(entries.iter().flat_map(|entry| entry.0.to_le_bytes()));
        bytes.extend(hops.iter().flat_map(|hop| hop.0.to_le_bytes()));
        bytes.extend(checksum(&bytes).to_le_bytes());
        bytes
    }

    /// Deserialises the preparation of `map` from `bytes`.
    ///
    /// # Errors
    /// Returns an error if the bytes are incomplete, or are not a preparation of this map's
    /// blocked cells. No input makes it panic or take more memory than the file's size allows. The
    /// checksum protects against accidents only; forged bytes with a correct one may pass, and
    /// then give wrong paths.
    pub fn from_bytes(bytes: &[u8], map: &SearchMap) -> Result<Self, PreparedFormatError> {
        let head = Head::read(bytes)?;
        if head.fingerprint != map.fingerprint() {
            return Err(PreparedFormatError::OtherMap);
        }
        let corners = Corners::new(map);
        let (order, rest) = bytes[HEADER_BYTES..].split_at(4 * head.nodes);
        let (lengths, rest) = rest.split_at(4 * head.nodes);
        let (entries, hops) = rest.split_at(8 * head.entries);
        let order = checked_order(&numbers(order), corners.count())?;
        let all: Vec<Cell> = corners.iter().collect();
        let cells: Vec<Cell> = order.iter().map(|&corner| all[corner as usize]).collect();
        let words = entries.chunks_exact(8).map(|bytes| Entry(u64_at(bytes, 0)));
        let hops = &hops[..4 * head.entries];
        let labels = Labels {
            first: checked_first(&numbers(lengths), head.entries)?,
            entries: words.collect(),
            hops: numbers(hops).into_iter().map(Hop).collect(),
        };
        labels.check(&cells).map_err(|index| content("label entry", index))?;
        let diagonals = map.diagonal_events();
        let (fingerprint, edges, nodes) = (head.fingerprint, head.edges, inverse(&order));
        Ok(Self { fingerprint, corners, diagonals, edges, nodes, cells, labels })
    }
}

/// The content of the header, once the length and the checksum are verified.
struct Head {
    fingerprint: u64,
    edges: u64,
    nodes: usize,
    entries: usize,
}

impl Head {
    fn read(bytes: &[u8]) -> Result<Self, PreparedFormatError> {
        if !bytes.starts_with(&MAGIC) {
            return Err(PreparedFormatError::Magic);
        }
        let found = bytes.len() as u64;
        if bytes.len() < HEADER_BYTES + CHECKSUM_BYTES {
            let expected = (HEADER_BYTES + CHECKSUM_BYTES) as u64;
            return Err(PreparedFormatError::Length { found, expected });
        }
        let (version, corners) = (u32_at(bytes, 8), u32_at(bytes, 12));
        if (version, corners) != (VERSION, CORNERS_ARE_NOT_CUT) {
            return Err(PreparedFormatError::Version { version, corners });
        }
        let (nodes, entries) = (u32_at(bytes, 32), u32_at(bytes, 36));
        let tables = 8 * u64::from(nodes) + 12 * u64::from(entries);
        let expected = (HEADER_BYTES + CHECKSUM_BYTES) as u64 + tables;
        if found != expected {
            return Err(PreparedFormatError::Length { found, expected });
        }
        let content = bytes.len() - CHECKSUM_BYTES;
        if checksum(&bytes[..content]) != u64_at(bytes, content) {
            return Err(PreparedFormatError::Checksum);
        }
        let (fingerprint, edges) = (u64_at(bytes, 16), u64_at(bytes, 24));
        Ok(Self { fingerprint, edges, nodes: nodes as usize, entries: entries as usize })
    }
}

impl Labels {
    /// Checks that queries can rely on the tables, whatever their source: each label ends with its
    /// own node, and every hop leads nearer to its hub, to the cell of the node it names. `first`
    /// must be ascending and end with the number of entries. Otherwise the error is the index of a
    /// faulty entry.
    fn check(&self, cells: &[Cell]) -> Result<(), usize> {
        let mut owners = vec![0; self.entries.len()];
        for node in 0..cells.len() {
            owners[self.first[node] as usize..self.first[node + 1] as usize].fill(node as u32);
        }
        for (place, (entry, hop)) in self.entries.iter().zip(&self.hops).enumerate() {
            let node = owners[place];
            let is_last = place + 1 == self.first[node as usize + 1] as usize;
            let is_own = entry.hub() == node && entry.key() == 0 && hop.next() == place;
            let ascends = is_last || entry.hub() < self.entries[place + 1].hub();
            let is_right =
                if is_last { is_own } else { ascends && self.leads_on(place, &owners, cells) };
            if !is_right {
                return Err(place);
            }
        }
        Ok(())
    }

    fn leads_on(&self, place: usize, owners: &[u32], cells: &[Cell]) -> bool {
        let (entry, hop) = (self.entries[place], self.hops[place]);
        let Some(&after) = self.entries.get(hop.next()) else { return false };
        let (from, to) = (cells[owners[place] as usize], cells[owners[hop.next()] as usize]);
        let leg = Cost::octile(from.x.abs_diff(to.x), from.y.abs_diff(to.y));
        from != to
            && after.hub() == entry.hub()
            && after.cost() + leg == entry.cost()
            && octant(from, to) == hop.octant()
    }
}

/// The given numbers, if they are those of all corner cells, each once.
fn checked_order(order: &[u32], corners: usize) -> Result<Vec<u32>, PreparedFormatError> {
    if order.len() != corners {
        return Err(content("node", corners.min(order.len())));
    }
    let mut is_seen = vec![false; corners];
    for (node, &corner) in order.iter().enumerate() {
        match is_seen.get_mut(corner as usize) {
            Some(seen @ false) => *seen = true,
            _ => return Err(content("node", node)),
        }
    }
    Ok(order.to_vec())
}

/// The first entry of each label.
fn checked_first(lengths: &[u32], entries: usize) -> Result<Vec<u32>, PreparedFormatError> {
    let mut first = Vec::with_capacity(lengths.len() + 1);
    let mut sum = 0_u64;
    first.push(0);
    for (node, &length) in lengths.iter().enumerate() {
        sum += u64::from(length);
        if length == 0 || sum > entries as u64 {
            return Err(content("label", node));
        }
        first.push(sum as u32);
    }
    if sum == entries as u64 { Ok(first) } else { Err(content("label", lengths.len())) }
}

const fn content(part: &'static str, index: usize) -> PreparedFormatError {
    PreparedFormatError::Content { part, index }
}

/// 64-bit checksum over all bytes, 8 at a time; a single changed byte changes it.
fn checksum(bytes: &[u8]) -> u64 {
    let word = |chunk: &[u8]| {
        let mut padded = [0; 8];
        padded[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(padded)
    };
    bytes.chunks(8).fold(bytes.len() as u64, |hash, chunk| mix(hash, word(chunk)))
}

fn numbers(bytes: &[u8]) -> Vec<u32> {
    bytes.chunks_exact(4).map(|bytes| u32_at(bytes, 0)).collect()
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    let mut four = [0; 4];
    four.copy_from_slice(&bytes[at..at + 4]);
    u32::from_le_bytes(four)
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    let mut eight = [0; 8];
    eight.copy_from_slice(&bytes[at..at + 8]);
    u64::from_le_bytes(eight)
}

#[cfg(test)]
#[path = "format_tests.rs"]
mod tests;
