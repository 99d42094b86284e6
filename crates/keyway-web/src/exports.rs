//! The functions of the WebAssembly module. A page writes a question to the address returned by
//! [`room`], calls [`ask`], and reads the answer at the address it returns.

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

/// Allocates memory for a question and returns its address.
#[expect(unsafe_code, reason = "an exported name is unsafe to give, and this one is given once")]
#[unsafe(no_mangle)]
pub(crate) extern "C" fn room(bytes: usize) -> usize {
    EXCHANGE.with_borrow_mut(|exchange| {
        exchange.question = vec![0; bytes];
        exchange.question.as_mut_ptr().addr()
    })
}

/// Answers the question and returns the address of the answer.
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

/// Returns the number of bytes of the answer.
#[expect(unsafe_code, reason = "an exported name is unsafe to give, and this one is given once")]
#[unsafe(no_mangle)]
pub(crate) extern "C" fn answer_bytes() -> usize {
    EXCHANGE.with_borrow(|exchange| exchange.answer.len())
}
