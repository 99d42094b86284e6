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

/** An answer, or the fault after which the library has to be started anew. */
export type Answered = { id: number } & ({ answer: Uint8Array } | { fault: string });

/** Whatever the host says of the file's type. */
const instance = fetch(wasmUrl).then(async (response) => {
    if (!response.ok) throw new Error(`the library was not loaded: ${response.status}`);
    const loaded = await WebAssembly.instantiate(await response.arrayBuffer());
    return loaded.instance.exports as unknown as Exports;
});

self.onmessage = async (event: MessageEvent<Asked>) => {
    const { id, question } = event.data;
    try {
        const library = await instance;
        const at = library.room(question.length);
        new Uint8Array(library.memory.buffer, at, question.length).set(question);
        const from = library.ask();
        const answer = new Uint8Array(library.memory.buffer, from, library.answer_bytes()).slice();
        const answered: Answered = { id, answer };
        self.postMessage(answered, { transfer: [answer.buffer] });
    } catch (error) {
        const answered: Answered = { id, fault: String(error) };
        self.postMessage(answered);
    }
};
