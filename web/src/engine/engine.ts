/** Asks the library, and keeps what it has to be told again when its thread was stopped. */

import { fromBytes, toBytes, type Message, type Parts } from "./message";
import type { Failure } from "./types";
import type { Answered, Asked } from "./worker";

/** The library refused a question: its message is for people. */
export class Refused extends Error {
    constructor(readonly failure: Failure["error"]) {
        super(failure.message);
    }
}

/** The work was stopped from the page. */
export class Stopped extends Error {}

interface Waiting {
    resolve(answer: Message): void;
    reject(error: Error): void;
}

export interface Answer<Head> {
    head: Head;
    parts: Parts;
}

export class Engine {
    private worker = this.start();
    private waiting = new Map<number, Waiting>();
    private next = 0;
    /** What was opened and edited, in this order. */
    private told: Message[] = [];

    private start(): Worker {
        const worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
        worker.onmessage = (event: MessageEvent<Answered>) => {
            const { id, answer } = event.data;
            this.waiting.get(id)?.resolve(fromBytes(answer));
            this.waiting.delete(id);
        };
        worker.onerror = (event) => this.restart(new Error(event.message || "the library failed"));
        return worker;
    }

    /** The answer to a question; refused or stopped ones are errors. */
    async ask<Head>(head: object, parts: Parts = {}): Promise<Answer<Head>> {
        const answer = await this.send({ head: JSON.stringify(head), parts });
        const read = JSON.parse(answer.head) as Head & Partial<Failure>;
        if (read.error) throw new Refused(read.error);
        return { head: read, parts: answer.parts };
    }

    /** The same for what changes the map: it is said again after a stop. */
    async tell<Head>(
        head: { ask: string; [field: string]: unknown },
        parts: Parts = {},
    ): Promise<Answer<Head>> {
        const answer = await this.ask<Head>(head, parts);
        if (head.ask === "open_map") this.told = [];
        this.told.push({ head: JSON.stringify(head), parts });
        return answer;
    }

    /** Ends whatever the library works at; it then has the map as it was. */
    stop(): void {
        this.restart(new Stopped("stopped"));
    }

    private restart(reason: Error): void {
        this.worker.terminate();
        const waiting = [...this.waiting.values()];
        this.waiting.clear();
        this.worker = this.start();
        for (const message of this.told) void this.send(message);
        for (const one of waiting) one.reject(reason);
    }

    private send(message: Message): Promise<Message> {
        const id = this.next++;
        const asked: Asked = { id, question: toBytes(message) };
        return new Promise((resolve, reject) => {
            this.waiting.set(id, { resolve, reject });
            this.worker.postMessage(asked);
        });
    }
}
