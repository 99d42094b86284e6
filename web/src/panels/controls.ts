/** Parts of forms, each with a label that belongs to it. */

let count = 0;

function labelled(label: string, control: HTMLElement): HTMLElement {
    control.id = `control-${count++}`;
    const text = document.createElement("label");
    text.htmlFor = control.id;
    text.textContent = label;
    const box = document.createElement("div");
    box.className = "field";
    box.append(text, control);
    return box;
}

export function choice(
    label: string,
    options: readonly (readonly [string, string])[],
    value: string,
    changed: (value: string) => void,
): HTMLElement {
    const select = document.createElement("select");
    for (const [name, text] of options) select.add(new Option(text, name, false, name === value));
    select.onchange = () => changed(select.value);
    return labelled(label, select);
}

/** A choice in groups. */
export function grouped(
    label: string,
    groups: readonly { name: string; options: readonly (readonly [string, string])[] }[],
    value: string,
    changed: (value: string) => void,
): HTMLElement {
    const select = document.createElement("select");
    for (const { name, options } of groups) {
        const group = document.createElement("optgroup");
        group.label = name;
        for (const [id, text] of options) group.append(new Option(text, id, false, id === value));
        select.append(group);
    }
    select.onchange = () => changed(select.value);
    return labelled(label, select);
}

/** Several of some names. */
export function checks(
    label: string,
    names: readonly string[],
    chosen: readonly string[],
    changed: (chosen: string[]) => void,
): HTMLElement {
    const box = document.createElement("fieldset");
    const legend = document.createElement("legend");
    legend.textContent = label;
    box.append(legend);
    const inputs = names.map((name) => {
        const text = document.createElement("label");
        const input = document.createElement("input");
        [input.type, input.checked, input.value] = ["checkbox", chosen.includes(name), name];
        input.onchange = () => changed(inputs.filter((it) => it.checked).map((it) => it.value));
        text.append(input, name);
        box.append(text);
        return input;
    });
    return box;
}

/** Something that is shown or not. */
export function check(label: string, value: boolean, changed: (value: boolean) => void) {
    const text = document.createElement("label");
    text.className = "check";
    const input = document.createElement("input");
    [input.type, input.checked] = ["checkbox", value];
    input.onchange = () => changed(input.checked);
    text.append(input, label);
    return text;
}

export function named(names: readonly string[]): (readonly [string, string])[] {
    return names.map((name) => [name, name] as const);
}

export interface NumberField {
    element: HTMLElement;
    input: HTMLInputElement;
    set(value: number): void;
}

export function number(
    label: string,
    value: number,
    bounds: { min?: number; max?: number; step: number },
    changed: (value: number) => void,
): NumberField {
    const input = document.createElement("input");
    input.type = "number";
    if (bounds.min !== undefined) input.min = String(bounds.min);
    if (bounds.max !== undefined) input.max = String(bounds.max);
    input.step = String(bounds.step);
    input.value = String(value);
    let known = value;
    input.onchange = () => {
        const given = input.valueAsNumber;
        const [low, high] = [bounds.min ?? -Infinity, bounds.max ?? Infinity];
        const isWhole = bounds.step === 1;
        if (!(given >= low && given <= high) || (isWhole && !Number.isSafeInteger(given))) {
            // It cannot be: the one before comes back.
            input.value = String(known);
            return;
        }
        known = given;
        changed(given);
    };
    return {
        element: labelled(label, input),
        input,
        set: (now) => {
            known = Number(now.toFixed(3));
            input.value = String(known);
        },
    };
}

/** A number that is slid, and shown beside its name. */
export function range(
    label: string,
    value: number,
    bounds: { min: number; max: number; step: number },
    changed: (value: number) => void,
): HTMLElement {
    const input = document.createElement("input");
    input.type = "range";
    [input.min, input.max] = [String(bounds.min), String(bounds.max)];
    [input.step, input.value] = [String(bounds.step), String(value)];
    const shown = document.createElement("output");
    shown.textContent = String(value);
    input.oninput = () => (shown.textContent = input.value);
    input.onchange = () => changed(input.valueAsNumber);
    const box = labelled(label, input);
    box.querySelector("label")?.after(shown);
    return box;
}

export interface Slider {
    element: HTMLElement;
    input: HTMLInputElement;
    set(value: number, max: number): void;
}

