/** The page: a map with a panel beside it. */

import "./style.css";
import houseYaml from "../../crates/keyway-cli/scenes/small_house.yaml?url";
import housePng from "../../crates/keyway-cli/scenes/small_house.png?url";
import roomsMap from "../../crates/keyway-cli/scenes/rooms.map?url";
import { Engine, Refused } from "./engine/engine";
import type { MapFacts, Names } from "./engine/types";
import { View } from "./draw/view";
import { button, choice, number, type NumberField } from "./panels/controls";
import { DrivePanel } from "./panels/drive";
import type { Page, Panel } from "./panels/panel";
import { PlanPanel } from "./panels/plan";
import { SearchPanel } from "./panels/search";
import { fromFragment, INITIAL, toFragment, type Pair, type State, type Tab } from "./state";
import { texts } from "./texts";

type Tool = keyof typeof texts.tools;
type Held =
    { kind: "start" | "goal" | "pan" | "draw" } | { kind: "disc" | "walker"; index: number };

/** Bundled maps: their files by name, the first one that of the map; start and goal. */
const BUNDLED: Record<string, { files: [string, string][]; start: Pair; goal: Pair }> = {
    house: {
        files: [
            ["small_house.yaml", houseYaml],
            ["small_house.png", housePng],
        ],
        start: INITIAL.start,
        goal: INITIAL.goal,
    },
    rooms: { files: [["rooms.map", roomsMap]], start: [1.5, 1.5], goal: [30.5, 30.5] },
};

const TABS: Tab[] = ["plan", "search", "drive"];
const CODES = { free: 0, occupied: 1 } as const;

class App implements Page {
    private readonly view: View;
    private cells: Uint8Array = new Uint8Array();
    private name = "";
    private tool: Tool = "move";
    private held: Held | null = null;
    private last: Pair = [0, 0];
    private isDue = false;
    private panel!: Panel;
    private places: NumberField[] = [];
    private readonly side = element("panel");
    private readonly status = element("status");

    constructor(
        readonly state: State,
        readonly engine: Engine,
        readonly names: Names,
    ) {
        this.view = new View(element("map") as HTMLCanvasElement);
        this.listen();
    }

    readonly mapName = () => this.name;

    readonly say = (text: string) => {
        this.status.textContent = text;
        this.view.canvas.setAttribute("aria-label", texts.pictureOf(text));
    };

    readonly redraw = () => {
        if (this.isDue) return;
        this.isDue = true;
        requestAnimationFrame(() => {
            this.isDue = false;
            this.draw();
        });
    };

    readonly changed = () => {
        void this.panel.refresh();
        void toFragment(this.state).then((fragment) =>
            history.replaceState(null, "", `#${fragment}`),
        );
    };

    async start(): Promise<void> {
        this.view.resize();
        await this.openBundled(this.state.map, false);
        this.open(this.state.tab);
    }

    /** Shows one of the parts. */
    private open(tab: Tab): void {
        this.state.tab = tab;
        for (const other of TABS) {
            element(`tab-${other}`).setAttribute("aria-selected", String(other === tab));
            element(`tab-${other}`).tabIndex = other === tab ? 0 : -1;
        }
        this.side.setAttribute("aria-labelledby", `tab-${tab}`);
        const panels = { plan: PlanPanel, search: SearchPanel, drive: DrivePanel };
        this.panel = new panels[tab](this);
        this.side.replaceChildren(this.panel.element);
        this.changed();
        this.redraw();
    }

    private async openBundled(map: string, isNew: boolean): Promise<void> {
        const bundled = BUNDLED[map] ?? BUNDLED["house"]!;
        const files = bundled.files.map(async ([name, url]): Promise<[string, Uint8Array]> => {
            const content = await (await fetch(url)).arrayBuffer();
            return [name, new Uint8Array(content)];
        });
        await this.openFiles(bundled.files[0]![0], Object.fromEntries(await Promise.all(files)));
        this.state.map = map;
        if (isNew) this.forget(bundled.start, bundled.goal);
        await this.drawAgain();
    }

    /** Walls and obstacles of another map. */
    private forget(start: Pair, goal: Pair): void {
        Object.assign(this.state, { start, goal, discs: [], walkers: [], free: [], walls: [] });
    }

    private async drawAgain(): Promise<void> {
        await this.edit(this.state.walls, "occupied");
        await this.edit(this.state.free, "free");
        this.showPlaces();
    }

