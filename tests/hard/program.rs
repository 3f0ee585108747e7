//! The program as its users meet it, watched: what it writes has to be sound however it ends.
