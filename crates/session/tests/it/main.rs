//! Laws of sessions: a viewer that follows has what one that comes late is sent; drags end where closed
//! forms say; nothing that is typed, set or dragged loses the text.

mod drags;
mod overlays;
mod previews;
mod scenes;
mod statements;
mod texts_beside;
mod viewer;
