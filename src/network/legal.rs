//! Limits of a road and of the nodes on it, together: whatever either forbids is forbidden.

use crate::osm::facts::{Legal, Limit, Permission};

/// The stricter of two sets of limits, field by field.
pub(super) fn merge(a: &Legal, b: &Legal) -> Legal {
    Legal {
        max_height: lesser(a.max_height, b.max_height),
        max_weight: lesser(a.max_weight, b.max_weight),
        max_axle_load: lesser(a.max_axle_load, b.max_axle_load),
        max_length: lesser(a.max_length, b.max_length),
        max_width: lesser(a.max_width, b.max_width),
        hgv: stricter(a.hgv, b.hgv),
        motor_vehicle: stricter(a.motor_vehicle, b.motor_vehicle),
    }
}

/// An unreadable limit wins over a readable one: it may be the lesser, so the answer can only be `unknown`.
fn lesser(a: Limit, b: Limit) -> Limit {
    match (a, b) {
        (Limit::Unreadable, _) | (_, Limit::Unreadable) => Limit::Unreadable,
        (Limit::At(a), Limit::At(b)) => Limit::At(a.min(b)),
        (Limit::None, other) | (other, Limit::None) => other,
    }
}

fn stricter(a: Permission, b: Permission) -> Permission {
    match (a, b) {
        (Permission::No, _) | (_, Permission::No) => Permission::No,
        (Permission::Restricted, _) | (_, Permission::Restricted) => Permission::Restricted,
        (Permission::Yes, Permission::Yes) => Permission::Yes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_either_forbids_is_forbidden() {
        let road = Legal { max_height: Limit::At(4.0), max_width: Limit::At(3.0), ..Legal::default() };
        let gate = Legal {
            max_height: Limit::At(2.1),
            max_width: Limit::Unreadable,
            hgv: Permission::Restricted,
            ..Legal::default()
        };
        let merged = merge(&road, &gate);
        assert_eq!(merged, merge(&gate, &road));
        assert_eq!(merged.max_height, Limit::At(2.1));
        assert_eq!(merged.max_width, Limit::Unreadable);
        assert_eq!(merged.max_length, Limit::None);
        assert_eq!(merged.hgv, Permission::Restricted);
    }
}
