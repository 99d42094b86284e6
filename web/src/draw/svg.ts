/** A canvas that writes SVG: as much of the 2D context as the view uses. */

const number = (value: number) => String(Number(value.toFixed(2)));
const escaped = (text: string) =>
    text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll('"', "&quot;");

export class SvgContext {
    fillStyle = "#000";
    strokeStyle = "#000";
    lineWidth = 1;
    lineJoin = "miter";
    font = "";
    textAlign = "left";
    textBaseline = "alphabetic";
    imageSmoothingEnabled = true;
    private readonly out: string[] = [];
    private path: string[] = [];
    private dashes: number[] = [];
    /** For each save: how many groups were opened since. */
    private readonly groups: number[] = [];
    private clips = 0;

    constructor(
        private readonly real: CanvasRenderingContext2D,
        private readonly width: number,
        private readonly height: number,
    ) {}

    get text(): string {
        const size = `viewBox="0 0 ${this.width} ${this.height}"`;
        return `<svg xmlns="http://www.w3.org/2000/svg" ${size}>\n${this.out.join("\n")}\n</svg>\n`;
    }

    save(): void {
        this.groups.push(0);
    }

    restore(): void {
        for (let i = this.groups.pop() ?? 0; i > 0; i--) this.out.push("</g>");
    }

    private open(attributes: string): void {
        this.out.push(`<g ${attributes}>`);
        if (this.groups.length > 0) this.groups[this.groups.length - 1]!++;
    }

    setTransform(): void {}

    clearRect(): void {}

    translate(x: number, y: number): void {
        this.open(`transform="translate(${number(x)} ${number(y)})"`);
    }

    rotate(angle: number): void {
        if (angle !== 0) this.open(`transform="rotate(${(angle * 180) / Math.PI})"`);
    }

    beginPath(): void {
        this.path = [];
    }

    moveTo(x: number, y: number): void {
        this.path.push(`M${number(x)} ${number(y)}`);
    }

    lineTo(x: number, y: number): void {
        this.path.push(`${this.path.length === 0 ? "M" : "L"}${number(x)} ${number(y)}`);
    }

    closePath(): void {
        this.path.push("Z");
    }

    rect(x: number, y: number, width: number, height: number): void {
        const [w, h] = [number(width), number(height)];
        this.path.push(`M${number(x)} ${number(y)}h${w}v${h}h-${w}Z`);
    }

    /** Whole circles only. */
    arc(x: number, y: number, radius: number): void {
        const [r, side] = [number(radius), number(2 * radius)];
        this.path.push(`M${number(x - radius)} ${number(y)}`);
        this.path.push(`a${r} ${r} 0 1 0 ${side} 0a${r} ${r} 0 1 0 -${side} 0Z`);
    }

    clip(): void {
        const id = `clip-${this.clips++}`;
        this.out.push(`<clipPath id="${id}"><path d="${this.path.join("")}"/></clipPath>`);
        this.open(`clip-path="url(#${id})"`);
    }

    fill(): void {
        this.out.push(`<path d="${this.path.join("")}" fill="${this.fillStyle}"/>`);
    }

    stroke(): void {
        if (this.path.length === 0) return;
        const dashes = this.dashes.length > 0 ? ` stroke-dasharray="${this.dashes.join(" ")}"` : "";
        const line = `stroke="${this.strokeStyle}" stroke-width="${number(this.lineWidth)}"`;
        const join = `fill="none" stroke-linejoin="round"${dashes}`;
        this.out.push(`<path d="${this.path.join("")}" ${join} ${line}/>`);
    }

    setLineDash(dashes: number[]): void {
        this.dashes = dashes;
    }

    fillRect(x: number, y: number, width: number, height: number): void {
        const size = `width="${number(width)}" height="${number(height)}"`;
        const place = `x="${number(x)}" y="${number(y)}"`;
        this.out.push(`<rect ${place} ${size} fill="${this.fillStyle}"/>`);
    }

    measureText(text: string): TextMetrics {
        this.real.font = this.font;
        return this.real.measureText(text);
    }

    fillText(text: string, x: number, y: number): void {
        const anchor = this.textAlign === "center" ? "middle" : "start";
        const base = this.textBaseline === "middle" ? "central" : "hanging";
        const place = `x="${number(x)}" y="${number(y)}" fill="${this.fillStyle}"`;
        const style = `style="font:${escaped(this.font)}" text-anchor="${anchor}"`;
        const text_ = escaped(text);
        this.out.push(`<text ${place} ${style} dominant-baseline="${base}">${text_}</text>`);
    }

    drawImage(picture: HTMLCanvasElement, x: number, y: number, width: number, height: number) {
        const sides = `width="${number(width)}" height="${number(height)}"`;
        const look = this.imageSmoothingEnabled ? "" : ' style="image-rendering:pixelated"';
        const place = `x="${number(x)}" y="${number(y)}" ${sides} preserveAspectRatio="none"`;
        this.out.push(`<image ${place}${look} href="${picture.toDataURL()}"/>`);
    }
}
