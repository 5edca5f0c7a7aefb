//! The nearest known name to a misspelt one.

/// Similarity (Jaro–Winkler, 0 to 1) from which a name counts as a misspelling of another.
const THRESHOLD: f64 = 0.78;

/// A list of names is cut off after this many.
const MOST_LISTED: usize = 32;

/// Pairs of characters that suggestions among the names of one text may compare: many misspelt names among many would take hours. A text of a
/// thousand names has suggestions for its first thousand mistakes.
const WORK: usize = 100_000_000;

/// What is left of the work on one text.
#[derive(Debug)]
pub(crate) struct Suggestions {
    left: usize,
}

impl Default for Suggestions {
    fn default() -> Self {
        Self { left: WORK }
    }
}

impl Suggestions {
    /// As [`nearest`], among as many of the names as there is work left for.
    pub fn nearest<'a>(&mut self, name: &str, known: &[&'a str]) -> Option<&'a str> {
        let affordable = known.iter().take_while(|candidate| {
            let pairs = (name.len() + 1).saturating_mul(candidate.len() + 1);
            let left = self.left.checked_sub(pairs);
            self.left = left.unwrap_or(0);
            left.is_some()
        });
        nearest(name, affordable.copied())
    }
}

/// The name among `known` that `name` most likely means, if any is near.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = name.to_lowercase();
    let scored = known.into_iter().map(|candidate| {
        let score = strsim::jaro_winkler(&name, &candidate.to_lowercase());
        (score, candidate)
    });
    scored
        .filter(|(score, _)| *score >= THRESHOLD)
        .max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| b.1.cmp(a.1)))
        .map(|(_, candidate)| candidate)
}

/// `a`, `b` and `c` as a choice: "`a`, `b` or `c`".
pub(crate) fn one_of<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    listed(names, "or")
}

/// `a`, `b` and `c` as a list: "`a`, `b` and `c`".
pub(crate) fn all_of<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    listed(names, "and")
}

fn listed<'a>(names: impl IntoIterator<Item = &'a str>, conjunction: &str) -> String {
    let mut names = names.into_iter();
    let listed = names.by_ref().take(MOST_LISTED);
    let mut quoted: Vec<String> = listed.map(|name| format!("`{name}`")).collect();
    // Of a slice this takes no time, however long it is.
    let left_out = names.count();
    if left_out > 0 {
        quoted.push(format!("{left_out} more"));
    }
    match quoted.split_last() {
        None => String::from("none"),
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} {conjunction} {last}", others.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::{all_of, nearest, one_of};

    #[test]
    fn finds_a_misspelling_and_refuses_a_stranger() {
        let known = ["revolute", "prismatic", "ball", "cart"];
        assert_eq!(nearest("revolut", known), Some("revolute"));
        assert_eq!(nearest("Ball", known), Some("ball"));
        assert_eq!(nearest("carriage_return", known), None);
        assert_eq!(nearest("", known), None);
    }

    #[test]
    fn lists_as_words() {
        assert_eq!(one_of(["a"]), "`a`");
        assert_eq!(one_of(["a", "b", "c"]), "`a`, `b` or `c`");
        assert_eq!(all_of(["a", "b", "c"]), "`a`, `b` and `c`");
        assert_eq!(one_of([]), "none");
        assert!(one_of(["x"; 40]).ends_with("`x` or 8 more"));
    }
}
