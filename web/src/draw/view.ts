/** The canvas: places of the world on the screen, and back. */

import type { MapFacts } from "../engine/types";
import type { Pair } from "../state";
import { texts } from "../texts";
import { SvgContext } from "./svg";

export interface Colors {
    ground: string;
    wall: string;
    unknown: string;
    line: string;
    smoothed: string;
    start: string;
    goal: string;
    expanded: string;
    generated: string;
    scanned: string;
    robot: string;
    hit: string;
    sensed: string;
    disc: string;
    mover: string;
    expandedback: string;
    shortest: string;
    believed: string;
    chosen: string;
    runnerup: string;
    admissible: string;
    touching: string;
    refused: string;
    /** Colours of methods, stacks and robots that are shown together. */
    series: string[];
}

/** Names of the colours in the style sheet. */
const COLORS = [
    ...["ground", "wall", "unknown", "line", "smoothed", "start", "goal", "expanded", "generated"],
    ...[
        "scanned",
        "robot",
        "hit",
        "sensed",
        "disc",
        "mover",
        "expandedback",
        "shortest",
        "believed",
        "chosen",
    ],
    ...["runnerup", "admissible", "touching", "refused"],
];
export const SERIES = 8;
/** So many cells are painted at once: more would freeze the page. */
const STRIP_CELLS = 1 << 21;

export class View {
    context: CanvasRenderingContext2D;
    private scale = 1;
    /** The scale at which the whole map is shown. */
    private whole = 1;
    private middle: Pair = [0, 0];
    private picture: HTMLCanvasElement | null = null;
    /** Lowest and highest column and row of what is not unknown. */
    private known: [Pair, Pair] = [
        [0, 0],
        [0, 0],
    ];
    facts: MapFacts | null = null;
    /** Called whenever more of the map is painted. */
    painted: () => void = () => {};
    /** Pictures of the map side by side: all of them show the same part of it. */
    private columns = 1;
    private rows = 1;
    private offset: Pair = [0, 0];

    constructor(readonly canvas: HTMLCanvasElement) {
        const context = canvas.getContext("2d");
        if (!context) throw new Error(texts.noCanvas);
        this.context = context;
    }

    get colors(): Colors {
        const style = getComputedStyle(document.documentElement);
        const color = (name: string) => style.getPropertyValue(`--${name}`).trim();
        const named = COLORS.map((name) => [name, color(name)]);
        const series = Array.from({ length: SERIES }, (_, i) => color(`series-${i}`));
        return { ...Object.fromEntries(named), series } as unknown as Colors;
    }

    /** The picture that `draw` draws, as SVG. */
    svg(draw: () => void): string {
        const real = this.context;
        const written = new SvgContext(real, this.canvas.width, this.canvas.height);
        // It has all that the view uses.
        this.context = written as unknown as CanvasRenderingContext2D;
        try {
            draw();
        } finally {
            this.context = real;
        }
        return written.text;
    }

    /** Divides the canvas into up to four pictures. */
    divide(panes: number): void {
        const isWide = this.canvas.width >= this.canvas.height;
        const [more, less] = [panes > 1 ? 2 : 1, panes > 2 ? 2 : 1];
        const [columns, rows] = isWide ? [more, less] : [less, more];
        if (columns === this.columns && rows === this.rows) return;
        [this.columns, this.rows] = [columns, rows];
        this.fit();
    }

    /** Draws one of the pictures, and nothing beside it. */
    inPane(pane: number, draw: () => void): void {
        const [width, height] = this.paneSize;
        this.offset = [(pane % this.columns) * width, Math.floor(pane / this.columns) * height];
        this.context.save();
        this.context.beginPath();
        this.context.rect(...this.offset, width, height);
        this.context.clip();
        draw();
        this.context.restore();
        this.offset = [0, 0];
    }

    get panes(): number {
        return this.columns * this.rows;
    }

    private get paneSize(): Pair {
        return [this.canvas.width / this.columns, this.canvas.height / this.rows];
    }

    /** A new map, which is shown whole. */
    show(facts: MapFacts, cells: Uint8Array): void {
        this.facts = facts;
        this.known = knownCells(facts, cells);
        void this.paint(cells);
        this.fit();
    }

