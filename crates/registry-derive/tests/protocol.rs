//! The page's types of requests and replies are those of the engine: `web/src/protocol.ts` is made of `src/request.rs`
//! and `src/replies.rs` of the crate `session`; it is here because this crate reads Rust.
//!
//! `MOLDLOFT_ACCEPT=1 cargo test -p moldloft-registry-derive` writes it.

use std::fmt::Write as _;
use std::path::Path;
use syn::{
    Attribute, Expr, Field, Fields, GenericArgument, Item, ItemEnum, Lit, Meta, PathArguments, Type,
};

const HEAD: &str = "// The requests of the engine by their kinds, and facts of its replies. Made by `crates/registry-derive/tests/protocol.rs`.\n";

#[test]
fn the_page_has_the_protocol_of_the_engine() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../session");
    let mut text = HEAD.to_string();
    for name in ["request.rs", "replies.rs"] {
        let source = std::fs::read_to_string(root.join("src").join(name)).expect("the source");
        for item in &syn::parse_file(&source).expect("Rust").items {
            match item {
                // Its parts are the page's own affair, but for the request itself.
                Item::Struct(item) if item.ident != "Request" => {
                    let head = doc(&item.attrs, "");
                    let members = members(&item.fields, "  ");
                    write!(text, "\n{head}export interface {} {{\n{members}}}\n", item.ident)
                        .unwrap();
                }
                Item::Enum(item) if item.ident == "Ask" => text += &requests(item),
                Item::Enum(item) => {
                    let head = doc(&item.attrs, "");
                    let word = |v: &syn::Variant| format!("'{}'", snake(&v.ident.to_string()));
                    let words: Vec<String> = item.variants.iter().map(word).collect();
                    let words = words.join(" | ");
                    write!(text, "\n{head}export type {} = {words}\n", item.ident).unwrap();
                }
                Item::Type(item) => {
                    let head = doc(&item.attrs, "");
                    let ty = typed(&item.ty);
                    write!(text, "\n{head}export type {} = {ty}\n", item.ident).unwrap();
                }
                _ => {}
            }
        }
    }
    let path = root.join("../../web/src/protocol.ts");
    if std::env::var("MOLDLOFT_ACCEPT").is_ok_and(|value| value == "1") {
        std::fs::write(&path, &text).expect("a writable page");
    }
    let page = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(page == text, "web/src/protocol.ts differs: MOLDLOFT_ACCEPT=1 writes it");
}

/// The fields of each request, by its kind.
fn requests(asks: &ItemEnum) -> String {
    let mut text = format!("\n{}export interface Requests {{\n", doc(&asks.attrs, ""));
    for variant in &asks.variants {
        let kind = snake(&variant.ident.to_string());
        text += &doc(&variant.attrs, "  ");
        match &variant.fields {
            Fields::Unit => writeln!(text, "  {kind}: Record<never, never>").unwrap(),
            fields => writeln!(text, "  {kind}: {{\n{}  }}", members(fields, "    ")).unwrap(),
        }
    }
    text + "}\n"
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
        let ty = typed(&field.ty);
        let (mark, ty) = match serde_option(field) {
            // What is missing is never null.
            Some(option) if option.starts_with("skip_serializing_if") => {
                ("?", ty.trim_end_matches(" | null"))
            }
            Some(option) if option.starts_with("default") => ("?", &*ty),
            // A request may leave out what has no value; a reply never does.
            None if ty.ends_with(" | null") && matches!(field.vis, syn::Visibility::Inherited) => {
                ("?", &*ty)
            }
            _ => ("", &*ty),
        };
        text += &doc(&field.attrs, indent);
        writeln!(text, "{indent}{name}{mark}: {ty}").unwrap();
    }
    text
}

fn serde_option(field: &Field) -> Option<String> {
    field.attrs.iter().find_map(|a| match &a.meta {
        Meta::List(list) if a.path().is_ident("serde") => Some(list.tokens.to_string()),
        _ => None,
    })
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
    let path = match ty {
        Type::Path(path) => path,
        Type::Reference(reference) => return typed(&reference.elem),
        Type::Array(array) => {
            let Expr::Lit(length) = &array.len else { panic!("a length that is no number") };
            let Lit::Int(length) = &length.lit else { panic!("a length that is no number") };
            let items = vec![typed(&array.elem); length.base10_parse().expect("a length")];
            return format!("[{}]", items.join(", "));
        }
        _ => panic!("a type without a rule"),
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
        "String" | "str" => "string".into(),
        "bool" => "boolean".into(),
        "f64" | "u32" | "u64" | "usize" => "number".into(),
        "Value" => "unknown".into(),
        "Option" => format!("{} | null", inner(0)),
        "Vec" => format!("{}[]", inner(0)),
        "BTreeMap" => format!("Record<{}, {}>", inner(0), inner(1)),
        // One of these files declares it, or TypeScript knows no such name.
        own => own.into(),
    }
}
