/** The claims of the four papers, measured in this page. */

import type { ClaimFacts, ClaimMap, Judged } from "../engine/types";
import { SERIES, type View } from "../draw/view";
import { LIMITS, type Pair } from "../state";
import { texts } from "../texts";
import {
    button,
    check,
    decimals,
    grouped,
    legend,
    number,
    table,
    type NumberField,
} from "./controls";
import { failure, Job, Latest, type Page, type Panel } from "./panel";
import { pairs } from "./plan";

export class PapersPanel implements Panel {
    readonly element = document.createElement("div");
    readonly hasEnds = false;
    private readonly about = document.createElement("div");
    private readonly methods = document.createElement("div");
    readonly wide = document.createElement("div");
    private readonly job = new Job(
        texts.papers.measure,
        (stop) => this.judge(stop),
        (text) => this.page.say(this, text),
    );
    private readonly scene: HTMLElement;
    private readonly seed: NumberField;
    private discs: [number, number, number][] = [];
    private movers: [number, number, number][] = [];
    private readonly choices = document.createElement("div");
    private claims: ClaimFacts[] = [];
    private lines: Pair[][] = [];
    private readonly latest = new Latest((stop) => this.open(stop));

    constructor(private readonly page: Page) {
        const { state } = page;
        const set = (change: () => void) => {
            change();
            page.changed();
        };
        const bounds = (most: number) => ({ min: 1, max: most, step: 1 });
        this.scene = check(texts.papers.scene, state.paperScene, (shown) =>
            set(() => (state.paperScene = shown)),
        );
        this.seed = number(texts.papers.seed, state.claimSeed, bounds(LIMITS.seed), (seed) =>
            set(() => (state.claimSeed = seed)),
        );
        this.element.append(
            this.choices,
            this.about,
            this.scene,
            this.seed.element,
            button(texts.papers.keep, () => page.keepMap()),
            this.methods,
            number(texts.papers.maps, state.claimMaps, bounds(LIMITS.claimMaps), (maps) =>
                set(() => (state.claimMaps = maps)),
            ).element,
            this.job.button,
        );
    }

    private get claim(): ClaimFacts | undefined {
        return this.claims.find(({ id }) => id === this.page.state.claim) ?? this.claims[0];
    }

    /** The map of the claim, with a seed, or that of the paper. */
    private get question() {
        const claim = this.claim;
        const isScene = this.page.state.paperScene && claim?.has_scene;
        return { id: claim?.id ?? "", seed: isScene ? null : this.page.state.claimSeed };
    }

    refresh(): Promise<void> {
        this.job.stop();
        return this.latest.run();
    }

    leave(): void {
        this.job.stop();
        this.latest.stop();
    }

    private async open(stop: AbortSignal): Promise<void> {
        const { engine, working, say, showMap } = this.page;
        this.wide.replaceChildren();
        try {
            if (this.claims.length === 0) {
                this.claims = (await engine.ask<ClaimFacts[]>({ ask: "claims" })).head;
                this.showChoices();
            }
            const claim = this.claim;
            if (!claim) return;
            this.showAbout(claim);
            this.scene.hidden = !claim.has_scene;
            this.seed.input.disabled = this.question.seed === null;
            const question = { ask: "open_claim", ...this.question };
            const { head, parts } = await working(stop, (signal) =>
                engine.ask<ClaimMap>(question, {}, signal),
            );
            const names = `claim ${claim.id} ${question.seed ?? ""}`.trim();
            [this.page.state.start, this.page.state.goal] = head.ends;
            showMap(head.map, parts["cells"] ?? new Uint8Array(), names);
            this.lines = claim.methods.map((_, i) => pairs(parts[`line ${i}`]));
            [this.discs, this.movers] = [head.discs, head.movers];
            const length = (i: number) => {
                const text = decimals(head.lengths_m[i]);
                return head.is_cut_off[i] ? texts.papers.cutOff(text) : text;
            };
            const rows = claim.methods.map((name, i) => [name, length(i)]);
            this.methods.replaceChildren(
                legend(claim.methods.map((name, i) => [`series-${i % SERIES}`, name])),
                table([texts.papers.method, texts.papers.length], rows),
            );
            say(this, texts.papers.shown(claim.id, head.map.name));
        } catch (error) {
            say(this, failure(error));
        }
        this.page.redraw();
    }

    private showChoices(): void {
        const papers = [...new Set(this.claims.map(({ paper }) => paper))];
        const groups = papers.map((paper) => ({
            name: texts.papers.titles[paper] ?? paper,
            options: this.claims
                .filter((claim) => claim.paper === paper)
                .map(({ id, statement }) => [id, `${id}: ${statement}`] as const),
        }));
        this.choices.replaceChildren(
            grouped(texts.papers.claim, groups, this.claim?.id ?? "", (id) => {
                this.page.state.claim = id;
                this.page.changed();
            }),
        );
    }

    private showAbout(claim: ClaimFacts): void {
        const lines = [claim.statement, `${texts.papers.titles[claim.paper] ?? claim.paper}.`];
        const parts = [...lines, `${texts.papers.family}: ${claim.about}`].map((text) => {
            const line = document.createElement("p");
            line.textContent = text;
            return line;
        });
        this.about.replaceChildren(...parts);
    }

    /** Measures map by map; the verdict so far is shown. */
    private async judge(outer: AbortSignal): Promise<void> {
        const { engine, state, say, working } = this.page;
        const claim = this.claim;
        if (!claim) return;
        await working(outer, async (stop) => {
            const measured = (seed: number | null) =>
                engine.ask<unknown>({ ask: "measure_claim", id: claim.id, seed }, {}, stop);
            const scene = claim.has_scene ? (await measured(null)).head : null;
            const rows: unknown[] = [];
            while (rows.length < state.claimMaps) {
                say(this, texts.papers.measuring(rows.length, state.claimMaps));
                rows.push((await measured(state.claimSeed + rows.length)).head);
                if (rows.length % 5 !== 0 && rows.length < state.claimMaps) continue;
                const question = { ask: "judge_claim", id: claim.id, rows, scene };
                this.showVerdict((await engine.ask<Judged>(question, {}, stop)).head);
            }
        });
        say(this, texts.papers.measured(claim.id, state.claimMaps));
    }

    private showVerdict({ report, figures }: Judged): void {
        const words = texts.papers;
        const verdict = document.createElement("p");
        const { maps, left_out } = report.family;
        verdict.textContent = words.verdict(words.verdicts[report.verdict] ?? report.verdict);
        verdict.append(` ${words.over(maps, left_out)}`);
        const rows = figures.map(({ statement, published, measured, verdict }) => [
            statement,
            published,
            measured,
            verdict === null ? "-" : (words.verdicts[verdict] ?? verdict),
        ]);
        this.wide.replaceChildren(verdict, table(words.header, rows));
    }

    draw(view: View): void {
        for (const [x, y, radius_m] of this.discs) {
            view.disc([x, y], view.pixels(radius_m), view.colors.disc);
        }
        for (const [x, y, radius_m] of this.movers) {
            view.disc([x, y], view.pixels(radius_m), view.colors.mover);
        }
        this.lines.forEach((line, i) => {
            view.line(line, view.colors.series[i % SERIES] ?? "", 4 - Math.min(3, i * 0.6));
        });
    }
}
