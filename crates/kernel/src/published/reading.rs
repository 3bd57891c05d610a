//! Readings of the paper: to the letter or with faults repaired, with one switch per erratum (E1 to E11 of
//! `docs/errata.md`).

/// How one fault is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum As {
    /// To the letter.
    Printed,
    /// Repaired.
    Repaired,
}

/// β of Eq. 17. Every β > 0 gives a bound; a worse β gives a looser one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beta {
    /// Eq. 18, √(tr (Q^lim)⁻¹ / tr Q⁻¹): the inverse of the trace's optimum (E1).
    Printed,
    /// √(tr Q⁻¹ / tr (Q^lim)⁻¹), which gives the least trace of (Q^b)⁻¹.
    TraceOptimal,
    /// √(n̂ᵀQ⁻¹n̂ / n̂ᵀ(Q^lim)⁻¹n̂), which is tight along the body's normal n̂: the semi-axes add there.
    Tangent,
}

/// The sway angles at which the trailers' tubes are centred (E8).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sway {
    /// q_{i+1}(t)|₀: δ = 0, straight behind along the leader's velocity, as in Eq. 12 and 16.
    Zero,
    /// The tuple δ̂(t) of axles that roll without slip.
    NoSlip,
}

/// The points between which |(q̃_N − q̃_0)·n̂_c| of Corollary (i) is measured (E4).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Offset {
    /// To the letter: both centres at the same instant, along the normal at the prime mover. In a bend this includes
    /// the road's own curvature.
    SameInstant,
    /// The difference of the centres' lateral offsets, each at its own foot on the centreline. Table I's h_Ω of 0.2 to
    /// 0.6 m fits this reading.
    OwnFeet,
    /// Repaired: the trailer's own lateral offset from the route's centre.
    FromRoute,
}

/// One choice per fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reading {
    /// E1, Eq. 18.
    pub beta: Beta,
    /// E2, Eq. 14-16: the centre of the sway ellipse.
    pub sway_centre: As,
    /// E3, Eq. 15: U_i.
    pub rotation: As,
    /// E4, Corollary (i).
    pub offset: Offset,
    /// E5: the last trailer only, or every unit.
    pub units: As,
    /// E6: half the body's dimensions as semi-axes, or √2 times them. The latter is the least ellipse of that form that
    /// holds the corners.
    pub body: As,
    /// E7: r_N^max over all directions, or only across the road.
    pub room: As,
    /// E8, Eq. 12 and 16.
    pub sway: Sway,
    /// E9, Eq. 2.
    pub radius: As,
    /// E10, Def. 5: normals inward, or outward as in Algorithm 1.
    pub normals: As,
    /// E11, Eq. 20: the infimum over the whole boundary, or the boundary at the foot.
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

    /// The reading closest to the print that runs on a road with bends and gives the paper's results. Normals point
    /// outward at the foot, as in Algorithm 1. Offsets are taken at the feet, axles roll, and β is that of the cited
    /// sources. The rest is as printed.
    pub const SIMULATED: Self = Self {
        beta: Beta::TraceOptimal,
        offset: Offset::OwnFeet,
        rotation: As::Repaired,
        sway: Sway::NoSlip,
        normals: As::Repaired,
        boundary: As::Repaired,
        ..Self::PRINTED
    };

    /// [`Self::SIMULATED`] with E4, E5, E6 and E9 repaired, without which a certificate bounds nothing. It never
    /// exceeds the deciding RSC at equal tolerances (`tests/certificate/errata/`).
    pub const SOUND: Self = Self {
        offset: Offset::FromRoute,
        units: As::Repaired,
        body: As::Repaired,
        radius: As::Repaired,
        ..Self::SIMULATED
    };
}
