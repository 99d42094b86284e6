//! A strict reader for the LaTeX of tables: everything unknown is an error.

/// Commands of LaTeX and `booktabs` that a table may use.
const COMMANDS: [&str; 23] = [
    "begin",
    "end",
    "toprule",
    "midrule",
    "bottomrule",
    "addlinespace",
    "textbackslash",
    "textasciitilde",
    "textasciicircum",
    "textless",
    "textgreater",
    "textbar",
    "char",
    "dots",
    "pm",
    "times",
    "cdot",
    "circ",
    "mu",
    "leq",
    "geq",
    "leftarrow",
    "rightarrow",
];

/// The cells of a table's rows. It checks the whole table: characters known to pdfLaTeX,
/// commands, balanced braces and dollar signs, rules in their places, and one cell per column in
/// each row.
pub(crate) fn read(text: &str) -> Vec<Vec<String>> {
    let lines: Vec<&str> = text.split(['\n', '\r']).map(without_comment).map(str::trim).collect();
    let mut lines = lines.into_iter().filter(|line| !line.is_empty());
    let begin = lines.next().unwrap();
    let columns = begin.strip_prefix(r"\begin{tabular}{").and_then(|rest| rest.strip_suffix('}'));
    let columns = columns.unwrap_or_else(|| panic!("{begin}"));
    assert!(
        !columns.is_empty() && columns.chars().all(|one| one == 'l' || one == 'r'),
        "{columns}"
    );
    assert_eq!(lines.next(), Some(r"\toprule"));
    let (mut rows, mut rules) = (Vec::new(), Vec::new());
    for line in lines.by_ref() {
        match line {
            r"\midrule" | r"\addlinespace" => rules.push((rows.len(), line)),
            r"\bottomrule" => break,
            row => rows.push(cells(row)),
        }
    }
    assert_eq!(lines.collect::<Vec<_>>(), [r"\end{tabular}"]);
    assert_eq!(rules.first(), Some(&(1, r"\midrule")), "below the header");
    for row in &rows {
        assert_eq!(row.len(), columns.len(), "{row:?}");
    }
    rows
}

/// A line up to a percent sign that is not escaped.
fn without_comment(line: &str) -> &str {
    let mut is_escaped = false;
    for (i, letter) in line.char_indices() {
        match letter {
            '%' if !is_escaped => return &line[..i],
            '\\' => is_escaped = !is_escaped,
            _ => is_escaped = false,
        }
    }
    line
}

fn cells(row: &str) -> Vec<String> {
    let row_text = row.strip_suffix(r"\\").unwrap_or_else(|| panic!("no end of the row: {row}"));
    assert!(!row_text.starts_with(['[', '*']), "belongs to the end of the row before: {row}");
    let (mut cells, mut depth, mut is_math) = (vec![String::new()], 0, false);
    let mut rest = row_text.trim();
    while let Some(letter) = rest.chars().next() {
        let mut length = letter.len_utf8();
        match letter {
            '\\' => length = command_length(rest),
            '{' => depth += 1,
            '}' => depth -= 1,
            '$' => is_math = !is_math,
            '^' => assert!(is_math, "{row}"),
            '&' => {
                assert!(depth == 0 && !is_math, "{row}");
                cells.push(String::new());
                rest = &rest[1..];
                continue;
            }
            '_' | '#' | '%' | '"' => panic!("{letter} in {row}"),
            letter => assert!(is_known(letter), "{letter:?} in {row}"),
        }
        assert!(depth >= 0, "{row}");
        cells.last_mut().unwrap().push_str(&rest[..length]);
        rest = &rest[length..];
    }
    assert!(depth == 0 && !is_math, "not closed: {row}");
    cells.iter().map(|cell| cell.trim().to_owned()).collect()
}

/// Length of a backslash and the command after it.
fn command_length(text: &str) -> usize {
    let name: String = text[1..].chars().take_while(char::is_ascii_alphabetic).collect();
    if name.is_empty() {
        assert!(text[1..].starts_with(['&', '%', '$', '#', '_', '{', '}']), "{text}");
        return 2;
    }
    assert!(COMMANDS.contains(&name.as_str()), "\\{name}");
    1 + name.len()
}

/// Printable ASCII, and letters of Latin alphabets that LaTeX composes of a letter and an accent
/// in its oldest fonts.
fn is_known(letter: char) -> bool {
    // Icelandic letters, and letters with a hook or a stroke: those fonts lack them.
    let is_missing = "ÐÞðþĄąĐđĘęĦħĮįŲųŊŋŦŧĸſŉ×÷".contains(letter);
    matches!(letter, ' '..='~') || (matches!(letter, 'À'..='ž') && !is_missing)
}
