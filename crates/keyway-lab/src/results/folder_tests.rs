use super::*;
use std::cell::RefCell;
use std::collections::BTreeMap;

/// The files of a folder with their contents.
type Files = BTreeMap<String, Vec<u8>>;

thread_local! {
    /// Content of a folder after each step of this thread.
    static STEPS: RefCell<Vec<Files>> = const { RefCell::new(Vec::new()) };
}

/// Called after every change of a folder.
pub(super) fn record(folder: &Path) {
    STEPS.with_borrow_mut(|steps| steps.push(files_of(folder)));
}

fn files_of(folder: &Path) -> Files {
    let entries = fs::read_dir(folder).into_iter().flatten().map(Result::unwrap);
    let name = |entry: &fs::DirEntry| entry.file_name().into_string().unwrap();
    entries.map(|entry| (name(&entry), fs::read(entry.path()).unwrap())).collect()
}

fn make(files: &Files, folder: &Path) {
    fs::create_dir_all(folder).unwrap();
    for (name, bytes) in files {
        fs::write(folder.join(name), bytes).unwrap();
    }
}

/// A run that writes these files. It first removes those of an earlier run, if it supersedes that
/// one.
fn run(
    folder: &Path,
    files: &[(&str, &str)],
    earlier: Option<&[&str]>,
) -> Result<(), ResultsError> {
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    let mut out = OutDir::prepare(folder, &names)?;
    if let Some(earlier) = earlier {
        out.supersede(earlier.iter().map(|&name| name.to_owned()));
    }
    for (name, text) in files {
        out.write(name, text.as_bytes())?;
    }
    out.finish().map(drop)
}

/// Returns every state that a killed run can leave: after each step, and within a write, with a
/// partial temporary file.
fn states_of_killed_runs(
    before: &Files,
    files: &[(&str, &str)],
    earlier: Option<&[&str]>,
) -> Vec<Files> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    make(before, &path);
    STEPS.take();
    run(&path, files, earlier).unwrap();
    let after: Vec<Files> = std::iter::once(before.clone()).chain(STEPS.take()).collect();
    let within = |state: &Files| {
        let names = files.iter().map(|(name, _)| *name).chain(Manifest::NAMES);
        let torn = |name: &str| {
            let mut state = state.clone();
            state.insert(format!(".{name}.keyway-0.tmp"), b"par".to_vec());
            state
        };
        names.map(torn).collect::<Vec<_>>()
    };
    after.iter().flat_map(|state| std::iter::once(state.clone()).chain(within(state))).collect()
}

const FIRST: [(&str, &str); 3] = [("a", "a1"), ("b", "b1"), ("c", "c1")];
const SECOND: [(&str, &str); 3] = [("a", "a2"), ("b", "b1"), ("d", "d2")];
const THIRD: [(&str, &str); 3] = [("a", "a3"), ("b", "b3"), ("d", "d3")];

fn left_by(run_of: &[(&str, &str)]) -> Files {
    run_of.iter().map(|(name, text)| ((*name).to_owned(), text.as_bytes().to_vec())).collect()
}

fn without_manifest(mut files: Files) -> Files {
    files.retain(|name, _| !Manifest::NAMES.contains(&name.as_str()));
    files
}

fn visible(mut files: Files) -> Files {
    files.retain(|name, _| !name.starts_with('.'));
    files
}

/// Returns the files that a first run leaves.
fn after_first() -> Files {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), &FIRST, Some(&[])).unwrap();
    files_of(folder.path())
}

#[test]
fn a_run_after_a_killed_one_is_as_if_that_had_never_been() {
    for before in [Files::new(), after_first()] {
        let earlier: &[&str] = if before.is_empty() { &[] } else { &["a", "b", "c"] };
        let states = states_of_killed_runs(&before, &SECOND, Some(earlier));
        assert!(states.len() > 20, "{}", states.len());
        for state in states {
            let folder = tempfile::tempdir().unwrap();
            make(&state, folder.path());
            // The files of an earlier run are known only from its report, which may be replaced.
            let known: &[&str] =
                if state.get("a") == Some(&b"a1".to_vec()) { earlier } else { &[] };
            run(folder.path(), &THIRD, Some(known)).unwrap_or_else(|e| panic!("{e}: {state:?}"));
            let left = without_manifest(files_of(folder.path()));
            assert_eq!(left, left_by(&THIRD), "{state:?}");
            for name in Manifest::NAMES {
                let list = fs::read_to_string(folder.path().join(name)).unwrap();
                assert_eq!(list.lines().count(), 3, "{list}");
            }
        }
    }
}

#[test]
fn a_killed_run_makes_no_foreign_file_its_own() {
    for state in states_of_killed_runs(&after_first(), &SECOND, Some(&["a", "b", "c"])) {
        for name in ["a", "b", "c", "d"] {
            let folder = tempfile::tempdir().unwrap();
            make(&state, folder.path());
            fs::write(folder.path().join(name), "foreign").unwrap();
            let ran = run(folder.path(), &THIRD, Some(&["a", "b", "c"]));
            assert_eq!(ran.is_err(), name != "c", "{name}: {state:?}");
            assert_eq!(
                fs::read(folder.path().join(name)).unwrap(),
                b"foreign",
                "{name}: {state:?}"
            );
        }
    }
}

