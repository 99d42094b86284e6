//! How far a measurement has come: a bar on a terminal, nothing elsewhere.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// Answers that were given, of those of all files read so far; and files.
pub(crate) struct Progress {
    bar: ProgressBar,
    files: usize,
    finished_files: AtomicUsize,
}

impl Progress {
    /// On the standard error, and not in the way of the report.
    ///
    /// The bar is not seen until somebody expects answers.
    pub(crate) fn over_files(files: usize) -> Self {
        let bar = bar("{bar:30} {pos}/{len} answers, {msg}, {elapsed}");
        // Not shown yet: a bar without answers to wait for would look full.
        let bar = bar.with_message(format!("0/{files} files"));
        Self { bar, files, finished_files: AtomicUsize::new(0) }
    }

    /// The same where every answer is a run of its own.
    pub(crate) fn over_runs(runs: usize) -> Self {
        let bar = bar("{bar:30} {pos}/{len} runs, {elapsed}");
        bar.inc_length(runs as u64);
        // Runs may take minutes: the clock goes on meanwhile.
        bar.enable_steady_tick(Duration::from_secs(1));
        Self { bar, files: 0, finished_files: AtomicUsize::new(0) }
    }

    pub(crate) fn expect(&self, answers: usize) {
        self.bar.inc_length(answers as u64);
    }

    pub(crate) fn answered(&self) {
        self.bar.inc(1);
    }

    pub(crate) fn finished_file(&self) {
        let finished = self.finished_files.fetch_add(1, Ordering::Relaxed) + 1;
        self.bar.set_message(format!("{finished}/{} files", self.files));
    }
}

fn bar(template: &str) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(0);
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

impl Drop for Progress {
    /// Also after an error the terminal is left clean.
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
