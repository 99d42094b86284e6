import { Fault, Refused, type Engine } from "../engine/engine";
import type { Names } from "../engine/types";
import type { View } from "../draw/view";
import type { State } from "../state";
import { texts } from "../texts";

/** What the panels have of the page. */
export interface Page {
    state: State;
    engine: Engine;
    names: Names;
    /** The name under which the library has the map. */
    mapName(): string;
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

/** One of the three parts of the page. */
export interface Panel {
    readonly element: HTMLElement;
    /** Start, goal, map or settings have changed. */
    refresh(): Promise<void>;
    draw(view: View): void;
    /** Another part is shown from now on. */
    leave?(): void;
}

/** What went wrong, for people; what nobody foresaw is thrown on. */
export function failure(error: unknown): string {
    if (error instanceof Refused) return error.message;
    if (error instanceof Fault) return texts.fault(error.message);
    throw error;
}

/** Questions of which only the last one counts: no other waits while one is answered. */
export class Latest {
    private isBusy = false;
    private isDue = false;

    constructor(private readonly work: () => Promise<void>) {}

    async run(): Promise<void> {
        this.isDue = true;
        if (this.isBusy) return;
        this.isBusy = true;
        try {
            while (this.isDue) {
                this.isDue = false;
                await this.work();
            }
        } finally {
            this.isBusy = false;
        }
    }
}
