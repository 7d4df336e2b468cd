//! `#[derive(Kind)]`: a documented struct becomes a row of the registry.
//!
//! ```text
//! /// Straight rulings between two curves: S(u,v) = (1-v) C1(u) + v C2(u).
//! #[derive(Kind)]
//! #[kind(class = Surface, shape, columns = "relabel c1 c2", example = "...")]
//! pub struct RuledSurf<T: Real> {
//!     /// Edge v = 0.
//!     c1: CurveRef<T>,
//!     /// Edge v = 1.
//!     c2: CurveRef<T>,
//! }
//! ```
//!
//! Struct: `class` (a `Class`), `columns` (model-file columns), `example` (a self-contained text of
//! the language), `function` (a function instead of a kind), `cheap` (a function that is not
//! cached), `name` (if it differs from the struct's), `shape` (the struct is itself the curve or
//! surface: no `Build` is written), `relabel` (a surface whose v-law can be redistributed). Kinds
//! of curves and snakes, and surfaces with `relabel` or with columns that begin with it, have a
//! last argument `relabel`, which acts on their result; see `moldloft_registry::relabelled`. `sweep
//! = [bead, point]`: the fields of a bead and of a point that the model moves; see
//! `moldloft_registry::Row::sweep`. `role`: the role of the kind for the interpreter besides its
//! value, a `moldloft_registry::Role`. `forward`: derivatives by forward differentiation alone; other
//! rows have a body for numbers of a tape, too. `previewed`: see `moldloft_registry::Row`. Each field has a constant that names it in faults,
//! `Self::C1` for `c1`: `fault.in_field(Self::C1)`. Field: `default` (absent) or `default = 3`,
//! `min`, `max`, `min_items`, `angle`, `variadic`.

use proc_macro::TokenStream;
use proc_macro2::TokenStream as Tokens;
use quote::quote;
use syn::ext::IdentExt;
use syn::punctuated::Punctuated;
use syn::{
    Attribute, Data, DeriveInput, Expr, Fields, Lit, LitStr, Meta, Token, parse_macro_input,
};

/// Declares a kind or function of the registry; see the crate's documentation.
#[proc_macro_derive(Kind, attributes(kind, field))]
pub fn derive_kind(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    expand(&input).unwrap_or_else(|error| error.to_compile_error()).into()
}

#[derive(Default)]
struct KindOptions {
    class: Option<Expr>,
    columns: Option<Expr>,
    example: Option<Expr>,
    name: Option<Expr>,
    function: bool,
    cheap: bool,
    shape: bool,
    relabel: bool,
    forward: bool,
    previewed: bool,
    sweep: Option<Vec<syn::Ident>>,
    role: Option<Expr>,
}

#[derive(Default)]
struct FieldOptions {
    default: Option<Tokens>,
    min: Option<Expr>,
    max: Option<Expr>,
    min_items: Option<Expr>,
    variadic: bool,
    angle: bool,
}

