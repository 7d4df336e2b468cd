//! The C interface: models in the process of another program.
//!
//! `C, C++, Fortran -> mlf_v1_... -> Document`
//!
//! Every function returns a code; `mlf_v1_message` copies the words of the last error of this thread into a buffer
//! of the caller. Texts are pointer and length, arrays are the caller's; a call never keeps a pointer. A model or a
//! shape is used by one thread at a time. A panic inside is a code, too. Functions of `mlf_v1_` never change their
//! meaning or their arguments: new ones are added.
//!
//! `include/moldloft.h` is generated from this file by `include/generate.py`.
//!
//! Invariant: nothing is computed here: `document` answers. It is the only crate besides the
//! extension with unsafe code, all of it for pointers of the caller.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
// The functions are for C, which has no `unsafe`: the header states the obligations of callers.
#![allow(unsafe_code, clippy::not_unsafe_ptr_arg_deref)]

mod memory;

use memory::{StatusError, array, array_mut, called, copied, set_message, text_of, words};
use moldloft_diag::render_all;
use moldloft_document::{Document, registry};
use moldloft_host::FileWorld;
use moldloft_num::{Order, Vec3};
use moldloft_parallel::prelude::*;
use moldloft_registry::{CurveRef, SurfaceRef, Value};

/// The call succeeded.
pub const MLF_OK: i32 = 0;
/// A pointer is null, or a number of things is wrong.
pub const MLF_ARGUMENT: i32 = 1;
/// The model has an error, or the request to it.
pub const MLF_MODEL: i32 = 2;
/// The buffer is too small; the size that is needed was stored.
pub const MLF_BUFFER: i32 = 3;
/// An error inside the library.
pub const MLF_INTERNAL: i32 = 99;

/// A model.
#[allow(non_camel_case_types)]
pub struct mlf_model(Document);

/// A curve or surface of a model at the time of its request.
#[allow(non_camel_case_types)]
pub struct mlf_shape(ShapeHandle);

enum ShapeHandle {
    Curve(CurveRef<f64>),
    Surface(SurfaceRef<f64>),
}

/// The version of the interface: 1.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_abi() -> u32 {
    1
}

/// Copies the message of the last error of this thread into `buffer` of `size` bytes, without a
/// terminating zero; returns its length in bytes. With a null buffer only the length.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_message(buffer: *mut u8, size: usize) -> usize {
    words(buffer, size)
}

/// Opens the model in a file; `path` has `length` bytes. Free it by mlf_v1_free.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_open(path: *const u8, length: usize, model: *mut *mut mlf_model) -> i32 {
    called(|| {
        let path = text_of(path, length)?;
        let world = Box::new(FileWorld::around(path, &[]));
        store(model, Document::open(registry(), world, path))
    })
}

/// Makes a model of a text in the language of `.sdl` files. Free it by mlf_v1_free.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_from_text(
    text: *const u8,
    length: usize,
    model: *mut *mut mlf_model,
) -> i32 {
    called(|| {
        let text = text_of(text, length)?;
        let world = Box::new(FileWorld::new(None, &[]));
        store(model, Document::from_text(registry(), world, "model.sdl", text))
    })
}

/// Hands a document without errors over.
fn store(model: *mut *mut mlf_model, document: Document) -> Result<(), StatusError> {
    if model.is_null() {
        return Err(StatusError::argument("the pointer for the model is null"));
    }
    sound(&document)?;
    let handle = Box::into_raw(Box::new(mlf_model(document)));
    // SAFETY: the caller gives a pointer to memory for a handle; it is not null.
    unsafe { *model = handle };
    Ok(())
}

/// The errors of a document as a fault.
fn sound(document: &Document) -> Result<(), StatusError> {
    if !document.has_errors() {
        return Ok(());
    }
    let all = document.diagnostics();
    Err(StatusError::model(render_all(all.iter().filter(|d| d.is_error()), document.sources())))
}

