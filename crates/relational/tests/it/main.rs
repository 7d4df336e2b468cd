//! Kinds of relational geometry: closed forms, derivative laws, searches, refusals.

mod closed_forms;
mod common;
mod curves;
mod laws;
mod plates;
mod refusals;
mod search;
mod surfaces;
