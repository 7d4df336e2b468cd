//! Answers of the server: each method from the text, from the result of its run, or from the names
//! of the workspace.

use crate::index::{Index, MOST_FILES, OpenText};
use crate::lines::LineIndex;
use crate::places::uri_of;
use crate::server::unknown;
use lsp_server::ErrorCode;
use lsp_types::request as ask;
use lsp_types::request::Request as _;
use lsp_types::{
    CompletionItem, CompletionItemKind, FoldingRange, FoldingRangeKind, InlayHint, InlayHintKind,
    InlayHintLabel, ParameterInformation, ParameterLabel, Position, Range, SemanticToken,
    SemanticTokenModifier, SemanticTokenType, SemanticTokens, SemanticTokensLegend, SignatureHelp,
    SignatureInformation, SymbolKind,
};
use moldloft::document::{CompletionKind, Document, NameRole, WorkspacePlace};
use moldloft::syntax::sdl;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A result, or a code of the protocol with the reason of the failure.
pub type Answer = Result<Value, (i32, String)>;

/// The text of a request.
pub struct Asked<'a> {
    pub uri: &'a str,
    pub text: &'a str,
    /// The folder of its file.
    pub folder: Option<PathBuf>,
}

/// Roles of names as the protocol calls them; the index in this list is the number in a message.
const TOKEN_TYPES: [SemanticTokenType; 5] = [
    SemanticTokenType::TYPE,
    SemanticTokenType::VARIABLE,
    SemanticTokenType::PARAMETER,
    SemanticTokenType::FUNCTION,
    SemanticTokenType::PROPERTY,
];
const TOKEN_MODIFIERS: [SemanticTokenModifier; 3] = [
    SemanticTokenModifier::DECLARATION,
    SemanticTokenModifier::DEFAULT_LIBRARY,
    SemanticTokenModifier::READONLY,
];

/// Capabilities of the server.
pub fn capabilities() -> Value {
    let legend = SemanticTokensLegend {
        token_types: TOKEN_TYPES.to_vec(),
        token_modifiers: TOKEN_MODIFIERS.to_vec(),
    };
    json!({
        "textDocumentSync": {"openClose": true, "change": 2, "save": true},
        "hoverProvider": true,
        "completionProvider": {"triggerCharacters": [".", "\"", "/"]},
        "signatureHelpProvider": {"triggerCharacters": ["(", ","], "retriggerCharacters": ["="]},
        "definitionProvider": true,
        "referencesProvider": true,
        "documentHighlightProvider": true,
        "renameProvider": {"prepareProvider": true},
        "documentFormattingProvider": true,
        "documentSymbolProvider": true,
        "workspaceSymbolProvider": true,
        "codeActionProvider": {"codeActionKinds": ["quickfix"]},
        "semanticTokensProvider": {"legend": legend, "full": true},
        "inlayHintProvider": true,
        "foldingRangeProvider": true,
        "workspace": {"workspaceFolders": {"supported": true, "changeNotifications": true}},
    })
}

/// True for methods that are answered from the result of a run.
pub fn needs_run(method: &str) -> bool {
    [
        ask::HoverRequest::METHOD,
        ask::Completion::METHOD,
        ask::SignatureHelpRequest::METHOD,
        ask::GotoDefinition::METHOD,
        ask::PrepareRenameRequest::METHOD,
        ask::Rename::METHOD,
        ask::DocumentSymbolRequest::METHOD,
        ask::CodeActionRequest::METHOD,
        ask::SemanticTokensFullRequest::METHOD,
        ask::InlayHintRequest::METHOD,
    ]
    .contains(&method)
}

/// True for methods that concern the names of all texts.
pub fn needs_workspace(method: &str) -> bool {
    [
        ask::GotoDefinition::METHOD,
        ask::References::METHOD,
        ask::DocumentHighlightRequest::METHOD,
        ask::PrepareRenameRequest::METHOD,
        ask::Rename::METHOD,
        ask::WorkspaceSymbolRequest::METHOD,
    ]
    .contains(&method)
}

fn failed(why: impl Into<String>) -> (i32, String) {
    (ErrorCode::RequestFailed as i32, why.into())
}

fn invalid(error: &serde_json::Error) -> (i32, String) {
    (ErrorCode::InvalidParams as i32, error.to_string())
}

fn position_of(params: &Value) -> Result<Position, (i32, String)> {
    serde_json::from_value(params["position"].clone()).map_err(|e| invalid(&e))
}

fn range_of(params: &Value) -> Result<Range, (i32, String)> {
    serde_json::from_value(params["range"].clone()).map_err(|e| invalid(&e))
}