fn faults(document: &Document, all: &[moldloft_diag::Diagnostic]) -> StatusError {
    StatusError::model(render_all(all.iter(), document.sources()))
}

fn document<'m>(model: *mut mlf_model) -> Result<&'m mut Document, StatusError> {
    // SAFETY: a handle of `store`, used by one thread at a time and not yet freed, by the contract of the header.
    let model = unsafe { model.as_mut() };
    model.map(|m| &mut m.0).ok_or_else(|| StatusError::argument("the model is null"))
}

/// Frees a model; null does nothing.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_free(model: *mut mlf_model) {
    if !model.is_null() {
        // SAFETY: a handle of `store` that is freed once, by the contract of the header.
        drop(unsafe { Box::from_raw(model) });
    }
}

/// Sets a parameter, or a literal of an object such as `P21.y`.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_set(
    model: *mut mlf_model,
    name: *const u8,
    length: usize,
    value: f64,
) -> i32 {
    called(|| {
        let document = document(model)?;
        let name = text_of(name, length)?.to_string();
        let set = document.set(&[(name, value)]).map(drop);
        set.map_err(|all| faults(document, &all))
    })
}

/// Evaluates an expression: a number, a vector or an array. Stores the numbers at `values`, which
/// has a capacity of `room`, and their number at `count`.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_eval(
    model: *mut mlf_model,
    expression: *const u8,
    length: usize,
    values: *mut f64,
    room: usize,
    count: *mut usize,
) -> i32 {
    called(|| {
        let document = document(model)?;
        let found = document.eval(text_of(expression, length)?);
        let found = found.map_err(|all| faults(document, &all))?;
        copied(&numbers(&found)?, values, room, count)
    })
}

/// The exact derivative of an expression by a parameter or literal; as mlf_v1_eval.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_derivative(
    model: *mut mlf_model,
    expression: *const u8,
    length: usize,
    by: *const u8,
    by_length: usize,
    values: *mut f64,
    room: usize,
    count: *mut usize,
) -> i32 {
    called(|| {
        let document = document(model)?;
        let expression = text_of(expression, length)?.to_string();
        let by = text_of(by, by_length)?.to_string();
        let rows = document.derivatives(&[expression], &[by]);
        let rows = rows.map_err(|all| faults(document, &all))?;
        let value = rows.first().and_then(|row| row.first());
        let value = value.ok_or_else(|| StatusError::argument("no derivative"))?;
        copied(&numbers(value)?, values, room, count)
    })
}

/// The numbers of a value.
fn numbers(value: &Value<f64>) -> Result<Vec<f64>, StatusError> {
    Ok(match value {
        Value::Number(x) => vec![x + 0.0],
        Value::Vector(v) => v.to_array().to_vec(),
        Value::Point(p) => p.xyz.to_array().to_vec(),
        Value::Numbers(a) => a.items.clone(),
        Value::Vectors(a) => a.iter().flat_map(|v| v.to_array()).collect(),
        other => {
            let class = other.class().with_article();
            return Err(StatusError::argument(&format!("expected numbers, found {class}")));
        }
    })
}

/// The curve or surface of that name as it is now. Free it by mlf_v1_shape_free.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_shape(
    model: *mut mlf_model,
    name: *const u8,
    length: usize,
    shape: *mut *mut mlf_shape,
) -> i32 {
    called(|| {
        if shape.is_null() {
            return Err(StatusError::argument("the pointer for the shape is null"));
        }
        let document = document(model)?;
        let name = text_of(name, length)?;
        let graph = document.graph();
        let object = graph.find(name).and_then(|key| graph.get(key));
        let found = match object.map(|o| o.value()) {
            None => return Err(StatusError::argument(&format!("unknown object `{name}`"))),
            Some(Some(Value::Curve(curve))) => ShapeHandle::Curve(curve.clone()),
            Some(Some(Value::Surface(surface))) => ShapeHandle::Surface(surface.clone()),
            Some(_) => {
                return Err(StatusError::argument(&format!(
                    "`{name}` is neither a curve nor a surface"
                )));
            }
        };
        // SAFETY: the caller gives a pointer to memory for a handle; it is not null.
        unsafe { *shape = Box::into_raw(Box::new(mlf_shape(found))) };
        Ok(())
    })
}

