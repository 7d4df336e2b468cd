//! The page's types of requests are those of the engine: `web/src/requests.ts` is made of `src/request.rs`.
//!
//! `MOLDLOFT_ACCEPT=1 cargo test -p moldloft-session` writes it.

use std::fmt::Write as _;
use std::path::Path;
use syn::{Attribute, Expr, Field, Fields, GenericArgument, Item, Lit, Meta, PathArguments, Type};

const HEAD: &str = "// The requests of the engine, by their kinds. Made by `crates/session/tests/it/requests.rs`; see there.\n";

/// The structs that requests contain.
const PARTS: [&str; 1] = ["Adjusted"];

#[test]
fn the_page_has_the_requests_of_the_engine() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let source = std::fs::read_to_string(root.join("src/request.rs")).expect("the source");
    let items = syn::parse_file(&source).expect("Rust").items;
    let mut text = HEAD.to_string();
    for item in &items {
        match item {
            Item::Struct(item) if PARTS.contains(&item.ident.to_string().as_str()) => {
                write!(text, "\n{}export interface {} {{\n", doc(&item.attrs, ""), item.ident)
                    .unwrap();
                text += &members(&item.fields, "  ");
                text += "}\n";
            }
            Item::Enum(item) if item.ident == "Ask" => {
                write!(text, "\n{}export interface Requests {{\n", doc(&item.attrs, "")).unwrap();
                for variant in &item.variants {
                    let kind = snake(&variant.ident.to_string());
                    text += &doc(&variant.attrs, "  ");
                    match &variant.fields {
                        Fields::Unit => writeln!(text, "  {kind}: Record<never, never>").unwrap(),
                        fields => {
                            writeln!(text, "  {kind}: {{\n{}  }}", members(fields, "    "))
                                .unwrap();
                        }
                    }
                }
                text += "}\n";
            }
            _ => {}
        }
    }
    let path = root.join("../../web/src/requests.ts");
    if std::env::var("MOLDLOFT_ACCEPT").is_ok_and(|value| value == "1") {
        std::fs::write(&path, &text).expect("a writable page");
    }
    let page = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(page == text, "web/src/requests.ts differs: MOLDLOFT_ACCEPT=1 writes it");
}

fn snake(name: &str) -> String {
    let mut text = String::new();
    for (k, c) in name.char_indices() {
        if c.is_uppercase() && k > 0 {
            text.push('_');
        }
        text.extend(c.to_lowercase());
    }
    text
}

fn members(fields: &Fields, indent: &str) -> String {
    let mut text = String::new();
    for field in fields {
        let name = field.ident.as_ref().expect("a named field");
        let mark = if may_be_missing(field) { "?" } else { "" };
        text += &doc(&field.attrs, indent);
        writeln!(text, "{indent}{name}{mark}: {}", typed(&field.ty)).unwrap();
    }
    text
}

fn may_be_missing(field: &Field) -> bool {
    let is_default = |a: &Attribute| match &a.meta {
        Meta::List(list) if a.path().is_ident("serde") => {
            list.tokens.to_string().starts_with("default")
        }
        _ => false,
    };
    typed(&field.ty).ends_with(" | null") || field.attrs.iter().any(is_default)
}

fn doc(attributes: &[Attribute], indent: &str) -> String {
    let line = |a: &Attribute| match &a.meta {
        Meta::NameValue(pair) if a.path().is_ident("doc") => match &pair.value {
            Expr::Lit(text) => match &text.lit {
                Lit::Str(text) => Some(text.value().trim().to_string()),
                _ => None,
            },
            _ => None,
        },
        _ => None,
    };
    let lines: Vec<String> = attributes.iter().filter_map(line).collect();
    if lines.is_empty() { String::new() } else { format!("{indent}/** {} */\n", lines.join(" ")) }
}

fn typed(ty: &Type) -> String {
    let Type::Path(path) = ty else {
        let Type::Array(array) = ty else { panic!("a type without a rule") };
        let Expr::Lit(length) = &array.len else { panic!("a length that is no number") };
        let Lit::Int(length) = &length.lit else { panic!("a length that is no number") };
        let items = vec![typed(&array.elem); length.base10_parse().expect("a length")];
        return format!("[{}]", items.join(", "));
    };
    let last = path.path.segments.last().expect("a name");
    let inner = |k: usize| match &last.arguments {
        PathArguments::AngleBracketed(all) => match &all.args[k] {
            GenericArgument::Type(ty) => typed(ty),
            _ => panic!("an argument without a rule"),
        },
        _ => panic!("a type without its argument"),
    };
    match last.ident.to_string().as_str() {
        "String" => "string".into(),
        "bool" => "boolean".into(),
        "f64" | "u64" | "usize" => "number".into(),
        "Value" => "unknown".into(),
        "Option" => format!("{} | null", inner(0)),
        "Vec" => format!("{}[]", inner(0)),
        "BTreeMap" => format!("Record<{}, {}>", inner(0), inner(1)),
        part if PARTS.contains(&part) => part.into(),
        other => panic!("no rule for {other}"),
    }
}
