/** The page: a map with a panel beside it. */

import "./style.css";
import { SCENES } from "./bundled";
import { View } from "./draw/view";
import { Engine } from "./engine/engine";
import type { Parts } from "./engine/message";
import type { MapFacts, Names, SceneFacts } from "./engine/types";
import { Ground } from "./ground";
import { fromFragment, toFragment } from "./link";
import { button, choice, grouped, number, save, type NumberField } from "./panels/controls";
import { ComparePanel } from "./panels/compare";
import { DrivePanel } from "./panels/drive";
import { failure, type Page, type Panel } from "./panels/panel";
import { PapersPanel } from "./panels/papers";
import { PlanPanel } from "./panels/plan";
import { SearchPanel } from "./panels/search";
import { Pointer, type Tool } from "./pointer";
import { Source } from "./source";
import { LIMITS, TABS, type Pair, type State, type Tab } from "./state";
import { texts } from "./texts";

/** Work that is done sooner is not announced. */
const SOON_MS = 250;

class App implements Page {
    readonly engine: Engine;
    names!: Names;
    private readonly view = new View(element("map") as HTMLCanvasElement);
    private readonly ground = new Ground(this.view, () => this.changed());
    private readonly source: Source;
    private readonly pointer: Pointer;
    private readonly status = element("status");
    private readonly stop = button(texts.stop, () => this.stops.at(-1)?.abort());
    /** Of the work that is done just now. */
    private readonly stops: AbortController[] = [];
    private isDue = false;
    private isLinkDue = false;
    private panel: Panel | null = null;
    /** These stay when another part is looked at, unless something has changed. */
    private readonly kept = new Map<Tab, Panel>();
    /** The last thing that each part has said. */
    private readonly said = new WeakMap<Panel, string>();
    /** One part is opened after the other. */
    private opening: Promise<void> = Promise.resolve();
    private turns = 0;
    /** The map that is opened just now. */
    private bringing: AbortController | null = null;
    private places: NumberField[] = [];
    private maps: HTMLSelectElement | null = null;
    private tools: HTMLSelectElement | null = null;

    constructor(readonly state: State) {
        this.engine = new Engine(this.ground.edits);
        const moved = () => {
            this.showPlaces();
            this.changed();
        };
        // A drive on another map is of no use.
        const drawn = () => {
            this.kept.forEach((panel) => panel.leave?.());
            this.redraw();
        };
        const { view, ground, engine, has } = this;
        this.source = new Source(engine, ground, state, (text) => this.say(null, text));
        this.pointer = new Pointer(view, ground, engine, state, moved, drawn, this.redraw, has);
        view.painted = this.redraw;
        this.stop.hidden = true;
        this.status.after(this.stop);
    }

    /** The things that can be moved in the part that is shown. */
    private readonly has = () => {
        const ends = this.panel?.hasEnds ?? false;
        const { tab } = this.state;
        const isDriven = tab === "drive" || tab === "compare";
        return { ends, obstacles: ends && isDriven, walls: tab !== "papers" };
    };

    get scene(): SceneFacts | null {
        return this.source.scene;
    }

    readonly mapName = () => this.ground.name;

    readonly showMap = (facts: MapFacts, cells: Uint8Array, name: string) => {
        this.source.show(facts, cells, name);
        this.kept.clear();
        this.showSource(name);
        this.showPlaces();
        this.writeLink();
    };

    readonly keepMap = () => {
        this.source.keep();
        void this.open("plan");
    };

    readonly lookAt = (place: Pair, width_m: number) => {
        this.view.lookAt(place, width_m);
        this.redraw();
    };

    readonly say = (panel: Panel | null, text: string) => {
        if (panel) this.said.set(panel, text);
        if (panel !== null && panel !== this.panel) return;
        this.status.textContent = text;
        this.view.canvas.setAttribute("aria-label", texts.pictureOf(text));
    };

    readonly working = async <T>(
        outer: AbortSignal | null,
        work: (stop: AbortSignal) => Promise<T>,
        text: string = texts.working,
    ): Promise<T> => {
        const own = new AbortController();
        const abort = () => own.abort();
        outer?.addEventListener("abort", abort);
        this.stops.push(own);
        let before: string | null = null;
        const timer = setTimeout(() => {
            this.stop.hidden = false;
            before = this.status.textContent;
            this.say(null, text);
        }, SOON_MS);
        try {
            return await work(own.signal);
        } finally {
            clearTimeout(timer);
            outer?.removeEventListener("abort", abort);
            this.stops.splice(this.stops.indexOf(own), 1);
            this.stop.hidden = this.stops.length === 0;
            if (before !== null && this.status.textContent === text) this.say(null, before);
        }
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
        for (const [tab, panel] of this.kept) if (panel !== this.panel) this.kept.delete(tab);
        void this.refresh();
        this.redraw();
        this.writeLink();
    };

