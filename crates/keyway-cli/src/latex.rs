//! Tables for papers: the package `booktabs` is all that they need.

use std::fmt::Write as _;

/// What the first lines of the file say to whoever includes it.
const HEAD: &str = r"% Needs \usepackage{booktabs}. Too wide for the page? Leave out columns, turn the page
% (landscape of \usepackage{pdflscape}), or scale the table (\usepackage{graphicx}):
% \resizebox{\textwidth}{!}{\input{table}}
";

/// A table; columns from the `first_number`-th on are aligned as numbers. Where the first cell
/// changes, there is a line between two rows; where the second one does, some space.
pub(crate) fn latex_table(header: &[&str], rows: &[Vec<String>], first_number: usize) -> String {
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

/// A text that LaTeX passes over.
pub(crate) fn comment(text: &str) -> String {
    let mut comment = String::new();
    for line in text.lines() {
        comment.extend(["% ", line.trim(), "\n"]);
    }
    comment
}

/// A cell: characters that mean something to TeX stand for themselves, and a missing value is a
/// dash.
fn escaped(cell: &str) -> String {
    if cell == "-" {
        return "--".to_owned();
    }
    let mut text = String::new();
    for (i, letter) in cell.char_indices() {
        let (before, after) = (&cell[..i], &cell[i + letter.len_utf8()..]);
        match letter {
            '\\' => text.push_str(r"\textbackslash{}"),
            '~' => text.push_str(r"\textasciitilde{}"),
            '^' => text.push_str(r"\textasciicircum{}"),
            '<' => text.push_str(r"\textless{}"),
            '>' => text.push_str(r"\textgreater{}"),
            '|' => text.push_str(r"\textbar{}"),
            // At the beginning of a row they would belong to the end of the row before.
            '[' | '*' => {
                text.push('{');
                text.push(letter);
                text.push('}');
            }
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => {
                text.push('\\');
                text.push(letter);
            }
            // A minus, not a hyphen.
            '-' if (before.is_empty() || before.ends_with(['(', ' ']))
                && after.starts_with(|next: char| next.is_ascii_digit()) =>
            {
                text.push_str("$-$");
            }
            letter if letter.is_control() => text.push(' '),
            letter => text.push(letter),
        }
    }
    text
}

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
    }

    #[test]
    fn every_special_character() {
        let text = r"&%$#_{}~^\<>|[*]";
        let expected = r"\&\%\$\#\_\{\}\textasciitilde{}\textasciicircum{}\textbackslash{}\textless{}\textgreater{}\textbar{}{[}{*}]";
        assert_eq!(escaped(text), expected);
    }
}
