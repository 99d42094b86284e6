/** The page: a map with a panel beside it. */

import "./style.css";
import { isBundled, load } from "./bundled";
import { View } from "./draw/view";
import { Engine } from "./engine/engine";
import type { Parts } from "./engine/message";
import type { MapFacts, Names } from "./engine/types";
import { Ground } from "./ground";
import { button, choice, number, type NumberField } from "./panels/controls";
import { DrivePanel } from "./panels/drive";
import { failure, type Page, type Panel } from "./panels/panel";
import { PlanPanel } from "./panels/plan";
import { SearchPanel } from "./panels/search";
import { Pointer, type Tool } from "./pointer";
import { fromFragment, TABS, toFragment, type Pair, type State, type Tab } from "./state";
import { texts } from "./texts";

class App implements Page {
    readonly engine: Engine;
    names!: Names;
    private readonly view = new View(element("map") as HTMLCanvasElement);
    private readonly ground = new Ground(this.view, () => this.changed());
    private readonly pointer: Pointer;
    private readonly status = element("status");
    private isDue = false;
    private isLinkDue = false;
    private panel: Panel | null = null;
    /** Its drive is still there after a look at another part, unless something has changed. */
    private drive: DrivePanel | null = null;
    private places: NumberField[] = [];
    private maps: HTMLSelectElement | null = null;

    constructor(readonly state: State) {
        this.engine = new Engine(this.ground.edits);
        const moved = () => {
            this.showPlaces();
            this.changed();
        };
        // A drive on another map is of no use.
        const drawn = () => {
            this.drive?.leave();
            this.redraw();
        };
        const { view, ground, engine } = this;
        this.pointer = new Pointer(view, ground, engine, state, moved, drawn, this.redraw);
    }

    readonly mapName = () => this.ground.name;

    readonly say = (panel: Panel | null, text: string) => {
        if (panel !== null && panel !== this.panel) return;
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
        this.state.drawn = this.ground.list;
        if (this.panel !== this.drive) this.drive = null;
        void this.panel?.refresh();
        this.redraw();
        this.writeLink();
    };

    /** Writes the state into the address, but not at every move of a pointer. */
    private writeLink(): void {
        if (this.isLinkDue) return;
        this.isLinkDue = true;
        setTimeout(async () => {
            this.isLinkDue = false;
            history.replaceState(null, "", `#${await toFragment(this.state)}`);
        }, 300);
    }

    async start(): Promise<void> {
        this.names = (await this.engine.ask<Names>({ ask: "names" })).head;
        this.makeTabs();
        this.makeControls();
        this.listen();
        this.view.resize();
        const { map, drawn } = this.state;
        const isHere = isBundled(map);
        await this.openBundled(isHere ? map : "house", !isHere);
        if (isHere) this.ground.draw(this.engine, drawn);
        await this.ground.tell(this.engine);
        this.open(this.state.tab);
        if (!isHere) this.say(null, texts.notInLink(map));
    }

    /** Shows one of the parts. */
    private open(tab: Tab): void {
        this.panel?.leave?.();
        this.state.tab = tab;
        for (const other of TABS) {
            element(`tab-${other}`).setAttribute("aria-selected", String(other === tab));
            element(`tab-${other}`).tabIndex = other === tab ? 0 : -1;
        }
        const side = element("panel");
        side.setAttribute("aria-labelledby", `tab-${tab}`);
        const isKept = tab === "drive" && this.drive !== null;
        if (tab === "drive") this.panel = this.drive ??= new DrivePanel(this);
        else this.panel = tab === "plan" ? new PlanPanel(this) : new SearchPanel(this);
        side.replaceChildren(this.panel.element);
        if (!isKept) void this.panel.refresh();
        this.redraw();
        this.writeLink();
    }

    private async openBundled(map: string, isNew: boolean): Promise<void> {
        const { name, parts, ends } = await load(map);
        await this.openFiles(name, parts);
        this.state.map = map;
        if (isNew) this.forget(ends);
        this.showPlaces();
    }

    private async openFiles(name: string, parts: Parts): Promise<void> {
        const facts: MapFacts = await this.ground.open(this.engine, name, parts);
        this.say(
            null,
            [`${facts.name}, ${facts.width} x ${facts.height}`, ...facts.warnings].join("; "),
        );
    }

    /** Walls and obstacles of another map. */
    private forget([start, goal]: [Pair, Pair]): void {
        Object.assign(this.state, { start, goal, discs: [], walkers: [], drawn: [] });
    }

    private async choose(map: string): Promise<void> {
        try {
            await this.openBundled(map, true);
            this.changed();
        } catch (error) {
            this.say(null, failure(error));
        }
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
            this.say(null, failure(error));
            return;
        }
        const { radius_m } = this.state;
        this.forget([this.ground.freeNear(0.25, radius_m), this.ground.freeNear(0.75, radius_m)]);
        this.state.map = readable.name;
        this.maps?.add(new Option(readable.name, readable.name, false, true));
        this.showPlaces();
        this.changed();
    }

    private draw(): void {
        const { view, state } = this;
        view.clear();
        const colors = view.colors;
        if (state.tab === "drive") {
            for (const { from, to } of state.walkers) {
                view.line([from, to], colors.mover, 1.5, [2, 4]);
            }
            for (const { at, radius_m } of state.discs) {
                view.disc(at, view.pixels(radius_m), colors.disc);
            }
        }
        this.panel?.draw(view);
        view.mark(state.start, "S", colors.start);
        view.mark(state.goal, "G", colors.goal);
    }

    private listen(): void {
        const { canvas } = this.view;
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
            this.ground.repaint();
            this.redraw();
        });
        // Another link in the same window.
        window.addEventListener("hashchange", () => location.reload());
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
        const files = document.createElement("input");
        [files.type, files.multiple, files.id] = ["file", true, "files"];
        files.onchange = () => {
            void this.openOwn([...(files.files ?? [])]).then(() => (files.value = ""));
        };
        const label = document.createElement("label");
        [label.htmlFor, label.textContent] = ["files", texts.openFiles];
        const box = document.createElement("div");
        box.className = "field";
        box.append(label, files);
        const bundled = Object.entries(texts.bundled);
        const maps = choice(texts.map, bundled, this.state.map, (map) => {
            if (isBundled(map)) void this.choose(map);
        });
        this.maps = maps.querySelector("select");
        const tools = Object.entries(texts.tools);
        element("controls").append(
            maps,
            box,
            choice(texts.pointer, tools, "move", (tool) => (this.pointer.tool = tool as Tool)),
            this.makePlaces(),
            button(texts.whole, () => {
                this.view.fit();
                this.redraw();
            }),
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
        history.replaceState(null, "", `#${await toFragment(this.state)}`);
        try {
            await navigator.clipboard.writeText(location.href);
            this.say(null, texts.copied);
        } catch {
            this.say(null, texts.clipboard);
        }
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
    try {
        await new App(await fromFragment(location.hash.slice(1))).start();
    } catch (error) {
        element("status").textContent = texts.notStarted(String(error));
        throw error;
    }
    document.body.dataset["ready"] = "true";
}

void main();