    private async refresh(): Promise<void> {
        const { panel } = this;
        try {
            await this.source.reseed();
        } catch (error) {
            this.say(null, failure(error));
            return;
        }
        if (panel === this.panel) await panel?.refresh();
    }

    /** Writes the state into the address, but not at every move of a pointer. */
    private writeLink(): void {
        if (this.isLinkDue) return;
        this.isLinkDue = true;
        setTimeout(async () => {
            this.isLinkDue = false;
            await this.putLink();
        }, 300);
    }

    /** Writes the state into the address; returns whether all of it has found room. */
    private async putLink(): Promise<boolean> {
        const { fragment, isWhole } = await toFragment(this.state, this.source.files);
        history.replaceState(null, "", `#${fragment}`);
        return isWhole;
    }

    async start(files: Parts): Promise<void> {
        this.names = (await this.engine.ask<Names>({ ask: "names" })).head;
        this.makeTabs();
        this.makeControls();
        this.listen();
        this.view.resize();
        const notice = await this.source.restore(files);
        this.showSource(this.state.map);
        await this.ground.tell(this.engine);
        await this.open(this.state.tab);
        if (notice === null) return;
        await this.panel?.refresh();
        this.say(null, notice);
    }

    /** Shows one of the parts. */
    private open(tab: Tab): Promise<void> {
        const turn = ++this.turns;
        this.opening = this.opening.then(async () => {
            if (turn !== this.turns) return;
            this.panel?.leave?.();
            try {
                if (this.state.tab === "papers" && tab !== "papers") await this.source.goBack();
            } catch (error) {
                this.say(null, failure(error));
            }
            this.showSource(this.state.map);
            this.show(tab);
        });
        return this.opening;
    }

    private show(tab: Tab): void {
        if (tab === "papers") this.source.remember();
        this.state.tab = tab;
        for (const other of TABS) {
            element(`tab-${other}`).setAttribute("aria-selected", String(other === tab));
            element(`tab-${other}`).tabIndex = other === tab ? 0 : -1;
        }
        const side = element("panel");
        side.setAttribute("aria-labelledby", `tab-${tab}`);
        const known = this.kept.get(tab);
        this.panel = known ?? this.made(tab);
        if (tab === "drive" || tab === "compare") this.kept.set(tab, this.panel);
        side.replaceChildren(this.panel.element);
        element("wide").replaceChildren(...(this.panel.wide ? [this.panel.wide] : []));
        if (known) this.say(null, this.said.get(known) ?? "");
        else void this.panel.refresh();
        this.showPlaces();
        this.redraw();
        this.writeLink();
    }

    private made(tab: Tab): Panel {
        if (tab === "plan") return new PlanPanel(this);
        if (tab === "search") return new SearchPanel(this);
        if (tab === "drive") return new DrivePanel(this);
        return tab === "compare" ? new ComparePanel(this) : new PapersPanel(this);
    }

    private choose(map: string): Promise<void> {
        return this.bring(async (stop) => {
            await this.source.open(map, stop);
            return [map];
        });
    }

    private openOwn(files: File[]): Promise<void> {
        return this.bring((stop) => this.source.openOwn(files, stop));
    }

    /** Opens a map in the place of what is done just now; only the last one counts. */
    private async bring(open: (stop: AbortSignal) => Promise<string[]>): Promise<void> {
        this.bringing?.abort();
        const bringing = new AbortController();
        this.bringing = bringing;
        this.panel?.leave?.();
        try {
            const names = await this.working(bringing.signal, open);
            if (this.bringing !== bringing || names.length === 0) return;
            for (const name of [...names, this.state.map]) this.showSource(name);
            // A claim would bring its own map again.
            if (this.state.tab === "papers") await this.open("plan");
            this.showPlaces();
            this.changed();
        } catch (error) {
            if (this.bringing !== bringing) return;
            this.showSource(this.state.map);
            this.say(null, failure(error));
        }
    }

    /** The name of the map in the list of maps. */
    private showSource(name: string): void {
        const { maps } = this;
        if (!maps) return;
        if (![...maps.options].some(({ value }) => value === name)) maps.add(new Option(name));
        maps.value = name;
    }