/// The answers that the text alone gives.
pub fn of_text(method: &str, text: &str) -> Option<Answer> {
    match method {
        ask::Formatting::METHOD => Some(match sdl::format(text) {
            Ok(new) if new == *text => Ok(json!([])),
            Ok(new) => {
                let whole = LineIndex::new(text).range(0, u32::MAX);
                Ok(json!([{"range": whole, "newText": new}]))
            }
            Err(_) => Err(failed("the text has errors and is unchanged")),
        }),
        ask::FoldingRangeRequest::METHOD => {
            let lines = LineIndex::new(text);
            let one = |fold: sdl::Fold| {
                let (start, end) = (lines.position(fold.start), lines.position(fold.end));
                // The line of a closing bracket stays.
                let last = if fold.comment { end.line } else { end.line.saturating_sub(1) };
                (last > start.line).then(|| FoldingRange {
                    start_line: start.line,
                    end_line: last,
                    kind: fold.comment.then_some(FoldingRangeKind::Comment),
                    ..FoldingRange::default()
                })
            };
            Some(Ok(json!(sdl::folds(text).into_iter().filter_map(one).collect::<Vec<_>>())))
        }
        _ => None,
    }
}

/// Answers from the result of a run.
pub fn of_document(
    method: &str,
    params: &Value,
    document: &mut Document,
    asked: &Asked<'_>,
) -> Answer {
    let lines = LineIndex::new(asked.text);
    match method {
        ask::HoverRequest::METHOD => {
            let at = lines.offset(position_of(params)?);
            Ok(match document.hover(at) {
                Some((said, span)) => json!({
                    "contents": {"kind": "markdown", "value": said},
                    "range": lines.range(span.start, span.end),
                }),
                None => Value::Null,
            })
        }
        ask::Completion::METHOD => {
            let at = lines.offset(position_of(params)?);
            let mut items: Vec<CompletionItem> =
                document.completions(at).into_iter().map(completion).collect();
            if document.names_file(asked.text, at) {
                items.extend(files(asked, at));
            }
            Ok(json!({"isIncomplete": false, "items": items}))
        }
        ask::SignatureHelpRequest::METHOD => {
            let at = lines.offset(position_of(params)?);
            Ok(document.call_signature(asked.text, at).map_or(Value::Null, |s| json!(signature(s))))
        }
        ask::DocumentSymbolRequest::METHOD => {
            let symbols = document.symbols().into_iter().map(|(name, kind, span)| {
                let kind = match kind {
                    CompletionKind::Function => SymbolKind::FUNCTION,
                    CompletionKind::Object => SymbolKind::OBJECT,
                    _ => SymbolKind::VARIABLE,
                };
                let place = lines.range(span.start, span.end);
                json!({"name": name, "kind": kind, "range": place, "selectionRange": place})
            });
            Ok(symbols.collect())
        }
        ask::CodeActionRequest::METHOD => actions(document, &lines, range_of(params)?, asked.uri),
        ask::SemanticTokensFullRequest::METHOD => Ok(json!(tokens(document, asked.text, &lines))),
        ask::InlayHintRequest::METHOD => {
            let range = range_of(params)?;
            let hints = document.argument_hints(lines.offset(range.start), lines.offset(range.end));
            let one = |hint: moldloft::document::ArgumentHint| InlayHint {
                position: lines.position(hint.offset),
                label: InlayHintLabel::String(format!("{} =", hint.name)),
                kind: Some(InlayHintKind::PARAMETER),
                text_edits: None,
                tooltip: None,
                padding_left: None,
                padding_right: Some(true),
                data: None,
            };
            Ok(json!(hints.into_iter().map(one).collect::<Vec<_>>()))
        }
        _ => Err(unknown(method)),
    }
}

fn completion(found: moldloft::document::Completion) -> CompletionItem {
    let kind = match found.kind {
        CompletionKind::Variable => CompletionItemKind::VARIABLE,
        CompletionKind::Object => CompletionItemKind::VALUE,
        CompletionKind::Function => CompletionItemKind::FUNCTION,
        CompletionKind::Kind => CompletionItemKind::CLASS,
        CompletionKind::Keyword => CompletionItemKind::KEYWORD,
        CompletionKind::Member => CompletionItemKind::FIELD,
        CompletionKind::Argument => CompletionItemKind::PROPERTY,
        CompletionKind::Word => CompletionItemKind::ENUM_MEMBER,
    };
    let argument = found.kind == CompletionKind::Argument;
    CompletionItem {
        insert_text: argument.then(|| format!("{} = ", found.word)),
        // Arguments of the call are listed before all other names.
        sort_text: argument.then(|| format!(" {}", found.word)),
        kind: Some(kind),
        detail: Some(found.detail).filter(|detail| !detail.is_empty()),
        label: found.word,
        ..CompletionItem::default()
    }
}

