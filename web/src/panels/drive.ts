/** A drive in the simulator, moment by moment, and the reasons of each. */

import type { Answer } from "../engine/engine";
import { Film } from "../engine/film";
import type { CycleReport, Driven, RobotReport, Speeds } from "../engine/types";
import { drawBelieved, drawMind, drawMovers, drawRobot } from "../draw/drive";
import { SERIES, type View } from "../draw/view";
import { driveQuestion, sceneFile, WALKER_RADIUS_M } from "../state";
import { texts } from "../texts";
import {
    button,
    check,
    choice,
    facts,
    legend,
    metres,
    Moments,
    named,
    number,
    range,
    save,
    table,
} from "./controls";
import { Job, type Page, type Panel } from "./panel";

export class DrivePanel implements Panel {
    readonly element = document.createElement("div");
    private readonly controls = document.createElement("div");
    private readonly result = document.createElement("div");
    private readonly moment = document.createElement("div");
    private readonly moments = new Moments(texts, (cycle) => this.showCycle(cycle));
    private readonly job = new Job(
        texts.drive,
        (stop) => this.run(stop),
        (text) => this.page.say(this, text),
    );
    private readonly report = button(texts.saveReport, () => {
        const { reports } = this.driven ?? { reports: [] };
        save("report.json", JSON.stringify(reports.length === 1 ? reports[0] : reports));
    });
    private readonly whose = document.createElement("div");
    private driven: Driven | null = null;
    private films: Film[] = [];
    /** The robot whose mind is shown. */
    private robot = 0;
    private hasReasons = false;
    /** The scene for which the controls were made. */
    private controlled: unknown = undefined;

    constructor(private readonly page: Page) {
        this.report.disabled = true;
        this.element.append(
            this.controls,
            this.job.button,
            button(texts.saveScene, () => this.saveScene()),
            this.report,
            this.result,
            this.moments.slider.element,
            this.moments.player.button,
            check(texts.fan, page.state.fan, (shown) => {
                page.state.fan = shown;
                page.redraw();
            }),
            button(texts.zoomToRobot, () => {
                const pose = this.films[this.robot]?.cycle(this.moments.shown)?.pose;
                if (pose) page.lookAt([pose[0], pose[1]], 5);
            }),
            this.whose,
            this.moment,
            legend(Object.entries(texts.driving.legend)),
        );
    }

    get hasEnds(): boolean {
        return this.page.scene === null;
    }

    private makeControls(): void {
        const { state, names, scene } = this.page;
        if (this.controlled === scene && this.controls.hasChildNodes()) return;
        this.controlled = scene;
        const set = (change: () => void) => {
            change();
            this.page.changed();
        };
        const own = [["", texts.asInScene]] as const;
        const seed = number(texts.seed, state.seed, { min: 0, step: 1 }, (value) =>
            set(() => (state.seed = value)),
        );
        if (scene) {
            this.controls.replaceChildren(
                choice(texts.stack, [...own, ...named(names.stacks)], state.sceneStack, (name) =>
                    set(() => (state.sceneStack = name)),
                ),
                seed.element,
            );
            return;
        }
        const disturbance = (label: string, field: "delay_s" | "noise_m", max: number) =>
            range(label, state[field], { min: 0, max, step: 0.01 }, (value) =>
                set(() => (state[field] = value)),
            );
        this.controls.replaceChildren(
            choice(texts.stack, named(names.stacks), state.stack, (name) =>
                set(() => (state.stack = name)),
            ),
            choice(texts.robot, named(names.robots), state.robot, (name) =>
                set(() => (state.robot = name)),
            ),
            seed.element,
            disturbance(texts.delay, "delay_s", 1),
            disturbance(texts.noise, "noise_m", 0.2),
        );
    }

    /** The last drive is no longer true, and one that goes on is not needed. */
    async refresh(): Promise<void> {
        this.job.stop();
        this.makeControls();
        this.clear();
        this.page.say(this, this.page.scene ? texts.driving.readyScene : texts.driving.ready);
    }

    leave(): void {
        this.moments.player.stop();
        this.job.stop();
    }

    private clear(): void {
        [this.driven, this.films, this.robot] = [null, [], 0];
        this.report.disabled = true;
        this.moments.begin([]);
        for (const part of [this.result, this.moment, this.whose]) part.replaceChildren();
    }

    private async run(stop: AbortSignal): Promise<void> {
        const { engine, state, working, mapName } = this.page;
        this.clear();
        const question = driveQuestion(state, mapName());
        const ask = (without_reasons: boolean, text?: string) =>
            working(
                stop,
                (stop) => engine.ask<Driven>({ ...question, without_reasons }, {}, stop),
                text,
            );
        this.hasReasons = false;
        const outcome = this.take(await ask(true));
        this.showWhose();
        this.moments.begin(this.films.map(({ cycles }) => cycles.length));
        // Reasons take several times as long as the drive.
        const explained = await ask(false, texts.driving.explaining(outcome));
        this.hasReasons = true;
        this.take(explained);
        this.moments.show(this.moments.shown);
    }

