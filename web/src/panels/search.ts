/** A search, event by event. */

import { integers } from "../engine/message";
import type { SearchReport } from "../engine/types";
import type { View } from "../draw/view";
import type { Pair } from "../state";
import { texts } from "../texts";
import { choice, facts, named, Player, slider } from "./controls";
import { failure, Latest, type Page, type Panel } from "./panel";

/** Numbers of an event: kind, side, column and row of the node, column and row of the other end. */
const NUMBERS = 6;
const [EXPANDED, GENERATED, SCANNED] = [0, 1, 3];
/** A search that plays takes about so many frames. */
const FRAMES = 300;

export class SearchPanel implements Panel {
    readonly element = document.createElement("div");
    private readonly result = document.createElement("div");
    private readonly slider = slider(texts.step, (shown) => this.showFirst(shown));
    private readonly player = new Player(texts, () => this.forward());
    private events: Int32Array = new Int32Array();
    private path: Pair[] = [];
    private report: SearchReport | null = null;
    private shown = 0;
    private readonly latest = new Latest(() => this.search());

    constructor(private readonly page: Page) {
        const { state, names } = page;
        const legend = document.createElement("ul");
        legend.className = "legend";
        for (const [name, text] of Object.entries(texts.search.legend)) {
            const item = document.createElement("li");
            const swatch = document.createElement("span");
            swatch.style.background = `var(--${name})`;
            item.append(swatch, text);
            legend.append(item);
        }
        this.element.append(
            choice(texts.planner, named(names.planners), state.planner, (name) => {
                state.planner = name;
                page.changed();
            }),
            this.slider.element,
            this.player.button,
            this.result,
            legend,
        );
    }

    refresh(): Promise<void> {
        return this.latest.run();
    }

    private async search(): Promise<void> {
        const { engine, state, say } = this.page;
        const { planner, radius_m, start, goal } = state;
        this.player.stop();
        try {
            const question = { ask: "search", planner, radius_m, start, goal };
            const { head, parts } = await engine.ask<SearchReport>(question);
            this.report = head;
            this.events = integers(parts["events"]);
            const cells = integers(parts["path"]);
            this.path = Array.from({ length: cells.length / 2 }, (_, i) => [
                cells[2 * i]!,
                cells[2 * i + 1]!,
            ]);
            say(
                this,
                head.why ??
                    `${texts.search.cost}: ${head.cost_cells?.toFixed(2)} ${texts.search.cells}`,
            );
        } catch (error) {
            [this.report, this.events, this.path] = [null, new Int32Array(), []];
            say(this, failure(error));
        }
        this.showFirst(this.count);
    }

    private get count(): number {
        return this.events.length / NUMBERS;
    }

    private forward(): boolean {
        const from = this.shown >= this.count ? 0 : this.shown;
        this.showFirst(Math.min(this.count, from + Math.max(1, Math.round(this.count / FRAMES))));
        return this.shown < this.count;
    }

    private showFirst(shown: number): void {
        this.shown = shown;
        this.slider.set(shown, this.count);
        const counts = [0, 0];
        for (let i = 0; i < shown; i++) {
            const kind = this.events[i * NUMBERS]!;
            if (kind === EXPANDED || kind === GENERATED) counts[kind]!++;
        }
        const words = texts.search;
        const cost = this.report?.cost_cells;
        this.result.replaceChildren(
            facts([
                [words.expanded, String(counts[EXPANDED])],
                [words.generated, String(counts[GENERATED])],
                [words.cost, cost == null ? "-" : `${cost.toFixed(2)} ${words.cells}`],
            ]),
        );
        this.page.redraw();
    }

    draw(view: View): void {
        const { expanded, generated, scanned, smoothed } = view.colors;
        const { context } = view;
        const resolution = view.facts?.resolution_m ?? 1;
        const side = Math.max(2, view.pixels(resolution));
        for (let i = 0; i < this.shown; i++) {
            const [kind, , x, y, x2, y2] = this.events.subarray(i * NUMBERS, (i + 1) * NUMBERS);
            const at = view.centre([x!, y!]);
            if (kind === SCANNED) view.line([at, view.centre([x2!, y2!])], scanned, 1);
            else if (kind === EXPANDED || kind === GENERATED) {
                const [px, py] = view.toScreen(at);
                context.fillStyle = kind === EXPANDED ? expanded : generated;
                context.fillRect(px - side / 2, py - side / 2, side, side);
            }
        }
        if (this.shown === this.count) {
            view.line(
                this.path.map((cell) => view.centre(cell)),
                smoothed,
                3,
            );
        }
    }
}
