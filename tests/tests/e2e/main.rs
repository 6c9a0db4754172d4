//! End to end: the built binary, a browser, and what a person sees.
//!
//! One program for all, so that it is linked once and the browsers are busy to the end.

mod ddc;
mod dop;
mod hart;
mod icon;
mod page;
