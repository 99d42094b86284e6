//! Tests of two programs that write into the same folder, and of killed ones.

use crate::support::{folder, keyway};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};

/// Every command that writes several files.
const LINES: [&str; 9] = [
    "navigate --scene small_house.toml --time-limit 1 --out OUT",
    "compare walled.map --queries 2 --no-times --out OUT",
    "bench scale walled.map --sides 7 --out OUT",
    "scene papers you2021 --count 1 --out OUT",
    "demo --out OUT",
    "batch small_house.toml --keep all --out OUT",
    "batch merge recorded --out OUT",
    "replay recorded/records/small_house.keyway.0.json --out .",
    "reproduce S1-8 --maps 2 --no-times --out OUT",
];

/// The folder that [`LINES`] write into.
fn out_of(line: &str) -> &'static str {
    if line.starts_with("replay") { "small_house.keyway.0" } else { "OUT" }
}

fn files_of(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    let files = entries.filter(|entry| entry.path().is_file());
    let name = |entry: &fs::DirEntry| entry.file_name().into_string().unwrap();
    files.map(|entry| (name(&entry), fs::read(entry.path()).unwrap())).collect()
}

#[test]
fn who_comes_second_is_refused_and_changes_nothing() {
    let folder = folder();
    keyway(folder.path(), "batch small_house.toml --keep all --out recorded").expect_code(0);
    for line in LINES {
        let name = out_of(line);
        let out = folder.path().join(name);
        fs::create_dir(&out).unwrap();
        let lock = File::create(out.join(".keyway-lock")).unwrap();
        lock.lock().unwrap();
        let refused = keyway(folder.path(), line).expect_code(2).err;
        let expected = format!(
            "error: {}: another `keyway` is writing to this folder; wait until it has finished, or choose another \
             folder\n",
            if line.starts_with("replay") { "./small_house.keyway.0" } else { name }
        );
        assert!(refused.ends_with(&expected), "{line}: {refused}");
        assert_eq!(files_of(&out).into_keys().collect::<Vec<_>>(), [".keyway-lock"], "{line}");
        // Released, as if the holder had been killed.
        drop(lock);
        let answer = keyway(folder.path(), line);
        assert!(answer.code < 2, "{line}: {}", answer.err);
        let files = files_of(&out);
        assert!(files.len() > 1 && !files.contains_key(".keyway-lock"), "{line}");
        fs::remove_dir_all(&out).unwrap();
    }
}

#[test]
fn a_map_and_its_image_are_written_by_one() {
    let folder = folder();
    let lock = File::create(folder.path().join(".w.yaml.keyway-lock")).unwrap();
    lock.lock().unwrap();
    let line = "map convert walled.map w.yaml";
    let refused = keyway(folder.path(), line).expect_code(2).err;
    assert!(refused.contains("w.yaml: another `keyway` is writing this file; wait"), "{refused}");
    keyway(folder.path(), "map convert walled.map v.yaml").expect_code(0);
    drop(lock);
    keyway(folder.path(), line).expect_code(0);
    let left = files_of(folder.path()).into_keys().filter(|name| name.contains("lock"));
    assert_eq!(left.count(), 0);
    // If there is no folder, none is created.
    keyway(folder.path(), "map convert walled.map none/w.yaml").expect_code(2);
    assert!(!folder.path().join("none").exists());
}

#[test]
fn a_killed_one_is_in_nobodys_way() {
    let folder = folder();
    keyway(folder.path(), "batch small_house.toml --keep all --out recorded").expect_code(0);
    for line in LINES {
        let out = folder.path().join(out_of(line));
        let mut child = Command::new(env!("CARGO_BIN_EXE_keyway"))
            .args(line.split_whitespace())
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        // The program may finish before it can be killed.
        while !out.join(".keyway-lock").exists() && child.try_wait().unwrap().is_none() {
            std::thread::yield_now();
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let again = keyway(folder.path(), line);
        assert!(again.code < 2, "{line}: {}", again.err);
        let names = || files_of(&out).into_keys().collect::<Vec<_>>();
        let after_killed = names();
        fs::remove_dir_all(&out).unwrap();
        keyway(folder.path(), line);
        assert_eq!(after_killed, names(), "{line}");
        fs::remove_dir_all(&out).unwrap();
    }
}
