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

export function named(names: readonly string[]): (readonly [string, string])[] {
    return names.map((name) => [name, name] as const);
}

export interface NumberField {
    element: HTMLElement;
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
        set: (now) => {
            known = Number(now.toFixed(3));
            input.value = String(known);
        },
    };
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
    const table = document.createElement("table");
    const body = table.createTBody();
    for (const [name, value] of rows) {
        const row = body.insertRow();
        const head = document.createElement("th");
        head.scope = "row";
        head.textContent = name;
        row.append(head);
        row.insertCell().textContent = value;
    }
    return table;
}

export const metres = (value: number | null | undefined, digits = 2) =>
    value === null || value === undefined ? "-" : `${value.toFixed(digits)} m`;

/** Numbers that go on by themselves while a button is pressed in. */
export class Player {
    readonly button: HTMLButtonElement;
    private timer: number | null = null;

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
