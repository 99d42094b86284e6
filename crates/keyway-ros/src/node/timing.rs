//! Timing of the cycles, and diagnostics of the node.

use crate::messages::diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue};
use crate::pilot::{Pilot, Waits};
use std::collections::BTreeSet;
use std::fmt::Display;
use std::time::Duration;

/// Statistics of the cycles since the last diagnostics.
pub(super) struct Timing {
    period_s: f64,
    cycles: u32,
    longest: Duration,
    all: Duration,
    /// Cycles that started more than half a period late, since the start of the node.
    late: u64,
    /// The reason for a stationary robot in the last cycle, if there was one.
    waits: Option<Waits>,
}

impl Timing {
    pub(super) const fn new(period_s: f64) -> Self {
        Self {
            period_s,
            cycles: 0,
            longest: Duration::ZERO,
            all: Duration::ZERO,
            late: 0,
            waits: None,
        }
    }

    /// Cycle period \[s\].
    pub(super) const fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Records the delay of a cycle's start.
    pub(super) fn note_delay(&mut self, delay: Duration) {
        self.late += u64::from(delay.as_secs_f64() > 0.5 * self.period_s);
    }

    /// Records the duration of a cycle.
    pub(super) fn note(&mut self, taken: Duration, waits: Option<Waits>) {
        self.cycles += 1;
        self.longest = self.longest.max(taken);
        self.all += taken;
        self.waits = waits;
    }

    /// Diagnostics: the state of the robot, of its cycles since the last call, and of
    /// incompatible nodes on its topics.
    pub(super) fn diagnostics(
        &mut self,
        pilot: &Pilot,
        misfits: &BTreeSet<String>,
        now_s: f64,
    ) -> DiagnosticArray {
        let header = pilot.header(now_s);
        let status = vec![self.of_driving(pilot), self.of_cycles(), of_topics(misfits)];
        let (period_s, late) = (self.period_s, self.late);
        *self = Self { late, waits: self.waits.take(), ..Self::new(period_s) };
        DiagnosticArray { header, status }
    }

    fn of_driving(&self, pilot: &Pilot) -> DiagnosticStatus {
        let doubts = pilot.navigator().map_or(&[][..], |navigator| navigator.doubts());
        let (level, message) = match (&self.waits, doubts.first()) {
            (Some(why), _) => (DiagnosticStatus::ERROR, format!("stationary: {why}")),
            (None, Some(doubt)) => (DiagnosticStatus::WARN, doubt.to_string()),
            (None, None) if !pilot.is_active() => (DiagnosticStatus::WARN, "inactive".to_owned()),
            (None, None) if pilot.drives() => (DiagnosticStatus::OK, "driving".to_owned()),
            (None, None) => (DiagnosticStatus::OK, "no goal".to_owned()),
        };
        let mut values = Vec::new();
        if let Some(navigator) = pilot.navigator() {
            values.push(value("movers", navigator.movers().len()));
            values.push(value("routes planned", navigator.routes_planned()));
            values.push(value("recoveries", navigator.recoveries().total()));
        }
        values.extend(doubts.iter().map(|doubt| value("doubt", doubt)));
        status("keyway: driving", (level, message), values)
    }

    fn of_cycles(&self) -> DiagnosticStatus {
        let milliseconds = |time: Duration| format!("{:.2}", 1e3 * time.as_secs_f64());
        let mean = self.all / self.cycles.max(1);
        let is_slow = self.longest.as_secs_f64() > self.period_s;
        let said = if is_slow {
            (DiagnosticStatus::WARN, "a cycle took longer than its period".to_owned())
        } else {
            (DiagnosticStatus::OK, "cycles are on time".to_owned())
        };
        let values = vec![
            value("period [ms]", milliseconds(Duration::from_secs_f64(self.period_s))),
            value("mean [ms]", milliseconds(mean)),
            value("longest [ms]", milliseconds(self.longest)),
            value("began late", self.late),
        ];
        status("keyway: cycles", said, values)
    }
}

fn of_topics(misfits: &BTreeSet<String>) -> DiagnosticStatus {
    let said = match misfits.first() {
        Some(first) => (DiagnosticStatus::WARN, first.clone()),
        None => (DiagnosticStatus::OK, "other nodes on its topics are compatible".to_owned()),
    };
    let values = misfits.iter().map(|misfit| value("misfit", misfit)).collect();
    status("keyway: topics", said, values)
}

fn status(name: &str, said: (u8, String), values: Vec<KeyValue>) -> DiagnosticStatus {
    let (level, message) = said;
    DiagnosticStatus { level, name: name.to_owned(), message, hardware_id: String::new(), values }
}

fn value(key: &str, value: impl Display) -> KeyValue {
    KeyValue { key: key.to_owned(), value: value.to_string() }
}
