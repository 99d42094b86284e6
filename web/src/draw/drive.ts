/** A drive at a moment. */

import type { Candidate, Film } from "../engine/film";
import type { Pair } from "../state";
import type { Colors, View } from "./view";

/** The time for which a moving obstacle's velocity is drawn ahead [s]. */
const AHEAD_S = 1.5;

/** The knowledge and the decision of a robot, as far as they lie below the robots. */
export function drawMind(view: View, film: Film, shown: number, withFan: boolean): void {
    const cycle = film.cycle(shown);
    if (!cycle) return;
    const { colors } = view;
    view.cells(film.sensedUpTo(shown), colors.sensed);
    if (withFan) drawFan(view, film.fan(shown), [cycle.pose[0], cycle.pose[1]]);
    view.line(film.route(shown), colors.line, 1.5, [4, 4]);
    const ratio = window.devicePixelRatio || 1;
    for (const hit of film.hitsAt(shown)) view.disc(hit, 1.5 * ratio, colors.hit);
    if (cycle.target_m) view.circle(cycle.target_m, 0.12, colors.chosen, 2);
}

/** Moving obstacles as a robot believes them, with their velocities. */
export function drawBelieved(view: View, film: Film, shown: number): void {
    const { colors } = view;
    for (const { centre, velocity_mps, radius_m, unseen_s } of film.cycle(shown)?.movers ?? []) {
        const ahead: Pair = [
            centre[0] + AHEAD_S * velocity_mps[0],
            centre[1] + AHEAD_S * velocity_mps[1],
        ];
        view.circle(centre, radius_m, colors.believed, 2, unseen_s > 0 ? [3, 3] : []);
        view.line([centre, ahead], colors.believed, 2);
    }
}

/** A robot, and where it drove so far. */
export function drawRobot(view: View, film: Film, shown: number, color: string): void {
    const cycle = film.cycle(shown);
    if (!cycle) return;
    view.line(film.driveUpTo(shown), color, 3);
    const [x, y, yaw] = cycle.pose;
    const { radius_m, vertices } = film.outline;
    if (radius_m === null) view.polygon(vertices, cycle.pose, color);
    else view.disc([x, y], view.pixels(radius_m), color);
    const tip: Pair = [x + 0.4 * Math.cos(yaw), y + 0.4 * Math.sin(yaw)];
    view.line([[x, y], tip], color, 3);
}

/** Moving obstacles; one of the runs still goes on. */
export function drawMovers(view: View, films: Film[], shown: number): void {
    const film = films.find(({ cycles }) => cycles.length > shown) ?? films[0];
    for (const { at, radius_m } of film?.moversAt(shown) ?? []) {
        view.disc(at, view.pixels(radius_m), view.colors.mover);
    }
}

/** The ways to which all velocities that were tried would lead, the best ones on top. */
function drawFan(view: View, fan: Candidate[], from: Pair): void {
    const kinds: [Candidate["fate"], keyof Colors, number][] = [
        ["refused", "refused", 0.7],
        ["touching", "touching", 0.7],
        ["admissible", "admissible", 0.9],
        ["second", "runnerup", 3],
        ["chosen", "chosen", 3],
    ];
    for (const [fate, color, width] of kinds) {
        const lines = fan.filter((it) => it.fate === fate).map(({ points }) => [from, ...points]);
        view.lines(lines, view.colors[color] as string, width);
    }
}
