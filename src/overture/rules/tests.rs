//! Rules to facts.
