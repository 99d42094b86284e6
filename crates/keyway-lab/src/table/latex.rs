//! Tables for papers; they need only the package `booktabs`.

use std::fmt::Write as _;

/// First lines of the file, for authors who include it.
const HEAD: &str = r"% Needs \usepackage{booktabs}. Too wide for the page? Leave out columns, turn the page
% (landscape of \usepackage{pdflscape}), or scale the table (\usepackage{graphicx}):
% \resizebox{\textwidth}{!}{\input{FILE}}
";

/// Returns a table; the columns from the `first_number`-th on are aligned as numbers. A change of
/// the first cell draws a line between two rows; a change of the second one adds some space.
pub fn latex_table(header: &[&str], rows: &[Vec<String>], first_number: usize) -> String {
    let line = |cells: &mut dyn Iterator<Item = &str>| {
        let escaped: Vec<String> = cells.map(escaped).collect();
        escaped.join(" & ") + r" \\"
    };
    let columns: String =
        (0..header.len()).map(|i| if i < first_number { 'l' } else { 'r' }).collect();
    let mut text = HEAD.to_owned();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "\\begin{{tabular}}{{{columns}}}\n  \\toprule");
    let _ = writeln!(text, "  {}\n  \\midrule", line(&mut header.iter().copied()));
    for (i, row) in rows.iter().enumerate() {
        match i.checked_sub(1).map(|before| &rows[before]) {
            Some(before) if before.first() != row.first() => text.push_str("  \\midrule\n"),
            Some(before) if before.get(1) != row.get(1) => text.push_str("  \\addlinespace\n"),
            _ => {}
        }
        let _ = writeln!(text, "  {}", line(&mut row.iter().map(String::as_str)));
    }
    text.push_str("  \\bottomrule\n\\end{tabular}\n");
    text
}

/// Returns a text as a LaTeX comment.
pub fn comment(text: &str) -> String {
    // TeX also ends a line at a carriage return.
    let lines = text.split(['\n', '\r']).filter(|line| !line.trim().is_empty());
    lines.flat_map(|line| ["% ", line.trim(), "\n"]).collect()
}

/// Escapes a cell: characters that are special to TeX are escaped, and a missing value is a dash.
/// Characters that pdfLaTeX cannot print are written as code points.
fn escaped(cell: &str) -> String {
    if cell == "-" {
        return "--".to_owned();
    }
    let mut text = String::new();
    for (i, letter) in cell.char_indices() {
        let (before, after) = (&cell[..i], &cell[i + letter.len_utf8()..]);
        if LIGATURES.iter().any(|pair| pair.ends_with(letter) && before.ends_with(&pair[..1])) {
            text.push_str("{}");
        }
        // A minus, not a hyphen.
        let is_minus = letter == '-'
            && (before.is_empty() || before.ends_with(['(', ' ']))
            && after.starts_with(|next: char| next.is_ascii_digit());
        match command(letter) {
            _ if is_minus => text.push_str("$-$"),
            Some(command) => text.push_str(command),
            // At the beginning of a row, TeX would take them as an argument of the previous line
            // break.
            None if matches!(letter, '[' | '*') => text.extend(['{', letter, '}']),
            None if letter.is_control() => text.push(' '),
            None if letter.is_ascii() || COMPOSED.contains(letter) => text.push(letter),
            None => {
                // Writing to a string cannot fail.
                let _ = write!(text, "U+{:04X}", u32::from(letter));
            }
        }
    }
    text
}

/// Pairs that TeX would print as another character, such as a dash.
const LIGATURES: [&str; 6] = ["--", "''", "``", ",,", "?`", "!`"];

/// Letters beyond ASCII that pdfLaTeX can set in every font encoding: the letters of the Cork
/// encoding that OT1 composes.
const COMPOSED: &str = "ÀÁÂÃÄÅÆÇÈÉÊËÌÍÎÏÑÒÓÔÕÖØÙÚÛÜÝßàáâãäåæçèéêëìíîïñòóôõöøùúûüýÿĂăĆćČčĎďĚěĞğİıĹĺĽľŁłŃńŇňŐőŒœŔŕŘřŚśŞşŠšŢţŤťŮůŰűŸŹźŻżŽž";

/// TeX command for a character that TeX does not print as it is.
const fn command(letter: char) -> Option<&'static str> {
    Some(match letter {
        '\\' => r"\textbackslash{}",
        '~' => r"\textasciitilde{}",
        '^' => r"\textasciicircum{}",
        '<' => r"\textless{}",
        '>' => r"\textgreater{}",
        '|' => r"\textbar{}",
        // In some languages this character begins a command.
        '"' => r"{\char34}",
        '&' => r"\&",
        '%' => r"\%",
        '$' => r"\$",
        '#' => r"\#",
        '_' => r"\_",
        '{' => r"\{",
        '}' => r"\}",
        '–' => "--",
        '—' => "---",
        '‘' => "`",
        '’' => "'",
        '“' => "``",
        '”' => "''",
        '…' => r"\dots{}",
        '\u{a0}' => "~",
        '−' => "$-$",
        '±' => r"$\pm$",
        '×' => r"$\times$",
        '·' => r"$\cdot$",
        '°' => r"$^\circ$",
        '²' => "$^2$",
        '³' => "$^3$",
        // Both the micro sign and the Greek letter.
        'µ' | 'μ' => r"$\mu$",
        '≤' => r"$\leq$",
        '≥' => r"$\geq$",
        '←' => r"$\leftarrow$",
        '→' => r"$\rightarrow$",
        _ => return None,
    })
}

