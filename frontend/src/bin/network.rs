//! The program of the DDC-100 networks, loaded when somebody wants to see one.

frontend::program!(frontend::network::Network);
