//! The functions of the module of WebAssembly. A page writes a question where [`room`] says, calls
//! [`ask`], and reads the answer there.

use crate::message::Message;
use crate::page::Page;
use std::cell::RefCell;

#[derive(Default)]
struct Exchange {
    page: Page,
    question: Vec<u8>,
    answer: Vec<u8>,
}

thread_local! {
    static EXCHANGE: RefCell<Exchange> = RefCell::default();
}

/// Makes room for a question of so many bytes; returns the address of the first one.
#[expect(unsafe_code, reason = "an exported name is unsafe to give, and this one is given once")]
#[unsafe(no_mangle)]
pub(crate) extern "C" fn room(bytes: usize) -> usize {
    EXCHANGE.with_borrow_mut(|exchange| {
        exchange.question = vec![0; bytes];
        exchange.question.as_mut_ptr().addr()
    })
}

/// Answers the question; returns the address of the answer's first byte.
#[expect(unsafe_code, reason = "an exported name is unsafe to give, and this one is given once")]
#[unsafe(no_mangle)]
pub(crate) extern "C" fn ask() -> usize {
    EXCHANGE.with_borrow_mut(|exchange| {
        let question = Message::from_bytes(&std::mem::take(&mut exchange.question));
        let question = question.unwrap_or_else(|error| Message::new(error.to_string()));
        exchange.answer = exchange.page.answer(&question).to_bytes();
        exchange.answer.as_ptr().addr()
    })
}

/// The number of bytes of the answer.
#[expect(unsafe_code, reason = "an exported name is unsafe to give, and this one is given once")]
#[unsafe(no_mangle)]
pub(crate) extern "C" fn answer_bytes() -> usize {
    EXCHANGE.with_borrow(|exchange| exchange.answer.len())
}
