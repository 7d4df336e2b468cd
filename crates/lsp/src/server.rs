//! What the server answers.

use crate::position::{offset, position, range};
use moldloft_diag::{DiagnosticData, LabelData, Severity};
use moldloft_host::FileWorld;
use moldloft_lang::{CompletionKind, Document, LIBRARIES, NoFiles, World};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Code of the protocol for a method that the server does not know.
const METHOD_NOT_FOUND: i64 = -32601;
/// Code for what cannot be done to this text.
const REQUEST_FAILED: i64 = -32803;

/// Whether more messages are awaited.
pub enum Next {
    Message,
    End { orderly: bool },
}

/// A text that an editor has open.
struct Open {
    document: Document,
    version: Value,
    /// Other texts that diagnostics of this one were told for.
    told: Vec<String>,
}

/// The open texts.
#[derive(Default)]
pub struct Server {
    open: BTreeMap<String, Open>,
    shut_down: bool,
}

impl Server {
    /// The messages that answer one.
    pub fn handle(&mut self, message: &Value) -> (Vec<Value>, Next) {
        let method = message["method"].as_str().unwrap_or("");
        let params = &message["params"];
        if method == "exit" {
            return (Vec::new(), Next::End { orderly: self.shut_down });
        }
        let answers = match message.get("id") {
            Some(id) if !method.is_empty() => {
                let answer = match self.request(method, params) {
                    Ok(result) => json!({"jsonrpc": "2.0", "id": id, "result": result}),
                    Err((code, text)) => {
                        json!({"jsonrpc": "2.0", "id": id, "error": {"code": code, "message": text}})
                    }
                };
                vec![answer]
            }
            _ => self.notice(method, params),
        };
        (answers, Next::Message)
    }

