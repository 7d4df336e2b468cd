//! An interactive session with a document.
//!
//! `request (JSON) -> Session -> reply (one binary frame)`
//! A [`Session`] answers the requests of the workbench: splice the text, set a parameter, drag a
//! point, inspect, complete, export. Replies contain only changes since the last one to the same
//! viewer; [`frame`] defines their format and [`Ask`] the requests. Several viewers of one model
//! share a session.
//!
//! ```
//! use moldloft_document::NoFiles;
//! use moldloft_session::{Reply, Session};
//!
//! let text = "param float w = 2 in [1, 3]; AbsPoint A(0, 0, 0); AbsPoint B(w, 0, 0); Line l(A, B);";
//! let mut session = Session::new(Box::new(NoFiles), "line.sdl", text);
//! let reply = Reply::of(&session.answer(r#"{"id": 1, "kind": "open"}"#));
//! assert_eq!(reply.head["params"][0]["value"], 2.0);
//! let reply = Reply::of(&session.answer(r#"{"id": 2, "kind": "set", "values": {"w": 3}}"#));
//! // A is unchanged, so only B and the line are sent.
//! assert_eq!(reply.head["items"].as_array().unwrap().len(), 2);
//! ```
//! Invariant: no transport, no file access, and no dependence on the state of the page.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod drag;
mod facts;
mod fields;
pub mod frame;
mod overlay;
mod patches;
mod replies;
mod reply;
mod request;
mod scene;
mod session;
mod text;
mod volume;

pub use fields::FIELDS;
pub use reply::Reply;
pub use request::{Ask, Request};
pub use scene::{Scene, SceneItem, SceneItemKind};
pub use session::Session;
