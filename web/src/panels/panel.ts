import { Fault, Refused, Stopped, type Engine } from "../engine/engine";
import type { MapFacts, Names, SceneFacts } from "../engine/types";
import type { View } from "../draw/view";
import type { Pair, State } from "../state";
import { texts } from "../texts";
import { button } from "./controls";

/** The page, as far as the panels know it. */
export interface Page {
    state: State;
    engine: Engine;
    names: Names;
    /** The name under which the library has the map. */
    mapName(): string;
    /** The scene that is open; `null` for one that is drawn. */
    scene: SceneFacts | null;
    /** Shows a map that the library has opened. */
    showMap(facts: MapFacts, cells: Uint8Array, name: string): void;
    /** The map of a claim stays in all parts. */
    keepMap(): void;
    /**
     * Shows that the page works, with a button that stops it, until the work is done; `outer` stops
     * it, too. `text` is what is said meanwhile.
     */
    working<T>(
        outer: AbortSignal | null,
        work: (stop: AbortSignal) => Promise<T>,
        text?: string,
    ): Promise<T>;
    /** Shows the surroundings of a place, so many metres wide. */
    lookAt(place: Pair, width_m: number): void;
    /** Something that the panel shows has changed: the picture is drawn again. */
    redraw(): void;
    /** The state was changed by the panel. */
    changed(): void;
    /**
     * A line about what is shown or what went wrong, which screen readers read out; only that of
     * the part that is shown is heard.
     */
    say(panel: Panel, text: string): void;
}

/** One of the parts of the page. */
export interface Panel {
    readonly element: HTMLElement;
    /** Start, goal, map or settings have changed. */
    refresh(): Promise<void>;
    /** Draws one of the pictures side by side, or the only one. */
    draw(view: View, pane: number): void;
    /** The colours have changed. */
    repaint?(): void;
    /** In how many pictures side by side it is drawn; one, unless it says otherwise. */
    readonly panes?: number;
    /** True if start, goal and obstacles can be moved in it. */
    readonly hasEnds: boolean;
    /** Tables that need the whole width of the page. */
    readonly wide?: HTMLElement;
    /** Another part is shown from now on. */
    leave?(): void;
}

/** The fault, for people; one that nobody foresaw is thrown on. */
export function failure(error: unknown): string {
    if (error instanceof Refused) return error.message;
    const isStopped = error instanceof DOMException && error.name === "AbortError";
    if (error instanceof Stopped || isStopped) return texts.stopped;
    if (error instanceof Fault) return texts.fault(error.message);
    throw error;
}

/** After so long, work that no longer counts is given up rather than waited for. */
const PATIENCE_MS = 1000;

/** Questions of which only the last one counts: no other waits while one is answered. */
export class Latest {
    private busy: { stop: AbortController; since_ms: number } | null = null;
    private isDue = false;

    /** `work` asks whether something newer is due before it asks for more. */
    constructor(private readonly work: (stop: AbortSignal) => Promise<void>) {}

    get isOver(): boolean {
        return this.isDue;
    }

    /** Gives up what is answered just now. */
    stop(): void {
        this.isDue = false;
        this.busy?.stop.abort();
    }

    async run(): Promise<void> {
        this.isDue = true;
        if (this.busy) {
            if (performance.now() - this.busy.since_ms > PATIENCE_MS) this.busy.stop.abort();
            return;
        }
        try {
            while (this.isDue) {
                this.isDue = false;
                this.busy = { stop: new AbortController(), since_ms: performance.now() };
                await this.work(this.busy.stop.signal);
            }
        } finally {
            this.busy = null;
        }
    }
}

/** Work that a button starts; only the last one counts. */
export class Job {
    readonly button: HTMLButtonElement;
    private running: AbortController | null = null;

    constructor(
        label: string,
        private readonly work: (stop: AbortSignal) => Promise<void>,
        private readonly failed: (text: string) => void,
    ) {
        this.button = button(label, () => void this.run());
    }

    /** Gives up what is done just now; another one can begin unless there is nothing to do. */
    stop(isEmpty = false): void {
        this.running?.abort();
        [this.button.disabled, this.running] = [isEmpty, null];
    }

    private async run(): Promise<void> {
        const running = new AbortController();
        this.running = running;
        this.button.disabled = true;
        try {
            await this.work(running.signal);
        } catch (error) {
            if (this.running === running) this.failed(failure(error));
        } finally {
            if (this.running === running) [this.button.disabled, this.running] = [false, null];
        }
    }
}
