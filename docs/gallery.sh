#!/usr/bin/env bash
# Draws the pictures of docs/planners.md, docs/concepts.md and docs/stack.md and of the first drive, and prints the table of
# docs/planners.md. Needs Rust alone.
set -euo pipefail
cd "$(dirname "$0")/.."

cargo build --release --locked -p keyway-cli
keyway=$PWD/target/release/keyway
images=$PWD/docs/images/planners
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$keyway" demo --out "$scratch" > /dev/null

plan() { # NAME [OPTION...]
    "$keyway" plan "$scratch/small_house.yaml" --start -8.175,-2.825 --goal 8.725,0.875 --radius 0.2 \
        --planner "$@"
}

echo "| planner | length [m] | excess | expanded | generated | turns | stopped because |"
echo "|---|---|---|---|---|---|---|"
for name in dijkstra greedy astar astar4 bidirectional-optimal jps prepared bidirectional-astar \
    bidirectional-24 bidirectional-jps-fixed bidirectional-jps density-astar ratio-astar hsta rrt \
    theta-star lazy-theta-star; do
    options=()
    # Its paper has cells of 1 m; a house has narrower doors than 4 of them.
    if [ "$name" = hsta ]; then options=(--set planner.reference_cell_m=0.15); fi
    plan "$name" "${options[@]}" --excess --picture "$images/$name.png" |
        awk -v name="$name" '
            function rest(n,  text, i) { for (i = n; i <= NF; i++) text = text $i " "; sub(/ +$/, "", text); return text }
            $1 == "length" { length_m = $2 } $1 == "excess" { excess = rest(2) }
            $1 == "expanded" { expanded = rest(2) } $1 == "generated" { generated = rest(2) }
            $1 == "turns" { turns = $2 } $1 == "stopped" { why = rest(3) }
            END { print "| `" name "` | " length_m " | " excess " | " expanded " | " generated " | " turns " | " why " |" }'
done
plan bidirectional-jps --animate "$images/bidirectional-jps.gif" > /dev/null

# The picture of docs/concepts.md.
plan jps --smoother continuous-curvature --picture "$PWD/docs/images/concepts/smoothed.png" > /dev/null

# The pictures of the first drive and of docs/stack.md.
ends=(--start -8.175,-2.825 --goal 8.725,0.875 --obstacle 0,0,0.15)
cp "$scratch/map.png" docs/images/demo.png
"$keyway" navigate "$scratch/small_house.yaml" "${ends[@]}" --fan 16.5 --out "$scratch/fan" > /dev/null
cp "$scratch/fan/fan.png" docs/images/stack/fan.png
"$keyway" navigate "$scratch/small_house.yaml" "${ends[@]}" --moving 6,-0.35,0.25,-0.1,0 --out "$scratch/drive" > /dev/null
cp "$scratch/drive/map.png" docs/images/stack/drive.png
echo 'like = "jackal"
limits = { min_turning_radius_m = 0.6, v_max_mps = 1.0 }' > "$scratch/my_car.toml"
"$keyway" navigate "$scratch/small_house.yaml" --start -8.175,-2.825,180 --goal -3.6,-0.6,180 \
    --robot "$scratch/my_car.toml" --out "$scratch/car" > /dev/null
cp "$scratch/car/map.png" docs/images/stack/car.png
