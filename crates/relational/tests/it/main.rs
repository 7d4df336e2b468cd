//! Kinds of relational geometry: closed forms, derivative laws, searches, refusals.

mod chebyshev;
mod closed_forms;
mod common;
mod creased_cuts;
mod curves;
mod degenerate;
mod facts;
mod inverse_relabel;
mod laws;
mod plates;
mod refusals;
mod search;
mod surfaces;
mod table;
mod third_derivatives;
mod trimmed;
mod wrappers;
