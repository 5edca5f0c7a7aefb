//! Fewer lines than the printer makes: brackets, chains of methods and sums that fit on one line stand on one, lists of names fill lines,
//! and an array that is the only argument of a call shares its lines.

/// Longest line that is joined, in characters.
const WIDTH: usize = 128;

/// What one level is indented by.
const LEVEL: usize = 4;

/// The text with lines joined where they fit.
pub fn joined(text: &str) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    loop {
        let before = lines.len();
        // What stands inside of others comes later: from the last line up.
        for i in (0..lines.len()).rev() {
            moved_out(&mut lines, i);
            continued(&mut lines, i);
            hugged(&mut lines, i);
            bracketed(&mut lines, i);
        }
        if lines.len() == before {
            break;
        }
    }
    (0..lines.len()).rev().for_each(|i| filled(&mut lines, i));
    lines.iter().map(|line| format!("{line}\n")).collect()
}

fn indent(line: &str) -> usize {
    line.bytes().take_while(|byte| *byte == b' ').count()
}

/// The line without what it is indented by.
fn content(line: &str) -> &str {
    &line[indent(line)..]
}

fn width(line: &str) -> usize {
    line.chars().count()
}

fn is_comment(line: &str) -> bool {
    content(line).starts_with("//")
}

/// The line that closes the bracket that the line `i` opens at its end.
fn closing(lines: &[String], i: usize) -> Option<usize> {
    let close = match lines[i].chars().last()? {
        '(' => ')',
        '[' => ']',
        _ => return None,
    };
    let level = indent(&lines[i]);
    let rest = lines.iter().enumerate().skip(i + 1);
    let (end, line) = rest.into_iter().find(|(_, line)| indent(line) <= level)?;
    (indent(line) == level && content(line).starts_with(close)).then_some(end)
}

/// Moves lines one level out.
fn shift(lines: &mut [String]) {
    for line in lines {
        line.drain(..LEVEL.min(indent(line)));
    }
}

/// Moves what a call is made on, and the methods below it, one level out where the printer begins two levels in.
fn moved_out(lines: &mut [String], i: usize) {
    let level = indent(&lines[i]);
    let begins = lines[i].ends_with('(') && !is_comment(&lines[i]);
    let Some(next) = lines.get(i + 1).filter(|_| begins) else {
        return;
    };
    if indent(next) == level + 2 * LEVEL {
        let rest = lines[i + 1..].iter();
        let count = rest.take_while(|line| indent(line) > level).count();
        shift(&mut lines[i + 1..=i + count]);
    }
}

/// `f(a, &[` on one line and `])` on another where an array is the last that stands in the bracket of the line `i`, after what fits there.
fn hugged(lines: &mut Vec<String>, i: usize) {
    if i >= lines.len() || is_comment(&lines[i]) || !lines[i].ends_with('(') {
        return;
    }
    let Some(end) = closing(lines, i).filter(|end| *end > i + 2) else {
        return;
    };
    let is_open = |line: &String| ["[", "&["].contains(&content(line));
    let Some(array) = (i + 1..end).find(|&at| is_open(&lines[at])) else {
        return;
    };
    let before: Vec<&str> = lines[i + 1..=array]
        .iter()
        .map(|line| line.trim())
        .collect();
    let head = format!("{}{}", lines[i], before.join(" "));
    let are_short = before[..before.len() - 1]
        .iter()
        .all(|entry| entry.ends_with(','));
    if are_short && closing(lines, array) == Some(end - 1) && width(&head) <= WIDTH {
        shift(&mut lines[array + 1..end]);
        let last = lines[end - 1].trim_end_matches(',').to_owned();
        lines[end - 1] = last + content(&lines[end]);
        lines.remove(end);
        lines.splice(i..=array, [head]);
    }
}

/// Appends to the line `i` the methods and operators that go on below it, as far as they fit.
fn continued(lines: &mut Vec<String>, i: usize) {
    if i >= lines.len() || is_comment(&lines[i]) {
        return;
    }
    let level = indent(&lines[i]);
    let mut last = i;
    while let Some(next) = lines.get(last + 1) {
        let text = content(next);
        let Some(space) = going_on(text) else {
            return;
        };
        let joined = format!("{}{space}{text}", lines[last]);
        if indent(next) != level + LEVEL || width(&joined) > WIDTH {
            return;
        }
        let end = closing(lines, last + 1).unwrap_or(last + 1);
        if lines
            .get(end + 1)
            .is_some_and(|after| indent(after) > level + LEVEL)
        {
            return;
        }
        shift(&mut lines[last + 2..=end.max(last + 1)]);
        lines[last] = joined;
        lines.remove(last + 1);
        last = end - 1;
    }
}

/// Joins the bracket that the line `i` opens, where all of it fits on the line.
fn bracketed(lines: &mut Vec<String>, i: usize) {
    if i >= lines.len() || is_comment(&lines[i]) {
        return;
    }
    let Some(end) = closing(lines, i).or_else(|| pattern_end(lines, i)) else {
        return;
    };
    let inside = &lines[i + 1..end];
    if inside
        .iter()
        .any(|line| is_comment(line) || line.ends_with(['{', ';']))
    {
        return;
    }
    let inside: Vec<&str> = inside.iter().map(|line| line.trim()).collect();
    let open = lines[i].trim_end_matches(',');
    let comma = if open.len() < lines[i].len() {
        ", "
    } else {
        ""
    };
    let inside = inside.join(" ");
    let comma = if inside.is_empty() { "" } else { comma };
    let joined = format!(
        "{open}{comma}{}{}",
        inside.trim_end_matches(','),
        lines[end].trim()
    );
    if width(&joined) <= WIDTH {
        lines.splice(i..=end, [joined]);
        moved_in(lines, i);
    }
}

