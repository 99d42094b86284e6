//! Halts of the whole process, as when a machine is suspended, or somebody sends SIGSTOP.
//!
//! The threads of `rustdds` end when a wait of theirs is interrupted, which a halt does, and when
//! they panic. They do so in silence: nothing comes any more, and nothing goes out.

use ros2_client::dds::rustdds::mio1;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Some thread of the process has panicked.
static HAS_PANICKED: AtomicBool = AtomicBool::new(false);

/// From now on threads that panic are noticed; what they say is printed as before.
pub(crate) fn notice_panics() {
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        HAS_PANICKED.store(true, Ordering::Relaxed);
        before(panic);
    }));
}

/// A thread that waits as those do, and tells when it was interrupted.
pub(super) struct Halts {
    happened: Arc<AtomicBool>,
}

impl Halts {
    /// Starts it. When it is interrupted it ends, and wakes who waits.
    pub(super) fn watch(wakes: mio1::Waker) -> io::Result<Self> {
        let happened = Arc::new(AtomicBool::new(false));
        let tells = Arc::clone(&happened);
        let mut poll = mio1::Poll::new()?;
        std::thread::Builder::new().name("halts".to_owned()).spawn(move || {
            let mut events = mio1::Events::with_capacity(1);
            while poll.poll(&mut events, None).is_ok() {}
            tells.store(true, Ordering::Relaxed);
            drop(wakes.wake());
        })?;
        Ok(Self { happened })
    }

    /// True once there was one, or a thread has panicked since the last call.
    pub(super) fn happened(&self) -> bool {
        self.happened.load(Ordering::Relaxed) || HAS_PANICKED.swap(false, Ordering::Relaxed)
    }
}
