/** The heads of answers, as far as the page reads them; see crates/keyway-web. */

export type Point = [number, number];

export interface Failure {
    error: { kind: string; message: string; field: string | null };
}

export interface Names {
    version: string;
    robots: string[];
    planners: string[];
    smoothers: string[];
    stacks: string[];
}

export interface MapFacts {
    name: string;
    width: number;
    height: number;
    resolution_m: number;
    origin: [number, number, number];
    warnings: string[];
}

export interface RouteReport {
    outcome: string;
    length_m: number | null;
    cost_cells: number | null;
    expanded: number;
    generated: number;
    turns: number | null;
    min_clearance_m: number | null;
    why: string | null;
    smoothed?: { length_m: number; min_clearance_m: number } | null;
}

export interface SearchReport {
    kinds: string[];
    events: number;
    expanded: number;
    generated: number;
    cost_cells: number | null;
    why: string | null;
}

export interface CycleReport {
    cycle: number;
    t_s: number;
    pose: [number, number, number];
    velocity: { v_mps: number; omega_radps: number };
    remaining_m: number;
    movers: unknown[];
    step: string;
    reason: string | null;
    command: { v_mps: number; omega_radps: number } | null;
    refusal: unknown;
    candidates: number;
    driving: number;
    rejected: { because: string; count: number }[];
    chosen: { shares: { term: string; weighted: number }[] } | null;
}

export interface RobotReport {
    outcome: string;
    reason: string | null;
    run: { time_s: number; length_m: number; min_clearance_m: number | null } | null;
}

export interface Driven {
    reports: RobotReport[];
    cycles: CycleReport[][];
    routes: [number, Point[]][][];
    outlines: { radius_m: number | null; vertices: Point[] }[];
    mover_radii_m: number[];
}