    private take({ head, parts }: Answer<Driven>): string {
        this.driven = head;
        this.films = head.reports.map((_, robot) => new Film(head, parts, robot));
        this.report.disabled = false;
        return this.showReport(head);
    }

    private saveScene(): void {
        const { state, mapName, say } = this.page;
        save("scene.toml", state.scene ?? sceneFile(state, mapName()));
        if (state.scene !== null) {
            const { sceneStack, seed } = state;
            const stack = sceneStack === "" ? "" : ` --stack ${sceneStack}`;
            say(this, texts.sceneCommand(`${stack} --seed ${seed}`));
        }
        if (state.drawn.length > 0) say(this, texts.notInScene);
    }

    /** Shows the report, and returns what it says. */
    private showReport({ reports }: Driven): string {
        const words = texts.driving;
        const one = reports.length === 1;
        const header = one ? [] : ["", ...reports.map((_, robot) => words.robot(robot + 1))];
        const outcome = ({ outcome, reason }: RobotReport) =>
            reason ? `${outcome}: ${reason}` : outcome;
        const seconds = ({ run }: RobotReport) => (run ? `${run.time_s.toFixed(1)} s` : "-");
        const rows = [
            [words.outcome, ...reports.map(outcome)],
            [words.runTime, ...reports.map(seconds)],
            [words.length, ...reports.map(({ run }) => metres(run?.length_m))],
            [words.clearance, ...reports.map(({ run }) => metres(run?.min_clearance_m))],
        ];
        this.result.replaceChildren(table(header, rows));
        const ends = reports.map((report) => words.driven(report.outcome, seconds(report)));
        const text = one ? ends.join() : ends.map((end, i) => `${i + 1}: ${end}`).join("; ");
        this.page.say(this, text);
        return text;
    }

    /** Chooses the robot whose mind is shown, where there are several. */
    private showWhose(): void {
        if (this.films.length < 2) return;
        const robots = this.films.map((_, i) => [String(i), String(i + 1)] as const);
        this.whose.replaceChildren(
            choice(texts.whose, robots, "0", (robot) => {
                this.robot = Number(robot);
                this.moments.show(this.moments.shown);
            }),
        );
    }

    /** Shows a cycle, and returns its time. */
    private showCycle(shown: number): number {
        const film = this.films[this.robot];
        const cycle = film?.cycle(shown);
        if (cycle)
            this.moment.replaceChildren(reasons(cycle, film?.refusal(shown), this.hasReasons));
        this.page.redraw();
        return cycle?.t_s ?? 0;
    }

    draw(view: View): void {
        const { colors } = view;
        const { shown } = this.moments;
        const film = this.films[this.robot];
        if (!film?.cycle(shown)) {
            for (const { from } of this.page.scene ? [] : this.page.state.walkers) {
                view.disc(from, view.pixels(WALKER_RADIUS_M), colors.mover);
            }
            for (const [x, y, radius_m] of this.page.scene?.movers ?? []) {
                view.disc([x, y], view.pixels(radius_m), colors.mover);
            }
            return;
        }
        drawMind(view, film, shown, this.page.state.fan);
        drawMovers(view, this.films, shown);
        this.films.forEach((one, i) => {
            const several = colors.series[i % SERIES] ?? colors.robot;
            drawRobot(view, one, shown, this.films.length > 1 ? several : colors.robot);
        });
        drawBelieved(view, film, shown);
    }
}

/** A moment in words and numbers. */
function reasons(
    cycle: CycleReport,
    refusal: string | undefined,
    hasReasons: boolean,
): HTMLElement {
    const words = texts.driving;
    const speeds = (it: Speeds | null) =>
        it ? `${it.v_mps.toFixed(2)} m/s, ${it.omega_radps.toFixed(2)} rad/s` : words.standing;
    const rows: (readonly [string, string])[] = [
        [words.now, `${cycle.t_s.toFixed(1)} s`],
        [words.step, cycle.reason ? `${cycle.step}: ${cycle.reason}` : cycle.step],
        [words.velocity, speeds(cycle.velocity)],
        [words.command, speeds(cycle.command)],
        [words.stopRule, refusal ?? words.letPass],
        [words.remaining, metres(cycle.remaining_m)],
        [words.movers, String(cycle.movers.length)],
        [words.candidates, hasReasons ? `${cycle.candidates}` : words.notYet],
    ];
    for (const { because, count } of cycle.rejected.filter(({ count }) => count > 0)) {
        rows.push([words.rejected, `${because}: ${count}`]);
    }
    const shares = cycle.chosen?.shares ?? [];
    const why = shares.map(({ term, weighted }) => `${term} ${weighted.toFixed(2)}`).join(", ");
    if (why) rows.push([words.reasons, why]);
    return facts(rows);
}