/// Inside a quoted text: the files beside the program that match it so far.
fn files(asked: &Asked<'_>, at: u32) -> Vec<CompletionItem> {
    /// The most names that are proposed.
    const MOST: usize = 200;
    let Some(before) = asked.text.get(..at as usize) else { return Vec::new() };
    let Some(start) = sdl::text_around(before, at) else { return Vec::new() };
    let quoted = &before[start as usize..];
    let (below, _) = quoted.rsplit_once('/').unwrap_or(("", quoted));
    // Nothing outside of the folder can be read by a model.
    let outside = below.starts_with('/') || below.split('/').any(|part| part == "..");
    let Some(folder) = asked.folder.as_ref().filter(|_| !outside) else { return Vec::new() };
    let Ok(entries) = std::fs::read_dir(folder.join(below)) else { return Vec::new() };
    let mut found: Vec<(String, bool)> = entries
        .flatten()
        .filter_map(|entry| {
            let name = entry.file_name().into_string().ok().filter(|n| !n.starts_with('.'))?;
            Some((name, entry.path().is_dir()))
        })
        .collect();
    found.sort();
    found.truncate(MOST);
    let one = |(name, folder): (String, bool)| CompletionItem {
        label: if folder { format!("{name}/") } else { name },
        kind: Some(if folder { CompletionItemKind::FOLDER } else { CompletionItemKind::FILE }),
        ..CompletionItem::default()
    };
    found.into_iter().map(one).collect()
}

fn signature(found: moldloft::document::CallSignature) -> SignatureHelp {
    let markdown = |text: String| {
        lsp_types::Documentation::MarkupContent(lsp_types::MarkupContent {
            kind: lsp_types::MarkupKind::Markdown,
            value: text,
        })
    };
    // The protocol counts UTF-16 units; names of arguments are ASCII, the text before them need not
    // be.
    let unit = |byte: u32| found.label[..byte as usize].encode_utf16().count() as u32;
    let arguments = found.arguments.iter().map(|(start, end, help)| ParameterInformation {
        label: ParameterLabel::LabelOffsets([unit(*start), unit(*end)]),
        documentation: (!help.is_empty()).then(|| markdown(help.clone())),
    });
    SignatureHelp {
        signatures: vec![SignatureInformation {
            parameters: Some(arguments.collect()),
            documentation: (!found.doc.is_empty()).then(|| markdown(found.doc)),
            active_parameter: found.active.map(|k| k as u32),
            label: found.label,
        }],
        active_signature: Some(0),
        active_parameter: found.active.map(|k| k as u32),
    }
}

/// The quick fixes of errors in a range.
fn actions(document: &Document, lines: &LineIndex<'_>, range: Range, uri: &str) -> Answer {
    let sources = document.sources();
    let main = sources.ids().next();
    let (from, to) = (lines.offset(range.start), lines.offset(range.end));
    let mut found = Vec::new();
    for diagnostic in document.diagnostics() {
        let span = diagnostic.span();
        if Some(span.file) != main || span.end < from || to < span.start {
            continue;
        }
        let Some(edit) = diagnostic.correction(sources).filter(|e| Some(e.span.file) == main)
        else {
            continue;
        };
        let at = lines.range(edit.span.start, edit.span.end);
        found.push(json!({
            "title": edit.title,
            "kind": "quickfix",
            "isPreferred": true,
            "diagnostics": [{
                "range": lines.range(span.start, span.end),
                "code": diagnostic.id,
                "source": "moldloft",
                "message": diagnostic.message,
            }],
            "edit": {"changes": {uri: [{"range": at, "newText": edit.replacement}]}},
        }));
    }
    Ok(found.into())
}

/// The names of a text, each by its distance from the last, as the protocol requires.
fn tokens(document: &Document, text: &str, lines: &LineIndex<'_>) -> SemanticTokens {
    let mut data = Vec::new();
    let mut last = Position::default();
    for token in document.name_tokens() {
        let (kind, modifiers) = match token.role {
            NameRole::Kind => (0, 2),
            NameRole::Object => (1, 4),
            NameRole::Parameter => (2, 4),
            NameRole::Variable | NameRole::Local => (1, 0),
            NameRole::Routine => (3, 0),
            NameRole::Function => (3, 2),
            NameRole::Member => (4, 0),
        };
        let start = lines.position(token.start);
        let Some(name) = text.get(token.start as usize..token.end as usize) else { continue };
        let same_line = start.line == last.line;
        data.push(SemanticToken {
            delta_line: start.line - last.line,
            delta_start: if same_line { start.character - last.character } else { start.character },
            length: name.encode_utf16().count() as u32,
            token_type: kind,
            token_modifiers_bitset: modifiers | u32::from(token.declares),
        });
        last = start;
    }
    SemanticTokens { result_id: None, data }
}