/// Frees a shape; null does nothing.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_shape_free(shape: *mut mlf_shape) {
    if !shape.is_null() {
        // SAFETY: a handle of `mlf_v1_shape` that is freed once, by the contract of the header.
        drop(unsafe { Box::from_raw(shape) });
    }
}

fn shape_of<'s>(shape: *const mlf_shape) -> Result<&'s ShapeHandle, StatusError> {
    // SAFETY: a handle of `mlf_v1_shape`, not yet freed, by the contract of the header.
    let shape = unsafe { shape.as_ref() };
    shape.map(|s| &s.0).ok_or_else(|| StatusError::argument("the shape is null"))
}

/// The number of parameters of a shape: 1 for a curve, 2 for a surface.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_shape_parameters(shape: *const mlf_shape, count: *mut usize) -> i32 {
    called(|| {
        let found = match shape_of(shape)? {
            ShapeHandle::Curve(_) => 1,
            ShapeHandle::Surface(_) => 2,
        };
        array_mut(count, 1)?[0] = found;
        Ok(())
    })
}

/// Points of a shape: `parameters` holds t, or u and v, of `n` points one after the other; `xyz`
/// takes x, y and z of each. Many points are shared among threads of the library's own.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_points(
    shape: *const mlf_shape,
    n: usize,
    parameters: *const f64,
    xyz: *mut f64,
) -> i32 {
    called(|| {
        let shape = shape_of(shape)?;
        let out: &mut [Vec3] = array_mut(xyz.cast(), n)?;
        match shape {
            ShapeHandle::Curve(curve) => {
                let ts: &[f64] = array(parameters, n)?;
                if n <= CHUNK {
                    curve.grid(ts, out);
                    return Ok(());
                }
                let chunks = out.par_chunks_mut(CHUNK).zip(ts.par_chunks(CHUNK));
                chunks.for_each(|(out, ts)| curve.grid(ts, out));
            }
            ShapeHandle::Surface(surface) => {
                let uv: &[[f64; 2]] = array(parameters.cast(), n)?;
                if n <= CHUNK {
                    surface.scattered(uv, out);
                    return Ok(());
                }
                let chunks = out.par_chunks_mut(CHUNK).zip(uv.par_chunks(CHUNK));
                chunks.for_each(|(out, uv)| surface.scattered(uv, out));
            }
        }
        Ok(())
    })
}

/// Number of points evaluated together by one thread; more are divided among all threads.
const CHUNK: usize = 1 << 14;

/// First derivatives of a shape by its parameters at `n` points, given as for mlf_v1_points: for
/// each point the derivative by t, or those by u and by v, x, y and z of each.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_slopes(
    shape: *const mlf_shape,
    n: usize,
    parameters: *const f64,
    slopes: *mut f64,
) -> i32 {
    called(|| {
        match shape_of(shape)? {
            ShapeHandle::Curve(curve) => {
                let ts: &[f64] = array(parameters, n)?;
                let out: &mut [[f64; 3]] = array_mut(slopes.cast(), n)?;
                let slopes = out.par_iter_mut().with_min_len(CHUNK).zip(ts);
                slopes.for_each(|(out, &t)| *out = curve.jet(t, Order::First)[1].to_array());
            }
            ShapeHandle::Surface(surface) => {
                let uv: &[[f64; 2]] = array(parameters.cast(), n)?;
                let out: &mut [[[f64; 3]; 2]] = array_mut(slopes.cast(), n)?;
                out.par_iter_mut().with_min_len(CHUNK).zip(uv).for_each(|(out, &[u, v])| {
                    let jet = surface.jet(u, v, Order::First);
                    *out = [jet.u.to_array(), jet.v.to_array()];
                });
            }
        }
        Ok(())
    })
}