fn expand(input: &DeriveInput) -> syn::Result<Tokens> {
    let options = kind_options(input)?;
    let ident = &input.ident;
    let fields = named_fields(input)?;
    let missing = |what: &str| syn::Error::new_spanned(ident, format!("a kind needs {what}"));
    let class = options.class.as_ref().ok_or_else(|| missing("`class = ...`"))?;
    let mut arguments = Arguments::of(fields)?;
    let check = arguments.check();
    let has_own = arguments.constants.iter().any(|name| name == "RELABEL");
    let relabelled =
        !options.function && !has_own && takes_relabel(class, &options.columns, options.relabel);
    let finish = if relabelled {
        arguments.constants.push(syn::Ident::new("RELABEL", ident.span()));
        let last = arguments.infos.len();
        quote!(
            let value = ::moldloft_registry::Build::build(this, &context)?;
            ::moldloft_registry::relabelled(value, &args[#last])
                .map_err(|fault| fault.in_field(Self::RELABEL))
        )
    } else {
        quote!(::moldloft_registry::Build::build(this, &context))
    };
    let row = row(input, &options, &arguments.infos, relabelled)?;
    let wrap = if options.shape { shape_build(ident, class)? } else { quote!() };
    let Arguments { reads, constants, .. } = &arguments;
    let positions = 0..constants.len();
    let (generics, parameters, conditions) = input.generics.split_for_impl();
    Ok(quote!(
        /// The fields, to name arguments by.
        #[allow(dead_code)]
        impl #generics #ident #parameters #conditions {
            #(pub(crate) const #constants: ::moldloft_registry::FieldId =
                ::moldloft_registry::export::field_id(#positions);)*
        }

        impl<T: ::moldloft_registry::Scalar> #ident<T> {
            fn call(
                args: &[::moldloft_registry::Value<T>],
                context: &::moldloft_registry::Context,
            ) -> ::core::result::Result<::moldloft_registry::Value<T>, ::moldloft_registry::CallError> {
                #check
                let this = Self { #(#reads),* };
                let nesting = args.iter().map(::moldloft_registry::Value::depth).max().unwrap_or(0);
                let context = ::moldloft_registry::Context { nesting, ..context.clone() };
                #finish
            }
        }

        impl ::moldloft_registry::export::StaticRow for #ident<f64> {
            fn row() -> ::moldloft_registry::Row {
                #row
            }
        }

        #wrap
    ))
}

fn named_fields(input: &DeriveInput) -> syn::Result<&syn::FieldsNamed> {
    let Data::Struct(data) = &input.data else {
        return Err(syn::Error::new_spanned(&input.ident, "a kind is a struct"));
    };
    match &data.fields {
        Fields::Named(fields) => Ok(fields),
        _ => Err(syn::Error::new_spanned(&input.ident, "a kind has named fields")),
    }
}

/// The fields of a kind as arguments.
#[derive(Default)]
struct Arguments {
    /// The entry of each in the row.
    infos: Vec<Tokens>,
    /// The fields of the struct, read from values.
    reads: Vec<Tokens>,
    /// The constants that name them in faults.
    constants: Vec<syn::Ident>,
    /// Fields whose count or range may only be known when an object was evaluated.
    checks: Vec<usize>,
}

impl Arguments {
    fn of(fields: &syn::FieldsNamed) -> syn::Result<Self> {
        let mut all = Self::default();
        // A kind without arguments says by a `PhantomData` which scalar it is of.
        let (markers, arguments): (Vec<_>, Vec<_>) =
            fields.named.iter().partition(|field| is_marker(&field.ty));
        for (k, field) in arguments.into_iter().enumerate() {
            let ident = field.ident.as_ref().expect("named fields have names");
            let ty = &field.ty;
            let options = field_options(&field.attrs)?;
            if options.min.is_some() || options.max.is_some() || options.min_items.is_some() {
                all.checks.push(k);
            }
            all.infos.push(field_info(field, ident, &options)?);
            all.reads.push(quote!(
                #ident: <#ty as ::moldloft_registry::FromValue<T>>::from_value(&args[#k])
                    .map_err(|fault| fault.in_field(::moldloft_registry::export::field_id(#k)))?
            ));
            all.constants.push(constant(ident));
        }
        all.reads.extend(markers.iter().map(|field| {
            let ident = &field.ident;
            quote!(#ident: ::core::marker::PhantomData)
        }));
        Ok(all)
    }

    /// The checks of evaluated arguments.
    fn check(&self) -> Tokens {
        if self.checks.is_empty() {
            return quote!();
        }
        let positions = &self.checks;
        let fields = positions.iter().map(|&k| &self.infos[k]);
        quote!(
            for (at, field) in [#((#positions, #fields)),*] {
                ::moldloft_registry::check_evaluated(&field, &args[at])
                    .map_err(|fault| fault.in_field(::moldloft_registry::export::field_id(at)))?;
            }
        )
    }
}

/// The entry of a field in the row. It is filled for one scalar; classes do not depend on it.
fn field_info(
    field: &syn::Field,
    ident: &syn::Ident,
    options: &FieldOptions,
) -> syn::Result<Tokens> {
    let ty = &field.ty;
    let help = doc_text(&field.attrs);
    if help.is_empty() {
        return Err(syn::Error::new_spanned(ident, "a field needs a doc comment"));
    }
    let name = LitStr::new(&ident.unraw().to_string(), ident.span());
    let default = match &options.default {
        Some(default) => quote!(Some(#default)),
        None => quote!(if <#ty as ::moldloft_registry::FromValue<S>>::OPTIONAL {
            Some(::moldloft_registry::DefaultValue::Unset)
        } else {
            None
        }),
    };
    let bound = |e: &Option<Expr>| match e {
        Some(e) => quote!(Some((#e) as f64)),
        None => quote!(None),
    };
    let (min, max) = (bound(&options.min), bound(&options.max));
    let min_items = options.min_items.as_ref().map_or(quote!(0), |e| quote!(#e));
    let variadic = options.variadic;
    let unit = if options.angle { quote!(Angle) } else { quote!(None) };
    Ok(quote!({
        type T = f64;
        type S = f64;
        let _ = ::core::marker::PhantomData::<(T, S)>;
        ::moldloft_registry::FieldSpec {
            name: #name,
            help: #help,
            class: <#ty as ::moldloft_registry::FromValue<S>>::CLASS,
            many: <#ty as ::moldloft_registry::FromValue<S>>::MANY,
            default: #default,
            unit: ::moldloft_registry::Unit::#unit,
            min: #min,
            max: #max,
            min_items: #min_items,
            variadic: #variadic,
        }
    }))
}

/// The row of a kind, with a last argument `relabel` if its result takes one.
fn row(
    input: &DeriveInput,
    options: &KindOptions,
    infos: &[Tokens],
    relabelled: bool,
) -> syn::Result<Tokens> {
    let ident = &input.ident;
    let doc = doc_text(&input.attrs);
    if doc.is_empty() {
        return Err(syn::Error::new_spanned(ident, "a kind needs a doc comment"));
    }
    let Some(example) = &options.example else {
        return Err(syn::Error::new_spanned(ident, "a kind needs `example = ...`"));
    };
    let columns = match &options.columns {
        Some(columns) => quote!(Some(#columns)),
        None => quote!(None),
    };
    let name = match &options.name {
        Some(name) => quote!(#name),
        None => {
            let text = LitStr::new(&ident.to_string(), ident.span());
            quote!(#text)
        }
    };
    let sweep = match &options.sweep {
        Some(fields) => quote!(Some([#(Self::#fields),*])),
        None => quote!(None),
    };
    let role = match &options.role {
        Some(role) => quote!(::moldloft_registry::Role::#role),
        None => quote!(::moldloft_registry::Role::Plain),
    };
    let rev = match options.forward {
        true => quote!(None),
        false => quote!(::moldloft_registry::taped!(
            #ident::<::moldloft_registry::export::Rev>::call
        )),
    };
    let extra =
        if relabelled { quote!(, ::moldloft_registry::export::RELABEL_FIELD) } else { quote!() };
    let (class, is_kind) = (&options.class, !options.function);
    let (cheap, previewed) = (options.cheap, options.previewed);
    Ok(quote!(
        ::moldloft_registry::Row {
            name: #name.into(),
            doc: #doc.into(),
            class: ::moldloft_registry::Class::#class,
            fields: ::std::vec![#(#infos),* #extra].into(),
            kind: #is_kind,
            columns: #columns,
            example: #example.into(),
            sweep: #sweep,
            cheap: #cheap,
            previewed: #previewed,
            role: #role,
            body: ::moldloft_registry::Implementation::Native {
                plain: #ident::<f64>::call,
                dual: #ident::<::moldloft_registry::export::Dual4>::call,
                rev: #rev,
            },
        }
    ))
}

/// `Build` of a struct that is itself the curve, surface or solid.
fn shape_build(ident: &syn::Ident, class: &Expr) -> syn::Result<Tokens> {
    let reference = match quote!(#class).to_string().as_str() {
        "Curve" => quote!(CurveRef),
        "Surface" => quote!(SurfaceRef),
        "Solid" => quote!(SolidRef),
        _ => {
            let message = "`shape` is for Curve, Surface and Solid";
            return Err(syn::Error::new_spanned(class, message));
        }
    };
    Ok(quote!(
        impl<T: ::moldloft_registry::export::Real> ::moldloft_registry::Build<T> for #ident<T> {
            fn build(
                self,
                context: &::moldloft_registry::Context,
            ) -> ::core::result::Result<::moldloft_registry::Value<T>, ::moldloft_registry::CallError> {
                Ok(::moldloft_registry::Value::#class(
                    ::moldloft_registry::#reference::new(self, context.nesting)
                ))
            }
        }
    ))
}

/// True for `PhantomData`.
fn is_marker(ty: &syn::Type) -> bool {
    matches!(ty, syn::Type::Path(path)
        if path.path.segments.last().is_some_and(|last| last.ident == "PhantomData"))
}

/// True for kinds whose parameter, of surfaces the second, is theirs to redistribute.
fn takes_relabel(class: &Expr, columns: &Option<Expr>, asked: bool) -> bool {
    let first_column = |columns: &Expr| match columns {
        Expr::Lit(lit) => match &lit.lit {
            Lit::Str(text) => text.value().starts_with("relabel"),
            _ => false,
        },
        _ => false,
    };
    match quote!(#class).to_string().as_str() {
        "Curve" | "Snake" => true,
        "Surface" => asked || columns.as_ref().is_some_and(first_column),
        _ => false,
    }
}

/// The constants of the fields in `[bead, point]`.
fn field_names(list: &Expr) -> syn::Result<Vec<syn::Ident>> {
    let wrong = |at: &Expr| syn::Error::new_spanned(at, "expected [field, field]");
    let Expr::Array(array) = list else { return Err(wrong(list)) };
    let name = |e: &Expr| match e {
        Expr::Path(path) => path.path.get_ident().ok_or_else(|| wrong(e)).map(constant),
        other => Err(wrong(other)),
    };
    array.elems.iter().map(name).collect()
}

fn constant(field: &syn::Ident) -> syn::Ident {
    syn::Ident::new(&field.unraw().to_string().to_uppercase(), field.span())
}

fn metas(attr: &Attribute) -> syn::Result<Punctuated<Meta, Token![,]>> {
    attr.parse_args_with(Punctuated::parse_terminated)
}

fn kind_options(input: &DeriveInput) -> syn::Result<KindOptions> {
    let mut options = KindOptions::default();
    for attr in input.attrs.iter().filter(|a| a.path().is_ident("kind")) {
        for meta in metas(attr)? {
            match &meta {
                Meta::NameValue(nv) if nv.path.is_ident("class") => {
                    options.class = Some(nv.value.clone());
                }
                Meta::NameValue(nv) if nv.path.is_ident("columns") => {
                    options.columns = Some(nv.value.clone());
                }
                Meta::NameValue(nv) if nv.path.is_ident("example") => {
                    options.example = Some(nv.value.clone());
                }
                Meta::NameValue(nv) if nv.path.is_ident("sweep") => {
                    options.sweep = Some(field_names(&nv.value)?);
                }
                Meta::NameValue(nv) if nv.path.is_ident("role") => {
                    options.role = Some(nv.value.clone());
                }
                Meta::NameValue(nv) if nv.path.is_ident("name") => {
                    options.name = Some(nv.value.clone());
                }
                Meta::Path(path) if path.is_ident("function") => options.function = true,
                Meta::Path(path) if path.is_ident("cheap") => options.cheap = true,
                Meta::Path(path) if path.is_ident("shape") => options.shape = true,
                Meta::Path(path) if path.is_ident("relabel") => options.relabel = true,
                Meta::Path(path) if path.is_ident("forward") => options.forward = true,
                Meta::Path(path) if path.is_ident("previewed") => options.previewed = true,
                other => return Err(syn::Error::new_spanned(other, "unknown option of a kind")),
            }
        }
    }
    Ok(options)
}

fn field_options(attrs: &[Attribute]) -> syn::Result<FieldOptions> {
    let mut options = FieldOptions::default();
    for attr in attrs.iter().filter(|a| a.path().is_ident("field")) {
        for meta in metas(attr)? {
            match &meta {
                Meta::Path(path) if path.is_ident("default") => {
                    options.default = Some(quote!(::moldloft_registry::DefaultValue::Unset));
                }
                Meta::Path(path) if path.is_ident("angle") => options.angle = true,
                Meta::Path(path) if path.is_ident("variadic") => options.variadic = true,
                Meta::NameValue(nv) if nv.path.is_ident("default") => {
                    let value = &nv.value;
                    options.default = Some(match value {
                        Expr::Lit(l) if matches!(l.lit, Lit::Str(_)) => {
                            quote!(::moldloft_registry::DefaultValue::Text(#value))
                        }
                        _ => quote!(::moldloft_registry::DefaultValue::Number((#value) as f64)),
                    });
                }
                Meta::NameValue(nv) if nv.path.is_ident("min") => {
                    options.min = Some(nv.value.clone())
                }
                Meta::NameValue(nv) if nv.path.is_ident("max") => {
                    options.max = Some(nv.value.clone())
                }
                Meta::NameValue(nv) if nv.path.is_ident("min_items") => {
                    options.min_items = Some(nv.value.clone());
                }
                other => return Err(syn::Error::new_spanned(other, "unknown option of a field")),
            }
        }
    }
    Ok(options)
}

/// The text of the doc comments, one blank stripped from the front of each line.
fn doc_text(attrs: &[Attribute]) -> String {
    let mut lines = Vec::new();
    for attr in attrs.iter().filter(|a| a.path().is_ident("doc")) {
        if let Meta::NameValue(nv) = &attr.meta
            && let Expr::Lit(lit) = &nv.value
            && let Lit::Str(text) = &lit.lit
        {
            let text = text.value();
            lines.push(text.strip_prefix(' ').unwrap_or(&text).trim_end().to_string());
        }
    }
    lines.join("\n").trim().to_string()
}