    private draw(): void {
        const { view, panel } = this;
        view.clear();
        const panes = panel?.panes ?? 1;
        view.divide(panes);
        for (let pane = 0; pane < panes; pane++) {
            view.inPane(pane, () => {
                view.ground();
                const { tab } = this.state;
                const isDriven = tab === "drive" || tab === "compare";
                if (isDriven) this.drawObstacles();
                panel?.draw(view, pane);
                this.drawEnds();
            });
        }
    }

    /** Obstacles that the map does not show. */
    private drawObstacles(): void {
        const { view, state, scene } = this;
        const { colors } = view;
        if (scene) {
            view.cells(scene.hidden_cells, colors.disc);
            for (const [x, y, radius_m] of scene.discs) {
                view.disc([x, y], view.pixels(radius_m), colors.disc);
            }
            for (const polygon of scene.polygons) view.polygon(polygon, [0, 0, 0], colors.disc);
            return;
        }
        for (const { from, to } of state.walkers) view.line([from, to], colors.mover, 1.5, [2, 4]);
        for (const { at, radius_m } of state.discs) {
            view.disc(at, view.pixels(radius_m), colors.disc);
        }
    }

    private drawEnds(): void {
        const { view, state, scene } = this;
        const { colors } = view;
        const isScene = scene && (state.tab === "drive" || state.tab === "compare");
        const robots = isScene ? scene.robots : [{ start: state.start, goal: state.goal }];
        robots.forEach(({ start, goal }, i) => {
            const number = robots.length > 1 ? String(i + 1) : "";
            view.mark(start, `S${number}`, colors.start);
            view.mark(goal, `G${number}`, colors.goal);
        });
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
            this.panel?.repaint?.();
            this.redraw();
        });
        // Another link in the same window.
        window.addEventListener("hashchange", () => location.reload());
    }

    private makeTabs(): void {
        for (const tab of TABS) {
            const made = button(texts.tabs[tab], () => void this.open(tab));
            made.id = `tab-${tab}`;
            made.setAttribute("role", "tab");
            made.setAttribute("aria-controls", "panel");
            made.onkeydown = ({ key }) => {
                const by = key === "ArrowRight" ? 1 : key === "ArrowLeft" ? -1 : 0;
                const next = TABS[(TABS.indexOf(tab) + by + TABS.length) % TABS.length]!;
                if (by === 0) return;
                void this.open(next);
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
        const scenes = [...SCENES].flatMap(([folder, names]) =>
            names.map((name) => [`scene ${folder}/${name}`, `${folder}: ${name}`] as const),
        );
        const groups = [
            { name: texts.groups.maps, options: Object.entries(texts.bundled) },
            { name: texts.groups.scenes, options: scenes },
        ];
        const maps = grouped(texts.map, groups, this.state.map, (map) => {
            if (this.source.isKnown(map)) void this.choose(map);
        });
        this.maps = maps.querySelector("select");
        const tools = Object.entries(texts.tools);
        const pointer = choice(texts.pointer, tools, "move", (tool) => {
            this.pointer.tool = tool as Tool;
        });
        this.tools = pointer.querySelector("select");
        element("controls").append(
            maps,
            box,
            pointer,
            this.makePlaces(),
            button(texts.whole, () => {
                this.view.fit();
                this.redraw();
            }),
            button(texts.share, () => void this.share()),
            button(texts.savePng, () => {
                this.view.canvas.toBlob((picture) => picture && save("keyway.png", picture));
            }),
            button(texts.saveSvg, () => {
                save(
                    "keyway.svg",
                    this.view.svg(() => this.draw()),
                );
            }),
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
        const isFixed = !this.has().ends;
        const { obstacles, walls } = this.has();
        const can: Record<string, boolean> = { wall: walls, disc: obstacles, walker: obstacles };
        for (const option of this.tools?.options ?? []) {
            option.disabled = can[option.value] === false;
        }
        this.places.forEach((field, i) => {
            field.set(numbers[i]!);
            field.input.disabled = isFixed;
        });
    }

    private async share(): Promise<void> {
        if (this.state.drawn.length > LIMITS.drawn) {
            this.say(null, texts.tooManyWalls(LIMITS.drawn));
            return;
        }
        const isWhole = await this.putLink();
        if (!isWhole) {
            this.say(null, texts.mapTooLarge);
            return;
        }
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
    document.documentElement.lang = texts.language;
    for (const [id, label] of Object.entries(texts.regions)) {
        element(id).setAttribute("aria-label", label);
    }
    try {
        const { state, files } = await fromFragment(location.hash.slice(1));
        await new App(state).start(files);
    } catch (error) {
        element("status").textContent = texts.notStarted(String(error));
        throw error;
    }
    document.body.dataset["ready"] = "true";
}

void main();
