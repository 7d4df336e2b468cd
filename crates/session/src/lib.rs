//! A document under a person's hands.
//!
//! `request (JSON) -> Session -> reply (one binary frame)`
//!
//! A [`Session`] answers a page: splice the text, set a parameter, drag a point, inspect, complete, export. After
//! each change it sends only what the viewer has not: see [`frame`] for the form of replies and [`Ask`] for
//! the requests. Several viewers of one model share a session.
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
//! // A has not moved.
//! assert_eq!(reply.head["items"].as_array().unwrap().len(), 2);
//! ```
//!
//! Invariant: knows no transport and opens no file; the page's state is never needed to answer.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod drag;
mod facts;
mod fields;
pub mod frame;
mod overlay;
mod patches;
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
