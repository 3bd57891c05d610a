//! Reference systems of a GeoPackage, transformed to WGS 84 by PROJ.
//!
//! Systems that are much used need no database of PROJ, which a machine may lack. Others are taken only where PROJ knows how
//! accurate its transformation is: a change of datum that it leaves out can be a hundred metres.

use proj::Proj;

use crate::shape::{Shape, Xy};

/// Least accuracy of a transformation, metres.
const ACCURACY_M: f64 = 5.0;

/// A way from a reference system to longitude and latitude.
pub(super) enum Transform {
    /// Coordinates are longitude and latitude already.
    None,
    /// By formula.
    Formula(Proj),
    /// By PROJ's database, which may take another operation at every place.
    Database(Proj),
}

impl Transform {
    /// The transformation of an authority's system.
    pub(super) fn of(authority: &str, code: i64) -> Result<Self, String> {
        let epsg = authority.eq_ignore_ascii_case("EPSG");
        // ETRS89, GDA94, GDA2020 and NAD83 differ from WGS 84 by less than two metres.
        if epsg && [4326, 4258, 4283, 7844, 4269].contains(&code) {
            return Ok(Self::None);
        }
        let made = match projected(code).filter(|_| epsg) {
            Some(pipeline) => Proj::new(&pipeline).ok().map(Self::Formula),
            None => by_database(authority, code).map(Self::Database),
        };
        made.ok_or_else(|| {
            format!(
                "its reference system {authority}:{code} cannot be transformed here; transform it to WGS 84 \
                 (`ogr2ogr -t_srs EPSG:4326 NEW.gpkg FILE`)"
            )
        })
    }

    /// Transforms all positions of a shape.
    pub(super) fn apply(&self, shape: &mut Shape) -> Result<(), String> {
        for at in shape.positions_mut() {
            *at = match self {
                Self::None => *at,
                Self::Formula(proj) | Self::Database(proj) => converted(proj, *at)?,
            };
        }
        match self {
            Self::Database(proj) if !accurate(proj) => {
                Err("PROJ has no accurate transformation to WGS 84 there; transform it with another program".to_owned())
            }
            _ => Ok(()),
        }
    }
}

fn converted(proj: &Proj, [x, y]: Xy) -> Result<Xy, String> {
    let place: (f64, f64) = proj
        .convert((x, y))
        .map_err(|error| format!("x {x}, y {y} cannot be transformed to WGS 84: {error}; correct them"))?;
    Ok([place.0, place.1])
}

/// Whether the operation of the last position is accurate. PROJ gives −1 where it does not know.
fn accurate(proj: &Proj) -> bool {
    let info = proj.proj_info();
    (0.0..=ACCURACY_M).contains(&info.accuracy) && !info.description.is_some_and(|text| text.contains("allpark"))
}

/// The pipeline from a projected system to degrees, for systems that are much used: Web Mercator and UTM.
fn projected(code: i64) -> Option<String> {
    let (zone, ellipsoid, south) = match code {
        3857 => return Some(pipeline("+proj=webmerc +ellps=WGS84")),
        32601..=32660 => (code - 32600, "WGS84", ""),
        32701..=32760 => (code - 32700, "WGS84", " +south"),
        25828..=25838 => (code - 25800, "GRS80", ""),
        26901..=26923 => (code - 26900, "GRS80", ""),
        28348..=28358 => (code - 28300, "GRS80", " +south"),
        7846..=7859 => (code - 7800, "GRS80", " +south"),
        _ => return None,
    };
    Some(pipeline(&format!("+proj=utm +zone={zone}{south} +ellps={ellipsoid}")))
}

fn pipeline(projection: &str) -> String {
    format!("+proj=pipeline +step +inv {projection} +step +proj=unitconvert +xy_in=rad +xy_out=deg")
}

/// A transformation from PROJ's database. Only systems of the plane are asked for: for others the crate `proj` panics, as PROJ
/// gives it no error. The definition in the file is not used, as it may lack the change of datum.
fn by_database(authority: &str, code: i64) -> Option<Proj> {
    if !authority.bytes().all(|byte| byte.is_ascii_alphanumeric()) {
        return None;
    }
    let system = format!("{authority}:{code}");
    let described = Proj::new(&system).ok()?.to_projjson(None, None, None).ok()?;
    let described: serde_json::Value = serde_json::from_str(&described).ok()?;
    let kind = described.get("type")?.as_str()?;
    let plane = ["ProjectedCRS", "GeographicCRS"].contains(&kind);
    plane.then(|| Proj::new_known_crs(&system, "EPSG:4326", None).ok()).flatten()
}
