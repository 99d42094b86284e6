//! Progress of a measurement: a bar on a terminal, nothing elsewhere.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use keyway_lab::progress::Progress as LabProgress;
use std::fmt::Display;
use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// Progress bar: answered queries of all files read so far, and finished files.
pub(crate) struct Progress {
    bar: ProgressBar,
    files: usize,
    finished_files: AtomicUsize,
}

impl Progress {
    /// A bar over files, on the standard error.
    ///
    /// It stays hidden until answers are expected.
    pub(crate) fn over_files(files: usize) -> Self {
        Self::over_files_on(target(), files)
    }

    fn over_files_on(target: ProgressDrawTarget, files: usize) -> Self {
        let bar = bar(target, "{bar:30} {pos}/{len} answers, {msg}, {elapsed}");
        // Hidden at first: a bar of length 0 would look full.
        let bar = bar.with_message(format!("0/{files} files"));
        Self { bar, files, finished_files: AtomicUsize::new(0) }
    }

    /// A bar over runs: every answer is a run.
    pub(crate) fn over_runs(runs: usize) -> Self {
        let bar = bar(target(), "{bar:30} {pos}/{len} runs, {elapsed}, {eta} left");
        bar.inc_length(runs as u64);
        // Runs may take minutes: the elapsed time keeps counting in between.
        bar.enable_steady_tick(Duration::from_secs(1));
        Self { bar, files: 0, finished_files: AtomicUsize::new(0) }
    }

    /// A bar over maps: every answer is the result of all methods on one map.
    pub(crate) fn over_maps() -> Self {
        let bar = bar(target(), "{bar:30} {pos}/{len} maps, {elapsed}, {eta} left");
        Self { bar, files: 0, finished_files: AtomicUsize::new(0) }
    }

    pub(crate) fn finished_file(&self) {
        let finished = self.finished_files.fetch_add(1, Ordering::Relaxed) + 1;
        self.bar.set_message(format!("{finished}/{} files", self.files));
    }
}

impl LabProgress for Progress {
    fn expect(&self, answers: usize) {
        self.bar.inc_length(answers as u64);
    }

    fn answered(&self) -> ControlFlow<()> {
        self.bar.inc(1);
        ControlFlow::Continue(())
    }
}

/// Progress bar of a batch. It appears as soon as the number of runs is known.
#[derive(Default)]
pub(crate) struct RunBar(OnceLock<Progress>);

impl LabProgress for RunBar {
    fn expect(&self, answers: usize) {
        self.0.get_or_init(|| Progress::over_runs(answers));
    }

    fn answered(&self) -> ControlFlow<()> {
        self.0.get().map_or(ControlFlow::Continue(()), Progress::answered)
    }

    fn warned(&self, warning: &dyn Display) {
        crate::stdout::warn(warning);
    }
}

fn target() -> ProgressDrawTarget {
    if std::io::stderr().is_terminal() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    }
}

/// Progress bar over drawn pictures. The caller clears it.
pub(crate) fn picture_bar() -> ProgressBar {
    bar(target(), "{bar:30} {pos}/{len} pictures, {elapsed}")
}

fn bar(target: ProgressDrawTarget, template: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(0), target);
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

impl Drop for Progress {
    /// Clears the bar, also after an error.
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use indicatif::TermLike;
    use std::io::Result;
    use std::sync::{Arc, Mutex};

    /// A terminal that keeps everything written to it.
    #[derive(Clone, Debug, Default)]
    struct Paper(Arc<Mutex<String>>);

    impl TermLike for Paper {
        fn width(&self) -> u16 {
            120
        }
        fn move_cursor_up(&self, _: usize) -> Result<()> {
            Ok(())
        }
        fn move_cursor_down(&self, _: usize) -> Result<()> {
            Ok(())
        }
        fn move_cursor_right(&self, _: usize) -> Result<()> {
            Ok(())
        }
        fn move_cursor_left(&self, _: usize) -> Result<()> {
            Ok(())
        }
        fn write_line(&self, text: &str) -> Result<()> {
            self.write_str(text)
        }
        fn write_str(&self, text: &str) -> Result<()> {
            self.0.lock().unwrap().push_str(text);
            Ok(())
        }
        fn clear_line(&self) -> Result<()> {
            Ok(())
        }
        fn flush(&self) -> Result<()> {
            Ok(())
        }
    }

    #[test]
    fn no_bar_is_seen_before_there_is_something_to_wait_for() {
        let paper = Paper::default();
        let target = ProgressDrawTarget::term_like(Box::new(paper.clone()));
        let progress = Progress::over_files_on(target, 2);
        progress.expect(4);
        assert!(progress.answered().is_continue());
        drop(progress);
        let text = paper.0.lock().unwrap();
        assert!(text.contains("0/4 answers, 0/2 files") && !text.contains("0/0"), "{text}");
    }
}
