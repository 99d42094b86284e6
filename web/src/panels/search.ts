/** Searches, event by event: one, or up to four side by side. */

import { Refused } from "../engine/engine";
import { integers } from "../engine/message";
import type { SearchReport } from "../engine/types";
import { EXPANDED, GENERATED, Ink, REPARENTED } from "../draw/ink";
import type { View } from "../draw/view";
import type { Pair } from "../state";
import { texts } from "../texts";
import { button, check, choice, legend, named, Player, slider, table } from "./controls";
import { failure, Latest, type Page, type Panel } from "./panel";
import { pairs } from "./plan";

/** A search that plays at the usual speed takes about so many frames. */
const FRAMES = 300;

/** A search of one planner. */
interface Found {
    planner: string;
    report: SearchReport | null;
    why: string | null;
    events: Int32Array;
    path: Pair[];
    shortest: Pair[];
}

export class SearchPanel implements Panel {
    readonly element = document.createElement("div");
    readonly hasEnds = true;
    private readonly result = document.createElement("div");
    private readonly slider = slider(texts.step, (shown) => this.showFirst(shown));
    private readonly player: Player = new Player(texts, () => {
        this.back.stop();
        return this.play(1);
    });
    private readonly back = new Player({ play: texts.playBack, pause: texts.pause }, () => {
        this.player.stop();
        return this.play(-1);
    });
    private found: Found[] = [];
    private inks: Ink[] = [];
    private shown = 0;
    private speed = 1;
    private readonly latest = new Latest((stop) => this.search(stop));

    constructor(private readonly page: Page) {
        const { state, names } = page;
        const none = [["", texts.nothing]] as const;
        const set = (change: () => void) => {
            change();
            page.changed();
        };
        const beside = texts.beside.map((label, i) =>
            choice(label, [...none, ...named(names.planners)], state.beside[i] ?? "", (name) =>
                set(
                    () =>
                        (state.beside = texts.beside.map((_, other) =>
                            other === i ? name : (state.beside[other] ?? ""),
                        )),
                ),
            ),
        );
        const speeds = Object.entries(texts.speeds);
        this.element.append(
            choice(texts.planner, named(names.planners), state.planner, (name) =>
                set(() => (state.planner = name)),
            ),
            ...beside,
            check(texts.shortest, state.shortest, (shown) => set(() => (state.shortest = shown))),
            this.slider.element,
            this.player.button,
            this.back.button,
            button(texts.stepBack, () => this.showFirst(this.shown - 1)),
            button(texts.stepForward, () => this.showFirst(this.shown + 1)),
            choice(texts.speed, speeds, "1", (speed) => (this.speed = Number(speed))),
            this.result,
            legend(Object.entries(texts.search.legend)),
        );
    }

    get panes(): number {
        return this.planners.length;
    }

    private get planners(): string[] {
        const { planner, beside } = this.page.state;
        return [planner, ...beside.filter((name) => name !== "")];
    }

    refresh(): Promise<void> {
        return this.latest.run();
    }

    leave(): void {
        this.latest.stop();
        this.pause();
    }

    private pause(): void {
        this.player.stop();
        this.back.stop();
    }

    private async search(stop: AbortSignal): Promise<void> {
        const { say, working } = this.page;
        this.pause();
        const { planners } = this;
        try {
            this.found = await working(stop, async (signal) => {
                const all: Found[] = [];
                for (const planner of planners) {
                    const asked = this.searchWith(planner, signal);
                    // A planner that cannot search here is one more picture.
                    const found = planners.length === 1 ? asked : asked.catch(notFound(planner));
                    all.push(await found);
                }
                return all;
            });
            const costs = this.found.map(({ planner, report, why }) => {
                const cost = `${report?.cost_cells?.toFixed(2)} ${texts.search.cells}`;
                const text = why ?? `${texts.search.cost}: ${cost}`;
                return planners.length > 1 ? `${planner}: ${text}` : text;
            });
            const left = this.found.map(({ report }) => report?.left_out ?? 0);
            const most = Math.max(...left);
            say(this, [...costs, ...(most > 0 ? [texts.search.leftOut(most)] : [])].join("; "));
        } catch (error) {
            this.found = [];
            say(this, failure(error));
        }
        this.inks = [];
        this.showFirst(this.count);
    }

    private async searchWith(planner: string, stop: AbortSignal): Promise<Found> {
        const { engine, state } = this.page;
        const { radius_m, start, goal, shortest } = state;
        const question = { ask: "search", planner, radius_m, start, goal, with_shortest: shortest };
        const { head, parts } = await engine.ask<SearchReport>(question, {}, stop);
        const cells = integers(parts["path"]);
        const path = Array.from({ length: cells.length / 2 }, (_, i): Pair => [
            cells[2 * i]!,
            cells[2 * i + 1]!,
        ]);
        const events = integers(parts["events"]);
        return {
            planner,
            report: head,
            why: head.why,
            events,
            path,
            shortest: pairs(parts["shortest"]),
        };
    }

    /** Events of the longest search. */
    private get count(): number {
        return Math.max(0, ...this.found.map(({ report }) => report?.events ?? 0));
    }

    private play(direction: 1 | -1): boolean {
        const end = direction > 0 ? this.count : 0;
        const from = this.shown === end ? this.count - end : this.shown;
        const by = Math.max(1, Math.round((this.speed * this.count) / FRAMES));
        this.showFirst(from + direction * by);
        return this.shown !== end;
    }

    private showFirst(shown: number): void {
        this.shown = Math.min(this.count, Math.max(0, shown));
        this.slider.set(this.shown, this.count);
        for (const ink of this.inks) ink.show(Math.min(this.shown, ink.count));
        this.page.redraw();
        this.showCounts();
    }

    /** From the pictures of the searches, which count what they show. */
    private showCounts(): void {
        const words = texts.search;
        const counts = (kind: number) => this.inks.map((ink) => String(ink.counts[kind]));
        const costs = this.found.map(({ report }) => {
            const cost = report?.cost_cells;
            return cost == null ? "-" : cost.toFixed(2);
        });
        const header = this.found.length > 1 ? ["", ...this.found.map((it) => it.planner)] : [];
        if (this.found.length === 0) this.result.replaceChildren();
        else {
            this.result.replaceChildren(
                table(header, [
                    [words.expanded, ...counts(EXPANDED)],
                    [words.generated, ...counts(GENERATED)],
                    [words.reparented, ...counts(REPARENTED)],
                    [words.costInCells, ...costs],
                ]),
            );
        }
    }

    draw(view: View, pane: number): void {
        if (this.inks.length !== this.found.length) {
            this.inks = this.found.map(({ events }) => new Ink(events, view));
        }
        const [found, ink] = [this.found[pane], this.inks[pane]];
        if (!found || !ink) return;
        ink.show(Math.min(this.shown, ink.count));
        ink.draw(view);
        view.line(found.shortest, view.colors.shortest, 2, [1, 4]);
        if (this.shown >= ink.count) {
            const line = found.path.map((cell) => view.centre(cell));
            view.line(line, view.colors.smoothed, 3);
        }
        if (this.found.length > 1) view.title(found.planner, view.colors.smoothed);
        if (pane === this.found.length - 1) this.showCounts();
    }

    /** The colours have changed. */
    repaint(): void {
        this.inks = [];
    }
}

/** A search that was refused. */
const notFound =
    (planner: string) =>
    (error: unknown): Found => {
        if (!(error instanceof Refused)) throw error;
        const events = new Int32Array();
        return { planner, report: null, why: error.message, events, path: [], shortest: [] };
    };