    /** Draws the cells anew, in the colours of now: a large map strip by strip. */
    async paint(cells: Uint8Array): Promise<void> {
        const facts = this.facts;
        if (!facts) return;
        const { width, height } = facts;
        const picture = document.createElement("canvas");
        [picture.width, picture.height] = [width, height];
        const context = picture.getContext("2d");
        if (!context) return;
        this.picture = picture;
        const { ground, wall, unknown } = this.colors;
        const words = new Uint32Array([ground, wall, unknown].map((color) => word(context, color)));
        const rows = Math.max(1, Math.floor(STRIP_CELLS / width));
        for (let first = 0; first < height; first += rows) {
            if (first > 0) {
                this.painted();
                await new Promise(requestAnimationFrame);
                if (this.picture !== picture) return;
            }
            const count = Math.min(rows, height - first);
            const image = context.createImageData(width, count);
            const pixels = new Uint32Array(image.data.buffer);
            for (let y = 0; y < count; y++) {
                // Rows come from the bottom.
                const from = (height - 1 - first - y) * width;
                for (let x = 0; x < width; x++) pixels[y * width + x] = words[cells[from + x]!]!;
            }
            context.putImageData(image, 0, first);
        }
        this.painted();
    }

    get knownCells(): [Pair, Pair] {
        return this.known;
    }

    /** Draws some cells anew. */
    paintCells(numbers: number[], cells: Uint8Array): void {
        const context = this.picture?.getContext("2d");
        const facts = this.facts;
        if (!context || !facts) return;
        const { ground, wall, unknown } = this.colors;
        for (const number of numbers) {
            context.fillStyle = [ground, wall, unknown][cells[number] ?? 0] ?? ground;
            const row = Math.floor(number / facts.width);
            context.fillRect(number % facts.width, facts.height - 1 - row, 1, 1);
        }
    }

    /** Shows the whole map. */
    fit(): void {
        const facts = this.facts;
        if (!facts) return;
        const corners = this.corners(facts);
        const [xs, ys] = [corners.map(([x]) => x), corners.map(([, y]) => y)];
        const [low, high] = [
            [Math.min(...xs), Math.min(...ys)],
            [Math.max(...xs), Math.max(...ys)],
        ];
        const [width, height] = [high[0]! - low[0]!, high[1]! - low[1]!];
        this.middle = [low[0]! + width / 2, low[1]! + height / 2];
        const [wide, tall] = this.paneSize;
        this.whole = 0.98 * Math.min(wide / width, tall / height);
        this.scale = this.whole;
    }

    private corners(facts: MapFacts): Pair[] {
        const [low, high] = this.known.map(([x, y]) => [
            x * facts.resolution_m,
            y * facts.resolution_m,
        ]);
        const [x, y, x2, y2] = [low![0]!, low![1]!, high![0]!, high![1]!];
        return (
            [
                [x, y],
                [x2, y],
                [x, y2],
                [x2, y2],
            ] as Pair[]
        ).map((at) => placed(facts, at));
    }

    /** Makes the canvas as large as its box. */
    resize(): void {
        const { clientWidth, clientHeight } = this.canvas;
        const ratio = window.devicePixelRatio || 1;
        this.canvas.width = Math.max(1, Math.round(clientWidth * ratio));
        this.canvas.height = Math.max(1, Math.round(clientHeight * ratio));
        const { middle, scale } = this;
        const isWhole = scale === this.whole;
        this.fit();
        if (!isWhole) [this.middle, this.scale] = [middle, scale];
    }

    /** Enlarges what is shown around a place, between a tenth and a hundred times the whole map. */
    zoom(factor: number, at: Pair): void {
        const before = this.toWorld(at);
        this.scale = Math.min(100 * this.whole, Math.max(0.1 * this.whole, this.scale * factor));
        const after = this.toWorld(at);
        this.middle = [
            this.middle[0] + before[0] - after[0],
            this.middle[1] + before[1] - after[1],
        ];
    }

    lookAt(place: Pair, width_m: number): void {
        this.middle = place;
        this.scale = Math.min(100 * this.whole, this.paneSize[0] / width_m);
    }

