//! Detection of halts of the process, such as a suspended machine or SIGSTOP, and of panics in
//! network threads, after which no messages are received or sent.

use ros2_client::dds::rustdds::mio1;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// True once a thread of the process has panicked.
static HAS_PANICKED: AtomicBool = AtomicBool::new(false);

/// Starts to record panics of threads; their messages are printed as before.
pub(crate) fn notice_panics() {
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        HAS_PANICKED.store(true, Ordering::Relaxed);
        before(panic);
    }));
}

/// True once a thread has panicked.
pub(super) fn has_panicked() -> bool {
    HAS_PANICKED.load(Ordering::Relaxed)
}

/// A thread that blocks without events: a halt interrupts it.
pub(super) struct Halts {
    happened: Arc<AtomicBool>,
}

impl Halts {
    /// Starts the thread. An interruption wakes the node.
    pub(super) fn watch(wakes: mio1::Waker) -> io::Result<Self> {
        let happened = Arc::new(AtomicBool::new(false));
        let tells = Arc::clone(&happened);
        let mut poll = mio1::Poll::new()?;
        std::thread::Builder::new().name("halts".to_owned()).spawn(move || {
            let mut events = mio1::Events::with_capacity(1);
            let is_halt = |error: io::Error| error.kind() == io::ErrorKind::Interrupted;
            while poll.poll(&mut events, None).map_or_else(is_halt, |()| true) {
                tells.store(true, Ordering::Relaxed);
                drop(wakes.wake());
            }
        })?;
        Ok(Self { happened })
    }

    /// True if there was a halt since the last call.
    pub(super) fn take(&self) -> bool {
        self.happened.swap(false, Ordering::Relaxed)
    }
}
