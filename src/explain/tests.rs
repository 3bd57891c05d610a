//! Corridors drawn by hand, and what is said of them.
