//! The number of a turn in its network.

crate::number::number! {
    /// The number of a turn: its place among all turns of a network ([`super::turn_facts`]), or of a portion or a database where one is
    /// meant. It holds within one network only; `TurnFacts::id` is the same in the next one.
    TurnNo
}
