//! Reference systems of a GeoPackage, transformed to WGS 84 by PROJ.
//!
//! Systems that are much used need no database of PROJ, which a machine may lack or have in another version. Others are taken
//! only where PROJ knows a real transformation: a shift that it leaves out can be a hundred metres.

use proj::Proj;

use crate::evidence::shape::Shape;

/// WGS 84 in degrees, longitude first.
const WGS84: &str = "+proj=longlat +datum=WGS84 +no_defs +type=crs";

/// A way from a reference system to longitude and latitude.
pub(super) enum Transform {
    /// Coordinates are longitude and latitude already.
    None,
    /// Through PROJ.
    Proj(Box<Proj>),
}

impl Transform {
    /// The transformation of a system by its authority's code, or else by its definition as text.
    pub(super) fn of(authority: &str, code: i64, definition: &str) -> Result<Self, String> {
        let epsg = authority.eq_ignore_ascii_case("EPSG");
        // ETRS89, GDA94, GDA2020 and NAD83 differ from WGS 84 by less than two metres.
        if epsg && [4326, 4258, 4283, 7844, 4269].contains(&code) {
            return Ok(Self::None);
        }
        let made = match projected(code).filter(|_| epsg) {
            Some(pipeline) => Proj::new(&pipeline).ok(),
            None => by_database(&format!("{authority}:{code}")).or_else(|| by_database(definition)),
        };
        made.map(|proj| Self::Proj(Box::new(proj))).ok_or_else(|| {
            format!(
                "its reference system {authority}:{code} cannot be transformed here; transform it to WGS 84 \
                 (`ogr2ogr -t_srs EPSG:4326 NEW.gpkg FILE`)"
            )
        })
    }

    /// Transforms all positions of a shape.
    pub(super) fn apply(&self, shape: &mut Shape) -> Result<(), String> {
        let Self::Proj(proj) = self else { return Ok(()) };
        for at in shape.positions_mut() {
            let place: (f64, f64) = proj
                .convert((at[0], at[1]))
                .map_err(|error| format!("x {}, y {} cannot be transformed: {error}; correct them", at[0], at[1]))?;
            *at = [place.0, place.1];
        }
        Ok(())
    }
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

/// A transformation from PROJ's database.
fn by_database(system: &str) -> Option<Proj> {
    let (from, to) = (Proj::new(system).ok()?, Proj::new(WGS84).ok()?);
    from.create_crs_to_crs_from_pj(&to, None, Some(vec!["ALLOW_BALLPARK=NO"])).ok()
}
