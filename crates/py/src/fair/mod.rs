//! Fairing: splines, nets and networks with their reports.

mod arguments;
mod look;
mod net;
mod solve;
mod spline;

pub use look::Look;
pub use net::{Net, Web};
pub use spline::{
    Spline, are_exact, data_findings, detectable, divided_differences, eta_y, is_exact,
    line_findings, monotone_runs, shared_knuckles,
};
