//! Addresses: editors' names of files.

use moldloft::lang::LIBRARIES;
use std::path::PathBuf;

/// The path of a file address.
pub fn path_of(uri: &str) -> Option<PathBuf> {
    let rest = uri.strip_prefix("file://")?;
    let mut bytes = Vec::new();
    let mut at = rest.bytes();
    while let Some(b) = at.next() {
        if b == b'%' {
            let hex = [at.next()?, at.next()?];
            let hex = std::str::from_utf8(&hex).ok()?.to_string();
            bytes.push(u8::from_str_radix(&hex, 16).ok()?);
        } else {
            bytes.push(b);
        }
    }
    let path = String::from_utf8(bytes).ok()?;
    // /C:/models on Windows.
    let drive = path.as_bytes().get(2) == Some(&b':');
    Some(PathBuf::from(if drive { &path[1..] } else { &path }))
}

/// Folder in which copies of the built-in libraries are shown: among temporary files.
fn folder_of_libraries() -> PathBuf {
    std::env::temp_dir().join("moldloft-libraries")
}

/// Writes the built-in libraries, which an editor shows as files; before the engine is confined,
/// which may not write.
pub fn lay_out_libraries() {
    let folder = folder_of_libraries();
    for (file, text) in LIBRARIES {
        let path = folder.join(file);
        let same = std::fs::read_to_string(&path).is_ok_and(|there| there == *text);
        if !same {
            // Written atomically, as another engine may read it. If the file is missing the editor
            // reports that.
            let new = folder.join(format!("{file}.{}", std::process::id()));
            let _ = std::fs::create_dir_all(&folder)
                .and_then(|()| std::fs::write(&new, text))
                .and_then(|()| std::fs::rename(&new, &path));
        }
    }
}

/// The address of a file; of a built-in library where it was laid out.
pub fn uri_of(name: &str) -> String {
    let library = LIBRARIES.iter().find(|(file, _)| name.strip_prefix("moldloft:") == Some(file));
    let path = match library {
        Some((file, _)) => folder_of_libraries().join(file),
        None => PathBuf::from(name),
    };
    let spelled = path.display().to_string().replace('\\', "/");
    let mut uri = String::from(if spelled.starts_with('/') { "file://" } else { "file:///" });
    for b in spelled.bytes() {
        if b.is_ascii_alphanumeric() || b"/-._~:".contains(&b) {
            uri.push(b as char);
        } else {
            uri.push_str(&format!("%{b:02X}"));
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_and_paths_go_both_ways() {
        for path in ["/models/hull.sdl", "/a b/ü#?%.sdl"] {
            assert_eq!(path_of(&uri_of(path)), Some(PathBuf::from(path)), "{path}");
        }
        assert_eq!(path_of("file:///C:/a.sdl"), Some(PathBuf::from("C:/a.sdl")));
        assert_eq!(path_of("untitled:Untitled-1"), None);
        assert_eq!(path_of("file:///a%2"), None);
    }
}
