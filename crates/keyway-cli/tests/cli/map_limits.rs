//! Tests of the limit on the size of maps.

use crate::support::{folder, keyway, write};

/// `walled.map` has 35 cells.
#[test]
fn every_command_that_reads_maps_has_the_limit() {
    let folder = folder();
    let scene = "version = 2\nmap = \"walled.map\"\nstart = [0.5, 0.5, 0]\ngoal = [1.5, 0.5]\n\
                 robot = \"paper\"\nstack = \"s0-key-point\"\n";
    write(&folder, "walled.toml", scene);
    write(&folder, "walled.map.scen", "version 1\n0 walled.map 7 5 0 0 1 0 1\n");
    keyway(folder.path(), "batch walled.toml --keep all --out recorded").expect_code(0);
    let record = "recorded/records/walled.s0-key-point.0.json";
    assert!(folder.path().join(record).exists());
    for line in [
        "map info walled.map",
        "map convert walled.map w.yaml",
        "plan walled.map --start 0.5,0.5 --goal 6.5,0.5",
        "prepare walled.map --out w.prepared",
        "compare walled.map --queries 1 --out c",
        "navigate walled.map --start 0.5,0.5 --goal 1.5,0.5 --out n",
        "navigate --scene walled.toml --out n",
        "batch walled.toml --out b",
        &format!("replay {record} --out r"),
        "bench grid walled.map.scen",
        "bench scale walled.map --sides 7 --out s",
    ] {
        let refused = keyway(folder.path(), &format!("{line} --max-cells 34")).expect_code(2).err;
        let expected = "walled.map: a map of 7 x 5 cells is larger than the limit of 34 cells; if this size is \
                        intended, raise the limit with --max-cells 35\n";
        assert!(refused.ends_with(expected), "{line}: {refused}");
        keyway(folder.path(), &format!("{line} --max-cells 35")).expect_code(0);
    }
    for number in ["0", "2147483649", "-1", "many"] {
        let line = format!("map info walled.map --max-cells {number}");
        let refused = keyway(folder.path(), &line).expect_code(2).err;
        assert!(refused.contains("from 1 to 2147483648"), "{number}: {refused}");
    }
}
