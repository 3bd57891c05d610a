//! How the print is read: to the letter, or with faults repaired, one switch an erratum (E1 to E11 of `docs/errata.md`).

/// One fault of the print.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum As {
    /// To the letter.
    Printed,
    /// As it must be.
    Repaired,
}

/// β of Eq. 17. Every β > 0 gives a bound; they differ in how much is given away.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beta {
    /// Eq. 18, √(tr (Q^lim)⁻¹ / tr Q⁻¹): the inverse of the trace's optimum (E1).
    Printed,
    /// √(tr Q⁻¹ / tr (Q^lim)⁻¹): the least trace of (Q^b)⁻¹.
    TraceOptimal,
    /// √(n̂ᵀQ⁻¹n̂ / n̂ᵀ(Q^lim)⁻¹n̂): tight along the body's normal n̂, where the semi-axes then add.
    Tangent,
}

/// Around which sway angles the tubes of the trailers are centred (E8).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sway {
    /// q_{i+1}(t)|₀: δ = 0, straight behind along the leader's velocity, as Eq. 12 and 16 have it.
    Zero,
    /// The tuple δ̂(t) of axles that roll without slip.
    NoSlip,
}

/// What |(q̃_N − q̃_0)·n̂_c| of the Corollary (i) is measured between (E4).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Offset {
    /// To the letter: both centres at the same instant, along the normal at the prime mover. In a bend this holds the
    /// road's own curvature as well.
    SameInstant,
    /// Each centre's lateral offset at its own foot on the centreline, their difference: what Table I's h_Ω of 0.2 to
    /// 0.6 m can have meant.
    OwnFeet,
    /// The trailer's own lateral offset from the route's centre: repaired.
    FromRoute,
}

/// One choice for each fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reading {
    /// E1, Eq. 18.
    pub beta: Beta,
    /// E2, Eq. 14-16: where the sway ellipse is centred.
    pub sway_centre: As,
    /// E3, Eq. 15: U_i.
    pub rotation: As,
    /// E4, Corollary (i).
    pub offset: Offset,
    /// E5: the last trailer only, or every unit.
    pub units: As,
    /// E6: half the body's dimensions as semi-axes, or √2 times them, which is the least ellipse of that form that holds
    /// the corners.
    pub body: As,
    /// E7: r_N^max over all directions, or across the road only.
    pub room: As,
    /// E8.
    pub sway: Sway,
    /// E9, Eq. 2.
    pub radius: As,
    /// E10, Def. 5: normals inward, or outward as in Algorithm 1.
    pub normals: As,
    /// E11, Eq. 20: infimum over the whole boundary, or the boundary at the foot.
    pub boundary: As,
}

impl Reading {
    /// Every formula to the letter.
    pub const PRINTED: Self = Self {
        beta: Beta::Printed,
        sway_centre: As::Printed,
        rotation: As::Printed,
        offset: Offset::SameInstant,
        units: As::Printed,
        body: As::Printed,
        room: As::Printed,
        sway: Sway::Zero,
        radius: As::Printed,
        normals: As::Printed,
        boundary: As::Printed,
    };

    /// The nearest reading that can be run on a road with bends and gives what the paper reports: outward normals at the foot, as
    /// Algorithm 1 has them, offsets at the feet, axles that roll, and the β that the cited sources have. The rest is as
    /// printed.
    pub const SIMULATED: Self = Self {
        beta: Beta::TraceOptimal,
        offset: Offset::OwnFeet,
        rotation: As::Repaired,
        sway: Sway::NoSlip,
        normals: As::Repaired,
        boundary: As::Repaired,
        ..Self::PRINTED
    };

    /// E4, E5, E6 and E9 repaired on top of that: what a certificate needs to bound anything at all. Never more
    /// than the deciding RSC at equal tolerances (`tests/certificate/errata/`).
    pub const SOUND: Self = Self {
        offset: Offset::FromRoute,
        units: As::Repaired,
        body: As::Repaired,
        radius: As::Repaired,
        ..Self::SIMULATED
    };
}
