/** The library, in a thread of its own: a question comes in as bytes, its answer goes out. */

import wasmUrl from "../keyway.wasm?url";

interface Exports {
    memory: WebAssembly.Memory;
    room(bytes: number): number;
    ask(): number;
    answer_bytes(): number;
}

export interface Asked {
    id: number;
    question: Uint8Array;
}

export interface Answered {
    id: number;
    answer: Uint8Array;
}

const instance = WebAssembly.instantiateStreaming(fetch(wasmUrl)).then(
    (loaded) => loaded.instance.exports as unknown as Exports,
);

self.onmessage = async (event: MessageEvent<Asked>) => {
    const { id, question } = event.data;
    const library = await instance;
    const at = library.room(question.length);
    new Uint8Array(library.memory.buffer, at, question.length).set(question);
    const from = library.ask();
    const answer = new Uint8Array(library.memory.buffer, from, library.answer_bytes()).slice();
    const answered: Answered = { id, answer };
    self.postMessage(answered, { transfer: [answer.buffer] });
};