#[cfg(test)]
#[path = "../../../keyway-cli/tests/cli/latex_reader.rs"]
mod reader;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_by_hand() {
        let row = |cells: [&str; 3]| cells.map(str::to_owned).to_vec();
        let rows = [
            row(["a_1.map", "jps", "-0.5"]),
            row(["a_1.map", "jps", "-0.1 (-2.5 to -1)"]),
            row(["a_1.map", "theta-star", "2"]),
            row(["b", "theta-star", "-"]),
        ];
        let expected = r"\begin{tabular}{llr}
  \toprule
  map & planner & excess \% \\
  \midrule
  a\_1.map & jps & $-$0.5 \\
  a\_1.map & jps & $-$0.1 ($-$2.5 to $-$1) \\
  \addlinespace
  a\_1.map & theta-star & 2 \\
  \midrule
  b & theta-star & -- \\
  \bottomrule
\end{tabular}
";
        let text = latex_table(&["map", "planner", "excess %"], &rows, 2);
        let (head, table) = text.split_at(text.find("\\begin").unwrap());
        assert!(head.lines().all(|line| line.starts_with('%')), "{head}");
        for part in ["booktabs", "landscape", "\\resizebox{\\textwidth}"] {
            assert!(head.contains(part), "{part}: {head}");
        }
        assert_eq!(table, expected);
    }

    #[test]
    fn every_line_of_a_comment_is_one() {
        assert_eq!(comment("a:\n   b; 95 %"), "% a:\n% b; 95 %\n");
        assert_eq!(comment("a\r\nb\r\\c\n\n"), "% a\n% b\n% \\c\n");
    }

    #[test]
    fn every_special_character() {
        let text = "&%$#_{}~^\\<>|[*]\"";
        let expected = r"\&\%\$\#\_\{\}\textasciitilde{}\textasciicircum{}\textbackslash{}\textless{}\textgreater{}\textbar{}{[}{*}]{\char34}";
        assert_eq!(escaped(text), expected);
        assert_eq!(
            escaped("1 ± 2 × 3 – 4 → 5 µs"),
            r"1 $\pm$ 2 $\times$ 3 -- 4 $\rightarrow$ 5 $\mu$s"
        );
        assert_eq!(escaped("a--b, ''c'', ?`d"), "a-{}-b, '{}'c'{}', ?{}`d");
        assert_eq!(escaped("Gänge\t中"), "Gänge U+4E2D");
    }

    /// Names of all characters of the first planes, and sequences with a special meaning, in each
    /// cell.
    #[test]
    fn hostile_names_make_a_sound_table() {
        let mut names: Vec<String> = [
            r"\input{/etc/passwd}",
            r"a \\ b & c",
            r"\\[2em]",
            "*",
            "[x]",
            "%",
            "$x_1$",
            "^^M",
            r"\end{tabular}",
            "#1",
            "{",
            "}",
            "a\rb\nc",
            "---",
            "?`",
            "",
            " ",
            "-",
            "-5",
            "\u{2028}",
            "naïve ± 3",
            "\u{1f916}",
            "~/a_b.toml",
        ]
        .map(str::to_owned)
        .to_vec();
        names.extend(
            (0..0x3000).filter_map(char::from_u32).map(|letter| format!("{letter}{letter}")),
        );
        let row = |(i, name): (usize, &String)| {
            let mut row = vec!["x".to_owned(); 3];
            row[i % 3].clone_from(name);
            row
        };
        let rows: Vec<Vec<String>> = names
            .iter()
            .enumerate()
            .flat_map(|(i, name)| [row((i, name)), row((0, name))])
            .collect();
        let text = comment("a\rb % c") + &latex_table(&["name &", "50 %", "m/s^2"], &rows, 1);
        let cells = reader::read(&text);
        assert_eq!(cells.len(), 1 + rows.len());
        assert_eq!(cells[0], [r"name \&", r"50 \%", r"m/s\textasciicircum{}2"]);
    }

    /// The reader detects errors in a table.
    #[test]
    fn the_reader_is_strict() {
        let table = |row: &str| {
            format!(
                "\\begin{{tabular}}{{lr}}\n\\toprule\na & b \\\\\n\\midrule\n{row}\n\\bottomrule\n\\end{{tabular}}\n"
            )
        };
        assert_eq!(reader::read(&table(r"c & $-$1 \\")), [["a", "b"], ["c", "$-$1"]]);
        for row in [
            r"c \\",
            r"c & d & e \\",
            "c & d",
            r"c_1 & d \\",
            r"c & # \\",
            r"c & 5 % \\",
            r"c & { \\",
            r"c & \foo \\",
            r"c & $x \\",
            r"c & 中 \\",
            r"c & ± \\",
            r"[c] & d \\",
            r"* & d \\",
            r"c & d \\[2em]",
            r"c & x^2 \\",
        ] {
            let found = std::panic::catch_unwind(|| reader::read(&table(row)));
            assert!(found.is_err(), "{row}");
        }
    }
}
