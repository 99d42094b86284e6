/** A drive in the simulator, moment by moment, and the reasons of each. */

import { integers, singles } from "../engine/message";
import { Stopped } from "../engine/engine";
import type { CycleReport, Driven } from "../engine/types";
import type { View } from "../draw/view";
import { sceneFile, WALKER_RADIUS_M, type Pair } from "../state";
import { texts } from "../texts";
import { button, choice, facts, metres, named, number, Player, slider } from "./controls";
import { failure, type Page, type Panel } from "./panel";

export class DrivePanel implements Panel {
    readonly element = document.createElement("div");
    private readonly result = document.createElement("div");
    private readonly moment = document.createElement("div");
    private readonly slider = slider(texts.time, (cycle) => this.showCycle(cycle));
    private readonly player = new Player(texts, () => this.forward());
    private readonly drive = button(texts.drive, () => void this.run());
    private readonly stop = button(texts.stop, () => this.running?.abort());
    private readonly report = button(texts.saveReport, () => {
        save("report.json", JSON.stringify(this.driven?.reports[0]));
    });
    private running: AbortController | null = null;
    private driven: Driven | null = null;
    private hits: Pair[][] = [];
    private sensed: Pair[][] = [];
    private movers: Float32Array = new Float32Array();
    private shown = 0;

    constructor(private readonly page: Page) {
        const { state, names } = page;
        [this.stop.disabled, this.report.disabled] = [true, true];
        this.element.append(
            choice(texts.stack, named(names.stacks), state.stack, (name) => {
                state.stack = name;
                page.changed();
            }),
            choice(texts.robot, named(names.robots), state.robot, (name) => {
                state.robot = name;
                page.changed();
            }),
            number(texts.seed, state.seed, { min: 0, step: 1 }, (seed) => {
                state.seed = seed;
                page.changed();
            }).element,
            number(texts.delay, state.delay_s, { min: 0, max: 1, step: 0.05 }, (delay) => {
                state.delay_s = delay;
                page.changed();
            }).element,
            number(texts.noise, state.noise_m, { min: 0, max: 0.2, step: 0.01 }, (noise) => {
                state.noise_m = noise;
                page.changed();
            }).element,
            this.drive,
            this.stop,
            button(texts.saveScene, () => this.saveScene()),
            this.report,
            this.result,
            this.slider.element,
            this.player.button,
            this.moment,
        );
    }

    /** What was driven before is no longer true, and what is driven just now not needed. */
    async refresh(): Promise<void> {
        this.running?.abort();
        this.clear();
        this.page.say(this, texts.driving.ready);
    }

    leave(): void {
        this.player.stop();
        this.running?.abort();
    }

    private clear(): void {
        this.player.stop();
        [this.driven, this.hits, this.sensed] = [null, [], []];
        this.report.disabled = true;
        this.result.replaceChildren();
        this.moment.replaceChildren();
        this.slider.set(0, 0);
        this.page.redraw();
    }

    private async run(): Promise<void> {
        const { engine, state, say, mapName } = this.page;
        this.clear();
        const running = new AbortController();
        this.running = running;
        [this.drive.disabled, this.stop.disabled] = [true, false];
        say(this, texts.working);
        try {
            const question = { ask: "drive", scene: sceneFile(state, mapName()) };
            const { head, parts } = await engine.ask<Driven>(question, {}, running.signal);
            if (running.signal.aborted) return;
            this.driven = head;
            this.report.disabled = false;
            this.hits = lists(integers(parts["hits 0"]), singles(parts["hits 0"]));
            const sensed = integers(parts["sensed 0"]);
            this.sensed = lists(sensed, sensed);
            this.movers = singles(parts["movers 0"]);
            this.showReport(head);
            this.showCycle(0);
        } catch (error) {
            say(this, error instanceof Stopped ? texts.stopped : failure(error));
        } finally {
            [this.drive.disabled, this.stop.disabled] = [false, true];
            this.running = null;
        }
    }

    private saveScene(): void {
        const { state, mapName, say } = this.page;
        save("scene.toml", sceneFile(state, mapName()));
        if (state.drawn.length > 0) say(this, texts.notInScene);
    }

    private showReport({ reports }: Driven): void {
        const report = reports[0];
        if (!report) return;
        const words = texts.driving;
        const seconds = report.run ? `${report.run.time_s.toFixed(1)} s` : "-";
        this.result.replaceChildren(
            facts([
                [
                    words.outcome,
                    report.reason ? `${report.outcome}: ${report.reason}` : report.outcome,
                ],
                [words.runTime, seconds],
                [words.length, metres(report.run?.length_m)],
                [words.clearance, metres(report.run?.min_clearance_m)],
            ]),
        );
        this.page.say(this, words.driven(report.outcome, seconds));
    }

