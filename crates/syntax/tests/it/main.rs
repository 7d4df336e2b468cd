//! Lexers, parsers and formatters: corpus, random programs, damaged texts.

mod canonical_models;
mod corpus;
mod ebnf;
mod mutations;
mod outline;
mod programs;
mod random;