    pan([x, y]: Pair): void {
        this.middle = [this.middle[0] - x / this.scale, this.middle[1] + y / this.scale];
    }

    toScreen([x, y]: Pair): Pair {
        const [w, h] = this.paneSize;
        return [
            this.offset[0] + w / 2 + (x - this.middle[0]) * this.scale,
            this.offset[1] + h / 2 - (y - this.middle[1]) * this.scale,
        ];
    }

    /** The place under a point of the canvas, in whichever picture it lies. */
    toWorld([x, y]: Pair): Pair {
        const [w, h] = this.paneSize;
        const within = (at: number, size: number, count: number) =>
            at - size * Math.min(count - 1, Math.max(0, Math.floor(at / size)));
        return [
            this.middle[0] + (within(x, w, this.columns) - w / 2) / this.scale,
            this.middle[1] - (within(y, h, this.rows) - h / 2) / this.scale,
        ];
    }

    /** The column and the row in which a place lies, which may be beside the map. */
    columnAndRow([x, y]: Pair): Pair {
        const [ox, oy, yaw] = this.facts?.origin ?? [0, 0, 0];
        const resolution = this.facts?.resolution_m ?? 1;
        const [dx, dy] = [x - ox, y - oy];
        const column = Math.floor((dx * Math.cos(yaw) + dy * Math.sin(yaw)) / resolution);
        const row = Math.floor((dy * Math.cos(yaw) - dx * Math.sin(yaw)) / resolution);
        return [column, row];
    }

    /** The middle of a cell. */
    centre([column, row]: Pair): Pair {
        const facts = this.facts;
        if (!facts) return [0, 0];
        return placed(facts, [
            (column + 0.5) * facts.resolution_m,
            (row + 0.5) * facts.resolution_m,
        ]);
    }

    /** Lengths of the world in pixels. */
    pixels(metres: number): number {
        return metres * this.scale;
    }

    clear(): void {
        const { context, canvas } = this;
        context.setTransform(1, 0, 0, 1, 0, 0);
        context.clearRect(0, 0, canvas.width, canvas.height);
    }

    /** Draws the map. */
    ground(): void {
        if (this.picture) this.layer(this.picture);
    }

    /** Draws a picture of the whole map; a pixel of it shows so many cells along each axis. */
    layer(picture: HTMLCanvasElement, cells = 1): void {
        if (!this.facts) return;
        const { context } = this;
        const { resolution_m, origin } = this.facts;
        const [width, height] = [picture.width * cells, picture.height * cells];
        const [x, y] = this.toScreen([origin[0], origin[1]]);
        const cell = this.pixels(resolution_m);
        context.save();
        context.translate(x, y);
        context.rotate(-origin[2]);
        context.imageSmoothingEnabled = cell < 1;
        context.drawImage(picture, 0, -height * cell, width * cell, height * cell);
        context.restore();
    }

    line(points: Pair[], color: string, width: number, dashes: number[] = []): void {
        this.lines([points], color, width, dashes);
    }

    /** Lines of one kind. */
    lines(lines: Pair[][], color: string, width: number, dashes: number[] = []): void {
        const { context } = this;
        const ratio = window.devicePixelRatio || 1;
        context.beginPath();
        for (const points of lines) {
            points.forEach((point, i) => {
                const [x, y] = this.toScreen(point);
                if (i === 0) context.moveTo(x, y);
                else context.lineTo(x, y);
            });
        }
        context.strokeStyle = color;
        context.lineWidth = width * ratio;
        context.lineJoin = "round";
        context.setLineDash(dashes.map((dash) => dash * ratio));
        context.stroke();
        context.setLineDash([]);
    }

    /** The outline of a disc, with its radius in metres. */
    circle(at: Pair, radius_m: number, color: string, width: number, dashes: number[] = []): void {
        const { context } = this;
        const ratio = window.devicePixelRatio || 1;
        const [x, y] = this.toScreen(at);
        context.beginPath();
        context.arc(x, y, this.pixels(radius_m), 0, 2 * Math.PI);
        context.strokeStyle = color;
        context.lineWidth = width * ratio;
        context.setLineDash(dashes.map((dash) => dash * ratio));
        context.stroke();
        context.setLineDash([]);
    }