#[test]
fn a_run_of_another_kind_leaves_what_a_killed_one_left() {
    let states = states_of_killed_runs(&after_first(), &SECOND, Some(&["a", "b", "c"]));
    for state in states {
        let folder = tempfile::tempdir().unwrap();
        make(&state, folder.path());
        run(folder.path(), &[("e", "e3")], None).unwrap();
        let mut expected = visible(state);
        expected.insert("e".to_owned(), b"e3".to_vec());
        assert_eq!(visible(files_of(folder.path())), expected);
    }
}

/// The list of the first run beside the files of the second one, as after a restored backup.
#[test]
fn an_old_or_lost_list_locks_nothing() {
    for list in Manifest::NAMES {
        for put_back in [true, false] {
            let folder = tempfile::tempdir().unwrap();
            make(&after_first(), folder.path());
            run(folder.path(), &SECOND, Some(&["a", "b", "c"])).unwrap();
            match after_first().get(list).filter(|_| put_back) {
                Some(old) => fs::write(folder.path().join(list), old).unwrap(),
                None => fs::remove_file(folder.path().join(list)).unwrap(),
            }
            fs::write(folder.path().join("b"), "foreign").unwrap();
            let refused = run(folder.path(), &THIRD, Some(&["a", "b", "d"])).unwrap_err();
            assert!(refused.to_string().contains("b is in the way"), "{refused}");
            assert!(refused.to_string().contains("; delete it or move it away, or"), "{refused}");
            fs::remove_file(folder.path().join("b")).unwrap();
            run(folder.path(), &THIRD, Some(&["a", "b", "d"])).unwrap();
            assert_eq!(without_manifest(files_of(folder.path())), left_by(&THIRD));
        }
    }
}

#[test]
fn a_run_that_ends_early_locks_nothing() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), &FIRST, None).unwrap();
    let mut out = OutDir::prepare(folder.path(), &["a"]).unwrap();
    out.write("a", b"a2").unwrap();
    // The run is killed here.
    drop(out);
    run(folder.path(), &THIRD, None).unwrap();
}

#[test]
fn a_file_that_appears_during_the_run_stays() {
    let folder = tempfile::tempdir().unwrap();
    let mut out = OutDir::prepare(folder.path(), &["a"]).unwrap();
    fs::write(folder.path().join("a"), "foreign").unwrap();
    assert!(out.write("a", b"mine").unwrap_err().to_string().contains("a is in the way"));
    assert_eq!(fs::read(folder.path().join("a")).unwrap(), b"foreign");
}

#[test]
fn folders_that_cannot_be_written_are_found_before() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    for below in [file.clone(), file.join("run"), file.join("x/y")] {
        let error = OutDir::prepare(&below, &["a"]).unwrap_err();
        assert!(error.to_string().ends_with("file is not a folder"), "{error}");
    }
    #[cfg(target_os = "linux")]
    for below in ["/proc/run", "/proc/run/x", "/proc"] {
        let error = OutDir::prepare(Path::new(below), &["a"]).unwrap_err();
        assert!(error.to_string().starts_with(&format!("cannot write {below}: ")), "{error}");
    }
    OutDir::prepare(&folder.path().join("x/y"), &["a"]).unwrap();
    assert_eq!(files_of(folder.path()).len(), 1, "nothing is left behind");
}

#[test]
fn own_files_are_replaced_and_foreign_ones_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    let mut first = OutDir::prepare(&path, &["a", "b"]).unwrap();
    first.write("a", b"1").unwrap();
    first.write("b", b"1").unwrap();
    assert_eq!(first.finish().unwrap(), [path.join("a"), path.join("b")]);

    fs::write(path.join("c"), "foreign").unwrap();
    let error = OutDir::prepare(&path, &["a", "c"]).unwrap_err();
    assert!(error.to_string().contains("c is in the way"), "{error}");
    let mut second = OutDir::prepare(&path, &["a", "b"]).unwrap();
    second.write("a", b"2").unwrap();
    second.finish().unwrap();
    assert_eq!(fs::read(path.join("a")).unwrap(), b"2");
    assert!(!path.join("b").exists(), "stale");
    assert_eq!(fs::read(path.join("c")).unwrap(), b"foreign");

    // A file that Keyway wrote and someone changed is foreign.
    fs::write(path.join("a"), "edited").unwrap();
    assert!(OutDir::prepare(&path, &["a"]).is_err());
    assert!(OutDir::prepare(&folder.path().join("none"), &["a"]).is_ok());
    assert!(!folder.path().join("none").exists(), "nothing is left behind");

    // A file of a name that Keyway once wrote, and then gave up, is foreign.
    fs::write(path.join("b"), "foreign").unwrap();
    assert!(OutDir::prepare(&path, &["b"]).is_err());
}
