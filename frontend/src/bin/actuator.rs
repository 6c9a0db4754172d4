//! The program of the ICON3000 in depth, loaded when somebody wants to see more than its registers.

frontend::program!(frontend::actuator::Actuator);
