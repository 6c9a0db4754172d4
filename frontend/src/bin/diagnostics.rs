//! The program of the diagnostic objects, loaded when somebody wants to see them.

frontend::program!(frontend::dop::Diagnostics);
