//! The program of the HART devices, loaded when somebody wants to see one, or HART frames.

frontend::program!(frontend::hart::Hart);