/// The numbers of vertices and of panels of the model as it is.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_panel_counts(
    model: *mut mlf_model,
    vertices: *mut usize,
    panels: *mut usize,
) -> i32 {
    called(|| {
        let document = document(model)?;
        let panelled = document.entire_panels().map_err(|d| faults(document, &[d]))?;
        array_mut(vertices, 1)?[0] = panelled.mesh.positions().len();
        array_mut(panels, 1)?[0] = panelled.mesh.faces().len();
        Ok(())
    })
}

/// The panels of the model as it is: x, y and z of each vertex, and four vertices of each panel, from
/// 0, counter-clockwise seen from outside; a triangle repeats its last. Either pointer may be null.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_panels(model: *mut mlf_model, xyz: *mut f64, corners: *mut u32) -> i32 {
    called(|| {
        let document = document(model)?;
        let panelled = document.entire_panels().map_err(|d| faults(document, &[d]))?;
        let (positions, faces) = (panelled.mesh.positions(), panelled.mesh.faces());
        if !xyz.is_null() {
            let out: &mut [[f64; 3]] = array_mut(xyz.cast(), positions.len())?;
            out.iter_mut().zip(positions).for_each(|(out, p)| *out = p.to_array());
        }
        if !corners.is_null() {
            let out: &mut [[u32; 4]] = array_mut(corners.cast(), faces.len())?;
            out.copy_from_slice(faces);
        }
        Ok(())
    })
}

/// The exact derivatives of all vertices of the panels by a parameter or literal: x, y and z of each.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_panel_derivatives(
    model: *mut mlf_model,
    by: *const u8,
    length: usize,
    xyz: *mut f64,
) -> i32 {
    called(|| {
        let document = document(model)?;
        let by = text_of(by, length)?.to_string();
        let columns = document.jacobian(&[by]).map_err(|all| faults(document, &all))?;
        let column = columns.first().map_or(&[][..], |c| c);
        let out: &mut [[f64; 3]] = array_mut(xyz.cast(), column.len())?;
        out.iter_mut().zip(column).for_each(|(out, p)| *out = p.to_array());
        Ok(())
    })
}

/// Adds statements to the end of the model's text; the model stays as it was when they are wrong.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_add(model: *mut mlf_model, text: *const u8, length: usize) -> i32 {
    called(|| {
        let document = document(model)?;
        let added = text_of(text, length)?;
        let before = document.text();
        document.set_text(&format!("{}\n{added}\n", before.trim_end()));
        let outcome = sound(document);
        if outcome.is_err() {
            document.set_text(&before);
        }
        outcome
    })
}

/// Gives an object another name, everywhere in the text.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_rename(
    model: *mut mlf_model,
    name: *const u8,
    length: usize,
    new_name: *const u8,
    new_length: usize,
) -> i32 {
    called(|| {
        let document = document(model)?;
        let (old, new) = (text_of(name, length)?, text_of(new_name, new_length)?);
        document.rename(old, new).map(drop).map_err(|d| faults(document, &[d]))
    })
}

/// Removes an object; refused while others depend on it.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_delete(model: *mut mlf_model, name: *const u8, length: usize) -> i32 {
    called(|| {
        let document = document(model)?;
        let name = text_of(name, length)?;
        document.delete(name).map(drop).map_err(|d| faults(document, &[d]))
    })
}

/// Copies the model's text into `buffer` of `size` bytes, and stores its length at `length`.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_text(
    model: *mut mlf_model,
    buffer: *mut u8,
    size: usize,
    length: *mut usize,
) -> i32 {
    called(|| copied(document(model)?.text().as_bytes(), buffer, size, length))
}

/// Forgets the message of this thread.
#[unsafe(no_mangle)]
pub extern "C" fn mlf_v1_clear_message() {
    set_message(String::new());
}
