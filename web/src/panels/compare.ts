/** Planners on the same queries, and stacks in the same world. */

import { Film } from "../engine/film";
import type { Comparison, Driven, Row, Summary } from "../engine/types";
import { drawMovers, drawRobot } from "../draw/drive";
import { SERIES, type View } from "../draw/view";
import { driveQuestion, LIMITS } from "../state";
import { texts } from "../texts";
import { button, checks, choice, decimals, legend, Moments, number, save, table } from "./controls";
import { Job, type Page, type Panel } from "./panel";

export class ComparePanel implements Panel {
    readonly element = document.createElement("div");
    private readonly controls = document.createElement("div");
    readonly wide = document.createElement("div");
    private readonly race = document.createElement("div");
    private readonly colors = document.createElement("div");
    private readonly moments = new Moments(texts, (cycle) => this.timeOf(cycle));
    private readonly job = new Job(
        texts.compareNow,
        (stop) => this.run(stop),
        (text) => this.page.say(this, text),
    );
    /** The first drive of each stack, with all its robots. */
    private runners: { stack: string; films: Film[] }[] = [];

    constructor(private readonly page: Page) {
        const what = Object.entries(texts.compared);
        this.race.append(this.moments.slider.element, this.moments.player.button, this.colors);
        this.element.append(
            choice(texts.compareWhat, what, page.state.compared, (what) => {
                page.state.compared = what as keyof typeof texts.compared;
                this.makeControls();
                page.changed();
            }),
            this.controls,
            this.job.button,
            this.race,
        );
        this.makeControls();
    }

    get hasEnds(): boolean {
        return this.page.state.compared === "stacks" && this.page.scene === null;
    }

    private makeControls(): void {
        const { state, names } = this.page;
        const set = (change: () => void) => {
            change();
            this.page.changed();
        };
        const count = (label: string, field: "queries" | "runs" | "seed") => {
            const bounds = { min: field === "seed" ? 0 : 1, max: LIMITS[field], step: 1 };
            return number(label, state[field], bounds, (value) => set(() => (state[field] = value)))
                .element;
        };
        const list = (
            label: string,
            all: string[],
            field: "planners" | "smoothers" | "stacks",
        ): HTMLElement =>
            checks(label, all, state[field], (chosen) => set(() => (state[field] = chosen)));
        if (state.compared === "planners") {
            this.controls.replaceChildren(
                list(texts.planners, names.planners, "planners"),
                list(texts.smoothers, names.smoothers, "smoothers"),
                count(texts.queries, "queries"),
                count(texts.seed, "seed"),
            );
        } else {
            this.controls.replaceChildren(
                list(texts.stacks, names.stacks, "stacks"),
                count(texts.runs, "runs"),
                count(texts.seed, "seed"),
            );
        }
    }

    async refresh(): Promise<void> {
        const { compared, stacks, planners, smoothers } = this.page.state;
        const lists = compared === "stacks" ? [stacks] : [planners, smoothers];
        this.job.stop(lists.some((list) => list.length === 0));
        this.clear();
        this.page.say(this, texts.comparing.ready[compared]);
    }

    leave(): void {
        this.moments.player.stop();
        this.job.stop();
    }

    private clear(): void {
        this.runners = [];
        this.moments.begin([]);
        this.race.hidden = true;
        this.wide.replaceChildren();
    }

    private run(stop: AbortSignal): Promise<void> {
        this.clear();
        return this.page.working(stop, (stop) =>
            this.page.state.compared === "planners"
                ? this.comparePlanners(stop)
                : this.raceStacks(stop),
        );
    }

    private async comparePlanners(stop: AbortSignal): Promise<void> {
        const { engine, state, say } = this.page;
        const { planners, smoothers, radius_m, queries, seed } = state;
        const question = { ask: "compare", planners, smoothers, radius_m, queries, seed };
        const { head } = await engine.ask<Comparison>(question, {}, stop);
        this.wide.replaceChildren(
            table(head.header, head.rows),
            button("CSV", () => save("compare.csv", head.csv)),
            button(texts.answersCsv, () => save("queries.csv", head.queries_csv)),
            button("LaTeX", () => save("compare.tex", head.latex)),
            button("JSON", () => save("compare.json", JSON.stringify(head.report))),
        );
        say(this, texts.comparing.done(head.rows.length));
    }

    /** Run by run: what is done so far is shown. */
    private async raceStacks(stop: AbortSignal): Promise<void> {
        const { engine, state, say, mapName } = this.page;
        const rows: Row[] = [];
        for (let run = 0; run < state.runs; run++) {
            for (const stack of state.stacks) {
                say(this, texts.comparing.running(rows.length, state.runs * state.stacks.length));
                const question = {
                    ...driveQuestion({ ...state, stack, sceneStack: stack }, mapName()),
                    seed: state.seed + run,
                    reports_only: run > 0,
                    without_reasons: true,
                };
                const { head, parts } = await engine.ask<Driven>(question, {}, stop);
                if (stop.aborted) return;
                rows.push(head.row);
                const films = head.cycles.map((_, robot) => new Film(head, parts, robot));
                if (run === 0) this.runners.push({ stack, films });
            }
            const { head } = await engine.ask<Summary>({ ask: "summary", rows }, {}, stop);
            this.showSummary(head);
            if (run > 0) continue;
            this.showColors();
            this.race.hidden = false;
            this.moments.begin(this.films.map(({ cycles }) => cycles.length));
        }
        say(this, texts.comparing.done(state.stacks.length));
    }

    private showSummary(summary: Summary): void {
        const words = texts.comparing;
        const rows = summary.stacks.map((stack) => [
            stack.stack,
            `${stack.reached}/${stack.runs}`,
            String(stack.contacts_driving + stack.contacts_standing),
            String(stack.stuck + stack.timeout + stack.no_path),
            decimals(stack.mean_time_s, 1),
            decimals(stack.mean_length_m),
            decimals(stack.least_clearance_m),
        ]);
        const whole = document.createElement("details");
        const [title, text] = [document.createElement("summary"), document.createElement("pre")];
        [title.textContent, text.textContent, text.tabIndex] = [words.whole, summary.text, 0];
        whole.append(title, text);
        this.wide.replaceChildren(
            table(words.header, rows),
            whole,
            button("CSV", () => save("summary.csv", summary.csv)),
            button(texts.runsCsv, () => save("runs.csv", summary.runs_csv)),
            button("Markdown", () => save("summary.md", summary.markdown)),
            button("LaTeX", () => save("summary.tex", summary.latex)),
        );
    }

    private showColors(): void {
        const colors = this.runners.map(({ stack }, i) => [`series-${i % SERIES}`, stack] as const);
        this.colors.replaceChildren(legend(colors));
    }

    private get films(): Film[] {
        return this.runners.flatMap(({ films }) => films);
    }

    private timeOf(cycle: number): number {
        this.page.redraw();
        const going = this.films.find(({ cycles }) => cycles.length > cycle);
        return going?.cycle(cycle)?.t_s ?? 0;
    }

    draw(view: View): void {
        drawMovers(view, this.films, this.moments.shown);
        this.runners.forEach(({ films }, i) => {
            const color = view.colors.series[i % SERIES] ?? "";
            for (const film of films) drawRobot(view, film, this.moments.shown, color);
        });
    }
}