    private get cycles(): CycleReport[] {
        return this.driven?.cycles[0] ?? [];
    }

    private forward(): boolean {
        const last = this.cycles.length - 1;
        this.showCycle(this.shown >= last ? 0 : this.shown + 1);
        return this.shown < last;
    }

    private showCycle(shown: number): void {
        this.shown = shown;
        this.slider.set(shown, Math.max(0, this.cycles.length - 1));
        const cycle = this.cycles[shown];
        if (cycle) {
            this.slider.input.setAttribute("aria-valuetext", `${cycle.t_s.toFixed(1)} s`);
            this.moment.replaceChildren(...reasons(cycle));
        }
        this.page.redraw();
    }

    draw(view: View): void {
        const cycle = this.cycles[this.shown];
        const colors = view.colors;
        if (!this.driven || !cycle) {
            for (const { from } of this.page.state.walkers) {
                view.disc(from, view.pixels(WALKER_RADIUS_M), colors.mover);
            }
            return;
        }
        const side = Math.max(2, view.pixels(view.facts?.resolution_m ?? 1));
        view.context.fillStyle = colors.sensed;
        for (const cells of this.sensed.slice(0, this.shown + 1)) {
            for (const cell of cells) {
                const [x, y] = view.toScreen(view.centre(cell));
                view.context.fillRect(x - side / 2, y - side / 2, side, side);
            }
        }
        const routes = this.driven.routes[0] ?? [];
        const route = routes.filter(([from]) => from <= cycle.cycle).at(-1)?.[1] ?? [];
        view.line(route, colors.line, 1.5, [4, 4]);
        const way = this.cycles
            .slice(0, this.shown + 1)
            .map(({ pose }): Pair => [pose[0], pose[1]]);
        view.line(way, colors.smoothed, 3);
        for (const hit of this.hits[this.shown] ?? []) {
            view.disc(hit, 1.5 * (window.devicePixelRatio || 1), colors.hit);
        }
        this.driven.mover_radii_m.forEach((radius_m, mover) => {
            const at = 2 * (this.shown * this.driven!.mover_radii_m.length + mover);
            const place: Pair = [this.movers[at]!, this.movers[at + 1]!];
            view.disc(place, view.pixels(radius_m), colors.mover);
        });
        const [x, y, yaw] = cycle.pose;
        const { radius_m, vertices } = this.driven.outlines[0]!;
        if (radius_m === null) view.polygon(vertices, cycle.pose, colors.robot);
        else view.disc([x, y], view.pixels(radius_m), colors.robot);
        const tip: Pair = [x + 0.4 * Math.cos(yaw), y + 0.4 * Math.sin(yaw)];
        view.line([[x, y], tip], colors.robot, 3);
    }
}

/** Gives the browser a file to keep. */
function save(name: string, content: string): void {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([content]));
    link.download = name;
    link.click();
    URL.revokeObjectURL(link.href);
}

/** A moment in words and numbers. */
function reasons(cycle: CycleReport): HTMLElement[] {
    const words = texts.driving;
    const speeds = (it: { v_mps: number; omega_radps: number } | null) =>
        it ? `${it.v_mps.toFixed(2)} m/s, ${it.omega_radps.toFixed(2)} rad/s` : words.standing;
    const rows: (readonly [string, string])[] = [
        [words.now, `${cycle.t_s.toFixed(1)} s`],
        [words.step, cycle.reason ? `${cycle.step}: ${cycle.reason}` : cycle.step],
        [words.velocity, speeds(cycle.velocity)],
        [words.command, speeds(cycle.command)],
        [words.remaining, metres(cycle.remaining_m)],
        [words.candidates, `${cycle.candidates}`],
    ];
    for (const { because, count } of cycle.rejected.filter(({ count }) => count > 0)) {
        rows.push([words.rejected, `${because}: ${count}`]);
    }
    const shares = cycle.chosen?.shares ?? [];
    const why = shares.map(({ term, weighted }) => `${term} ${weighted.toFixed(2)}`).join(", ");
    if (why) rows.push([words.reasons, why]);
    return [facts(rows)];
}

/** For each cycle a count, and as many pairs. */
function lists(counts: Int32Array, numbers: Int32Array | Float32Array): Pair[][] {
    const all: Pair[][] = [];
    for (let at = 0; at < counts.length;) {
        const count = counts[at++]!;
        all.push(
            Array.from({ length: count }, (_, i) => [
                numbers[at + 2 * i]!,
                numbers[at + 2 * i + 1]!,
            ]),
        );
        at += 2 * count;
    }
    return all;
}
