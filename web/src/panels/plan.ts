/** A path, planned again whenever something changes. */

import { doubles } from "../engine/message";
import type { RouteReport } from "../engine/types";
import type { View } from "../draw/view";
import type { Pair } from "../state";
import { texts } from "../texts";
import { check, choice, facts, legend, metres, named, number } from "./controls";
import { failure, Latest, type Page, type Panel } from "./panel";

export class PlanPanel implements Panel {
    readonly element = document.createElement("div");
    readonly hasEnds = true;
    private readonly result = document.createElement("div");
    private line: Pair[] = [];
    private smoothed: Pair[] = [];
    private shortest: Pair[] = [];
    private readonly latest = new Latest((stop) => this.plan(stop));

    constructor(private readonly page: Page) {
        const { state, names } = page;
        const set = (change: () => void) => {
            change();
            page.changed();
        };
        this.element.append(
            choice(texts.planner, named(names.planners), state.planner, (name) =>
                set(() => (state.planner = name)),
            ),
            choice(texts.smoother, named(names.smoothers), state.smoother, (name) =>
                set(() => (state.smoother = name)),
            ),
            number(texts.radius, state.radius_m, { min: 0, step: 0.05 }, (radius) =>
                set(() => (state.radius_m = radius)),
            ).element,
            check(texts.shortest, state.shortest, (shown) => set(() => (state.shortest = shown))),
            this.result,
            legend(Object.entries(texts.plan.legend)),
        );
    }

    refresh(): Promise<void> {
        return this.latest.run();
    }

    leave(): void {
        this.latest.stop();
    }

    private async plan(stop: AbortSignal): Promise<void> {
        const { engine, state } = this.page;
        const { planner, smoother, radius_m, start, goal } = state;
        const question = { ask: "plan", planner, smoother, radius_m, start, goal };
        const begin = performance.now();
        try {
            const { head, parts } = await this.page.working(stop, (signal) =>
                engine.ask<RouteReport>(question, {}, signal),
            );
            this.line = pairs(parts["line"]);
            this.smoothed = pairs(parts["smoothed"]);
            this.shortest = [];
            this.show(head, performance.now() - begin);
            this.page.redraw();
            // It takes longer than the plan, so a drag does not wait for it.
            if (!state.shortest || this.latest.isOver || head.outcome !== "found") return;
            const again = { ...question, smoother: "none", with_shortest: true };
            const answer = await this.page.working(stop, (signal) =>
                engine.ask<RouteReport>(again, {}, signal),
            );
            this.shortest = pairs(answer.parts["shortest"]);
        } catch (error) {
            [this.line, this.smoothed, this.shortest] = [[], [], []];
            this.result.replaceChildren();
            this.page.say(this, failure(error));
        }
        this.page.redraw();
    }

    private show(report: RouteReport, time_ms: number): void {
        const words = texts.plan;
        if (report.outcome !== "found") {
            this.result.replaceChildren();
            this.page.say(this, `${texts.noPath}: ${report.why ?? report.outcome}`);
            return;
        }
        this.result.replaceChildren(
            facts([
                [words.length, metres(report.length_m)],
                [words.smoothed, metres(report.smoothed?.length_m)],
                [
                    words.clearance,
                    metres(report.smoothed?.min_clearance_m ?? report.min_clearance_m),
                ],
                [words.turns, String(report.turns ?? "-")],
                [words.expanded, String(report.expanded)],
                [words.time, `${time_ms.toFixed(1)} ms`],
            ]),
        );
        const length = metres(report.smoothed?.length_m ?? report.length_m);
        this.page.say(this, texts.found(length, report.turns ?? 0));
    }

    draw(view: View): void {
        const { line, smoothed, shortest } = view.colors;
        view.line(this.shortest, shortest, 2, [1, 4]);
        view.line(this.line, line, 1.5, this.smoothed.length > 0 ? [4, 4] : []);
        view.line(this.smoothed, smoothed, 3);
    }
}

export function pairs(part: Uint8Array | undefined): Pair[] {
    const numbers = doubles(part);
    return Array.from({ length: numbers.length / 2 }, (_, i) => [
        numbers[2 * i]!,
        numbers[2 * i + 1]!,
    ]);
}