    /** Opens a map; when it cannot be read, the one before stays. */
    private async openFiles(name: string, parts: Record<string, Uint8Array>): Promise<void> {
        const { head, parts: cells } = await this.engine.tell<MapFacts>(
            { ask: "open_map", name },
            parts,
        );
        this.name = name;
        this.cells = cells["cells"] ?? new Uint8Array();
        this.view.show(head, this.cells);
        this.say(`${head.name}, ${head.width} x ${head.height}`);
    }

    private async openOwn(files: File[]): Promise<void> {
        const readable = files.find(({ name }) => /\.(ya?ml|map)$/i.test(name)) ?? files[0];
        if (!readable) return;
        const read = files.map(async (file): Promise<[string, Uint8Array]> => [
            file.name,
            new Uint8Array(await file.arrayBuffer()),
        ]);
        try {
            await this.openFiles(readable.name, Object.fromEntries(await Promise.all(read)));
        } catch (error) {
            if (!(error instanceof Refused)) throw error;
            this.say(error.message);
            return;
        }
        const facts = this.view.facts!;
        const at = (share: number) => this.view.centre([facts.width * share, facts.height * share]);
        this.forget(at(0.25), at(0.75));
        this.showPlaces();
        this.changed();
    }

    /** Changes cells of the map. */
    private async edit(cells: Pair[], state: "free" | "occupied"): Promise<void> {
        if (cells.length === 0) return;
        await this.engine.tell({ ask: "edit_map", cells, state });
        const width = this.view.facts?.width ?? 0;
        for (const [x, y] of cells) this.cells[y * width + x] = CODES[state];
        this.view.paint(this.cells);
    }

    private paintAt(at: Pair): void {
        const middle = this.view.cellAt(at);
        if (!middle) return;
        const near = [-1, 0, 1].flatMap((dy) =>
            [-1, 0, 1].map((dx): Pair => [middle[0] + dx, middle[1] + dy]),
        );
        const facts = this.view.facts!;
        const isInside = ([x, y]: Pair) => x >= 0 && y >= 0 && x < facts.width && y < facts.height;
        const cells = near.filter(isInside);
        const isWall = this.tool === "wall";
        (isWall ? this.state.walls : this.state.free).push(...cells);
        void this.edit(cells, isWall ? "occupied" : "free").then(this.changed);
    }

    private draw(): void {
        const { view, state } = this;
        view.clear();
        const colors = view.colors;
        if (state.tab === "drive") {
            for (const { from, to } of state.walkers) {
                view.line([from, to], colors.mover, 1.5, [2, 4]);
            }
            for (const { at, radius_m } of state.discs)
                view.disc(at, view.pixels(radius_m), colors.disc);
        }
        this.panel?.draw(view);
        view.mark(state.start, "S", colors.start);
        view.mark(state.goal, "G", colors.goal);
    }

    /** What is under the pointer. */
    private under(at: Pair): Held {
        const reach = 14 * (window.devicePixelRatio || 1);
        const isNear = (place: Pair, size: number) => {
            const [x, y] = this.view.toScreen(place);
            const [px, py] = this.view.toScreen(at);
            return Math.hypot(x - px, y - py) < size;
        };
        if (isNear(this.state.start, reach)) return { kind: "start" };
        if (isNear(this.state.goal, reach)) return { kind: "goal" };
        const index = this.state.discs.findIndex((disc) =>
            isNear(disc.at, Math.max(reach, this.view.pixels(disc.radius_m))),
        );
        if (this.state.tab === "drive" && index >= 0) return { kind: "disc", index };
        return { kind: this.tool === "wall" || this.tool === "erase" ? "draw" : "pan" };
    }

    /** Puts what the tool says, and holds it. */
    private put(at: Pair): void {
        const { discs, walkers } = this.state;
        if (this.tool === "disc") {
            discs.push({ at, radius_m: 0.2 });
            this.held = { kind: "disc", index: discs.length - 1 };
        } else if (this.tool === "walker") {
            walkers.push({ from: at, to: at });
            this.held = { kind: "walker", index: walkers.length - 1 };
        } else return;
        this.moveTo(at);
    }

    private moveTo(at: Pair): void {
        const held = this.held;
        const rounded = at.map((value) => Number(value.toFixed(3))) as Pair;
        if (held?.kind === "start" || held?.kind === "goal") this.state[held.kind] = rounded;
        else if (held?.kind === "disc") this.state.discs[held.index]!.at = rounded;
        else if (held?.kind === "walker") this.state.walkers[held.index]!.to = rounded;
        else return;
        this.showPlaces();
        this.redraw();
        this.changed();
    }

