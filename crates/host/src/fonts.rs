//! Fonts of the system by their names.

use crate::read_regular;
use moldloft_font::font_names;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Maximum depth of folders of fonts, and number of files in them.
const DEEPEST: usize = 6;
const MOST_FILES: usize = 10_000;

/// The bytes of the font of the system with a family name or a full name, whichever case it is in.
///
/// Files whose own name is the font's are tried first, then all in the order of their paths.
///
/// # Errors
/// The reason in words.
pub fn system_font(name: &str) -> Result<Arc<[u8]>, String> {
    let mut files = Vec::new();
    folders().iter().for_each(|folder| collect(folder, DEEPEST, &mut files));
    files.sort();
    let plain = |text: &str| -> String {
        text.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
    };
    let wanted = plain(name);
    let called =
        |p: &PathBuf| p.file_stem().and_then(|s| s.to_str()).is_some_and(|s| plain(s) == wanted);
    files.sort_by_key(|p| !called(p));
    for file in files {
        let Ok(bytes) = read_regular(&file) else { continue };
        if font_names(&bytes).iter().flatten().any(|n| n.eq_ignore_ascii_case(name)) {
            return Ok(bytes.into());
        }
    }
    Err("no font of that name is installed".to_owned())
}

/// The folders of fonts of this system and its user.
fn folders() -> Vec<PathBuf> {
    let home = std::env::var_os("HOME").map(PathBuf::from);
    let of_user = |parts: &[&str]| -> Vec<PathBuf> {
        home.iter().flat_map(|home| parts.iter().map(move |part| home.join(part))).collect()
    };
    let (system, own): (&[&str], &[&str]) = if cfg!(target_os = "macos") {
        (&["/Library/Fonts", "/System/Library/Fonts"], &["Library/Fonts"])
    } else {
        (&["/usr/share/fonts", "/usr/local/share/fonts"], &[".local/share/fonts", ".fonts"])
    };
    if cfg!(windows) {
        let of =
            |variable: &str, part: &str| Some(Path::new(&std::env::var_os(variable)?).join(part));
        let all = [of("WINDIR", "Fonts"), of("LOCALAPPDATA", r"Microsoft\Windows\Fonts")];
        return all.into_iter().flatten().collect();
    }
    system.iter().map(PathBuf::from).chain(of_user(own)).collect()
}

fn collect(folder: &Path, deep: usize, files: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
        if files.len() >= MOST_FILES {
            return;
        }
        if path.is_dir() {
            if deep > 0 {
                collect(&path, deep - 1, files);
            }
        } else if path.extension().is_some_and(|end| {
            ["ttf", "otf", "ttc", "otc"].iter().any(|known| end.eq_ignore_ascii_case(known))
        }) {
            files.push(path);
        }
    }
}