    /** Cells, each of at least two pixels. */
    cells(cells: Pair[], color: string): void {
        const { context } = this;
        const side = Math.max(2, this.pixels(this.facts?.resolution_m ?? 1));
        context.fillStyle = color;
        for (const cell of cells) {
            const [x, y] = this.toScreen(this.centre(cell));
            context.fillRect(x - side / 2, y - side / 2, side, side);
        }
    }

    /** A text in the upper left corner of a picture. */
    title(text: string, color: string): void {
        const { context } = this;
        const size = 14 * (window.devicePixelRatio || 1);
        context.font = `600 ${size}px system-ui, sans-serif`;
        [context.textAlign, context.textBaseline] = ["left", "top"];
        context.fillStyle = this.colors.ground;
        const [x, y] = [this.offset[0] + size / 2, this.offset[1] + size / 2];
        context.fillRect(x - 4, y - 4, context.measureText(text).width + 8, size + 8);
        context.fillStyle = color;
        context.fillText(text, x, y);
    }

    disc(at: Pair, radius: number, color: string): void {
        const [x, y] = this.toScreen(at);
        this.context.beginPath();
        this.context.arc(x, y, radius, 0, 2 * Math.PI);
        this.context.fillStyle = color;
        this.context.fill();
    }

    /** A polygon that is given in the frame of a pose. */
    polygon(vertices: Pair[], [x, y, yaw]: [number, number, number], color: string): void {
        const [cos, sin] = [Math.cos(yaw), Math.sin(yaw)];
        const { context } = this;
        context.beginPath();
        for (const [ahead, left] of vertices) {
            const at: Pair = [x + ahead * cos - left * sin, y + ahead * sin + left * cos];
            context.lineTo(...this.toScreen(at));
        }
        context.closePath();
        context.fillStyle = color;
        context.fill();
    }

    /** A round mark with a letter, of the same size at every scale. */
    mark(at: Pair, letter: string, color: string): void {
        const size = 9 * (window.devicePixelRatio || 1);
        this.disc(at, size, color);
        const [x, y] = this.toScreen(at);
        const { context } = this;
        context.fillStyle = "#fff";
        context.font = `bold ${1.2 * size}px system-ui, sans-serif`;
        context.textAlign = "center";
        context.textBaseline = "middle";
        context.fillText(letter, x, y);
    }
}

const UNKNOWN = 2;

/** Columns and rows from the first to behind the last cell that is not unknown, and two beside. */
function knownCells({ width, height }: MapFacts, cells: Uint8Array): [Pair, Pair] {
    let [left, right, low, high] = [width, -1, -1, -1];
    for (let row = 0; row < height; row++) {
        const from = row * width;
        let [first, last] = [0, width - 1];
        while (first <= last && cells[from + first] === UNKNOWN) first++;
        if (first > last) continue;
        while (cells[from + last] === UNKNOWN) last--;
        if (low < 0) low = row;
        [left, right, high] = [Math.min(left, first), Math.max(right, last), row];
    }
    if (high < 0) {
        [left, low, right, high] = [2, 2, width - 3, height - 3];
    }
    return [
        [left - 2, low - 2],
        [right + 3, high + 3],
    ];
}

function placed(facts: MapFacts, [x, y]: Pair): Pair {
    const [ox, oy, yaw] = facts.origin;
    const [cos, sin] = [Math.cos(yaw), Math.sin(yaw)];
    return [ox + x * cos - y * sin, oy + x * sin + y * cos];
}

/** A colour as a pixel of an image. */
export function word(context: CanvasRenderingContext2D, color: string): number {
    const [red, green, blue] = rgb(context, color);
    return (255 << 24) | (blue << 16) | (green << 8) | red;
}

/** Red, green and blue of any colour: a canvas gives all of them as #1a2b3c. */
function rgb(context: CanvasRenderingContext2D, color: string): [number, number, number] {
    context.fillStyle = color;
    const number = Number.parseInt(String(context.fillStyle).slice(1), 16);
    return [(number >> 16) & 255, (number >> 8) & 255, number & 255];
}
