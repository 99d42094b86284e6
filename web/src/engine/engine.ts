/** Asks the library, and tells it again what it has to know when its thread was stopped. */

import { fromBytes, toBytes, type Message, type Parts } from "./message";
import type { Failure } from "./types";
import type { Answered, Asked } from "./worker";

/** The library refused a question: its message is for people. */
export class Refused extends Error {
    constructor(readonly failure: Failure["error"]) {
        super(failure.message);
    }
}

/** The library broke down, as where a browser has no more memory for it; it starts anew. */
export class Fault extends Error {}

/** The question was stopped from the page. */
export class Stopped extends Error {}

interface Waiting {
    message: Message;
    resolve(answer: Message): void;
    reject(error: Error): void;
}

export interface Answer<Head> {
    head: Head;
    parts: Parts;
}

export interface Question {
    ask: string;
    [field: string]: unknown;
}

export class Engine {
    private worker = this.start();
    /** In the order in which they were asked: the library works at the first one. */
    private waiting = new Map<number, Waiting>();
    private next = 0;
    /** The question by which the map was opened. */
    opened: Message | null = null;

    /** `edits` are all changes of the map since it was opened. */
    constructor(private readonly edits: () => Question[]) {}

    private start(): Worker {
        const worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
        worker.onmessage = ({ data }: MessageEvent<Answered>) => {
            if ("fault" in data) this.restart(data.id, new Fault(data.fault));
            else {
                this.waiting.get(data.id)?.resolve(fromBytes(data.answer));
                this.waiting.delete(data.id);
            }
        };
        worker.onerror = (event) => {
            const [first] = this.waiting.keys();
            this.restart(first, new Fault(event.message || "it was not loaded"));
        };
        return worker;
    }

    /** The answer to a question; `stop` ends it. */
    async ask<Head>(
        question: Question,
        parts: Parts = {},
        stop?: AbortSignal,
    ): Promise<Answer<Head>> {
        const message = { head: JSON.stringify(question), parts };
        const answer = await this.answer<Head>(message, stop);
        if (question.ask.startsWith("open_")) this.opened = message;
        return answer;
    }

    /** Opens again what was open once. */
    async reopen<Head>(opened: Message): Promise<Answer<Head>> {
        const answer = await this.answer<Head>(opened);
        this.opened = opened;
        return answer;
    }

    private async answer<Head>(message: Message, stop?: AbortSignal): Promise<Answer<Head>> {
        const answer = await this.send(message, stop);
        const head = JSON.parse(answer.head) as Head & Partial<Failure>;
        if (head.error) throw new Refused(head.error);
        return { head, parts: answer.parts };
    }

    private send(message: Message, stop?: AbortSignal): Promise<Message> {
        if (stop?.aborted) return Promise.reject(new Stopped("stopped"));
        const id = this.next++;
        return new Promise((resolve, reject) => {
            this.waiting.set(id, { message, resolve, reject });
            this.post(id, message);
            stop?.addEventListener("abort", () => {
                if (this.waiting.has(id)) this.restart(id, new Stopped("stopped"));
            });
        });
    }

    private post(id: number, message: Message): void {
        const asked: Asked = { id, question: toBytes(message) };
        this.worker.postMessage(asked);
    }

    /** Gives up one question; the others are asked again. */
    private restart(id: number | undefined, reason: Error): void {
        this.worker.terminate();
        this.worker = this.start();
        const given = id === undefined ? undefined : this.waiting.get(id);
        if (id !== undefined) this.waiting.delete(id);
        const edits = this.edits().map((edit) => ({ head: JSON.stringify(edit), parts: {} }));
        for (const message of this.opened ? [this.opened, ...edits] : []) {
            this.post(this.next++, message);
        }
        for (const [other, { message }] of this.waiting) this.post(other, message);
        given?.reject(reason);
    }
}
