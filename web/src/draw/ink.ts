/** A search as a picture of the map, to which each event adds a cell or a line of cells. */

import type { Pair } from "../state";
import { texts } from "../texts";
import { word, type View } from "./view";

/** Numbers of an event: kind, side, column and row of the node, column and row of the other end. */
export const NUMBERS = 6;
export const [EXPANDED, GENERATED, REPARENTED, SCANNED, LINKED, MET] = [0, 1, 2, 3, 4, 5];
/** Contents of a pixel; the higher one stays. */
const [SCANNED_INK, GENERATED_INK, EXPANDED_INK, BACK_INK] = [1, 2, 3, 4];
/** Fewer nodes that lie apart are drawn as dots, which are seen on a large map, too. */
const MOST_DOTS = 5000;
/** Larger maps are shown coarser. */
const MOST_PIXELS = 1 << 22;

export class Ink {
    readonly canvas = document.createElement("canvas");
    private readonly context: CanvasRenderingContext2D;
    private readonly image: ImageData;
    private readonly pixels: Uint32Array;
    private readonly inks: Uint8Array;
    private readonly words: number[];
    /** Cells of a pixel, along an axis. */
    private readonly cells: number;
    private shown = 0;
    private dirty: [number, number, number, number] | null = null;
    /** Links of a tree, as far as it is shown: the places in the events. */
    links: number[] = [];
    met: Pair | null = null;
    /** Nodes that were expanded: the places in the events. */
    private nodes: number[] = [];
    /** True if nodes lie apart: jump points, and those of a tree. */
    private isSparse = false;
    /** The number of events of each kind that are shown. */
    counts: number[] = [];

    constructor(
        private readonly events: Int32Array,
        view: View,
    ) {
        const { width, height } = view.facts ?? { width: 1, height: 1 };
        this.cells = Math.max(1, Math.ceil(Math.sqrt((width * height) / MOST_PIXELS)));
        this.canvas.width = Math.ceil(width / this.cells);
        this.canvas.height = Math.ceil(height / this.cells);
        const context = this.canvas.getContext("2d");
        if (!context) throw new Error(texts.noCanvas);
        this.context = context;
        this.image = context.createImageData(this.canvas.width, this.canvas.height);
        this.pixels = new Uint32Array(this.image.data.buffer);
        this.inks = new Uint8Array(this.pixels.length);
        const { scanned, generated, expanded, expandedback } = view.colors;
        const colors = [scanned, generated, expanded, expandedback];
        this.words = [0, ...colors.map((color) => word(context, color))];
        this.reset();
    }

    get count(): number {
        return this.events.length / NUMBERS;
    }

    /** Shows the first events. */
    show(first: number): void {
        if (first < this.shown) this.reset();
        for (let i = this.shown; i < first; i++) this.add(i * NUMBERS);
        this.shown = first;
        if (!this.dirty) return;
        const [x, y, x2, y2] = this.dirty;
        this.context.putImageData(this.image, 0, 0, x, y, x2 - x + 1, y2 - y + 1);
        this.dirty = null;
    }

    private reset(): void {
        this.pixels.fill(0);
        this.inks.fill(0);
        this.dirty = [0, 0, this.canvas.width - 1, this.canvas.height - 1];
        [this.shown, this.links, this.met, this.counts] = [0, [], null, [0, 0, 0, 0, 0, 0]];
        [this.nodes, this.isSparse] = [[], false];
    }

    private add(at: number): void {
        const { events } = this;
        const [kind, side, x, y] = [events[at]!, events[at + 1]!, events[at + 2]!, events[at + 3]!];
        this.counts[kind]!++;
        this.isSparse ||= kind === SCANNED || kind === LINKED;
        if (kind === EXPANDED) {
            this.dot(x, y, side === 1 ? BACK_INK : EXPANDED_INK);
            if (this.nodes.length <= MOST_DOTS) this.nodes.push(at);
        } else if (kind === GENERATED) this.dot(x, y, GENERATED_INK);
        else if (kind === SCANNED) this.line([x, y], [events[at + 4]!, events[at + 5]!]);
        else if (kind === LINKED) this.links.push(at);
        else if (kind === MET) this.met = [x, y];
    }

    private line([x, y]: Pair, [x2, y2]: Pair): void {
        const steps = Math.max(Math.abs(x2 - x), Math.abs(y2 - y));
        for (let i = 0; i <= steps; i++) {
            const share = steps === 0 ? 0 : i / steps;
            this.dot(
                Math.round(x + share * (x2 - x)),
                Math.round(y + share * (y2 - y)),
                SCANNED_INK,
            );
        }
    }

    private dot(column: number, row: number, ink: number): void {
        const x = Math.floor(column / this.cells);
        // Rows come from the bottom.
        const y = this.canvas.height - 1 - Math.floor(row / this.cells);
        const at = y * this.canvas.width + x;
        if (!(this.inks[at]! < ink)) return;
        this.inks[at] = ink;
        this.pixels[at] = this.words[ink]!;
        const dirty = (this.dirty ??= [x, y, x, y]);
        if (x < dirty[0]) dirty[0] = x;
        if (y < dirty[1]) dirty[1] = y;
        if (x > dirty[2]) dirty[2] = x;
        if (y > dirty[3]) dirty[3] = y;
    }

    draw(view: View): void {
        view.layer(this.canvas, this.cells);
        if (this.links.length > 0) {
            const { events } = this;
            const link = (at: number): Pair[] => [
                view.centre([events[at + 2]!, events[at + 3]!]),
                view.centre([events[at + 4]!, events[at + 5]!]),
            ];
            view.lines(this.links.map(link), view.colors.expanded, 1);
        }
        if (this.isSparse && this.nodes.length <= MOST_DOTS) this.drawNodes(view);
        if (this.met) view.disc(view.centre(this.met), 5, view.colors.goal);
    }

    private drawNodes(view: View): void {
        const { expanded, expandedback } = view.colors;
        const radius = 2.5 * (window.devicePixelRatio || 1);
        for (const at of this.nodes) {
            const place = view.centre([this.events[at + 2]!, this.events[at + 3]!]);
            view.disc(place, radius, this.events[at + 1] === 1 ? expandedback : expanded);
        }
    }
}