    private listen(): void {
        const { canvas } = this.view;
        const place = (event: PointerEvent | WheelEvent): Pair => {
            const ratio = window.devicePixelRatio || 1;
            return [event.offsetX * ratio, event.offsetY * ratio];
        };
        canvas.onpointerdown = (event) => {
            canvas.setPointerCapture(event.pointerId);
            this.last = place(event);
            const at = this.view.toWorld(this.last);
            this.held = this.under(at);
            if (this.held.kind === "draw") this.paintAt(at);
            else if (this.held.kind === "pan" && this.state.tab === "drive") this.put(at);
        };
        canvas.onpointermove = (event) => {
            const now = place(event);
            if (this.held?.kind === "pan") {
                this.view.pan([now[0] - this.last[0], now[1] - this.last[1]]);
                this.redraw();
            } else if (this.held?.kind === "draw") this.paintAt(this.view.toWorld(now));
            else if (this.held) this.moveTo(this.view.toWorld(now));
            this.last = now;
        };
        canvas.onpointerup = canvas.onpointercancel = () => (this.held = null);
        canvas.addEventListener(
            "wheel",
            (event) => {
                event.preventDefault();
                this.view.zoom(Math.exp(-event.deltaY / 400), place(event));
                this.redraw();
            },
            { passive: false },
        );
        canvas.ondragover = (event) => event.preventDefault();
        canvas.ondrop = (event) => {
            event.preventDefault();
            void this.openOwn([...(event.dataTransfer?.files ?? [])]);
        };
        new ResizeObserver(() => {
            this.view.resize();
            this.redraw();
        }).observe(canvas);
        matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
            this.view.paint(this.cells);
            this.redraw();
        });
        this.makeTabs();
        this.makeControls();
    }

    private makeTabs(): void {
        for (const tab of TABS) {
            const made = button(texts.tabs[tab], () => this.open(tab));
            made.id = `tab-${tab}`;
            made.setAttribute("role", "tab");
            made.setAttribute("aria-controls", "panel");
            made.onkeydown = ({ key }) => {
                const by = key === "ArrowRight" ? 1 : key === "ArrowLeft" ? -1 : 0;
                const next = TABS[(TABS.indexOf(tab) + by + TABS.length) % TABS.length]!;
                if (by === 0) return;
                this.open(next);
                element(`tab-${next}`).focus();
            };
            element("tabs").append(made);
        }
    }

    private makeControls(): void {
        const maps = Object.entries(texts.bundled);
        const tools = Object.entries(texts.tools);
        const files = document.createElement("input");
        [files.type, files.multiple, files.id] = ["file", true, "files"];
        files.onchange = () => void this.openOwn([...(files.files ?? [])]);
        const label = document.createElement("label");
        [label.htmlFor, label.textContent] = ["files", texts.openFiles];
        const box = document.createElement("div");
        box.className = "field";
        box.append(label, files);
        element("controls").append(
            choice(texts.map, maps, this.state.map, (map) => {
                void this.openBundled(map, true).then(this.changed);
            }),
            box,
            choice(texts.pointer, tools, this.tool, (tool) => (this.tool = tool as Tool)),
            this.makePlaces(),
            button(texts.share, () => void this.share()),
        );
    }

    /** Start and goal as numbers: for keyboards, and to be exact. */
    private makePlaces(): HTMLElement {
        const box = document.createElement("div");
        box.className = "places";
        for (const end of ["start", "goal"] as const) {
            for (const axis of [0, 1] as const) {
                const name = `${texts[end]} ${axis === 0 ? "x" : "y"} [m]`;
                const field = number(name, this.state[end][axis], { step: 0.05 }, (value) => {
                    this.state[end][axis] = value;
                    this.redraw();
                    this.changed();
                });
                this.places.push(field);
                box.append(field.element);
            }
        }
        return box;
    }

    private showPlaces(): void {
        const numbers = [...this.state.start, ...this.state.goal];
        this.places.forEach((field, i) => field.set(numbers[i]!));
    }

    private async share(): Promise<void> {
        const fragment = await toFragment(this.state);
        history.replaceState(null, "", `#${fragment}`);
        await navigator.clipboard?.writeText(location.href);
        this.say(texts.copied);
    }
}

function element(id: string): HTMLElement {
    const found = document.getElementById(id);
    if (!found) throw new Error(`the page has no element ${id}`);
    return found;
}

async function main(): Promise<void> {
    document.title = texts.title;
    element("title").textContent = texts.title;
    element("subtitle").textContent = texts.subtitle;
    const state = await fromFragment(location.hash.slice(1));
    const engine = new Engine();
    const { head } = await engine.ask<Names>({ ask: "names" });
    await new App(state, engine, head).start();
    document.body.dataset["ready"] = "true";
}

void main();
