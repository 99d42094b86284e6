/** The cells of the map: as they were opened, and as they were drawn since. */

import type { View } from "./draw/view";
import type { Engine, Question } from "./engine/engine";
import type { Parts } from "./engine/message";
import type { MapFacts } from "./engine/types";
import type { Drawn, Pair } from "./state";

const STATES = ["free", "occupied"] as const;

export class Ground {
    name = "";
    private cells: Uint8Array = new Uint8Array();
    /** By number of the cell. */
    private readonly drawn = new Map<number, 0 | 1>();
    private readonly pending = new Set<number>();
    private isDue = false;

    constructor(
        private readonly view: View,
        private readonly changed: () => void,
    ) {}

    /** Opens a map; when it cannot be read, the one before stays. */
    async open(engine: Engine, name: string, parts: Parts, stop?: AbortSignal): Promise<MapFacts> {
        const answer = await engine.ask<MapFacts>({ ask: "open_map", name }, parts, stop);
        this.show(answer.head, answer.parts["cells"] ?? new Uint8Array());
        return answer.head;
    }

    /** Shows a map that the library has opened. */
    show(facts: MapFacts, cells: Uint8Array): void {
        [this.name, this.cells] = [facts.name, cells];
        this.drawn.clear();
        this.pending.clear();
        this.view.show(facts, cells);
    }

    /** All changes since the map was opened. */
    readonly edits = (): Question[] => this.questions(this.drawn.keys());

    private questions(numbers: Iterable<number>): Question[] {
        const width = this.view.facts?.width ?? 1;
        const cells: [Pair[], Pair[]] = [[], []];
        for (const number of numbers) {
            const state = this.drawn.get(number);
            if (state === undefined) continue;
            cells[state].push([number % width, Math.floor(number / width)]);
        }
        const asked = STATES.map((state, i) => ({ ask: "edit_map", cells: cells[i], state }));
        return asked.filter((_, i) => cells[i]!.length > 0);
    }

    get list(): Drawn[] {
        const width = this.view.facts?.width ?? 1;
        return [...this.drawn].map(([at, state]) => [at % width, Math.floor(at / width), state]);
    }

    /** Draws cells; those beside the map are left out. */
    draw(engine: Engine, cells: Drawn[]): void {
        const facts = this.view.facts;
        if (!facts) return;
        const changed: number[] = [];
        for (const [x, y, state] of cells) {
            if (x < 0 || y < 0 || x >= facts.width || y >= facts.height) continue;
            const number = y * facts.width + x;
            if (this.cells[number] === state) continue;
            this.cells[number] = state;
            this.drawn.set(number, state);
            this.pending.add(number);
            changed.push(number);
        }
        this.view.paintCells(changed, this.cells);
        if (changed.length > 0 && !this.isDue) {
            this.isDue = true;
            requestAnimationFrame(() => void this.tell(engine));
        }
    }

    /** Tells the library what was drawn since it was told last. */
    async tell(engine: Engine): Promise<void> {
        this.isDue = false;
        const questions = this.questions(this.pending);
        this.pending.clear();
        if (questions.length === 0) return;
        await Promise.all(questions.map((question) => engine.ask(question)));
        this.changed();
    }

    /** Draws all cells in the colours of now. */
    repaint(): void {
        void this.view.paint(this.cells);
    }

    /** The middle of a free cell near a place of the map, with free cells around as far as that. */
    freeNear(share: number, radius_m: number): Pair {
        const { width, height, resolution_m } = this.view.facts!;
        const [low, high] = this.view.knownCells;
        const around = Math.min(20, Math.max(0, Math.ceil(radius_m / resolution_m - 0.5)));
        const isFree = (x: number, y: number) => {
            for (let dy = -around; dy <= around; dy++) {
                for (let dx = -around; dx <= around; dx++) {
                    const [column, row] = [x + dx, y + dy];
                    const isInside = column >= 0 && row >= 0 && column < width && row < height;
                    if (!isInside || this.cells[row * width + column] !== 0) return false;
                }
            }
            return true;
        };
        const size = [width, height];
        const wanted = [0, 1].map((i) => {
            const at = Math.round(low[i]! + share * (high[i]! - 1 - low[i]!));
            return Math.min(size[i]! - 1, Math.max(0, at));
        });
        const step = Math.max(1, Math.round(Math.max(width, height) / 256));
        let [best, least]: [Pair, number] = [[wanted[0]!, wanted[1]!], Infinity];
        for (let y = 0; y < height; y += step) {
            for (let x = 0; x < width; x += step) {
                const distance = Math.hypot(x - wanted[0]!, y - wanted[1]!);
                if (distance < least && isFree(x, y)) [best, least] = [[x, y], distance];
            }
        }
        return this.view.centre(best);
    }
}
