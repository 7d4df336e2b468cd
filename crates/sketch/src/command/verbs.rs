//! The verbs, how they may be shortened, and their help.

use super::CommandError;
use std::sync::LazyLock;

/// A verb of the language.
#[derive(Clone, Debug)]
pub struct Verb {
    /// The word.
    pub name: &'static str,
    /// Heading in HELP.
    pub group: &'static str,
    /// Its forms.
    pub forms: Vec<&'static str>,
    /// Description.
    pub does: &'static str,
}

impl Verb {
    /// Its forms, on one line.
    pub fn usage(&self) -> String {
        self.forms.join(" | ")
    }
}

/// Every verb once, in the order of the help.
///
/// The table `verbs.txt` is their only description: HELP, completion and the command reference of
/// `docs/sketch.md` use it. REVERSE occurs twice, as a command and as an answer; only the first
/// counts here.
pub static VERBS: LazyLock<Vec<Verb>> = LazyLock::new(|| {
    let mut verbs: Vec<Verb> = Vec::new();
    for verb in table() {
        if verbs.iter().all(|v| v.name != verb.name) {
            verbs.push(verb);
        }
    }
    verbs
});

fn table() -> Vec<Verb> {
    let mut rows: Vec<Verb> = Vec::new();
    let (mut group, mut forms) = ("", Vec::new());
    for line in include_str!("verbs.txt").lines().filter(|l| !l.is_empty()) {
        if let Some(heading) = line.strip_prefix("# ") {
            group = heading;
        } else if let Some(does) = line.strip_prefix("    ") {
            let forms = std::mem::take(&mut forms);
            let name = forms.first().map_or("", |f: &&str| f.split(' ').next().unwrap_or(f));
            rows.push(Verb { name, group, forms, does });
        } else {
            forms.push(line);
        }
    }
    rows
}

/// The row of a verb, with its usage.
pub fn row(name: &str) -> Option<&'static Verb> {
    VERBS.iter().find(|v| v.name == name)
}

/// The command reference as Markdown, for `docs/sketch.md`.
pub fn reference() -> String {
    let mut out = String::new();
    let mut group = "";
    for verb in table() {
        if verb.group != group {
            group = verb.group;
            out.push_str(&format!("\n### {group}\n\n| command | does |\n| --- | --- |\n"));
        }
        let forms: Vec<String> =
            verb.forms.iter().map(|f| format!("`{}`", f.replace('|', "\\|"))).collect();
        out.push_str(&format!("| {} | {} |\n", forms.join("<br>"), verb.does));
    }
    out
}

/// The verb of a word, and a note if it was completed or corrected.
///
/// Exact, or a unique beginning, or the first three letters (manual, appendix D: interpreters look at
/// the first two or three characters only, so that later misspelling does no harm).
///
/// # Errors
/// Names the verbs it could be.
pub fn find(word: &str) -> Result<(&'static str, Option<String>), CommandError> {
    let upper = word.to_ascii_uppercase();
    let names = || VERBS.iter().map(|v| v.name);
    if let Some(verb) = names().find(|v| *v == upper) {
        return Ok((verb, None));
    }
    let starting: Vec<&str> = names().filter(|v| v.starts_with(upper.as_str())).collect();
    match starting[..] {
        [verb] => return Ok((verb, None)),
        [] => {}
        // QUADRATIC, PARABOLA and their likes are one command under several names.
        _ => {
            let all = starting.join(" or ");
            return Err(CommandError::text(format!("{all}?"), "type one more letter"));
        }
    }
    let head: String = upper.chars().take(3).collect();
    if head.chars().count() == 3 {
        let like: Vec<&str> = names().filter(|v| v.starts_with(head.as_str())).collect();
        match like[..] {
            // A longer form, or a slip of one letter: other words are no misspellings.
            [verb]
                if upper.starts_with(verb) || moldloft_diag::edit_distance(&upper, verb) <= 1 =>
            {
                return Ok((verb, Some(format!("read {upper} as {verb}"))));
            }
            [_] | [] => {}
            _ => {
                // Several begin alike (EXTRUDE, EXTENSIONS): the nearest spelling decides.
                let near = moldloft_diag::nearest(&upper, like.iter().copied());
                if let Some(verb) = near.filter(|v| moldloft_diag::edit_distance(&upper, v) <= 1) {
                    let verb = like.iter().find(|v| **v == verb).copied().unwrap_or(like[0]);
                    return Ok((verb, Some(format!("read {upper} as {verb}"))));
                }
                let all = like.join(" or ");
                return Err(CommandError::text(format!("{all}?"), "type one more letter"));
            }
        }
    }
    let next = match moldloft_diag::nearest(&upper, names()) {
        Some(near) => format!("did you mean {near}?"),
        None => "HELP lists all commands".to_owned(),
    };
    Err(CommandError::text(format!("there is no command {upper}"), next))
}