/// Moves the methods and operators that go on below the line `i` one level in, where they stand below a bracket that has become that line. Those
/// below a method or operator stand as it does.
fn moved_in(lines: &mut [String], i: usize) {
    if going_on(content(&lines[i])).is_some() {
        return;
    }
    let level = indent(&lines[i]);
    let mut at = i + 1;
    while let Some(next) = lines.get(at) {
        if indent(next) != level || going_on(content(next)).is_none() {
            return;
        }
        let end = closing(lines, at).unwrap_or(at);
        for line in &mut lines[at..=end] {
            line.insert_str(0, &" ".repeat(LEVEL));
        }
        at = end + 1;
    }
}

/// What stands between an expression and the method or operator that this line goes on with.
fn going_on(text: &str) -> Option<&'static str> {
    match text.chars().next() {
        Some('.') if !text.starts_with("..") => Some(""),
        Some('*' | '+' | '-' | '/') if text[1..].starts_with(' ') => Some(" "),
        _ => None,
    }
}

/// The line that closes the pattern of an array, which the printer breaks after names.
fn pattern_end(lines: &[String], i: usize) -> Option<usize> {
    let level = indent(&lines[i]);
    if !(content(&lines[i]).starts_with("let [") && lines[i].ends_with(',')) {
        return None;
    }
    let rest = lines.iter().enumerate().skip(i + 1);
    let mut within = rest.take_while(|(_, line)| indent(line) == level);
    let (end, _) = within.find(|(_, line)| content(line).starts_with(']'))?;
    Some(end)
}

/// Puts single names or numbers that follow each other on one line, as many as fit, in the array that the line `i` opens.
fn filled(lines: &mut Vec<String>, i: usize) {
    if is_comment(&lines[i]) || !lines[i].ends_with('[') {
        return;
    }
    let Some(end) = closing(lines, i) else {
        return;
    };
    let level = indent(&lines[i]) + LEVEL;
    let is_word = |c: char| c.is_alphanumeric() || "_.:-\"".contains(c);
    let is_entry = |line: &str| {
        let entry = line.trim().strip_suffix(',');
        indent(line) == level && entry.is_some_and(|entry| entry.chars().all(is_word))
    };
    let mut rows: Vec<String> = vec![];
    let mut is_row = false;
    for line in &lines[i + 1..end] {
        let fits = |row: &&mut String| width(row) + 1 + width(line.trim()) <= WIDTH;
        match rows
            .last_mut()
            .filter(|row| is_row && is_entry(line) && fits(row))
        {
            Some(row) => *row += &format!(" {}", line.trim()),
            None => rows.push(line.clone()),
        }
        is_row = is_entry(line);
    }
    lines.splice(i + 1..end, rows);
}

#[cfg(test)]
mod tests {
    use super::joined;

    #[test]
    fn what_fits_stands_on_one_line() {
        let text = "    let a = b\n        .mul_add(\n            c,\n            d\n                .mul_add(e, f),\n        )\n        .sqrt();\n";
        assert_eq!(
            joined(text),
            "    let a = b.mul_add(c, d.mul_add(e, f)).sqrt();\n"
        );
        let product = format!(
            "    let {} = dot(\n        a,\n        b,\n    )\n    .sqrt()\n    * c;\n",
            "n".repeat(105)
        );
        assert!(
            joined(&product).ends_with(" = dot(a, b)\n        .sqrt()\n        * c;\n"),
            "{}",
            joined(&product)
        );
        let pattern = "    let [a, b,\n    ]: [T; 2] = (*q)\n        .into();\n";
        assert_eq!(joined(pattern), "    let [a, b]: [T; 2] = (*q).into();\n");
        let product = "    let a = b\n        * c;\n    // (\n    let x = 1;\n";
        assert_eq!(
            joined(product),
            "    let a = b * c;\n    // (\n    let x = 1;\n"
        );
    }

    #[test]
    fn lists_of_names_fill_lines() {
        let entry = |n: usize| format!("    \"name_{n:02}\",\n");
        let list: String = (0..20).map(entry).collect();
        let text = joined(&format!("const A: [&str; 20] = [\n{list}];\n"));
        assert_eq!(text.lines().count(), 4, "{text}");
        assert!(text.lines().all(|line| line.len() <= 128), "{text}");
        let row = "    f(\n        3,\n        [\n            long * name,\n            zero,\n            one,\n        ],\n    )\n";
        let long = row.replace("name", &"n".repeat(100));
        assert!(
            joined(&long).starts_with("    f(3, [\n        long"),
            "{}",
            joined(&long)
        );
        assert!(
            joined(&long).ends_with("\n        zero, one,\n    ])\n"),
            "{}",
            joined(&long)
        );
    }
}
