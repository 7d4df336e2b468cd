//! The nearest name, for "did you mean".

/// Number of insertions, deletions, replacements and swaps of neighbours that turn `a` into `b`,
/// each position being changed once (the restricted Damerau–Levenshtein distance), in characters.
///
/// ```
/// assert_eq!(moldloft_diag::edit_distance("hull", "hlul"), 1);
/// assert_eq!(moldloft_diag::edit_distance("BCurve", "CCurve"), 1);
/// assert_eq!(moldloft_diag::edit_distance("", "abc"), 3);
/// ```
pub fn edit_distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().collect();
    let b: Vec<char> = b.chars().collect();
    let mut before: Vec<usize> = vec![0; b.len() + 1];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    let mut row: Vec<usize> = vec![0; b.len() + 1];
    for i in 1..=a.len() {
        row[0] = i;
        for j in 1..=b.len() {
            let replaced = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = replaced.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        std::mem::swap(&mut before, &mut last);
        std::mem::swap(&mut last, &mut row);
    }
    last[b.len()]
}

/// The help that proposes a name.
pub fn did_you_mean(near: impl std::fmt::Display) -> String {
    format!("did you mean `{near}`?")
}

/// The name that a help of [`did_you_mean`] proposes.
pub(crate) fn proposed(help: &str) -> Option<&str> {
    help.strip_prefix("did you mean `")?.strip_suffix("`?").filter(|name| !name.contains('`'))
}

/// The candidate most similar to `name`: equal except for case, or within an edit distance of a
/// third of its length (at least 1); failing that, one that begins or ends with it and an underscore. The first of
/// equally near ones; `None` for names longer than 100 characters.
///
/// ```
/// assert_eq!(moldloft_diag::nearest("AbsPiont", ["AbsPoint", "RelPoint"]), Some("AbsPoint"));
/// assert_eq!(moldloft_diag::nearest("bcurve", ["CCurve", "BCurve"]), Some("BCurve"));
/// assert_eq!(moldloft_diag::nearest("offset", ["set_offset"]), Some("set_offset"));
/// assert_eq!(moldloft_diag::nearest("x", ["hull"]), None);
/// ```
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    const LONGEST: usize = 100;
    const SHORTEST_PART: usize = 3;
    let length = name.chars().count();
    if length > LONGEST {
        return None;
    }
    let limit = (length / 3).max(1);
    let folded = name.to_lowercase();
    let mut best: Option<(usize, &str)> = None;
    let mut longer: Option<&str> = None;
    for candidate in candidates {
        let other = candidate.chars().count();
        if other > LONGEST || candidate == name {
            continue;
        }
        let is_part = length >= SHORTEST_PART
            && (candidate.strip_prefix(name).is_some_and(|rest| rest.starts_with('_'))
                || candidate.strip_suffix(name).is_some_and(|rest| rest.ends_with('_')));
        if is_part {
            longer = longer.or(Some(candidate));
        }
        let distance = if candidate.to_lowercase() == folded {
            0
        } else if other.abs_diff(length) > limit {
            continue;
        } else {
            edit_distance(name, candidate)
        };
        // A one-letter name would be "near" to every other one-letter name.
        let plausible = distance == 0 || (distance <= limit && distance < length.max(other));
        if plausible && best.is_none_or(|(nearest, _)| distance < nearest) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate).or(longer)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances() {
        for (a, b, d) in [
            ("", "", 0),
            ("a", "", 1),
            ("kitten", "sitting", 3),
            ("ab", "ba", 1),
            ("ca", "abc", 3),
            ("été", "ete", 2),
        ] {
            assert_eq!(edit_distance(a, b), d, "{a} {b}");
            assert_eq!(edit_distance(b, a), d, "{b} {a}");
        }
    }

    #[test]
    fn nearest_is_first_of_equals_and_never_far() {
        assert_eq!(nearest("P2", ["P1", "P3"]), Some("P1"));
        assert_eq!(nearest("q", ["p"]), None);
        assert_eq!(nearest("stern", ["bow", "keel"]), None);
        assert_eq!(nearest("hull", []), None);
        assert_eq!(nearest("shell", ["shells", "set_shell"]), Some("shells"));
        assert_eq!(nearest("union", ["smooth_union", "set_union"]), Some("smooth_union"));
        assert_eq!(nearest("un", ["un_on"]), None);
        assert_eq!(nearest("hull", ["hull", "hall"]), Some("hall"));
        assert_eq!(nearest(&"x".repeat(1000), ["x"]), None);
    }
}
