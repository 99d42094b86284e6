/** Pointers on the canvas: what they hold, draw, or move. */

import type { View } from "./draw/view";
import type { Ground } from "./ground";
import type { Engine } from "./engine/engine";
import type { Pair, State } from "./state";
import type { texts } from "./texts";

export type Tool = keyof typeof texts.tools;

type Held =
    | { kind: "start" | "goal" | "pan" | "draw" }
    | { kind: "disc" | "walker" | "walker end"; index: number };

const ratio = () => window.devicePixelRatio || 1;

export class Pointer {
    tool: Tool = "move";
    private held: Held | null = null;
    /** True if what is held was put by this very pointer. */
    private isNew = false;
    private last: Pair = [0, 0];
    /** Fingers on the canvas, by their numbers. */
    private readonly fingers = new Map<number, Pair>();

    constructor(
        private readonly view: View,
        private readonly ground: Ground,
        private readonly engine: Engine,
        private readonly state: State,
        private readonly moved: () => void,
        private readonly drawn: () => void,
        private readonly redraw: () => void,
        /** The things that can be moved. */
        private readonly has: () => { ends: boolean; obstacles: boolean; walls: boolean },
    ) {
        const { canvas } = view;
        canvas.onpointerdown = (event) => this.down(event);
        canvas.onpointermove = (event) => this.move(event);
        canvas.onpointerup = canvas.onpointercancel = ({ pointerId }) => {
            this.fingers.delete(pointerId);
            this.held = null;
        };
        const wheel = (event: WheelEvent) => {
            event.preventDefault();
            view.zoom(Math.exp(-event.deltaY / 400), place(event));
            redraw();
        };
        canvas.addEventListener("wheel", wheel, { passive: false });
        canvas.onkeydown = (event) => this.key(event);
    }

    /** Arrows move the map, plus and minus enlarge it, zero shows all of it. */
    private key(event: KeyboardEvent): void {
        const { canvas } = this.view;
        const by = 40 * ratio();
        const moves: Record<string, Pair> = {
            ArrowLeft: [by, 0],
            ArrowRight: [-by, 0],
            ArrowUp: [0, by],
            ArrowDown: [0, -by],
        };
        const zooms: Record<string, number> = { "+": 1.25, "=": 1.25, "-": 0.8 };
        const [move, zoom] = [moves[event.key], zooms[event.key]];
        if (move) this.view.pan(move);
        else if (zoom) this.view.zoom(zoom, [canvas.width / 2, canvas.height / 2]);
        else if (event.key === "0") this.view.fit();
        else return;
        event.preventDefault();
        this.redraw();
    }

    private down(event: PointerEvent): void {
        this.view.canvas.setPointerCapture(event.pointerId);
        this.last = place(event);
        this.fingers.set(event.pointerId, this.last);
        const at = this.view.toWorld(this.last);
        // Two fingers zoom; what the first one has put was not meant.
        if (this.fingers.size > 1) {
            this.takeBack();
            this.held = null;
            return;
        }
        this.held = this.under(at);
        this.isNew = false;
        if (this.held?.kind === "draw") this.stroke(at, at);
        else if (this.held?.kind === "pan" && this.has().obstacles) this.put(at);
    }

    private move(event: PointerEvent): void {
        const now = place(event);
        if (this.fingers.size > 1) {
            this.pinch(event.pointerId, now);
            return;
        }
        if (this.held?.kind === "pan") {
            this.view.pan([now[0] - this.last[0], now[1] - this.last[1]]);
            this.redraw();
        } else if (this.held?.kind === "draw") {
            this.stroke(this.view.toWorld(this.last), this.view.toWorld(now));
        } else if (this.held) this.moveTo(this.view.toWorld(now));
        this.last = now;
    }

    private pinch(finger: number, now: Pair): void {
        const other = [...this.fingers].find(([number]) => number !== finger)?.[1];
        const before = this.fingers.get(finger);
        this.fingers.set(finger, now);
        if (!other || !before) return;
        const apart = (at: Pair) => Math.max(1, Math.hypot(at[0] - other[0], at[1] - other[1]));
        this.view.zoom(apart(now) / apart(before), other);
        this.redraw();
    }

