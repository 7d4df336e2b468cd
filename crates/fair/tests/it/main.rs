//! The tests of fairing: one program.
#![allow(missing_docs)]

mod breaks;
mod defaults;
mod entity;
mod findings;
mod fit;
mod fixtures;
mod grid;
mod hulls;
mod interrogate;
mod joined;
mod joins;
mod kinds_of_nets;
mod knot_removal;
mod many;
mod network;
mod optimum;
mod option_derivatives;
mod rational;
mod shapes;
mod short_lists;
mod swings;
mod truth;
