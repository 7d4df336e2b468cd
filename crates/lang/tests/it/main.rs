//! Inner parts of the language; programs are run by the tests of `document`.

mod format;
mod inside_folder;
mod panel_attributes;
mod remainders;
mod subarray;
mod units;
