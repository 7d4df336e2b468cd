//! Tests of the crate as one program: a module for each subject.

mod blends;
mod bodies;
mod certified;
mod common;
mod contacts;
mod csg;
mod distances;
mod faces;
mod facets;
mod hulls;
mod mass;
mod primitives;
mod prisms;
mod queries;
mod rays;
mod rows;
mod sets;
mod sheets;
mod thin;
mod trees;
