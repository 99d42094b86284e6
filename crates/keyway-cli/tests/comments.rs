//! Comments are at most 100 columns wide, and doc comments state what a thing is.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

/// Words with which no doc line begins: the first line names the thing or what it does.
const QUESTIONS: [&str; 10] =
    ["What", "Who", "Whose", "Whom", "Whether", "Where", "How", "When", "Which", "Why"];
const WIDEST: usize = 100;

fn sources() -> Vec<PathBuf> {
    let mut folders =
        vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()];
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() && !path.ends_with("target") {
                folders.push(path);
            } else if path.extension().is_some_and(|end| end == "rs") {
                files.push(path);
            }
        }
    }
    files
}

/// The text of a comment line, without its slashes.
fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    ["///", "//!", "//"].iter().find_map(|slashes| line.strip_prefix(slashes)).map(str::trim_start)
}

/// Lines of a file that break a rule, as `line: text`; tables and code in doc comments may be wide.
fn faults(text: &str) -> Vec<String> {
    let (mut is_code, mut faults) = (false, Vec::new());
    for (number, line) in text.lines().enumerate() {
        let Some(comment) = comment(line) else {
            is_code = false;
            continue;
        };
        is_code ^= comment.starts_with("```");
        let is_doc = ["///", "//!"].iter().any(|slashes| line.trim_start().starts_with(slashes));
        let first = comment.split(|c: char| !c.is_alphanumeric()).next().unwrap();
        let is_quoted =
            is_code || [">>>", "|", "ValueError:"].iter().any(|it| comment.starts_with(it));
        let is_wide = line.chars().count() > WIDEST && !is_quoted;
        if is_wide || is_doc && !is_code && QUESTIONS.contains(&first) {
            faults.push(format!("{}: {}", number + 1, line.trim()));
        }
    }
    faults
}

#[test]
fn comments_are_narrow_and_no_doc_line_opens_with_a_question_word() {
    let files = sources();
    assert!(files.len() > 500, "{} files", files.len());
    let mut all = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        let found = faults(&text).into_iter();
        all.extend(found.map(|fault| format!("{}:{fault}", file.display())));
    }
    assert!(all.is_empty(), "{} lines:\n{}", all.len(), all.join("\n"));
}

#[test]
fn faults_are_recognised() {
    let wide = "x".repeat(WIDEST);
    let good = format!("/// Returns what it is.\n/// ```\n/// {wide}\n/// ```\n/// | {wide} |\n");
    assert_eq!(faults(&good), [""; 0]);
    assert_eq!(faults("    /// Where it ends\n// When so\n"), ["1: /// Where it ends"]);
    assert_eq!(faults(&format!("// {wide}\n")).len(), 1);
}