export function slider(label: string, changed: (value: number) => void): Slider {
    const input = document.createElement("input");
    input.type = "range";
    [input.min, input.max, input.value] = ["0", "0", "0"];
    input.oninput = () => changed(input.valueAsNumber);
    return {
        element: labelled(label, input),
        input,
        set: (value, max) => {
            [input.max, input.value] = [String(max), String(value)];
        },
    };
}

export function button(label: string, pressed: () => void): HTMLButtonElement {
    const made = document.createElement("button");
    made.type = "button";
    made.textContent = label;
    made.onclick = pressed;
    return made;
}

/** A table of names and values. */
export function facts(rows: readonly (readonly [string, string])[]): HTMLElement {
    return table([], rows);
}

/** A table whose first column names the rows; its header may be empty. */
export function table(
    header: readonly string[],
    rows: readonly (readonly string[])[],
): HTMLElement {
    const made = document.createElement("table");
    if (header.length > 0) {
        const row = made.createTHead().insertRow();
        for (const text of header) {
            const head = document.createElement("th");
            [head.scope, head.textContent] = ["col", text];
            row.append(head);
        }
    }
    const body = made.createTBody();
    for (const [name, ...values] of rows) {
        const row = body.insertRow();
        const head = document.createElement("th");
        [head.scope, head.textContent] = ["row", name ?? ""];
        row.append(head);
        for (const value of values) row.insertCell().textContent = value;
    }
    const box = document.createElement("div");
    box.className = "table";
    // A table wider than the page is moved with the keyboard.
    box.tabIndex = 0;
    box.append(made);
    return box;
}

/** The meaning of the colours. */
export function legend(entries: readonly (readonly [string, string])[]): HTMLElement {
    const list = document.createElement("ul");
    list.className = "legend";
    for (const [color, text] of entries) {
        const item = document.createElement("li");
        const swatch = document.createElement("span");
        swatch.style.background = `var(--${color})`;
        item.append(swatch, text);
        list.append(item);
    }
    return list;
}

/** Gives the browser a file to keep. */
export function save(name: string, content: BlobPart): void {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([content]));
    link.download = name;
    link.click();
    URL.revokeObjectURL(link.href);
}

export const decimals = (value: number | null | undefined, digits = 2) =>
    value === null || value === undefined ? "-" : value.toFixed(digits);

export const metres = (value: number | null | undefined, digits = 2) =>
    value === null || value === undefined ? "-" : `${decimals(value, digits)} m`;

/** A slider over the cycles of drives, and a button that plays them. */
export class Moments {
    readonly slider: Slider;
    readonly player: Player;
    shown = 0;
    private last = 0;

    /** `changed` shows a cycle, and returns its time. */
    constructor(
        words: { time: string; play: string; pause: string },
        private readonly changed: (cycle: number) => number,
    ) {
        this.slider = slider(words.time, (cycle) => this.show(cycle));
        this.player = new Player(words, () => {
            this.show(this.shown >= this.last ? 0 : this.shown + 1);
            return this.shown < this.last;
        });
    }

    /** The lengths of all drives that are shown together. */
    begin(lengths: number[]): void {
        this.player.stop();
        this.last = Math.max(0, ...lengths.map((length) => length - 1));
        this.show(0);
    }

    show(cycle: number): void {
        this.shown = cycle;
        this.slider.set(cycle, this.last);
        const time_s = this.changed(cycle);
        this.slider.input.setAttribute("aria-valuetext", `${time_s.toFixed(1)} s`);
    }
}

/** Numbers that go on by themselves while a button is pressed in. */
export class Player {
    readonly button: HTMLButtonElement;
    private timer: number | null = null;

    /** `forward` goes one step, and says whether there is more. */
    constructor(
        private readonly words: { play: string; pause: string },
        private readonly forward: () => boolean,
    ) {
        this.button = button(words.play, () => (this.timer === null ? this.start() : this.stop()));
    }

    private start(): void {
        this.button.textContent = this.words.pause;
        const turn = () => {
            if (this.forward()) this.timer = requestAnimationFrame(turn);
            else this.stop();
        };
        this.timer = requestAnimationFrame(turn);
    }

    stop(): void {
        if (this.timer !== null) cancelAnimationFrame(this.timer);
        this.timer = null;
        this.button.textContent = this.words.play;
    }
}