/// Locations as the editor spells them; those of one file follow each other.
fn located(places: &[WorkspacePlace], open: &[OpenText<'_>]) -> Vec<(String, Range)> {
    let names: Vec<String> = open.iter().map(|(uri, ..)| Index::name_of(uri)).collect();
    let mut found = Vec::with_capacity(places.len());
    for group in places.chunk_by(|a, b| a.0 == b.0) {
        let file = &group[0].0;
        let saved;
        let (uri, text) = match names.iter().position(|name| name == file) {
            Some(k) => (open[k].0.to_string(), open[k].2),
            None => {
                let bytes = moldloft::host::read_regular(Path::new(file)).unwrap_or_default();
                saved = String::from_utf8_lossy(&bytes).into_owned();
                (uri_of(file), saved.as_str())
            }
        };
        let lines = LineIndex::new(text);
        found.extend(group.iter().map(|place| (uri.clone(), lines.range(place.1, place.2))));
    }
    found
}

/// The answers that the names of all texts give.
pub fn of_workspace(
    method: &str,
    params: &Value,
    uri: &str,
    index: &Index,
    open: &[OpenText<'_>],
    document: Option<&Document>,
) -> Answer {
    let workspace = index.workspace();
    if method == ask::WorkspaceSymbolRequest::METHOD {
        let found = workspace.symbols(params["query"].as_str().unwrap_or(""));
        let (names, places): (Vec<String>, Vec<WorkspacePlace>) = found.into_iter().unzip();
        let found = names.into_iter().zip(located(&places, open)).map(|(name, (uri, range))| {
            let location = json!({"uri": uri, "range": range});
            json!({"name": name, "kind": SymbolKind::VARIABLE, "location": location})
        });
        return Ok(found.collect());
    }
    let Some((.., text)) = open.iter().find(|(known, ..)| *known == uri) else {
        return Err(failed(format!("`{uri}` is not open")));
    };
    let file = Index::name_of(uri);
    let lines = LineIndex::new(text);
    let at = lines.offset(position_of(params)?);
    match method {
        ask::GotoDefinition::METHOD => {
            let place = workspace.definition(&file, at);
            if let Some((uri, range)) = located(place.as_slice(), open).pop() {
                return Ok(json!({"uri": uri, "range": range}));
            }
            let Some(document) = document else { return Ok(Value::Null) };
            let sources = document.sources();
            Ok(document.definition(at).map_or(Value::Null, |span| {
                let there = sources.text(span.file).map_or("", |t| t);
                let name = sources.name(span.file).unwrap_or("");
                let range = LineIndex::new(there).range(span.start, span.end);
                json!({"uri": uri_of(name), "range": range})
            }))
        }
        ask::References::METHOD => {
            let found = located(&workspace.references(&file, at), open).into_iter();
            Ok(found.map(|(uri, range)| json!({"uri": uri, "range": range})).collect())
        }
        ask::DocumentHighlightRequest::METHOD => {
            let found = workspace.references(&file, at).into_iter();
            let here = found.filter(|place| place.0 == file);
            Ok(here.map(|place| json!({"range": lines.range(place.1, place.2)})).collect())
        }
        ask::PrepareRenameRequest::METHOD => {
            let found = workspace.references(&file, at).into_iter();
            let here = found.filter(|p| p.0 == file).find(|p| p.1 <= at && at <= p.2);
            match here {
                Some(place) => Ok(json!(lines.range(place.1, place.2))),
                None => Err(failed("no name at this position")),
            }
        }
        _ => {
            if !index.complete {
                return Err(failed(format!(
                    "the workspace has more than {MOST_FILES} programs, so that some uses could be \
                     missed: open a smaller folder"
                )));
            }
            let document = document.ok_or_else(|| {
                failed("the program did not run to its end, so its names are unknown")
            })?;
            let new = params["newName"].as_str().unwrap_or("");
            let reserved = |name: &str| document.is_reserved(name);
            let places = workspace.renamed(&file, at, new, reserved).map_err(failed)?;
            let mut changes: BTreeMap<String, Vec<Value>> = BTreeMap::new();
            for (uri, range) in located(&places, open) {
                changes.entry(uri).or_default().push(json!({"range": range, "newText": new}));
            }
            Ok(json!({"changes": changes}))
        }
    }
}