    fn notice(&mut self, method: &str, params: &Value) -> Vec<Value> {
        let uri = params["textDocument"]["uri"].as_str().unwrap_or("").to_string();
        match method {
            "textDocument/didOpen" => {
                let item = &params["textDocument"];
                let text = item["text"].as_str().unwrap_or("");
                let document = opened(&uri, text);
                let version = item["version"].clone();
                self.open.insert(uri.clone(), Open { document, version, told: Vec::new() });
                self.diagnostics(&uri)
            }
            "textDocument/didChange" => {
                let Some(open) = self.open.get_mut(&uri) else { return Vec::new() };
                let mut text = open.document.text();
                for change in params["contentChanges"].as_array().into_iter().flatten() {
                    let new = change["text"].as_str().unwrap_or("");
                    match change.get("range") {
                        Some(range) => {
                            let start = offset(&text, &range["start"]) as usize;
                            let end = (offset(&text, &range["end"]) as usize).max(start);
                            text.replace_range(start..end, new);
                        }
                        None => text = new.to_string(),
                    }
                }
                open.document.set_text(&text);
                open.version = params["textDocument"]["version"].clone();
                self.diagnostics(&uri)
            }
            "textDocument/didSave" => {
                // Other texts may load this one.
                let all: Vec<String> = self.open.keys().cloned().collect();
                let mut answers = Vec::new();
                for other in all {
                    if other != uri
                        && let Some(open) = self.open.get_mut(&other)
                    {
                        let text = open.document.text();
                        open.document = opened(&other, &text);
                        answers.extend(self.diagnostics(&other));
                    }
                }
                answers
            }
            "textDocument/didClose" => {
                let told = self.open.remove(&uri).map_or(Vec::new(), |open| open.told);
                let all = std::iter::once(uri).chain(told);
                all.map(|uri| published(&uri, &Value::Null, &[])).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The diagnostics of a text, by the files that they are about.
    fn diagnostics(&mut self, uri: &str) -> Vec<Value> {
        let Some(open) = self.open.get_mut(uri) else { return Vec::new() };
        let document = &open.document;
        let sources = document.sources();
        let main = sources.ids().next();
        let main_text = document.text();
        let mut by_file: BTreeMap<String, Vec<Value>> = BTreeMap::new();
        by_file.insert(uri.to_string(), Vec::new());
        for diagnostic in document.diagnostics() {
            let span = diagnostic.span();
            let at_home = !span.is_known() || Some(span.file) == main;
            let (home, text) = if at_home {
                (uri.to_string(), main_text.clone())
            } else {
                let name = sources.name(span.file).unwrap_or("");
                (uri_of(name), sources.text(span.file).map_or(String::new(), |t| t.to_string()))
            };
            let place = if span.is_known() {
                range(&text, span)
            } else {
                json!({"start": position(&text, 0), "end": position(&text, 0)})
            };
            let data = diagnostic.to_data(sources);
            let severity = match diagnostic.severity {
                Severity::Error => 1,
                Severity::Warning => 2,
                _ => 3,
            };
            let related: Vec<Value> =
                data.secondary.iter().map(|l| self::related(l, uri)).collect();
            by_file.entry(home).or_default().push(json!({
                "range": place,
                "severity": severity,
                "code": data.id,
                "source": "moldloft",
                "message": message(&data),
                "relatedInformation": related,
            }));
        }
        let mut answers = Vec::new();
        let before = std::mem::take(&mut open.told);
        for gone in before.iter().filter(|uri| !by_file.contains_key(*uri)) {
            answers.push(published(gone, &Value::Null, &[]));
        }
        for (home, all) in &by_file {
            let version = if home == uri { open.version.clone() } else { Value::Null };
            answers.push(published(home, &version, all));
        }
        open.told = by_file.into_keys().filter(|home| home != uri).collect();
        answers
    }

    fn request(&mut self, method: &str, params: &Value) -> Result<Value, (i64, String)> {
        match method {
            "initialize" => return Ok(capabilities()),
            "shutdown" => {
                self.shut_down = true;
                return Ok(Value::Null);
            }
            _ => {}
        }
        let uri = params["textDocument"]["uri"].as_str().unwrap_or("").to_string();
        if !method.starts_with("textDocument/") {
            return Err((METHOD_NOT_FOUND, format!("there is no method `{method}`")));
        }
        let Some(open) = self.open.get_mut(&uri) else {
            return Err((REQUEST_FAILED, format!("`{uri}` is not open")));
        };
        let document = &mut open.document;
        let text = document.text();
        let at = offset(&text, &params["position"]);
        match method {
            "textDocument/hover" => Ok(match document.hover(at) {
                Some((said, span)) => json!({
                    "contents": {"kind": "markdown", "value": said},
                    "range": range(&text, span),
                }),
                None => Value::Null,
            }),
            "textDocument/completion" => {
                let items = document.completions(at).into_iter().map(|c| {
                    let kind = match c.kind {
                        CompletionKind::Variable => 6,
                        CompletionKind::Object => 21,
                        CompletionKind::Function => 3,
                        CompletionKind::Kind => 7,
                        CompletionKind::Keyword => 14,
                        CompletionKind::Member => 5,
                    };
                    json!({"label": c.word, "kind": kind, "detail": c.detail})
                });
                Ok(json!({"isIncomplete": false, "items": items.collect::<Vec<_>>()}))
            }
            "textDocument/definition" => Ok(match document.definition(at) {
                Some(span) => {
                    let sources = document.sources();
                    if sources.ids().next() == Some(span.file) {
                        json!({"uri": uri, "range": range(&text, span)})
                    } else {
                        let there = sources.text(span.file).map_or("", |t| t);
                        let name = sources.name(span.file).unwrap_or("");
                        json!({"uri": uri_of(name), "range": range(there, span)})
                    }
                }
                None => Value::Null,
            }),
            "textDocument/references" | "textDocument/documentHighlight" => {
                let spans = document.references(at);
                let places =
                    spans.into_iter().map(|s| json!({"uri": uri, "range": range(&text, s)}));
                Ok(places.collect())
            }
            "textDocument/prepareRename" => match document.references(at).first() {
                Some(_) => {
                    let found = document.references(at);
                    let here = found.into_iter().find(|s| s.touches(at));
                    Ok(here.map_or(Value::Null, |span| range(&text, span)))
                }
                None => Err((REQUEST_FAILED, "there is no name here".into())),
            },
            "textDocument/rename" => {
                let new = params["newName"].as_str().unwrap_or("");
                let spans = document.renamed(at, new).map_err(|why| (REQUEST_FAILED, why))?;
                let edits =
                    spans.into_iter().map(|s| json!({"range": range(&text, s), "newText": new}));
                let edits: Vec<Value> = edits.collect();
                Ok(json!({"changes": {uri: edits}}))
            }
            "textDocument/formatting" => match moldloft_syntax::sdl::format(&text) {
                Ok(new) if new == text => Ok(json!([])),
                Ok(new) => {
                    let whole =
                        json!({"start": position(&text, 0), "end": position(&text, u32::MAX)});
                    Ok(json!([{"range": whole, "newText": new}]))
                }
                Err(_) => Err((REQUEST_FAILED, "the text has errors and is left as it is".into())),
            },
            "textDocument/documentSymbol" => {
                let symbols = document.symbols().into_iter().map(|(name, kind, span)| {
                    let kind = match kind {
                        CompletionKind::Function => 12,
                        CompletionKind::Object => 19,
                        _ => 13,
                    };
                    let place = range(&text, span);
                    json!({"name": name, "kind": kind, "range": place, "selectionRange": place})
                });
                Ok(symbols.collect())
            }
            _ => Err((METHOD_NOT_FOUND, format!("there is no method `{method}`"))),
        }
    }
}

/// What the server can do.
fn capabilities() -> Value {
    json!({
        "capabilities": {
            "textDocumentSync": {"openClose": true, "change": 2, "save": true},
            "hoverProvider": true,
            "completionProvider": {"triggerCharacters": ["."]},
            "definitionProvider": true,
            "referencesProvider": true,
            "documentHighlightProvider": true,
            "renameProvider": {"prepareProvider": true},
            "documentFormattingProvider": true,
            "documentSymbolProvider": true,
        },
        "serverInfo": {"name": "moldloft-lsp", "version": env!("CARGO_PKG_VERSION")},
    })
}

fn published(uri: &str, version: &Value, all: &[Value]) -> Value {
    let mut params = json!({"uri": uri, "diagnostics": all});
    if !version.is_null() {
        params["version"] = version.clone();
    }
    json!({"jsonrpc": "2.0", "method": "textDocument/publishDiagnostics", "params": params})
}

/// The text of a diagnostic: what is wrong, what was expected, how to mend it.
fn message(data: &DiagnosticData) -> String {
    let mut text = data.message.clone();
    for (word, said) in [("expected", &data.expected), ("found", &data.found)] {
        if let Some(said) = said {
            text.push_str(&format!("\n{word} {said}"));
        }
    }
    for said in data.notes.iter().chain(&data.help) {
        text.push_str(&format!("\n{said}"));
    }
    text
}

fn related(label: &LabelData, uri: &str) -> Value {
    let home = path_of(uri).map(|p| p.display().to_string());
    let same = home.as_deref() == Some(label.file.as_str()) || label.file == uri;
    let place = |line: u32, column: u32| json!({"line": line - 1, "character": column - 1});
    json!({
        "location": {
            "uri": if same { uri.to_string() } else { uri_of(&label.file) },
            "range": {
                "start": place(label.line, label.column),
                "end": place(label.end_line, label.end_column),
            },
        },
        "message": label.text,
    })
}

/// The model of a text: what it loads is sought beside its file.
fn opened(uri: &str, text: &str) -> Document {
    let (world, name): (Box<dyn World>, String) = match path_of(uri) {
        Some(path) => {
            let folder = path.parent().unwrap_or(Path::new(".")).to_path_buf();
            (Box::new(FileWorld::new(Some(&folder), &[])), path.display().to_string())
        }
        None => (Box::new(NoFiles), uri.to_string()),
    };
    Document::from_text(moldloft_lang::registry(), world, &name, text)
}

/// The path of a file address.
fn path_of(uri: &str) -> Option<PathBuf> {
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

/// The address of a file; a built-in library is laid beside other temporary files to be shown.
fn uri_of(name: &str) -> String {
    let library = LIBRARIES.iter().find(|(file, _)| name.strip_prefix("moldloft:") == Some(file));
    let path = match library {
        Some((file, text)) => {
            let folder = std::env::temp_dir().join("moldloft-libraries");
            let path = folder.join(file);
            let same = std::fs::read_to_string(&path).is_ok_and(|there| there == *text);
            if !same {
                // Without the file the editor says itself that there is none.
                let _ = std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&path, text));
            }
            path
        }
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
