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
    events: number;
    left_out: number;
    expanded: number;
    generated: number;
    cost_cells: number | null;
    why: string | null;
}

export interface Speeds {
    v_mps: number;
    omega_radps: number;
}

export interface CycleReport {
    cycle: number;
    t_s: number;
    pose: [number, number, number];
    velocity: Speeds;
    remaining_m: number;
    target_m: Point | null;
    movers: { centre: Point; velocity_mps: Point; radius_m: number; unseen_s: number }[];
    step: string;
    reason: string | null;
    command: Speeds | null;
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

/** A line of the results of a batch; the page hands it on as it is. */
export type Row = Record<string, unknown>;

export interface Driven {
    reports: RobotReport[];
    row: Row;
    cycles: CycleReport[][];
    routes: [number, Point[]][][];
    refusals: [number, string][][];
    outlines: { radius_m: number | null; vertices: Point[] }[];
    mover_radii_m: number[];
}

export interface SceneFacts {
    map: MapFacts;
    is_generated: boolean;
    is_random: boolean;
    seed: number;
    description: string | null;
    robots: { start: Point; via: Point[]; goal: Point; stack: string }[];
    discs: [number, number, number][];
    polygons: Point[][];
    hidden_cells: Point[];
    movers: [number, number, number][];
}

export interface Comparison {
    report: unknown;
    header: string[];
    rows: string[][];
    csv: string;
    queries_csv: string;
    latex: string;
}

export interface StackSummary {
    stack: string;
    runs: number;
    reached: number;
    contacts_driving: number;
    contacts_standing: number;
    stuck: number;
    timeout: number;
    no_path: number;
    mean_time_s: number | null;
    mean_length_m: number | null;
    least_clearance_m: number | null;
}

export interface Summary {
    stacks: StackSummary[];
    text: string;
    markdown: string;
    latex: string;
    runs_csv: string;
    csv: string;
}

export interface ClaimFacts {
    id: string;
    paper: string;
    statement: string;
    about: string;
    methods: string[];
    has_scene: boolean;
}

export interface ClaimMap {
    map: MapFacts;
    ends: [Point, Point];
    lengths_m: (number | null)[];
    is_cut_off: boolean[];
    discs: [number, number, number][];
    movers: [number, number, number][];
}

export interface Judged {
    report: { verdict: string; family: { maps: number; left_out: number } };
    figures: { statement: string; published: string; measured: string; verdict: string | null }[];
}