    /** The thing under the pointer. */
    private under(at: Pair): Held {
        const reach = 14 * ratio();
        const isNear = (place: Pair, size = reach) => {
            const [x, y] = this.view.toScreen(place);
            const [px, py] = this.view.toScreen(at);
            return Math.hypot(x - px, y - py) < size;
        };
        const { start, goal, discs, walkers } = this.state;
        const has = this.has();
        if (has.ends && isNear(start)) return { kind: "start" };
        if (has.ends && isNear(goal)) return { kind: "goal" };
        if (has.obstacles) {
            const size = (radius_m: number) => Math.max(reach, this.view.pixels(radius_m));
            const disc = discs.findIndex((disc) => isNear(disc.at, size(disc.radius_m)));
            const from = walkers.findIndex((walker) => isNear(walker.from));
            const to = walkers.findIndex((walker) => isNear(walker.to));
            if (this.tool === "erase") this.remove(disc, from >= 0 ? from : to);
            else if (disc >= 0) return { kind: "disc", index: disc };
            else if (from >= 0) return { kind: "walker", index: from };
            else if (to >= 0) return { kind: "walker end", index: to };
        }
        const isDrawing = has.walls && (this.tool === "wall" || this.tool === "erase");
        return { kind: isDrawing ? "draw" : "pan" };
    }

    private remove(disc: number, walker: number): void {
        if (disc >= 0) this.state.discs.splice(disc, 1);
        if (walker >= 0) this.state.walkers.splice(walker, 1);
        if (disc >= 0 || walker >= 0) this.moved();
    }

    private takeBack(): void {
        if (!this.isNew) return;
        if (this.held?.kind === "disc") this.remove(this.held.index, -1);
        else if (this.held?.kind === "walker end") this.remove(-1, this.held.index);
        this.isNew = false;
    }

    /** Puts what the tool says, and holds it. */
    private put(at: Pair): void {
        const { discs, walkers } = this.state;
        if (this.tool === "disc") {
            discs.push({ at, radius_m: 0.2 });
            this.held = { kind: "disc", index: discs.length - 1 };
        } else if (this.tool === "walker") {
            walkers.push({ from: rounded(at), to: at });
            this.held = { kind: "walker end", index: walkers.length - 1 };
        } else return;
        this.isNew = true;
        this.moveTo(at);
    }

    private moveTo(place: Pair): void {
        const at = rounded(place);
        const { held, state } = this;
        if (held?.kind === "start" || held?.kind === "goal") state[held.kind] = at;
        else if (held?.kind === "disc") state.discs[held.index]!.at = at;
        else if (held?.kind === "walker") state.walkers[held.index]!.from = at;
        else if (held?.kind === "walker end") state.walkers[held.index]!.to = at;
        else return;
        this.moved();
    }

    /** Draws walls, or erases them, along a line. */
    private stroke(from: Pair, to: Pair): void {
        const resolution = this.view.facts?.resolution_m ?? 1;
        const steps = Math.ceil(Math.hypot(to[0] - from[0], to[1] - from[1]) / resolution) || 1;
        const state = this.tool === "wall" ? 1 : 0;
        for (let i = 0; i <= steps; i++) {
            const at = [0, 1].map((axis) => from[axis]! + ((to[axis]! - from[axis]!) * i) / steps);
            const [x, y] = this.view.columnAndRow(at as Pair);
            const near = [-1, 0, 1].flatMap((dy) =>
                [-1, 0, 1].map((dx) => [x + dx, y + dy, state]),
            );
            this.ground.draw(this.engine, near as [number, number, 0 | 1][]);
        }
        this.drawn();
    }
}

function place(event: PointerEvent | WheelEvent): Pair {
    return [event.offsetX * ratio(), event.offsetY * ratio()];
}

const rounded = (at: Pair) => at.map((value) => Number(value.toFixed(3))) as Pair;
